//! StartFit: whether the start points of a stage fit its system, and what they are made from.

use crate::chart::Chart;
use crate::homotopies::HomotopyKind;
use crate::homotopies::prepare::StartSystem;
use crate::prepare_error::PrepareError;
use crate::start_points::{Digest, StartPoints, StoredPoints};
use crate::start_systems::exchange::Exchange;
use crate::start_systems::linear_product::{LinearProduct, SOLVING_STEPS, SetStructure};
use crate::start_systems::multihomogeneous::Multihomogeneous;
use crate::start_systems::polyhedral::branches::CellBranches;
use crate::start_systems::polyhedral::generic::{GenericSystem, ToricStart};
use crate::start_systems::total_degree::TotalDegree;
use crate::work::Stage;
use cognate_systems::polynomial::Degrees;
use cognate_systems::scaling::Scaling;
use cognate_systems::system::System;
use std::sync::Arc;

/// Points where paths begin.
#[derive(Debug)]
pub(crate) enum Points {
    /// Points that a start system makes.
    Made(StartSystem),
    /// Stored points, in the unknowns that are tracked.
    Stored(Arc<StoredPoints>),
}

/// The properties of a stage that its start points must fit.
pub(crate) struct StartFit<'a> {
    /// The system that is tracked: the given system, or combinations of its equations.
    pub system: &'a System,
    /// Degrees of the system that is tracked.
    pub degrees: &'a Degrees,
    pub chart: &'a Chart,
    /// Ratio of the variables to the unknowns: stored points are values of the variables.
    pub scaling: &'a Scaling,
    pub stage: &'a Stage,
    /// The generic system with the same monomials, for homotopies that begin or end at one.
    pub generic: Option<&'a GenericSystem>,
}

fn misfit(what: impl Into<String>) -> PrepareError {
    PrepareError::StartPoints(what.into())
}

impl StartFit<'_> {
    /// Checks start points against the stage and returns their source; `objects` finds stored points by their digest.
    pub fn points(
        &self,
        start: &StartPoints,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Points, PrepareError> {
        let made = match start {
            StartPoints::TotalDegree { degrees } => self.total_degree(degrees)?,
            StartPoints::Multihomogeneous {
                degrees,
                dimensions,
                exchange,
            } => self.multihomogeneous(degrees, dimensions, exchange.as_ref())?,
            StartPoints::LinearProduct { sets, count } => self.linear_product(sets, *count)?,
            StartPoints::Stored { object, count } => {
                return self.stored(*object, *count, objects);
            }
            StartPoints::MixedCells { count, branches } => {
                self.mixed_cells(*count, branches.as_ref())?
            }
            StartPoints::Selected { .. } => return Err(misfit("a selection of a selection")),
        };
        Ok(Points::Made(made))
    }

    fn is_straight(&self) -> bool {
        matches!(self.stage.homotopy, HomotopyKind::StraightLine { .. })
    }

    fn is_toric(&self) -> bool {
        matches!(self.stage.homotopy, HomotopyKind::Toric)
    }

    fn total_degree(&self, degrees: &[u32]) -> Result<StartSystem, PrepareError> {
        let equation_degrees = self.degrees.by_group.iter().map(|row| &row[0]);
        if !(self.chart.group_count() == 1
            && self.is_straight()
            && degrees.iter().eq(equation_degrees))
        {
            return Err(misfit(
                "a total-degree start has one group of variables and the degrees of the equations",
            ));
        }
        Ok(StartSystem::TotalDegree(TotalDegree::new(degrees)))
    }

    fn multihomogeneous(
        &self,
        degrees: &[Vec<u32>],
        dimensions: &[u32],
        exchange: Option<&Exchange>,
    ) -> Result<StartSystem, PrepareError> {
        let (chart, seed) = (self.chart, self.stage.seed);
        let fits = self.is_straight()
            && *degrees == self.degrees.by_group
            && dimensions.len() == chart.group_count()
            && (0..dimensions.len()).all(|k| dimensions[k] as usize == chart.group_size(k) - 1);
        let made = fits
            .then(|| Multihomogeneous::new(degrees, dimensions, exchange, chart, seed))
            .flatten()
            .ok_or_else(|| {
                misfit("the degrees or dimensions are not those of the system's groups")
            })?;
        Ok(StartSystem::Multihomogeneous(made))
    }

    fn linear_product(&self, sets: &SetStructure, count: u64) -> Result<StartSystem, PrepareError> {
        let degrees = self.degrees.total.iter().map(|&d| d as usize);
        let fits = self.is_straight() && in_order(self.system);
        if !(fits && sets.iter().map(Vec::len).eq(degrees)) {
            return Err(misfit(
                "a linear-product start has one affine group of all variables and as many sets as degrees",
            ));
        }
        let n = self.system.variable_count();
        let start = LinearProduct::new(sets, n, self.stage.seed, SOLVING_STEPS)
            .map_err(|error| misfit(error.to_string()))?;
        if start.count() != count {
            let start_count = start.count();
            return Err(misfit(format!(
                "the sets have {start_count} start points, not {count}"
            )));
        }
        Ok(StartSystem::LinearProduct(Arc::new(start)))
    }

    fn stored(
        &self,
        object: Digest,
        count: u64,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Points, PrepareError> {
        let stored = objects(object).ok_or(PrepareError::MissingObject(object))?;
        let variables = self.system.variable_count();
        if stored.len() as u64 != count || stored.dimension != variables {
            return Err(misfit(format!(
                "{} points of {} coordinates for {variables} variables",
                stored.len(),
                stored.dimension,
            )));
        }
        if self.is_straight() || self.is_toric() {
            return Err(misfit(
                "stored points start a parameter homotopy or a user homotopy",
            ));
        }
        Ok(Points::Stored(match self.scaling.is_none() {
            true => stored,
            false => Arc::new(stored.in_unknowns(self.scaling)),
        }))
    }

    fn mixed_cells(
        &self,
        count: u64,
        branches: Option<&CellBranches>,
    ) -> Result<StartSystem, PrepareError> {
        let generic = self.generic.filter(|_| self.is_toric());
        let generic = generic.ok_or_else(|| misfit("mixed cells start a toric homotopy"))?;
        let (generic, seed) = (generic.clone(), self.stage.seed);
        let start = match branches {
            Some(counted) => ToricStart::branched(generic, seed, counted),
            None => ToricStart::new(generic, seed),
        };
        let start = start.map_err(|error| misfit(error.to_string()))?;
        if start.count() != count {
            let volume = start.count();
            return Err(misfit(format!("the mixed volume is {volume}, not {count}")));
        }
        Ok(StartSystem::Toric(Arc::new(start)))
    }
}

/// Whether all variables are one affine group, in order.
pub(crate) fn in_order(system: &System) -> bool {
    let [group] = system.groups.as_slice() else {
        return false;
    };
    !group.homogeneous
        && group
            .variables
            .iter()
            .copied()
            .eq(0..system.variable_count())
}

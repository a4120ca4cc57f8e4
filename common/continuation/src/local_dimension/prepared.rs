//! PreparedLocalDimension: a stage that asks of stored endpoints whether they are isolated.

use super::candidates::{Candidate, EXTRA, from_stored};
use super::moved_slice::meets;
use super::{LEAST_ERROR, Question, local_dimension};
use crate::asked_system::AskedSystem;
use crate::chart::Chart;
use crate::homotopies::HomotopyKind;
use crate::item_result::{ItemResult, PointResult};
use crate::path_result::{LocalDimension, PathIndex};
use crate::prepared_items::PreparedItems;
use crate::sharpening::missed_slice::misses_slice;
use crate::sharpening::search::sharpen;
use crate::stage::PrepareError;
use crate::start_points::{Digest, StartPoints, StoredPoints};
use crate::work::Stage;
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::Complex;
use cognate_systems::exact_point::exact_point;
use cognate_systems::expression::Node;
use cognate_systems::polynomial::{PolynomialError, check_homogeneous, degrees, dual_dimensions};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::ops::Range;
use std::sync::Arc;

/// Digits to which a multiple point must be a solution of deflated equations: two points that are
/// 1e-23 of their size apart are told from one.
const CONFIRMING_DIGITS: u32 = 50;
/// Least margin at which dimensions in doubles are believed.
const CLEAR: f64 = 3.0;
/// The margin of a multiplicity that deflated equations do not confirm.
const UNCONFIRMED: f64 = 1.0;

/// An exact solution belongs to an endpoint if it is at most this many times the endpoint's error away.
const NEXT: f64 = 10.0;
/// An exact solution belongs to an endpoint if it is at most this far away, whatever the endpoint's error.
const FARTHEST_EXACT: f64 = 1e-6;
/// Relative error of a point whose exact coordinates are rounded to doubles, in the chart.
const ROUNDED: f64 = 1e-15;

/// A term below this, relative to the largest ones, may be a rounding error.
const SMALL_TERM: f64 = 1e-12;

/// The equations that are asked, and the endpoints.
#[derive(Debug)]
pub struct PreparedLocalDimension {
    asked: AskedSystem,
    /// The equations that are asked, exactly, in the unknowns that are tracked.
    system: System,
    /// The equations that are asked, exactly, in the variables.
    given: System,
    /// Values of the parameters of the system at each target.
    parameters: Vec<Vec<Complex64>>,
    seed: u64,
    /// Relative accuracy to which coefficients are known.
    data_accuracy: f64,
    /// Largest degree of an equation.
    degree: u32,
    /// The smallest constant other than 0 as a part of the largest one, or of 1.
    least_constant: f64,
    candidates: Vec<Candidate>,
}

/// A solution with small rational coordinates, and the parameters that it belongs to.
struct ExactPoint {
    values: Vec<ComplexRational>,
    parameters: Vec<ComplexRational>,
}

impl ExactPoint {
    /// Dimensions of the dual space up to an order less one and that order; `None` where that takes too much to tell.
    fn dual_dimensions(&self, system: &System, order: u32) -> Option<[u32; 2]> {
        dual_dimensions(system, &self.values, &self.parameters, order)
    }

    /// Dimensions of the dual space up to order 0, 1, ... until they stop growing, at the multiplicity; `None` where they
    /// exceed a bound of it, or that takes too much to tell.
    fn closed_dual_dimensions(&self, system: &System, question: Question) -> Option<Vec<u32>> {
        let mut dimensions = vec![1];
        for order in 1..=question.depth {
            let [before, last] = self.dual_dimensions(system, order)?;
            dimensions.push(last);
            if last == before {
                return Some(dimensions);
            }
            if u64::from(last) > question.bound {
                return None;
            }
        }
        None
    }
}

impl PreparedLocalDimension {
    /// Checks that stage, endpoints and system fit, and compiles.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        system.check()?;
        let misfit = |what: &str| PrepareError::StartPoints(what.to_string());
        let StartPoints::Stored { object, count } = &stage.start_points else {
            return Err(misfit("endpoints to look at are stored"));
        };
        let stored = objects(*object).ok_or(PrepareError::MissingObject(*object))?;
        if stored.len() as u64 != *count || stored.dimension != system.variable_count() + EXTRA {
            return Err(misfit(
                "endpoints have the system's variables and two numbers more",
            ));
        }
        let homotopy = &stage.homotopy;
        let targets = homotopy.parameter_sets() as u64;
        let given = (0..homotopy.parameter_sets())
            .map(|target| homotopy.end_parameters(target, system.path_variable));
        let given: Option<Vec<_>> = given.map(|values| Some(values?.into_owned())).collect();
        let on_the_way = matches!(homotopy, HomotopyKind::MoveSlice { .. });
        let given = given.filter(|_| !on_the_way);
        let given = given.ok_or_else(|| misfit("a homotopy on the way ends at another system"))?;
        let expected = system.parameters.len();
        for values in &given {
            if values.len() != expected {
                return Err(PrepareError::Parameters {
                    what: "parameters of the endpoints",
                    found: values.len(),
                    expected,
                });
            }
        }
        let candidates: Vec<Candidate> = (0..stored.len())
            .map(|index| from_stored(&stored, index).filter(|c| c.target < targets))
            .collect::<Option<_>>()
            .ok_or_else(|| misfit("an endpoint's accuracy, bound or target is none"))?;
        let variables = system;
        let system = &*system.in_unknowns();
        let wrong = |error: PolynomialError| PrepareError::Degrees(error.to_string());
        let degrees_of_equations = degrees(system).map_err(wrong)?;
        check_homogeneous(system, &degrees_of_equations).map_err(wrong)?;
        let chart = Chart::new(system, stage.seed, stage.attempt);
        Ok(Self {
            asked: AskedSystem::new(
                system,
                &degrees_of_equations,
                &stage.homotopy,
                chart,
                stage.seed,
            ),
            system: system.clone(),
            given: variables.clone(),
            parameters: given,
            seed: stage.seed,
            data_accuracy: stage.settings.error_of_data(),
            degree: degrees_of_equations
                .total
                .iter()
                .copied()
                .max()
                .unwrap_or(0),
            least_constant: least_constant(system),
            candidates,
        })
    }

    /// Number of endpoints.
    pub fn items(&self) -> u64 {
        self.candidates.len() as u64
    }

    /// Number of coordinates of the chart.
    pub fn dimension(&self) -> usize {
        self.asked.chart().dimension()
    }

    /// The dual spaces at these endpoints.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    pub fn run(&self, items: Range<u64>) -> Vec<PointResult<LocalDimension>> {
        items.map(|item| self.look(item)).collect()
    }

    /// Values of the parameters at an endpoint's target.
    fn parameters_of(&self, candidate: &Candidate) -> &[Complex64] {
        // Where parameters do not matter one empty list of them stands for all targets.
        let target = usize::try_from(candidate.target).ok();
        let parameters = target.and_then(|target| self.parameters.get(target));
        parameters.map_or(&[][..], Vec::as_slice)
    }

    /// The values of the unknowns of an endpoint, or of the exact solution that it is next to, and that.
    fn point_of(&self, candidate: &Candidate) -> (Vec<Complex64>, Option<ExactPoint>) {
        let error = (NEXT * candidate.question.accuracy).min(FARTHEST_EXACT);
        let exact = || {
            let parameters = self.parameters_of(candidate).iter();
            let parameters = parameters.map(|&z| ComplexRational::from_doubles(z));
            let parameters = parameters.collect::<Option<Vec<_>>>()?;
            let values = exact_point(&self.given, &parameters, &candidate.values, error)?;
            Some(ExactPoint { values, parameters })
        };
        let exact = exact();
        let rounded = exact.as_ref().map(|point| {
            let round = |z: &ComplexRational| {
                let z = Complex::<f64>::from_rational((), z);
                Complex64::new(z.re, z.im)
            };
            point.values.iter().map(round).collect::<Vec<_>>()
        });
        let scaling = &self.given.scaling;
        let values = rounded.as_ref().unwrap_or(&candidate.values);
        (scaling.to_unknowns(values), exact)
    }

    /// Where doubles do not tell, the multiplicity of an exact solution is that of its exact dual space.
    ///
    /// Dual spaces know a multiple point to the accuracy of the endpoint, an exact solution to rounding: several
    /// points nearer together than that look like one. The margin says whether that is ruled out.
    fn confirmed(
        &self,
        candidate: &Candidate,
        unknowns: &[Complex64],
        exact: Option<&ExactPoint>,
        dimension: LocalDimension,
    ) -> LocalDimension {
        let is_closed = matches!(*dimension.dual_dimensions, [.., before, last] if last == before)
            && dimension.margin >= CLEAR;
        let is_exact = self.data_accuracy == 0.0;
        if let Some(exact) = exact.filter(|_| is_exact && !is_closed) {
            let closed = exact.closed_dual_dimensions(&self.given, candidate.question);
            return match closed {
                Some(dual_dimensions) => LocalDimension {
                    dual_dimensions,
                    margin: f64::INFINITY,
                    ..dimension
                },
                None => dimension,
            };
        }
        let [.., before, last] = *dimension.dual_dimensions else {
            return dimension;
        };
        if last != before || last == 1 || dimension.margin <= UNCONFIRMED {
            return dimension;
        }
        let order = dimension.dual_dimensions.len() as u32 - 1;
        let exactly = exact.and_then(|exact| exact.dual_dimensions(&self.given, order));
        let confirmed = match exactly {
            Some(exactly) => exactly == [last, last],
            None => self.is_deflated(candidate, unknowns),
        };
        match confirmed {
            true => dimension,
            false => LocalDimension {
                margin: UNCONFIRMED,
                ..dimension
            },
        }
    }

    /// Slices that doubles meet since terms are too small for them are no evidence of a set.
    fn without_missed_slices(
        &self,
        candidate: &Candidate,
        unknowns: &[Complex64],
        dual_spaces: LocalDimension,
    ) -> LocalDimension {
        let may_be_missed = self.data_accuracy == 0.0
            && meets(&dual_spaces.moved_slices)
            && self.has_small_terms(unknowns);
        let (parameters, seed) = (self.parameters_of(candidate), self.seed);
        match may_be_missed && misses_slice(&self.system, parameters, unknowns, seed) {
            true => LocalDimension {
                moved_slices: Vec::new(),
                ..dual_spaces
            },
            false => dual_spaces,
        }
    }

    /// Whether a term other than 0 can be so small at a point that doubles take it for 0.
    fn has_small_terms(&self, unknowns: &[Complex64]) -> bool {
        let sizes = || unknowns.iter().map(|z| z.re.abs().max(z.im.abs()));
        let least = sizes().filter(|size| *size > 0.0).fold(1.0, f64::min);
        let largest = sizes().fold(1.0, f64::max);
        let mut term = self.least_constant;
        for _ in 0..self.degree {
            term *= least / largest;
        }
        term < SMALL_TERM
    }

    /// Whether deflated equations have as many digits of a point as are asked for: then it is one multiple point.
    fn is_deflated(&self, candidate: &Candidate, unknowns: &[Complex64]) -> bool {
        let (parameters, seed) = (self.parameters_of(candidate), self.seed);
        let sharpened = sharpen(&self.system, parameters, unknowns, CONFIRMING_DIGITS, seed);
        sharpened.is_ok_and(|sharpened| sharpened.deflations > 0)
    }

    fn look(&self, item: u64) -> PointResult<LocalDimension> {
        let candidate = &self.candidates[item as usize];
        let chart = self.asked.chart();
        let (unknowns, exact) = self.point_of(candidate);
        let point = chart.from_variables(&unknowns);
        let dimension = point.as_ref().map(|point| {
            let question = Question {
                accuracy: match exact {
                    Some(_) => ROUNDED,
                    None => candidate.question.accuracy.max(LEAST_ERROR),
                },
                ..candidate.question
            };
            let dual_spaces = local_dimension(
                &self.asked,
                candidate.target,
                point,
                question,
                self.data_accuracy,
            );
            let dual_spaces = self.without_missed_slices(candidate, &unknowns, dual_spaces);
            self.confirmed(candidate, &unknowns, exact.as_ref(), dual_spaces)
        });
        // A patch that misses the point, with probability 0, leaves it undecided.
        let mut endpoint = point.map_or_else(Vec::new, |point| chart.homogeneous(&point));
        if endpoint.is_empty() {
            endpoint.push(Complex64::default());
        } else {
            chart.normalize(&mut endpoint);
        }
        PointResult {
            residual: 0.0,
            accuracy: candidate.question.accuracy,
            ..PointResult::new(PathIndex(item), 0, endpoint, dimension)
        }
    }
}

/// The smallest constant of a system other than 0 as a part of the largest one, or of 1.
fn least_constant(system: &System) -> f64 {
    let sizes = system
        .expressions
        .nodes()
        .iter()
        .filter_map(|node| match node {
            Node::Constant(value) => {
                let z = Complex::<f64>::from_rational((), value);
                Some(z.re.abs().max(z.im.abs())).filter(|size| *size > 0.0)
            }
            _ => None,
        });
    let (least, largest) = sizes.fold((1.0, 1.0), |(least, largest): (f64, f64), size| {
        (least.min(size), largest.max(size))
    });
    least / largest
}

impl PreparedItems for PreparedLocalDimension {
    fn items(&self) -> u64 {
        self.items()
    }

    fn run(&self, items: Range<u64>, _: usize) -> Vec<ItemResult> {
        let results = self.run(items).into_iter();
        results.map(ItemResult::LocalDimension).collect()
    }
}

//! Operand: one component about which something is asked, in the unknowns that are tracked.
//!
//! The witness points come from a file or a client: they are accepted only where Newton's method converges at them.

use super::deflated::{Deflations, ProblemContext, PureSet, equal_ones_merged};
use super::job::Job;
use super::problem::Problem;
use super::superset::SingularEnd;
use cognate_continuation::bend::RefinedPoint;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_solutions::witness::{ComponentId, WitnessSet};
use num_complex::Complex64;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Most witness points of all components about which something is asked.
pub const MOST_WITNESS_POINTS: usize = 100_000;
/// Multiple points in files of other programs are known to about so much.
const READ_ACCURACY: f64 = 1e-9;
/// Most coefficients of slices in one stage: 16 MiB of its message.
const MOST_COEFFICIENTS: usize = 1 << 20;
/// Most paths of one stage.
const MOST_PATHS: usize = 1 << 20;
/// A witness point that Newton's method moves farther than this, relative to its size, is none.
const MOVED: f64 = 1e-9;

/// Reason why a witness set is none of this system.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OperandError {
    /// A row of the slice, or a point, has too few or too many numbers, or one that is not finite.
    #[error("component {id}: {what} has {found} numbers; expected {expected} finite ones")]
    Shape {
        /// The component.
        id: ComponentId,
        /// Name of the part that is wrong.
        what: String,
        /// Number of numbers in the wrong part.
        found: usize,
        /// Number of numbers that the part must have.
        expected: usize,
    },
    /// The degree differs from the number of witness points.
    #[error("component {id}: degree {degree}, but {points} witness points")]
    Degree {
        /// The component.
        id: ComponentId,
        /// The degree that it says it has.
        degree: u64,
        /// Number of witness points.
        points: usize,
    },
    /// A point is not where equations and slice meet regularly.
    #[error(
        "component {id}: witness point {point} does not lie on the equations and the slice, or is not regular there"
    )]
    NotThere {
        /// The component.
        id: ComponentId,
        /// The point's place, from 1.
        point: usize,
    },
    /// No component of the system has this dimension.
    #[error("component {id}: components of this system have dimensions {least} to {most}")]
    Dimension {
        /// The component.
        id: ComponentId,
        /// The lowest that a component can have.
        least: u32,
        /// The highest that a component can have.
        most: u32,
    },
    /// The deflations of the component cannot be made.
    #[error(
        "component {id}: the ranks of its deflations are not those of such equations, or too many"
    )]
    Deflation {
        /// The component.
        id: ComponentId,
    },
    /// Two points are one.
    #[error("component {id}: two of its witness points are the same")]
    Twice {
        /// The component.
        id: ComponentId,
    },
    /// A component has another multiplicity than 1 where the equations are regular.
    #[error(
        "component {id}: multiplicity {multiplicity}, but the equations are regular at its points: 1"
    )]
    Multiplicity {
        /// The component.
        id: ComponentId,
        /// Multiplicity in the witness set.
        multiplicity: u64,
    },
    /// Two components have one name.
    #[error("component {0} is there twice")]
    Name(ComponentId),
    /// Too much to be asked about.
    #[error("{0} witness points; at most {MOST_WITNESS_POINTS}")]
    TooMany(usize),
}

impl OperandError {
    /// The component and the place of its point, from 0, where it is about one.
    pub fn place(&self) -> Option<(ComponentId, Option<usize>)> {
        match self {
            Self::NotThere { id, point } => Some((*id, Some(point - 1))),
            Self::Shape { id, .. }
            | Self::Degree { id, .. }
            | Self::Dimension { id, .. }
            | Self::Deflation { id }
            | Self::Twice { id }
            | Self::Multiplicity { id, .. }
            | Self::Name(id) => Some((*id, None)),
            Self::TooMany(_) => None,
        }
    }
}

/// One component.
#[derive(Clone, Debug)]
pub(crate) struct Operand {
    pub id: ComponentId,
    pub set: PureSet,
    /// A row for each dimension: the constant, then a coefficient for each unknown.
    pub slices: Vec<Vec<Complex64>>,
}

impl Operand {
    /// The component, where each of its points is one of the problem's.
    pub fn new(context: &mut ProblemContext<'_>, given: &WitnessSet) -> Result<Self, OperandError> {
        let id = given.id;
        let problem = context.problem;
        check_shape(problem, given)?;
        if !context.deflations.admits(problem, &given.deflation) {
            return Err(OperandError::Deflation { id });
        }
        let slices = problem.tracked_slices(&given.slice);
        let points: Vec<Vec<Complex64>> = given
            .points
            .iter()
            .map(|p| problem.to_unknowns(p))
            .collect();
        let on = (slices.as_slice(), given.deflation.as_slice());
        let refined = context.deflations.points_on(problem, on, &points);
        let mut refined_points: Vec<RefinedPoint> = Vec::with_capacity(points.len());
        for (place, (refined, start)) in refined.into_iter().zip(&points).enumerate() {
            let near = |r: &RefinedPoint| moved(r, start) < MOVED;
            let point = place + 1;
            refined_points.push(
                refined
                    .filter(near)
                    .ok_or(OperandError::NotThere { id, point })?,
            );
        }
        let apart = refined_points.iter().map(|p| (p.clone(), 1)).collect();
        if equal_ones_merged(apart).len() < refined_points.len() {
            return Err(OperandError::Twice { id });
        }
        if let (true, Some(scheme)) = (given.deflation.is_empty(), given.multiplicity.scheme)
            && scheme != 1
        {
            return Err(OperandError::Multiplicity {
                id,
                multiplicity: scheme,
            });
        }
        let set = PureSet {
            dimension: slices.len(),
            ranks: given.deflation.clone(),
            multiplicity: given.multiplicity.clone(),
            points: refined_points,
        };
        Ok(Self { id, set, slices })
    }

    pub fn dimension(&self) -> usize {
        self.slices.len()
    }

    pub fn degree(&self) -> usize {
        self.set.points.len()
    }

    /// Slices to which paths may lead in one stage, whose message holds their coefficients.
    pub fn most_targets(&self) -> usize {
        let coefficients = self.slices.iter().map(Vec::len).sum::<usize>().max(1);
        (MOST_COEFFICIENTS / coefficients)
            .min(MOST_PATHS / self.degree())
            .max(1)
    }

    /// Paths from the witness points to these slices, one set after the other.
    pub fn moved_to(
        &self,
        context: &mut ProblemContext<'_>,
        targets: Vec<Vec<Vec<Complex64>>>,
    ) -> Job {
        let homotopy = HomotopyKind::Parameter {
            start: self.slices.concat(),
            targets: targets.into_iter().map(|rows| rows.concat()).collect(),
        };
        let system = context.described(self.set.tracked());
        let tracking = &context.problem.tracking;
        Job::track(system, homotopy, &self.set.doubles(), tracking).ends_only()
    }

    /// The slices moved in parallel until they pass a point.
    pub fn slices_through(&self, point: &[Complex64]) -> Vec<Vec<Complex64>> {
        let through = |row: &Vec<Complex64>| {
            let terms = row[1..].iter().zip(point);
            let constant = -terms.map(|(c, x)| c * x).sum::<Complex64>();
            let rest = row[1..].iter().copied();
            std::iter::once(constant).chain(rest).collect()
        };
        self.slices.iter().map(through).collect()
    }
}

/// Components of one problem, in the unknowns that are tracked.
#[derive(Clone, Debug)]
pub(crate) struct TrackedSet {
    pub problem: Arc<Problem>,
    pub operands: Arc<Vec<Operand>>,
    pub deflations: Deflations,
}

impl TrackedSet {
    /// The components, each named once, where all of their points are the problem's.
    pub fn new(problem: Arc<Problem>, given: &[WitnessSet]) -> Result<Self, OperandError> {
        let points = given.iter().map(|set| set.points.len()).sum();
        if points > MOST_WITNESS_POINTS {
            return Err(OperandError::TooMany(points));
        }
        let mut names = BTreeSet::new();
        if let Some(twice) = given.iter().find(|set| !names.insert(set.id)) {
            return Err(OperandError::Name(twice.id));
        }
        let mut deflations = Deflations::default();
        let mut context = ProblemContext {
            problem: &problem,
            deflations: &mut deflations,
        };
        let operands = given.iter();
        let operands = operands.map(|set| Operand::new(&mut context, set));
        let operands = operands.collect::<Result<_, _>>()?;
        Ok(Self {
            problem,
            operands: Arc::new(operands),
            deflations,
        })
    }

    /// The problem and its deflations.
    pub fn context(&mut self) -> ProblemContext<'_> {
        ProblemContext {
            problem: &self.problem,
            deflations: &mut self.deflations,
        }
    }

    /// Paths from the witness points of a component to this slice.
    pub fn moved(&mut self, place: usize, slice: Vec<Vec<Complex64>>) -> Job {
        let operands = Arc::clone(&self.operands);
        operands[place].moved_to(&mut self.context(), vec![slice])
    }

    /// The points of a component to which these paths came on this slice, and how many points were lost. From one
    /// general slice to another all points of a component go apart.
    pub fn arrived(
        &mut self,
        place: usize,
        slice: &[Vec<Complex64>],
        job: &Job,
    ) -> (Vec<RefinedPoint>, u64) {
        let set = &self.operands[place].set;
        let variable_count = self.problem.variables();
        let (mut ends, _) = job.regular_ends();
        ends.iter_mut().for_each(|end| end.truncate(variable_count));
        let on = (slice, set.ranks.as_slice());
        let refined = self.deflations.points_on(&self.problem, on, &ends);
        let points_with_paths = refined.into_iter().flatten().map(|point| (point, 1));
        let points: Vec<RefinedPoint> = equal_ones_merged(points_with_paths.collect())
            .into_iter()
            .filter(|(_, paths)| *paths == 1)
            .map(|(point, _)| point)
            .collect();
        let lost = (set.points.len() - points.len()) as u64 + job.crossings_left();
        (points, lost)
    }
}

/// Distance of a refined point from its start, in the given unknowns, relative to its size or to 1.
fn moved(refined: &RefinedPoint, start: &[Complex64]) -> f64 {
    let coordinates = refined
        .point
        .iter()
        .map(cognate_continuation::bend::rounded);
    let (mut apart, mut size) = (0.0, 1.0f64);
    for (x, &y) in coordinates.zip(start) {
        apart += (x - y).norm_sqr();
        size += y.norm_sqr();
    }
    (apart / size).sqrt()
}

fn check_shape(problem: &Problem, given: &WitnessSet) -> Result<(), OperandError> {
    let (id, n) = (given.id, problem.variables());
    let wrong = |what: String, length: usize, expected: usize| OperandError::Shape {
        id,
        what,
        found: length,
        expected,
    };
    let dimension = id.dimension as usize;
    // Deflated equations may be regular on sets that are no components of the equations.
    let least = match given.deflation.is_empty() {
        true => n - problem.levels,
        false => 0,
    };
    let most = n - 1;
    if !(least..=most).contains(&dimension) {
        return Err(OperandError::Dimension {
            id,
            least: least as u32,
            most: most as u32,
        });
    }
    if given.slice.len() != dimension {
        return Err(wrong("its slice".into(), given.slice.len(), dimension));
    }
    let finite = |row: &[Complex64]| row.iter().all(|z| z.re.is_finite() && z.im.is_finite());
    for (k, row) in given.slice.iter().enumerate() {
        if row.len() != n + 1 || !finite(row) {
            let what = format!("row {} of its slice", k + 1);
            return Err(wrong(what, row.len(), n + 1));
        }
    }
    for (k, point) in given.points.iter().enumerate() {
        if point.len() != n || !finite(point) {
            let what = format!("witness point {}", k + 1);
            return Err(wrong(what, point.len(), n));
        }
    }
    if given.degree != given.points.len() as u64 || given.points.is_empty() {
        return Err(OperandError::Degree {
            id,
            degree: given.degree,
            points: given.points.len(),
        });
    }
    Ok(())
}

/// The deflations after which the equations are regular at a point of a slice, where it is known to some digits
/// only that equations and slice meet there; `None` where there are none.
pub(crate) fn ranks_at(
    problem: &Problem,
    slice: &[Vec<Complex64>],
    point: &[Complex64],
) -> Option<Vec<u32>> {
    let slices = problem.tracked_slices(slice);
    let dimension = slices.len();
    let end = SingularEnd {
        values: problem.to_unknowns(point),
        accuracy: READ_ACCURACY,
        paths: 1,
    };
    let mut deflations = Deflations::on_slices(slices);
    let regular_point = deflations.regular_point(problem, dimension, &end)?;
    Some(regular_point.ranks().to_vec())
}

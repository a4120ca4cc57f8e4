//! Positions of a mechanism for one target, counted so that nothing is missing unsaid.

use super::start_positions::in_order;
use cognate_kinematics::compile::{CLOSES, Configuration, Formulation, Lifted, Target};
use cognate_kinematics::mechanism::Mechanism;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;

/// Imaginary parts below this are none, where the equations do not tell conjugates.
const REAL: f64 = 1e-7;

/// Counts of one target: its paths, each counted once, and its positions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Regular positions, complex ones too.
    pub complex: u64,
    /// Regular positions that are real.
    pub real: u64,
    /// Regular positions that are proved to be real; `None` if proofs were not asked for.
    pub certified_real: Option<u64>,
    /// Real positions of which all joints are within their limits.
    pub within_limits: u64,
    /// Paths that end at isolated singular positions.
    pub singular: u64,
    /// Paths that end at infinity.
    pub at_infinity: u64,
    /// Paths that end on positive-dimensional sets.
    pub positive_dimensional: u64,
    /// Paths that end at solutions that are no positions.
    pub degenerate: u64,
    /// Paths whose end is not known.
    pub failed: u64,
}

impl Counts {
    /// Adds those of another target.
    pub fn add(&mut self, other: &Self) {
        self.complex += other.complex;
        self.real += other.real;
        self.certified_real = match (self.certified_real, other.certified_real) {
            (Some(a), Some(b)) => Some(a + b),
            (a, b) => a.or(b),
        };
        self.within_limits += other.within_limits;
        self.singular += other.singular;
        self.at_infinity += other.at_infinity;
        self.positive_dimensional += other.positive_dimensional;
        self.degenerate += other.degenerate;
        self.failed += other.failed;
    }

    /// All paths.
    pub fn sum(&self) -> u64 {
        self.complex
            + self.singular
            + self.at_infinity
            + self.positive_dimensional
            + self.degenerate
            + self.failed
    }
}

/// A position of a mechanism, with proofs and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// Values of joints and poses of bodies.
    pub configuration: Configuration,
    /// Whether it is real.
    pub is_real: bool,
    /// Whether it is proved to be there; `None` where that was not asked for.
    pub certified: Option<bool>,
    /// Joints beyond their limits; empty for complex positions.
    pub violated: Vec<String>,
    /// Condition number of the equations; of a real posture of an arm, of its screws: angles in radians, lengths in parts of
    /// the arm's size.
    pub condition: f64,
    /// Whether the equations are singular there; of an arm whose pose is special, whether the arm is.
    pub is_singular: bool,
    /// How many solutions of the equations, each counted as often as it is one, it stands for; 0 where it is one of a set.
    pub multiplicity: u64,
    /// Joints of an arm that can begin to move while the tool is at rest; empty where it is regular.
    pub dependent: Vec<String>,
    /// The variables of the equations, in their order; none where the position has a closed form.
    pub point: Vec<Complex64>,
}

impl Position {
    /// Whether all joints are within their limits; `None` for complex positions.
    pub fn within_limits(&self) -> Option<bool> {
        self.is_real.then_some(self.violated.is_empty())
    }
}

/// A set of postures of one pose, along which an arm moves while its tool is at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct PostureSet {
    /// Dimension of the set.
    pub dimension: usize,
    /// Names of the joints that move along the set.
    pub joints: Vec<String>,
    /// Difference between the largest and the least value of each, in radians or lengths; more than a turn where the joint
    /// turns on. Empty where the dimension is above 1.
    pub spans: Vec<(String, f64)>,
    /// Whether it comes back to where it begins.
    pub is_closed: bool,
    /// Number of paths that end on the set.
    pub paths: u64,
    /// One of its postures: within the limits where there is one, and of these the nearest to the values that are preferred,
    /// else the one whose values have the least sum of squares. It is among the positions, too.
    pub posture: Position,
}

/// How the positions of a target came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// By paths from a general member of the mechanism's family, or by a solve of the equations.
    Paths,
    /// By paths in the equations of an arm's loop.
    Loop,
    /// By a closed form of an arm, named by what of the arm gives it one.
    ClosedForm(&'static str),
    /// Multiplied out, leg by leg or row by row.
    Product,
    /// The mechanism could not be prepared.
    None,
}

impl Route {
    /// The route in words.
    pub fn name(&self) -> String {
        match self {
            Self::Paths => "paths".into(),
            Self::Loop => "paths of the arm's loop".into(),
            Self::ClosedForm(kind) => format!("closed form: {kind}"),
            Self::Product => "closed form".into(),
            Self::None => "none".into(),
        }
    }
}

/// The answer for one target.
#[derive(Clone, Debug, PartialEq)]
pub struct Postures {
    /// The given joint values, or the given pose.
    pub target: Target,
    /// Joints that are held for this target and not for others, with their values in radians or lengths.
    pub held: Vec<(String, f64)>,
    /// Paths of the solve, by how they ended.
    pub counts: Counts,
    /// Positions of the target: real ones first, in the order of their joint values.
    pub positions: Vec<Position>,
    /// Sets of postures of an arm.
    pub sets: Vec<PostureSet>,
    /// Whether nothing is in doubt.
    pub settled: bool,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// How the positions came about.
    pub route: Route,
}

impl Postures {
    /// Holds the counts against the number of positions of a general target, where it is known.
    pub fn compare(&mut self, here: Option<u64>) {
        let Some(here) = here.filter(|here| *here != self.counts.sum()) else {
            return;
        };
        self.settled = false;
        self.warnings.push(format!(
            "{} of {here} paths are accounted for",
            self.counts.sum()
        ));
    }
}

/// Joints of a real position that are beyond their limits.
pub fn violated(mechanism: &Mechanism, configuration: &Configuration) -> Vec<String> {
    let mut beyond = Vec::new();
    if mechanism.limits.is_empty() {
        return beyond;
    }
    let kinds = mechanism.values();
    for (name, value) in &configuration.values {
        let Some([low, high]) = mechanism.limits_of(name) else {
            continue;
        };
        let is_angle = kinds.iter().any(|(n, angle)| **n == **name && *angle);
        if !is_within([low, high], value.real(), is_angle) {
            beyond.push(name.to_string());
        }
    }
    beyond
}

/// Whether a joint's value is within limits. Angles come from (-pi, pi]; a joint with wider limits may stand a turn further.
pub fn is_within([low, high]: [f64; 2], x: f64, is_angle: bool) -> bool {
    // A bound is met up to rounding.
    let slack = 1e-9 * (1.0 + low.abs().max(high.abs()));
    let within = |x: f64| x >= low - slack && x <= high + slack;
    let turn = 2.0 * std::f64::consts::PI;
    let turns = if is_angle {
        (high.abs().max(low.abs()) / turn).ceil().min(1000.0) as i64 + 1
    } else {
        0
    };
    (-turns..=turns).any(|k| within(x + k as f64 * turn))
}

/// The answer for a target from positions of a closed form.
pub fn of_positions(
    mechanism: &Mechanism,
    target: &Target,
    configurations: Vec<Configuration>,
) -> Postures {
    let position = |configuration: Configuration| Position {
        violated: violated(mechanism, &configuration),
        configuration,
        is_real: true,
        certified: None,
        condition: 1.0,
        is_singular: false,
        multiplicity: 1,
        dependent: Vec::new(),
        point: Vec::new(),
    };
    let positions: Vec<Position> = configurations.into_iter().map(position).collect();
    let count = positions.len() as u64;
    Postures {
        target: target.clone(),
        held: Vec::new(),
        counts: Counts {
            complex: count,
            real: count,
            within_limits: positions.iter().filter(|p| p.violated.is_empty()).count() as u64,
            ..Counts::default()
        },
        positions,
        sets: Vec::new(),
        settled: true,
        warnings: Vec::new(),
        route: Route::Product,
    }
}

/// Whether a position is real: as the equations tell, else by its imaginary parts.
fn is_real(solution: &Solution, configuration: &Configuration) -> bool {
    solution.real.unwrap_or_else(|| {
        let joints = configuration.values.iter().map(|(_, v)| v.imaginary());
        let poses = configuration.bodies.iter().map(|(_, pose)| {
            let entries = pose.rotation.iter().flatten().chain(&pose.position);
            entries.map(|c| c.im.abs()).fold(0.0, f64::max)
        });
        joints.chain(poses).all(|imaginary| imaginary < REAL)
    })
}

/// The answer for a target from the solutions of its equations.
pub fn of_set(
    mechanism: &Mechanism,
    formulation: &dyn Formulation,
    system: &System,
    (target, parameters): (&Target, &[Complex64]),
    set: &SolutionSet,
    certify: bool,
) -> Postures {
    let mut counts = Counts {
        singular: set.paths.singular,
        at_infinity: set.paths.at_infinity,
        positive_dimensional: set.paths.positive_dimensional.unwrap_or(0),
        degenerate: set.paths.excess.unwrap_or(0) + set.paths.removed,
        failed: set.paths.failed + set.paths.undecided + set.paths.within_data_accuracy,
        certified_real: certify.then_some(0),
        ..Counts::default()
    };
    let mut positions = Vec::new();
    let mut closes = true;
    for solution in &set.solutions {
        let point = in_order(solution, system);
        let configuration = match formulation.lift(Some(target), parameters, &point) {
            Lifted::Position(configuration) => *configuration,
            Lifted::Degenerate(_) => {
                counts.degenerate += u64::from(!solution.singular);
                continue;
            }
            Lifted::Moving(_) => {
                counts.positive_dimensional += u64::from(!solution.singular);
                continue;
            }
        };
        if configuration.residual.is_nan() || configuration.residual > CLOSES {
            // A solution that does not close the mechanism is not a position, and the reason why it was found is not
            // known.
            closes = false;
            counts.failed += u64::from(!solution.singular);
            continue;
        }
        let is_real = is_real(solution, &configuration);
        let certificate = solution.certificate.as_ref();
        let violated = if is_real {
            violated(mechanism, &configuration)
        } else {
            Vec::new()
        };
        if !solution.singular {
            counts.complex += 1;
            counts.real += u64::from(is_real);
            counts.within_limits += u64::from(is_real && violated.is_empty());
            let proved = certificate.is_some_and(|c| c.certified && c.real == Some(true));
            counts.certified_real = counts.certified_real.map(|n| n + u64::from(proved));
        }
        positions.push(Position {
            configuration,
            is_real,
            certified: certify.then(|| certificate.is_some_and(|c| c.certified)),
            violated,
            condition: solution.condition,
            is_singular: solution.singular,
            multiplicity: solution.multiplicity,
            dependent: Vec::new(),
            point,
        });
    }
    sort(&mut positions);
    Postures {
        target: target.clone(),
        held: Vec::new(),
        settled: set.settled() && closes,
        counts,
        positions,
        sets: Vec::new(),
        warnings: Vec::new(),
        route: Route::Paths,
    }
}

/// Real positions first, in the order of their distance from these joint values.
pub fn sort_by_distance(positions: &mut [Position], near: &[f64]) {
    positions.sort_by(|a, b| {
        let key = |position: &Position| (!position.is_real, distance(position, near));
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
}

/// The largest difference of a joint's value from these, angles by the shorter way.
pub fn distance(position: &Position, near: &[f64]) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    let values = position.configuration.values.iter().zip(near);
    let apart = values.map(|((_, value), near)| {
        let apart = (value.real() - near).abs();
        match value {
            JointValue::Turn(..) => (apart - (apart / turn).round() * turn).abs(),
            JointValue::Shift(_) => apart,
        }
    });
    apart.fold(0.0, f64::max)
}

/// Real positions first, regular ones before singular ones, then in the order of their joint values.
pub fn sort(positions: &mut Vec<Position>) {
    let key = |p: Position| {
        let values = p.configuration.values.iter().map(|(_, v)| v.rank());
        ((!p.is_real, p.is_singular), values.collect::<Vec<f64>>(), p)
    };
    let mut keyed: Vec<_> = positions.drain(..).map(key).collect();
    keyed.sort_by(|(kind, values, _), (other_kind, others, _)| {
        let differ = || {
            let both = values.iter().zip(others);
            both.map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne())
        };
        kind.cmp(other_kind)
            .then_with(|| differ().unwrap_or(std::cmp::Ordering::Equal))
    });
    positions.extend(keyed.into_iter().map(|(_, _, position)| position));
}

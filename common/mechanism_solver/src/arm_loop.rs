//! ArmLoop: the equations of an arm's whole loop, followed to poses at which the equations of its family do not decide.

use super::followed_paths::FollowedPaths;
use super::start_positions::observed;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::{ClosingOptions, KnownSolutions, SolveMethod, TrackingOptions};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_family::PreparedFamily;
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::tracker::settings::Settings;
use cognate_kinematics::compile::closure::Closure;
use cognate_kinematics::compile::{ArmFormulation, CLOSES};
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bits in which paths are followed at most at first: a pose has those of doubles, and what more bits would tell apart is
/// decided by the arm.
const PRECISION: u32 = 53;
/// Bits in which paths are followed at most with care, no further than what the arm itself decides better: double-doubles.
const CAREFUL_PRECISION: u32 = 106;
/// Steps of a path at most at its first attempt with care; a regular one takes some hundred.
const CAREFUL_STEPS: u32 = 500;

/// The loop of an arm with its postures at a general complex pose.
pub struct ArmLoop {
    closure: Closure,
    system: System,
    start: Arc<StoredPoints>,
    options: SolveOptions,
    family: PreparedFamily,
    /// The paths from the general pose to others.
    paths: FollowedPaths,
}

/// Where the path of one posture ends.
#[derive(Clone, Debug)]
pub struct End {
    /// Why it ended.
    pub outcome: PathOutcome,
    /// Values of the joints, complex ones; at infinity they mean nothing.
    pub values: Vec<JointValue>,
    /// Whether the posture is proved to be there and real; `None` where that was not asked for.
    pub proved: Option<Proof>,
}

/// Result of the certification of a posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proof {
    /// Exactly one solution is near.
    pub exists: bool,
    /// The solution is real.
    pub is_real: bool,
}

impl ArmLoop {
    /// From the postures at a general pose: solutions of another formulation's equations at these parameters. An error
    /// where one of them is no posture.
    pub fn new(
        arm: &dyn ArmFormulation,
        parameters: &[Complex64],
        points: &StoredPoints,
        (seed, certify): (u64, bool),
    ) -> Result<Self, String> {
        let chain = &arm.six_joint_arm().arm;
        let closure = Closure::of(chain).ok_or("the arm has not six free joints")?;
        let mut general = None;
        let mut coordinates = Vec::new();
        for k in 0..points.len() {
            let (pose, values) = arm
                .posture(parameters, points.point(k))
                .ok_or("a posture at a general pose leaves a joint open")?;
            let growth = values.iter().map(size).fold(1.0, f64::max);
            let gap = chain.tool_pose(&values).distance(&pose, chain.size());
            if gap.is_nan() || gap > CLOSES * growth {
                return Err("a posture at a general pose does not close its loop".into());
            }
            coordinates.extend(closure.point(&values));
            general = Some(pose);
        }
        let general = general.ok_or("the arm has no posture at a general pose")?;
        let system = closure.equations().system("the arm's loop");
        let system = system.map_err(|error| error.to_string())?;
        let options = SolveOptions {
            seed,
            method: SolveMethod::Given(KnownSolutions {
                points: None,
                parameters: Some(closure.parameters(&general)),
            }),
            closings: ClosingOptions {
                certify,
                no_exact_count: true,
                ..ClosingOptions::default()
            },
            tracking: of_settings(Settings {
                max_precision_bits: CAREFUL_PRECISION,
                max_steps: CAREFUL_STEPS,
                ..Settings::default()
            }),
            ..SolveOptions::default()
        };
        let quick = SolveOptions {
            tracking: of_settings(Settings {
                max_precision_bits: PRECISION,
                ..Settings::default()
            }),
            ..options.clone()
        };
        let start = Arc::new(StoredPoints {
            dimension: system.variables.len(),
            coordinates,
        });
        let target = closure.parameters(&Pose::IDENTITY);
        let paths = FollowedPaths::new(&system, &quick, &start, target)?;
        Ok(Self {
            start,
            closure,
            system,
            options,
            family: PreparedFamily::default(),
            paths,
        })
    }

    /// The loop.
    pub fn closure(&self) -> &Closure {
        &self.closure
    }

    /// The equations of the loop; their parameters are a pose.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Where the paths of all postures end at a pose, each followed once; in the order of the postures at the general one.
    pub fn ends(&self, pose: &Pose) -> Result<Vec<End>, String> {
        let targets = vec![self.closure.parameters(pose)];
        let results = self.paths.follow(targets, &self.family)?;
        let end = |result| self.end(&self.paths.system, result, None);
        Ok(results.iter().map(end).collect())
    }

    fn end(&self, tracked: &System, result: &PathResult, proved: Option<Proof>) -> End {
        let point = affine(result.endpoint.to_double());
        End {
            outcome: result.outcome,
            values: self.closure.values(&tracked.scaling.to_variables(&point)),
            proved,
        }
    }

    /// Ends of the paths of all postures at a pose. Paths that meet are followed again with more care, with proofs if
    /// they are asked for.
    pub fn careful_ends(&self, pose: &Pose) -> Result<Vec<End>, String> {
        let options = SolveOptions {
            target_parameters: vec![self.closure.parameters(pose)],
            ..self.options.clone()
        };
        let mut last: BTreeMap<u64, PathResult> = BTreeMap::new();
        let mut observer = |results: &[ItemResult]| {
            for result in results {
                if let ItemResult::Track(path) = result {
                    last.insert(path.origin.0, path.clone());
                }
            }
        };
        let start = Some(&self.start);
        let (sets, tracked) = observed(&self.system, &options, start, &self.family, &mut observer)?;
        let set = sets.first().ok_or("the pose was not solved")?;
        if last.len() != self.start.len() {
            return Err(format!(
                "{} of {} paths have an end",
                last.len(),
                self.start.len()
            ));
        }
        let proof = |path: u64| {
            let mut solutions = set.solutions.iter();
            let solution = solutions.find(|solution| solution.paths.contains(&path))?;
            let certificate = solution.certificate.as_ref()?;
            Some(Proof {
                exists: certificate.certified,
                is_real: certificate.certified && certificate.real == Some(true),
            })
        };
        let none = Proof {
            exists: false,
            is_real: false,
        };
        let certify = options.closings.certify;
        let end = |(path, result): (u64, PathResult)| {
            let proved = certify.then(|| proof(path).unwrap_or(none));
            self.end(&tracked, &result, proved)
        };
        Ok(last.into_iter().map(end).collect())
    }
}

fn of_settings(settings: Settings) -> TrackingOptions {
    TrackingOptions {
        settings,
        ..TrackingOptions::default()
    }
}

/// The values of the variables at a point with one homogenising coordinate, the first.
fn affine(point: &[Complex64]) -> Vec<Complex64> {
    match point {
        [] => Vec::new(),
        [first, rest @ ..] => rest.iter().map(|x| x / first).collect(),
    }
}

/// The largest modulus of a joint value's numbers.
pub fn size(value: &JointValue) -> f64 {
    match value {
        JointValue::Turn(c, s) => c.norm_sqr().max(s.norm_sqr()).sqrt(),
        JointValue::Shift(d) => d.norm_sqr().sqrt(),
    }
}

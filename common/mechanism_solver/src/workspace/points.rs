//! Points: at which points a mechanism's output can be, and in how many postures.
//!
//! A point of a chain is a target of position, one of a platform a pose of given orientation. The output point of a planar linkage
//! is joined to the ground at the point; the assemblies of the closed linkage are its postures.

use super::arms::Arms;
use super::planar_chain::PlanarChain;
use super::reach::{MOST_JOINTS, Ring, reaches, ring};
use super::reached_point::ReachedPoint;
use super::two_links;
use crate::parallel;
use crate::preparation::AnswerOptions;
use crate::prepared_mechanism::PreparedMechanism;
use cognate_kinematics::compile::{Problem, Question, Target};
use cognate_kinematics::mechanism::exact::{Angle, Number};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::task::Task;
use cognate_kinematics::mechanism::{
    Body, Joint, JointKind, Linkage, Mechanism, MechanismError, Side, Space, Vector,
};
use cognate_kinematics::plane::modulus;
use num_complex::Complex64;

/// The name of the joint that holds the output point of a linkage at a point.
const HELD: &str = "output held at the point";

/// Reachability of each of the points; in the plane the third coordinate is 0.
pub fn workspace(
    mechanism: &Mechanism,
    points: &[[f64; 3]],
    orientation: Option<Angle>,
    options: &AnswerOptions,
) -> Result<Vec<ReachedPoint>, MechanismError> {
    let question = Question::of(Problem::Inverse);
    let poses = |rotation: Pose| {
        let target = |p: &[f64; 3]| {
            Target::Pose(Pose {
                position: p.map(Complex64::from),
                ..rotation
            })
        };
        points.iter().map(target).collect::<Vec<_>>()
    };
    let answered = |question: &Question, targets: &[Target]| {
        let prepared = PreparedMechanism::new(mechanism, question, options)?;
        let answers = prepared.solve(targets)?;
        Ok(answers.iter().map(ReachedPoint::of_postures).collect())
    };
    match (&mechanism.body, orientation) {
        (Body::Platform(platform), None) if platform.fixed_orientation => {
            answered(&question, &poses(Pose::IDENTITY))
        }
        (Body::Platform(platform), Some(angle))
            if !platform.fixed_orientation && mechanism.space == Space::Planar =>
        {
            let [c, s] = angle.direction.map(Complex64::from);
            answered(&question, &poses(Pose::about_z(c, s)))
        }
        (Body::Chain(chain), None) if !chain.closed && chain.joints.len() == 3 => {
            let question = Question {
                task: Task::Position,
                ..question
            };
            let task = |target: Target| match target {
                Target::Pose(pose) => Task::Position.completed(&pose).map(Target::Pose),
                inputs @ Target::Inputs(_) => Ok(inputs),
            };
            let targets: Result<Vec<_>, _> = poses(Pose::IDENTITY).into_iter().map(task).collect();
            let targets = targets.map_err(|message| mechanism.error(message))?;
            answered(&question, &targets)
        }
        (Body::Linkage(linkage), None) if mechanism.space == Space::Planar => {
            let threads = parallel::threads(options.threads);
            let each = |k: usize| of_linkage(mechanism, linkage, points[k], options);
            parallel::map(points.len(), threads, each)
                .into_iter()
                .collect()
        }
        _ => Err(mechanism.error(
            "not in this version: points of planar linkages, of chains of three joints, of platforms that keep their orientation, \
             and with --orientation of planar platforms",
        )),
    }
}

/// A point of the output of a planar linkage.
fn of_linkage(
    mechanism: &Mechanism,
    linkage: &Linkage,
    point: [f64; 3],
    options: &AnswerOptions,
) -> Result<ReachedPoint, MechanismError> {
    let output = mechanism.output.as_ref();
    let place = output.and_then(|o| o.point.clone());
    let (Some(output), Some(place)) = (output, place) else {
        return Err(mechanism.error("the output is no point: \"output\": {\"link\", \"point\"}"));
    };
    let link = linkage.links.iter().position(|l| *l == output.link);
    let link = link.ok_or_else(|| mechanism.error(format!("there is no link {}", output.link)))?;
    let in_plane = [point[0], point[1]];
    let chain = PlanarChain::open(mechanism, linkage, link, &place);
    let two_links = chain
        .as_ref()
        .and_then(|chain| two_links::reached(chain, in_plane));
    if let Some(answer) = two_links {
        return Ok(answer);
    }
    if let Some(chain) = chain.filter(|chain| chain.turns.len() != 2) {
        return Ok(of_chain(&chain, in_plane));
    }
    let arms = Arms::of(mechanism, linkage, (link, &place));
    let arms = arms.filter(|arms| mechanism.limits_of(&arms.between).is_none());
    if let Some(answer) = arms.and_then(|arms| arms.reached(in_plane)) {
        return Ok(answer);
    }
    held(mechanism, linkage, (link, &place), (point, options))
}

/// A point of the output of a planar linkage with two freedoms: the assemblies of the linkage of which the output is joined to
/// the ground there.
fn held(
    mechanism: &Mechanism,
    linkage: &Linkage,
    (link, place): (usize, &Vector),
    (point, options): ([f64; 3], &AnswerOptions),
) -> Result<ReachedPoint, MechanismError> {
    if mechanism.expected_mobility() != Some(2) {
        return Err(mechanism.error(
            "not in this version: the workspace of a planar linkage with loops of which the freedoms are not two",
        ));
    }
    let side = |point: [Number; 3]| Side {
        point,
        axis: [0, 0, 1].map(Number::integer),
        second: None,
    };
    let mut held = linkage.clone();
    held.joints.push(Joint {
        name: HELD.into(),
        kind: JointKind::R,
        links: [linkage.ground, link],
        sides: [side(point.map(Number::of_double)), side(place.clone())],
    });
    let closed = Mechanism {
        body: Body::Linkage(held),
        inputs: Vec::new(),
        output: None,
        ..mechanism.clone()
    };
    let question = Question {
        inputs: Some(Vec::new()),
        ..Question::of(Problem::Forward)
    };
    let prepared = PreparedMechanism::new(&closed, &question, options)?;
    let answers = prepared.solve(&[Target::Inputs(Vec::new())])?;
    let answer = answers.first().map(ReachedPoint::of_postures);
    answer.ok_or_else(|| mechanism.error("no answer for a point"))
}

/// A point of a planar chain of one joint, or of more than two: whether it is in the ring that the chain reaches.
fn of_chain(chain: &PlanarChain, point: [f64; 2]) -> ReachedPoint {
    let point = Complex64::new(point[0], point[1]);
    match ring(&chain.free().lengths(), modulus(point - chain.base)) {
        Ring::Border => {
            ReachedPoint::in_doubt("in doubt: the point is at the border of the reach".into())
        }
        Ring::Outside => ReachedPoint::counted(0, 0),
        Ring::Inside if !chain.has_limits() => ReachedPoint::uncounted(true),
        Ring::Inside if chain.turns.len() > MOST_JOINTS => ReachedPoint::uncounted_in_doubt(),
        Ring::Inside => match reaches(chain, point) {
            Some(within_limits) => ReachedPoint::uncounted(within_limits),
            None => ReachedPoint::uncounted_in_doubt(),
        },
    }
}

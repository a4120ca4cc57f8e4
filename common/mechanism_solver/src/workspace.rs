//! Workspace: at which points a mechanism's output can be, and in how many postures.
//!
//! A point of a chain is a target of position, one of a platform a pose of given orientation. The output point of a planar linkage
//! is joined to the ground at the point; the assemblies of the closed linkage are its postures.

use super::postures::Postures;
use super::preparation::AnswerOptions;
use super::prepared_mechanism::PreparedMechanism;
use cognate_kinematics::compile::{Problem, Question, Target};
use cognate_kinematics::mechanism::exact::{Angle, Number};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::task::Task;
use cognate_kinematics::mechanism::{
    Body, Joint, JointKind, Linkage, Mechanism, MechanismError, Side, Space,
};
use cognate_kinematics::plane::modulus;
use num_complex::Complex64;

/// The name of the joint that holds the output point of a linkage at a point.
const HELD: &str = "output held at the point";
/// A distance this near to the border of a ring, in parts of its radius, is in doubt.
const BORDER: f64 = 1e-12;

/// What a point is for the output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReachedPoint {
    /// Whether the output can be there, whatever the limits; `None` where that is in doubt.
    pub reachable: Option<bool>,
    /// Real postures; `None` where they are infinitely many, or in doubt.
    pub postures: Option<u64>,
    /// Real postures within all limits; `None` likewise.
    pub within_limits: Option<u64>,
    /// What is in doubt.
    pub doubt: Option<String>,
    /// What is in doubt about limits alone: an answer that leaves limits aside does not depend on it.
    pub doubt_of_limits: Option<String>,
}

impl ReachedPoint {
    /// What is in doubt, of limits too where `with_limits`.
    pub fn doubts(&self, with_limits: bool) -> impl Iterator<Item = &str> {
        let limits = self.doubt_of_limits.as_deref().filter(|_| with_limits);
        self.doubt.as_deref().into_iter().chain(limits)
    }

    fn in_doubt(doubt: String) -> Self {
        Self {
            reachable: None,
            postures: None,
            within_limits: None,
            doubt: Some(doubt),
            doubt_of_limits: None,
        }
    }

    fn of(answer: &Postures) -> Self {
        if !answer.settled {
            let mut doubt = "in doubt: not every path is accounted for".to_owned();
            for warning in &answer.warnings {
                doubt = format!("{doubt}; {warning}");
            }
            return Self::in_doubt(doubt);
        }
        let real = || answer.positions.iter().filter(|p| p.is_real);
        let is_finite = answer.counts.positive_dimensional == 0 && answer.sets.is_empty();
        let within = real().filter(|p| p.violated.is_empty()).count() as u64;
        if !is_finite && real().next().is_none() {
            return Self::in_doubt(
                "in doubt: a set of complex postures makes the point, of which no real one is known".into(),
            );
        }
        Self {
            reachable: Some(real().next().is_some()),
            postures: is_finite.then_some(real().count() as u64),
            within_limits: is_finite.then_some(within),
            doubt: None,
            doubt_of_limits: None,
        }
    }

    /// Whether it can be reached within limits.
    pub fn reachable_within_limits(&self) -> Option<bool> {
        match (self.reachable, self.within_limits) {
            (Some(false), _) => Some(false),
            (_, within) => within.map(|n| n > 0),
        }
    }
}

/// What each of the points is; in the plane the third coordinate is 0.
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
        Ok(answers.iter().map(ReachedPoint::of).collect())
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
            let each = points.iter().map(|p| of_linkage(mechanism, linkage, *p, options));
            each.collect()
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
    if let Some(lengths) = lengths_of_chain(linkage, link, &place)
        && lengths.links.len() != 2
    {
        return Ok(in_ring(&lengths, point, !mechanism.limits.is_empty()));
    }
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
        sides: [side(point.map(Number::of_double)), side(place)],
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
    let answer = answers.first().map(ReachedPoint::of);
    answer.ok_or_else(|| mechanism.error("no answer for a point"))
}

/// Lengths of a chain of turns in series from the ground to a point.
struct ChainLengths {
    base: [f64; 2],
    links: Vec<f64>,
}

fn lengths_of_chain(linkage: &Linkage, link: usize, place: &[Number; 3]) -> Option<ChainLengths> {
    let all_turn = linkage.joints.iter().all(|j| j.kind == JointKind::R);
    if !all_turn || !linkage.at_home || linkage.joints.len() + 1 != linkage.links.len() {
        return None;
    }
    let point = |p: &[Number; 3]| [p[0].to_f64(), p[1].to_f64()];
    let (mut points, mut at, mut used) = (vec![point(place)], link, Vec::new());
    while at != linkage.ground {
        let toward = linkage
            .joints
            .iter()
            .enumerate()
            .find(|(j, joint)| !used.contains(j) && joint.links.contains(&at));
        let (j, joint) = toward?;
        used.push(j);
        points.push(point(&joint.sides[0].point));
        at = joint.links[usize::from(joint.links[0] == at)];
    }
    let apart = |p: [f64; 2], q: [f64; 2]| modulus(Complex64::new(p[0] - q[0], p[1] - q[1]));
    let length = |pair: &[[f64; 2]]| apart(pair[0], pair[1]);
    (used.len() == linkage.joints.len()).then(|| ChainLengths {
        links: points.windows(2).map(length).collect(),
        base: points[points.len() - 1],
    })
}

/// Whether a point is in the ring that a planar chain reaches.
fn in_ring(chain: &ChainLengths, point: [f64; 3], has_limits: bool) -> ReachedPoint {
    let sum: f64 = chain.links.iter().sum();
    let largest = chain.links.iter().copied().fold(0.0, f64::max);
    let inner = (2.0 * largest - sum).max(0.0);
    let distance = modulus(Complex64::new(
        point[0] - chain.base[0],
        point[1] - chain.base[1],
    ));
    let near = |radius: f64| (distance - radius).abs() <= BORDER * sum;
    if near(sum) || (inner > 0.0 && near(inner)) {
        return ReachedPoint::in_doubt("in doubt: the point is at the border of the reach".into());
    }
    let reachable = distance < sum && distance > inner;
    let none = (!reachable).then_some(0);
    ReachedPoint {
        reachable: Some(reachable),
        postures: none,
        within_limits: none,
        doubt: None,
        doubt_of_limits: (has_limits && reachable).then(|| {
            "in doubt: whether one of infinitely many postures is within limits is not in this version".into()
        }),
    }
}

//! Positions of a mechanism as JSON; angles in radians.

use super::listing::{Finished, Listing, Sink};
use super::view::{View, digest, snapped_json};
use crate::error::ClientError;
use cognate_kinematics::compile::{Problem, Target};
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Body, Space};
use cognate_kinematics::real_arm::{RealArm, Regularity};
use cognate_mechanism_solver::postures::{Counts, Position, PostureSet, Postures};
use num_complex::Complex64;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// A complex number as a pair.
type Pair = [f64; 2];

/// A pose as it is written: fields of every object are in the order of their names.
#[derive(Serialize)]
#[serde(untagged)]
enum PoseText {
    Plane {
        angle: f64,
        position: [f64; 2],
    },
    Space {
        position: [f64; 3],
        quaternion: [f64; 4],
    },
    Complex {
        position: [Pair; 3],
        rotation: [[Pair; 3]; 3],
    },
}

impl PoseText {
    fn real(view: &View<'_>, pose: &Pose) -> Self {
        let [x, y, z] = pose.position.map(|c| c.re);
        match view.mechanism.space {
            Space::Planar => Self::Plane {
                angle: JointValue::Turn(pose.rotation[0][0], pose.rotation[1][0]).real(),
                position: [x, y],
            },
            _ => Self::Space {
                position: [x, y, z],
                quaternion: pose.quaternion(),
            },
        }
    }

    fn of(view: &View<'_>, pose: &Pose, is_real: bool) -> Self {
        let pair = |c: Complex64| [c.re, c.im];
        match is_real {
            true => Self::real(view, pose),
            false => Self::Complex {
                position: pose.position.map(pair),
                rotation: pose.rotation.map(|row| row.map(pair)),
            },
        }
    }
}

/// The value of a joint as it is written.
#[derive(Serialize)]
#[serde(untagged)]
enum ValueText {
    Real(f64),
    Turn { cos: Pair, sin: Pair },
    Shift { shift: Pair },
}

impl ValueText {
    fn of(value: &JointValue, is_real: bool) -> Self {
        let pair = |c: Complex64| [c.re, c.im];
        match *value {
            _ if is_real => Self::Real(value.real()),
            JointValue::Turn(c, s) => Self::Turn {
                cos: pair(c),
                sin: pair(s),
            },
            JointValue::Shift(d) => Self::Shift { shift: pair(d) },
        }
    }
}

/// An object whose fields are named by a mechanism, in the order of their names.
struct Named<'a, T>(Vec<(&'a str, T)>);

impl<'a, T> Named<'a, T> {
    fn of(fields: impl Iterator<Item = (&'a str, T)>) -> Self {
        let mut fields: Vec<(&str, T)> = fields.collect();
        fields.sort_by_key(|(name, _)| *name);
        Self(fields)
    }
}

impl<T: Serialize> Serialize for Named<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// A position as it is written.
#[derive(Serialize)]
struct PositionText<'a> {
    certified: Option<bool>,
    condition: Option<f64>,
    dependent: &'a [String],
    /// Least singular value of the screws of an arm with six joints, angles in radians and lengths in parts of its size.
    distance_to_singularity: Option<f64>,
    inputs: Named<'a, ValueText>,
    joints: Named<'a, ValueText>,
    links: Named<'a, PoseText>,
    multiplicity: Option<u64>,
    output: Option<PoseText>,
    real: bool,
    residual: f64,
    /// Sign of the determinant of the screws of an arm with six joints; `None` where it is in doubt.
    sign: Option<i8>,
    singular: bool,
    violated: &'a [String],
    within_limits: Option<bool>,
}

impl<'a> PositionText<'a> {
    fn of(view: &View<'_>, position: &'a Position) -> Self {
        let is_real = position.is_real;
        let inverse = view.problem == Problem::Inverse;
        let inputs = &view.preparation.inputs;
        // Inverse: every joint is an input. Forward: the given joints, and the others.
        let is_input = |name: &str| inverse || inputs.iter().any(|input| input == name);
        let values = |wanted: bool| {
            let values = position.configuration.values.iter();
            let values = values.filter(move |(name, _)| is_input(name) == wanted);
            Named::of(values.map(|(name, value)| (&**name, ValueText::of(value, is_real))))
        };
        let bodies = position.configuration.bodies.iter();
        let bodies = bodies.map(|(name, pose)| (&**name, PoseText::of(view, pose, is_real)));
        let output = position.configuration.output.as_ref();
        let regularity = regularity(view, position);
        let sign = regularity.map(|regularity| regularity.sign);
        Self {
            certified: position.certified,
            condition: position.condition.is_finite().then_some(position.condition),
            dependent: &position.dependent,
            distance_to_singularity: regularity.map(|r| r.least_singular_value),
            inputs: values(true),
            joints: values(false),
            links: Named::of(bodies),
            multiplicity: (position.multiplicity > 0).then_some(position.multiplicity),
            output: output.map(|pose| PoseText::of(view, pose, is_real)),
            real: is_real,
            residual: position.configuration.residual,
            sign: sign.filter(|sign| *sign != 0 && !position.is_singular),
            singular: position.is_singular,
            violated: &position.violated,
            within_limits: position.within_limits(),
        }
    }
}

/// How far a real posture of an arm with six joints is from a singular one; `None` for other mechanisms.
fn regularity(view: &View<'_>, position: &Position) -> Option<Regularity> {
    let Body::Chain(chain) = &view.mechanism.body else {
        return None;
    };
    if chain.closed || !position.is_real || view.problem != Problem::Inverse {
        return None;
    }
    let values = &position.configuration.values;
    let value = |name: &str| values.iter().find(|(other, _)| **other == *name);
    let joints = chain.joints.iter();
    let values: Option<Vec<JointValue>> = joints
        .map(|joint| value(&joint.name).map(|(_, value)| *value))
        .collect();
    RealArm::of(chain).regularity(&values?)
}

/// A set of postures as it is written.
#[derive(Serialize)]
struct SetText<'a> {
    closed: bool,
    dimension: usize,
    joints: &'a [String],
    paths: u64,
    posture: PositionText<'a>,
    spans: Named<'a, f64>,
}

impl<'a> SetText<'a> {
    fn of(view: &View<'_>, set: &'a PostureSet) -> Self {
        Self {
            closed: set.is_closed,
            dimension: set.dimension,
            joints: &set.joints,
            paths: set.paths,
            posture: PositionText::of(view, &set.posture),
            spans: Named::of(set.spans.iter().map(|(joint, span)| (&**joint, *span))),
        }
    }
}

/// Numbers of paths as they are written.
#[derive(Serialize)]
struct CountsText {
    at_infinity: u64,
    certified_real: Option<u64>,
    complex: u64,
    degenerate: u64,
    failed: u64,
    positive_dimensional: u64,
    real: u64,
    singular: u64,
    within_limits: u64,
}

impl CountsText {
    fn of(counts: &Counts) -> Self {
        Self {
            at_infinity: counts.at_infinity,
            certified_real: counts.certified_real,
            complex: counts.complex,
            degenerate: counts.degenerate,
            failed: counts.failed,
            positive_dimensional: counts.positive_dimensional,
            real: counts.real,
            singular: counts.singular,
            within_limits: counts.within_limits,
        }
    }
}

/// The ends of all paths together, each counted once; where there are no paths, the solutions that paths would end at.
#[derive(Serialize)]
struct PathsText {
    at_infinity: u64,
    degenerate: u64,
    failed: u64,
    finite: u64,
    positive_dimensional: u64,
    singular: u64,
    total: u64,
}

impl PathsText {
    fn of(counts: &Counts) -> Self {
        Self {
            at_infinity: counts.at_infinity,
            degenerate: counts.degenerate,
            failed: counts.failed,
            finite: counts.complex,
            positive_dimensional: counts.positive_dimensional,
            singular: counts.singular,
            total: counts.sum(),
        }
    }
}

/// Given values of a target.
#[derive(Serialize)]
#[serde(untagged)]
enum GivenText<'a> {
    Pose(PoseText),
    Inputs(Named<'a, f64>),
}

/// A target's answer as it is written.
#[derive(Serialize)]
struct TargetText<'a> {
    configurations: CountsText,
    given: GivenText<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    held: Option<Named<'a, f64>>,
    index: u64,
    route: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    sets: Option<Vec<SetText<'a>>>,
    settled: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    solutions: Option<Vec<PositionText<'a>>>,
    warnings: &'a [String],
}

impl<'a> TargetText<'a> {
    /// Without positions.
    fn counts(view: &View<'a>, index: u64, target: &'a Postures) -> Self {
        let names = view.preparation.inputs.iter();
        let named = |values: &[f64]| {
            let pairs = names.zip(values);
            Named::of(pairs.map(|(name, value)| (name.as_str(), *value)))
        };
        let held = target.held.iter();
        let held = held.map(|(joint, value)| (&**joint, *value));
        Self {
            configurations: CountsText::of(&target.counts),
            given: match &target.target {
                Target::Pose(pose) => GivenText::Pose(PoseText::real(view, pose)),
                Target::Inputs(values) => GivenText::Inputs(named(values)),
            },
            held: (!target.held.is_empty()).then(|| Named::of(held)),
            index,
            route: target.route.name(),
            sets: None,
            settled: target.settled,
            solutions: None,
            warnings: &target.warnings,
        }
    }

    fn of(view: &View<'a>, index: u64, target: &'a Postures) -> Self {
        let listed = target.positions.iter().filter(|p| view.lists(p));
        let solutions = listed.map(|position| PositionText::of(view, position));
        let sets = target.sets.iter().map(|set| SetText::of(view, set));
        Self {
            sets: Some(sets.collect()),
            solutions: Some(solutions.collect()),
            ..Self::counts(view, index, target)
        }
    }

    fn text(&self) -> String {
        serde_json::to_string(self).expect(WRITABLE)
    }

    fn value(&self) -> Value {
        serde_json::to_value(self).expect(WRITABLE)
    }
}

/// Message of a panic that does not occur: all keys that are written here are names.
const WRITABLE: &str = "numbers and names can be written as JSON";

/// A position.
pub(super) fn position_json(view: &View<'_>, position: &Position) -> Value {
    serde_json::to_value(PositionText::of(view, position)).expect(WRITABLE)
}

/// A target's answer on a line of a stream, whose number it has.
pub fn line(view: &View<'_>, number: u64, answer: &Postures) -> Value {
    let mut value = TargetText::of(view, 0, answer).value();
    if let Some(fields) = value.as_object_mut() {
        fields.remove("index");
        fields.insert("line".into(), json!(number));
    }
    value
}

/// A target's answer without its positions.
pub(super) fn target_counts(view: &View<'_>, index: u64, target: &Postures) -> Value {
    TargetText::counts(view, index, target).value()
}

/// Facts about a mechanism that stand at the head of its answers.
pub fn mechanism(view: &View<'_>, content: &[u8]) -> Value {
    let (mechanism, prepared) = (view.mechanism, view.preparation);
    let from = if prepared.from_cache { "cache" } else { "now" };
    json!({
        "name": mechanism.name,
        "digest": digest(content),
        "space": mechanism.space.name(),
        "family": {
            "name": prepared.family.name,
            "expected": prepared.family.expected,
            "here": prepared.here,
            "reason": (!prepared.reason.is_empty()).then_some(&prepared.reason),
            "prepared": prepared.here.map(|_| from),
            "source": prepared.family.source,
        },
        "representation": prepared.family.representation,
        "symmetry": 1,
        "snapped": snapped_json(mechanism),
    })
}

/// The answer as one JSON object, with a line for each target.
pub struct Object<'a> {
    view: View<'a>,
    sink: Sink,
    with_positions: bool,
    is_first: bool,
    /// The counts of the targets that are written.
    counts: Counts,
}

impl<'a> Object<'a> {
    /// Writes the facts that are known before the targets. `content` are the bytes of the mechanism's file.
    pub fn new(
        view: View<'a>,
        content: &[u8],
        with_positions: bool,
        mut sink: Sink,
    ) -> Result<Self, ClientError> {
        let problem = match view.problem {
            Problem::Forward => "forward",
            Problem::Inverse => "inverse",
            Problem::Motion => "motion",
        };
        sink.write(&format!(
            "{{\n\"mechanism\": {},\n\"problem\": \"{problem}\",\n\"angles\": \"rad\",\n\"targets\": [",
            mechanism(&view, content)
        ))?;
        Ok(Self {
            view,
            sink,
            with_positions,
            is_first: true,
            counts: Counts::default(),
        })
    }
}

impl Listing for Object<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        let comma = if std::mem::take(&mut self.is_first) {
            ""
        } else {
            ","
        };
        self.counts.add(&answer.counts);
        let target = match self.with_positions {
            true => TargetText::of(&self.view, index, answer),
            false => TargetText::counts(&self.view, index, answer),
        };
        self.sink.write(&format!("{comma}\n{}", target.text()))
    }

    fn finish(mut self: Box<Self>, end: &Finished<'_>) -> Result<(), ClientError> {
        let time = json!({"wall_seconds": end.wall_seconds, "cpu_seconds": end.cpu_seconds});
        self.sink.write(&format!(
            "\n],\n\"settled\": {},\n\"paths\": {},\n\"time\": {time},\n\"warnings\": {}\n}}\n",
            end.summary.settled,
            json!(PathsText::of(&self.counts)),
            json!(end.summary.warnings)
        ))?;
        self.sink.finish()
    }
}

/// A line of JSON for each target, with its positions.
pub struct Lines<'a> {
    view: View<'a>,
    sink: Sink,
}

impl<'a> Lines<'a> {
    /// Nothing stands before the first target.
    pub fn new(view: View<'a>, sink: Sink) -> Self {
        Self { view, sink }
    }
}

impl Listing for Lines<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        let target = TargetText::of(&self.view, index, answer);
        self.sink.write(&format!("{}\n", target.text()))
    }

    fn finish(self: Box<Self>, _: &Finished<'_>) -> Result<(), ClientError> {
        self.sink.finish()
    }
}

//! Configurations from files: the values of all joints, the points of a framework, or the pose of a platform.

use super::document::{Document, Entry, MechanismError};
use super::exact::Number;
use super::pose::Pose;
use super::read_parts::pose;
use super::targets::listed;
use super::{Body, Mechanism};

/// The value of one joint, exact where it was written so.
#[derive(Clone, Debug, PartialEq)]
pub enum GivenValue {
    /// Cosine and sine of a turn.
    Turn([Number; 2]),
    /// A shift.
    Shift(Number),
}

/// Where a mechanism stands.
#[derive(Clone, Debug, PartialEq)]
pub enum GivenConfiguration {
    /// The position in which the file gives the joints.
    Home,
    /// A value for each of [`Mechanism::values`], in this order.
    Joints(Vec<GivenValue>),
    /// The points of a framework, in the file's order.
    Points(Vec<[Number; 2]>),
    /// The pose of a platform's output.
    Pose(Pose),
}

/// Reads configurations in JSON, one or a list: `{"joints": {..}}`, `{"points": {..}}` or `{"pose": {..}}`.
pub fn configurations(
    file: &str,
    content: &[u8],
    mechanism: &Mechanism,
    degrees: bool,
) -> Result<Vec<GivenConfiguration>, MechanismError> {
    let document = Document::new(file, content)?;
    let tree = document.json_tree()?;
    let entries = listed(&Entry {
        document,
        tree: &tree,
        path: String::new(),
    })?;
    let read = |entry: &Entry<'_>| configuration(entry, mechanism, degrees);
    entries.iter().map(read).collect()
}

fn configuration(
    entry: &Entry<'_>,
    mechanism: &Mechanism,
    degrees: bool,
) -> Result<GivenConfiguration, MechanismError> {
    let (field, what) = match &mechanism.body {
        Body::Linkage(_) | Body::Chain(_) => ("joints", "the value of every joint by its name"),
        Body::Framework(_) => ("points", "the place [x, y] of every point by its name"),
        Body::Platform(_) => ("pose", "the pose of the platform"),
    };
    let fields = entry.fields(&format!("an object with \"{field}\": {what}"))?;
    let given = fields.required(field, what)?;
    let configuration = match &mechanism.body {
        Body::Linkage(_) | Body::Chain(_) => joints(&given, mechanism, degrees)?,
        Body::Framework(framework) => {
            let places = given.fields(what)?;
            let place = |name: &String| {
                let place = places.required(name, "the place of this point")?;
                place.numbers::<2>("two numbers")
            };
            let points: Result<_, _> = framework.points.iter().map(place).collect();
            places.finish()?;
            GivenConfiguration::Points(points?)
        }
        Body::Platform(_) => GivenConfiguration::Pose(pose(&given, degrees, mechanism.space)?.pose),
    };
    fields.finish()?;
    Ok(configuration)
}

fn joints(
    entry: &Entry<'_>,
    mechanism: &Mechanism,
    degrees: bool,
) -> Result<GivenConfiguration, MechanismError> {
    let fields = entry.fields("an object of values by the names of joints")?;
    let mut values = Vec::new();
    for (name, is_angle) in mechanism.values() {
        let value = fields.required(&name, "the value of this joint")?;
        values.push(if is_angle {
            GivenValue::Turn(turn(&value, degrees)?)
        } else {
            GivenValue::Shift(value.number()?)
        });
    }
    fields.finish()?;
    Ok(GivenConfiguration::Joints(values))
}

/// Cosine and sine of an angle: exact where they are written, and at multiples of right angles.
fn turn(entry: &Entry<'_>, degrees: bool) -> Result<[Number; 2], MechanismError> {
    let angle = entry.angle(degrees, false)?.angle;
    if entry.is_list() {
        let pair = entry.numbers::<2>("[cos, sin]")?;
        let squares = pair.each_ref().map(|n| n.surd.as_ref().map(|s| s.square()));
        if let [Some(c), Some(s)] = squares
            && c + s == 1
        {
            return Ok(pair);
        }
    }
    let is_right = angle.direction.iter().all(|x| x.fract() == 0.0);
    Ok(angle.direction.map(|x| match is_right {
        true => Number::of_double(x),
        false => Number::rounded(x),
    }))
}

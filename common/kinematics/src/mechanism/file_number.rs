//! Numbers of a mechanism's file: lengths, twists, offsets, coordinates of points and directions, each with its name and with
//! what moves when it is changed.

use super::chain::{Chain, ChainJoint, normal};
use super::exact::Number;
use super::pose::Pose;
use super::{
    Body, Framework, Joint, JointKind, LegKind, Linkage, Mechanism, Platform, Side, Space, Vector,
};

/// A number of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileNumber {
    /// Name of the number: `q2.a`, `B.point.0`, the name of a bar, `A1.0` of a platform's point.
    pub name: String,
    /// Value of the number; radians if it is an angle.
    pub value: f64,
    /// Whether the number is an angle.
    pub is_angle: bool,
    /// Parts of the mechanism that move when the number is changed.
    pub moves: Moves,
}

/// Where in a chain something is put in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainPlace {
    /// Before the base.
    Start,
    /// Between the base and the first joint.
    Base,
    /// Between a joint and the rest of its row.
    Joint(usize),
    /// Behind a row.
    Row(usize),
}

/// Parts of a mechanism that move when a number is changed.
#[derive(Clone, Debug, PartialEq)]
pub enum Moves {
    /// No part moves; only the zero of a joint's value changes.
    Nothing,
    /// The part of a chain behind a place turns about an axis of the frame there, or shifts along it.
    Chain {
        /// The place.
        place: ChainPlace,
        /// Whether it turns.
        turns: bool,
        /// Number of the axis.
        axis: usize,
    },
    /// Something that is not followed in this version: the orientation of a chain's base or tool, and the direction of a shift
    /// in space that is given in the coordinates of links.
    NotFollowed,
    /// The point of a joint, along an axis; in one of its two links, or in the home position.
    Point {
        /// Number of the joint.
        joint: usize,
        /// The link's side of the joint; `None` in the home position.
        side: Option<usize>,
        /// Number of the axis.
        axis: usize,
    },
    /// The direction of a joint's axis, or of its second axis.
    Direction {
        /// Number of the joint.
        joint: usize,
        /// The link's side of the joint; `None` in the home position.
        side: Option<usize>,
        /// Whether it is [`Side::second`].
        is_second: bool,
        /// Number of the component.
        axis: usize,
    },
    /// The length of a bar.
    Bar(usize),
    /// The length of a leg that is not driven.
    Leg(usize),
    /// A point of the base, along an axis, with the legs that begin there.
    BasePoint {
        /// Numbers of the legs.
        legs: Vec<usize>,
        /// Number of the axis.
        axis: usize,
    },
    /// A point of the platform, along an axis, with the legs that end there.
    MovingPoint {
        /// Numbers of the legs.
        legs: Vec<usize>,
        /// Number of the axis.
        axis: usize,
    },
}

impl Mechanism {
    /// The numbers of its file on which its shape can depend, in the order of the file.
    pub fn file_numbers(&self) -> Vec<FileNumber> {
        match &self.body {
            Body::Chain(chain) => of_chain(chain),
            Body::Linkage(linkage) => of_linkage(linkage, self.space),
            Body::Framework(framework) => of_framework(framework),
            Body::Platform(platform) => of_platform(platform, self.space),
        }
    }
}

fn length(name: String, number: &Number, moves: Moves) -> FileNumber {
    FileNumber {
        name,
        value: number.to_f64(),
        is_angle: false,
        moves,
    }
}

fn of_chain(chain: &Chain) -> Vec<FileNumber> {
    let mut list = end_numbers("base", &file_base(chain), ChainPlace::Start);
    for (j, joint) in chain.joints.iter().enumerate() {
        list.extend(of_row(chain, j, joint));
    }
    let last = ChainPlace::Row(chain.joints.len().saturating_sub(1));
    list.extend(end_numbers("tool", &chain.tool, last));
    list
}

/// The base as the file has it.
fn file_base(chain: &Chain) -> Pose {
    let Some((a, alpha)) = chain.first_normal else {
        return chain.base;
    };
    let base = chain.base.then(&normal(a, &alpha).inverse());
    match base.distance(&Pose::IDENTITY, chain.size()) < 1e-14 {
        true => Pose::IDENTITY,
        false => base,
    }
}

/// Numbers of a chain's base or tool, where that is written.
fn end_numbers(name: &str, pose: &Pose, place: ChainPlace) -> Vec<FileNumber> {
    if *pose == Pose::IDENTITY {
        return Vec::new();
    }
    let along = |axis: usize| FileNumber {
        name: format!("{name}.position.{axis}"),
        value: pose.position[axis].re,
        is_angle: false,
        moves: Moves::Chain {
            place,
            turns: false,
            axis,
        },
    };
    let mut list: Vec<FileNumber> = (0..3).map(along).collect();
    if pose.rotation != Pose::IDENTITY.rotation {
        list.push(FileNumber {
            name: format!("{name}.rotation"),
            value: 0.0,
            is_angle: true,
            moves: Moves::NotFollowed,
        });
    }
    list
}

fn of_row(chain: &Chain, j: usize, joint: &ChainJoint) -> Vec<FileNumber> {
    // A modified row has the normal before its joint, a standard one that behind it.
    let (place, a, alpha) = match chain.first_normal {
        None => (ChainPlace::Row(j), joint.a, joint.alpha),
        Some((a, alpha)) => match j.checked_sub(1) {
            None => (ChainPlace::Base, a, alpha),
            Some(before) => {
                let row = &chain.joints[before];
                (ChainPlace::Row(before), row.a, row.alpha)
            }
        },
    };
    let number = |field: &str, value: f64, is_angle: bool, place: ChainPlace, axis: usize| {
        // The joint itself moves so.
        let is_zero = axis == 2 && joint.is_angle == is_angle;
        FileNumber {
            name: format!("{}.{field}", joint.name),
            value,
            is_angle,
            moves: match is_zero {
                true => Moves::Nothing,
                false => Moves::Chain {
                    place,
                    turns: is_angle,
                    axis,
                },
            },
        }
    };
    let behind = ChainPlace::Joint(j);
    let fields = [
        number("d", joint.d, false, behind, 2),
        number("theta", joint.theta.radians, true, behind, 2),
        number("a", a, false, place, 0),
        number("alpha", alpha.radians, true, place, 0),
    ];
    // A zero of the joint's value is named where the file says something of it.
    let is_named = |x: &FileNumber| x.moves != Moves::Nothing || x.value != 0.0;
    fields.into_iter().filter(is_named).collect()
}

fn of_linkage(linkage: &Linkage, space: Space) -> Vec<FileNumber> {
    let mut list = Vec::new();
    for (j, joint) in linkage.joints.iter().enumerate() {
        if linkage.at_home {
            list.extend(of_side(joint, j, None, &joint.name, space));
            continue;
        }
        for side in 0..2 {
            let link = &linkage.links[joint.links[side]];
            let name = format!("{}.in.{link}", joint.name);
            list.extend(of_side(joint, j, Some(side), &name, space));
        }
    }
    list
}

fn of_side(
    joint: &Joint,
    j: usize,
    side: Option<usize>,
    name: &str,
    space: Space,
) -> Vec<FileNumber> {
    let Side {
        point,
        axis,
        second,
    } = &joint.sides[side.unwrap_or(0)];
    let axes = if space == Space::Planar { 2 } else { 3 };
    let vector = |field: &str, vector: &Vector, moves: &dyn Fn(usize) -> Moves| {
        let numbers = vector.iter().take(axes).enumerate();
        let number = |(k, x)| length(format!("{name}.{field}.{k}"), x, moves(k));
        numbers.map(number).collect::<Vec<_>>()
    };
    let is_shift_between_links = joint.kind == JointKind::P && side.is_some();
    let direction = |is_second: bool| {
        move |axis: usize| {
            if is_second && joint.kind == JointKind::R
                || is_second && side.is_none() && joint.kind != JointKind::U
            {
                Moves::Nothing
            } else if is_shift_between_links && space == Space::Spatial {
                Moves::NotFollowed
            } else {
                Moves::Direction {
                    joint: j,
                    side,
                    is_second,
                    axis,
                }
            }
        }
    };
    let mut list = Vec::new();
    // A shift has no place, and a spherical mechanism has one point; in links' coordinates the place of a shift is a distance.
    let has_point = match joint.kind {
        JointKind::P => side.is_some(),
        JointKind::E => false,
        _ => space != Space::Spherical,
    };
    if has_point {
        let moves = |axis: usize| Moves::Point {
            joint: j,
            side,
            axis,
        };
        list.extend(vector("point", point, &moves));
    }
    let field = match joint.kind {
        JointKind::S => return list,
        JointKind::R if space == Space::Planar => return list,
        JointKind::P if space == Space::Planar => "direction",
        JointKind::E => "normal",
        JointKind::U => "axes.0",
        _ => "axis",
    };
    list.extend(vector(field, axis, &direction(false)));
    if let Some(second) = second {
        let field = if joint.kind == JointKind::U {
            "axes.1"
        } else {
            "x"
        };
        list.extend(vector(field, second, &direction(true)));
    }
    list
}

fn of_framework(framework: &Framework) -> Vec<FileNumber> {
    let bars = framework.bars.iter().enumerate();
    let number = |(k, bar): (usize, &super::Bar)| {
        let name = bar.name.clone();
        let name = name.unwrap_or_else(|| format!("bars.{k}.length"));
        length(name, &bar.length, Moves::Bar(k))
    };
    bars.map(number).collect()
}

/// Legs that share a point of a platform's base or body.
struct SharedPoint<'a> {
    name: String,
    point: &'a Vector,
    legs: Vec<usize>,
}

/// The points of the legs, those with a name once.
fn shared_points<'a>(
    platform: &'a Platform,
    end: usize,
    point: impl Fn(usize) -> Option<&'a Vector>,
) -> Vec<SharedPoint<'a>> {
    let mut list: Vec<SharedPoint<'a>> = Vec::new();
    for (k, leg) in platform.legs.iter().enumerate() {
        let Some(point) = point(k) else { continue };
        let field = ["from", "to"][end];
        let default_name = || format!("{}.{field}", leg.name);
        let name = leg.ends[end].clone();
        let shared = name.as_ref();
        match list.iter_mut().find(|p| Some(&p.name) == shared) {
            Some(other) => other.legs.push(k),
            None => list.push(SharedPoint {
                name: name.unwrap_or_else(default_name),
                point,
                legs: vec![k],
            }),
        }
    }
    list
}

fn of_platform(platform: &Platform, space: Space) -> Vec<FileNumber> {
    let foot = |k: usize| match &platform.legs[k].kind {
        LegKind::Strut { from, .. } => Some(from),
        LegKind::Crank { .. } | LegKind::Slider { .. } => None,
    };
    let base = shared_points(platform, 0, foot);
    let moving = shared_points(platform, 1, |k| Some(&platform.legs[k].to));
    let axes = if space == Space::Planar { 2 } else { 3 };
    let mut list = Vec::new();
    for (points, others, body) in [(&base, &moving, "base"), (&moving, &base, "moving")] {
        for point in points {
            // One name may stand for a point of the base and one of the platform.
            let name = match others.iter().any(|other| other.name == point.name) {
                true => format!("{body}.{}", point.name),
                false => point.name.clone(),
            };
            for (axis, number) in point.point.iter().take(axes).enumerate() {
                let legs = point.legs.clone();
                let moves = match body {
                    "base" => Moves::BasePoint { legs, axis },
                    _ => Moves::MovingPoint { legs, axis },
                };
                list.push(length(format!("{name}.{axis}"), number, moves));
            }
        }
    }
    for (k, leg) in platform.legs.iter().enumerate() {
        if let LegKind::Strut {
            length: Some(number),
            ..
        } = &leg.kind
        {
            let field = match leg.word.as_str() {
                "SS" | "RR" => "length",
                _ => "at",
            };
            list.push(length(
                format!("{}.{field}", leg.name),
                number,
                Moves::Leg(k),
            ));
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use crate::mechanism::{ReadOptions, read};

    fn names(text: &str) -> Vec<String> {
        let mechanism = read("m", text.as_bytes(), &ReadOptions::default());
        let numbers = mechanism.unwrap_or_else(|e| panic!("{e}")).file_numbers();
        let shown = |x: &super::FileNumber| format!("{}={}", x.name, x.value);
        numbers.iter().map(shown).collect()
    }

    #[test]
    fn numbers_have_the_names_of_free_numbers() {
        let framework = r#"{"space": "planar", "framework": {"points": ["A", "B", "C"], "fixed": ["A", "B"], "bars": [
            {"name": "b", "between": ["A", "B"], "length": 2}, {"between": ["A", "C"], "length": "3/2"},
            {"between": ["B", "C"], "length": 1}]}}"#;
        assert_eq!(
            names(framework),
            ["b=2", "bars.1.length=1.5", "bars.2.length=1"]
        );
        let platform = r#"{"space": "planar", "platform": {"base": {"A": [0, 0], "B": [1, 0]}, "moving": {"A": [2, 3]}, "legs": [
            {"name": "L1", "type": "RR", "from": "A", "to": "A", "length": 1},
            {"name": "L2", "type": "RPR", "from": "B", "to": "A"}]}}"#;
        let wanted = ["base.A.0=0", "base.A.1=0", "B.0=1", "B.1=0"];
        assert_eq!(names(platform)[..4], wanted);
        let wanted = ["moving.A.0=2", "moving.A.1=3", "L1.length=1"];
        assert_eq!(names(platform)[4..], wanted);
    }

    #[test]
    fn rows_of_both_conventions_are_named_as_the_file_has_them() {
        for convention in ["standard", "modified"] {
            let text = format!(
                r#"{{"angles": "rad", "loop": {{"convention": "{convention}", "joints": [
                {{"name": "q1", "a": 1, "alpha": 0.1}}, {{"name": "q2", "type": "P", "a": 2, "d": 3}}]}}}}"#
            );
            let wanted = ["q1.d=0", "q1.a=1", "q1.alpha=0.1"];
            assert_eq!(names(&text)[..3], wanted, "{convention}");
            let wanted = ["q2.d=3", "q2.theta=0", "q2.a=2", "q2.alpha=0"];
            assert_eq!(names(&text)[3..], wanted, "{convention}");
        }
    }
}

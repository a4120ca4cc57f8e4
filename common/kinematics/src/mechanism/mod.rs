//! Mechanisms as people write them down: links and joints, chains of Denavit-Hartenberg rows, platforms on legs,
//! frameworks of bars. Checked when read; equations are made of them by `compile`.

pub mod chain;
pub mod configuration;
pub mod document;
pub mod exact;
pub mod file_number;
pub mod graph;
pub mod line;
pub mod pose;
pub mod read;
pub(crate) mod read_bodies;
pub mod read_options;
mod read_parts;
pub mod table_comments;
mod target_row;
pub mod targets;
pub mod task;
mod typed_numbers;
pub mod typed_pose;
pub mod write;

pub use document::MechanismError;
pub use read::read;
pub use read_options::ReadOptions;

use chain::Chain;
use exact::{Angle, Number};
use pose::Pose;

/// Most links, joints, legs, bars or points of one mechanism.
pub const MOST_PARTS: usize = 1000;

/// Where a mechanism moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// In space: six freedoms of a body.
    Spatial,
    /// In a plane: three.
    Planar,
    /// About a point: three.
    Spherical,
}

impl Space {
    /// Freedoms of a free body.
    pub fn freedoms(self) -> i64 {
        match self {
            Self::Spatial => 6,
            Self::Planar | Self::Spherical => 3,
        }
    }

    /// The word for it in a file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spatial => "spatial",
            Self::Planar => "planar",
            Self::Spherical => "spherical",
        }
    }
}

/// How two links can move against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Revolute: a turn about an axis.
    R,
    /// Prismatic: a shift along an axis.
    P,
    /// Cylindrical: both about and along one axis.
    C,
    /// Planar contact: two shifts, and a turn about the normal.
    E,
    /// Spherical: all turns about a point.
    S,
    /// Universal: turns about two axes that cross.
    U,
}

impl JointKind {
    /// Freedoms of the joint.
    pub fn freedoms(self) -> i64 {
        match self {
            Self::R | Self::P => 1,
            Self::C | Self::U => 2,
            Self::E | Self::S => 3,
        }
    }

    /// The letter of the joint.
    pub fn letter(self) -> &'static str {
        match self {
            Self::R => "R",
            Self::P => "P",
            Self::C => "C",
            Self::E => "E",
            Self::S => "S",
            Self::U => "U",
        }
    }
}

/// A point or direction in the coordinates of a link; the third coordinate is 0 in the plane.
pub type Vector = [Number; 3];

/// Where a joint sits in one of its links.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// A point of the axis, the centre.
    pub point: Vector,
    /// Direction of the axis, of the shift, or the normal; (0, 0, 1) for balls and in the plane's R.
    pub axis: Vector,
    /// The direction from which the joint's angle counts, or the second axis of a U.
    pub second: Option<Vector>,
}

/// A joint between two links.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name of the joint.
    pub name: String,
    /// Type of the joint.
    pub kind: JointKind,
    /// The two links, by number.
    pub links: [usize; 2],
    /// Where it sits in each of them.
    pub sides: [Side; 2],
}

/// Links and joints in general.
#[derive(Clone, Debug, PartialEq)]
pub struct Linkage {
    /// Names of the links.
    pub links: Vec<String>,
    /// The link that stands still.
    pub ground: usize,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Whether joints are given in the home position, so that there all joint values are 0.
    pub at_home: bool,
}

/// How a leg joins base and platform.
#[derive(Clone, Debug, PartialEq)]
pub enum LegKind {
    /// A strut between two points. Its length is the input, or fixed.
    Strut {
        /// The point of the base.
        from: Vector,
        /// The fixed length; the input where there is none.
        length: Option<Number>,
        /// The base end is a U, or an R in the plane, so that nothing spins.
        held: bool,
    },
    /// A crank in the base, and a rod from its tip.
    Crank {
        /// The centre of the circle of the tip.
        center: Vector,
        /// The crank's axis; (0, 0, 1) in the plane.
        axis: Vector,
        /// The direction of the crank at angle 0.
        zero: Box<Vector>,
        /// The crank's length.
        length: Number,
        /// The rod's length.
        rod: Number,
    },
    /// A slider in the base, and a rod from it.
    Slider {
        /// The slider's place at 0.
        origin: Vector,
        /// The direction of the slide.
        direction: Vector,
        /// The rod's length.
        rod: Number,
    },
}

/// A leg of a platform.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// Name of the leg, and of the leg's input.
    pub name: String,
    /// The type as written: `SPS`, `RSS`, ...
    pub word: String,
    /// Kind of the leg.
    pub kind: LegKind,
    /// The point of the platform, in the platform's coordinates.
    pub to: Vector,
    /// Names of the points of base and platform, where they have some.
    pub ends: [Option<String>; 2],
}

impl Leg {
    /// Whether it has an input.
    pub fn is_driven(&self) -> bool {
        !matches!(
            self.kind,
            LegKind::Strut {
                length: Some(_),
                ..
            }
        )
    }

    /// Whether its input is an angle.
    pub fn is_angle(&self) -> bool {
        matches!(self.kind, LegKind::Crank { .. })
    }
}

/// A body on legs.
#[derive(Clone, Debug, PartialEq)]
pub struct Platform {
    /// The legs.
    pub legs: Vec<Leg>,
    /// The platform keeps its orientation: its rods are doubled to parallelograms.
    pub fixed_orientation: bool,
    /// The point of the moving body of which the place is meant by its pose.
    pub output_point: [f64; 3],
}

impl Platform {
    /// The pose of the output where the moving body is here: its rotation, and the place of the output's point.
    pub fn output(&self, body: &Pose) -> Pose {
        let [x, y, z] = self.output_point;
        body.then(&Pose::shift(x, y, z))
    }

    /// The pose of the moving body where the output is here.
    pub fn body(&self, output: &Pose) -> Pose {
        let [x, y, z] = self.output_point;
        output.then(&Pose::shift(-x, -y, -z))
    }
}

/// A bar between two points.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Name of the bar; `None` if the file gives none.
    pub name: Option<String>,
    /// The two points, by number.
    pub between: [usize; 2],
    /// Length of the bar.
    pub length: Number,
}

/// Bars in the plane that turn about common points.
#[derive(Clone, Debug, PartialEq)]
pub struct Framework {
    /// Names of the points.
    pub points: Vec<String>,
    /// The bars.
    pub bars: Vec<Bar>,
    /// The two points that stand still: the first at (0, 0), the second on the positive x-axis.
    pub fixed: [usize; 2],
}

impl Framework {
    /// Whether a bar is that between the points that stand still.
    pub fn is_fixed(&self, bar: &Bar) -> bool {
        bar.between.iter().all(|point| self.fixed.contains(point))
    }
}

/// Structure of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// Links and joints.
    Linkage(Linkage),
    /// A chain of joints, open or closed.
    Chain(Box<Chain>),
    /// A platform on legs.
    Platform(Platform),
    /// A framework of bars.
    Framework(Framework),
}

/// The name of a platform's moving body.
pub const PLATFORM: &str = "platform";

/// The name of the link behind a chain's joint, counted from 1.
pub fn link_name(joint: usize) -> String {
    format!("link{joint}")
}

/// Output of a mechanism: a link, or a point of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// A link's name.
    pub link: String,
    /// Point of the link, if the file names one.
    pub point: Option<Vector>,
}

/// A number that was taken for the right angle that it rounds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snapped {
    /// Where: `joints[1].alpha`, `joint_2 rpy`.
    pub place: String,
    /// The digits as the file gives them.
    pub digits: String,
    /// The angle for which the digits are taken, in degrees.
    pub degrees: i64,
}

impl Snapped {
    /// Whether the digits are fewer than a double holds, so that somebody should know.
    pub fn is_coarse(&self) -> bool {
        let digits = self.digits.chars().filter(char::is_ascii_digit);
        digits.skip_while(|c| *c == '0').count() < 15
    }
}

/// Limits of a joint or leg, in radians or lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// The joint's name.
    pub joint: String,
    /// Lowest and highest value.
    pub range: [f64; 2],
}

/// A mechanism that was read and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// The file's name, for messages.
    pub file: String,
    /// Name of the mechanism.
    pub name: String,
    /// Whether the mechanism moves in space, in a plane or about a point.
    pub space: Space,
    /// Whether angles of files and tables are in degrees.
    pub degrees: bool,
    /// Links and joints, a chain, a platform or a framework.
    pub body: Body,
    /// The joints or legs that drive it.
    pub inputs: Vec<String>,
    /// The link, or the point of one, that is asked for.
    pub output: Option<Output>,
    /// Limits of joints.
    pub limits: Vec<Limits>,
    /// Right angles that the file rounds.
    pub snapped: Vec<Snapped>,
    /// Further warnings for the user.
    pub warnings: Vec<String>,
}

impl Mechanism {
    /// An error about the mechanism.
    pub fn error(&self, message: impl Into<String>) -> MechanismError {
        MechanismError::of_file(&self.file, message)
    }

    /// These names, each with whether its value is an angle.
    pub fn kinds(&self, names: &[String]) -> Vec<(String, bool)> {
        let values = self.values();
        let is_angle = |name: &String| values.iter().any(|(n, angle)| n == name && *angle);
        let kind = |name: &String| (name.clone(), is_angle(name));
        names.iter().map(kind).collect()
    }

    /// Names of the joints or legs that have a value, and whether it is an angle.
    pub fn values(&self) -> Vec<(String, bool)> {
        match &self.body {
            Body::Linkage(linkage) => {
                let single = |j: &&Joint| matches!(j.kind, JointKind::R | JointKind::P);
                let joints = linkage.joints.iter().filter(single);
                joints
                    .map(|j| (j.name.clone(), j.kind == JointKind::R))
                    .collect()
            }
            Body::Chain(chain) => {
                let joints = chain.joints.iter();
                joints.map(|j| (j.name.clone(), j.is_angle)).collect()
            }
            Body::Platform(platform) => {
                let driven = platform.legs.iter().filter(|leg| leg.is_driven());
                driven
                    .map(|leg| (leg.name.clone(), leg.is_angle()))
                    .collect()
            }
            Body::Framework(_) => Vec::new(),
        }
    }

    /// The limits of a joint.
    pub fn limits_of(&self, joint: &str) -> Option<[f64; 2]> {
        self.limits
            .iter()
            .find(|l| l.joint == joint)
            .map(|l| l.range)
    }

    /// Warnings about rounded right angles, a sentence each.
    pub fn snapping_warnings(&self) -> Vec<String> {
        let coarse = self.snapped.iter().filter(|s| s.is_coarse());
        let say = |s: &Snapped| {
            format!(
                "{}: {} is read as {} deg; --no-snap takes it as written",
                s.place, s.digits, s.degrees
            )
        };
        coarse.map(say).collect()
    }
}

/// An angle that was read, with its snapping noted.
pub(crate) fn noted(read: exact::ReadAngle, place: &str, snapped: &mut Vec<Snapped>) -> Angle {
    if let Some(digits) = read.snapped {
        let quarters = (read.angle.radians / std::f64::consts::FRAC_PI_2).round();
        snapped.push(Snapped {
            place: place.to_owned(),
            digits,
            degrees: quarters as i64 * 90,
        });
    }
    read.angle
}

//! The four kinds of bodies of a mechanism's file: chains, links with joints, platforms, frameworks.

use super::chain::{Chain, ChainJoint, normal};
use super::document::{Entry, Fields, MechanismError};
use super::exact::{Angle, Number};
use super::pose::{Pose, ROTATION_ERROR};
use super::read_parts::{Context, parts, pose};
use super::{
    Bar, Framework, Joint, JointKind, Leg, LegKind, Linkage, Platform, Side, Space, Vector,
};
use std::collections::HashMap;

/// Why there are no screws.
const HELICAL: &str = "is H: a screw's motion is not algebraic; drive a P in its place, or lock it";

/// Names, each once.
struct Names(HashMap<String, usize>);

impl Names {
    fn new() -> Self {
        Self(HashMap::new())
    }

    fn add(&mut self, entry: &Entry<'_>) -> Result<String, MechanismError> {
        let name = entry.text("a name")?;
        if name.is_empty() {
            return Err(entry.error("a name is empty"));
        }
        let number = self.0.len();
        if self.0.insert(name.to_owned(), number).is_some() {
            return Err(entry.error(format!("the name \"{name}\" stands for two things")));
        }
        Ok(name.to_owned())
    }

    fn find(&self, entry: &Entry<'_>, what: &str) -> Result<usize, MechanismError> {
        let name = entry.text(what)?;
        self.0.get(name).copied().ok_or_else(|| {
            let mut names: Vec<&str> = self.0.keys().map(String::as_str).collect();
            names.sort_unstable();
            entry.error(format!(
                "there is no {what} \"{name}\"; there are {}",
                names.join(", ")
            ))
        })
    }
}

fn joint_kind(entry: &Entry<'_>, name: &str) -> Result<JointKind, MechanismError> {
    match entry.text("a joint type: R, P, C, E, S or U")? {
        "R" => Ok(JointKind::R),
        "P" => Ok(JointKind::P),
        "C" => Ok(JointKind::C),
        "E" => Ok(JointKind::E),
        "S" => Ok(JointKind::S),
        "U" => Ok(JointKind::U),
        "H" => Err(entry.error(format!("joint {name} {HELICAL}"))),
        other => Err(entry.error(format!("expected R, P, C, E, S or U, found \"{other}\""))),
    }
}

/// `serial` and `loop`: rows of a table.
pub(super) fn chain(
    fields: &Fields<'_>,
    name: &str,
    context: &mut Context,
) -> Result<Chain, MechanismError> {
    let body = fields.required(name, "a chain")?;
    if context.space != Space::Spatial {
        let message =
            "rows of Denavit and Hartenberg are spatial; say a planar chain by links and joints";
        return Err(body.error(message));
    }
    let fields = body.fields("a chain: convention and joints")?;
    let modified = match fields.optional("convention") {
        None => false,
        Some(entry) => match entry.text("standard or modified")? {
            "standard" => false,
            "modified" => true,
            other => {
                let message = format!("expected standard or modified, found \"{other}\"");
                return Err(entry.error(message));
            }
        },
    };
    let mut names = Names::new();
    let mut rows = Vec::new();
    let list = fields.required("joints", "the rows of the table")?;
    for item in parts(&list, "a list of joints")? {
        rows.push(row(&item, &mut names, context)?);
    }
    if rows.is_empty() {
        return Err(list.error("expected at least one joint"));
    }
    let end = |name: &str| match fields.optional(name) {
        Some(entry) => {
            let read = pose(&entry, context.degrees, Space::Spatial)?;
            if read.rounding > ROTATION_ERROR {
                return Err(entry.error(format!(
                    "this is no rotation: it is off by {:.1e}; at most {ROTATION_ERROR:.0e} is rounded away",
                    read.rounding
                )));
            }
            Ok(read.pose)
        }
        None => Ok(Pose::IDENTITY),
    };
    let (base, tool) = (end("base")?, end("tool")?);
    fields.finish()?;
    let mut chain = Chain {
        joints: rows,
        base,
        tool,
        closed: name == "loop",
        first_normal: None,
    };
    if modified {
        of_modified(&mut chain);
    }
    Ok(chain)
}

fn row(
    item: &Entry<'_>,
    names: &mut Names,
    context: &mut Context,
) -> Result<ChainJoint, MechanismError> {
    let fields = item.fields("a joint: name, type, a, alpha, d, theta")?;
    let name = names.add(&fields.required("name", "the joint's name")?)?;
    let kind = match fields.optional("type") {
        None => JointKind::R,
        Some(entry) => {
            let kind = joint_kind(&entry, &name)?;
            if !matches!(kind, JointKind::R | JointKind::P) {
                return Err(entry.error(format!(
                    "joint {name}: rows are for R and P, found {}; say others by links and joints",
                    kind.letter()
                )));
            }
            kind
        }
    };
    let length = |name: &str| match fields.optional(name) {
        Some(entry) => entry.double(),
        None => Ok(0.0),
    };
    let (a, d) = (length("a")?, length("d")?);
    let mut angle = |name: &str| match fields.optional(name) {
        Some(entry) => context.angle(&entry),
        None => Ok(Angle::ZERO),
    };
    let (alpha, theta) = (angle("alpha")?, angle("theta")?);
    fields.finish()?;
    Ok(ChainJoint {
        name,
        is_angle: kind == JointKind::R,
        a,
        alpha,
        d,
        theta,
    })
}

/// Rx(alpha) Tx(a) Rz(theta) Tz(d) row by row is the standard order with a and alpha one row earlier.
pub(crate) fn of_modified(chain: &mut Chain) {
    let normals: Vec<(f64, Angle)> = chain.joints.iter().map(|j| (j.a, j.alpha)).collect();
    let count = chain.joints.len();
    for (i, joint) in chain.joints.iter_mut().enumerate() {
        (joint.a, joint.alpha) = if i + 1 < count {
            normals[i + 1]
        } else {
            (0.0, Angle::ZERO)
        };
    }
    if let Some((a, alpha)) = normals.first() {
        chain.base = chain.base.then(&normal(*a, alpha));
        chain.first_normal = Some((*a, *alpha));
    }
}

/// `links` and `joints`.
pub(super) fn linkage(
    fields: &Fields<'_>,
    context: &mut Context,
) -> Result<Linkage, MechanismError> {
    let list = fields.required("links", "the names of the links")?;
    let mut names = Names::new();
    let mut links = Vec::new();
    for item in parts(&list, "a list of names")? {
        links.push(names.add(&item)?);
    }
    if links.len() < 2 {
        return Err(list.error("expected at least two links"));
    }
    let ground = match fields.optional("ground") {
        Some(entry) => names.find(&entry, "link")?,
        None => 0,
    };
    let list = fields.required("joints", "the joints")?;
    let mut joint_names = Names::new();
    let mut joints = Vec::new();
    let mut homes = Vec::new();
    for item in parts(&list, "a list of joints")? {
        let (mut joint, at_home) = joint(&item, &names, &links, &mut joint_names, context)?;
        // Values are those of the moving link against the ground, in whatever order the two are named.
        if joint.links[1] == ground {
            joint.links.swap(0, 1);
            joint.sides.swap(0, 1);
        }
        joints.push(joint);
        homes.push(at_home);
    }
    if homes.iter().any(|home| *home != homes[0]) {
        let message = "some joints are given in the home position and some in their links; expected one of the two";
        return Err(list.error(message));
    }
    let linkage = Linkage {
        links,
        ground,
        joints,
        at_home: homes.first().copied().unwrap_or(true),
    };
    if let Some(loose) = linkage.unreached() {
        let message = format!(
            "link \"{}\" is joined to nothing that leads to the ground",
            linkage.links[loose]
        );
        return Err(list.error(message));
    }
    Ok(linkage)
}

fn joint(
    item: &Entry<'_>,
    links: &Names,
    link_names: &[String],
    names: &mut Names,
    context: &mut Context,
) -> Result<(Joint, bool), MechanismError> {
    let fields = item.fields("a joint: name, type, links, point, axis")?;
    let name = names.add(&fields.required("name", "the joint's name")?)?;
    let kind_entry = fields.required("type", "R, P, C, E, S or U")?;
    let kind = joint_kind(&kind_entry, &name)?;
    let allowed = match context.space {
        Space::Spatial => true,
        Space::Planar => matches!(kind, JointKind::R | JointKind::P),
        Space::Spherical => kind == JointKind::R,
    };
    if !allowed {
        return Err(kind_entry.error(format!(
            "joint {name} is {}, which a {} mechanism has not",
            kind.letter(),
            context.space.name()
        )));
    }
    let pair = fields.required("links", "the two links")?;
    let items = pair.items("two links")?;
    let [a, b] = &items[..] else {
        return Err(pair.error(format!("expected two links, found {}", items.len())));
    };
    let ends = [links.find(a, "link")?, links.find(b, "link")?];
    if ends[0] == ends[1] {
        return Err(pair.error(format!(
            "joint {name} joins \"{}\" to itself",
            link_names[ends[0]]
        )));
    }
    let (sides, at_home) = match fields.optional("in") {
        None => {
            let side = side(&fields, kind, context)?;
            ([side.clone(), side], true)
        }
        Some(entry) => {
            let inside = entry.fields("an object with a place in each of the two links")?;
            let side_in = |link: usize| -> Result<Side, MechanismError> {
                let what = "the joint's place in this link";
                let fields = inside.required(&link_names[link], what)?.fields(what)?;
                let side = side(&fields, kind, context)?;
                fields.finish()?;
                Ok(side)
            };
            let sides = [side_in(ends[0])?, side_in(ends[1])?];
            inside.finish()?;
            (sides, false)
        }
    };
    fields.finish()?;
    let joint = Joint {
        name,
        kind,
        links: ends,
        sides,
    };
    Ok((joint, at_home))
}

fn z_axis() -> Vector {
    [Number::integer(0), Number::integer(0), Number::integer(1)]
}

fn origin() -> Vector {
    [Number::integer(0), Number::integer(0), Number::integer(0)]
}

/// Point and axis of a joint as its type wants them.
fn side(fields: &Fields<'_>, kind: JointKind, context: &Context) -> Result<Side, MechanismError> {
    let planar = context.space == Space::Planar;
    let spherical = context.space == Space::Spherical;
    let needs_point = !(spherical || planar && kind == JointKind::P || kind == JointKind::E);
    let point = match fields.optional("point") {
        Some(entry) => context.vector(&entry, "the point")?,
        None if needs_point && kind != JointKind::P => {
            return Err(fields.error("the field \"point\" is missing: a point of the axis"));
        }
        None => origin(),
    };
    let axis_name = match kind {
        JointKind::P if planar => "direction",
        JointKind::E => "normal",
        JointKind::U => "axes",
        _ => "axis",
    };
    let mut second = None;
    let axis = match kind {
        JointKind::S => z_axis(),
        JointKind::R if planar => z_axis(),
        JointKind::U => {
            let entry = fields.required("axes", "the two axes")?;
            let items = entry.items("two axes")?;
            let [first, other] = &items[..] else {
                return Err(entry.error(format!("expected two axes, found {}", items.len())));
            };
            second = Some(context.direction(other, "the second axis")?);
            context.direction(first, "the first axis")?
        }
        _ => {
            let entry = fields.required(axis_name, "its direction")?;
            context.direction(&entry, "the axis")?
        }
    };
    if let Some(entry) = fields.optional("x") {
        second = Some(context.direction(&entry, "the direction x")?);
    }
    Ok(Side {
        point,
        axis,
        second,
    })
}

/// `platform`: base, moving, legs.
pub(super) fn platform(
    fields: &Fields<'_>,
    context: &mut Context,
) -> Result<Platform, MechanismError> {
    let body = fields.required("platform", "base, moving and legs")?;
    if context.space == Space::Spherical {
        return Err(body.error("say a spherical platform by links and joints"));
    }
    let fields = body.fields("a platform: base, moving and legs")?;
    let fixed_orientation = match fields.optional("orientation") {
        None => false,
        Some(entry) => match entry.text("fixed or free")? {
            "fixed" => true,
            "free" => false,
            other => return Err(entry.error(format!("expected fixed or free, found \"{other}\""))),
        },
    };
    let base = points(&fields, "base", context)?;
    let moving = points(&fields, "moving", context)?;
    let mut names = Names::new();
    let list = fields.required("legs", "the legs")?;
    let mut legs = Vec::new();
    for item in parts(&list, "a list of legs")? {
        legs.push(leg(&item, &base, &moving, &mut names, context)?);
    }
    if legs.is_empty() {
        return Err(list.error("expected at least one leg"));
    }
    fields.finish()?;
    Ok(Platform {
        legs,
        fixed_orientation,
        output_point: [0.0; 3],
    })
}

type Points = HashMap<String, Vector>;

fn points(fields: &Fields<'_>, name: &str, context: &Context) -> Result<Points, MechanismError> {
    let entry = fields.required(name, "named points")?;
    let mut named_points = HashMap::new();
    for (name, entry) in entry.fields("an object of named points")?.all() {
        named_points.insert(name.to_owned(), context.vector(&entry, "a point")?);
    }
    Ok(named_points)
}

fn place(
    entry: &Entry<'_>,
    points: &Points,
    context: &Context,
) -> Result<(Vector, Option<String>), MechanismError> {
    if entry.is_list() {
        return Ok((context.vector(entry, "a point")?, None));
    }
    let name = entry.text("the name of a point")?;
    match points.get(name) {
        Some(point) => Ok((point.clone(), Some(name.to_owned()))),
        None => {
            let mut names: Vec<&str> = points.keys().map(String::as_str).collect();
            names.sort_unstable();
            Err(entry.error(format!(
                "there is no point \"{name}\" here; there are {}",
                names.join(", ")
            )))
        }
    }
}

/// A length above 0.
fn length(fields: &Fields<'_>, name: &str, what: &str) -> Result<Number, MechanismError> {
    let entry = fields.required(name, what)?;
    let number = entry.number()?;
    if number.value <= 0 {
        return Err(entry.error(format!("expected a length above 0, found {}", number.value)));
    }
    Ok(number)
}

/// A leg's crank, and the name of its centre where it has one.
fn crank(
    fields: &Fields<'_>,
    base: &Points,
    rod: Number,
    context: &Context,
) -> Result<(LegKind, Option<String>), MechanismError> {
    let crank = fields.required("crank", "center, axis, zero and length")?;
    let inside = crank.fields("a crank: center, axis, zero, length")?;
    let (center, name) = place(
        &inside.required("center", "the crank's centre")?,
        base,
        context,
    )?;
    let axis = match context.space {
        Space::Planar => z_axis(),
        _ => context.direction(&inside.required("axis", "its direction")?, "the axis")?,
    };
    let zero_entry = inside.required("zero", "the crank's direction at angle 0")?;
    let zero = context.direction(&zero_entry, "the zero direction")?;
    let along: f64 = (0..3).map(|i| axis[i].to_f64() * zero[i].to_f64()).sum();
    let size = |v: &Vector| {
        v.iter()
            .map(|c| c.to_f64() * c.to_f64())
            .sum::<f64>()
            .sqrt()
    };
    if along.abs() > 1e-5 * size(&axis) * size(&zero) {
        return Err(zero_entry.error("the zero direction is not at a right angle to the axis"));
    }
    let length = length(&inside, "length", "the crank's length")?;
    inside.finish()?;
    let kind = LegKind::Crank {
        center,
        axis,
        zero: Box::new(zero),
        length,
        rod,
    };
    Ok((kind, name))
}

fn leg(
    item: &Entry<'_>,
    base: &Points,
    moving: &Points,
    names: &mut Names,
    context: &mut Context,
) -> Result<Leg, MechanismError> {
    let fields = item.fields("a leg: name, type, from, to")?;
    let name = names.add(&fields.required("name", "the leg's name")?)?;
    let (to, to_name) = place(
        &fields.required("to", "a point of the platform")?,
        moving,
        context,
    )?;
    fields.optional("limits");
    let type_entry = fields.required("type", "the leg's type")?;
    let word = type_entry.text("the leg's type")?.to_owned();
    let planar = context.space == Space::Planar;
    let from_name;
    let kind = match (word.as_str(), planar) {
        ("SPS" | "UPS" | "SPU" | "SS", false) | ("RPR" | "RR", true) => {
            let (from, name) = place(
                &fields.required("from", "a point of the base")?,
                base,
                context,
            )?;
            from_name = name;
            let fixed = match word.as_str() {
                "SS" | "RR" => Some(length(&fields, "length", "its length")?),
                _ if fields.optional("at").is_some() => Some(length(&fields, "at", "its length")?),
                _ => None,
            };
            LegKind::Strut {
                from,
                length: fixed,
                held: planar || word.contains('U'),
            }
        }
        ("RSS", false) | ("RRR", true) => {
            let rod = length(&fields, "rod", "the rod's length")?;
            let (kind, name) = crank(&fields, base, rod, context)?;
            from_name = name;
            kind
        }
        ("PSS", false) | ("PRR", true) => {
            let slider = fields.required("slider", "origin and direction")?;
            let inside = slider.fields("a slider: origin, direction")?;
            let (origin, name) = place(
                &inside.required("origin", "the slider's place at 0")?,
                base,
                context,
            )?;
            from_name = name;
            let direction = inside.required("direction", "its direction")?;
            let direction = context.direction(&direction, "the direction")?;
            inside.finish()?;
            LegKind::Slider {
                origin,
                direction,
                rod: length(&fields, "rod", "the rod's length")?,
            }
        }
        (other, _) => {
            let leg_types = match planar {
                true => "RPR, RR, RRR, PRR",
                false => "SPS, UPS, SS, RSS, PSS",
            };
            return Err(type_entry.error(format!(
                "expected a leg of type {leg_types}, found \"{other}\""
            )));
        }
    };
    fields.finish()?;
    Ok(Leg {
        name,
        word,
        kind,
        to,
        ends: [from_name, to_name],
    })
}

/// `framework`: points, bars, fixed.
pub(super) fn framework(
    fields: &Fields<'_>,
    context: &mut Context,
) -> Result<Framework, MechanismError> {
    let body = fields.required("framework", "points and bars")?;
    if context.space != Space::Planar {
        return Err(body.error("a framework is planar: \"space\": \"planar\""));
    }
    let fields = body.fields("a framework: points, bars, fixed")?;
    let mut names = Names::new();
    let mut points = Vec::new();
    for item in parts(
        &fields.required("points", "names of points")?,
        "a list of names",
    )? {
        points.push(names.add(&item)?);
    }
    let pair = |entry: &Entry<'_>| -> Result<[usize; 2], MechanismError> {
        let items = entry.items("two points")?;
        let [a, b] = &items[..] else {
            return Err(entry.error(format!("expected two points, found {}", items.len())));
        };
        let pair = [names.find(a, "point")?, names.find(b, "point")?];
        if pair[0] == pair[1] {
            return Err(entry.error("expected two points, found one twice"));
        }
        Ok(pair)
    };
    let mut bars: Vec<Bar> = Vec::new();
    let list = fields.required("bars", "the bars")?;
    for item in parts(&list, "a list of bars")? {
        let inside = item.fields("a bar: between, length")?;
        let between = pair(&inside.required("between", "two points")?)?;
        let entry = inside.required("length", "its length")?;
        let length = entry.number()?;
        if length.value <= 0 {
            return Err(entry.error("expected a length above 0"));
        }
        // Sweeps name the bar's length by it.
        let name = inside
            .optional("name")
            .map(|entry| entry.text("a name").map(str::to_owned))
            .transpose()?;
        inside.finish()?;
        let same = |b: &Bar| b.between == between || b.between == [between[1], between[0]];
        if bars.iter().any(same) {
            return Err(item.error("these points are joined by a bar already"));
        }
        bars.push(Bar {
            name,
            between,
            length,
        });
    }
    let entry = fields.required("fixed", "the two points of the bar that stands still")?;
    let fixed = pair(&entry)?;
    let on_bar = |b: &Bar| b.between == fixed || b.between == [fixed[1], fixed[0]];
    if !bars.iter().any(on_bar) {
        return Err(entry.error("the fixed points are not joined by a bar"));
    }
    fields.finish()?;
    Ok(Framework {
        points,
        bars,
        fixed,
    })
}

//! From the text of a mechanism's file to a checked mechanism: JSON, TOML, DH table, URDF, told apart by content.

use super::document::{Document, Entry, Fields, MechanismError};
use super::pose::Pose;
use super::read_bodies::{chain, framework, linkage, platform};
use super::read_options::ReadOptions;
use super::read_parts::Context;
use super::{Body, Limits, Mechanism, Output, PLATFORM, Space, link_name};
use crate::import::{dh, urdf};
use cognate_numeric::counted::counted;
use std::collections::HashSet;

/// Reads a mechanism from a file's bytes; `file` is its name.
pub fn read(
    file: &str,
    content: &[u8],
    options: &ReadOptions,
) -> Result<Mechanism, MechanismError> {
    let document = Document::new(file, content)?;
    let start = document.text.trim_start_matches('\u{feff}').trim_start();
    if start.starts_with('<') {
        return urdf::read(&document, options);
    }
    if dh::is_table(start) {
        return dh::read(&document, options);
    }
    if file.ends_with(".csv") {
        let heading = start.lines().next().unwrap_or_default();
        let heading: String = heading.chars().take(40).collect();
        let message = format!(
            "expected headings between commas, such as name,theta,d,a,alpha, found \"{heading}\""
        );
        return Err(document.error(0, "", message));
    }
    let tree = document.tree()?;
    let root = Entry {
        document,
        tree: &tree,
        path: String::new(),
    };
    mechanism(&root, options)
}

fn mechanism(root: &Entry<'_>, options: &ReadOptions) -> Result<Mechanism, MechanismError> {
    let fields = root.fields("an object with a mechanism")?;
    let file = root.document.file;
    let name = match fields.optional("name") {
        Some(entry) => entry.text("the mechanism's name")?.to_owned(),
        None => file.to_owned(),
    };
    let space = match fields.optional("space") {
        None => Space::Spatial,
        Some(entry) => match entry.text("spatial, planar or spherical")? {
            "spatial" => Space::Spatial,
            "planar" => Space::Planar,
            "spherical" => Space::Spherical,
            other => {
                let message = format!("expected spatial, planar or spherical, found \"{other}\"");
                return Err(entry.error(message));
            }
        },
    };
    let unit = fields.optional("angles");
    let unit_is_named = unit.is_some();
    let degrees = match unit {
        None => true,
        Some(entry) => match entry.text("deg or rad")? {
            "deg" => true,
            "rad" => false,
            other => return Err(entry.error(format!("expected deg or rad, found \"{other}\""))),
        },
    };
    if let Some(length) = fields.optional("length") {
        length.text("the unit of lengths, a word")?;
    }
    let mut context = Context {
        space,
        degrees,
        unit_is_named,
        snap: !options.no_snap,
        snapped: Vec::new(),
    };
    let bodies = ["serial", "loop", "platform", "framework", "joints"];
    let present: Vec<&str> = bodies
        .into_iter()
        .filter(|n| fields.optional(n).is_some())
        .collect();
    let body = match present[..] {
        ["serial"] => Body::Chain(Box::new(chain(&fields, "serial", &mut context)?)),
        ["loop"] => Body::Chain(Box::new(chain(&fields, "loop", &mut context)?)),
        ["platform"] => Body::Platform(platform(&fields, &mut context)?),
        ["framework"] => Body::Framework(framework(&fields, &mut context)?),
        ["joints"] => Body::Linkage(linkage(&fields, &mut context)?),
        [] => {
            return Err(fields.error(
                "the mechanism has no body: expected links with joints, serial, loop, platform or framework",
            ));
        }
        _ => {
            let message = format!("expected one body, found {}", present.join(" and "));
            return Err(fields.error(message));
        }
    };
    let mut mechanism = Mechanism {
        file: file.to_owned(),
        name,
        space,
        degrees,
        body,
        inputs: Vec::new(),
        output: None,
        limits: Vec::new(),
        snapped: context.snapped,
        warnings: Vec::new(),
    };
    let leg_limits = legs_limits(&fields, &mechanism)?;
    mechanism.limits.extend(leg_limits);
    inputs_and_limits(&fields, &mut mechanism)?;
    fields.finish()?;
    Ok(mechanism)
}

/// Names of inputs, the output and the limits of joints.
fn inputs_and_limits(fields: &Fields<'_>, mechanism: &mut Mechanism) -> Result<(), MechanismError> {
    let values = mechanism.values();
    let joint_value = |name: &str| values.iter().find(|(n, _)| n == name);
    let names = || {
        let names: Vec<&str> = values.iter().map(|(n, _)| n.as_str()).collect();
        names.join(", ")
    };
    if let Some(entry) = fields.optional("inputs") {
        let mut seen = HashSet::new();
        for item in entry.items("a list of names of joints")? {
            let name = item.text("the name of a joint")?;
            if joint_value(name).is_none() {
                let message = format!(
                    "no joint \"{name}\" that can be driven; there are {}",
                    names()
                );
                return Err(item.error(message));
            }
            if !seen.insert(name) {
                return Err(item.error(format!("\"{name}\" is an input already")));
            }
            mechanism.inputs.push(name.to_owned());
        }
    } else if let Body::Platform(_) = mechanism.body {
        mechanism.inputs = values.iter().map(|(n, _)| n.clone()).collect();
    }
    if let Some(entry) = fields.optional("output") {
        let output = output(&entry, mechanism)?;
        take_output(&entry, &output, &mut mechanism.body)?;
        mechanism.output = Some(output);
    }
    if let Some(entry) = fields.optional("limits") {
        for (name, range) in entry.fields("an object of [low, high]")?.all() {
            let Some((_, is_angle)) = joint_value(name) else {
                let message = format!(
                    "no joint \"{name}\" that can have limits; there are {}",
                    names()
                );
                return Err(range.error(message));
            };
            let range = limits(&range, *is_angle, mechanism.degrees)?;
            mechanism.limits.push(Limits {
                joint: name.to_owned(),
                range,
            });
        }
    }
    Ok(())
}

/// Limits that stand in the legs of a platform themselves.
fn legs_limits(fields: &Fields<'_>, mechanism: &Mechanism) -> Result<Vec<Limits>, MechanismError> {
    let Body::Platform(platform) = &mechanism.body else {
        return Ok(Vec::new());
    };
    let mut leg_limits = Vec::new();
    let Some(body) = fields.optional("platform") else {
        return Ok(leg_limits);
    };
    let legs = body.fields("a platform")?.required("legs", "its legs")?;
    for (item, leg) in legs.items("a list of legs")?.iter().zip(&platform.legs) {
        if let Some(entry) = item.fields("a leg")?.optional("limits") {
            leg_limits.push(Limits {
                joint: leg.name.clone(),
                range: limits(&entry, leg.is_angle(), mechanism.degrees)?,
            });
        }
    }
    Ok(leg_limits)
}

/// `[low, high]` in radians or lengths.
fn limits(entry: &Entry<'_>, is_angle: bool, degrees: bool) -> Result<[f64; 2], MechanismError> {
    let items = entry.items("[low, high]")?;
    let [low, high] = &items[..] else {
        return Err(entry.error(format!(
            "expected [low, high], found {}",
            counted(items.len(), "value")
        )));
    };
    let value = |entry: &Entry<'_>| -> Result<f64, MechanismError> {
        if is_angle {
            Ok(entry.angle(degrees, false)?.angle.radians)
        } else {
            entry.double()
        }
    };
    let range = [value(low)?, value(high)?];
    if range[0] > range[1] {
        let message = format!(
            "limits are reversed: {} above {}",
            low.describe(),
            high.describe()
        );
        return Err(entry.error(message));
    }
    Ok(range)
}

fn output(entry: &Entry<'_>, mechanism: &Mechanism) -> Result<Output, MechanismError> {
    let mut output = Output {
        link: String::new(),
        point: None,
    };
    if entry.is_object() {
        let fields = entry.fields("a link and a point")?;
        let link = fields.required("link", "the name of a link")?;
        output.link = link.text("the name of a link")?.to_owned();
        if let Some(point) = fields.optional("point") {
            let context = Context {
                space: mechanism.space,
                degrees: mechanism.degrees,
                unit_is_named: true,
                snap: false,
                snapped: Vec::new(),
            };
            output.point = Some(context.vector(&point, "a point")?);
        }
        fields.finish()?;
    } else {
        output.link = entry
            .text("the name of a link, or {\"link\", \"point\"}")?
            .to_owned();
    }
    let links = match &mechanism.body {
        Body::Linkage(linkage) => linkage.links.clone(),
        Body::Chain(chain) => (1..=chain.joints.len()).map(link_name).collect(),
        Body::Platform(_) => vec![PLATFORM.to_owned()],
        Body::Framework(_) => return Err(entry.error("a framework has no output")),
    };
    if !links.contains(&output.link) {
        let message = format!(
            "no link \"{}\"; there are {}",
            output.link,
            links.join(", ")
        );
        return Err(entry.error(message));
    }
    Ok(output)
}

/// Makes a point of the last link of an open chain its tool, and one of a platform that of which the place is meant.
fn take_output(entry: &Entry<'_>, output: &Output, body: &mut Body) -> Result<(), MechanismError> {
    let point = output.point.as_ref();
    let point = point.map_or([0.0; 3], |point| std::array::from_fn(|i| point[i].to_f64()));
    match body {
        Body::Chain(chain) if !chain.closed => {
            let last = link_name(chain.joints.len());
            if output.link != last {
                return Err(entry.error(format!(
                    "the output of an open chain is a point of its last link, {last}"
                )));
            }
            if chain.tool != Pose::IDENTITY {
                return Err(entry
                    .error("expected one of \"tool\" and \"output\": both say where the tool is"));
            }
            let [x, y, z] = point;
            chain.tool = Pose::shift(x, y, z);
        }
        Body::Platform(platform) => platform.output_point = point,
        _ => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::exact::Angle;
    use num_complex::Complex64;

    fn message(text: &str) -> String {
        match read("m", text.as_bytes(), &ReadOptions::default()) {
            Ok(_) => "read".into(),
            Err(e) => e.to_string(),
        }
    }

    #[test]
    fn errors_name_file_line_and_field() {
        for (text, wanted) in [
            (
                "{\n\"serial\": {\"joints\": [\n{\"name\": \"a\", \"alfa\": 1}]}}",
                "m:3: serial.joints[0]: unknown field \"alfa\"",
            ),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\", \"d\": true}]}}",
                "m:1: serial.joints[0].d: expected a number",
            ),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\"}, {\"name\": \"a\"}]}}",
                "m:1: serial.joints[1].name: the name \"a\" stands for two things",
            ),
            (
                "{\"links\": [\"g\", \"k\"], \"joints\": [\n{\"name\": \"a\", \"type\": \"R\", \"links\": [\"g\", \"x\"]}]}",
                "m:2: joints[0].links[1]: there is no link \"x\"; there are g, k",
            ),
            ("{\"name\": \"a\"}", "m:1: the mechanism has no body"),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\"}]}, \"limits\": {\"a\": [3, 2]}}",
                "m:1: limits.a: limits are reversed: the number 3 above the number 2",
            ),
            (
                "{\"angles\": \"deg\", \"serial\": {\"joints\": [{\"name\": \"a\"}]}, \"limits\": {\"a\": [170, -170]}}",
                "m:1: limits.a: limits are reversed: the number 170 above the number -170",
            ),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\"}]}, \"inputs\": [\"b\"]}",
                "m:1: inputs[0]: no joint \"b\" that can be driven; there are a",
            ),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\"}, {\"name\": \"b\"}]}, \"output\": \"link1\"}",
                "m:1: output: the output of an open chain is a point of its last link, link2",
            ),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\"}], \"tool\": {\"position\": [0, 0, 1]}}, \"output\": \"link1\"}",
                "m:1: output: expected one of \"tool\" and \"output\"",
            ),
            (
                "{\"serial\": {\"joints\": [{\"name\": \"a\"}]}, \"output\": \"hand\"}",
                "m:1: output: no link \"hand\"; there are link1",
            ),
            ("{\"serial\"", "m:1: expected `:`"),
            (
                "space = \"planar\"\n[framework]\npoints = [1]\n",
                "m:3: framework.points[0]: expected a name, found the number 1",
            ),
            ("space = \"planar\"\nspace = \"planar\"\n", "m:2:"),
            (
                "{\"serial\": {\"joints\": [\n{\"name\": \"a\", \"alpha\": 1.5708}]}}",
                "m:2: serial.joints[0].alpha: a right angle in radians",
            ),
            (
                "type,theta,d,a,alpha\nR,0,0,0,x\n",
                "m:2: alpha: expected an angle, found \"x\"",
            ),
        ] {
            let error_text = message(text);
            assert!(
                error_text.starts_with(wanted),
                "{error_text}\n  instead of\n{wanted}"
            );
        }
    }

    #[test]
    fn toml_says_what_json_says() {
        let toml = "space = \"spatial\"\n[platform]\nbase = { A = [1, 0, 0] }\nmoving = { P = [\"3/5\", 0, 0.5] }\n\
                    legs = [{ name = \"L1\", from = \"A\", to = \"P\", type = \"SPS\", limits = [0.8, 1.6] }]\n";
        let json = "{\"space\": \"spatial\", \"platform\": {\"base\": {\"A\": [1, 0, 0]}, \"moving\": {\"P\": [\"3/5\", 0, 0.5]}, \
                    \"legs\": [{\"name\": \"L1\", \"from\": \"A\", \"to\": \"P\", \"type\": \"SPS\", \"limits\": [0.8, 1.6]}]}}";
        let options = ReadOptions::default();
        let read_text = |text: &str| read("m", text.as_bytes(), &options).unwrap();
        assert_eq!(read_text(toml), read_text(json));
        let json_text = crate::mechanism::write::json(&read_text(toml), toml.as_bytes()).unwrap();
        assert_eq!(read_text(&json_text), read_text(json));
    }

    #[test]
    fn modified_rows_move_as_they_should() {
        use crate::mechanism::Body;
        use crate::mechanism::chain::JointValue;
        let row = |k: u32| {
            format!(
                "{{\"name\": \"q{k}\", \"a\": 0.{k}, \"d\": 0.2, \"alpha\": {}, \"theta\": 10}}",
                30 * k
            )
        };
        let text = format!(
            "{{\"serial\": {{\"convention\": \"modified\", \"joints\": [{}, {}, {}]}}}}",
            row(1),
            row(2),
            row(3)
        );
        let read = read("m", text.as_bytes(), &ReadOptions::default()).unwrap();
        let Body::Chain(chain) = &read.body else {
            unreachable!("a chain was written")
        };
        let values = [0.4, -0.9, 1.3];
        let turns: Vec<JointValue> = values
            .iter()
            .map(|x| JointValue::of_real(*x, true))
            .collect();
        // J. Craig: Rx(alpha) Tx(a) Rz(q + theta) Tz(d), row by row.
        let mut wanted = Pose::IDENTITY;
        for (k, q) in (1..).zip(values) {
            let [c, s] = Angle::of_degrees(30.0 * f64::from(k))
                .direction
                .map(Complex64::from);
            let [cq, sq] = Angle::of_radians(q + 10f64.to_radians())
                .direction
                .map(Complex64::from);
            wanted = wanted
                .then(&Pose::about_x(c, s))
                .then(&Pose::shift(0.1 * f64::from(k), 0.0, 0.0))
                .then(&Pose::about_z(cq, sq))
                .then(&Pose::shift(0.0, 0.0, 0.2));
        }
        assert!(chain.tool_pose(&turns).distance(&wanted, 1.0) < 1e-14);
    }
}

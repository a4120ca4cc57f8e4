//! URDF: the chain of joints from a base link to a tip link, with origins, axes and limits.
//!
//! Meshes and masses are ignored. A part that does not fit into a chain is refused with its name and line.

use super::xml_limits::beyond_limits;
use crate::mechanism::chain::{Axis, Chain};
use crate::mechanism::document::{Document, MechanismError};
use crate::mechanism::exact::{Number, read_angle};
use crate::mechanism::pose::Pose;
use crate::mechanism::read_options::{ChainEnds, ReadOptions};
use crate::mechanism::{Body, Limits, MOST_PARTS, Mechanism, Snapped, Space, noted};
use num_complex::Complex64;
use roxmltree::{Node, ParsingOptions};
use std::collections::HashMap;

/// Start of a comment.
const COMMENT: &str = "<!--";
/// Most elements and attributes of a file.
const MOST_NODES: u32 = 1_000_000;

/// A joint of the file.
struct FileJoint<'a, 'input> {
    node: Node<'a, 'input>,
    name: &'a str,
    kind: &'a str,
    parent: &'a str,
    child: &'a str,
}

/// The joint that carries each link, by the name of the link.
type ParentJoints<'j, 'a, 'input> = HashMap<&'a str, &'j FileJoint<'a, 'input>>;

struct Reader<'d> {
    document: Document<'d>,
}

impl Reader<'_> {
    fn error(&self, node: &Node<'_, '_>, message: impl Into<String>) -> MechanismError {
        self.document.error(node.range().start, "", message)
    }

    fn attribute<'a>(&self, node: &Node<'a, '_>, name: &str) -> Result<&'a str, MechanismError> {
        node.attribute(name).ok_or_else(|| {
            let element = node.tag_name().name();
            self.error(node, format!("<{element}> has no attribute \"{name}\""))
        })
    }

    fn triple<'a>(
        &self,
        node: &Node<'a, '_>,
        name: &str,
        joint: &str,
    ) -> Result<Option<[&'a str; 3]>, MechanismError> {
        let Some(text) = node.attribute(name) else {
            return Ok(None);
        };
        let words: Vec<&str> = text.split_whitespace().collect();
        let triple = <[&str; 3]>::try_from(words);
        let bad = |_| {
            let message = format!("joint {joint}: {name} is \"{text}\"; expected three numbers");
            self.error(node, message)
        };
        triple.map(Some).map_err(bad)
    }

    fn length(&self, node: &Node<'_, '_>, joint: &str, text: &str) -> Result<f64, MechanismError> {
        let number = Number::read(text)
            .map(|n| n.to_f64())
            .filter(|x| x.is_finite());
        number.ok_or_else(|| {
            self.error(
                node,
                format!("joint {joint}: expected a number, found \"{text}\""),
            )
        })
    }

    /// All joints, each with its ends.
    fn joints<'a, 'input>(
        &self,
        root: &Node<'a, 'input>,
    ) -> Result<Vec<FileJoint<'a, 'input>>, MechanismError> {
        let mut joints: Vec<FileJoint<'a, 'input>> = Vec::new();
        for node in root.children().filter(|n| n.has_tag_name("joint")) {
            let name = self.attribute(&node, "name")?;
            let end = |tag: &str| -> Result<&'a str, MechanismError> {
                let element = node.children().find(|n| n.has_tag_name(tag));
                let element = element
                    .ok_or_else(|| self.error(&node, format!("joint {name} has no <{tag}>")))?;
                self.attribute(&element, "link")
            };
            let joint = FileJoint {
                node,
                name,
                kind: self.attribute(&node, "type")?,
                parent: end("parent")?,
                child: end("child")?,
            };
            if joints.iter().any(|j| j.name == name) {
                return Err(self.error(&node, format!("the name {name} stands for two joints")));
            }
            if joints.len() >= MOST_PARTS {
                return Err(self.error(&node, format!("more than {MOST_PARTS} joints")));
            }
            joints.push(joint);
        }
        Ok(joints)
    }

    /// The joints from the base to the tip, in order.
    fn chain<'j, 'a, 'input>(
        &self,
        root: &Node<'_, '_>,
        joints: &'j [FileJoint<'a, 'input>],
        ends: &ChainEnds,
    ) -> Result<Vec<&'j FileJoint<'a, 'input>>, MechanismError> {
        let links = self.links(root)?;
        let parent_joints = self.parent_joints(&links, joints)?;
        let tip = self.tip(root, &links, joints, ends)?;
        let base = self.base(root, &links, &parent_joints, ends)?;
        let mut chain = Vec::new();
        let mut link = tip;
        while Some(link) != base {
            let Some(joint) = parent_joints.get(link) else {
                match base {
                    None => break,
                    Some(base) => {
                        let message = format!("no chain of joints leads from {base} to {tip}");
                        return Err(self.error(root, message));
                    }
                }
            };
            if chain.len() > joints.len() {
                return Err(self.error(
                    &joint.node,
                    "the joints form a loop; write it as mechanism.json",
                ));
            }
            chain.push(*joint);
            link = joint.parent;
        }
        chain.reverse();
        Ok(chain)
    }

    /// The names of all links.
    fn links<'a>(&self, root: &Node<'a, '_>) -> Result<Vec<&'a str>, MechanismError> {
        let elements = root.children().filter(|n| n.has_tag_name("link"));
        elements.map(|node| self.attribute(&node, "name")).collect()
    }

    /// The joint that carries each link, by the name of the link; roots have none.
    fn parent_joints<'j, 'a, 'input>(
        &self,
        links: &[&str],
        joints: &'j [FileJoint<'a, 'input>],
    ) -> Result<ParentJoints<'j, 'a, 'input>, MechanismError> {
        let mut parent_joints = HashMap::new();
        for joint in joints {
            for link in [joint.parent, joint.child] {
                if !links.contains(&link) {
                    let message = format!(
                        "joint {} names link \"{link}\", which is not there",
                        joint.name
                    );
                    return Err(self.error(&joint.node, message));
                }
            }
            if let Some(other) = parent_joints.insert(joint.child, joint) {
                return Err(self.error(
                    &joint.node,
                    format!(
                        "link \"{}\" has two parents, by {} and {}: URDF cannot say a loop; write it as mechanism.json",
                        joint.child, other.name, joint.name
                    ),
                ));
            }
        }
        Ok(parent_joints)
    }

    /// The link at the end of the chain: the one that was asked for, `tool0`, or the only link without a child.
    fn tip<'t>(
        &self,
        root: &Node<'_, '_>,
        links: &[&'t str],
        joints: &[FileJoint<'_, '_>],
        ends: &'t ChainEnds,
    ) -> Result<&'t str, MechanismError> {
        let is_parent = |link: &str| joints.iter().any(|j| j.parent == link);
        let tips: Vec<&str> = links.iter().copied().filter(|l| !is_parent(l)).collect();
        match (&ends.tip, &tips[..]) {
            (Some(tip), _) => {
                self.check_link(root, links, tip, "--tip")?;
                Ok(tip.as_str())
            }
            (None, _) if links.contains(&"tool0") => Ok("tool0"),
            (None, [tip]) => Ok(tip),
            (None, []) => Err(self.error(root, "the robot has no links and no joints".to_owned())),
            (None, _) => {
                let message = format!("several tips: {}; choose one with --tip", tips.join(", "));
                Err(self.error(root, message))
            }
        }
    }

    /// The link where the chain begins, if it was asked for; `None` for the only root.
    fn base<'t>(
        &self,
        root: &Node<'_, '_>,
        links: &[&str],
        parent_joints: &ParentJoints<'_, '_, '_>,
        ends: &'t ChainEnds,
    ) -> Result<Option<&'t str>, MechanismError> {
        let roots: Vec<&str> = links
            .iter()
            .copied()
            .filter(|l| !parent_joints.contains_key(l))
            .collect();
        match (&ends.base, &roots[..]) {
            (Some(base), _) => {
                self.check_link(root, links, base, "--base")?;
                Ok(Some(base.as_str()))
            }
            (None, [_]) => Ok(None),
            (None, []) => Err(self.error(
                root,
                "every link has a parent: the joints form a loop; write it as mechanism.json",
            )),
            (None, _) => {
                let message = format!(
                    "several roots: {}; choose one with --base",
                    roots.join(", ")
                );
                Err(self.error(root, message))
            }
        }
    }

    /// Refuses the name of a link, given by an option, that the file does not have.
    fn check_link(
        &self,
        root: &Node<'_, '_>,
        links: &[&str],
        name: &str,
        option: &str,
    ) -> Result<(), MechanismError> {
        if links.contains(&name) {
            return Ok(());
        }
        let message = format!(
            "{option} {name}: there is no such link; there are {}",
            links.join(", ")
        );
        Err(self.error(root, message))
    }

    /// The pose of a joint's `<origin>`.
    fn origin(
        &self,
        joint: &FileJoint<'_, '_>,
        snap: bool,
        snapped: &mut Vec<Snapped>,
    ) -> Result<Pose, MechanismError> {
        let Some(node) = joint.node.children().find(|n| n.has_tag_name("origin")) else {
            return Ok(Pose::IDENTITY);
        };
        let mut position = [0.0; 3];
        if let Some(words) = self.triple(&node, "xyz", joint.name)? {
            for (value, word) in position.iter_mut().zip(words) {
                *value = self.length(&node, joint.name, word)?;
            }
        }
        let mut turned = Pose::IDENTITY;
        if let Some(words) = self.triple(&node, "rpy", joint.name)? {
            let mut angles = [crate::mechanism::exact::Angle::ZERO; 3];
            for (angle, word) in angles.iter_mut().zip(words) {
                let read = read_angle(word, false, snap);
                let bad = || {
                    self.error(
                        &node,
                        format!("joint {}: expected an angle, found \"{word}\"", joint.name),
                    )
                };
                *angle = noted(
                    read.ok_or_else(bad)?,
                    &format!("{} rpy", joint.name),
                    snapped,
                );
            }
            turned = Pose::of_roll_pitch_yaw(angles);
        }
        Ok(Pose {
            position: position.map(Complex64::from),
            ..turned
        })
    }

    /// The axis of a moving joint in its own frame.
    fn axis(
        &self,
        joint: &FileJoint<'_, '_>,
        warnings: &mut Vec<String>,
    ) -> Result<[f64; 3], MechanismError> {
        let element = joint.node.children().find(|n| n.has_tag_name("axis"));
        let Some(node) = element else {
            warnings.push(format!(
                "{}: no <axis>; URDF means 1 0 0 by that",
                joint.name
            ));
            return Ok([1.0, 0.0, 0.0]);
        };
        let Some(words) = self.triple(&node, "xyz", joint.name)? else {
            return Err(self.error(&node, format!("joint {}: <axis> has no xyz", joint.name)));
        };
        let mut axis = [0.0; 3];
        for (value, word) in axis.iter_mut().zip(words) {
            *value = self.length(&node, joint.name, word)?;
        }
        if axis == [0.0; 3] {
            return Err(self.error(
                &node,
                format!("joint {}: its axis has length 0", joint.name),
            ));
        }
        Ok(axis)
    }

    fn limits(&self, joint: &FileJoint<'_, '_>) -> Result<Option<Limits>, MechanismError> {
        let element = joint.node.children().find(|n| n.has_tag_name("limit"));
        let Some(node) = element.filter(|_| joint.kind != "continuous") else {
            return Ok(None);
        };
        let value = |name: &str| match node.attribute(name) {
            Some(text) => self.length(&node, joint.name, text).map(Some),
            None => Ok(None),
        };
        let (Some(low), Some(high)) = (value("lower")?, value("upper")?) else {
            return Ok(None);
        };
        if low > high {
            let message = format!(
                "joint {}: limits are reversed: {low} is above {high}",
                joint.name
            );
            return Err(self.error(&node, message));
        }
        Ok(Some(Limits {
            joint: joint.name.to_owned(),
            range: [low, high],
        }))
    }
}

/// First byte of the first macro of xacro, comments apart; a file without one is URDF, even where it declares their namespace.
pub fn first_macro(text: &str) -> Option<usize> {
    let starts: &[&str] = match text.contains("xmlns:xacro") {
        true => &["<xacro:", "${", "$("],
        false => &["<xacro:"],
    };
    let mut at = 0;
    for part in text.split(COMMENT) {
        let markup = match at {
            0 => part,
            _ => part.split_once("-->").map_or("", |(_, markup)| markup),
        };
        if let Some(place) = starts.iter().filter_map(|start| markup.find(start)).min() {
            return Some(at + part.len() - markup.len() + place);
        }
        at += part.len() + COMMENT.len();
    }
    None
}

/// Reads the chain.
pub fn read(document: &Document<'_>, options: &ReadOptions) -> Result<Mechanism, MechanismError> {
    if let Some(at) = first_macro(document.text) {
        return Err(document.error(
            at,
            "",
            "this is a xacro file: install xacro, which is run then, or run it first",
        ));
    }
    if let Some((at, message)) = beyond_limits(document.text) {
        return Err(document.error(at, "", message));
    }
    let parsing = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let xml = roxmltree::Document::parse_with_options(document.text, parsing).map_err(|e| {
        MechanismError {
            file: document.file.to_owned(),
            line: Some(e.pos().row as usize),
            field: String::new(),
            message: e.to_string(),
        }
    })?;
    let reader = Reader {
        document: *document,
    };
    let root = xml.root_element();
    if !root.has_tag_name("robot") {
        let message = format!("expected <robot>, found <{}>", root.tag_name().name());
        return Err(reader.error(&root, message));
    }
    let joints = reader.joints(&root)?;
    let chain = reader.chain(&root, &joints, &options.ends)?;
    let (mut snapped, mut warnings, mut limits) = (Vec::new(), Vec::new(), Vec::new());
    let (mut pose, mut axes) = (Pose::IDENTITY, Vec::new());
    for joint in &chain {
        pose = pose.then(&reader.origin(joint, !options.no_snap, &mut snapped)?);
        if joint.node.children().any(|n| n.has_tag_name("mimic")) {
            let message = format!(
                "joint {} mimics another one, which is no freedom of its own",
                joint.name
            );
            return Err(reader.error(&joint.node, message));
        }
        let is_angle = match joint.kind {
            "fixed" => continue,
            "revolute" | "continuous" => true,
            "prismatic" => false,
            kind => {
                let message = format!(
                    "joint {} is {kind}; expected revolute, continuous, prismatic or fixed on the chain",
                    joint.name
                );
                return Err(reader.error(&joint.node, message));
            }
        };
        let axis = reader.axis(joint, &mut warnings)?;
        limits.extend(reader.limits(joint)?);
        axes.push(Axis {
            name: joint.name.to_owned(),
            is_angle,
            point: pose.position.map(|c| c.re),
            direction: pose.direction(axis.map(Complex64::from)).map(|c| c.re),
        });
    }
    let rows = Chain::of_axes(&axes, pose);
    let rows = rows.ok_or_else(|| reader.error(&root, "no joint between base and tip moves"))?;
    let on_chain = |j: &&FileJoint<'_, '_>| chain.iter().any(|c| c.name == j.name);
    let off: Vec<&str> = joints
        .iter()
        .filter(|j| j.kind != "fixed" && !on_chain(j))
        .map(|j| j.name)
        .collect();
    if !off.is_empty() {
        warnings.push(format!("not on the chain: {}", off.join(", ")));
    }
    Ok(Mechanism {
        file: document.file.to_owned(),
        name: root.attribute("name").unwrap_or(document.file).to_owned(),
        space: Space::Spatial,
        degrees: false,
        body: Body::Chain(Box::new(rows)),
        inputs: Vec::new(),
        output: None,
        limits,
        snapped,
        warnings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::chain::JointValue;
    use crate::mechanism::read;

    /// Two links that turn, a fixed tool; `{}` stands in the second joint.
    const ARM: &str = r#"<robot name="arm">
<link name="base"/><link name="one"/><link name="two"/><link name="tool"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="one"/>
<origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-1" upper="2"/></joint>
<joint name="j2" type="TYPE"><parent link="PARENT"/><child link="two"/>
<origin xyz="0.3 0 0" rpy="ANGLE 0 0"/>AXIS</joint>
<joint name="end" type="fixed"><parent link="two"/><child link="tool"/><origin xyz="0 0 0.2"/></joint>
</robot>"#;

    fn arm(changes: &[(&str, &str)]) -> Result<Mechanism, String> {
        let mut text = ARM.to_owned();
        let usual = [
            ("TYPE", "continuous"),
            ("PARENT", "one"),
            ("ANGLE", "1.5708"),
            ("AXIS", "<axis xyz=\"0 0 2\"/>"),
        ];
        for (from, to) in changes.iter().chain(&usual) {
            text = text.replacen(from, to, 1);
        }
        read("arm.urdf", text.as_bytes(), &ReadOptions::default()).map_err(|e| e.to_string())
    }

    /// Attack M of the third attack on the service (2026-11): 80,000 attributes took a minute.
    #[test]
    fn an_element_of_many_attributes_is_refused_by_their_number() {
        let many: String = (0..80_000).map(|k| format!(" a{k}=\"\"")).collect();
        let text = format!("<robot>\n<link{many}/></robot>");
        let document = Document {
            file: "a.urdf",
            text: &text,
        };
        let refused = super::read(&document, &ReadOptions::default()).unwrap_err();
        assert_eq!(refused.line, Some(2));
        assert!(refused.message.contains("64 attributes"), "{refused}");
    }

    #[test]
    fn the_chain_moves_as_the_file_says() {
        let arm = arm(&[]).unwrap();
        let Body::Chain(chain) = &arm.body else {
            unreachable!("URDF is a chain")
        };
        // j1 by 90 degrees: j2 at (0, 0.3, 0.5), its axis, -y of link one, along +x; the tool 0.2 along it.
        let values = [
            JointValue::of_real(std::f64::consts::FRAC_PI_2, true),
            JointValue::of_real(0.7, true),
        ];
        let tool = chain.tool_pose(&values).position.map(|c| c.re);
        for (x, wanted) in tool.into_iter().zip([0.2, 0.3, 0.5]) {
            assert!((x - wanted).abs() < 1e-15, "{tool:?}");
        }
        assert_eq!(arm.limits_of("j1"), Some([-1.0, 2.0]));
        assert_eq!(arm.limits_of("j2"), None);
        assert_eq!(
            arm.snapping_warnings(),
            ["j2 rpy: 1.5708 is read as 90 deg; --no-snap takes it as written"]
        );
    }

    #[test]
    fn what_is_no_chain_is_refused_by_name_and_line() {
        let message = |changes: &[(&str, &str)]| arm(changes).unwrap_err();
        assert_eq!(
            message(&[("TYPE", "floating")]),
            "arm.urdf:5: joint j2 is floating; expected revolute, continuous, prismatic or fixed on the chain"
        );
        assert_eq!(
            message(&[("AXIS", "<axis xyz=\"0 0 1\"/><mimic joint=\"j1\"/>")]),
            "arm.urdf:5: joint j2 mimics another one, which is no freedom of its own"
        );
        assert_eq!(
            message(&[("AXIS", "<axis xyz=\"0 0 0\"/>")]),
            "arm.urdf:6: joint j2: its axis has length 0"
        );
        assert_eq!(
            message(&[("AXIS", "<axis xyz=\"0 0\"/>")]),
            "arm.urdf:6: joint j2: xyz is \"0 0\"; expected three numbers"
        );
        assert_eq!(
            message(&[("ANGLE", "x")]),
            "arm.urdf:6: joint j2: expected an angle, found \"x\""
        );
        assert_eq!(
            message(&[("PARENT", "nobody")]),
            "arm.urdf:5: joint j2 names link \"nobody\", which is not there"
        );
        assert_eq!(
            message(&[("lower=\"-1\"", "lower=\"3\"")]),
            "arm.urdf:4: joint j1: limits are reversed: 3 is above 2"
        );
        assert!(
            message(&[(
                "<parent link=\"two\"/><child link=\"tool\"/>",
                "<parent link=\"base\"/><child link=\"two\"/>"
            )])
            .starts_with(
                "arm.urdf:7: link \"two\" has two parents, by j2 and end: URDF cannot say a loop"
            )
        );
        assert!(
            message(&[
                (
                    "<link name=\"tool\"/>",
                    "<link name=\"tool\"/><link name=\"a\"/>"
                ),
                ("PARENT", "one")
            ])
            .contains("several tips: tool, a; choose one with --tip")
        );
        let empty = read("arm.urdf", b"<robot></robot>", &ReadOptions::default());
        assert_eq!(
            empty.unwrap_err().to_string(),
            "arm.urdf:1: the robot has no links and no joints"
        );
        for (old, new, line) in [
            ("ANGLE", "${angle}", 6),
            ("</robot>", "<xacro:wrist/></robot>", 8),
        ] {
            let macros = message(&[("<robot name", "<robot xmlns:xacro=\"x\" name"), (old, new)]);
            let expected = format!(
                "arm.urdf:{line}: this is a xacro file: install xacro, which is run then, or run it first"
            );
            assert_eq!(macros, expected);
        }
        assert!(message(&[("</robot>", "")]).starts_with("arm.urdf:"));
        assert!(message(&[("<robot name", "<!DOCTYPE x><robot name")]).starts_with("arm.urdf:"));
    }

    /// As xacro leaves it: the namespace, and comments of the file that it expanded.
    #[test]
    fn a_namespace_of_macros_without_macros_is_read() {
        let name = "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" name";
        let plain = arm(&[]).unwrap();
        let expanded = arm(&[
            ("<robot name", name),
            ("</robot>", "<!-- <xacro:wrist/> ${angle} --></robot>"),
        ]);
        assert_eq!(expanded.unwrap(), plain);
    }

    #[test]
    fn a_missing_axis_is_said() {
        let arm = arm(&[("AXIS", "")]).unwrap();
        assert_eq!(arm.warnings, ["j2: no <axis>; URDF means 1 0 0 by that"]);
    }
}

//! Links and joints in general: a spanning tree of joints, loops cut at the joints that are left, rods as distances.
//!
//! In space and about a point. Turns are cosine and sine; a body about a point that only rods hold is a quaternion.

use super::formulation::{
    Configuration, Family, Formulation, Lifted, Problem, Question, Target, overdriven, turn_of,
    unbalanced,
};
use super::linkage_pose::{
    Branch, Elements, elements, input_parameters, real, side_frame, size, spanning_tree,
};
use super::text::{self, Equations, TextPose};
use crate::mechanism::chain::JointValue;
use crate::mechanism::exact::double_expression;
use crate::mechanism::graph::is_rod;
use crate::mechanism::pose::{Pose, Vector3, dot, unit};
use crate::mechanism::{Joint, JointKind, Linkage, Mechanism, MechanismError, Output, Space};
use crate::plane::modulus;
use num_complex::Complex64;
use std::sync::Arc;

/// A square that is not 0 where a quaternion is a rotation.
const NORM: &str = "e0^2+e1^2+e2^2+e3^2";

/// The formulation of a linkage in space.
pub fn compile(
    mechanism: &Mechanism,
    linkage: &Linkage,
    question: &Question,
    inputs: Vec<String>,
) -> Result<Box<dyn Formulation>, MechanismError> {
    if !question.locks.is_empty() || question.problem == Problem::Inverse {
        return Err(mechanism.error(
            "not in this version: poses and locks of linkages in space; drive them by --input",
        ));
    }
    // One input is tried whatever counting says: overconstrained loops move by their special dimensions.
    if question.problem == Problem::Forward && inputs.len() > 1 {
        overdriven(mechanism, &inputs)?;
    }
    let place = |name: &String| linkage.joints.iter().position(|j| j.name == *name);
    let driven: Vec<usize> = inputs.iter().filter_map(place).collect();
    let spherical = mechanism.space == Space::Spherical;
    let rods = rods(linkage, &driven, spherical);
    let rod_links: Vec<usize> = rods.iter().map(|r| r.link).collect();
    let tree = spanning_tree(linkage, &driven, &rod_links);
    let reached = |link: usize| link == linkage.ground || tree.iter().any(|b| b.links[1] == link);
    let loose: Vec<usize> = (0..linkage.links.len())
        .filter(|l| !reached(*l) && !rod_links.contains(l))
        .collect();
    let free_body = match loose[..] {
        [] => None,
        [one] if spherical => Some(one),
        _ => {
            let names: Vec<&str> = loose.iter().map(|l| linkage.links[*l].as_str()).collect();
            return Err(mechanism.error(format!(
                "not in this version: {} hang on balls or rods alone; say a platform on legs as \"platform\"",
                names.join(", ")
            )));
        }
    };
    let cut: Vec<usize> = (0..linkage.joints.len())
        .filter(|j| !tree.iter().any(|b| b.joint == *j))
        .filter(|j| {
            !linkage.joints[*j]
                .links
                .iter()
                .any(|l| rod_links.contains(l))
        })
        .collect();
    if let Some(j) = cut.iter().find(|j| driven.contains(j)) {
        let name = &linkage.joints[*j].name;
        return Err(mechanism.error(format!(
            "not in this version: {name} is driven and closes a loop of driven joints"
        )));
    }
    let mut moves = Vec::new();
    for branch in &tree {
        let joint = &linkage.joints[branch.joint];
        let Some(joint_moves) = elements(joint, linkage.at_home) else {
            return Err(mechanism.error(format!(
                "joint {}: its directions give no frame (U needs the home position)",
                joint.name
            )));
        };
        moves.push(if branch.is_reversed {
            joint_moves.reversed()
        } else {
            joint_moves
        });
    }
    let mut loops = Loops {
        linkage: linkage.clone(),
        spherical,
        rods,
        tree,
        moves,
        cut,
        driven,
        free_body,
        inputs,
        output: mechanism.output.clone(),
        family: Family {
            name: String::new(),
            expected: None,
            source: "not known",
            representation: "cosines and sines of joints, loops cut at joints, rods as distances",
        },
        equations: Equations::default(),
    };
    loops.write_equations(mechanism, question.problem)?;
    Ok(Box::new(loops))
}

/// A link that only holds two joints apart: two balls, or two axes about a point.
#[derive(Clone, Debug, PartialEq)]
struct Rod {
    link: usize,
    /// Numbers of the two joints of the rod.
    joints: [usize; 2],
    /// The distance of its balls, or the cosine of the angle of its axes.
    measure: f64,
}

/// Links that disappear; of neighbours the one farther from the ground.
fn rods(linkage: &Linkage, driven: &[usize], spherical: bool) -> Vec<Rod> {
    let distance = distances(linkage);
    let mut order: Vec<usize> = (0..linkage.links.len())
        .filter(|l| *l != linkage.ground)
        .collect();
    order.sort_by_key(|l| std::cmp::Reverse(distance[*l]));
    let mut rods: Vec<Rod> = Vec::new();
    for link in order {
        let joints = linkage.joints_of(link);
        let [a, b] = joints[..] else { continue };
        let fits = if spherical {
            !driven.contains(&a) && !driven.contains(&b)
        } else {
            is_rod(linkage, link)
        };
        let other = |j: usize| linkage.joints[j].links.iter().copied().find(|l| *l != link);
        let beside = [a, b]
            .iter()
            .any(|j| rods.iter().any(|r| Some(r.link) == other(*j)));
        // A link at the ground is kept: about a point it is a turn, which is less than a rotation.
        let at_ground = spherical && [a, b].iter().any(|j| other(*j) == Some(linkage.ground));
        if !fits || beside || at_ground {
            continue;
        }
        let side = |j: usize| {
            let joint = &linkage.joints[j];
            &joint.sides[usize::from(joint.links[1] == link)]
        };
        let measure = if spherical {
            let axis = |j: usize| unit(real(&side(j).axis)).unwrap_or([0.0, 0.0, 1.0]);
            dot(axis(a), axis(b))
        } else {
            let (p, q) = (real(&side(a).point), real(&side(b).point));
            let away: [f64; 3] = std::array::from_fn(|k| p[k] - q[k]);
            dot(away, away).sqrt()
        };
        rods.push(Rod {
            link,
            joints: [a, b],
            measure,
        });
    }
    rods
}

/// Joints between every link and the ground.
fn distances(linkage: &Linkage) -> Vec<usize> {
    let mut distance = vec![usize::MAX; linkage.links.len()];
    distance[linkage.ground] = 0;
    for _ in 0..linkage.links.len() {
        for joint in &linkage.joints {
            let [a, b] = joint.links;
            distance[a] = distance[a].min(distance[b].saturating_add(1));
            distance[b] = distance[b].min(distance[a].saturating_add(1));
        }
    }
    distance
}

struct Loops {
    linkage: Linkage,
    spherical: bool,
    rods: Vec<Rod>,
    tree: Vec<Branch>,
    /// How each joint of the tree moves, away from the ground.
    moves: Vec<Elements>,
    /// Joints at which loops are cut.
    cut: Vec<usize>,
    driven: Vec<usize>,
    /// A body that only rods hold.
    free_body: Option<usize>,
    inputs: Vec<String>,
    output: Option<Output>,
    family: Family,
    equations: Equations,
}

impl Loops {
    /// The far end of a rod's joint: its link there, and the joint's side in it.
    fn end(&self, rod: &Rod, which: usize) -> (usize, &crate::mechanism::Side) {
        let joint = &self.linkage.joints[rod.joints[which]];
        let side = usize::from(joint.links[0] == rod.link);
        (joint.links[side], &joint.sides[side])
    }

    fn write_equations(
        &mut self,
        mechanism: &Mechanism,
        problem: Problem,
    ) -> Result<(), MechanismError> {
        let mut equations = Equations::default();
        let poses = self.write_poses(mechanism, &mut equations)?;
        let turns_or_shifts = equations.groups.first().map_or(0, Vec::len);
        let freedoms: usize = self.free_variables().count();
        let mut unknowns = freedoms;
        if self.free_body.is_some() {
            if turns_or_shifts > 0 {
                return Err(mechanism.error(
                    "not in this version: about a point, a body held by rods beside links that turn freely",
                ));
            }
            equations.groups = vec![(0..4).map(|k| format!("e{k}")).collect()];
            equations.homogeneous = true;
            equations.degenerate.push(("no pose", NORM.into()));
            unknowns += 3;
        }
        let mut conditions = 0;
        for rod in &self.rods {
            let ends = [0, 1].map(|k| {
                let (link, side) = self.end(rod, k);
                let pose = &poses[link];
                let vector = if self.spherical {
                    pose.direction(&text::doubles(unit(real(&side.axis)).unwrap_or([0.0; 3])))
                } else {
                    pose.point(&text::vector(&side.point))
                };
                (vector, self.scale(link))
            });
            let equation = if self.spherical {
                let product = text::times(&ends[0].1, &ends[1].1);
                let cosine = text::times(&double_expression(rod.measure), &product);
                format!("{}-{cosine}", text::dot(&ends[0].0, &ends[1].0))
            } else {
                let away: [String; 3] =
                    std::array::from_fn(|i| text::minus(&ends[0].0[i], &ends[1].0[i]));
                format!(
                    "{}-{}^2",
                    text::dot(&away, &away),
                    double_expression(rod.measure)
                )
            };
            equations.equations.push(equation);
            conditions += 1;
        }
        for &j in &self.cut {
            let joint = self.linkage.joints[j].clone();
            self.cut_equations(&joint, &poses, &mut equations);
            let lost = if self.spherical { 3 } else { 6 } - joint.kind.freedoms();
            conditions += lost as usize;
        }
        if problem == Problem::Forward {
            unbalanced(mechanism, &self.inputs, unknowns, conditions)?;
        }
        self.describe(unknowns);
        if let Some(gap) = equations.drop_identities(mechanism, super::size(mechanism))? {
            return Err(mechanism.error(gap));
        }
        if equations.groups.is_empty() || equations.equations.is_empty() {
            return Err(
                mechanism.error("nothing is left to solve: every link is where the inputs put it")
            );
        }
        self.equations = equations;
        Ok(())
    }

    fn describe(&mut self, unknowns: usize) {
        let letters = |list: &[Joint]| list.iter().map(|j| j.kind.letter()).collect::<String>();
        self.family.name = match (self.spherical, self.linkage.joints.len()) {
            (true, _) => format!("spherical linkage of {} links", self.linkage.links.len()),
            (false, n) if n <= 8 => letters(&self.linkage.joints),
            _ => format!("linkage of {} links", self.linkage.links.len()),
        };
        if self.free_body.is_some() && self.rods.len() == 3 {
            self.family.expected = Some(8);
            self.family.source = "three quadrics in a quaternion";
            self.family.representation = "a quaternion, an angle for every leg";
        }
        let one_turn = unknowns == 1 && self.rods.len() == 1 && self.cut.is_empty();
        if one_turn && self.free_body.is_none() {
            self.family.expected = Some(2);
            self.family.source = "a circle and a sphere";
        }
    }

    /// Free elements of the tree: branch, place in it, whether it turns.
    fn free_variables(&self) -> impl Iterator<Item = (usize, usize, bool)> + '_ {
        self.tree.iter().enumerate().flat_map(move |(b, branch)| {
            let free = !self.driven.contains(&branch.joint);
            let parts = self.moves[b].parts.iter().enumerate();
            parts
                .filter(move |_| free)
                .map(move |(e, (_, turns))| (b, e, *turns))
        })
    }

    /// Factor of the rotation of a link, as an expression.
    fn scale(&self, link: usize) -> String {
        if self.free_body == Some(link) {
            format!("({NORM})")
        } else {
            "1".into()
        }
    }

    /// Poses of all links as expressions; variables and parameters on the way.
    fn write_poses(
        &self,
        mechanism: &Mechanism,
        equations: &mut Equations,
    ) -> Result<Vec<TextPose>, MechanismError> {
        let identity = TextPose::constant(&Pose::IDENTITY);
        let mut poses = vec![identity; self.linkage.links.len()];
        let mut variables = Vec::new();
        for name in &self.inputs {
            // Parameters in the order of the inputs.
            let Some(j) = self
                .linkage
                .joints
                .iter()
                .position(|joint| joint.name == *name)
            else {
                return Err(mechanism.error(format!("there is no joint {name}")));
            };
            match self.linkage.joints[j].kind {
                JointKind::R => {
                    text::turn(equations, &format!("{}", j + 1));
                }
                _ => equations.parameters.push(format!("shift_{}", j + 1)),
            }
        }
        for (b, branch) in self.tree.iter().enumerate() {
            let number = branch.joint + 1;
            let driven = self.driven.contains(&branch.joint);
            let mut pose = poses[branch.links[0]].clone();
            for (e, (before, turns)) in self.moves[b].parts.iter().enumerate() {
                let name = format!("{}_{}", number, e + 1);
                let sign = if branch.is_reversed { "(-1)" } else { "1" };
                let element = match (turns, driven) {
                    (true, true) => TextPose::about_z(
                        &format!("c_{number}"),
                        &text::times(sign, &format!("s_{number}")),
                    ),
                    (false, true) => {
                        let shift = text::times(sign, &format!("shift_{number}"));
                        TextPose::shift(["0".into(), "0".into(), shift])
                    }
                    (true, false) => {
                        let (c, s) = (format!("c{name}"), format!("s{name}"));
                        equations.equations.push(format!("{c}^2+{s}^2-1"));
                        variables.extend([c.clone(), s.clone()]);
                        TextPose::about_z(&c, &s)
                    }
                    (false, false) => {
                        let d = format!("d{name}");
                        variables.push(d.clone());
                        TextPose::shift(["0".into(), "0".into(), d])
                    }
                };
                pose = pose
                    .then(&TextPose::constant(before), &format!("m{name}a"), equations)
                    .then(&element, &format!("m{name}b"), equations);
            }
            let after = TextPose::constant(&self.moves[b].after);
            poses[branch.links[1]] = pose.then(&after, &format!("m{number}c"), equations);
        }
        if !variables.is_empty() {
            equations.groups = vec![variables];
        }
        if let Some(link) = self.free_body {
            poses[link].rotation = [
                ["e0^2+e1^2-e2^2-e3^2", "2*(e1*e2-e0*e3)", "2*(e1*e3+e0*e2)"],
                ["2*(e1*e2+e0*e3)", "e0^2-e1^2+e2^2-e3^2", "2*(e2*e3-e0*e1)"],
                ["2*(e1*e3-e0*e2)", "2*(e2*e3+e0*e1)", "e0^2-e1^2-e2^2+e3^2"],
            ]
            .map(|row| row.map(|entry| format!("({entry})")));
        }
        Ok(poses)
    }

    /// Equations of a loop that is cut at a joint.
    fn cut_equations(&self, joint: &Joint, poses: &[TextPose], equations: &mut Equations) {
        let [a, b] = joint.links;
        let [first, second] = &joint.sides;
        let axis_of = |side: &crate::mechanism::Side| {
            text::doubles(unit(real(&side.axis)).unwrap_or([0.0; 3]))
        };
        let scales = [self.scale(b), self.scale(a)];
        let same = |p: [String; 3], q: [String; 3], equations: &mut Equations| {
            for (p, q) in p.iter().zip(&q) {
                let (p, q) = (text::times(p, &scales[0]), text::times(q, &scales[1]));
                equations.equations.push(text::minus(&p, &q));
            }
        };
        let points = [
            poses[a].point(&text::vector(&first.point)),
            poses[b].point(&text::vector(&second.point)),
        ];
        let axes = [
            poses[a].direction(&axis_of(first)),
            poses[b].direction(&axis_of(second)),
        ];
        let [p, q] = points;
        let [y, z] = axes;
        let away: [String; 3] = std::array::from_fn(|i| text::minus(&q[i], &p[i]));
        let across = |v: &[String; 3], w: &[String; 3], equations: &mut Equations| {
            for (i, j) in [(1, 2), (2, 0), (0, 1)] {
                let (x, y) = (text::times(&v[i], &w[j]), text::times(&v[j], &w[i]));
                equations.equations.push(text::minus(&x, &y));
            }
        };
        match joint.kind {
            JointKind::S => same(p, q, equations),
            JointKind::R => {
                if !self.spherical {
                    same(p, q, equations);
                }
                same(y, z, equations);
            }
            JointKind::C => {
                across(&away, &y, equations);
                same(y, z, equations);
            }
            JointKind::E => {
                equations.equations.push(text::dot(&away, &y));
                same(y, z, equations);
            }
            JointKind::P => {
                across(&away, &y, equations);
                if let (Some(f), Some(g)) = (
                    side_frame(first, joint.kind),
                    side_frame(second, joint.kind),
                ) {
                    for k in 0..3 {
                        let column = |f: &Pose| text::doubles(f.column(k).map(|c| c.re));
                        let (u, v) = (
                            poses[a].direction(&column(&f)),
                            poses[b].direction(&column(&g)),
                        );
                        same(u, v, equations);
                    }
                }
            }
            JointKind::U => {
                same(p, q, equations);
                if let Some(other) = &second.second {
                    let other = unit(real(other)).unwrap_or([0.0; 3]);
                    let axis = unit(real(&first.axis)).unwrap_or([0.0; 3]);
                    let turned = poses[b].direction(&text::doubles(other));
                    let cosine = double_expression(dot(axis, other));
                    equations
                        .equations
                        .push(text::minus(&text::dot(&y, &turned), &cosine));
                }
            }
        }
    }

    /// Values of all joints of the tree at a solution.
    fn tree_values(&self, parameters: &[Complex64], point: &[Complex64]) -> Vec<Vec<JointValue>> {
        let mut given: Vec<(usize, JointValue)> = Vec::new();
        let mut place = 0;
        for name in &self.inputs {
            let Some(j) = self
                .linkage
                .joints
                .iter()
                .position(|joint| joint.name == *name)
            else {
                continue;
            };
            if self.linkage.joints[j].kind == JointKind::R {
                let (c, s) = turn_of(parameters[place], parameters[place + 1]);
                given.push((j, JointValue::Turn(c, s)));
                place += 2;
            } else {
                given.push((j, JointValue::Shift(parameters[place])));
                place += 1;
            }
        }
        let mut next = point.iter().copied();
        let mut take = || next.next().unwrap_or_default();
        self.tree
            .iter()
            .zip(&self.moves)
            .map(|(branch, moves)| {
                if let Some((_, value)) = given.iter().find(|(j, _)| *j == branch.joint) {
                    return vec![if branch.is_reversed {
                        negated(*value)
                    } else {
                        *value
                    }];
                }
                let value = |(_, turns): &(Pose, bool)| {
                    if *turns {
                        let c = take();
                        JointValue::Turn(c, take())
                    } else {
                        JointValue::Shift(take())
                    }
                };
                moves.parts.iter().map(value).collect()
            })
            .collect()
    }

    /// The largest gap of rods and cut joints, and values of the joints that have one.
    fn closing(
        &self,
        poses: &[Pose],
        values: &[Vec<JointValue>],
    ) -> (f64, Vec<(Arc<str>, JointValue)>) {
        let size = size(&self.linkage);
        let scale = 1.0
            + poses
                .iter()
                .flat_map(|p| p.rotation)
                .flatten()
                .map(|c| c.norm_sqr())
                .fold(0.0, f64::max);
        let mut most = 0.0f64;
        let complex = |v: [f64; 3]| v.map(Complex64::from);
        for rod in &self.rods {
            let ends: [Vector3; 2] = [0, 1].map(|k| {
                let (link, side) = self.end(rod, k);
                if self.spherical {
                    poses[link].direction(complex(unit(real(&side.axis)).unwrap_or([0.0; 3])))
                } else {
                    poses[link].point(complex(real(&side.point)))
                }
            });
            let error = if self.spherical {
                let product: Complex64 = (0..3).map(|i| ends[0][i] * ends[1][i]).sum();
                modulus(product - rod.measure)
            } else {
                let square: Complex64 = (0..3)
                    .map(|i| (ends[0][i] - ends[1][i]) * (ends[0][i] - ends[1][i]))
                    .sum();
                modulus(square - rod.measure * rod.measure) / (size * size)
            };
            most = most.max(error / scale);
        }
        let mut joint_values = Vec::new();
        for (j, joint) in self.linkage.joints.iter().enumerate() {
            let single = matches!(joint.kind, JointKind::R | JointKind::P);
            if let Some(b) = self.tree.iter().position(|branch| branch.joint == j) {
                if single {
                    let value = values[b][0];
                    let value = if self.tree[b].is_reversed {
                        negated(value)
                    } else {
                        value
                    };
                    joint_values.push((joint.name.as_str().into(), value));
                }
                continue;
            }
            if !self.cut.contains(&j) {
                continue;
            }
            let [Some(f), Some(g)] = [0, 1].map(|k| side_frame(&joint.sides[k], joint.kind)) else {
                continue;
            };
            let between = poses[joint.links[0]]
                .then(&f)
                .inverse()
                .then(&poses[joint.links[1]].then(&g));
            most = most.max(cut_gap(joint.kind, &between, size, self.spherical) / scale);
            match joint.kind {
                JointKind::R => {
                    let value = JointValue::Turn(between.rotation[0][0], between.rotation[1][0]);
                    joint_values.push((joint.name.as_str().into(), value));
                }
                JointKind::P => joint_values.push((
                    joint.name.as_str().into(),
                    JointValue::Shift(between.position[2]),
                )),
                _ => {}
            }
        }
        (most, joint_values)
    }
}

fn negated(value: JointValue) -> JointValue {
    match value {
        JointValue::Turn(c, s) => JointValue::Turn(c, -s),
        JointValue::Shift(d) => JointValue::Shift(-d),
    }
}

/// How far the pose between the two sides of a joint is from one that the joint allows.
fn cut_gap(kind: JointKind, between: &Pose, size: f64, spherical: bool) -> f64 {
    let p = between.position.map(|c| modulus(c) / size);
    let axis = modulus(between.rotation[0][2]).max(modulus(between.rotation[1][2]));
    let place = p[0].max(p[1]).max(p[2]);
    match kind {
        JointKind::R if spherical => axis,
        JointKind::R => axis.max(place),
        JointKind::S => place,
        JointKind::C => axis.max(p[0]).max(p[1]),
        JointKind::E => axis.max(p[2]),
        JointKind::P => between
            .distance(
                &Pose {
                    position: between.position,
                    ..Pose::IDENTITY
                },
                1.0,
            )
            .max(p[0])
            .max(p[1]),
        JointKind::U => place,
    }
}

impl Formulation for Loops {
    fn family(&self) -> &Family {
        &self.family
    }

    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn equations(&self) -> Option<&Equations> {
        Some(&self.equations)
    }

    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        let Target::Inputs(values) = target else {
            return Err("expected values of the inputs".into());
        };
        Ok(input_parameters(&self.linkage, &self.inputs, values))
    }

    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        let count = self.equations.parameters.len();
        (count > 0).then(|| (0..count).map(|_| draw()).collect())
    }

    fn lift(&self, _: Option<&Target>, parameters: &[Complex64], point: &[Complex64]) -> Lifted {
        let values = self.tree_values(parameters, point);
        let mut poses = vec![Pose::IDENTITY; self.linkage.links.len()];
        for ((branch, moves), values) in self.tree.iter().zip(&self.moves).zip(&values) {
            poses[branch.links[1]] = poses[branch.links[0]].then(&moves.pose(values));
        }
        if let Some(link) = self.free_body {
            let e = [point[0], point[1], point[2], point[3]];
            match Pose::of_quaternion(e, [Complex64::default(); 3]) {
                Some(pose) => poses[link] = pose,
                None => return Lifted::Degenerate("no pose"),
            }
        }
        let (residual, values) = self.closing(&poses, &values);
        let is_body = |l: &usize| !self.rods.iter().any(|r| r.link == *l);
        let output = self.output.as_ref().and_then(|output| {
            let mut links = self.linkage.links.iter();
            let link = links.position(|l| *l == output.link).filter(is_body)?;
            let point = output.point.as_ref().map_or([0.0; 3], real);
            Some(Pose {
                position: poses[link].point(point.map(Complex64::from)),
                ..poses[link]
            })
        });
        let bodies = (0..poses.len())
            .filter(is_body)
            .map(|l| (self.linkage.links[l].as_str().into(), poses[l]));
        Lifted::Position(Box::new(Configuration {
            output,
            values,
            bodies: bodies.collect(),
            residual,
        }))
    }
}

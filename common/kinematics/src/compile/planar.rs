//! Linkages in the plane: a turn g of every link that is free, its conjugate G, g G = 1, and a pair of equations a
//! loop; links that a given turn or a shift ties together share one g. Two groups.

pub(super) mod velocities;

use super::formulation::{
    Configuration, Family, Formulation, Lifted, PathText, Problem, Question, Target, overdriven,
    unbalanced,
};
use super::linkage_pose::{input_parameters, real, size};
use super::planar_platform::isotropic_pose;
use super::text::{self, Equations, complex};
use crate::mechanism::chain::JointValue;
use crate::mechanism::exact::{Number, Surd, double_expression, expression};
use crate::mechanism::pose::Pose;
use crate::mechanism::{Joint, JointKind, Linkage, Mechanism, MechanismError, Side, Vector};
use crate::plane::{modulus, unit};
use cognate_numeric::rational::Rational;
use num_complex::Complex64;

/// The formulation of a planar linkage's question.
pub fn compile(
    mechanism: &Mechanism,
    linkage: &Linkage,
    question: &Question,
    inputs: Vec<String>,
) -> Result<Box<dyn Formulation>, MechanismError> {
    Ok(Box::new(formulated(mechanism, linkage, question, inputs)?))
}

/// The turns and places of the links, with the equations of the question.
pub(super) fn formulated(
    mechanism: &Mechanism,
    linkage: &Linkage,
    question: &Question,
    inputs: Vec<String>,
) -> Result<Planar, MechanismError> {
    if !question.locks.is_empty() {
        return Err(mechanism.error(
            "not in this version: locks of linkages; give the joint as an input (--input)",
        ));
    }
    let output = match (question.problem, &mechanism.output) {
        (Problem::Inverse, None) => {
            return Err(mechanism.error("which link has the pose? name it in the file: \"output\""));
        }
        (_, None) => None,
        (_, Some(output)) => linkage.links.iter().position(|l| *l == output.link),
    };
    if question.problem == Problem::Forward {
        overdriven(mechanism, &inputs)?;
    }
    let place = |name: &String| linkage.joints.iter().position(|j| j.name == *name);
    let driven: Vec<usize> = inputs.iter().filter_map(place).collect();
    let point = mechanism.output.as_ref().and_then(|o| o.point.as_ref());
    let mut planar = Planar {
        linkage: linkage.clone(),
        driven,
        inputs,
        output,
        output_point: point.map_or(Complex64::default(), |p| {
            Complex64::new(p[0].to_f64(), p[1].to_f64())
        }),
        is_inverse: question.problem == Problem::Inverse,
        is_exact: question.problem == Problem::Motion,
        places: Vec::new(),
        turns: Vec::new(),
        tree: Vec::new(),
        family: Family {
            name: format!("planar linkage of {} links", linkage.links.len()),
            expected: None,
            source: "not known",
            representation: "isotropic turns of the links, two groups",
        },
        equations: Equations::default(),
    };
    planar.tie(mechanism)?;
    planar.grow();
    planar.write(mechanism, question.problem)?;
    Ok(planar)
}

/// The turn of a link: that of its class times a factor.
#[derive(Clone, Debug, PartialEq)]
struct Turn {
    /// Number of the class; 0 is the ground's, which does not turn.
    class: usize,
    /// Factors one after another, from the class to the link.
    factors: Vec<Factor>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Factor {
    /// A unit number.
    Constant(Complex64),
    /// The given turn of a joint, or its inverse.
    Given { joint: usize, inverse: bool },
    /// The given turn of the output.
    Output,
}

/// The turns and places of a linkage's links, and its equations.
pub(super) struct Planar {
    linkage: Linkage,
    driven: Vec<usize>,
    inputs: Vec<String>,
    output: Option<usize>,
    output_point: Complex64,
    is_inverse: bool,
    /// Whether multiples of roots are written as such, and not as the nearest doubles.
    is_exact: bool,
    /// The place of each link, and its conjugate, as text.
    places: Vec<[String; 2]>,
    turns: Vec<Turn>,
    /// Joints in the order in which they lead from the ground, with the near and the far side.
    tree: Vec<(usize, usize)>,
    family: Family,
    equations: Equations,
}

fn place(side: &Side) -> Complex64 {
    Complex64::new(side.point[0].to_f64(), side.point[1].to_f64())
}

/// The direction from which a turn counts, or along which a shift goes.
fn direction(joint: &Joint, side: usize) -> Complex64 {
    let side = &joint.sides[side];
    let vector = if joint.kind == JointKind::P {
        Some(&side.axis)
    } else {
        side.second.as_ref()
    };
    vector.map_or(Complex64::new(1.0, 0.0), |v| {
        let [x, y, _] = real(v);
        unit(Complex64::new(x, y))
    })
}

/// 1 over the length of a vector of multiples of roots; `None` for others.
pub fn over_length(vector: &[&Number]) -> Option<String> {
    let mut square = Rational::new();
    for number in vector.iter().filter(|number| number.value != 0) {
        square += number.surd.as_deref()?.square();
    }
    let surd = Surd::root(&square)?;
    let is_square = square.numer().is_perfect_square() && square.denom().is_perfect_square();
    Some(match (square != 0, is_square) {
        (false, _) => return None,
        (true, true) => {
            let root = (square.numer().clone().sqrt(), square.denom().clone().sqrt());
            expression(&Rational::from((root.1, root.0)))
        }
        (true, false) => format!("(1/{})", surd.expression()),
    })
}

fn constant_text(z: Complex64, bar: bool) -> String {
    complex(&double_expression(z.re), &double_expression(z.im), bar)
}

impl Planar {
    /// Puts links into classes that turn together.
    fn tie(&mut self, mechanism: &Mechanism) -> Result<(), MechanismError> {
        let count = self.linkage.links.len();
        let mut turns: Vec<Option<Turn>> = vec![None; count];
        let mut classes = 0;
        let mut order = vec![self.linkage.ground];
        order.extend((0..count).filter(|l| *l != self.linkage.ground));
        let mut used = vec![false; self.linkage.joints.len()];
        for start in order {
            if turns[start].is_some() {
                continue;
            }
            turns[start] = Some(Turn {
                class: classes,
                factors: Vec::new(),
            });
            classes += 1;
            let mut open = vec![start];
            if start == self.linkage.ground
                && self.is_inverse
                && let Some(link) = self.output
            {
                turns[link] = Some(Turn {
                    class: 0,
                    factors: vec![Factor::Output],
                });
                open.push(link);
            }
            while let Some(link) = open.pop() {
                for j in self.linkage.joints_of(link) {
                    let joint = &self.linkage.joints[j];
                    let ties = joint.kind == JointKind::P || self.driven.contains(&j);
                    if !ties || used[j] {
                        continue;
                    }
                    used[j] = true;
                    let from = usize::from(joint.links[1] == link);
                    let next = joint.links[1 - from];
                    if turns[next].is_some() {
                        return Err(mechanism.error(format!(
                            "not in this version: a loop through {} in which no joint turns freely",
                            joint.name
                        )));
                    }
                    let Some(mut turn) = turns[link].clone() else {
                        continue;
                    };
                    let ratio = direction(joint, from) / direction(joint, 1 - from);
                    if ratio != Complex64::new(1.0, 0.0) {
                        turn.factors.push(Factor::Constant(ratio));
                    }
                    if joint.kind == JointKind::R {
                        turn.factors.push(Factor::Given {
                            joint: j,
                            inverse: from == 1,
                        });
                    }
                    turns[next] = Some(turn);
                    open.push(next);
                }
            }
        }
        self.turns = turns.into_iter().flatten().collect();
        Ok(())
    }

    /// The spanning tree by which places are counted.
    fn grow(&mut self) {
        let mut reached = vec![false; self.linkage.links.len()];
        reached[self.linkage.ground] = true;
        let mut next = 0;
        let mut open = vec![self.linkage.ground];
        while next < open.len() {
            let link = open[next];
            next += 1;
            for j in self.linkage.joints_of(link) {
                let joint = &self.linkage.joints[j];
                let from = usize::from(joint.links[1] == link);
                let far = joint.links[1 - from];
                if !reached[far] {
                    reached[far] = true;
                    self.tree.push((j, from));
                    open.push(far);
                }
            }
        }
    }

    fn classes(&self) -> usize {
        self.turns.iter().map(|t| t.class).max().unwrap_or(0)
    }

    /// The turn of a link, or its conjugate, as text.
    fn turn_text(&self, link: usize, bar: bool) -> String {
        let turn = &self.turns[link];
        let mut text = match turn.class {
            0 => "1".to_owned(),
            class => format!("{}{class}", if bar { "G" } else { "g" }),
        };
        for factor in &turn.factors {
            let one = match factor {
                Factor::Constant(z) => constant_text(*z, bar),
                Factor::Given { joint, inverse } => {
                    given_turn(&format!("{}", joint + 1), *inverse != bar)
                }
                Factor::Output => given_turn("out", bar),
            };
            text = text::times(&text, &one);
        }
        text
    }

    /// Where a side of a joint is, from the place of its link.
    fn arm_text(&self, joint: &Joint, side: usize, bar: bool) -> String {
        let point = self.number_pair(&joint.sides[side].point, bar);
        text::times(&self.turn_text(joint.links[side], bar), &point)
    }

    /// The first two coordinates of a vector as a complex number.
    fn number_pair(&self, vector: &Vector, bar: bool) -> String {
        let text = |number: &Number| match self.is_exact {
            true => number.exact_expression(),
            false => number.expression(),
        };
        complex(&text(&vector[0]), &text(&vector[1]), bar)
    }

    /// The unit vector of a shift in the first link.
    fn direction_text(&self, joint: &Joint, bar: bool) -> String {
        let [x, y, _] = &joint.sides[0].axis;
        if !self.is_exact || (x.value == 0 && y.value == 0) {
            return constant_text(direction(joint, 0), bar);
        }
        let over = over_length(&[x, y]).unwrap_or_else(|| {
            let [x, y] = [x, y].map(Number::exact_expression);
            format!("(1/sqrt({x}^2+{y}^2))")
        });
        text::times(&self.number_pair(&joint.sides[0].axis, bar), &over)
    }

    /// The shift of a joint along its direction in the first link.
    fn shift_text(&self, j: usize, bar: bool) -> String {
        let joint = &self.linkage.joints[j];
        if joint.kind != JointKind::P {
            return "0".into();
        }
        let along = self.direction_text(joint, bar);
        let turned = text::times(&self.turn_text(joint.links[0], bar), &along);
        text::times(&turned, &self.shift_name(j))
    }

    fn shift_name(&self, j: usize) -> String {
        if self.driven.contains(&j) {
            format!("shift_{}", j + 1)
        } else {
            format!("s{}", j + 1)
        }
    }

    fn write(&mut self, mechanism: &Mechanism, problem: Problem) -> Result<(), MechanismError> {
        let mut equations = Equations::default();
        self.declare_parameters(&mut equations);
        let turns: Vec<String> = (1..=self.classes()).map(|k| format!("g{k}")).collect();
        let conjugate_turns: Vec<String> = (1..=self.classes()).map(|k| format!("G{k}")).collect();
        let pairs = turns.iter().cloned().zip(conjugate_turns.iter().cloned());
        equations.conjugates = pairs.collect();
        for k in 1..=self.classes() {
            equations.equations.push(format!("g{k}*G{k}-1"));
        }
        self.places = vec![Default::default(); self.linkage.links.len()];
        for bar in [false, true] {
            let places = self.link_places(&mut equations, bar);
            self.close_loops(&mut equations, &places, bar);
            self.guide_output(&mut equations, &places, bar);
            for (link, place) in places.into_iter().enumerate() {
                self.places[link][usize::from(bar)] = place;
            }
        }
        let mut first_group = turns;
        first_group.extend(self.free_shifts());
        if first_group.is_empty() {
            return Err(
                mechanism.error("nothing is left to solve: every link is where the inputs put it")
            );
        }
        equations.groups = vec![first_group];
        if !conjugate_turns.is_empty() {
            equations.groups.push(conjugate_turns);
        }
        if problem != Problem::Motion {
            unbalanced(
                mechanism,
                &self.inputs,
                equations.unknowns(),
                equations.equations.len(),
            )?;
        }
        self.equations = equations;
        Ok(())
    }

    /// The inputs, and for an inverse problem the pose of the output.
    fn declare_parameters(&self, equations: &mut Equations) {
        for name in &self.inputs {
            let Some(j) = self
                .linkage
                .joints
                .iter()
                .position(|joint| joint.name == *name)
            else {
                continue;
            };
            match self.linkage.joints[j].kind {
                JointKind::R => equations
                    .parameters
                    .extend([format!("t_{}", j + 1), format!("w_{}", j + 1)]),
                _ => equations.parameters.push(self.shift_name(j)),
            }
        }
        if self.is_inverse {
            equations
                .parameters
                .extend(["x_out", "y_out", "t_out", "w_out"].map(String::from));
        }
    }

    /// The names of the shifts that no input gives.
    fn free_shifts(&self) -> impl Iterator<Item = String> {
        let shifts = (0..self.linkage.joints.len())
            .filter(|j| self.linkage.joints[*j].kind == JointKind::P && !self.driven.contains(j));
        shifts.map(|j| self.shift_name(j))
    }

    /// Defines the place of each link, or its conjugate, along the tree.
    fn link_places(&self, equations: &mut Equations, bar: bool) -> Vec<String> {
        let letter = if bar { "P" } else { "p" };
        let mut places = vec!["0".to_owned(); self.linkage.links.len()];
        for (j, from) in &self.tree {
            let joint = &self.linkage.joints[*j];
            let shift = self.shift_text(*j, bar);
            let near = text::sum(&[
                places[joint.links[*from]].clone(),
                self.arm_text(joint, *from, bar),
            ]);
            let near = if *from == 0 {
                text::sum(&[near, shift])
            } else {
                text::minus(&near, &shift)
            };
            let place = text::minus(&near, &self.arm_text(joint, 1 - from, bar));
            let far = joint.links[1 - from];
            places[far] = equations.define(format!("{letter}{}", far + 1), place);
        }
        places
    }

    /// One equation for each joint outside the tree: both of its links put it at one place.
    fn close_loops(&self, equations: &mut Equations, places: &[String], bar: bool) {
        let tree_joints: Vec<usize> = self.tree.iter().map(|(j, _)| *j).collect();
        for (j, joint) in self.linkage.joints.iter().enumerate() {
            if tree_joints.contains(&j) {
                continue;
            }
            let end = |side: usize| {
                text::sum(&[
                    places[joint.links[side]].clone(),
                    self.arm_text(joint, side, bar),
                ])
            };
            let near = text::sum(&[end(0), self.shift_text(j, bar)]);
            equations.equations.push(text::minus(&near, &end(1)));
        }
    }

    /// For an inverse problem the equation of the output point, which stands where the pose puts it.
    fn guide_output(&self, equations: &mut Equations, places: &[String], bar: bool) {
        if self.is_inverse
            && let Some(link) = self.output
        {
            let arm = text::times(
                &self.turn_text(link, bar),
                &constant_text(self.output_point, bar),
            );
            let target = if bar {
                "(x_out-I*y_out)"
            } else {
                "(x_out+I*y_out)"
            };
            let place = text::sum(&[places[link].clone(), arm]);
            equations.equations.push(text::minus(&place, target));
        }
    }
}

/// A given turn (w + i t)/(w - i t), or its inverse, which is its conjugate.
fn given_turn(name: &str, inverse: bool) -> String {
    let (above, below) = if inverse { ("-", "+") } else { ("+", "-") };
    format!("(w_{name}{above}I*t_{name})/(w_{name}{below}I*t_{name})")
}

/// Numbers of a solution by the equations' names.
struct Numbers<'a> {
    planar: &'a Planar,
    names: Vec<String>,
    point: &'a [Complex64],
    parameters: &'a [Complex64],
}

impl Numbers<'_> {
    fn get(&self, name: &str) -> Complex64 {
        let variable = self
            .names
            .iter()
            .position(|n| n == name)
            .map(|i| self.point[i]);
        let parameters = &self.planar.equations.parameters;
        let parameter = || {
            parameters
                .iter()
                .position(|n| n == name)
                .map(|i| self.parameters[i])
        };
        variable.or_else(parameter).unwrap_or_default()
    }

    fn given(&self, name: &str, inverse: bool) -> Complex64 {
        let (t, w) = (
            self.get(&format!("t_{name}")),
            self.get(&format!("w_{name}")),
        );
        let turned = Complex64::new(-t.im, t.re);
        let z = (w + turned) / (w - turned);
        if inverse {
            Complex64::new(1.0, 0.0) / z
        } else {
            z
        }
    }

    fn turn(&self, link: usize, bar: bool) -> Complex64 {
        let turn = &self.planar.turns[link];
        let mut value = match turn.class {
            0 => Complex64::new(1.0, 0.0),
            class => self.get(&format!("{}{class}", if bar { "G" } else { "g" })),
        };
        for factor in &turn.factors {
            value *= match factor {
                Factor::Constant(z) => conjugate(*z, bar),
                Factor::Given { joint, inverse } => {
                    self.given(&format!("{}", joint + 1), *inverse != bar)
                }
                Factor::Output => self.given("out", bar),
            };
        }
        value
    }

    fn shift(&self, j: usize, bar: bool) -> Complex64 {
        let joint = &self.planar.linkage.joints[j];
        if joint.kind != JointKind::P {
            return Complex64::default();
        }
        let along = conjugate(direction(joint, 0), bar);
        self.turn(joint.links[0], bar) * along * self.get(&self.planar.shift_name(j))
    }

    fn arm(&self, joint: &Joint, side: usize, bar: bool) -> Complex64 {
        self.turn(joint.links[side], bar) * conjugate(place(&joint.sides[side]), bar)
    }
}

fn conjugate(z: Complex64, bar: bool) -> Complex64 {
    if bar { z.conj() } else { z }
}

impl Formulation for Planar {
    fn family(&self) -> &Family {
        &self.family
    }

    fn path(&self, link: &str, point: &Vector) -> Option<PathText> {
        let link = self.linkage.links.iter().position(|name| name == link)?;
        let coordinate = |bar: bool| {
            let arm = text::times(&self.turn_text(link, bar), &self.number_pair(point, bar));
            text::sum(&[self.places[link][usize::from(bar)].clone(), arm])
        };
        let shifts_on_turning = |(j, _): &(usize, usize)| {
            let joint = &self.linkage.joints[*j];
            joint.kind == JointKind::P && self.turns[joint.links[0]].class != 0
        };
        Some(PathText {
            coordinates: [false, true].map(coordinate).to_vec(),
            denominator: "1".into(),
            is_linear: !self.tree.iter().any(shifts_on_turning),
        })
    }

    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn equations(&self) -> Option<&Equations> {
        Some(&self.equations)
    }

    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        match target {
            Target::Pose(pose) => {
                let angle = Complex64::new(pose.rotation[0][0].re, pose.rotation[1][0].re);
                let half = crate::plane::half(unit(angle));
                Ok(vec![
                    pose.position[0],
                    pose.position[1],
                    half.im.into(),
                    half.re.into(),
                ])
            }
            Target::Inputs(values) => Ok(input_parameters(&self.linkage, &self.inputs, values)),
        }
    }

    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        let count = self.equations.parameters.len();
        let size = size(&self.linkage);
        let is_angle = |name: &String| name.starts_with("t_") || name.starts_with("w_");
        let names = &self.equations.parameters;
        (count > 0).then(|| {
            names
                .iter()
                .map(|n| if is_angle(n) { draw() } else { draw() * size })
                .collect()
        })
    }

    fn lift(&self, _: Option<&Target>, parameters: &[Complex64], point: &[Complex64]) -> Lifted {
        let numbers = Numbers {
            planar: self,
            names: self.equations.variables(),
            point,
            parameters,
        };
        let size = size(&self.linkage);
        let mut places = vec![[Complex64::default(); 2]; self.linkage.links.len()];
        for (j, from) in &self.tree {
            let joint = &self.linkage.joints[*j];
            for (k, bar) in [(0, false), (1, true)] {
                let shift = numbers.shift(*j, bar) * if *from == 0 { 1.0 } else { -1.0 };
                let near = places[joint.links[*from]][k] + numbers.arm(joint, *from, bar) + shift;
                places[joint.links[1 - from]][k] = near - numbers.arm(joint, 1 - from, bar);
            }
        }
        let largest = point.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
        let mut most = 0.0f64;
        let mut values = Vec::new();
        for (j, joint) in self.linkage.joints.iter().enumerate() {
            let mut ratio = [Complex64::default(); 2];
            for (k, bar) in [(0, false), (1, true)] {
                let end =
                    |side: usize| places[joint.links[side]][k] + numbers.arm(joint, side, bar);
                let gap = end(0) + numbers.shift(j, bar) - end(1);
                most = most.max(modulus(gap) / (size * largest.sqrt()));
                let [x, y] = [0, 1].map(|side| {
                    numbers.turn(joint.links[side], bar) * conjugate(direction(joint, side), bar)
                });
                ratio[k] = y / x;
            }
            let value = match joint.kind {
                JointKind::R => {
                    let half_i = Complex64::new(0.0, 0.5);
                    JointValue::Turn((ratio[0] + ratio[1]) * 0.5, (ratio[1] - ratio[0]) * half_i)
                }
                _ => {
                    most = most.max(modulus(ratio[0] - 1.0));
                    JointValue::Shift(numbers.get(&self.shift_name(j)))
                }
            };
            values.push((joint.name.as_str().into(), value));
        }
        for k in 1..=self.classes() {
            let product = numbers.get(&format!("g{k}")) * numbers.get(&format!("G{k}"));
            most = most.max(modulus(product - 1.0) / largest);
        }
        let poses: Vec<Pose> = (0..places.len())
            .map(|link| {
                let [g, g_bar] = [false, true].map(|bar| numbers.turn(link, bar));
                isotropic_pose(places[link][0], places[link][1], g, g_bar)
            })
            .collect();
        let output = self.output.map(|link| {
            let point = self.output_point;
            let arm = [point.re.into(), point.im.into(), Complex64::default()];
            Pose {
                position: poses[link].point(arm),
                ..poses[link]
            }
        });
        Lifted::Position(Box::new(Configuration {
            values,
            output,
            bodies: self
                .linkage
                .links
                .iter()
                .map(|name| name.as_str().into())
                .zip(poses)
                .collect(),
            residual: most,
        }))
    }
}

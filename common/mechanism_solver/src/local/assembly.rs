//! Assembly: a mechanism at a configuration, as coordinates that are 0 there and conditions that close it.

use super::conditions::{Condition, Place, Square, Step, Value, Vector, Weighted};
use super::field::Constant;
use super::moved_parts::{MovedParts, NUMBER, number_shift};
use super::steps::{about_z, basis, fixed, near, reversed, vector};
use cognate_kinematics::compile::linkage_pose::{Branch, elements, spanning_tree};
use cognate_kinematics::compile::size;
use cognate_kinematics::mechanism::chain::Chain;
use cognate_kinematics::mechanism::configuration::{GivenConfiguration, GivenValue};
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::mechanism::file_number::{ChainPlace, Moves};
use cognate_kinematics::mechanism::graph::is_rod;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{
    Body, Framework, Joint, JointKind, LegKind, Linkage, Mechanism, Platform, Space,
};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::Rational;

/// Sizes are between this and its inverse, in the file's unit.
const LONGEST: f64 = 1e18;

/// Weights of coordinates in slices are multiples of the inverse of this between -1 and 1.
const WEIGHTS: u64 = 1000;

/// A mechanism at a configuration.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// Whether the mechanism moves in space, in a plane or about a point.
    pub space: Space,
    /// A length of the mechanism, a power of 2; shifts are in parts of it.
    pub size: Constant,
    /// Where the coordinates stand.
    pub values: Vec<Value>,
    /// Coordinates of the configuration, where it is not quite the one that was given.
    pub offset: Vec<Constant>,
    /// Names of the joints or legs whose values are coordinates, with the number of the coordinate.
    pub named: Vec<(String, usize)>,
    /// Driven legs of a platform, each with its two ends.
    pub legs: Vec<(String, [Place; 2])>,
    /// The conditions.
    pub conditions: Vec<Condition>,
    /// Steps from the ground to each link, where links have poses.
    pub links: Vec<(String, Vec<Step>)>,
    /// Parts that the first coordinate moves, if a number of the file is a coordinate.
    pub moved: MovedParts,
}

impl Assembly {
    /// The mechanism at a configuration; an error names the joint or value that is missing.
    pub fn of(mechanism: &Mechanism, given: &GivenConfiguration) -> Result<Self, String> {
        Self::with(mechanism, given, None)
    }

    /// The mechanism at a configuration, with a number of its file as the first coordinate.
    pub fn with_number(
        mechanism: &Mechanism,
        given: &GivenConfiguration,
        moves: &Moves,
    ) -> Result<Self, String> {
        Self::with(mechanism, given, Some(moves.clone()))
    }

    fn with(
        mechanism: &Mechanism,
        given: &GivenConfiguration,
        moves: Option<Moves>,
    ) -> Result<Self, String> {
        let mut assembly = Self {
            space: mechanism.space,
            size: power_of_two(size(mechanism)),
            values: Vec::new(),
            offset: Vec::new(),
            named: Vec::new(),
            legs: Vec::new(),
            conditions: Vec::new(),
            links: Vec::new(),
            moved: MovedParts(moves),
        };
        match &assembly.moved.0 {
            None => {}
            Some(Moves::Direction { .. } | Moves::Chain { turns: true, .. }) => {
                assembly.values.push(no_turn());
            }
            Some(_) => assembly.values.push(no_shift()),
        }
        match &mechanism.body {
            Body::Linkage(linkage) => assembly.add_linkage(mechanism, linkage, given)?,
            Body::Chain(chain) => assembly.add_chain(chain, &joints(mechanism, given)?),
            Body::Framework(framework) => assembly.add_framework(framework, given)?,
            Body::Platform(platform) => assembly.add_platform(platform, given)?,
        }
        assembly.offset = vec![Constant::integer(0); assembly.values.len()];
        Ok(assembly)
    }

    /// Conditions that no coordinate enters: bars between fixed points.
    pub fn constant_conditions(&self) -> usize {
        let is_constant = |condition: &&Condition| match condition {
            Condition::Distance(parts) => parts.0.iter().all(|place| place.steps.is_empty()),
            Condition::Loop(_) | Condition::Meet(_) | Condition::Slice(_) => false,
        };
        self.conditions.iter().filter(is_constant).count()
    }

    /// The assembly with `count` more general linear conditions that hold at the configuration.
    pub fn sliced(mut self, count: usize, seed: u64) -> Self {
        for index in 0..count {
            let mut random = RandomStream::new(seed, Purpose::Probe, index as u64);
            let mut weight = || {
                let steps = random.below(2 * WEIGHTS) as i64 - WEIGHTS as i64;
                Constant::rational(Rational::from(steps) / Rational::from(WEIGHTS))
            };
            let weighted = |offset: &Constant| Weighted {
                weight: weight(),
                offset: offset.clone(),
            };
            let slice = self.offset.iter().map(weighted).collect();
            self.conditions.push(Condition::Slice(slice));
        }
        self
    }

    fn coordinate(&mut self, value: Value) -> usize {
        self.values.push(value);
        self.values.len() - 1
    }

    fn add_linkage(
        &mut self,
        mechanism: &Mechanism,
        linkage: &Linkage,
        given: &GivenConfiguration,
    ) -> Result<(), String> {
        let is_home = *given == GivenConfiguration::Home;
        if is_home && !linkage.at_home {
            return Err(
                "the file gives joints in their links' coordinates and no home; give the values of joints with --at FILE".into(),
            );
        }
        let simple = |j: &&Joint| matches!(j.kind, JointKind::R | JointKind::P);
        if let Some(joint) = linkage
            .joints
            .iter()
            .find(|j| !simple(j))
            .filter(|_| !is_home)
        {
            return Err(format!(
                "not in this version: joint {} is {}, which has no single value; --at home takes the position of the file",
                joint.name,
                joint.kind.letter()
            ));
        }
        let rods: Vec<usize> = (0..linkage.links.len())
            .filter(|l| is_rod(linkage, *l))
            .collect();
        if mechanism.graph().idle > rods.len() as i64 {
            return Err("not in this version: struts that spin between two balls".into());
        }
        let values = match is_home {
            true => Vec::new(),
            false => joints(mechanism, given)?,
        };
        let motions = self.joint_motions(linkage, &values)?;
        let tree = spanning_tree(linkage, &[], &rods);
        self.add_links(linkage, &tree, &motions, &rods)?;
        for (j, joint) in linkage.joints.iter().enumerate() {
            let is_in_tree = tree.iter().any(|branch| branch.joint == j);
            if is_in_tree || joint.links.iter().any(|l| rods.contains(l)) {
                continue;
            }
            let condition = self.cut(j, joint, &motions[j]);
            self.conditions.push(condition);
        }
        for rod in rods {
            let condition = self.rod(linkage, rod);
            self.conditions.push(condition);
        }
        Ok(())
    }

    /// Steps from the first link of each joint to its second; none of a ball.
    fn joint_motions(
        &mut self,
        linkage: &Linkage,
        values: &[Value],
    ) -> Result<Vec<Vec<Step>>, String> {
        let mut motions = Vec::new();
        let mut given = values.iter().cloned();
        for (j, joint) in linkage.joints.iter().enumerate() {
            if joint.kind == JointKind::S {
                motions.push(Vec::new());
                continue;
            }
            // A value is that of the second link against the first; at the ground that of the other link.
            let is_swapped = joint.links[1] == linkage.ground;
            let steps = match linkage.at_home {
                true => self.steps_at_home(joint, &mut given),
                false => self.steps_between(joint, is_swapped, &mut given)?,
            };
            let mut steps = self.moved.joint(j, joint, steps);
            if is_swapped && linkage.at_home {
                steps = reversed(&steps);
            }
            if matches!(joint.kind, JointKind::R | JointKind::P) {
                self.named.push((joint.name.clone(), self.values.len() - 1));
            }
            motions.push(steps);
        }
        Ok(motions)
    }

    fn steps_at_home(
        &mut self,
        joint: &Joint,
        given: &mut impl Iterator<Item = Value>,
    ) -> Vec<Step> {
        let side = &joint.sides[0];
        let (axis, point) = (vector(&side.axis), vector(&side.point));
        let turn = |assembly: &mut Self, axis: Vector, value: Option<Value>| Step::Turn {
            axis,
            point: Box::new(point.clone()),
            coordinate: assembly.coordinate(value.unwrap_or_else(no_turn)),
            is_reversed: false,
        };
        let shift = |assembly: &mut Self, axis: Vector, value: Option<Value>| Step::Shift {
            axis,
            coordinate: assembly.coordinate(value.unwrap_or_else(no_shift)),
            is_reversed: false,
        };
        match joint.kind {
            JointKind::R => vec![turn(self, axis, given.next())],
            JointKind::P => vec![shift(self, axis, given.next())],
            JointKind::C => {
                vec![turn(self, axis.clone(), None), shift(self, axis, None)]
            }
            JointKind::E => {
                let [x, y] = across(&axis);
                vec![
                    shift(self, x, None),
                    shift(self, y, None),
                    turn(self, axis, None),
                ]
            }
            JointKind::U => {
                let second = side.second.as_ref().map_or_else(|| axis.clone(), vector);
                vec![turn(self, axis, None), turn(self, second, None)]
            }
            JointKind::S => Vec::new(),
        }
    }

    /// Steps of a joint that is given in the coordinates of its links.
    fn steps_between(
        &mut self,
        joint: &Joint,
        is_swapped: bool,
        given: &mut impl Iterator<Item = Value>,
    ) -> Result<Vec<Step>, String> {
        let moves = elements(joint, false)
            .ok_or_else(|| format!("joint {}: its directions give no frame", joint.name))?;
        let moves = if is_swapped { moves.reversed() } else { moves };
        let mut steps = Vec::new();
        for (before, turns) in &moves.parts {
            steps.push(fixed(before));
            let usual = if *turns { no_turn } else { no_shift };
            let coordinate = self.coordinate(given.next().unwrap_or_else(usual));
            steps.push(about_z(coordinate, *turns));
        }
        steps.push(fixed(&moves.after));
        Ok(if is_swapped { reversed(&steps) } else { steps })
    }

    fn add_links(
        &mut self,
        linkage: &Linkage,
        tree: &[Branch],
        motions: &[Vec<Step>],
        rods: &[usize],
    ) -> Result<(), String> {
        let mut steps: Vec<Option<Vec<Step>>> = vec![None; linkage.links.len()];
        steps[linkage.ground] = Some(Vec::new());
        for branch in tree {
            let mut path = steps[branch.links[0]].clone().unwrap_or_default();
            let motion = &motions[branch.joint];
            path.extend(match branch.is_reversed {
                true => reversed(motion),
                false => motion.clone(),
            });
            steps[branch.links[1]] = Some(path);
        }
        for (link, steps) in steps.into_iter().enumerate() {
            let steps = match steps {
                Some(steps) => steps,
                None if rods.contains(&link) => Vec::new(),
                None if linkage
                    .joints_of(link)
                    .iter()
                    .all(|j| linkage.joints[*j].kind == JointKind::S) =>
                {
                    self.free_body(None)
                }
                None => {
                    return Err(format!(
                        "not in this version: link {} hangs on links that balls alone hold",
                        linkage.links[link]
                    ));
                }
            };
            self.links.push((linkage.links[link].clone(), steps));
        }
        Ok(())
    }

    /// Coordinates of a body that no joint leads to, from a pose.
    fn free_body(&mut self, at: Option<&Pose>) -> Vec<Step> {
        let place = at.map_or([0.0; 3], |pose| pose.position.map(|c| c.re));
        let mut steps = Vec::new();
        let axes = if self.space == Space::Planar { 2 } else { 3 };
        for (k, x) in place.into_iter().enumerate().take(axes) {
            if self.space == Space::Spherical {
                break;
            }
            steps.push(Step::Shift {
                axis: basis(k),
                coordinate: self.coordinate(Value::Shift(near(x))),
                is_reversed: false,
            });
        }
        let rotation = at.map_or(Pose::IDENTITY.rotation, |pose| pose.rotation);
        let rows = rotation.map(|row| row.map(|c| near(c.re)));
        if self.space == Space::Planar {
            let [c, s] = [rows[0][0].clone(), rows[1][0].clone()];
            let coordinate = self.coordinate(Value::Turn([c, s]));
            steps.push(about_z(coordinate, true));
        } else {
            let coordinate = self.coordinate(Value::Spin);
            self.coordinate(Value::Spin);
            self.coordinate(Value::Spin);
            steps.push(Step::Spin {
                at: Box::new(rows),
                coordinate,
            });
        }
        steps
    }

    fn steps_of(&self, link: usize) -> Vec<Step> {
        self.links
            .get(link)
            .map_or_else(Vec::new, |(_, s)| s.clone())
    }

    /// The loop that a joint closes.
    fn cut(&self, j: usize, joint: &Joint, motion: &[Step]) -> Condition {
        let [mut first, mut second] = joint.links.map(|link| self.steps_of(link));
        if joint.kind == JointKind::S {
            first.extend(self.moved.ball(j, 0));
            second.extend(self.moved.ball(j, 1));
            let mut places = [first, second].into_iter().zip(&joint.sides);
            let mut place = || {
                places.next().map(|(steps, side)| Place {
                    steps,
                    point: vector(&side.point),
                })
            };
            if let (Some(a), Some(b)) = (place(), place()) {
                return Condition::Meet(Box::new([a, b]));
            }
            return Condition::Loop(Vec::new());
        }
        let mut steps = first;
        steps.extend(motion.iter().cloned());
        steps.extend(reversed(&second));
        Condition::Loop(steps)
    }

    /// The distance of the two balls of a rod.
    fn rod(&self, linkage: &Linkage, rod: usize) -> Condition {
        let joints = linkage.joints_of(rod);
        let place = |j: usize, at_rod: bool| {
            let joint = &linkage.joints[j];
            let is_rod = joint.links[1] == rod;
            let side = usize::from(is_rod == at_rod);
            let mut steps = match at_rod {
                true => Vec::new(),
                false => self.steps_of(joint.links[side]),
            };
            steps.extend(self.moved.ball(j, side));
            Place {
                steps,
                point: vector(&joint.sides[side].point),
            }
        };
        let ends = [joints[0], joints[1]].map(|j| place(j, false));
        let balls = [joints[0], joints[1]].map(|j| place(j, true));
        let is_changed = balls.iter().any(|ball| !ball.steps.is_empty());
        let square = match is_changed {
            true => Square::Between(Box::new(balls)),
            false => Square::Number(square_of_distance(&balls[0].point, &balls[1].point)),
        };
        Condition::Distance(Box::new((ends, square)))
    }

    fn add_chain(&mut self, chain: &Chain, values: &[Value]) {
        let mut steps = self.moved.chain(ChainPlace::Start);
        if !is_identity(&chain.base) {
            steps.push(fixed(&chain.base));
        }
        steps.extend(self.moved.chain(ChainPlace::Base));
        for (j, (joint, value)) in chain.joints.iter().zip(values).enumerate() {
            let coordinate = self.coordinate(value.clone());
            self.named.push((joint.name.clone(), coordinate));
            steps.push(about_z(coordinate, joint.is_angle));
            steps.extend(self.moved.chain(ChainPlace::Joint(j)));
            steps.push(fixed(&joint.after()));
            steps.extend(self.moved.chain(ChainPlace::Row(j)));
            let name = cognate_kinematics::mechanism::link_name(self.links.len() + 1);
            self.links.push((name, steps.clone()));
        }
        if !is_identity(&chain.tool) {
            steps.push(fixed(&chain.tool));
        }
        if chain.closed {
            self.conditions.push(Condition::Loop(steps));
        } else if let Some((_, last)) = self.links.last_mut() {
            *last = steps;
        }
    }

    fn add_framework(
        &mut self,
        framework: &Framework,
        given: &GivenConfiguration,
    ) -> Result<(), String> {
        let GivenConfiguration::Points(points) = given else {
            return Err(
                "a framework has no home; give the places of its points with --at FILE".into(),
            );
        };
        let zero = || basis(0).map(|_| Constant::integer(0));
        let mut places = Vec::new();
        for (k, numbers) in points.iter().enumerate() {
            let [x, y] = numbers.each_ref().map(Constant::of);
            if framework.fixed.contains(&k) {
                let axis = self.moved.fixed_point_axis(framework, points, k);
                places.push(Place {
                    steps: axis.map(number_shift).into_iter().collect(),
                    point: [x, y, Constant::integer(0)],
                });
                continue;
            }
            let shifts = [x, y].into_iter().enumerate();
            let steps = shifts
                .map(|(axis, value)| Step::Shift {
                    axis: basis(axis),
                    coordinate: self.coordinate(Value::Shift(value)),
                    is_reversed: false,
                })
                .collect();
            places.push(Place {
                steps,
                point: zero(),
            });
        }
        for (b, bar) in framework.bars.iter().enumerate() {
            let ends = bar.between.map(|k| places[k].clone());
            let is_changed = self.moved.0 == Some(Moves::Bar(b));
            if is_changed && framework.is_fixed(bar) {
                continue;
            }
            let square = square(&bar.length, is_changed);
            self.conditions
                .push(Condition::Distance(Box::new((ends, square))));
        }
        Ok(())
    }

    fn add_platform(
        &mut self,
        platform: &Platform,
        given: &GivenConfiguration,
    ) -> Result<(), String> {
        let GivenConfiguration::Pose(output) = given else {
            return Err("a platform has no home; give its pose with --at FILE".into());
        };
        let pose = platform.body(output);
        let mut steps = self.free_body(Some(&pose));
        if platform.fixed_orientation {
            steps.retain(|step| matches!(step, Step::Shift { .. }));
            self.values
                .truncate(steps.len() + usize::from(self.moved.0.is_some()));
        }
        for (k, leg) in platform.legs.iter().enumerate() {
            let mut to_head = steps.clone();
            to_head.extend(self.moved.leg_end(k, true));
            let head = Place {
                steps: to_head,
                point: vector(&leg.to),
            };
            match &leg.kind {
                LegKind::Strut { from, length, .. } => {
                    let foot = Place {
                        steps: self.moved.leg_end(k, false),
                        point: vector(from),
                    };
                    match length {
                        Some(length) => {
                            let square = square(length, self.moved.0 == Some(Moves::Leg(k)));
                            self.conditions
                                .push(Condition::Distance(Box::new(([foot, head], square))));
                        }
                        None => self.legs.push((leg.name.clone(), [foot, head])),
                    }
                }
                _ => {
                    return Err(format!(
                        "not in this version: leg {} has a crank or a slider, of which a pose does not tell the value",
                        leg.name
                    ));
                }
            }
        }
        self.links
            .push((cognate_kinematics::mechanism::PLATFORM.into(), steps));
        Ok(())
    }

    /// All numbers that the conditions contain.
    pub fn constants(&self) -> Vec<Constant> {
        let mut list = vec![self.size.clone()];
        list.extend(self.offset.iter().cloned());
        for value in &self.values {
            match value {
                Value::Turn(pair) => list.extend(pair.iter().cloned()),
                Value::Shift(x) => list.push(x.clone()),
                Value::Spin => {}
            }
        }
        for condition in &self.conditions {
            match condition {
                Condition::Loop(steps) => add_constants(steps, &mut list),
                // Rational weights, and the offsets that stand in the list already.
                Condition::Slice(_) => {}
                Condition::Meet(places) => {
                    for place in &**places {
                        add_constants(&place.steps, &mut list);
                        list.extend(place.point.iter().cloned());
                    }
                }
                Condition::Distance(parts) => {
                    for place in &parts.0 {
                        add_constants(&place.steps, &mut list);
                        list.extend(place.point.iter().cloned());
                    }
                    match &parts.1 {
                        Square::Number(square) | Square::Changed { square, .. } => {
                            list.push(square.clone());
                        }
                        Square::Between(places) => {
                            for place in &**places {
                                add_constants(&place.steps, &mut list);
                                list.extend(place.point.iter().cloned());
                            }
                        }
                    }
                }
            }
        }
        list
    }
}

fn add_constants(steps: &[Step], list: &mut Vec<Constant>) {
    for step in steps {
        match step {
            Step::Fixed(pose) => {
                list.extend(pose.0.iter().flatten().cloned());
                list.extend(pose.1.iter().cloned());
            }
            Step::Turn { axis, point, .. } => {
                list.extend(axis.iter().chain(point.iter()).cloned());
                list.push(Constant::length(axis));
            }
            Step::Shift { axis, .. } => {
                list.extend(axis.iter().cloned());
                list.push(Constant::length(axis));
            }
            Step::Spin { at, .. } => list.extend(at.iter().flatten().cloned()),
        }
    }
}

/// The power of 2 that is next above a length.
fn power_of_two(length: f64) -> Constant {
    let mut power = 1.0;
    while power < length && power < LONGEST {
        power *= 2.0;
    }
    while power / 2.0 >= length && power > 1.0 / LONGEST {
        power /= 2.0;
    }
    Constant::of(&Number::of_double(power))
}

fn joints(mechanism: &Mechanism, given: &GivenConfiguration) -> Result<Vec<Value>, String> {
    match given {
        GivenConfiguration::Joints(values) => Ok(values.iter().map(of_given).collect()),
        GivenConfiguration::Home => {
            let at_zero = |(_, is_angle): &(String, bool)| {
                if *is_angle { no_turn() } else { no_shift() }
            };
            Ok(mechanism.values().iter().map(at_zero).collect())
        }
        _ => Err("expected the values of joints".into()),
    }
}

fn of_given(value: &GivenValue) -> Value {
    match value {
        GivenValue::Turn(pair) => Value::Turn(pair.each_ref().map(Constant::of)),
        GivenValue::Shift(x) => Value::Shift(Constant::of(x)),
    }
}

pub(super) fn no_turn() -> Value {
    Value::Turn([Constant::integer(1), Constant::integer(0)])
}

pub(super) fn no_shift() -> Value {
    Value::Shift(Constant::integer(0))
}

/// The square of a length, which the first coordinate changes.
fn square(length: &Number, is_changed: bool) -> Square {
    let square = Constant::of(length).square();
    match is_changed {
        true => Square::Changed {
            square,
            coordinate: NUMBER,
        },
        false => Square::Number(square),
    }
}

fn is_identity(pose: &Pose) -> bool {
    *pose == Pose::IDENTITY
}

/// Two directions at right angles to a direction.
fn across(axis: &Vector) -> [Vector; 2] {
    let z = axis.each_ref().map(|c| c.double);
    let frame = cognate_kinematics::mechanism::pose::frame([0.0; 3], z, None);
    let frame = frame.unwrap_or(Pose::IDENTITY);
    [0, 1].map(|j| std::array::from_fn(|i| near(frame.rotation[i][j].re)))
}

fn square_of_distance(p: &Vector, q: &Vector) -> Constant {
    let double: f64 = p
        .iter()
        .zip(q)
        .map(|(a, b)| (a.double - b.double).powi(2))
        .sum();
    let rational = |c: &Constant| {
        let surd = c.exact.as_ref().filter(|surd| surd.radicand == 1);
        surd.map(|surd| surd.coefficient.clone())
    };
    let mut sum = Some(cognate_numeric::rational::Rational::new());
    for (a, b) in p.iter().zip(q) {
        let difference = rational(a).zip(rational(b)).map(|(a, b)| a - b);
        sum = sum.zip(difference).map(|(sum, d)| sum + d.clone() * d);
    }
    sum.map_or_else(|| Constant::rounded(double), Constant::rational)
}

//! The postures of an arm at a pose at which its equations do not decide: the arm itself does.
//!
//! The path of every posture is followed to its end in the equations of the whole loop. A real posture next to an end is
//! brought to the digits of the pose; the screws of the joints there say whether it is regular. Where they depend, it is
//! isolated, with as many paths as end there, or it is one of a set along which the arm moves.

use super::arm_loop::{ArmLoop, End, size};
use super::postures::{Counts, Position, PostureSet, Postures, Route, distance, sort, violated};
use super::self_motion::{AT_POSE, Arc, Neighbour, SINGULAR, SelfMotion, neighbour};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_kinematics::compile::six_joint_arm::OUT_OF_REACH;
use cognate_kinematics::compile::{ArmFormulation, CLOSES, Target};
use cognate_kinematics::mechanism::Mechanism;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::real_arm::{Freedom, RealArm};
use cognate_numeric::random::{Purpose, RandomStream};

/// An end with imaginary parts below this may be a real posture: rounding by 1e-16 parts a fourfold one by as much.
pub const NEARLY_REAL: f64 = 1e-3;
/// A posture is where a path ended when it is no further away than this, in radians or parts of the size.
const AT_END: f64 = 1e-2;
/// Two regular postures of one pose are further apart than this, and two singular ones further than the second.
const APART: [f64; 2] = [1e-7, 1e-4];
/// Joint values at random from which postures are looked for besides: each is a chance to see that one is missing.
const SEARCHES: usize = 24;
/// Number of their random stream.
const SEARCH: u64 = 0x7365_6172;
/// Sets of one pose that are listed at most.
const MOST_SETS: usize = 64;
/// A joint moves in a velocity of length 1 when its part is larger than this.
const MOVES: f64 = 1e-6;

/// A real posture, and the paths that lead there.
struct Group {
    values: Vec<JointValue>,
    freedom: Freedom,
    /// Numbers of the ends that are there.
    ends: Vec<usize>,
    /// Numbers of ends elsewhere, complex ones or at infinity, from which it was reached: where it is one of a set, the
    /// set's other points.
    elsewhere: Vec<usize>,
}

impl Group {
    fn is_singular(&self) -> bool {
        !self.freedom.at_rest(SINGULAR).is_empty()
    }
}

/// The ends of all paths, sorted by the kind of posture.
#[derive(Default)]
struct Sorted {
    groups: Vec<Group>,
    /// Numbers of the ends at regular complex postures.
    complex: Vec<usize>,
    /// Numbers of the other ends from which no real posture was reached.
    lost: Vec<usize>,
    /// How many paths have ends of which nothing is known.
    failed: u64,
}

/// The answer at a pose, with proofs where they are asked for; of sets the posture that is nearest to these values, where there
/// are some.
pub fn answer(
    mechanism: &Mechanism,
    formulation: &dyn ArmFormulation,
    arm_loop: &ArmLoop,
    pose: &Pose,
    (certify, near): (bool, &[f64]),
) -> Result<Postures, String> {
    let by = |ends| {
        of_ends(
            mechanism,
            formulation,
            arm_loop,
            pose,
            ends,
            (certify, near),
        )
    };
    if !certify {
        let answer = by(arm_loop.ends(pose)?);
        if answer.settled {
            return Ok(answer);
        }
    }
    arm_loop.careful_ends(pose).map(by)
}

/// The answer from the ends of all paths.
fn of_ends(
    mechanism: &Mechanism,
    formulation: &dyn ArmFormulation,
    arm_loop: &ArmLoop,
    pose: &Pose,
    ends: Vec<End>,
    (certify, near): (bool, &[f64]),
) -> Postures {
    let arm = RealArm::of(arm_loop.closure().arm());
    let sorted = sorted(arm_loop, &arm, pose, &ends);
    let mut book = Book {
        mechanism,
        formulation,
        arm,
        pose,
        ends: &ends,
        certify,
        near,
        answer: Postures {
            target: Target::Pose(*pose),
            held: Vec::new(),
            counts: Counts {
                certified_real: certify.then_some(0),
                failed: sorted.failed,
                ..Counts::default()
            },
            positions: Vec::new(),
            sets: Vec::new(),
            settled: true,
            warnings: Vec::new(),
            route: Route::Loop,
        },
    };
    // Postures with ends first, so that sets that were reached from elsewhere are those already there.
    let mut groups = sorted.groups;
    groups.sort_by_key(|group| group.ends.is_empty());
    let mut motions = Vec::new();
    for group in &groups {
        let six = formulation.six_joint_arm();
        let refused = six.refused(&group.values);
        // A set of postures may hold both some that have the yaw and others.
        let may_differ = || group.is_singular() && refused == six.without_yaw(&group.values);
        match refused {
            Some(reason) if !may_differ() => book.refused(group, reason),
            _ if group.is_singular() => book.singular(group, &mut motions),
            _ => book.regular(group),
        }
    }
    for end in &sorted.complex {
        book.complex(*end, false);
    }
    for end in &sorted.lost {
        book.elsewhere(*end);
    }
    book.duplicates(&sorted.complex);
    let mut answer = book.answer;
    if answer.counts.failed > 0 {
        answer.settled = false;
        answer.warnings.push(format!(
            "what {} of {} paths lead to is not known: postures may be missing",
            answer.counts.failed,
            ends.len()
        ));
    }
    sort(&mut answer.positions);
    answer
}

/// Ends by their kind: at real postures, at complex ones, elsewhere with a real posture that was reached from there, or
/// not known; and the postures that are reached from joint values at random.
fn sorted(arm_loop: &ArmLoop, arm: &RealArm<'_>, pose: &Pose, ends: &[End]) -> Sorted {
    let mut sorted = Sorted::default();
    for (k, end) in ends.iter().enumerate() {
        let is_complex = imaginary(&end.values) > NEARLY_REAL;
        let is_regular = end.outcome == PathOutcome::Regular;
        if is_complex && is_regular {
            match closes(arm_loop, pose, &end.values) {
                true => sorted.complex.push(k),
                false => sorted.failed += 1,
            }
            continue;
        }
        let near = RealArm::real_values(&end.values);
        let reached = arm.toward(pose, &near);
        let is_at_end = !is_complex && arm.distance(&reached.values, &near) <= AT_END;
        if reached.gap <= AT_POSE {
            let kind = match is_at_end && !is_at_infinity(end) {
                true => Some(Reach::At(k)),
                false => Some(Reach::Elsewhere(k)),
            };
            sorted.add(arm, reached.values, kind);
        } else if is_regular {
            sorted.complex.push(k);
        } else {
            sorted.lost.push(k);
        }
    }
    let mut random = RandomStream::new(0, Purpose::Probe, SEARCH);
    for _ in 0..SEARCHES {
        let values = arm.random_values(|| random.uniform());
        let reached = arm.toward(pose, &values);
        if reached.gap <= AT_POSE {
            sorted.add(arm, reached.values, None);
        }
    }
    sorted
}

/// From which end a posture was reached.
enum Reach {
    /// The posture is at this end.
    At(usize),
    /// The posture is elsewhere; it was reached from this end.
    Elsewhere(usize),
}

fn is_at_infinity(end: &End) -> bool {
    matches!(end.outcome, PathOutcome::Diverging | PathOutcome::PutAside)
}

/// Whether complex joint values bring the tool to a pose.
fn closes(arm_loop: &ArmLoop, pose: &Pose, values: &[JointValue]) -> bool {
    let chain = arm_loop.closure().arm();
    let growth: f64 = values.iter().map(|value| size(value).max(1.0)).product();
    chain.tool_pose(values).distance(pose, chain.size()) <= CLOSES * growth
}

/// The largest imaginary part of joint values, each in parts of its size where that is above 1.
fn imaginary(values: &[JointValue]) -> f64 {
    let parts = values
        .iter()
        .map(|value| value.imaginary() / size(value).max(1.0));
    parts.fold(0.0, f64::max)
}

impl Sorted {
    fn add(&mut self, arm: &RealArm<'_>, values: Vec<JointValue>, reach: Option<Reach>) {
        let group = Group {
            freedom: arm.freedom(&values),
            values,
            ends: Vec::new(),
            elsewhere: Vec::new(),
        };
        let [regular, singular] = APART;
        let apart = if group.is_singular() {
            singular
        } else {
            regular
        };
        let mut groups = self.groups.iter();
        let same = groups.position(|other| arm.distance(&other.values, &group.values) <= apart);
        let place = same.unwrap_or(self.groups.len());
        if same.is_none() {
            self.groups.push(group);
        }
        match reach {
            Some(Reach::At(end)) => self.groups[place].ends.push(end),
            Some(Reach::Elsewhere(end)) => self.groups[place].elsewhere.push(end),
            None => {}
        }
    }
}

/// A curve of postures.
struct Motion {
    curve: SelfMotion,
    /// The place of its first arc among the answer's sets; `None` where no posture meets the task.
    set: Option<usize>,
}

/// The answer while it is made.
struct Book<'a> {
    mechanism: &'a Mechanism,
    formulation: &'a dyn ArmFormulation,
    arm: RealArm<'a>,
    pose: &'a Pose,
    ends: &'a [End],
    certify: bool,
    /// Joint values to which postures of sets should be near; empty where there are none.
    near: &'a [f64],
    answer: Postures,
}

impl Book<'_> {
    fn position(&self, values: &[JointValue], condition: f64) -> Position {
        let configuration = self.formulation.position(values, self.pose);
        Position {
            violated: violated(self.mechanism, &configuration),
            configuration,
            is_real: true,
            certified: self.certify.then_some(false),
            condition,
            is_singular: false,
            multiplicity: 1,
            dependent: Vec::new(),
            point: Vec::new(),
        }
    }

    /// Names of the free joints that have a part in one of these velocities.
    fn moving(&self, velocities: &[Vec<f64>]) -> Vec<String> {
        let chain = &self.formulation.six_joint_arm().arm;
        let moves = |k: usize| velocities.iter().any(|v| v[k].abs() > MOVES);
        let joints = chain.joints.iter().enumerate();
        let joints = joints.filter(|(k, _)| moves(*k));
        joints.map(|(_, joint)| joint.name.clone()).collect()
    }

    /// A posture that the arm refuses. Where joints move that were added to the chain, they may be at rest elsewhere on a curve.
    fn refused(&mut self, group: &Group, reason: &str) {
        self.answer.counts.degenerate += group.ends.len() as u64;
        group.elsewhere.iter().for_each(|end| self.elsewhere(*end));
        let may_rest = reason == OUT_OF_REACH && group.is_singular();
        if may_rest && neighbour(&self.arm, self.pose, &group.values).is_some() {
            self.answer.settled = false;
            self.answer
                .warnings
                .push("a set of postures may hold some that the chain reaches".into());
        }
    }

    /// A regular posture has one path.
    fn regular(&mut self, group: &Group) {
        let mut position = self.position(&group.values, group.freedom.condition());
        let counts = &mut self.answer.counts;
        counts.complex += u64::from(!group.ends.is_empty());
        counts.real += 1;
        counts.within_limits += u64::from(position.violated.is_empty());
        if self.certify {
            let mut proofs = group.ends.iter().filter_map(|k| self.ends[*k].proved);
            let is_proved = proofs.any(|proof| proof.exists && proof.is_real);
            position.certified = Some(is_proved);
            counts.certified_real = counts.certified_real.map(|n| n + u64::from(is_proved));
        }
        // Others have jumped.
        counts.failed += (group.ends.len() as u64).saturating_sub(1);
        self.answer.positions.push(position);
        if group.ends.is_empty() {
            self.without_path();
        }
        group.elsewhere.iter().for_each(|end| self.elsewhere(*end));
    }

    /// A posture was found to which no path leads: others may be missing.
    fn without_path(&mut self) {
        self.answer.settled = false;
        self.answer
            .warnings
            .push("a posture was reached to which no path leads: others may be missing".into());
    }

    /// An end that is none of the real postures reached from there.
    fn elsewhere(&mut self, end: usize) {
        let is_complex = imaginary(&self.ends[end].values) > NEARLY_REAL;
        match self.ends[end].outcome {
            _ if is_at_infinity(&self.ends[end]) => self.answer.counts.at_infinity += 1,
            PathOutcome::Singular if is_complex => self.complex(end, true),
            _ => self.answer.counts.failed += 1,
        }
    }

    /// A posture in which the screws of the joints depend: one of a set, or isolated.
    fn singular(&mut self, group: &Group, motions: &mut Vec<Motion>) {
        let with_others = (group.ends.len() + group.elsewhere.len()) as u64;
        let on_known = motions
            .iter()
            .find(|motion| motion.curve.contains(&self.arm, &group.values));
        if let Some(motion) = on_known {
            self.count_on_set(motion.set, with_others);
            return;
        }
        if let Some(start) = neighbour(&self.arm, self.pose, &group.values) {
            let before = self.answer.sets.len();
            self.sets_from(start, with_others, motions);
            if self.has_yaw(&group.values) && self.answer.sets.len() == before {
                self.may_have_yaw();
            }
            return;
        }
        if !self.has_yaw(&group.values) {
            self.answer.counts.degenerate += group.ends.len() as u64;
            group.elsewhere.iter().for_each(|end| self.elsewhere(*end));
            return;
        }
        // Singular ends elsewhere are on a complex set of which this is a real point.
        let (on_complex_set, others): (Vec<usize>, Vec<usize>) = group
            .elsewhere
            .iter()
            .partition(|end| self.ends[**end].outcome == PathOutcome::Singular);
        others.into_iter().for_each(|end| self.elsewhere(end));
        let paths = (group.ends.len() + on_complex_set.len()) as u64;
        let mut position = self.position(&group.values, group.freedom.condition());
        position.is_singular = true;
        position.multiplicity = paths;
        position.dependent = self.moving(group.freedom.at_rest(SINGULAR));
        self.answer.positions.push(position);
        self.answer.counts.singular += paths;
        match paths {
            0 => self.without_path(),
            1 => {
                self.answer.settled = false;
                self.answer.warnings.push(
                    "one path alone ends at a singular posture, which has two and more: one may be missing".into(),
                );
            }
            _ => {}
        }
    }

    /// Whether the tool has the yaw that is asked for, where one is.
    fn has_yaw(&self, values: &[JointValue]) -> bool {
        let six = self.formulation.six_joint_arm();
        six.without_yaw(values).is_none()
    }

    /// A set of postures of which none is known to have the yaw.
    fn may_have_yaw(&mut self) {
        self.answer.settled = false;
        self.answer
            .warnings
            .push("a set of postures may hold some that have the yaw".into());
    }

    /// Paths that end on a set; `None` where no posture of it meets the task.
    fn count_on_set(&mut self, set: Option<usize>, paths: u64) {
        match set {
            Some(set) => {
                self.answer.sets[set].paths += paths;
                self.answer.counts.positive_dimensional += paths;
            }
            None => self.answer.counts.degenerate += paths,
        }
    }

    /// The set of postures to which this one belongs, with its paths, and those that it meets.
    fn sets_from(&mut self, start: Neighbour, paths: u64, motions: &mut Vec<Motion>) {
        let mut open = vec![(start, paths)];
        while let Some((start, paths)) = open.pop() {
            let is_known = |motion: &Motion| motion.curve.contains(&self.arm, &start.values);
            if paths == 0 && motions.iter().any(is_known) {
                continue;
            }
            if self.answer.sets.len().max(motions.len()) >= MOST_SETS {
                self.answer.settled = false;
                self.answer.warnings.push(format!(
                    "more than {MOST_SETS} sets of postures: some are not listed"
                ));
                return;
            }
            let before = motions.len();
            self.set(paths, &start, motions);
            for motion in &motions[before..] {
                let branches = motion.curve.branches(&self.arm, self.pose);
                open.extend(branches.into_iter().map(|branch| (branch, 0)));
            }
        }
    }

    /// A set of postures, by the curve through one of them where it has one dimension. Arcs of the curve that meet the task are
    /// sets of their own.
    fn set(&mut self, paths: u64, start: &Neighbour, motions: &mut Vec<Motion>) {
        let curve = match start.velocities.len() {
            1 => SelfMotion::through(&self.arm, self.pose, start),
            _ => None,
        };
        let before = self.answer.sets.len();
        match &curve {
            Some(curve) => {
                for arc in curve.arcs(|values| self.has_yaw(values)) {
                    self.list_set(start, Some((curve, &arc)));
                }
            }
            None if self.has_yaw(&start.values) => self.list_set(start, None),
            None => self.may_have_yaw(),
        }
        let set = Some(before).filter(|before| self.answer.sets.len() > *before);
        self.count_on_set(set, paths);
        if let Some(curve) = curve {
            let chain = &self.formulation.six_joint_arm().arm;
            if !curve.is_closed && chain.joints.iter().all(|joint| joint.is_angle) {
                // Turns come back: this one was not followed to where it began.
                self.answer.settled = false;
                self.answer.warnings.push(
                    "a curve of postures could not be followed to its end: others that it meets may be missing".into(),
                );
            }
            motions.push(Motion { curve, set });
        }
    }

    /// Lists a set: an arc of a curve, or what is around one posture.
    fn list_set(&mut self, start: &Neighbour, arc: Option<(&SelfMotion, &Arc)>) {
        let postures = match arc {
            Some((curve, arc)) => arc.places.iter().map(|k| &curve.postures[*k]).collect(),
            None => vec![&start.values],
        };
        let shown = postures
            .into_iter()
            .map(|values| self.position(values, f64::INFINITY));
        // Within the limits where there is one, and of those the nearest, or the least in the sum of squares.
        let rank = |position: &Position| {
            let values = position.configuration.values.iter();
            let square: f64 = values.map(|(_, v)| v.real() * v.real()).sum();
            let size = match self.near.is_empty() {
                true => square,
                false => distance(position, self.near),
            };
            (!position.violated.is_empty(), size)
        };
        let first = |a: &Position, b: &Position| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        };
        let Some(mut posture) = shown.min_by(first) else {
            return;
        };
        posture.is_singular = true;
        posture.multiplicity = 0;
        posture.dependent = self.moving(&start.velocities);
        let chain = &self.formulation.six_joint_arm().arm;
        let spans = arc.map(|(curve, arc)| curve.spans(arc)).unwrap_or_default();
        let size = chain.size();
        let spans = chain.joints.iter().zip(spans);
        let spans = spans.filter(|(joint, _)| posture.dependent.contains(&joint.name));
        self.answer.sets.push(PostureSet {
            dimension: start.velocities.len(),
            joints: posture.dependent.clone(),
            spans: spans
                .map(|(joint, span)| {
                    let unit = if joint.is_angle { 1.0 } else { size };
                    (joint.name.clone(), span * unit)
                })
                .collect(),
            is_closed: arc.is_some_and(|(curve, arc)| curve.is_closed_arc(arc)),
            paths: 0,
            posture: posture.clone(),
        });
        self.answer.positions.push(posture);
    }

    /// A posture that is not real.
    fn complex(&mut self, end: usize, is_singular: bool) {
        let values = &self.ends[end].values;
        if self.formulation.six_joint_arm().refused(values).is_some() {
            self.answer.counts.degenerate += 1;
            return;
        }
        let configuration = self.formulation.position(values, self.pose);
        match is_singular {
            true => self.answer.counts.singular += 1,
            false => self.answer.counts.complex += 1,
        }
        self.answer.positions.push(Position {
            configuration,
            is_real: false,
            certified: self.ends[end].proved.map(|proof| proof.exists),
            violated: Vec::new(),
            condition: f64::INFINITY,
            is_singular,
            multiplicity: 1,
            dependent: Vec::new(),
            point: Vec::new(),
        });
    }

    /// Paths that have ended at one regular complex posture have jumped.
    fn duplicates(&mut self, regular: &[usize]) {
        let point = |end: usize| self.ends[end].values.iter();
        let same = |a: usize, b: usize| {
            point(a).zip(point(b)).all(|(a, b)| match (a, b) {
                (JointValue::Turn(c, s), JointValue::Turn(x, y)) => {
                    let [near, far] = [(c - x).norm_sqr() + (s - y).norm_sqr(), c.norm_sqr()];
                    near <= APART[0] * APART[0] * (1.0 + far)
                }
                (a, b) => (a.real() - b.real()).abs() <= APART[0] * (1.0 + a.real().abs()),
            })
        };
        let pairs = regular.iter().enumerate();
        let met = pairs.filter(|(k, a)| regular[..*k].iter().any(|b| same(**a, *b)));
        let met = met.count() as u64;
        if met > 0 {
            self.answer.settled = false;
            self.answer.warnings.push(format!(
                "{met} paths meet others at a regular posture: some may be missing"
            ));
        }
    }
}

//! SelfMotion: the curve of postures of one pose, along which an arm moves while its tool is at rest.

use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::real_arm::{Freedom, RealArm};

/// A tool is at a pose when no part of the gap between them is larger: radians, or parts of the arm's size. Poses that are
/// made by doubles, or written with 16 digits, are no better.
pub const AT_POSE: f64 = 1e-12;
/// Singular values below this part of the largest count as 0: nearer than its square root two postures are not told apart
/// by a pose of [`AT_POSE`].
pub const SINGULAR: f64 = 1e-6;
/// Distances of a posture at which it is asked whether there are others, in radians or parts of the size.
const NEARBY: [f64; 2] = [0.03, 0.01];
/// Step along a curve, in radians or parts of the size.
const STEP: f64 = 0.05;
/// Least step, before a curve is left as it is.
const LEAST_STEP: f64 = 1e-3;
/// Steps along a curve at most, in each direction.
const MOST_STEPS: usize = 4000;
/// Singular values below this part of the largest, a step away from a place where curves meet.
const MEETING: f64 = 2.0 * STEP;
/// How far from such a place other curves are looked for, in radians or parts of the size.
const ACROSS: [f64; 2] = [3.0 * STEP, 6.0 * STEP];
/// How far a posture on a curve may be from the tangent at the nearest one that was computed: twice what a curve bends in a
/// step whose radius of curvature is a quarter of a radian.
const FROM_TANGENT: f64 = 4.0 * STEP * STEP;

/// A posture next to a singular one, from which the arm moves on.
pub struct Neighbour {
    /// Values of the joints.
    pub values: Vec<JointValue>,
    /// Velocities of the joints that leave the tool at rest: as many as the set of postures has dimensions.
    pub velocities: Vec<Vec<f64>>,
}

/// A posture near a singular one with the same pose; `None` where the singular one is isolated.
pub fn neighbour(arm: &RealArm<'_>, pose: &Pose, values: &[JointValue]) -> Option<Neighbour> {
    let freedom = arm.freedom(values);
    let mut best: Option<Neighbour> = None;
    for velocity in directions(freedom.at_rest(SINGULAR)) {
        for distance in NEARBY {
            let step: Vec<f64> = velocity.iter().map(|v| v * distance).collect();
            let reached = arm.toward(pose, &arm.after_step(values, &step));
            let apart = arm.distance(&reached.values, values);
            if reached.gap > AT_POSE || !(distance / 8.0..=4.0 * distance).contains(&apart) {
                continue;
            }
            let freedom = arm.freedom(&reached.values);
            let velocities = freedom.at_rest(SINGULAR).to_vec();
            let is_better = best
                .as_ref()
                .is_none_or(|best| velocities.len() < best.velocities.len());
            if !velocities.is_empty() && is_better {
                best = Some(Neighbour {
                    values: reached.values,
                    velocities,
                });
            }
        }
    }
    best
}

/// Unit vectors of a space with this basis: those of the basis, and sums and differences of every two.
fn directions(basis: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut list = Vec::new();
    for (k, first) in basis.iter().enumerate() {
        list.push(first.clone());
        for second in &basis[..k] {
            for (a, b) in [(1.0, 1.0), (1.0, -1.0), (2.0, 1.0), (1.0, -2.0)] {
                let sum = first.iter().zip(second).map(|(x, y)| a * x + b * y);
                list.extend(unit(sum.collect()));
            }
        }
    }
    let opposite: Vec<Vec<f64>> = list
        .iter()
        .map(|v| v.iter().map(|x| -x).collect())
        .collect();
    list.extend(opposite);
    list
}

fn unit(vector: Vec<f64>) -> Option<Vec<f64>> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0).then(|| vector.iter().map(|x| x / length).collect())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The least singular value but one, as a part of the largest.
fn second(freedom: &Freedom) -> f64 {
    let values = &freedom.singular_values;
    match (values.first(), values.len().checked_sub(2)) {
        (Some(first), Some(k)) if *first > 0.0 => values[k] / first,
        _ => f64::INFINITY,
    }
}

/// A curve of postures.
pub struct SelfMotion {
    /// Postures along it, a step apart; of a closed one the last is the first.
    pub postures: Vec<Vec<JointValue>>,
    /// Velocities of the joints at these postures, of length 1.
    velocities: Vec<Vec<f64>>,
    /// Sums of the joints' steps from the first posture to each.
    turned: Vec<Vec<f64>>,
    /// The least singular value at each posture, apart from those of the curve itself, as a part of the largest: where
    /// it is nearly 0, other curves meet this one.
    second: Vec<f64>,
    /// Whether it comes back to where it began.
    pub is_closed: bool,
}

/// A part of a curve: places of postures that follow each other.
pub struct Arc {
    /// The places, in their order.
    pub places: Vec<usize>,
}

impl SelfMotion {
    /// The curve through a posture with this velocity.
    pub fn through(arm: &RealArm<'_>, pose: &Pose, start: &Neighbour) -> Option<Self> {
        let velocity = start.velocities.first()?;
        let mut motion = Self {
            postures: vec![start.values.clone()],
            velocities: vec![velocity.clone()],
            turned: vec![vec![0.0; velocity.len()]],
            second: vec![second(&arm.freedom(&start.values))],
            is_closed: false,
        };
        motion.extend(arm, pose);
        if !motion.is_closed {
            motion.reverse();
            motion.extend(arm, pose);
        }
        Some(motion)
    }

    fn reverse(&mut self) {
        self.postures.reverse();
        self.velocities.reverse();
        self.turned.reverse();
        self.second.reverse();
        for v in self.velocities.iter_mut().flatten() {
            *v = -*v;
        }
    }

    /// Goes on from the last posture until the curve closes or cannot be followed.
    fn extend(&mut self, arm: &RealArm<'_>, pose: &Pose) {
        let first = self.postures.len();
        let mut step = STEP;
        while self.postures.len() < first + MOST_STEPS {
            let (Some(values), Some(velocity), Some(turned)) = (
                self.postures.last(),
                self.velocities.last(),
                self.turned.last(),
            ) else {
                return;
            };
            let ahead: Vec<f64> = velocity.iter().map(|v| v * step).collect();
            let predicted = arm.after_step(values, &ahead);
            let reached = arm.toward(pose, &predicted);
            let freedom = arm.freedom(&reached.values);
            let rest = freedom.at_rest(SINGULAR);
            // Straight on where curves meet.
            let mut next = vec![0.0; velocity.len()];
            for basis in rest {
                let along = dot(basis, velocity);
                next.iter_mut()
                    .zip(basis)
                    .for_each(|(x, b)| *x += along * b);
            }
            let is_near = arm.distance(&reached.values, &predicted) < step / 2.0;
            let next = unit(next).filter(|next| dot(next, velocity) > 0.8);
            let Some(next) = next.filter(|_| is_near && reached.gap <= AT_POSE) else {
                step /= 2.0;
                if step < LEAST_STEP {
                    return;
                }
                continue;
            };
            let difference = arm.differences(values, &reached.values);
            let turned = turned.iter().zip(difference).map(|(x, d)| x + d).collect();
            self.postures.push(reached.values);
            self.velocities.push(next);
            self.turned.push(turned);
            self.second.push(second(&freedom));
            step = STEP;
            if self.postures.len() > 3 && self.meets_its_beginning(arm) {
                self.is_closed = true;
                self.close(arm);
                return;
            }
        }
    }

    /// Repeats the first posture at the end.
    fn close(&mut self, arm: &RealArm<'_>) {
        let last = self.postures.len() - 1;
        let difference = arm.differences(&self.postures[last], &self.postures[0]);
        let turned = self.turned[last].iter().zip(difference);
        self.turned.push(turned.map(|(x, d)| x + d).collect());
        self.postures.push(self.postures[0].clone());
        self.velocities.push(self.velocities[0].clone());
        self.second.push(self.second[0]);
    }

    /// Whether the last posture is about to pass the first one, in its direction.
    fn meets_its_beginning(&self, arm: &RealArm<'_>) -> bool {
        let (first, last) = (&self.postures[0], &self.postures[self.postures.len() - 1]);
        let (from, to) = (
            &self.velocities[0],
            &self.velocities[self.velocities.len() - 1],
        );
        arm.distance(last, first) < 0.75 * STEP && dot(from, to) > 0.8
    }

    /// Whether a posture of the pose lies on the curve.
    pub fn contains(&self, arm: &RealArm<'_>, values: &[JointValue]) -> bool {
        let pairs = self.postures.iter().zip(&self.velocities);
        pairs.into_iter().any(|(posture, velocity)| {
            let difference = arm.differences(posture, values);
            let along = dot(&difference, velocity);
            let aside = difference.iter().zip(velocity);
            let aside = aside
                .map(|(d, v)| (d - along * v).abs())
                .fold(0.0, f64::max);
            along.abs() <= STEP && aside <= FROM_TANGENT
        })
    }

    /// Postures of curves that may meet this one, near the places where the arm has one freedom more.
    pub fn branches(&self, arm: &RealArm<'_>, pose: &Pose) -> Vec<Neighbour> {
        let mut branches = Vec::new();
        let at = |k: usize| self.second.get(k).copied().unwrap_or(f64::INFINITY);
        let is_least = |k: &usize| {
            let before = if *k == 0 { f64::INFINITY } else { at(k - 1) };
            at(*k) < MEETING && at(*k) <= before && at(*k) <= at(k + 1)
        };
        for k in (0..self.postures.len()).filter(is_least) {
            let values = &self.postures[k];
            let freedom = arm.freedom(values);
            for velocity in directions(freedom.at_rest(MEETING)) {
                for distance in ACROSS {
                    let step: Vec<f64> = velocity.iter().map(|v| v * distance).collect();
                    let reached = arm.toward(pose, &arm.after_step(values, &step));
                    if reached.gap > AT_POSE || self.contains(arm, &reached.values) {
                        continue;
                    }
                    let velocities = arm.freedom(&reached.values).at_rest(SINGULAR).to_vec();
                    if !velocities.is_empty() {
                        branches.push(Neighbour {
                            values: reached.values,
                            velocities,
                        });
                    }
                }
            }
        }
        branches
    }

    /// The arcs of the curve of which all postures are wanted.
    pub fn arcs(&self, is_wanted: impl Fn(&[JointValue]) -> bool) -> Vec<Arc> {
        let mut arcs: Vec<Arc> = Vec::new();
        let mut is_open = false;
        for (k, values) in self.postures.iter().enumerate() {
            let goes_on = std::mem::replace(&mut is_open, is_wanted(values));
            match arcs.last_mut() {
                Some(arc) if is_open && goes_on => arc.places.push(k),
                _ if is_open => arcs.push(Arc { places: vec![k] }),
                _ => {}
            }
        }
        let last = self.postures.len() - 1;
        // Of a closed curve, the arc that ends with it goes on with the one that begins with it.
        if let ([first, .., end], true) = (&mut arcs[..], self.is_closed)
            && first.places.first() == Some(&0)
            && end.places.last() == Some(&last)
        {
            end.places.extend(std::mem::take(&mut first.places));
            arcs.swap_remove(0);
        }
        arcs
    }

    /// By how much each joint moves along an arc, from its least to its largest value: radians, or parts of the size.
    pub fn spans(&self, arc: &Arc) -> Vec<f64> {
        let joints = self.turned.first().map_or(0, Vec::len);
        let span = |joint: usize| {
            let (mut x, mut low, mut high) = (0.0f64, 0.0f64, 0.0f64);
            for pair in arc.places.windows(2) {
                // Where a closed curve goes on from its beginning, both are one posture.
                if pair[1] > pair[0] {
                    x += self.turned[pair[1]][joint] - self.turned[pair[0]][joint];
                }
                (low, high) = (low.min(x), high.max(x));
            }
            high - low
        };
        (0..joints).map(span).collect()
    }

    /// Whether an arc is a curve that comes back to where it begins.
    pub fn is_closed_arc(&self, arc: &Arc) -> bool {
        self.is_closed && arc.places.len() == self.postures.len()
    }
}

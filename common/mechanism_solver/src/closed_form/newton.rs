//! Newton's method on the arm: the hand's frame as a function of the turns, in real numbers where they are real.

use super::condition::condition;
use super::number::Number;
use super::six_turns::{Link, SixTurns};
use super::turn::{Turn, Turns};
use cognate_kinematics::mechanism::pose::Pose;
use num_complex::Complex64;

/// Joints, and numbers of a screw.
const SIX: usize = 6;
/// Steps at most.
const MOST_STEPS: usize = 4;
/// A hand is where it should be within this, in parts of the growth of numbers along the arm: rounding of its product.
const EXACT: f64 = 8e-15;
/// A hand that is further away than this after all steps is not reached.
const REACHED: f64 = 1e-12;

/// Rotation and shift of a velocity or of a gap.
type Twist<T> = [T; SIX];

/// A posture that was brought to the digits of the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polished {
    /// The turns.
    pub turns: Turns,
    /// Condition number of the joints' screws; of complex turns the quotient of their largest and least pivot.
    pub condition: f64,
}

/// Brings turns near a posture to it; `None` where the hand does not come to its place. Screws of real turns are those about
/// the point `tool` of the hand's frame.
pub fn polished(arm: &SixTurns, hand: &Pose, turns: &Turns, tool: [f64; 3]) -> Option<Polished> {
    let is_real = turns.iter().all(|turn| turn.imaginary() == 0.0);
    if !is_real {
        let there = Posture {
            turns: turns.map(|turn| [turn.c, turn.s]),
            pivots: None,
        };
        let there = there.brought_to(arm, &Frame::of(hand, |x| x))?;
        return Some(Polished {
            turns: there.turns.map(|[c, s]| Turn { c, s }),
            condition: there.pivots?,
        });
    }
    let there = Posture {
        turns: turns.map(|turn| [turn.c.re, turn.s.re]),
        pivots: None,
    };
    let there = there.brought_to(arm, &Frame::of(hand, |x| x.re))?;
    let (screws, reached) = screws(arm, &there.turns);
    Some(Polished {
        turns: there.turns.map(|[c, s]| Turn {
            c: c.into(),
            s: s.into(),
        }),
        condition: condition(&about(screws, reached.seen(tool))),
    })
}

/// Screws about a point that is this far from where they were.
fn about(mut screws: [Twist<f64>; SIX], [u, v, w]: [f64; 3]) -> [Twist<f64>; SIX] {
    for [x, y, z, a, b, c] in &mut screws {
        *a += *y * w - *z * v;
        *b += *z * u - *x * w;
        *c += *x * v - *y * u;
    }
    screws
}

/// Cosines and sines near a posture.
struct Posture<T> {
    turns: [[T; 2]; SIX],
    /// Quotient of the largest and the least pivot of the last step; `None` before the first.
    pivots: Option<f64>,
}

impl<T: Number> Posture<T> {
    /// The posture at which the hand is in its place; `None` where it does not come there.
    fn brought_to(mut self, arm: &SixTurns, hand: &Frame<T>) -> Option<Self> {
        for step in 0..=MOST_STEPS {
            let (screws, reached) = screws(arm, &self.turns);
            let sizes = self.turns.iter().map(|[c, s]| c.square().max(s.square()));
            let growth: f64 = sizes.map(|size| size.max(1.0)).product::<f64>().sqrt();
            let gap = reached.distance(hand);
            if gap.is_nan() || growth.is_nan() {
                return None;
            }
            // Complex postures are told to be regular by their pivots.
            let may_end = T::IS_REAL || step > 0;
            if may_end && gap <= EXACT * growth {
                return Some(self);
            }
            if step == MOST_STEPS {
                return (gap <= REACHED * growth).then_some(self);
            }
            let (angles, pivots) = solved(screws, reached.toward(hand))?;
            self.pivots = Some(pivots);
            for (turn, angle) in self.turns.iter_mut().zip(angles) {
                *turn = moved(*turn, angle);
            }
        }
        None
    }
}

/// A turn by a small angle more. By tan(angle/2) up to its third power: the numbers stay on the circle.
fn moved<T: Number>([c, s]: [T; 2], angle: T) -> [T; 2] {
    let t = angle * 0.5 * (angle * angle * (1.0 / 12.0) + T::from(1.0));
    let (ahead, aside) = (T::from(1.0) - t * t, t * 2.0);
    let (x, y) = (c * ahead - s * aside, s * ahead + c * aside);
    let over = t * t + T::from(1.0);
    let (x, y) = (x / over, y / over);
    // One step of Newton's method for the root of the square, which is 1 up to rounding.
    let factor = (T::from(3.0) - (x * x + y * y)) * 0.5;
    [x * factor, y * factor]
}

/// A frame by the columns of its rotation, and its origin.
#[derive(Clone, Copy, Debug)]
struct Frame<T> {
    columns: [[T; 3]; 3],
    place: [T; 3],
}

impl<T: Number> Frame<T> {
    fn of(pose: &Pose, number: impl Fn(Complex64) -> T) -> Self {
        Self {
            columns: std::array::from_fn(|j| pose.column(j).map(&number)),
            place: pose.position.map(&number),
        }
    }

    fn turned(&mut self, [c, s]: [T; 2]) {
        let [x, y, _] = &mut self.columns;
        for (x, y) in x.iter_mut().zip(y) {
            (*x, *y) = (*x * c + *y * s, *y * c - *x * s);
        }
    }

    fn along(&mut self, link: &Link) {
        let [c, s] = link.twist;
        let [x, y, z] = &mut self.columns;
        for k in 0..3 {
            self.place[k] = self.place[k] + x[k] * link.length + z[k] * link.offset;
            (y[k], z[k]) = (y[k] * c + z[k] * s, z[k] * c - y[k] * s);
        }
    }

    /// A vector of the frame as it is seen outside.
    fn seen(&self, vector: [f64; 3]) -> [T; 3] {
        let [x, y, z] = &self.columns;
        std::array::from_fn(|k| x[k] * vector[0] + y[k] * vector[1] + z[k] * vector[2])
    }

    /// The largest difference of a number.
    fn distance(&self, other: &Self) -> f64 {
        let columns = self.columns.iter().zip(&other.columns);
        let vectors = columns.chain([(&self.place, &other.place)]);
        let mut most = 0.0;
        for (a, b) in vectors {
            for k in 0..3 {
                let square = (a[k] - b[k]).square();
                // A square that is not a number counts as the largest.
                most = if square <= most { most } else { square };
            }
        }
        most.sqrt()
    }

    /// The twist to another frame that is near: half of the sum of vector products of their columns, and the difference
    /// of their places.
    fn toward(&self, other: &Self) -> Twist<T> {
        let mut gap = [T::from(0.0); SIX];
        for (a, b) in self.columns.iter().zip(&other.columns) {
            for (k, turn) in cross(a, b).into_iter().enumerate() {
                gap[k] = gap[k] + turn * 0.5;
            }
        }
        for k in 0..3 {
            gap[3 + k] = other.place[k] - self.place[k];
        }
        gap
    }
}

fn cross<T: Number>([x, y, z]: &[T; 3], [u, v, w]: &[T; 3]) -> [T; 3] {
    [*y * *w - *z * *v, *z * *u - *x * *w, *x * *v - *y * *u]
}

/// The screws of the joints about the hand's place, and the hand.
fn screws<T: Number>(arm: &SixTurns, turns: &[[T; 2]; SIX]) -> ([Twist<T>; SIX], Frame<T>) {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    let mut frame = Frame {
        columns: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        place: [zero; 3],
    };
    let mut axes = [([zero; 3], [zero; 3]); SIX];
    for ((place, turn), axis) in turns.iter().enumerate().zip(&mut axes) {
        *axis = (frame.columns[2], frame.place);
        frame.turned(*turn);
        if let Some(link) = arm.links.get(place) {
            frame.along(link);
        }
    }
    let screw = |(direction, point): ([T; 3], [T; 3])| {
        let arm = std::array::from_fn(|k| frame.place[k] - point[k]);
        let [u, v, w] = cross(&direction, &arm);
        let [x, y, z] = direction;
        [x, y, z, u, v, w]
    };
    (axes.map(screw), frame)
}

/// The velocities whose screws add up to a gap, by elimination with the largest pivot of all, and the quotient of the largest and
/// the least pivot; `None` where a pivot is 0.
fn solved<T: Number>(mut columns: [Twist<T>; SIX], mut gap: Twist<T>) -> Option<(Twist<T>, f64)> {
    let mut order: [usize; SIX] = std::array::from_fn(|k| k);
    let (mut first, mut least) = (0.0, 0.0);
    for k in 0..SIX {
        let (mut size, mut column, mut row) = (0.0, k, k);
        for j in k..SIX {
            for i in k..SIX {
                let here = columns[j][i].square();
                if here > size {
                    (size, column, row) = (here, j, i);
                }
            }
        }
        if size.is_nan() || size == 0.0 {
            return None;
        }
        least = size;
        if k == 0 {
            first = size;
        }
        columns.swap(k, column);
        order.swap(k, column);
        for other in &mut columns {
            other.swap(k, row);
        }
        gap.swap(k, row);
        let pivot = columns[k];
        let inverse = T::from(1.0) / pivot[k];
        for other in columns[k + 1..].iter_mut().chain([&mut gap]) {
            let factor = other[k] * inverse;
            for i in k + 1..SIX {
                other[i] = other[i] - pivot[i] * factor;
            }
            other[k] = factor;
        }
    }
    // Row k of the columns behind holds their factors.
    let mut velocities = [T::from(0.0); SIX];
    for k in (0..SIX).rev() {
        for j in k + 1..SIX {
            gap[k] = gap[k] - columns[j][k] * gap[j];
        }
        velocities[order[k]] = gap[k];
    }
    Some((velocities, (first / least).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::super::test_arms::{link, turns};
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    #[test]
    fn turns_near_a_posture_come_to_it() {
        let arm = SixTurns {
            links: [
                link(0.1, 70.0, 0.4),
                link(0.3, 20.0, 0.1),
                link(0.2, -90.0, 0.3),
                link(0.1, 90.0, -0.2),
                link(0.1, 60.0, 0.5),
            ],
        };
        let mut random = RandomStream::new(3, Purpose::Test, 75);
        for _ in 0..100 {
            let posture = turns(&mut random);
            let hand = arm.hand(&posture);
            let near = posture.map(|turn| {
                let [c, s] = moved([turn.c, turn.s], (random.disc() * 1e-5).re.into());
                Turn { c, s }
            });
            let Some(polished) = polished(&arm, &hand, &near, [0.0; 3]) else {
                continue;
            };
            if polished.condition > 1e4 {
                continue;
            }
            for (turn, expected) in polished.turns.iter().zip(&posture) {
                assert!(turn.imaginary() == 0.0);
                let apart = (turn.c - expected.c).norm_sqr() + (turn.s - expected.s).norm_sqr();
                assert!(apart.sqrt() < 1e-11, "{apart:e} {}", polished.condition);
            }
        }
    }

    #[test]
    fn columns_are_solved_and_dependent_ones_told() {
        let mut random = RandomStream::new(4, Purpose::Test, 75);
        let mut column = || -> Twist<Complex64> { std::array::from_fn(|_| random.disc()) };
        let mut columns: [Twist<Complex64>; SIX] = std::array::from_fn(|_| column());
        let expected = column();
        let image = |columns: &[Twist<Complex64>; SIX]| -> Twist<Complex64> {
            std::array::from_fn(|i| (0..SIX).map(|k| columns[k][i] * expected[k]).sum())
        };
        let (velocities, condition) = solved(columns, image(&columns)).expect("regular columns");
        for (x, y) in velocities.iter().zip(&expected) {
            assert!((x - y).norm_sqr().sqrt() < 1e-13 * condition);
        }
        columns[2] = columns[4];
        let gap = image(&columns);
        assert!(solved(columns, gap).is_none_or(|(_, condition)| condition > 1e14));
    }
}

//! Batch: where the paths of all lanes are, where they were, and where they go next.

use super::digits::Digits;
use super::taylor_probe::Series;
use crate::predictor::hermite::{POINTS, weights};
use cognate_numeric::scalar::{Complex, Mask, Real};
use num_complex::Complex64;

/// Points of a path, and where the next one is tried.
const SLOTS: usize = POINTS + 1;

/// The paths of all lanes: coordinates in the chart.
///
/// The points stand in a ring, with one slot for the step that is tried. In lanes that do not move, while others do, the
/// point that the ring would lose takes a free slot: a rejected step leaves a lane with the points that it had, since a
/// prediction from fewer of them would fail at a shorter step too. So their order is not that of the path: the oldest
/// point may outlive a newer one by some steps.
pub(super) struct Batch<R: Real> {
    pub x: [Vec<Complex<R>>; SLOTS],
    pub tangent: [Vec<Complex<R>>; SLOTS],
    /// Points where the turns around 0 begin.
    anchor: Vec<Complex<R>>,
    anchor_tangent: Vec<Complex<R>>,
    pub t: [Complex<R::Control>; SLOTS],
    /// Lanes in which the point of a slot counts; the present point of a path always counts.
    pub known: [R::Mask; SLOTS],
    /// The slot where the paths are.
    pub newest: usize,
    pub target: Complex<R::Control>,
    /// Wanted length of the next step.
    pub h: R::Control,
    /// Largest first Newton correction of a step, relative to the largest coordinate.
    pub limit: R::Control,
    usual_limit: f64,
    /// Lanes whose next step has length 0.
    pub refine: R::Mask,
    /// Lanes whose last step was not rejected.
    pub may_grow: R::Mask,
    pub a: Vec<Complex<R>>,
    pub b: Vec<Complex<R>>,
    pub exchanges: R::Control,
}

impl<R: Real> Batch<R> {
    pub fn new(context: R::Context, dimension: usize, parameters: usize, limit: f64) -> Self {
        let points = || vec![Complex::<R>::zero(context); dimension];
        let control = |v: f64| R::Control::from_f64((), v);
        Self {
            x: std::array::from_fn(|_| points()),
            tangent: std::array::from_fn(|_| points()),
            anchor: points(),
            anchor_tangent: points(),
            t: std::array::from_fn(|_| Complex::from_f64((), 1.0, 0.0)),
            known: [R::Mask::splat(false); SLOTS],
            newest: 0,
            target: Complex::from_f64((), 1.0, 0.0),
            h: control(0.0),
            limit: control(limit),
            usual_limit: limit,
            refine: R::Mask::splat(true),
            may_grow: R::Mask::splat(true),
            a: vec![Complex::zero(context); parameters],
            b: vec![Complex::zero(context); parameters],
            exchanges: control(0.0),
        }
    }

    /// The slot with the points of `age` steps ago.
    #[inline(always)]
    pub fn slot(&self, age: usize) -> usize {
        (self.newest + age) % SLOTS
    }

    /// Present points of the paths.
    pub fn here(&self) -> &[Complex<R>] {
        &self.x[self.newest]
    }

    /// Tangents of the paths at their present points.
    pub fn tangent_here(&self) -> &[Complex<R>] {
        &self.tangent[self.newest]
    }

    /// Present t of a path.
    pub fn t(&self, lane: usize) -> Complex64 {
        self.t[self.newest].lane(lane)
    }

    /// The slot of the nearest point behind a path.
    pub fn before(&self, lane: usize) -> usize {
        let here = self.t(lane);
        let way = |slot: usize| (self.t[slot].lane(lane) - here).norm_sqr();
        (1..POINTS)
            .map(|age| self.slot(age))
            .filter(|&slot| self.known[slot].lane(lane))
            .min_by(|&a, &b| way(a).total_cmp(&way(b)))
            .expect("the path has moved")
    }

    /// Interpolates a path's point at real `t` between its present and earlier points.
    pub fn between(&self, lane: usize, t: f64) -> Vec<Complex64> {
        let native = |z: Complex64| Complex { re: z.re, im: z.im };
        let slots: [usize; POINTS] = std::array::from_fn(|age| self.slot(age));
        let history: [bool; POINTS - 1] =
            std::array::from_fn(|k| self.known[slots[k + 1]].lane(lane));
        let times = std::array::from_fn(|age| native(self.t[slots[age]].lane(lane)));
        let w = weights::<f64>(&times, &Complex { re: t, im: 0.0 }, &history);
        let weight = |z: &Complex<f64>| Complex64::new(z.re, z.im);
        let mut point = vec![Complex64::default(); self.here().len()];
        for (age, &slot) in slots.iter().enumerate() {
            if age > 0 && !history[age - 1] {
                continue;
            }
            let (value, slope) = (weight(&w.point[age]), weight(&w.tangent[age]));
            let both = self.x[slot].iter().zip(&self.tangent[slot]);
            for (sum, (x, tangent)) in point.iter_mut().zip(both) {
                *sum += value * x.lane(lane) + slope * tangent.lane(lane);
            }
        }
        point
    }

    /// The points behind a lane no longer belong to where it goes.
    pub fn forget_history(&mut self, lane: usize) {
        for lanes in &mut self.known {
            lanes.set_lane(lane, false);
        }
    }

    pub fn read(
        &self,
        lane: usize,
        slot: usize,
        point: &mut Vec<Complex64>,
        tangent: &mut Vec<Complex64>,
    ) {
        point.clear();
        point.extend(self.x[slot].iter().map(|z| z.lane(lane)));
        tangent.clear();
        tangent.extend(self.tangent[slot].iter().map(|z| z.lane(lane)));
    }

    pub fn read_here(&self, lane: usize, point: &mut Vec<Complex64>, tangent: &mut Vec<Complex64>) {
        self.read(lane, self.newest, point, tangent);
    }

    /// Begins a path at this point.
    pub fn write(&mut self, lane: usize, t: Complex64, point: &[Complex64]) {
        let slot = self.newest;
        let both = self.x[slot].iter_mut().zip(&mut self.tangent[slot]);
        for ((x, tangent), value) in both.zip(point) {
            x.set_lane(lane, *value);
            tangent.set_lane(lane, *value);
        }
        self.arrive(lane, t);
    }

    /// Takes a path from another context, with all its digits.
    pub fn write_digits(
        &mut self,
        context: R::Context,
        lane: usize,
        t: Complex64,
        point: &[Digits],
    ) {
        let (slot, only) = (self.newest, one_lane::<R>(lane));
        let both = self.x[slot].iter_mut().zip(&mut self.tangent[slot]);
        for ((x, tangent), digits) in both.zip(point) {
            let value = digits.value::<R>(context);
            x.select(only, &value);
            tangent.select(only, &value);
        }
        self.arrive(lane, t);
    }

    /// A lane is somewhere else than it was.
    pub fn arrive(&mut self, lane: usize, t: Complex64) {
        self.t[self.newest].set_lane(lane, t);
        self.forget_history(lane);
    }

    /// Present point of a path with all its digits.
    pub fn digits(&self, lane: usize) -> Vec<Digits> {
        self.here().iter().map(|z| Digits::of(z, lane)).collect()
    }

    /// Replaces, in these lanes, the points that a step led to by the present points of the paths.
    #[inline(always)]
    pub fn stay(&self, x: &mut [Complex<R>], tangent: &mut [Complex<R>], stays: R::Mask) {
        if stays.any() {
            for i in 0..x.len() {
                x[i].select(stays, &self.x[self.newest][i]);
                tangent[i].select(stays, &self.tangent[self.newest][i]);
            }
        }
    }

    /// Takes the points that a step has led to, `moved` lanes at `t`; in lanes that did not move their coordinates are
    /// those where the lane is.
    #[inline(always)]
    pub fn advance(
        &mut self,
        x: Vec<Complex<R>>,
        tangent: Vec<Complex<R>>,
        t: &Complex<R::Control>,
        moved: R::Mask,
    ) {
        let (newest, next) = (self.newest, self.slot(POINTS));
        let mut there = self.t[newest].clone();
        there.select(moved, t);
        self.known[newest] = moved;
        let stays = moved.not();
        if stays.any() {
            // The slot behind is free there, since a lane that stays is in the next one as well: the last point goes there.
            let last = self.slot(POINTS - 1);
            for points in [&mut self.x, &mut self.tangent] {
                select(points, newest, last, stays);
            }
            let before = self.t[last].clone();
            self.t[newest].select(stays, &before);
            self.known[newest] = moved.or(self.known[last]);
        }
        (self.x[next], self.tangent[next], self.t[next]) = (x, tangent, there);
        self.known[next] = R::Mask::splat(false);
        self.newest = next;
    }

    /// Remembers where a lane is.
    pub fn drop_anchor(&mut self, lane: usize) {
        let (slot, only) = (self.newest, one_lane::<R>(lane));
        for i in 0..self.anchor.len() {
            self.anchor[i].select(only, &self.x[slot][i]);
            self.anchor_tangent[i].select(only, &self.tangent[slot][i]);
        }
    }

    /// The points that [`Self::drop_anchor`] remembered, all lanes.
    pub fn anchor(&self) -> &[Complex<R>] {
        &self.anchor
    }

    /// Takes a lane back to where it was at real `t`.
    pub fn return_to_anchor(&mut self, lane: usize, t: f64) {
        let (slot, only) = (self.newest, one_lane::<R>(lane));
        for i in 0..self.anchor.len() {
            self.x[slot][i].select(only, &self.anchor[i]);
            self.tangent[slot][i].select(only, &self.anchor_tangent[i]);
        }
        self.arrive(lane, Complex64::new(t, 0.0));
    }

    /// Takes a lane back by one step; gives its t there.
    pub fn step_back(&mut self, lane: usize) -> Complex64 {
        let (from, to, only) = (self.before(lane), self.newest, one_lane::<R>(lane));
        for points in [&mut self.x, &mut self.tangent] {
            select(points, to, from, only);
        }
        let t = self.t[from].lane(lane);
        self.arrive(lane, t);
        t
    }

    /// The lane's next step has length 0.
    pub fn refine(&mut self, lane: usize) {
        self.refine.set_lane(lane, true);
    }

    /// The lane's next steps lead to `target`, the first at most `h` long.
    pub fn follow(&mut self, lane: usize, target: Complex64, h: f64) {
        self.target.set_lane(lane, target);
        self.h.set_lane(lane, h);
        self.limit.set_lane(lane, self.usual_limit);
        self.refine.set_lane(lane, false);
        self.may_grow.set_lane(lane, true);
    }

    /// Predicts a lane's path by its series, a way of length `s` from where it is.
    pub fn extrapolate(
        &self,
        context: R::Context,
        lane: usize,
        series: &Series,
        s: f64,
        predicted: &mut [Complex<R>],
    ) {
        let only = one_lane::<R>(lane);
        let coordinates = predicted.iter_mut().zip(self.here());
        for ((predicted, here), by) in coordinates.zip(series.displacements(s)) {
            let mut there = here.clone();
            there.add(&Complex::from_f64(context, by.re, by.im));
            predicted.select(only, &there);
        }
    }

    /// The lane's next steps are no longer and no coarser than this.
    pub fn restrict(&mut self, lane: usize, h: f64, limit: f64) {
        self.h.set_lane(lane, self.h.lane(lane).min(h));
        self.limit.set_lane(lane, self.usual_limit.min(limit));
    }
}

/// Copies the lanes of a mask from slot to slot.
#[inline(always)]
fn select<R: Real>(slots: &mut [Vec<Complex<R>>], to: usize, from: usize, lanes: R::Mask) {
    let two = slots.get_disjoint_mut([from, to]);
    let [from, to] = two.expect("they are two slots");
    for (to, from) in to.iter_mut().zip(from) {
        to.select(lanes, from);
    }
}

/// The mask of one lane.
fn one_lane<R: Real>(lane: usize) -> R::Mask {
    let mut only = R::Mask::splat(false);
    only.set_lane(lane, true);
    only
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::lanes::Lanes;

    #[test]
    fn a_lane_that_stays_keeps_the_points_behind_it() {
        type Two = Lanes<2>;
        let mut batch = Batch::<Two>::new((), 1, 0, 1e-4);
        let number = |value: f64| Complex::<Two>::from_f64((), value, 0.0);
        // The second lane moves in all steps but the fourth and the last.
        let moves = [true, true, true, false, true, false];
        for (step, moves) in moves.into_iter().enumerate() {
            let value = step as f64 + 1.0;
            let mut moved = <Two as Real>::Mask::splat(true);
            moved.set_lane(1, moves);
            let mut x = vec![number(value)];
            x[0].select(moved.not(), &batch.here()[0]);
            let t = Complex::from_f64((), -value, 0.0);
            batch.advance(x.clone(), x, &t, moved);
        }
        let counting_times = |lane: usize| -> Vec<f64> {
            let ages = (0..POINTS).map(|age| batch.slot(age));
            let counting = ages
                .enumerate()
                .filter(|&(age, slot)| age == 0 || batch.known[slot].lane(lane));
            counting
                .map(|(_, slot)| {
                    assert!(
                        (batch.t[slot].lane(lane).re + batch.x[slot][0].lane(lane).re).abs() < 1.5
                    );
                    batch.x[slot][0].lane(lane).re
                })
                .collect()
        };
        assert_eq!(counting_times(0), [6.0, 5.0, 4.0, 3.0]);
        let mut points = counting_times(1);
        points.sort_by(f64::total_cmp);
        assert_eq!(points, [0.0, 2.0, 3.0, 5.0]);
        let before = batch.before(1);
        assert_eq!(batch.x[before][0].lane(1).re, 3.0);
    }
}

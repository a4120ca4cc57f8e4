//! The split of a pure set into components: sums of second derivatives say what is closed, loops what belongs
//! together.
//!
//! A union of components, and nothing else, has witness points whose second derivatives along a moving slice have the
//! sum 0 (see `continuation::bend`); a smallest set of points with this sum is a component. All unions of few classes
//! of points are tried. Where there are more classes, loops of the slice join points first: around a loop each point
//! comes to a point of the same component.

mod jumps;
mod witness_sets;

use super::classes::{Class, join};
use super::deflated::{Deflations, PureSet};
use super::job::{Job, Tracking};
use super::moved::{MovedPoints, is_closed, misses_points};
use super::problem::Problem;
use super::proof::moving_slices;
use super::search::Search;
use super::symmetry::{PointImages, WAYS};
use cognate_continuation::bend::{length, rounded};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_systems::slices::form;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::Trace;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Most classes of which all unions are tried.
const MOST_CLASSES: usize = 16;
/// Most loops in all.
const MOST_LOOPS: u32 = 200;
/// A path that came back is at a witness point within this, relative to the point.
const BACK: f64 = 1e-6;
/// Most points of a set whose conjugates and images under a symmetry group are followed.
const MOST_IMAGES: usize = 5000;
/// Streams of random numbers from this one on are those of images under a symmetry group.
const IMAGES: u64 = 1 << 40;
/// Stages of a loop: to two other slices and back.
const LEGS: usize = 3;

/// Split of one set into components.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Split {
    set: PureSet,
    /// Derivatives of the points; `None` while they are asked for.
    bends: Option<MovedPoints>,
    classes: Vec<Class>,
    smallest_wrong: Option<f64>,
    loops: u32,
    idle: u32,
    broken: u64,
    /// Pairs of a point and its image under each loop, without points that came back to themselves.
    edges: Vec<Vec<[usize; 2]>>,
    /// The leg that is open, its points, and the witness points where its paths began.
    leg: usize,
    travellers: Vec<usize>,
    /// Points that were lost, looked for by loops.
    search: Search,
    /// Images of the points under the symmetry group.
    symmetry: PointImages,
    /// Images under one of its generators are under way.
    turning: bool,
    /// Conjugates of the witness points are under way.
    mirroring: bool,
    /// The witness point where the conjugate of each is after its slice has moved back; `None` where that was not
    /// asked or is not clear.
    mirrored: Option<Vec<usize>>,
}

impl Split {
    pub fn new(set: PureSet) -> Self {
        Self {
            classes: (0..set.points.len()).map(Class::of).collect(),
            bends: None,
            set,
            smallest_wrong: None,
            loops: 0,
            idle: 0,
            broken: 0,
            edges: Vec::new(),
            leg: 0,
            travellers: Vec::new(),
            search: Search::default(),
            symmetry: PointImages::default(),
            turning: false,
            mirroring: false,
            mirrored: None,
        }
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(
        &mut self,
        (problem, deflations): (&Problem, &mut Deflations),
        done: Option<Job>,
    ) -> Option<Job> {
        let variable_count = problem.variables();
        if self.set.dimension == 0 {
            let conjugates = self.conjugates(problem);
            self.mirrored = self.images(&conjugates, variable_count);
            while let Some(images) = self.next_images(problem) {
                let images = self.images(&images, variable_count);
                self.symmetry.take(images);
            }
            return None;
        }
        if self.mirroring {
            let ends = done.as_ref().and_then(arrivals);
            self.mirrored = ends.and_then(|ends| self.images(&ends, variable_count));
            return None;
        }
        if std::mem::take(&mut self.turning) {
            let ends = done.as_ref().and_then(arrivals);
            let images = ends.and_then(|ends| self.images(&ends, variable_count));
            self.symmetry.take(images);
            return self.next_stage(problem, deflations);
        }
        let Some(_) = &self.bends else {
            let Some(job) = done else {
                return Some(self.ask_bends(problem));
            };
            self.bends = job.into_moved();
            return self.next_stage(problem, deflations);
        };
        let mut points = self.travelling();
        if self.search.asks_bends() {
            if let Some(job) = done {
                if let (Some(bends), Some(moved)) = (&mut self.bends, job.into_moved()) {
                    bends.extend(moved);
                }
                self.search.bends_are_known();
            }
        } else if let Some(job) = done {
            let arrived = arrivals(&job);
            self.leg += 1;
            match (arrived, self.leg == LEGS) {
                (Some(ends), false) => points = ends,
                (Some(ends), true) if self.search.is_on() => {
                    if let Some(job) = self.take_lost((problem, deflations), &ends) {
                        return Some(job);
                    }
                }
                (Some(ends), true) => self.close_loop(&ends, variable_count),
                (None, _) => self.give_up_loop(),
            }
            if self.leg > 0 {
                return Some(self.track(problem, deflations, &points));
            }
        }
        self.next_stage(problem, deflations)
    }

    /// Next stage while no loop is under way.
    fn next_stage(&mut self, problem: &Problem, deflations: &mut Deflations) -> Option<Job> {
        let turn = self.turn(problem, deflations);
        let next = turn.or_else(|| self.next_loop(problem, deflations));
        next.or_else(|| self.mirror(problem, deflations))
    }

    /// The images of all points under the next generator of the symmetry group; `None` where there is none, or the set
    /// has many points or is deflated.
    fn next_images(&mut self, problem: &Problem) -> Option<Vec<Vec<Complex64>>> {
        let (generator, _) = self.symmetry.next();
        let map = problem.symmetry.get(generator)?;
        if !self.set.ranks.is_empty() || self.set.points.len() > MOST_IMAGES {
            return None;
        }
        self.travellers = (0..self.set.points.len()).collect();
        let points = self.set.doubles().into_iter();
        Some(points.map(|point| map.image(&point)).collect())
    }

    /// The stage that moves the images of the points from the images of the slices back to their own. A multiple of a
    /// slice is the same slice, and begins another way.
    fn turn(&mut self, problem: &Problem, deflations: &mut Deflations) -> Option<Job> {
        let points = self.next_images(problem)?;
        self.turning = true;
        let (generator, way) = self.symmetry.next();
        let number = (generator * WAYS + way) as u64;
        let mut random = RandomStream::new(problem.seed(), Purpose::Loop, IMAGES + number);
        let mut start = Vec::new();
        for row in &problem.slices(self.set.dimension) {
            let factor = random.unit();
            let image = problem.symmetry[generator].slice(row);
            start.extend(image.into_iter().map(|c| c * factor));
        }
        Some(self.move_home((problem, deflations), start, &points, &problem.tracking))
    }

    /// The conjugates of the points; none where conjugation means nothing or the set has many points.
    fn conjugates(&mut self, problem: &Problem) -> Vec<Vec<Complex64>> {
        self.travellers = (0..self.set.points.len()).collect();
        let Some(involution) = &problem.involution else {
            return Vec::new();
        };
        if !self.set.ranks.is_empty() || self.set.points.len() > MOST_IMAGES {
            return Vec::new();
        }
        let points = self.set.doubles().into_iter();
        points.map(|point| involution.image(&point)).collect()
    }

    /// The stage that moves the conjugates of the points from the conjugate slices back to their own.
    fn mirror(&mut self, problem: &Problem, deflations: &mut Deflations) -> Option<Job> {
        let points = self.conjugates(problem);
        let involution = problem.involution.as_ref().filter(|_| !points.is_empty())?;
        self.mirroring = true;
        let mut start = Vec::new();
        for row in &problem.slices(self.set.dimension) {
            start.push(row[0].conj());
            start.extend(involution.image(&row[1..]));
        }
        let with = problem.tracking.soon_given_up();
        Some(self.move_home((problem, deflations), start, &points, &with))
    }

    /// The stage that moves points from these slices to those of the set.
    fn move_home(
        &self,
        (problem, deflations): (&Problem, &mut Deflations),
        start: Vec<Complex64>,
        points: &[Vec<Complex64>],
        with: &Tracking,
    ) -> Job {
        let homotopy = HomotopyKind::Parameter {
            start,
            targets: vec![problem.slices(self.set.dimension).concat()],
        };
        let system = deflations.of_stage(problem, &self.set.tracked());
        let system = (self.set.tracked(), &*system);
        Job::track(system, homotopy, points, with).ends_only()
    }

    /// The stage that asks how the points move when the slices do.
    fn ask_bends(&self, problem: &Problem) -> Job {
        let dimension = self.set.dimension;
        let ends = moving_slices(problem, dimension);
        let bend_count = self.bends.as_ref().map_or(0, MovedPoints::count);
        let points = self.set.stored_from(bend_count);
        let variable_count = problem.variables();
        Job::bend_for_sums(
            self.set.whole(),
            ends,
            points,
            variable_count,
            &problem.tracking,
        )
    }

    /// The next loop, where there are classes that it may bring together.
    fn next_loop(&mut self, problem: &Problem, deflations: &mut Deflations) -> Option<Job> {
        if !problem.split {
            return None;
        }
        let variable_count = problem.variables();
        self.close(variable_count);
        let open = self.open().count();
        let more = self.loops < MOST_LOOPS;
        let hopeless = self.hopeless();
        let searches = hopeless && self.misses_points();
        let goes_on = match searches {
            true => more && self.search.begin(),
            false => {
                self.search.end();
                let untested = self
                    .open()
                    .any(|class| self.is_untested(class, variable_count));
                let together = open <= 1 && !untested;
                !together && !hopeless && more && self.idle < problem.idle_loops
            }
        };
        if !goes_on {
            return None;
        }
        self.travellers = self.open().flat_map(|c| c.points.clone()).collect();
        self.travellers.sort_unstable();
        if self.symmetry.are_known() && !self.search.is_on() {
            // The others' loops are images of theirs.
            self.travellers = self.symmetry.least_of_each(&self.travellers);
        }
        let points = self.travelling();
        Some(self.track(problem, deflations, &points))
    }

    fn open(&self) -> impl Iterator<Item = &Class> {
        self.classes.iter().filter(|class| class.closed.is_none())
    }

    fn travelling(&self) -> Vec<Vec<Complex64>> {
        let double = |&k: &usize| self.set.points[k].point.iter().map(rounded).collect();
        self.travellers.iter().map(double).collect()
    }

    /// Coefficients of all slices where a leg of a loop begins or ends.
    fn corner(&self, problem: &Problem, leg: usize) -> Vec<Complex64> {
        let (n, dimension) = (problem.variables(), self.set.dimension);
        if leg == 0 || leg == LEGS {
            return problem.slices(dimension).concat();
        }
        let number = 1 + self.loops * LEGS as u32 + leg as u32;
        let mut random = RandomStream::new(problem.seed(), Purpose::Loop, u64::from(number));
        let seed = random.bits();
        let rows = 0..dimension as u32;
        rows.flat_map(|row| form(seed, row, number, n)).collect()
    }

    fn track(
        &self,
        problem: &Problem,
        deflations: &mut Deflations,
        points: &[Vec<Complex64>],
    ) -> Job {
        let homotopy = HomotopyKind::Parameter {
            start: self.corner(problem, self.leg),
            targets: vec![self.corner(problem, self.leg + 1)],
        };
        let system = deflations.of_stage(problem, &self.set.tracked());
        let system = (self.set.tracked(), &*system);
        // Another loop does as well, unless all of them are hard.
        let with = match self.loops % 2 {
            0 => problem.tracking.soon_given_up(),
            _ => problem.tracking.clone(),
        };
        Job::track(system, homotopy, points, &with).ends_only()
    }

    fn give_up_loop(&mut self) {
        self.loops += 1;
        self.leg = 0;
        match self.search.is_on() {
            true => self.search.found_nothing(),
            false => {
                self.broken += 1;
                self.idle += 1;
            }
        }
    }

    /// Takes the points to which a loop led and that no path came to; the stage that asks how they move.
    fn take_lost(
        &mut self,
        (problem, deflations): (&Problem, &mut Deflations),
        ends: &[Vec<Complex64>],
    ) -> Option<Job> {
        self.loops += 1;
        self.leg = 0;
        let point_indices: Vec<usize> = (0..self.set.points.len()).collect();
        let places = self.places(&point_indices, ends, problem.variables());
        let lost = (self.search).lost_points((problem, deflations), &self.set, ends, &places);
        let first = self.set.points.len();
        self.set.points.extend(lost);
        let new_points = first..self.set.points.len();
        if !new_points.is_empty() {
            // Where the symmetry group takes the new ones has not been asked.
            self.symmetry = PointImages::default();
        }
        self.classes.extend(new_points.clone().map(Class::of));
        (!new_points.is_empty()).then(|| self.ask_bends(problem))
    }

    /// Joins the classes between which the loop leads, where it is a permutation; of points that stand for their
    /// orbits, where no two come together.
    fn close_loop(&mut self, ends: &[Vec<Complex64>], variable_count: usize) {
        let images = match self.symmetry.are_known() {
            true => self.different_images(ends, variable_count),
            false => self.images(ends, variable_count),
        };
        let Some(images) = images else {
            return self.give_up_loop();
        };
        self.loops += 1;
        self.leg = 0;
        let before = self.classes.len();
        let pairs = self.travellers.iter().zip(images);
        let moved = pairs.filter(|(from, to)| **from != *to);
        let edge: Vec<[usize; 2]> = moved.map(|(&from, to)| [from, to]).collect();
        let joined = self.symmetry.with_images(edge.clone(), None);
        join(&mut self.classes, &joined);
        self.edges.push(edge);
        match self.classes.len() < before {
            true => self.idle = 0,
            false => self.idle += 1,
        }
    }

    /// The witness point to which each path came back; `None` where they are no permutation.
    fn images(&self, ends: &[Vec<Complex64>], variable_count: usize) -> Option<Vec<usize>> {
        let places = self
            .places(&self.travellers, ends, variable_count)
            .into_iter();
        let images: Vec<usize> = places.collect::<Option<_>>()?;
        let mut sorted = images.clone();
        sorted.sort_unstable();
        (sorted == self.travellers).then_some(images)
    }

    /// Number of the open witness point to which each path came; `None` if a path came to none, or two paths to one.
    fn different_images(
        &self,
        ends: &[Vec<Complex64>],
        variable_count: usize,
    ) -> Option<Vec<usize>> {
        let open: Vec<usize> = self.open_points().collect();
        let places = self.places(&open, ends, variable_count).into_iter();
        let images: Vec<usize> = places.collect::<Option<_>>()?;
        let different: BTreeSet<usize> = images.iter().copied().collect();
        (different.len() == images.len()).then_some(images)
    }

    /// Number of the witness point, of these, at each end; `None`: at none of them.
    fn places(
        &self,
        among: &[usize],
        ends: &[Vec<Complex64>],
        variable_count: usize,
    ) -> Vec<Option<usize>> {
        let point = |k: usize| {
            self.set.points[k].point[..variable_count]
                .iter()
                .map(rounded)
        };
        // No two points are nearer than their values of a form of length 1.
        let mut random = RandomStream::new(0, Purpose::Probe, 4);
        let weight = 1.0 / (variable_count as f64).sqrt();
        let form: Vec<Complex64> = (0..variable_count)
            .map(|_| random.unit() * weight)
            .collect();
        let value = |x: &mut dyn Iterator<Item = Complex64>| -> f64 {
            x.zip(&form).map(|(x, c)| (x * c).re).sum()
        };
        let among = among.iter();
        let mut order: Vec<(f64, usize)> = among.map(|&k| (value(&mut point(k)), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let place = |end: &Vec<Complex64>| {
            let size = 1.0 + end.iter().map(|y| y.norm_sqr()).sum::<f64>();
            let distance = |k: usize| {
                let pairs = point(k).zip(end).map(|(x, &y)| (x, x - y));
                let (size, apart) = pairs.fold((1.0, 0.0), |(size, apart), (x, d)| {
                    (size + x.norm_sqr(), apart + d.norm_sqr())
                });
                apart / size
            };
            let (at, reach) = (value(&mut end.iter().copied()), 2.0 * BACK * size.sqrt());
            let first = order.partition_point(|(value, _)| *value < at - reach);
            let near = order[first..]
                .iter()
                .take_while(|(value, _)| *value <= at + reach);
            let near = near.map(|&(_, k)| (distance(k), k));
            let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
            (nearest.0 <= BACK * BACK).then_some(nearest.1)
        };
        ends.iter().map(place).collect()
    }

    /// The sum of second derivatives over these points.
    fn trace(&self, points: impl Iterator<Item = usize>) -> Trace {
        let moved = self.bends.as_ref();
        moved.map_or_else(
            || MovedPoints::default().trace(std::iter::empty()),
            |m| m.trace(points),
        )
    }

    /// Whether not even all open points together are closed: no loop brings them together to components.
    fn hopeless(&self) -> bool {
        !is_closed(&self.trace(self.open_points()))
    }

    /// Whether some points are open, and others of their components are missing.
    fn misses_points(&self) -> bool {
        let some = self.open().next().is_some();
        some && misses_points(&self.trace(self.open_points()))
    }

    fn open_points(&self) -> impl Iterator<Item = usize> {
        self.open().flat_map(|class| class.points.iter().copied())
    }

    /// Finds the classes that are components, alone or, where few are left, in unions.
    fn close(&mut self, variable_count: usize) {
        self.take_jumps_back(variable_count);
        for k in 0..self.classes.len() {
            if self.classes[k].closed.is_none()
                && !self.is_untested(&self.classes[k], variable_count)
            {
                let trace = self.trace(self.classes[k].points.iter().copied());
                match is_closed(&trace) {
                    true => self.classes[k].closed = Some(trace),
                    false => self.wrong(&trace),
                }
            }
        }
        while let Some((members, trace)) = self.least_closed_union(variable_count) {
            let mut points = Vec::new();
            for &k in members.iter().rev() {
                points.extend(self.classes.remove(k).points);
            }
            points.sort_unstable();
            let closed = Some(trace);
            self.classes.push(Class { points, closed });
        }
    }

    fn wrong(&mut self, trace: &Trace) {
        let least = self.smallest_wrong.unwrap_or(f64::INFINITY);
        self.smallest_wrong = Some(least.min(trace.deviation));
    }

    /// The closed union of the fewest open classes, by their places, ascending; `None` where there is none or
    /// there are too many classes to try.
    fn least_closed_union(&mut self, variable_count: usize) -> Option<(Vec<usize>, Trace)> {
        let places = 0..self.classes.len();
        let open: Vec<usize> = places
            .filter(|&k| self.classes[k].closed.is_none())
            .filter(|&k| !self.is_untested(&self.classes[k], variable_count))
            .collect();
        if open.len() < 2 || open.len() > MOST_CLASSES {
            return None;
        }
        let mut masks: Vec<u32> = (1..1u32 << open.len())
            .filter(|mask| mask.count_ones() > 1)
            .collect();
        masks.sort_by_key(|mask| (mask.count_ones(), *mask));
        // Sums in doubles leave few unions to be looked at in all digits.
        let rough: Vec<(Vec<Complex64>, f64)> = open
            .iter()
            .map(|&k| self.rough(&self.classes[k].points))
            .collect();
        for mask in masks {
            let chosen = (0..open.len()).filter(|k| mask >> k & 1 == 1);
            let mut sum = vec![Complex64::default(); variable_count];
            let mut lengths = 0.0;
            for k in chosen.clone() {
                lengths += rough[k].1;
                for (sum, t) in sum.iter_mut().zip(&rough[k].0) {
                    *sum += t;
                }
            }
            let deviation = length(&sum) / lengths;
            if deviation > 1e-10 {
                let least = self.smallest_wrong.unwrap_or(f64::INFINITY);
                self.smallest_wrong = Some(least.min(deviation));
                continue;
            }
            let members: Vec<usize> = chosen.map(|k| open[k]).collect();
            let points = members.iter().flat_map(|&k| self.classes[k].points.clone());
            let trace = self.trace(points);
            match is_closed(&trace) {
                true => return Some((members, trace)),
                false => self.wrong(&trace),
            }
        }
        None
    }

    fn rough(&self, points: &[usize]) -> (Vec<Complex64>, f64) {
        let moved = self.bends.as_ref();
        moved.map_or_else(Default::default, |moved| moved.rough(points))
    }
}

/// Ends of all paths of a stage, in their order; `None` if a path did not arrive, or some met.
fn arrivals(job: &Job) -> Option<Vec<Vec<Complex64>>> {
    if job.crossings_left() > 0 {
        return None;
    }
    let mut ends: BTreeMap<u64, Vec<Complex64>> = BTreeMap::new();
    for (result, decision, values) in job.ends() {
        if decision.verdict != Verdict::Finite {
            return None;
        }
        ends.insert(result.origin.0, values);
    }
    Some(ends.into_values().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::bend::{Bend, RefinedPoint, exactly};
    use cognate_solutions::witness::Multiplicity;

    /// Two components of `degree` points each, whose second derivatives sum to 0.
    fn two_components(degree: usize) -> Split {
        let mut random = RandomStream::new(5, Purpose::Test, 1);
        let mut bends = MovedPoints::with_capacity(2 * degree, 1);
        for _ in 0..2 {
            let mut sum = Complex64::default();
            for k in 0..degree {
                // Few bits: the sum is exact.
                let part =
                    |random: &mut RandomStream| random.below(1 << 20) as f64 / 1024.0 - 512.0;
                let z = Complex64::new(part(&mut random), part(&mut random));
                let z = if k + 1 == degree { -sum } else { z };
                sum += z;
                bends.push(Some(&Bend {
                    velocity: vec![exactly(Complex64::new(1.0, 0.0))],
                    acceleration: vec![exactly(z)],
                    error: 1e-28,
                }));
            }
        }
        let point = |k: usize| RefinedPoint {
            point: vec![exactly(Complex64::new(k as f64, 0.0))],
            correction: 0.0,
            moved: 0.0,
            residual: 0.0,
            condition: 1.0,
        };
        let mut split = Split::new(PureSet {
            dimension: 1,
            ranks: Vec::new(),
            multiplicity: Multiplicity {
                scheme: Some(1),
                tracked: 1,
                dual_dimensions: Vec::new(),
            },
            points: (0..2 * degree).map(point).collect(),
        });
        split.bends = Some(bends);
        split.travellers = (0..2 * degree).collect();
        split
    }

    /// A loop after which the point at each place is where it says.
    fn go_around(split: &mut Split, images: &[usize]) {
        let place = |k: &usize| vec![Complex64::new(*k as f64, 0.0)];
        let ends: Vec<Vec<Complex64>> = images.iter().map(place).collect();
        split.close_loop(&ends, 1);
        split.close(1);
    }

    fn closed(split: &Split) -> Vec<Vec<usize>> {
        let closed = split.classes.iter().filter(|c| c.closed.is_some());
        let mut closed: Vec<Vec<usize>> = closed
            .map(|class| {
                let mut points = class.points.clone();
                points.sort_unstable();
                points
            })
            .collect();
        closed.sort();
        closed
    }

    #[test]
    fn a_loop_in_which_two_paths_jumped_is_taken_back() {
        const DEGREE: usize = 40;
        let point_indices: Vec<usize> = (0..2 * DEGREE).collect();
        let components = [
            point_indices[..DEGREE].to_vec(),
            point_indices[DEGREE..].to_vec(),
        ];
        // The points of each component go around among themselves.
        let mut around: Vec<usize> = point_indices.clone();
        around[..DEGREE].rotate_left(1);
        around[DEGREE..].rotate_left(1);
        // Loops in groups of four points, so that there are more classes than unions that can be tried.
        let mut fours: Vec<usize> = point_indices.clone();
        fours.chunks_mut(4).for_each(|four| four.rotate_left(1));
        let mut split = two_components(DEGREE);
        go_around(&mut split, &around);
        // One loop alone has nothing beside it that says that it did not jump.
        assert!(closed(&split).is_empty());
        go_around(&mut split, &around);
        assert_eq!(closed(&split), components);
        // Ends of two paths are exchanged, in the first loop and in the second.
        let jumped = |images: &[usize]| {
            let mut images = images.to_vec();
            images.swap(3, DEGREE + 4);
            images
        };
        let mut split = two_components(DEGREE);
        go_around(&mut split, &jumped(&point_indices));
        go_around(&mut split, &around);
        go_around(&mut split, &around);
        assert_eq!((closed(&split), split.broken), (components.to_vec(), 1));
        let mut split = two_components(DEGREE);
        go_around(&mut split, &fours);
        go_around(&mut split, &jumped(&around));
        // No loop says yet that the second one is wrong: nothing is closed before one does.
        assert!(closed(&split).is_empty());
        go_around(&mut split, &around);
        assert_eq!((closed(&split), split.broken), (components.to_vec(), 1));
    }

    /// Two components that a symmetry exchanges; by one of two ways two of its paths exchanged their ends.
    #[test]
    fn an_image_to_which_a_path_jumped_brings_nothing_together() {
        const DEGREE: usize = 40;
        let exchanged: Vec<usize> = (0..2 * DEGREE)
            .map(|k| (k + DEGREE) % (2 * DEGREE))
            .collect();
        let mut around: Vec<usize> = (0..2 * DEGREE).collect();
        around[..DEGREE].rotate_left(1);
        around[DEGREE..].rotate_left(1);
        let point_indices: Vec<usize> = (0..2 * DEGREE).collect();
        let components = [
            point_indices[..DEGREE].to_vec(),
            point_indices[DEGREE..].to_vec(),
        ];
        for jumps in [false, true] {
            let mut split = two_components(DEGREE);
            for way in 0..WAYS {
                let mut images = exchanged.clone();
                if jumps && way == 1 {
                    images.swap(3, DEGREE + 7);
                }
                split.symmetry.take(Some(images));
            }
            // Points of one component stand for all.
            for _ in 0..3 {
                let open: Vec<usize> = split.open_points().collect();
                split.travellers = split.symmetry.least_of_each(&open);
                let images: Vec<usize> = split.travellers.iter().map(|&k| around[k]).collect();
                go_around(&mut split, &images);
            }
            assert_eq!(closed(&split), components, "jumps: {jumps}");
            assert_eq!(split.symmetry.refused(), u64::from(jumps));
        }
    }

    #[test]
    fn a_loop_that_is_no_permutation_brings_nothing_together() {
        const DEGREE: usize = 20;
        let around = |by: usize| -> Vec<usize> {
            let mut images: Vec<usize> = (0..2 * DEGREE).collect();
            images[..DEGREE].rotate_left(by);
            images[DEGREE..].rotate_left(by);
            images
        };
        let mut split = two_components(DEGREE);
        // Two paths come to one point: one of them has left its way, perhaps to the other component.
        let mut broken = around(1);
        broken[3] = DEGREE + 4;
        go_around(&mut split, &broken);
        assert_eq!((split.classes.len(), split.broken), (2 * DEGREE, 1));
        // A path comes to no witness point.
        let place = |k: &usize| vec![Complex64::new(*k as f64, 0.0)];
        let mut ends: Vec<Vec<Complex64>> = around(1).iter().map(place).collect();
        ends[7][0] += 0.5;
        split.close_loop(&ends, 1);
        assert_eq!((split.classes.len(), split.broken), (2 * DEGREE, 2));
        // Sound loops do what they do without broken ones.
        go_around(&mut split, &around(1));
        go_around(&mut split, &around(3));
        let point_indices: Vec<usize> = (0..2 * DEGREE).collect();
        let expected = [
            point_indices[..DEGREE].to_vec(),
            point_indices[DEGREE..].to_vec(),
        ];
        assert_eq!(closed(&split), expected);
        assert_eq!((split.loops, split.broken), (4, 2));
    }
}

//! The split of a pure set into components: sums of second derivatives say which points are closed, loops which belong
//! together.
//!
//! Stages in order: second derivatives of the witness points along a moving slice; images of the points under each
//! generator of the symmetry group, by which one loop stands for its images; loops of the slice, on which each point
//! comes to a point of the same component, until [`Classes`] says that no more loops help; conjugates of the points,
//! which say what components are self-conjugate. Where points are missing, loops look for them: then second derivatives
//! and images are asked once more.

mod arrivals;
mod missing_points;
mod witness_sets;

use super::classes::Classes;
use super::deflated::{ProblemContext, PureSet};
use super::job::{Job, Tracking};
use super::moved::{is_closed, misses_points};
use super::problem::Problem;
use super::proof::moving_slices;
use super::symmetry::WAYS;
use arrivals::WitnessPoints;
use cognate_continuation::bend::{RefinedPoint, rounded};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_systems::slices::form;
use cognate_numeric::random::{Purpose, RandomStream};
use missing_points::MissingPoints;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Most loops in all.
const MOST_LOOPS: u32 = 200;
/// Most points of a set whose conjugates and images under a symmetry group are followed.
const MOST_IMAGES: usize = 5000;
/// Streams of random numbers from this one on are those of images under a symmetry group.
const IMAGES: u64 = 1 << 40;
/// Stages of a loop: to two other slices and back.
const LEGS: usize = 3;

/// Split of one set into components.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Split {
    /// The set as it was given, with the points that loops found.
    set: PureSet,
    classes: Classes,
    state: State,
    /// Number of loops that were tracked, to the end or not.
    loops: u32,
    /// Number of loops for joining classes since the last that joined some.
    idle_loops: u32,
    /// Number of loops for joining classes whose paths came to no permutation of the points.
    broken_loops: u64,
    missing_points: MissingPoints,
    /// The witness point where the conjugate of each is after its slice has moved back; `None` where that was not
    /// asked or is not clear.
    conjugates: Option<Vec<usize>>,
}

/// State of a split: the stage that is under way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum State {
    /// No stage has been asked for.
    Start,
    /// Second derivatives of the points of which they are not known.
    SecondDerivatives,
    /// Images of all points under the next generator of the symmetry group move to the slices of the set.
    SymmetryImage,
    /// Points move around a loop of the slice.
    Loop(SliceLoop),
    /// Conjugates of all points move to the slices of the set.
    Conjugates,
    /// Nothing is left to ask.
    #[default]
    Done,
}

/// A loop of the slice that is under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SliceLoop {
    purpose: LoopPurpose,
    /// The part of the loop that is under way, from 0.
    leg: usize,
    /// Numbers of the witness points where the paths began, ascending.
    tracked_points: Vec<usize>,
}

/// Purpose of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum LoopPurpose {
    /// Classes are joined.
    JoinClasses,
    /// Points that no path came to are looked for.
    FindMissingPoints,
}

/// Image of a set: of its slices and of its witness points.
struct SetImage {
    /// Coefficients of the slices, one slice after the other.
    slices: Vec<Complex64>,
    points: Vec<Vec<Complex64>>,
}

impl Split {
    pub fn new(set: PureSet) -> Self {
        Self {
            classes: Classes::of_single_points(set.points.len()),
            set,
            state: State::Start,
            loops: 0,
            idle_loops: 0,
            broken_loops: 0,
            missing_points: MissingPoints::default(),
            conjugates: None,
        }
    }

    /// Learns from the stage that is done, and says which comes next; `None` when the split is done.
    pub fn advance(&mut self, context: &mut ProblemContext<'_>, done: Option<Job>) -> Option<Job> {
        let problem = context.problem;
        match (std::mem::take(&mut self.state), done) {
            (State::Start, _) if self.set.dimension == 0 => {
                self.map_isolated_points(problem);
                None
            }
            (State::Start, _) => Some(self.ask_second_derivatives(problem)),
            (State::SecondDerivatives, Some(job)) => {
                let second_derivatives = job.into_moved();
                let second_derivatives = second_derivatives.expect("the stage asked for them");
                self.classes.add_second_derivatives(second_derivatives);
                self.next_stage(context)
            }
            (State::SymmetryImage, Some(job)) => {
                let ends = arrivals::ends(&job);
                let images = ends.and_then(|ends| self.permutation(problem, &ends));
                self.classes.symmetry.take(images);
                self.next_stage(context)
            }
            (State::Loop(slice_loop), Some(job)) => self.after_leg(context, slice_loop, &job),
            (State::Conjugates, Some(job)) => {
                let ends = arrivals::ends(&job);
                self.conjugates = ends.and_then(|ends| self.permutation(problem, &ends));
                None
            }
            (State::Done, _) => None,
            (state, None) => unreachable!("a stage of {state:?} is under way"),
        }
    }

    /// The next stage when none is under way.
    fn next_stage(&mut self, context: &mut ProblemContext<'_>) -> Option<Job> {
        let problem = context.problem;
        if let Some(image) = self.symmetry_image(problem) {
            self.state = State::SymmetryImage;
            return Some(self.move_back(context, image, &problem.tracking));
        }
        if let Some(purpose) = self.next_loop(problem) {
            return Some(self.begin_loop(context, purpose));
        }
        let image = self.conjugate_image(problem)?;
        self.state = State::Conjugates;
        Some(self.move_back(context, image, &problem.tracking.soon_given_up()))
    }

    /// Finds the images of points of dimension 0, which need no paths: each is a component by itself.
    fn map_isolated_points(&mut self, problem: &Problem) {
        let image = self.conjugate_image(problem);
        self.conjugates = image.and_then(|image| self.permutation(problem, &image.points));
        while let Some(image) = self.symmetry_image(problem) {
            let images = self.permutation(problem, &image.points);
            self.classes.symmetry.take(images);
        }
    }

    /// The stage that asks how points whose second derivatives are not known move when the slices do.
    fn ask_second_derivatives(&mut self, problem: &Problem) -> Job {
        self.state = State::SecondDerivatives;
        Job::bend_for_sums(
            self.set.whole(),
            moving_slices(problem, self.set.dimension),
            self.set.stored_from(self.classes.second_derivative_count()),
            problem.variables(),
            &problem.tracking,
        )
    }

    /// Whether images of the set are followed: it is not deflated, and has few points.
    fn has_images(&self) -> bool {
        self.set.ranks.is_empty() && self.set.points.len() <= MOST_IMAGES
    }

    /// The image of the set under the next generator of the symmetry group; `None` where there is none. A multiple of
    /// a slice is the same slice, and begins another way.
    fn symmetry_image(&self, problem: &Problem) -> Option<SetImage> {
        let (generator, way) = self.classes.symmetry.next();
        let map = problem.symmetry.get(generator)?;
        if !self.has_images() {
            return None;
        }
        let number = (generator * WAYS + way) as u64;
        let mut random = RandomStream::new(problem.seed(), Purpose::Loop, IMAGES + number);
        let mut slices = Vec::new();
        for row in &problem.slices(self.set.dimension) {
            let factor = random.unit();
            slices.extend(map.slice(row).into_iter().map(|c| c * factor));
        }
        let points = self.set.doubles();
        let points = points.iter().map(|point| map.image(point)).collect();
        Some(SetImage { slices, points })
    }

    /// The conjugate of the set; `None` where conjugation means nothing.
    fn conjugate_image(&self, problem: &Problem) -> Option<SetImage> {
        let involution = problem.involution.as_ref()?;
        if !self.has_images() {
            return None;
        }
        let mut slices = Vec::new();
        for row in &problem.slices(self.set.dimension) {
            slices.push(row[0].conj());
            slices.extend(involution.image(&row[1..]));
        }
        let points = self.set.doubles();
        let points = points.iter().map(|point| involution.image(point)).collect();
        Some(SetImage { slices, points })
    }

    /// The stage that moves the image of the set back to the slices of the set.
    fn move_back(
        &self,
        context: &mut ProblemContext<'_>,
        image: SetImage,
        tracking: &Tracking,
    ) -> Job {
        let homotopy = HomotopyKind::Parameter {
            start: image.slices,
            targets: vec![context.problem.slices(self.set.dimension).concat()],
        };
        let system = context.described(self.set.tracked());
        Job::track(system, homotopy, &image.points, tracking).ends_only()
    }

    /// The witness point at each end of paths from all points; `None` where they are no permutation.
    fn permutation(&self, problem: &Problem, ends: &[Vec<Complex64>]) -> Option<Vec<usize>> {
        self.witness_points(problem, 0..self.set.points.len())
            .distinct_at(ends)
    }

    fn witness_points(
        &self,
        problem: &Problem,
        among: impl IntoIterator<Item = usize>,
    ) -> WitnessPoints<'_> {
        WitnessPoints::new(&self.set.points, among, problem.variables())
    }

    /// Purpose of the next loop; `None` where no loop helps.
    fn next_loop(&mut self, problem: &Problem) -> Option<LoopPurpose> {
        if !problem.split {
            return None;
        }
        self.classes.close();
        if self.loops >= MOST_LOOPS {
            return None;
        }
        let trace = self.classes.open_trace();
        if is_closed(&trace) {
            let joins = self.idle_loops < problem.idle_loops && self.classes.may_be_joined();
            joins.then_some(LoopPurpose::JoinClasses)
        } else {
            let searches = misses_points(&trace) && self.missing_points.may_be_found();
            searches.then_some(LoopPurpose::FindMissingPoints)
        }
    }

    fn begin_loop(&mut self, context: &mut ProblemContext<'_>, purpose: LoopPurpose) -> Job {
        let mut tracked_points = self.classes.open_points();
        let symmetry = &self.classes.symmetry;
        if symmetry.are_known() && purpose == LoopPurpose::JoinClasses {
            // Loops of the other points are images of the loops of these.
            tracked_points = symmetry.least_of_each(&tracked_points);
        }
        let double = |&k: &usize| self.set.points[k].point.iter().map(rounded).collect();
        let points: Vec<Vec<Complex64>> = tracked_points.iter().map(double).collect();
        let slice_loop = SliceLoop {
            purpose,
            leg: 0,
            tracked_points,
        };
        self.track_leg(context, slice_loop, &points)
    }

    /// The stage that tracks these points along a leg of a loop.
    fn track_leg(
        &mut self,
        context: &mut ProblemContext<'_>,
        slice_loop: SliceLoop,
        points: &[Vec<Complex64>],
    ) -> Job {
        let problem = context.problem;
        let homotopy = HomotopyKind::Parameter {
            start: self.corner(problem, slice_loop.leg),
            targets: vec![self.corner(problem, slice_loop.leg + 1)],
        };
        self.state = State::Loop(slice_loop);
        // Another loop does as well, unless all of them are hard.
        let tracking = if self.loops.is_multiple_of(2) {
            problem.tracking.soon_given_up()
        } else {
            problem.tracking.clone()
        };
        let system = context.described(self.set.tracked());
        Job::track(system, homotopy, points, &tracking).ends_only()
    }

    /// Coefficients of all slices where a leg of the next loop begins or ends.
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

    /// The stage after a leg of a loop.
    fn after_leg(
        &mut self,
        context: &mut ProblemContext<'_>,
        mut slice_loop: SliceLoop,
        job: &Job,
    ) -> Option<Job> {
        let ends = arrivals::ends(job);
        slice_loop.leg += 1;
        if let (Some(points), true) = (&ends, slice_loop.leg < LEGS) {
            return Some(self.track_leg(context, slice_loop, points));
        }
        self.loops += 1;
        match slice_loop.purpose {
            LoopPurpose::JoinClasses => {
                let open_points = self.classes.open_points();
                let witness_points = self.witness_points(context.problem, open_points);
                let images = ends.and_then(|ends| witness_points.distinct_at(&ends));
                self.join_classes(&slice_loop.tracked_points, images);
            }
            LoopPurpose::FindMissingPoints => {
                let new_points = ends.map(|ends| self.new_points(context, &ends));
                if self.take_points(new_points.unwrap_or_default()) {
                    return Some(self.ask_second_derivatives(context.problem));
                }
            }
        }
        self.next_stage(context)
    }

    /// Joins the classes between which a loop leads; `images`: the witness point to which each path came, `None` where
    /// the loop is broken.
    fn join_classes(&mut self, tracked_points: &[usize], images: Option<Vec<usize>>) {
        let joined = match images {
            Some(images) => self.classes.join_by_loop(tracked_points, &images),
            None => {
                self.broken_loops += 1;
                false
            }
        };
        self.idle_loops = if joined { 0 } else { self.idle_loops + 1 };
    }

    /// The points to which a loop led and that no path came to.
    fn new_points(
        &self,
        context: &mut ProblemContext<'_>,
        ends: &[Vec<Complex64>],
    ) -> Vec<RefinedPoint> {
        let witness_points = self.witness_points(context.problem, 0..self.set.points.len());
        let places: Vec<Option<usize>> = ends.iter().map(|end| witness_points.at(end)).collect();
        missing_points::new_points(context, &self.set, ends, &places)
    }

    /// Takes the points that a loop found. Whether there are some.
    fn take_points(&mut self, new_points: Vec<RefinedPoint>) -> bool {
        self.missing_points.count_loop(new_points.len());
        if new_points.is_empty() {
            return false;
        }
        let first = self.set.points.len();
        self.set.points.extend(new_points);
        self.classes.add_points(first..self.set.points.len());
        true
    }
}

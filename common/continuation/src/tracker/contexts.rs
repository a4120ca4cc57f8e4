//! Tracking contexts: a chart and an arithmetic each, and how paths are handed from one to another.
//!
//! Paths begin in the first context, in lanes of doubles. One that runs far out of
//! the affine chart goes on in projective patches; one that lacks digits goes
//! up a rung of the ladder (double -> double-double -> MPFR with twice the bits
//! each time), and down again when it has passed the difficult place. What a
//! path does is a function of the path alone, whichever paths are tracked with it.

use super::digits::Digits;
use super::lane::Lane;
use super::lockstep::Lockstep;
use super::observer::Observer;
use super::settings::Settings;
use crate::homotopies::Homotopy;
use crate::path_result::PathResult;
use crate::stage::PreparedStage;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{
    CompiledSet, InstructionSet, Job, JobOfSet, dispatch_on, dispatch_set, dispatch_single,
};
use cognate_numeric::lanes::double_doubles::DoubleDoubleLanes;
use cognate_numeric::precision::{DOUBLE, DOUBLE_DOUBLE, rungs};
use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision, Real};
use num_complex::Complex64;
use std::collections::VecDeque;
use std::marker::PhantomData;
use std::ops::Range;

/// Where a path that leaves its tracking context goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Handoff {
    /// In projective patches, with as many digits.
    Projective,
    /// On the next rung of the ladder of precision.
    Up,
    /// On the rung below.
    Down,
}

/// A path on its way from one tracking context to another.
#[derive(Clone, Debug)]
pub(super) struct HandedOffPath {
    pub lane: Lane,
    pub t: Complex64,
    /// In the chart of the context where it goes; `None` where that chart misses it.
    pub point: Option<Vec<Digits>>,
    pub exchanges: f64,
    pub handoff: Handoff,
}

/// Paths of one tracking context that wait for a lane.
pub(super) struct Queue {
    /// Items of the stage, whose paths begin at their start points.
    pub items: Range<u64>,
    /// Paths that other contexts handed over.
    pub handed_off: VecDeque<HandedOffPath>,
}

impl Queue {
    /// Number of paths that wait.
    fn count(&self) -> u64 {
        self.items.end - self.items.start + self.handed_off.len() as u64
    }
}

/// How the paths of a tracking context ended there.
#[derive(Default)]
pub(super) struct Ended {
    /// Results with the items whose paths they are of.
    pub results: Vec<(u64, PathResult)>,
    pub handed_off: Vec<HandedOffPath>,
}

/// Shortest step on the higher rungs, as a part of the way that is left: t is a double there too.
const LEAST_STEP: f64 = 1e-15;

/// A chart and an arithmetic, and where paths may be handed to from there.
#[derive(Clone, Copy)]
pub(super) struct TrackingContext<'a> {
    pub stage: &'a PreparedStage,
    pub homotopy: &'a Homotopy,
    /// Bits of the arithmetic.
    pub bits: u32,
    /// Whether a path may go on in projective patches.
    pub projective: bool,
    /// Whether a path may go on on the next rung.
    pub up: bool,
    /// Whether a path may go on on the rung below.
    pub down: bool,
}

impl TrackingContext<'_> {
    /// The stage's settings as they are meant for this arithmetic: the endgame may go as much
    /// further in as there are more digits, and steps may be as short as doubles can tell values of
    /// t apart.
    pub fn settings(&self) -> Settings {
        let mut settings = self.stage.settings().clone();
        if self.bits > DOUBLE {
            settings.min_step = settings.min_step.min(LEAST_STEP);
        }
        let least = settings.endgame_min_radius;
        for _ in 1..(self.bits / DOUBLE).min(4) {
            settings.endgame_min_radius *= least;
        }
        settings
    }
}

/// The work of one tracking context, in lanes of one scalar type.
struct Work<'a, R: Real> {
    tracking: TrackingContext<'a>,
    context: R::Context,
    queue: Queue,
    observer: Option<&'a mut dyn Observer>,
    scalar: PhantomData<R>,
}

impl<'a, R: Real> Work<'a, R> {
    fn new(
        tracking: TrackingContext<'a>,
        context: R::Context,
        queue: Queue,
        observer: Option<&'a mut dyn Observer>,
    ) -> Self {
        Self {
            tracking,
            context,
            queue,
            observer,
            scalar: PhantomData,
        }
    }
}

impl<R: Real> Job for Work<'_, R> {
    type Output = Ended;
    #[inline(always)]
    fn run(self) -> Ended {
        Lockstep::<R>::new(self.tracking, self.context, self.queue, self.observer).run()
    }
}

/// Paths in lanes of double-doubles.
struct DoubleDoublePaths<'a> {
    tracking: TrackingContext<'a>,
    queue: Queue,
    observer: Option<&'a mut dyn Observer>,
}

impl JobOfSet for DoubleDoublePaths<'_> {
    type Output = Ended;
    #[inline(always)]
    fn run<S: CompiledSet>(self) -> Ended {
        Work::<DoubleDoubleLanes<S>>::new(self.tracking, (), self.queue, self.observer).run()
    }
}

/// Tracks the paths that wait for this context, `width` paths at a time where it has lanes.
fn work<'a>(
    tracking: TrackingContext<'a>,
    set: InstructionSet,
    width: usize,
    queue: Queue,
    observer: Option<&'a mut dyn Observer>,
) -> Ended {
    match (tracking.bits, width) {
        (DOUBLE, 1) => dispatch_single(Work::<f64>::new(tracking, (), queue, observer)),
        (DOUBLE, 8) => dispatch_on(set, Work::<Lanes<8>>::new(tracking, (), queue, observer)),
        (DOUBLE, 16) => dispatch_on(set, Work::<Lanes<16>>::new(tracking, (), queue, observer)),
        (DOUBLE_DOUBLE, 8 | 16) if queue.count() > 1 => {
            let paths = DoubleDoublePaths {
                tracking,
                queue,
                observer,
            };
            dispatch_set(set, paths)
        }
        (DOUBLE_DOUBLE, 1 | 8 | 16) => dispatch_single(Work::<DoubleDouble<f64>>::new(
            tracking,
            (),
            queue,
            observer,
        )),
        // Numbers of MPFR use no vector instructions.
        (bits, 1 | 8 | 16) => Work::<MultiplePrecision>::new(tracking, bits, queue, observer).run(),
        _ => panic!("there are lanes of width 1, 8 and 16, not {width}"),
    }
}

/// Tracks the paths of `items` through all contexts; results in item order.
pub(crate) fn track(
    stage: &PreparedStage,
    set: InstructionSet,
    items: Range<u64>,
    width: usize,
    mut observer: Option<&mut dyn Observer>,
) -> Vec<PathResult> {
    let settings = stage.settings();
    let rungs: Vec<u32> = rungs(settings.precision_bits, settings.max_precision_bits).collect();
    let count = usize::try_from(items.end - items.start).expect("a chunk fits in memory");
    let mut results: Vec<Option<PathResult>> = vec![None; count];
    let mut queues: Vec<VecDeque<HandedOffPath>> = vec![VecDeque::new(); rungs.len()];
    let mut take = |ended: Ended, rung: usize, queues: &mut Vec<VecDeque<HandedOffPath>>| {
        for (item, result) in ended.results {
            let at = usize::try_from(item - items.start).expect("a chunk fits in memory");
            debug_assert!(results[at].is_none(), "an item ends once");
            results[at] = Some(result);
        }
        for path in ended.handed_off {
            let to = match path.handoff {
                Handoff::Projective => rung,
                Handoff::Up => rung + 1,
                Handoff::Down => rung - 1,
            };
            queues[to].push_back(path);
        }
    };
    let projective = stage.has_projective_homotopy();
    let first = TrackingContext {
        stage,
        homotopy: stage.homotopy(),
        bits: rungs[0],
        projective,
        up: !projective && rungs.len() > 1,
        down: false,
    };
    let all = Queue {
        items: items.clone(),
        handed_off: VecDeque::new(),
    };
    let watching = observer.as_mut().map(|o| &mut **o as &mut dyn Observer);
    take(work(first, set, width, all, watching), 0, &mut queues);
    while let Some(rung) = queues.iter().position(|paths| !paths.is_empty()) {
        let tracking = TrackingContext {
            stage,
            homotopy: stage.projective_homotopy().unwrap_or(stage.homotopy()),
            bits: rungs[rung],
            projective: false,
            up: rung + 1 < rungs.len(),
            down: rung > 0,
        };
        let arrived = Queue {
            items: 0..0,
            handed_off: std::mem::take(&mut queues[rung]),
        };
        let watching = observer.as_mut().map(|o| &mut **o as &mut dyn Observer);
        take(
            work(tracking, set, width, arrived, watching),
            rung,
            &mut queues,
        );
    }
    results
        .into_iter()
        .map(|result| result.expect("every item ends with exactly one result"))
        .collect()
}

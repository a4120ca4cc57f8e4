//! The paths of a stage, tracked through all contexts that they need.
//!
//! Paths begin in the first context, in lanes of doubles. One that runs far out of
//! the affine chart goes on in projective patches; one that lacks digits goes
//! up a rung of the ladder (double -> double-double -> MPFR with twice the bits
//! each time), and down again when it has passed the difficult place. What a
//! path does is a function of the path alone, whichever paths are tracked with it.

use super::lockstep::Lockstep;
use super::observer::{Observer, Recorder, StepEvent};
use super::tracking_context::{Ended, HandedOffPath, Handoff, Queue, TrackingContext};
use crate::path_result::PathResult;
use crate::stage::PreparedStage;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::called::DoubleDoubleLanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch_baseline, limited_to};
use cognate_numeric::precision::{DOUBLE, DOUBLE_DOUBLE, rungs};
use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision, Real};
use std::collections::VecDeque;
use std::marker::PhantomData;
use std::ops::Range;

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

/// The fewest lanes that the tracker is compiled for; one path alone leaves the others idle.
const NARROWEST: usize = 8;

/// Tracks the paths that wait for this context, `width` paths at a time where it has lanes.
fn work<'a>(
    tracking: TrackingContext<'a>,
    width: usize,
    queue: Queue,
    observer: Option<&'a mut dyn Observer>,
) -> Ended {
    match (tracking.bits, width) {
        (DOUBLE, 8) => dispatch_baseline(Work::<Lanes<8>>::new(tracking, (), queue, observer)),
        (DOUBLE, 16) => dispatch_baseline(Work::<Lanes<16>>::new(tracking, (), queue, observer)),
        (DOUBLE_DOUBLE, 8 | 16) if queue.count() > 1 => dispatch_baseline(
            Work::<DoubleDoubleLanes>::new(tracking, (), queue, observer),
        ),
        (DOUBLE_DOUBLE, 8 | 16) => dispatch_baseline(Work::<DoubleDouble<f64>>::new(
            tracking,
            (),
            queue,
            observer,
        )),
        // Numbers of MPFR use no vector instructions.
        (bits, 8 | 16) => Work::<MultiplePrecision>::new(tracking, bits, queue, observer).run(),
        _ => panic!("there are widths of 1, 8 and 16, not {width}"),
    }
}

impl PreparedStage {
    /// Tracks the paths of these items, `width` (1, 8 or 16) at a time; results in item order.
    ///
    /// Pure: the same items give the same bits at every width, in every range, on every machine
    /// with fused multiply-add.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage or `width` is none of the three.
    pub fn track(&self, items: Range<u64>, width: usize) -> Vec<PathResult> {
        assert!(items.end <= self.items(), "a chunk lies within its stage");
        let first = items.start;
        let mut results = match width {
            1 => items
                .flat_map(|item| track(self, item..item + 1, NARROWEST, None))
                .collect(),
            _ => track(self, items, width, None),
        };
        self.refine_ends(first, &mut results);
        self.hold_against_asked(first, &mut results);
        results
    }

    /// [`Self::track`] with one instruction set, for tests that compare them.
    pub fn track_on(
        &self,
        set: InstructionSet,
        items: Range<u64>,
        width: usize,
    ) -> Vec<PathResult> {
        limited_to(set, || self.track(items, width))
    }

    /// Tracks one path again and keeps every step.
    pub fn trace(&self, item: u64) -> (PathResult, Vec<StepEvent>) {
        assert!(item < self.items(), "the item lies within the stage");
        let mut recorder = Recorder::default();
        let mut results = track(self, item..item + 1, NARROWEST, Some(&mut recorder));
        self.refine_ends(item, &mut results);
        self.hold_against_asked(item, &mut results);
        (results.remove(0), recorder.0)
    }
}

/// Tracks the paths of `items` through all contexts; results in item order.
fn track(
    stage: &PreparedStage,
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
    let queue = Queue {
        items: items.clone(),
        handed_off: VecDeque::new(),
    };
    let watching = observer.as_mut().map(|o| &mut **o as &mut dyn Observer);
    take(work(first, width, queue, watching), 0, &mut queues);
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
        take(work(tracking, width, arrived, watching), rung, &mut queues);
    }
    results
        .into_iter()
        .map(|result| result.expect("every item ends with exactly one result"))
        .collect()
}

//! Rooms: a chart and an arithmetic each, and the doors between them.
//!
//! Paths begin in the first room, in lanes of doubles. One that runs far out of
//! the affine chart goes on in projective patches; one that lacks digits goes
//! up a rung of the ladder (double -> double-double -> MPFR with twice the bits
//! each time), and down again when it has passed the difficult place. What a
//! path does is a function of the path alone, whoever shares its rooms.

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

/// Where a path goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Door {
    /// In projective patches, with as many digits.
    Beyond,
    /// On the next rung.
    Up,
    /// On the rung below.
    Down,
}

/// A path on its way from one room to another.
#[derive(Clone, Debug)]
pub(super) struct Departure {
    pub lane: Lane,
    pub t: Complex64,
    /// In the chart of the room where it goes; `None` where that chart misses it.
    pub point: Option<Vec<Digits>>,
    pub exchanges: f64,
    pub door: Door,
}

/// Paths that wait for a lane.
pub(super) struct Waiting {
    /// From their start points.
    pub items: Range<u64>,
    /// From where they left another room.
    pub departures: VecDeque<Departure>,
}

impl Waiting {
    /// How many.
    fn count(&self) -> u64 {
        self.items.end - self.items.start + self.departures.len() as u64
    }
}

/// How the paths of a room ended there.
#[derive(Default)]
pub(super) struct Ended {
    /// By item.
    pub results: Vec<(u64, PathResult)>,
    pub departures: Vec<Departure>,
}

/// Shortest step on the higher rungs, as a part of the way that is left: t is a double there too.
const LEAST_STEP: f64 = 1e-15;

/// A chart and an arithmetic, and which doors there are.
#[derive(Clone, Copy)]
pub(super) struct Room<'a> {
    pub stage: &'a PreparedStage,
    pub homotopy: &'a Homotopy,
    /// Bits of the arithmetic.
    pub bits: u32,
    pub beyond: bool,
    pub up: bool,
    pub down: bool,
}

impl Room<'_> {
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

/// One room's work in one arithmetic.
struct Work<'a, R: Real> {
    room: Room<'a>,
    context: R::Context,
    waiting: Waiting,
    observer: Option<&'a mut dyn Observer>,
    scalar: PhantomData<R>,
}

impl<'a, R: Real> Work<'a, R> {
    fn new(
        room: Room<'a>,
        context: R::Context,
        waiting: Waiting,
        observer: Option<&'a mut dyn Observer>,
    ) -> Self {
        Self {
            room,
            context,
            waiting,
            observer,
            scalar: PhantomData,
        }
    }
}

impl<R: Real> Job for Work<'_, R> {
    type Output = Ended;
    #[inline(always)]
    fn run(self) -> Ended {
        Lockstep::<R>::new(self.room, self.context, self.waiting, self.observer).run()
    }
}

/// Paths in lanes of double-doubles.
struct DoubleDoublePaths<'a> {
    room: Room<'a>,
    waiting: Waiting,
    observer: Option<&'a mut dyn Observer>,
}

impl JobOfSet for DoubleDoublePaths<'_> {
    type Output = Ended;
    #[inline(always)]
    fn run<S: CompiledSet>(self) -> Ended {
        Work::<DoubleDoubleLanes<S>>::new(self.room, (), self.waiting, self.observer).run()
    }
}

/// Tracks what waits for this room, `width` paths at a time where it has lanes.
fn work<'a>(
    room: Room<'a>,
    set: InstructionSet,
    width: usize,
    waiting: Waiting,
    observer: Option<&'a mut dyn Observer>,
) -> Ended {
    match (room.bits, width) {
        (DOUBLE, 1) => dispatch_single(Work::<f64>::new(room, (), waiting, observer)),
        (DOUBLE, 8) => dispatch_on(set, Work::<Lanes<8>>::new(room, (), waiting, observer)),
        (DOUBLE, 16) => dispatch_on(set, Work::<Lanes<16>>::new(room, (), waiting, observer)),
        (DOUBLE_DOUBLE, 8 | 16) if waiting.count() > 1 => {
            let paths = DoubleDoublePaths {
                room,
                waiting,
                observer,
            };
            dispatch_set(set, paths)
        }
        (DOUBLE_DOUBLE, 1 | 8 | 16) => {
            dispatch_single(Work::<DoubleDouble<f64>>::new(room, (), waiting, observer))
        }
        // Numbers of MPFR use no vector instructions.
        (bits, 1 | 8 | 16) => Work::<MultiplePrecision>::new(room, bits, waiting, observer).run(),
        _ => panic!("there are lanes of width 1, 8 and 16, not {width}"),
    }
}

/// Tracks the paths of `items` through all rooms; results in item order.
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
    let mut waiting: Vec<VecDeque<Departure>> = vec![VecDeque::new(); rungs.len()];
    let mut take = |ended: Ended, rung: usize, waiting: &mut Vec<VecDeque<Departure>>| {
        for (item, result) in ended.results {
            let at = usize::try_from(item - items.start).expect("a chunk fits in memory");
            debug_assert!(results[at].is_none(), "an item ends once");
            results[at] = Some(result);
        }
        for departure in ended.departures {
            let to = match departure.door {
                Door::Beyond => rung,
                Door::Up => rung + 1,
                Door::Down => rung - 1,
            };
            waiting[to].push_back(departure);
        }
    };
    let beyond = stage.has_beyond();
    let first = Room {
        stage,
        homotopy: stage.homotopy(),
        bits: rungs[0],
        beyond,
        up: !beyond && rungs.len() > 1,
        down: false,
    };
    let all = Waiting {
        items: items.clone(),
        departures: VecDeque::new(),
    };
    let watching = observer.as_mut().map(|o| &mut **o as &mut dyn Observer);
    take(work(first, set, width, all, watching), 0, &mut waiting);
    while let Some(rung) = waiting.iter().position(|paths| !paths.is_empty()) {
        let room = Room {
            stage,
            homotopy: stage.homotopy_beyond().unwrap_or(stage.homotopy()),
            bits: rungs[rung],
            beyond: false,
            up: rung + 1 < rungs.len(),
            down: rung > 0,
        };
        let arrived = Waiting {
            items: 0..0,
            departures: std::mem::take(&mut waiting[rung]),
        };
        let watching = observer.as_mut().map(|o| &mut **o as &mut dyn Observer);
        take(
            work(room, set, width, arrived, watching),
            rung,
            &mut waiting,
        );
    }
    results
        .into_iter()
        .map(|result| result.expect("every item ends with exactly one result"))
        .collect()
}

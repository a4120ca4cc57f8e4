//! A few paths of a start, tracked while a solve is planned: whether most of them are wasted.
//!
//! A start bounds the solutions by degrees or groups. Where only a few of very many paths end at regular
//! solutions, going on equation by equation leaves the others behind early.

use cognate_continuation::stage::PreparedStage;
use cognate_continuation::work::Stage;
use cognate_numeric::interruption::count_work;
use cognate_numeric::precision::DOUBLE;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Tolerances, Verdict, classify};
use cognate_solutions::point_shape::PointShape;
use cognate_systems::system::System;
use std::fmt::{Display, Formatter};

/// Starts with more paths than this are sampled.
const MANY_PATHS: u64 = 1000;
/// Number of paths of a sample.
const SAMPLE: u64 = 32;
/// Most paths of the sample that end at regular solutions, if most paths of the start are wasted.
const FEW: u64 = SAMPLE / 4;
/// Operations of one step of a path, for each two of its coordinates, about.
const OPERATIONS_PER_STEP: u64 = 40;
/// No path of a sample takes more steps: one that does ends at no regular solution, as far as planning is
/// concerned.
const STEPS: u32 = 1000;

/// Counts of the ends of the paths of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SampledEnds {
    /// Number of paths of the start.
    paths: u64,
    /// Paths of the sample that ended at regular solutions.
    regular: u64,
    /// Paths of the sample that ended at singular points that are not at infinity.
    singular: u64,
}

impl SampledEnds {
    /// Samples a stage whose start points are made by the stage itself, if it has very many paths; `None` if many end
    /// at regular solutions.
    pub(crate) fn of_few(system: &System, stage: &Stage, tolerances: &Tolerances) -> Option<Self> {
        let paths = stage.items().filter(|paths| *paths > MANY_PATHS)?;
        let ends = Self::of(system, stage, paths, tolerances)?;
        (ends.regular <= FEW).then_some(ends)
    }

    /// Tracks a sample in doubles; `None` if the stage cannot be prepared, or the work is interrupted. One path is
    /// taken from each of `SAMPLE` equal parts of all paths, at random by the stage's seed.
    fn of(system: &System, stage: &Stage, paths: u64, tolerances: &Tolerances) -> Option<Self> {
        let mut stage = stage.clone();
        stage.settings.max_precision_bits = DOUBLE;
        stage.settings.max_steps = STEPS;
        let coordinates = system.variable_count() as u64;
        let operations = u64::from(STEPS) * OPERATIONS_PER_STEP * coordinates * coordinates;
        if count_work(operations) {
            return None;
        }
        let prepared = PreparedStage::new(system, &stage, &|_| None).ok()?;
        let shape = PointShape::of(system);
        let mut within = RandomStream::new(stage.seed, Purpose::Probe, 2);
        let mut ends = Self {
            paths,
            ..Self::default()
        };
        for part in 0..SAMPLE {
            let (from, to) = (paths * part / SAMPLE, paths * (part + 1) / SAMPLE);
            let item = from + within.below(to - from);
            if count_work(operations) {
                return None;
            }
            for result in prepared.track(item..item + 1, 1) {
                match classify(&result, &shape, tolerances).verdict {
                    Verdict::Finite => ends.regular += 1,
                    verdict if verdict.may_be_multiple() => ends.singular += 1,
                    _ => {}
                }
            }
        }
        Some(ends)
    }

    /// Whether some are known to end where solutions may be missed by a method that leaves singular points behind.
    pub(crate) fn are_singular(self) -> bool {
        self.singular > 0
    }
}

impl Display for SampledEnds {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { paths, regular, .. } = self;
        write!(
            f,
            "{regular} of {SAMPLE} that were tried end at regular solutions of the {paths} paths"
        )
    }
}

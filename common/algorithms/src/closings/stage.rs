//! ClosingStage: after a solve one more stage, which looks at its finite endpoints.

use crate::finite_endpoints::{FiniteEndpoint, FiniteEndpoints};
use crate::opening::Opening;
use crate::progress::{self, Progress, StageProgress};
use crate::solve::{Next, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::work::{Stage, StageId, Work};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::Arc;

/// The stage, and what it found: a fact for each endpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClosingStage<Fact> {
    homotopy: HomotopyKind,
    seed: u64,
    /// The stage once it is open; empty where there was nothing to look at.
    stages: Vec<StageProgress>,
    /// Target and path of each item.
    items: Vec<(u64, u64)>,
    /// Item by item; empty until the stage is absorbed.
    found: Vec<Fact>,
}

impl<Fact> ClosingStage<Fact> {
    /// Opens the stage that does this work at these of the endpoints; nothing where there are none.
    pub fn open(
        endpoints: FiniteEndpoints,
        points: Vec<FiniteEndpoint>,
        work: Work,
        numbers: &mut StageNumbers,
    ) -> (Self, Next) {
        let FiniteEndpoints {
            homotopy,
            seed,
            settings,
            ..
        } = endpoints;
        let mut closing = Self {
            homotopy: homotopy.clone(),
            seed,
            stages: Vec::new(),
            items: points.iter().map(|p| (p.target, p.path)).collect(),
            found: Vec::new(),
        };
        let Some(first) = points.first() else {
            return (closing, Next::Done);
        };
        let dimension = first.values.len();
        let stored = Arc::new(StoredPoints {
            dimension,
            coordinates: points.iter().flat_map(|p| p.values.clone()).collect(),
        });
        let stored_points = stored.as_start();
        let count = points.len() as u64;
        let start_points = if points.iter().all(|p| p.target == 0) && !several(&homotopy) {
            stored_points
        } else {
            // Item i of target t is point i there: its index among all targets and points.
            StartPoints::Selected {
                base: Box::new(stored_points),
                indices: (0..)
                    .zip(&points)
                    .map(|(i, p)| p.target * count + i)
                    .collect(),
            }
        };
        let stage = Stage::new(work, homotopy, start_points, settings, seed);
        let opening = Opening {
            stage,
            system: None,
            objects: vec![stored],
        };
        let next = numbers.open(opening, &mut closing.stages);
        (closing, next)
    }

    /// Next step once the stage is open, or was left out.
    pub fn next(&self) -> Next {
        match self.is_done() {
            true => Next::Done,
            false => Next::Wait,
        }
    }

    /// Takes the results of the stage.
    pub fn absorb(
        &mut self,
        stage: StageId,
        results: &mut dyn Iterator<Item = ItemResult>,
        fact: impl Fn(ItemResult) -> Fact,
    ) {
        progress::absorb(&mut self.stages, stage);
        self.found = results.map(fact).collect();
        assert_eq!(
            self.found.len(),
            self.items.len(),
            "a stage is absorbed as a whole"
        );
    }

    /// Progress of a solve with this closing; `closing` is `None` before the endpoints of the stage are known.
    /// `description` makes the text for this number of endpoints.
    pub fn progress(
        closing: Option<&Self>,
        mut progress: Progress,
        description: impl Fn(u64) -> String,
    ) -> Progress {
        let Some(closing) = closing else {
            progress.done = false;
            return progress;
        };
        for stage in &closing.stages {
            progress.stages.push(*stage);
            progress.done = stage.absorbed;
            if !stage.absorbed {
                progress.description = description(stage.items);
            }
        }
        progress
    }

    /// True when nothing more is to come.
    pub fn is_done(&self) -> bool {
        self.stages.iter().all(|stage| stage.absorbed)
    }

    /// The facts by target and path.
    pub fn facts(&self) -> HashMap<(u64, u64), &Fact> {
        self.items.iter().copied().zip(&self.found).collect()
    }

    /// The homotopy that ends at the parameters of each target.
    pub fn homotopy(&self) -> &HomotopyKind {
        &self.homotopy
    }

    /// The seed of its randomness.
    pub fn seed(&self) -> u64 {
        self.seed
    }
}

/// Whether a homotopy has several targets.
fn several(homotopy: &HomotopyKind) -> bool {
    homotopy.parameter_sets() > 1
}

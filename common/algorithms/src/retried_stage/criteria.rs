//! Criteria: by what the paths of one stage are judged.

use cognate_continuation::path_result::PathResult;
use cognate_continuation::start_systems::exchange::Exchange;
use cognate_continuation::work::Stage;
use cognate_solutions::classification::{Decision, Tolerances, classify};
use cognate_solutions::degenerate::DeclaredSets;
use cognate_solutions::images::with_images;
use cognate_solutions::point_shape::PointShape;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Data that do not change while a stage and its repetitions are tracked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Criteria {
    /// The stage that comes first.
    pub first: Stage,
    /// Layout of the coordinates of the stage's points.
    pub shape: PointShape,
    /// Sets of which a few endpoints are asked whether they are isolated.
    pub declared: DeclaredSets,
    pub tolerances: Tolerances,
    /// The targets' paths follow each other.
    pub paths_per_target: u64,
    /// Paths that belong to this stage and never began: lost in the one before.
    pub lost: u64,
}

impl Criteria {
    /// The verdict on one result by itself.
    pub fn decide(&self, result: &PathResult) -> Decision {
        classify(result, &self.shape, &self.tolerances)
    }

    /// Exchange that takes a path to its image, if paths have images.
    pub fn exchange(&self) -> Option<&Exchange> {
        self.first.start_points.exchange()
    }

    /// Results of one target, with the images of their paths if paths have images.
    pub fn with_images<'a>(&self, results: &'a [PathResult]) -> Cow<'a, [PathResult]> {
        with_images(results, self.paths_per_target, self.exchange(), &self.shape)
    }

    /// The path that is tracked in the place of this one: of an image its path.
    pub fn tracked(&self, path: u64) -> u64 {
        match self.exchange() {
            Some(_) => path % self.paths_per_target,
            None => path,
        }
    }

    /// The target that a path goes to.
    pub fn target_of(&self, path: u64) -> u64 {
        path / self.paths_per_target
    }

    /// Values of the parameters at a target; none where paths end at a system without them.
    pub fn parameters(&self, target: usize) -> Cow<'_, [Complex64]> {
        // The plan has put 0 for a path variable.
        let parameters = self.first.homotopy.end_parameters(target, None);
        parameters.unwrap_or_default()
    }
}

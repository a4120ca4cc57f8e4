//! Chains of two joints in space through given poses, by one job of the service.

use super::{How, real_roots};
use crate::connection::Target;
use crate::error::ClientError;
use crate::output::progress::Progress;
use crate::output::text::counted;
use cognate_kinematics::spatial_dyads::spherical::{SphericalFourBar, linkages};
use cognate_kinematics::spatial_dyads::{Chain, SpatialDyad, SpatialPoses};
use cognate_summary::solve::Summary;

/// Error of a chain, relative to the extent of the poses, above which it is doubted.
const LARGEST_ERROR: f64 = 1e-6;

/// Real chains with what was counted.
pub struct Answer {
    /// The chains, each with whether it is proved.
    pub dyads: Vec<(SpatialDyad, bool)>,
    /// The spherical four-bar linkages, of hinges only.
    pub linkages: Vec<SphericalFourBar>,
    /// Counts and warnings of the solve.
    pub summary: Summary,
    /// Reasons why the answer is not settled, beside those of the solve.
    pub doubts: Vec<String>,
}

/// Finds all chains.
pub async fn spatial_dyads(
    target: &Target,
    poses: &SpatialPoses,
    how: &How,
    progress: &mut Progress,
) -> Result<Answer, ClientError> {
    let (summary, roots) = real_roots(target, poses.system(), vec![], how, progress).await?;
    let mut doubts = vec![];
    let mut dyads = vec![];
    let on_families = summary.paths.positive_dimensional.unwrap_or_default();
    if summary.solutions.positive_dimensional == Some(true) || on_families > 0 {
        doubts.push(format!(
            "whole families of chains pass the poses, which are not listed: {} end on them",
            counted(on_families, "path")
        ));
    }
    for root in roots {
        match poses.dyad(&root.values) {
            Some(dyad) => {
                if dyad.error > LARGEST_ERROR {
                    doubts.push(format!(
                        "chain {} misses the poses by {:.1e} of their extent",
                        dyads.len() + 1,
                        dyad.error
                    ));
                }
                // The lines of cylinder joints follow from their directions without a proof.
                let certified = root.certified && poses.chain() != Chain::Cylinders;
                dyads.push((dyad, certified));
            }
            None => doubts.push("a solution does not determine its chain".into()),
        }
    }
    let chains: Vec<SpatialDyad> = dyads.iter().map(|(dyad, _)| *dyad).collect();
    Ok(Answer {
        linkages: linkages(poses, &chains),
        dyads,
        summary,
        doubts,
    })
}

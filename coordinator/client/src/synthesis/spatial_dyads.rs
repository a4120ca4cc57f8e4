//! Chains of two or three joints in space through given poses, by one job of the service.

use super::{Family, How, real_roots};
use crate::connection::Target;
use crate::error::ClientError;
use crate::output::progress::Progress;
use crate::output::text::counted;
use cognate_kinematics::spatial_dyads::spherical::{SphericalFourBar, linkages};
use cognate_kinematics::spatial_dyads::{Chain, Reading, SpatialDyad, SpatialPoses};
use cognate_protocol::submission::StartKind;
use cognate_solutions::completeness::Completeness;
use cognate_summary::solve::Summary;
use num_complex::Complex64;

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
    /// Number of real points on surfaces that no chain of the kind makes.
    pub on_other_surfaces: u64,
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
    let (mut summary, solutions) = match poses.chain().unknowns() {
        6 => solutions::<6>(target, poses, how, progress).await?,
        _ => solutions::<9>(target, poses, how, progress).await?,
    };
    let chain = poses.chain();
    let general_count = match chain {
        // Each with both signs of a direction.
        Chain::HingeSliderBall => 2 * chain.most(),
        _ => chain.most(),
    };
    if summary.paths.finite >= general_count {
        summary.solutions.complete = Completeness::Yes;
        let reason = format!("general poses have {general_count} solutions");
        summary.solutions.complete_reason = Some(reason);
    }
    let mut on_other_surfaces = 0;
    let mut doubts = vec![];
    let mut dyads = vec![];
    let on_families = summary.paths.positive_dimensional.unwrap_or_default();
    if summary.solutions.positive_dimensional == Some(true) || on_families > 0 {
        doubts.push(format!(
            "whole families of chains pass the poses, which are not listed: {} end on them",
            counted(on_families, "path")
        ));
    }
    if !summary.settled && summary.warnings.is_empty() {
        let reason = summary.solutions.complete_reason.as_deref();
        doubts.push(format!(
            "the solve is not settled{}",
            reason.map_or(String::new(), |reason| format!(": {reason}"))
        ));
    }
    for (values, certified) in solutions {
        match poses.read(&values) {
            Reading::Chain(dyad) => {
                // The lines of cylinder joints follow from their directions without a proof.
                let certified = certified && poses.chain() != Chain::Cylinders;
                dyads.push((dyad, certified));
            }
            Reading::OtherSurface => on_other_surfaces += 1,
            Reading::Repeated => {}
            Reading::Undetermined => doubts.push("a solution does not determine its chain".into()),
        }
    }
    // Short links first.
    let size = |(dyad, _): &(SpatialDyad, bool)| dyad.distance.or(dyad.angle).unwrap_or(0.0);
    dyads.sort_by(|one, other| size(one).total_cmp(&size(other)));
    for (number, (dyad, _)) in (1usize..).zip(&dyads) {
        if dyad.error > LARGEST_ERROR {
            doubts.push(format!(
                "chain {number} misses the poses by {:.1e} of their extent",
                dyad.error
            ));
        }
        let later = (number + 1..).zip(&dyads[number..]);
        for (later, _) in later.filter(|(_, (other, _))| poses.may_be_one(dyad, other)) {
            doubts.push(format!(
                "chains {number} and {later} are one up to rounding: it may be a multiple one"
            ));
        }
    }
    let chains: Vec<SpatialDyad> = dyads.iter().map(|(dyad, _)| *dyad).collect();
    Ok(Answer {
        linkages: linkages(poses, &chains),
        dyads,
        on_other_surfaces,
        summary,
        doubts,
    })
}

/// Real solutions of the system, each with whether it is proved.
async fn solutions<const N: usize>(
    target: &Target,
    poses: &SpatialPoses,
    how: &How,
    progress: &mut Progress,
) -> Result<(Summary, Vec<(Vec<Complex64>, bool)>), ClientError> {
    let family = Family {
        system: poses.system(),
        parameters: vec![],
        start: match poses.chain() {
            // Fifty times as many paths by degrees in the groups.
            Chain::HingeSliderBall => StartKind::Polyhedral,
            _ => StartKind::Multihomogeneous,
        },
    };
    let (summary, roots) = real_roots::<N>(target, family, how, progress).await?;
    let roots = roots.into_iter();
    let roots = roots.map(|root| (root.values.to_vec(), root.certified));
    Ok((summary, roots.collect()))
}

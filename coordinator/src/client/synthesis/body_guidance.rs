//! Body guidance: five poses to dyads, by one job of the service.

use super::{How, finished, preset};
use crate::client::connection::Target;
use crate::client::error::ClientError;
use crate::client::output::progress::Progress;
use crate::client::problem::Prepared;
use crate::results::summary::Summary;
use cognate_kinematics::body_guidance::{Poses, system};
use cognate_protocol::submission::{Options, SettingsChoice, Source, StartKind, Submission};
use num_complex::Complex64;

/// A real dyad: a pivot, and a joint of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dyad {
    /// Pivot, and joint in the first pose.
    pub ends: [Complex64; 2],
    /// Proved to be there, alone, and to be real.
    pub certified: bool,
}

/// Finds the dyads: the real ones, and the job's summary.
pub async fn dyads(
    target: &Target,
    poses: &Poses,
    how: &How,
    progress: &mut Progress,
) -> Result<(Vec<Dyad>, Summary), ClientError> {
    let options = Options {
        start: StartKind::Multihomogeneous,
        seed: how.seed,
        settings: SettingsChoice {
            preset: Some(preset(how.preset)),
            ..SettingsChoice::default()
        },
        precision: how.precision,
        target_parameters: vec![poses.parameters()],
        name: how.name.clone(),
        certify: how.certify,
        ..Options::default()
    };
    let prepared = Prepared {
        submission: Submission {
            source: Source::System(Box::new(system())),
            options,
        },
        name: how.name.clone(),
        warnings: vec![],
    };
    let (mut connection, job, summary) = finished(target, prepared, progress).await?;
    let mut dyads = vec![];
    connection
        .solutions(&job, |solution| {
            let values: Vec<Complex64> = solution.variables.0.iter().map(|(_, z)| *z).collect();
            let values: Result<[Complex64; 4], _> = values.try_into();
            let values = values.map_err(|_| {
                ClientError::GaveUp("a solution of it has another number of variables".into())
            })?;
            if solution.real == Some(true) {
                let proof = solution.certificate.as_ref();
                dyads.push(Dyad {
                    ends: poses.dyad(&values),
                    certified: proof.is_some_and(|c| {
                        c.certified && c.distinct == Some(true) && c.real == Some(true)
                    }),
                });
            }
            Ok(true)
        })
        .await?;
    Ok((dyads, summary))
}

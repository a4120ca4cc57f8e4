//! The sisters of the nine-point problem: five poses of a body, three with the crank's angles, five points with the crank's
//! angles, five pairs of angles, poses and points mixed; to designs, by jobs of the service.

use super::{Family, How, Root, Round, real_roots};
use crate::connection::Target;
use crate::error::ClientError;
use crate::output::progress::Progress;
use cognate_kinematics::body_guidance::{self, Poses};
use cognate_kinematics::design::{Design, ranked};
use cognate_kinematics::function_generation::{self, AnglePairs};
use cognate_kinematics::linkage::Side;
use cognate_kinematics::path_timing::{self, TimedPoints};
use cognate_kinematics::poses_and_points::{PosesAndPoints, one_of_each_pair};
use cognate_kinematics::timed_poses::TimedPoses;
use cognate_protocol::submission::StartKind;
use cognate_systems::system::System;
use num_complex::Complex64;

/// The synthesis problem that is asked.
#[derive(Clone, Debug, PartialEq)]
pub enum Sister {
    /// A body in five poses.
    Poses(Poses),
    /// Five points of a path, each at an angle of the crank.
    TimedPoints(TimedPoints),
    /// Two sides at five pairs of angles.
    AnglePairs(AnglePairs),
    /// A body in three poses, each at an angle of the crank, and pivots of the driven link.
    TimedPoses(TimedPoses, Vec<Complex64>),
    /// A body in some poses, and a point of it at some places.
    PosesAndPoints(PosesAndPoints),
}

/// A real dyad: a pivot, and a joint of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dyad {
    /// Pivot, and joint in the first position.
    pub ends: [Complex64; 2],
    /// Proved to be there, alone, and to be real.
    pub certified: bool,
}

/// Linkages that were found, and their counts.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// The real dyads; of timed points the drivers, then the partners of each. None of angles and of
    /// mixtures.
    pub dyads: Vec<Dyad>,
    /// Linkages, best first.
    pub designs: Vec<Design>,
    /// The jobs, one or more.
    pub rounds: Vec<Round>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Finds all designs.
pub async fn designs(
    target: &Target,
    sister: &Sister,
    how: &How,
    progress: &mut Progress,
) -> Result<Found, ClientError> {
    let mut search = Search {
        target,
        how,
        progress,
        rounds: vec![],
    };
    let mut design_answer = match sister {
        Sister::Poses(poses) => search.guides(poses).await?,
        Sister::TimedPoints(points) => search.timed(points).await?,
        Sister::AnglePairs(pairs) => search.functions(pairs).await?,
        Sister::PosesAndPoints(given) => search.mixed(given).await?,
        Sister::TimedPoses(poses, pivots) => timed_poses(poses, pivots),
    };
    design_answer.rounds = search.rounds;
    Ok(design_answer)
}

/// The crank, and a linkage for each pivot of a driven link, from linear equations.
fn timed_poses(poses: &TimedPoses, pivots: &[Complex64]) -> Found {
    let mut answer = Found::default();
    let crank = match poses.crank() {
        Ok(crank) => crank,
        Err(fault) => {
            answer.warnings.push(fault.to_string());
            return answer;
        }
    };
    let dyad = |ends| Dyad {
        ends,
        certified: false,
    };
    answer.dyads.push(dyad(crank));
    for pivot in pivots {
        match poses.driven(*pivot) {
            Ok(driven) => {
                let which = [0, answer.dyads.len()];
                answer.designs.push(poses.linkage(which, [crank, driven]));
                answer.dyads.push(dyad(driven));
            }
            Err(fault) => answer
                .warnings
                .push(format!("pivot {}, {}: {fault}", pivot.re, pivot.im)),
        }
    }
    answer.designs = ranked(answer.designs);
    answer
}

/// A synthesis under way.
struct Search<'a> {
    target: &'a Target,
    how: &'a How,
    progress: &'a mut Progress,
    rounds: Vec<Round>,
}

impl Search<'_> {
    async fn guides(&mut self, poses: &Poses) -> Result<Found, ClientError> {
        let dyads = self.dyads("dyads", poses, self.how.certify).await?;
        let ends: Vec<_> = dyads.iter().map(|dyad| dyad.ends).collect();
        Ok(Found {
            designs: poses.linkages(&ends),
            dyads,
            ..Found::default()
        })
    }

    /// Drivers, then for each the dyads that its coupler's poses have besides.
    async fn timed(&mut self, points: &TimedPoints) -> Result<Found, ClientError> {
        let (system, certify) = (path_timing::system(), self.how.certify);
        let mut roots = self
            .roots("drivers", system, points.parameters(), certify)
            .await?;
        roots.retain(|root| points.is_finite(&root.values));
        let (mut dyads, mut drivers, mut warnings) = (vec![], vec![], vec![]);
        for root in roots {
            match points.driver(&root.values) {
                Ok(driver) => {
                    dyads.push(Dyad {
                        ends: driver.dyad,
                        certified: root.certified,
                    });
                    drivers.push(driver);
                }
                Err(fault) => warnings.push(format!("a driver has no list of partners: {fault}")),
            }
        }
        let mut designs = vec![];
        for (k, driver) in drivers.iter().enumerate() {
            // The drivers' poses are rounded: a proof about them says nothing of the points.
            let partners = self.dyads("partners", &driver.poses, false).await?;
            let partners: Vec<_> = partners.iter().map(|dyad| dyad.ends).collect();
            for ends in driver.partners(&partners) {
                let pair = [k, dyads.len()];
                designs.push(
                    driver
                        .poses
                        .linkage(pair, [driver.dyad, ends], Some(Side::A)),
                );
                dyads.push(Dyad {
                    ends,
                    certified: false,
                });
            }
        }
        Ok(Found {
            dyads,
            designs: ranked(designs),
            warnings,
            ..Found::default()
        })
    }

    async fn functions(&mut self, pairs: &AnglePairs) -> Result<Found, ClientError> {
        let system = function_generation::system();
        let certify = self.how.certify;
        let roots = self
            .roots("linkages", system, pairs.parameters(), certify)
            .await?;
        let designs = roots.iter().filter_map(|root| pairs.linkage(&root.values));
        Ok(Found {
            designs: ranked(designs.collect()),
            ..Found::default()
        })
    }

    async fn mixed(&mut self, given: &PosesAndPoints) -> Result<Found, ClientError> {
        let system = given.mixture().system();
        let certify = self.how.certify;
        let roots = self
            .roots("linkages", system, given.parameters(), certify)
            .await?;
        let solutions: Vec<_> = roots.iter().map(|root| root.values).collect();
        let linkages = one_of_each_pair(&solutions);
        let designs = linkages
            .iter()
            .filter_map(|solution| given.linkage(solution));
        Ok(Found {
            designs: ranked(designs.collect()),
            ..Found::default()
        })
    }

    async fn dyads(
        &mut self,
        purpose: &'static str,
        poses: &Poses,
        certify: bool,
    ) -> Result<Vec<Dyad>, ClientError> {
        let (system, parameters) = (body_guidance::system(), poses.parameters());
        let roots = self.roots(purpose, system, parameters, certify).await?;
        let dyad = |root: Root<4>| Dyad {
            ends: poses.dyad(&root.values),
            certified: root.certified,
        };
        Ok(roots.into_iter().map(dyad).collect())
    }

    /// Runs one job and returns the real solutions.
    async fn roots<const N: usize>(
        &mut self,
        purpose: &'static str,
        system: System,
        parameters: Vec<Complex64>,
        certify: bool,
    ) -> Result<Vec<Root<N>>, ClientError> {
        let how = How {
            certify,
            ..self.how.clone()
        };
        let family = Family {
            system,
            parameters: vec![parameters],
            start: StartKind::Multihomogeneous,
        };
        let solved = real_roots(self.target, family, &how, self.progress);
        let (summary, roots) = solved.await?;
        self.rounds.push(Round { purpose, summary });
        Ok(roots)
    }
}

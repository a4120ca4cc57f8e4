//! Boundary: a key of where a path enters the endgame, by which paths that became one are found.
//!
//! Paths are apart until the end of the way, so two that are at one point at the boundary of the
//! endgame were one before it: one of them has jumped. Regular ends show that by themselves; where
//! many paths end at one point, or at infinity, only this does (Sommese and Wampler, The numerical
//! solution of systems of polynomials, 2005, section 2.3: paths are checked at t = 0.1).

use super::batch::Batch;
use crate::chart::{Chart, norm};
use crate::path_result::{BoundaryKey, NUMBERS};
use crate::projection::Projection;
use crate::start_systems::exchange::Exchange;
use cognate_numeric::scalar::Real;

/// Error between points of a path, as a part of the error of a prediction beyond them: with
/// nodes 0 (twice) and h the largest (s (1 - s))^2 is 1/16, against (1 + s)^2 s^2 = 4 at s = 1; with
/// a step before that is far shorter, s^4 (1 - s)^2 <= 0.022 against 1.
const BETWEEN: f64 = 0.05;

/// Rule by which keys are made; the same for every attempt at a stage.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    projections: [Projection; NUMBERS],
}

impl Boundary {
    /// For points of this chart, or of another of the same groups; with an exchange a point and its
    /// image have one key, since only one of their paths is followed.
    pub fn new(chart: &Chart, exchange: Option<&Exchange>, seed: u64) -> Self {
        /// Indices below belong to others.
        const FIRST: u64 = 16;
        let sizes = || (0..chart.group_count()).map(|group| chart.group_size(group));
        let projection = |k: usize| {
            let projection = Projection::new(sizes(), seed, FIRST + k as u64);
            match exchange {
                Some(exchange) => projection.with_exchange(chart, exchange),
                None => projection,
            }
        };
        Self {
            projections: std::array::from_fn(projection),
        }
    }

    /// The key of a lane's path, which has just come past real `t`; `corrections`: Newton's first and
    /// second where it is now, relative to the largest coordinate. `None` where a group's coordinates
    /// are all 0.
    pub(super) fn key<R: Real>(
        &self,
        batch: &Batch<R>,
        chart: &Chart,
        (lane, t): (usize, f64),
        corrections: [f64; 2],
    ) -> Option<BoundaryKey> {
        let [first, second] = corrections;
        let point = batch.between(lane, t);
        let error = (BETWEEN * first).max(second) * norm(&point);
        let point = chart.homogeneous(&point);
        let forms = &self.projections[0];
        let error = error / forms.least_size(&point);
        let key = BoundaryKey {
            numbers: std::array::from_fn(|k| self.projections[k].value(&point)),
            margin: forms.slope() * error + forms.rounding(),
        };
        Some(key).filter(BoundaryKey::is_sound)
    }
}

#[cfg(test)]
mod tests {
    use crate::homotopies::HomotopyKind;
    use crate::path_result::{BoundaryKey, PathResult};
    use crate::stage::PreparedStage;
    use crate::start_points::StartPoints;
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, StageId, Work};
    use cognate_systems::named::cyclic;

    fn meet(a: &BoundaryKey, b: &BoundaryKey) -> bool {
        let mut numbers = a.numbers.iter().zip(b.numbers);
        numbers.all(|(a_k, b_k)| (a_k - b_k).abs() <= a.margin + b.margin)
    }

    /// By path, those of paths that run to infinity.
    fn keys(settings: Settings, attempt: u16) -> Vec<(u64, BoundaryKey)> {
        let stage = Stage {
            id: StageId(0),
            system: None,
            work: Work::Track,
            homotopy: HomotopyKind::StraightLine {
                parameters: Vec::new(),
            },
            start_points: StartPoints::TotalDegree {
                degrees: vec![1, 2, 3, 4, 5],
            },
            settings,
            seed: 3,
            attempt,
        };
        let prepared = PreparedStage::new(&cyclic(5).system, &stage, &|_| None).unwrap();
        let key = |result: PathResult| Some((result.origin.0, *result.boundary?));
        let keys: Vec<_> = prepared
            .track(0..120, 8)
            .into_iter()
            .filter_map(key)
            .collect();
        assert_eq!(keys.len(), 50, "the others have regular ends");
        keys
    }

    /// Whatever steps a path makes there, in whatever patch and arithmetic: its key is the same to
    /// within the margins, and no other's, infinity or not.
    #[test]
    fn a_path_has_one_key_and_no_other_has_it() {
        let first = keys(Settings::default(), 0);
        let (robust, precise) = (Settings::default().robust(), Settings::default());
        let precise = Settings {
            precision_bits: 106,
            ..precise
        };
        let others = [
            keys(Settings::default().tightened(1), 1),
            keys(robust, 0),
            keys(precise, 2),
        ];
        let widest = first
            .iter()
            .fold(0.0, |widest: f64, (_, key)| widest.max(key.margin));
        assert!(widest < 1e-3, "{widest}");
        for path_keys in &others {
            for (i, a) in &first {
                for (j, b) in path_keys {
                    assert_eq!(meet(a, b), i == j, "{i} {j}: {a:?} {b:?}");
                }
            }
        }
    }
}

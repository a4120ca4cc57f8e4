//! ReachedPoint: what a point is for the output of a mechanism.

use crate::postures::{Postures, Route};

/// Reachability of a point for the output, with the number of postures.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReachedPoint {
    /// Whether the output can be there, whatever the limits; `None` where that is in doubt.
    pub reachable: Option<bool>,
    /// Whether it can be there within all limits; `None` where that is in doubt.
    pub reachable_within_limits: Option<bool>,
    /// Real postures; `None` where they are infinitely many, or in doubt.
    pub postures: Option<u64>,
    /// Real postures within all limits; `None` likewise.
    pub within_limits: Option<u64>,
    /// Postures, complex ones too; `None` where these are not known or infinitely many.
    pub complex: Option<u64>,
    /// Reason for a doubt; `None` if nothing is in doubt.
    pub doubt: Option<String>,
    /// Reason for a doubt about limits alone: an answer that leaves limits aside does not depend on it.
    pub doubt_of_limits: Option<String>,
}

impl ReachedPoint {
    /// Doubts about the point, with those about limits if `with_limits`.
    pub fn doubts(&self, with_limits: bool) -> impl Iterator<Item = &str> {
        let limits = self.doubt_of_limits.as_deref().filter(|_| with_limits);
        self.doubt.as_deref().into_iter().chain(limits)
    }

    /// Whether the output can be there: within all limits where `with_limits`.
    pub fn is_reachable(&self, with_limits: bool) -> Option<bool> {
        match with_limits {
            true => self.reachable_within_limits,
            false => self.reachable,
        }
    }

    /// A point of which nothing is known, for this reason.
    pub fn in_doubt(doubt: String) -> Self {
        Self {
            doubt: Some(doubt),
            ..Self::default()
        }
    }

    /// A point with finitely many postures, of which `within_limits` are within limits.
    pub fn counted(postures: u64, within_limits: u64) -> Self {
        Self {
            reachable: Some(postures > 0),
            reachable_within_limits: Some(within_limits > 0),
            postures: Some(postures),
            within_limits: Some(within_limits),
            ..Self::default()
        }
    }

    /// A point with infinitely many postures; whether some of them are within limits.
    pub fn uncounted(within_limits: bool) -> Self {
        Self {
            reachable: Some(true),
            reachable_within_limits: Some(within_limits),
            within_limits: (!within_limits).then_some(0),
            ..Self::default()
        }
    }

    /// A point with infinitely many postures, of which it is not known whether some are within limits.
    pub fn uncounted_in_doubt() -> Self {
        Self {
            reachable: Some(true),
            doubt_of_limits: Some(
                "in doubt: whether one of infinitely many postures is within limits".into(),
            ),
            ..Self::default()
        }
    }

    /// A point from the postures of a mechanism that is held there.
    pub fn of_postures(answer: &Postures) -> Self {
        if !answer.settled {
            let mut doubt = "in doubt: not every path is accounted for".to_owned();
            for warning in &answer.warnings {
                doubt = format!("{doubt}; {warning}");
            }
            return Self::in_doubt(doubt);
        }
        let real = || answer.positions.iter().filter(|p| p.is_real);
        let is_finite = answer.counts.positive_dimensional == 0 && answer.sets.is_empty();
        let within = real().filter(|p| p.violated.is_empty()).count() as u64;
        if is_finite {
            return Self {
                complex: (answer.route != Route::Product).then_some(answer.counts.complex),
                ..Self::counted(real().count() as u64, within)
            };
        }
        if real().next().is_none() {
            return Self::in_doubt(
                "in doubt: a set of complex postures makes the point, of which no real one is known".into(),
            );
        }
        match within {
            0 => Self::uncounted_in_doubt(),
            _ => Self::uncounted(true),
        }
    }
}

//! Reports: finished chunks, kept and sent again until the coordinator has given a receipt.
//!
//! A chunk's results leave this list only by a receipt, so that no result is lost
//! with a reply; whether a late report still counts is the coordinator's decision.

use crate::retry::{Backoff, Moment, Retry};
use crate::transport::LeaseId;
use std::collections::BTreeMap;
use std::sync::Arc;

struct Kept<C> {
    content: Arc<C>,
    retry: Retry,
}

/// Finished chunks without a receipt. `C` is what is sent.
pub struct Reports<C> {
    kept: BTreeMap<LeaseId, Kept<C>>,
}

impl<C> Default for Reports<C> {
    fn default() -> Self {
        Self {
            kept: BTreeMap::new(),
        }
    }
}

impl<C> Reports<C> {
    /// Keeps a finished chunk from now on; it is due at once.
    pub fn keep(&mut self, lease: LeaseId, content: C) {
        let kept = Kept {
            content: Arc::new(content),
            retry: Retry::default(),
        };
        let before = self.kept.insert(lease, kept);
        assert!(before.is_none(), "a lease's chunk is finished once");
    }

    /// Reports to be sent now; they count as sent from here on.
    pub fn send_due(&mut self, now: Moment) -> Vec<(LeaseId, Arc<C>)> {
        let due = self
            .kept
            .iter_mut()
            .filter(|(_, kept)| kept.retry.is_due(now));
        due.map(|(lease, kept)| {
            kept.retry.begin();
            (lease.clone(), Arc::clone(&kept.content))
        })
        .collect()
    }

    /// The report was answered: it need not be kept any more. False: it was not kept.
    pub fn answered(&mut self, lease: &LeaseId) -> bool {
        self.kept.remove(lease).is_some()
    }

    /// No answer came: it is sent again, later.
    pub fn failed(&mut self, lease: &LeaseId, now: Moment, backoff: &Backoff) {
        if let Some(kept) = self.kept.get_mut(lease) {
            kept.retry.fail(now, backoff);
        }
    }

    /// Time at which the next report is to be sent; `None` where none is kept.
    pub fn due_at(&self) -> Option<Moment> {
        self.kept
            .values()
            .filter_map(|kept| kept.retry.due_at())
            .min()
    }

    /// Number of reports that are kept.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// True when every report has its receipt.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Whether this one is kept.
    pub fn contains(&self, lease: &LeaseId) -> bool {
        self.kept.contains_key(lease)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::tests::lease;
    use std::time::Duration;

    #[test]
    fn a_report_is_kept_until_its_receipt() {
        let backoff = Backoff::default();
        let mut now = Moment::default();
        let mut reports = Reports::default();
        reports.keep(lease(1), "one");
        reports.keep(lease(2), "two");
        let sent = reports.send_due(now);
        assert_eq!(
            sent.iter().map(|(_, c)| **c).collect::<Vec<_>>(),
            ["one", "two"]
        );
        assert!(reports.send_due(now).is_empty(), "they are on their way");
        assert_eq!(reports.due_at(), None);

        assert!(reports.answered(&lease(1)));
        for _ in 0..20 {
            reports.failed(&lease(2), now, &backoff);
            assert!(reports.send_due(now).is_empty(), "not at once");
            now = reports.due_at().unwrap();
            let repeated_reports = reports.send_due(now);
            assert_eq!(repeated_reports.len(), 1);
            assert_eq!(*repeated_reports[0].1, "two");
        }
        assert!(now.since(Moment::default()) < Duration::from_secs(60));
        assert!(reports.answered(&lease(2)));
        assert!(
            !reports.answered(&lease(2)),
            "a second receipt changes nothing"
        );
        assert!(reports.is_empty());
    }
}

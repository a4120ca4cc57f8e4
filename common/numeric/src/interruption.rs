//! Interruption: ends long work on this thread when nobody waits for it any more, or once it has taken its share.
//!
//! Loops that may take long count their work, about one for each multiplication, and end when the interruption says so.
//! No answer depends on a clock: an interrupted count reports that it takes too long, and the caller that interrupted
//! it drops the answer.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

thread_local! {
    static CURRENT: RefCell<Option<Interruption>> = const { RefCell::new(None) };
}

/// A sign that work is to end; clones are the same sign.
#[derive(Clone, Debug, Default)]
pub struct Interruption(Arc<Sign>);

#[derive(Debug)]
struct Sign {
    is_set: AtomicBool,
    /// Work that was counted under this sign.
    counted: AtomicU64,
    /// The sign is set by itself once more work than this was counted.
    most: u64,
}

impl Default for Sign {
    fn default() -> Self {
        Self {
            is_set: AtomicBool::new(false),
            counted: AtomicU64::new(0),
            most: u64::MAX,
        }
    }
}

impl Interruption {
    /// A sign that is set by itself once more than this much work was counted, about one for each multiplication.
    pub fn after(most: u64) -> Self {
        Self(Arc::new(Sign {
            most,
            ..Sign::default()
        }))
    }

    /// Ends the work that runs under this sign.
    pub fn interrupt(&self) {
        self.0.is_set.store(true, Ordering::Relaxed);
    }

    /// Whether the work is to end, or has been ended: its answer is of no use then.
    pub fn is_interrupted(&self) -> bool {
        self.0.is_set.load(Ordering::Relaxed)
    }

    /// The work that was counted under this sign so far.
    pub fn counted(&self) -> u64 {
        self.0.counted.load(Ordering::Relaxed)
    }

    fn count(&self, operations: u64) -> bool {
        let before = self.0.counted.fetch_add(operations, Ordering::Relaxed);
        if before.saturating_add(operations) > self.0.most {
            self.interrupt();
        }
        self.is_interrupted()
    }

    /// Returns a guard that interrupts the work when it is dropped; the waiting caller holds it.
    pub fn when_dropped(&self) -> InterruptWhenDropped {
        InterruptWhenDropped(self.clone())
    }

    /// Runs work on this thread under this sign.
    pub fn run<T>(&self, work: impl FnOnce() -> T) -> T {
        let _within = Within(CURRENT.replace(Some(self.clone())));
        work()
    }
}

/// Interrupts work when it is dropped.
#[derive(Debug)]
pub struct InterruptWhenDropped(Interruption);

impl Drop for InterruptWhenDropped {
    fn drop(&mut self) {
        self.0.interrupt();
    }
}

/// Puts the sign back that was there before, after a panic, too.
struct Within(Option<Interruption>);

impl Drop for Within {
    fn drop(&mut self) {
        CURRENT.replace(self.0.take());
    }
}

/// Whether the work of this thread may be interrupted at all.
pub fn can_be_interrupted() -> bool {
    CURRENT.with_borrow(Option::is_some)
}

/// Whether the work of this thread is to end.
pub fn is_interrupted() -> bool {
    CURRENT.with_borrow(|sign| sign.as_ref().is_some_and(Interruption::is_interrupted))
}

/// Counts work of this thread, about one for each multiplication; whether it is to end. Loops ask so every few
/// milliseconds.
pub fn count_work(operations: u64) -> bool {
    CURRENT.with_borrow(|sign| sign.as_ref().is_some_and(|sign| sign.count(operations)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_reaches_the_work_that_runs_under_it() {
        let sign = Interruption::default();
        sign.run(|| {
            assert!(can_be_interrupted() && !is_interrupted());
            drop(sign.when_dropped());
            assert!(is_interrupted());
            Interruption::default().run(|| assert!(!is_interrupted()));
            assert!(is_interrupted());
        });
        assert!(!can_be_interrupted() && !is_interrupted());
        assert!(sign.is_interrupted());
    }

    #[test]
    fn work_ends_once_its_share_is_counted() {
        let sign = Interruption::after(10);
        sign.run(|| {
            assert!(!count_work(4) && !count_work(6) && !is_interrupted());
            assert!(count_work(1) && is_interrupted());
        });
        assert_eq!(sign.counted(), 11);
        assert!(!count_work(u64::MAX), "no sign, no share");
        let unbounded = Interruption::default();
        assert!(!unbounded.run(|| count_work(u64::MAX)));
    }
}

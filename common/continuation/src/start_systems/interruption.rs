//! Interruption: ends long work on this thread when nobody waits for it any more.
//!
//! Counting is bounded by operations, so that what it answers never depends on a clock. An interrupted
//! count says that it takes too long; whoever interrupted it drops the answer.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    static CURRENT: RefCell<Option<Interruption>> = const { RefCell::new(None) };
}

/// A sign that work is to end; clones are the same sign.
#[derive(Clone, Debug, Default)]
pub struct Interruption(Arc<AtomicBool>);

impl Interruption {
    /// Ends the work that runs under this sign.
    pub fn interrupt(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the work is to end, or has been ended: its answer is of no use then.
    pub fn is_interrupted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// A value that interrupts the work when it is dropped: held by whoever waits.
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
}

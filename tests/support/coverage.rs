//! Coverage: which edges of the code were taken, where the program was built to count them
//! (`tests/any_bytes/README.md`). Elsewhere nothing is counted.

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// The compiler's counters of all edges, one byte each, eight at a time.
static COUNTERS: Mutex<Vec<&'static [AtomicU64]>> = Mutex::new(Vec::new());

/// Registers counters. Compiled code that counts calls runs it before `main`, once for each of its parts, with the same
/// bounds.
// SAFETY: the name is reserved for this by the compiler's sanitizers, of which none is linked here.
#[unsafe(no_mangle)]
extern "C" fn __sanitizer_cov_8bit_counters_init(begin: *const AtomicU8, end: *const AtomicU8) {
    let mut counters = COUNTERS.lock().unwrap_or_else(PoisonError::into_inner);
    let is_registered = |part: &&[AtomicU64]| part.as_ptr_range().contains(&begin.cast());
    let length = (end as usize).saturating_sub(begin as usize);
    if length < 16 || counters.iter().any(is_registered) {
        return;
    }
    // SAFETY: these are the bounds of one array of bytes that lives as long as the program, and `AtomicU64` may have any
    // bits. The few before and behind the aligned ones are not looked at.
    let (_, part, _) = unsafe { std::slice::from_raw_parts(begin, length).align_to() };
    counters.push(part);
}

/// Whether edges are counted.
pub fn is_counted() -> bool {
    let counters = COUNTERS.lock().unwrap_or_else(PoisonError::into_inner);
    !counters.is_empty()
}

/// Hands over each edge that was taken since the last call, with how often modulo 256, and forgets them.
pub fn take(mut edge: impl FnMut(usize, u8)) {
    let counters = COUNTERS.lock().unwrap_or_else(PoisonError::into_inner);
    let words = counters.iter().flat_map(|part| part.iter());
    for (k, word) in words.enumerate() {
        let counts = word.load(Ordering::Relaxed);
        if counts == 0 {
            continue;
        }
        word.store(0, Ordering::Relaxed);
        for (i, count) in counts.to_ne_bytes().into_iter().enumerate() {
            if count != 0 {
                edge(8 * k + i, count);
            }
        }
    }
}

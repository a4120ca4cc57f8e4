//! Choose the instruction set once, around a whole chunk of work.
//!
//! `dispatch(job)` runs `job.run()` compiled for the best instruction set of
//! this machine. The only `unsafe` code of the mathematics stands here.

use std::cell::Cell;

/// Work that is compiled once per instruction set.
///
/// `run` and everything below it must be `#[inline(always)]`, and it is a trait
/// method because a closure cannot be marked so; measured: otherwise each
/// operation is a call and all is 17 to 20 times slower
/// (`continuation/benches/tracking.rs` has the guard).
pub trait Job {
    /// Result of the work.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// An instruction set with fused multiply-add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// x86-64 with AVX-512 F, DQ, VL and FMA.
    Avx512,
    /// x86-64 with AVX2 and FMA.
    Avx2,
    /// AArch64, where NEON and fused multiply-add are always there.
    Neon,
    /// No hardware fused multiply-add: the same bits, but very slow; not for work.
    Software,
}

impl InstructionSet {
    /// The best one that this machine has; within [`limited_to`], the one that is named there.
    #[inline]
    pub fn detect() -> Self {
        SET.get().unwrap_or_else(|| {
            let best = Self::best();
            SET.set(Some(best));
            best
        })
    }

    fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("fma")
                && std::arch::is_x86_feature_detected!("avx512f")
                && std::arch::is_x86_feature_detected!("avx512dq")
                && std::arch::is_x86_feature_detected!("avx512vl")
            {
                return Self::Avx512;
            }
            if std::arch::is_x86_feature_detected!("fma")
                && std::arch::is_x86_feature_detected!("avx2")
            {
                return Self::Avx2;
            }
            Self::Software
        }
        #[cfg(target_arch = "aarch64")]
        {
            Self::Neon
        }
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        {
            Self::Software
        }
    }

    /// Name of the instruction set, as workers announce it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Neon => "neon",
            Self::Software => "software",
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn run_avx512<J: Job>(job: J) -> J::Output {
    job.run()
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<J: Job>(job: J) -> J::Output {
    job.run()
}

std::thread_local! {
    /// The set that this thread uses: the best one, or what [`limited_to`] says; `None` before the first question.
    static SET: Cell<Option<InstructionSet>> = const { Cell::new(None) };
}

/// Runs `work` with everything that it dispatches on this thread done with `set`, or with the best
/// instruction set that this machine has where it lacks that one. For tests that compare them.
pub fn limited_to<T>(set: InstructionSet, work: impl FnOnce() -> T) -> T {
    /// Gives the limit back that was there before, also after a panic.
    struct Before(Option<InstructionSet>);
    impl Drop for Before {
        fn drop(&mut self) {
            SET.set(self.0);
        }
    }
    let best = InstructionSet::best();
    let has_it = set == best || (best == InstructionSet::Avx512 && set == InstructionSet::Avx2);
    let _before = Before(SET.replace(Some(if has_it { set } else { best })));
    work()
}

const NO_FUSED_MULTIPLY_ADD: &str =
    "this machine has no fused multiply-add, which every path's bits rely on";

/// Runs the job with the best instruction set of this machine.
pub fn dispatch<J: Job>(job: J) -> J::Output {
    dispatch_on(InstructionSet::detect(), job)
}

/// Runs the job with one instruction set, for tests that compare them; with the best that this
/// machine has where it lacks the one asked for, which gives the same bits.
///
/// # Panics
/// On a machine without fused multiply-add. Programs that track paths ask [`InstructionSet::detect`] first and decline
/// this machine.
pub fn dispatch_on<J: Job>(instruction_set: InstructionSet, job: J) -> J::Output {
    let best = InstructionSet::best();
    assert!(best != InstructionSet::Software, "{NO_FUSED_MULTIPLY_ADD}");
    #[cfg(target_arch = "x86_64")]
    {
        if best == InstructionSet::Avx512 && instruction_set != InstructionSet::Avx2 {
            // SAFETY: the features were detected on this machine just now;
            // `lanes_agree_on_every_instruction_set` runs both and compares.
            unsafe { run_avx512(job) }
        } else {
            // SAFETY: as above; a machine with the AVX-512 set has AVX2.
            unsafe { run_avx2(job) }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = instruction_set;
        job.run()
    }
}

/// Runs a job that is compiled once, for AVX2 with fused multiply-add, which every machine with AVX-512 has, too. So are
/// single numbers, which gain nothing from AVX-512, and paths in lanes, whose equations and eliminations are machine code
/// made for the set of this machine (`tests/benches/build.md` has what a second copy costs). The bits are those of
/// [`dispatch`].
///
/// # Panics
/// On a machine without fused multiply-add, as [`dispatch_on`] does.
pub fn dispatch_baseline<J: Job>(job: J) -> J::Output {
    let set = InstructionSet::detect();
    assert!(set != InstructionSet::Software, "{NO_FUSED_MULTIPLY_ADD}");
    #[cfg(target_arch = "x86_64")]
    {
        // SAFETY: the features were detected on this machine just now: both sets have AVX2 and FMA;
        // `the_baseline_is_the_same_on_every_instruction_set` compares.
        unsafe { run_avx2(job) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        job.run()
    }
}

/// Runs a small job that stands in a loop of another job, as a function that is never inlined, compiled for each
/// instruction set; the one of this machine is taken, within [`limited_to`] the one that is named there.
///
/// # Panics
/// On a machine without fused multiply-add, as [`dispatch_on`] does.
#[inline(never)]
pub fn call<J: Job>(job: J) -> J::Output {
    #[cfg(target_arch = "x86_64")]
    match InstructionSet::detect() {
        // SAFETY: `detect` gives a set whose features were detected on this machine.
        InstructionSet::Avx512 => unsafe { run_avx512(job) },
        // SAFETY: as above.
        InstructionSet::Avx2 => unsafe { run_avx2(job) },
        InstructionSet::Neon | InstructionSet::Software => panic!("{NO_FUSED_MULTIPLY_ADD}"),
    }
    #[cfg(not(target_arch = "x86_64"))]
    job.run()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::scalar::{Complex, Real};

    struct Horner([f64; 16]);

    impl Job for Horner {
        type Output = [u64; 16];
        #[inline(always)]
        fn run(self) -> [u64; 16] {
            let x = Complex {
                re: Lanes(self.0),
                im: Lanes([0.25; 16]),
            };
            let mut sum = Complex::<Lanes<16>>::from_f64((), 1.0, 0.0);
            for k in 1..40 {
                sum.mul(&x);
                sum.re.add(&Lanes::from_f64((), 1.0 / f64::from(k)));
            }
            sum.div(&x);
            std::array::from_fn(|i| sum.re.0[i].to_bits() ^ sum.im.0[i].to_bits())
        }
    }

    #[test]
    fn lanes_agree_on_every_instruction_set() {
        let x = std::array::from_fn(|i| (i as f64 - 7.3) / 9.1);
        let plain = dispatch_on(InstructionSet::Software, Horner(x));
        for set in [
            InstructionSet::Avx512,
            InstructionSet::Avx2,
            InstructionSet::Neon,
        ] {
            assert_eq!(plain, dispatch_on(set, Horner(x)), "{}", set.name());
        }
    }

    #[test]
    fn the_baseline_is_the_same_on_every_instruction_set() {
        let x = std::array::from_fn(|i| (i as f64 - 7.3) / 9.1);
        let single = dispatch_baseline(Horner(x));
        for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
            let limited = limited_to(set, || {
                assert!(
                    InstructionSet::detect() == set
                        || InstructionSet::best() != InstructionSet::Avx512
                );
                dispatch(Horner(x))
            });
            assert_eq!(single, limited, "{}", set.name());
        }
        assert_eq!(InstructionSet::detect(), InstructionSet::best());
    }
}

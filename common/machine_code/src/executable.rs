//! Executable: code in memory of its own, and how it is called. The only `unsafe` of this crate.
//!
//! The memory is written first and made executable then, never both at a time. Where a machine
//! does not allow that, or lacks the instructions, there is no code.

use crate::encoder::VectorSet;
use crate::registers::Assembled;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::InstructionSet;
use cognate_numeric::scalar::{Complex, Real};
use std::any::TypeId;

/// The numbers as lanes of width `W`; `None` if `R` is another type.
#[inline(always)]
pub(crate) fn as_lanes<const W: usize, R: Real>(
    numbers: &[Complex<R>],
) -> Option<&[Complex<Lanes<W>>]> {
    (TypeId::of::<R>() == TypeId::of::<Lanes<W>>()).then(|| {
        // SAFETY: the two types are one, as their `TypeId`s say.
        unsafe { std::slice::from_raw_parts(numbers.as_ptr().cast(), numbers.len()) }
    })
}

/// The numbers as lanes of width `W`, to be written; `None` if `R` is another type.
#[inline(always)]
pub(crate) fn as_lanes_mut<const W: usize, R: Real>(
    numbers: &mut [Complex<R>],
) -> Option<&mut [Complex<Lanes<W>>]> {
    (TypeId::of::<R>() == TypeId::of::<Lanes<W>>()).then(|| {
        // SAFETY: the two types are one, as their `TypeId`s say.
        unsafe { std::slice::from_raw_parts_mut(numbers.as_mut_ptr().cast(), numbers.len()) }
    })
}

/// The code to make for this instruction set; `None` where there is none, or this machine lacks
/// the instructions.
pub(crate) fn vector_set(instruction_set: InstructionSet) -> Option<VectorSet> {
    let set = match instruction_set {
        InstructionSet::Avx512 => VectorSet::Avx512,
        InstructionSet::Avx2 => VectorSet::Avx2,
        InstructionSet::Neon | InstructionSet::Software => return None,
    };
    is_there(set).then_some(set)
}

/// Whether this machine runs code of this set.
pub(crate) fn is_there(set: VectorSet) -> bool {
    let best = InstructionSet::detect();
    match set {
        VectorSet::Avx512 => best == InstructionSet::Avx512,
        VectorSet::Avx2 => matches!(best, InstructionSet::Avx512 | InstructionSet::Avx2),
    }
}

/// A function in memory of its own, for arrays of `Complex<Lanes<W>>`.
#[derive(Debug)]
pub(crate) struct Executable<const W: usize> {
    pages: Pages,
    set: VectorSet,
    extents: [usize; 6],
    /// Vectors of work space that a call needs.
    pub spills: usize,
    constants: Vec<f64>,
}

/// Arrays that a call of the code reads and writes.
pub(crate) struct Arrays<'a, const W: usize> {
    pub x: &'a [Complex<Lanes<W>>],
    pub p: &'a [Complex<Lanes<W>>],
    pub dp: &'a [Complex<Lanes<W>>],
    pub out: &'a mut [Complex<Lanes<W>>],
    pub spills: &'a mut [Lanes<8>],
}

impl<const W: usize> Executable<W> {
    /// Takes code for width `W`; `None` where it cannot be run.
    pub(crate) fn new(assembled: Assembled, constants: Vec<f64>, set: VectorSet) -> Option<Self> {
        let whole = W.is_multiple_of(set.lanes()) && assembled.extents[5] <= 8 * constants.len();
        if !whole || !is_there(set) {
            return None;
        }
        Some(Self {
            pages: Pages::new(&assembled.code)?,
            set,
            extents: assembled.extents,
            spills: assembled.spills,
            constants,
        })
    }

    /// Bytes of code.
    pub(crate) fn len(&self) -> usize {
        self.pages.code
    }

    /// Runs it, once for as many lanes as a vector has until all are served; bit i of what it
    /// gives is the routine's result for lane i.
    ///
    /// # Panics
    /// When an array is shorter than what the code touches of it.
    #[inline(always)]
    pub(crate) fn call(&self, arrays: Arrays<'_, W>) -> u32 {
        let (lanes, bytes) = (self.set.lanes(), self.set.bytes());
        let last = (W / lanes - 1) * bytes;
        let number = size_of::<Complex<Lanes<W>>>();
        let holds = |extent: usize, length: usize| extent == 0 || extent + last <= length * number;
        assert!(
            holds(self.extents[0], arrays.x.len())
                && holds(self.extents[1], arrays.p.len())
                && holds(self.extents[2], arrays.dp.len())
                && holds(self.extents[3], arrays.out.len())
                && self.extents[4] <= size_of_val::<[Lanes<8>]>(arrays.spills),
            "the arrays are as long as the code takes them to be"
        );
        let inputs = [arrays.x, arrays.p, arrays.dp].map(|a| a.as_ptr().cast::<u8>());
        let out = arrays.out.as_mut_ptr().cast::<u8>();
        let spills = arrays.spills.as_mut_ptr().cast::<u8>();
        let constants = self.constants.as_ptr().cast::<u8>();
        let mut results = 0;
        for part in 0..W / lanes {
            let shift = part * bytes;
            let result = self.pages.call(
                inputs.map(|input| input.wrapping_add(shift)),
                out.wrapping_add(shift),
                spills,
                constants,
            );
            results |= result << (part * lanes);
        }
        results
    }
}

#[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
use elsewhere::Pages;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
use linux::Pages;

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod linux {
    use std::ptr::NonNull;

    /// Arrays in the order of `Base`.
    type Function =
        extern "sysv64" fn(*const u8, *const u8, *const u8, *mut u8, *mut u8, *const u8) -> u32;

    /// Memory that was mapped for code.
    #[derive(Debug)]
    pub(super) struct Pages {
        start: NonNull<libc::c_void>,
        length: usize,
        /// Bytes of code.
        pub code: usize,
    }

    // SAFETY: after it is made nothing writes to the memory; it is unmapped by its only owner.
    unsafe impl Send for Pages {}
    // SAFETY: as above; running code does not change it.
    unsafe impl Sync for Pages {}

    impl Pages {
        /// Maps memory, writes the code, makes it executable; `None` where that is forbidden.
        pub(super) fn new(code: &[u8]) -> Option<Self> {
            let length = code.len().max(1);
            let access = libc::PROT_READ | libc::PROT_WRITE;
            let kind = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS;
            // SAFETY: a new anonymous mapping; nothing else is touched.
            let start = unsafe { libc::mmap(std::ptr::null_mut(), length, access, kind, -1, 0) };
            if start == libc::MAP_FAILED {
                return None;
            }
            let pages = Self {
                start: NonNull::new(start)?,
                length,
                code: code.len(),
            };
            // SAFETY: the mapping is ours alone, writable, and at least as long as the code.
            unsafe { std::ptr::copy_nonoverlapping(code.as_ptr(), start.cast(), code.len()) };
            let access = libc::PROT_READ | libc::PROT_EXEC;
            // SAFETY: the whole mapping, which nobody else knows yet.
            let done = unsafe { libc::mprotect(start, length, access) };
            (done == 0).then_some(pages)
        }

        /// Calls the code. Only `Executable::call` does so, which has checked the arrays.
        #[inline(always)]
        pub(super) fn call(
            &self,
            inputs: [*const u8; 3],
            out: *mut u8,
            spills: *mut u8,
            constants: *const u8,
        ) -> u32 {
            // SAFETY: the code was made by `assemble` as a function of this type: it keeps to the
            // calling convention, changes no memory but `out` and `spills`, and touches of each
            // array as many bytes as the caller has found there. The instructions are those of a
            // set that this machine has.
            let function =
                unsafe { std::mem::transmute::<*mut libc::c_void, Function>(self.start.as_ptr()) };
            function(inputs[0], inputs[1], inputs[2], out, spills, constants)
        }
    }

    impl Drop for Pages {
        fn drop(&mut self) {
            // SAFETY: mapped by `new` with this length; nobody runs it any more.
            unsafe { libc::munmap(self.start.as_ptr(), self.length) };
        }
    }
}

#[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
mod elsewhere {
    /// There is none here.
    #[derive(Debug)]
    pub(super) struct Pages {
        pub code: usize,
    }

    impl Pages {
        pub(super) fn new(_: &[u8]) -> Option<Self> {
            None
        }

        pub(super) fn call(&self, _: [*const u8; 3], _: *mut u8, _: *mut u8, _: *const u8) -> u32 {
            unreachable!("no pages are ever made here")
        }
    }
}

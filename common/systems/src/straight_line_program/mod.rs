//! StraightLineProgram, and the stages that make one, in order.
//!
//! `jacobian` differentiates on the expression graph, `compile` lowers it to a
//! flow graph, `optimize` fuses operations and drops dead code, `schedule`
//! forms runs of equal operation and gives slots; `assignments` calls the first
//! three in all their variants and takes the cheapest. A program works on one
//! memory: inputs, constants, temporaries; results go straight to the caller.

pub(crate) mod assignments;
pub(crate) mod compile;
pub mod constant;
pub(crate) mod enclosure;
pub mod instruction;
pub mod jacobian;
pub(crate) mod optimize;
pub mod schedule;

use instruction::{FREQUENT, Operation};

/// An address in memory or an entry of the output.
pub type Index = u32;

/// Places of inputs, constants and temporaries in the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Number of variables.
    pub variables: usize,
    /// Number of parameters, and of their derivatives along the path.
    pub parameters: usize,
    /// Number of constants that fill all lanes.
    pub constants: usize,
    /// Number of constants that stand once for all lanes, outside the memory.
    pub singles: usize,
}

impl Layout {
    fn index(position: usize) -> Index {
        Index::try_from(position).expect("a program has fewer than 2^32 addresses")
    }

    /// Address of a variable.
    pub fn variable(&self, v: u32) -> Index {
        v
    }

    /// Address of a parameter.
    pub fn parameter(&self, p: u32) -> Index {
        Self::index(self.variables + p as usize)
    }

    /// Address of a parameter's derivative along the path.
    pub fn direction(&self, p: u32) -> Index {
        Self::index(self.variables + self.parameters + p as usize)
    }

    /// Address of a constant.
    pub fn constant(&self, c: u32) -> Index {
        Self::index(self.variables + 2 * self.parameters + c as usize)
    }

    /// Address of a temporary.
    pub fn temporary(&self, slot: u32) -> Index {
        Self::index(self.temporaries() + slot as usize)
    }

    /// Address of the first temporary.
    pub fn temporaries(&self) -> usize {
        self.variables + 2 * self.parameters + self.constants
    }
}

/// Destination of the results of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Into temporaries.
    Memory,
    /// Into the caller's output.
    Output,
}

/// Consecutive instructions of one operation and target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The operation of all instructions of the run.
    pub operation: Operation,
    /// Destination of the results.
    pub target: Target,
    /// Number of instructions in the run.
    pub length: u32,
    /// Place of the operation in [`FREQUENT`], or the length of that list.
    pub arm: u8,
}

impl Run {
    /// A run of this operation.
    pub fn new(operation: Operation, target: Target, length: usize) -> Self {
        let arm = FREQUENT
            .iter()
            .position(|&terms| operation == Operation::Sum(terms))
            .unwrap_or(FREQUENT.len());
        Self {
            operation,
            target,
            length: u32::try_from(length).expect("a run is shorter than 2^32"),
            arm: arm as u8,
        }
    }

    /// Words of code for each instruction: its target and its operands.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        1 + self.operation.operands()
    }
}

/// A checked program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StraightLineProgram {
    layout: Layout,
    memory: usize,
    outputs: usize,
    runs: Vec<Run>,
    code: Vec<Index>,
}

impl StraightLineProgram {
    /// Checks a program: every address is in the memory, only temporaries are
    /// written, every output of `wanted` is written exactly once and no other, runs and code
    /// match.
    ///
    /// # Panics
    /// When it is not so; programs are made by the compiler, never read from outside.
    pub fn new(
        layout: Layout,
        temporaries: usize,
        outputs: usize,
        wanted: impl Fn(usize) -> bool,
        runs: Vec<Run>,
        code: Vec<Index>,
    ) -> Self {
        let memory = layout.temporaries() + temporaries;
        let mut written: Vec<bool> = (0..outputs).map(|entry| !wanted(entry)).collect();
        let mut rest = code.as_slice();
        for run in &runs {
            assert!(run.operation.operands() > 0, "a sum has a term");
            let words = run.stride() * run.length as usize;
            let (run_code, later) = rest
                .split_at_checked(words)
                .expect("a run is as long as its code");
            rest = later;
            for instruction in run_code.chunks_exact(run.stride()) {
                let target = instruction[0] as usize;
                match run.target {
                    Target::Memory => assert!(
                        (layout.temporaries()..memory).contains(&target),
                        "an instruction writes only temporaries"
                    ),
                    Target::Output => assert!(
                        target < outputs && !std::mem::replace(&mut written[target], true),
                        "an output is written once"
                    ),
                }
                for (k, &operand) in instruction[1..].iter().enumerate() {
                    let room = if run.operation.takes_single(k) {
                        layout.singles
                    } else {
                        memory
                    };
                    assert!((operand as usize) < room, "an operand is where it can be");
                }
            }
        }
        assert!(rest.is_empty(), "every instruction is in a run");
        assert!(written.iter().all(|&w| w), "every output is written");
        Self {
            layout,
            memory,
            outputs,
            runs,
            code,
        }
    }

    /// Places of values in the memory.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Length of the memory: inputs, constants and temporaries.
    #[inline(always)]
    pub fn memory(&self) -> usize {
        self.memory
    }

    /// Number of temporaries.
    pub fn temporaries(&self) -> usize {
        self.memory - self.layout.temporaries()
    }

    /// Number of entries of the output.
    #[inline(always)]
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// The runs, in order.
    #[inline(always)]
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Target and operands of every instruction, in the order of the runs.
    #[inline(always)]
    pub fn code(&self) -> &[Index] {
        &self.code
    }

    /// Number of instructions.
    pub fn instruction_count(&self) -> usize {
        self.runs.iter().map(|run| run.length as usize).sum()
    }

    /// Real operations of one evaluation of one path (`Operation::flops`).
    pub fn flops(&self) -> usize {
        self.runs
            .iter()
            .map(|run| run.length as usize * run.operation.flops())
            .sum()
    }
}

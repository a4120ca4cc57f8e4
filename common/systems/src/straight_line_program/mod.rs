//! StraightLineProgram, and the stages that make one, in order.
//!
//! `jacobian` differentiates on the expression graph, `compile` lowers it to a
//! flow graph, `optimize` fuses operations and drops dead code, `schedule`
//! forms runs of equal operation and gives slots. A program works on one
//! memory: inputs, constants, temporaries; results go straight to the caller.

pub(crate) mod compile;
pub mod constant;
pub mod instruction;
pub mod jacobian;
pub(crate) mod optimize;
pub(crate) mod schedule;

use instruction::Operation;

/// An address in memory or an entry of the output.
pub type Index = u32;

/// Where inputs, constants and temporaries stand in the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Number of variables.
    pub variables: usize,
    /// Number of parameters, and of their derivatives along the path.
    pub parameters: usize,
    /// Number of constants.
    pub constants: usize,
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

/// Where the results of a run go.
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
    /// What they compute.
    pub operation: Operation,
    /// Where to.
    pub target: Target,
    /// How many they are.
    pub length: u32,
}

/// Targets and operands of all instructions, by number of operands, in the order of the runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Operands {
    /// Target, a.
    pub unary: Vec<[Index; 2]>,
    /// Target, a, b.
    pub binary: Vec<[Index; 3]>,
    /// Target, a, b, c.
    pub ternary: Vec<[Index; 4]>,
    /// Target, a, b, c, d.
    pub quaternary: Vec<[Index; 5]>,
}

/// A checked program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StraightLineProgram {
    layout: Layout,
    memory: usize,
    outputs: usize,
    runs: Vec<Run>,
    operands: Operands,
}

impl StraightLineProgram {
    /// Checks a program: every address is in the memory, only temporaries are
    /// written, every output is written exactly once, runs and operands match.
    ///
    /// # Panics
    /// When it is not so; programs are made by the compiler, never read from outside.
    pub fn new(
        layout: Layout,
        temporaries: usize,
        outputs: usize,
        runs: Vec<Run>,
        operands: Operands,
    ) -> Self {
        let memory = layout.temporaries() + temporaries;
        let program = Self {
            layout,
            memory,
            outputs,
            runs,
            operands,
        };
        let mut cursors = [0usize; 4];
        let mut written = vec![false; outputs];
        for run in &program.runs {
            let arity = run.operation.arity();
            let start = cursors[arity - 1];
            cursors[arity - 1] += run.length as usize;
            for k in start..cursors[arity - 1] {
                let instruction = program
                    .operands
                    .instruction(arity, k)
                    .expect("a run is as long as its operands");
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
                for &operand in &instruction[1..] {
                    assert!((operand as usize) < memory, "an operand is in the memory");
                }
            }
        }
        for arity in 1..=4 {
            assert!(
                program
                    .operands
                    .instruction(arity, cursors[arity - 1])
                    .is_none(),
                "every instruction is in a run"
            );
        }
        assert!(written.iter().all(|&w| w), "every output is written");
        program
    }

    /// Where things stand in the memory.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Length of the memory: inputs, constants and temporaries.
    pub fn memory(&self) -> usize {
        self.memory
    }

    /// Number of temporaries.
    pub fn temporaries(&self) -> usize {
        self.memory - self.layout.temporaries()
    }

    /// Number of entries of the output.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// The runs, in order.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Targets and operands.
    pub fn operands(&self) -> &Operands {
        &self.operands
    }

    /// Number of instructions, copies included.
    pub fn instruction_count(&self) -> usize {
        self.runs.iter().map(|run| run.length as usize).sum()
    }

    /// Number of instructions of one operation.
    pub fn count_of(&self, operation: Operation) -> usize {
        self.runs
            .iter()
            .filter(|run| run.operation == operation)
            .map(|run| run.length as usize)
            .sum()
    }

    /// Real operations of one evaluation of one path (`Operation::flops`).
    pub fn flops(&self) -> usize {
        self.runs
            .iter()
            .map(|run| run.length as usize * run.operation.flops())
            .sum()
    }
}

impl Operands {
    /// Target and operands of one instruction.
    pub fn instruction(&self, arity: usize, k: usize) -> Option<&[Index]> {
        match arity {
            1 => self.unary.get(k).map(|i| &i[..]),
            2 => self.binary.get(k).map(|i| &i[..]),
            3 => self.ternary.get(k).map(|i| &i[..]),
            _ => self.quaternary.get(k).map(|i| &i[..]),
        }
    }
}

//! Registers: from a routine to code, in one pass over its steps.
//!
//! A value that finds no register free takes that of the value whose next use is furthest
//! (Belady, IBM Systems Journal 5, 1966), which is written to memory unless it stands there
//! already. Inputs and constants are operands in memory where a register would not pay.

use crate::encoder::{Base, Binary, Encoder, Form, Memory, Signs, Source, VectorSet};
use crate::routine::{CONSTANTS, OUTPUT, Operation, Place, Routine, SPILL, Step, Value};

/// No register, no further use.
const NONE: u32 = u32::MAX;

/// The code of a routine, and what it touches.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Assembled {
    /// A function of six addresses.
    pub code: Vec<u8>,
    /// Bytes of each array that the code touches from the beginning, in the order of [`Base`].
    pub extents: [usize; 6],
    /// Vectors that find no register.
    pub spills: usize,
}

/// Code of a routine for arrays of `Complex<Lanes<width>>`, of which it serves the first lanes, as
/// many as a vector has.
pub(crate) fn assemble(routine: &Routine, set: VectorSet, width: usize) -> Assembled {
    let mut allocator = Allocator::new(routine, set, width);
    allocator.begin();
    for (number, step) in routine.steps.iter().enumerate() {
        match *step {
            Step::Compute(operation, operands, result) => {
                allocator.compute(number, operation, operands, result);
            }
            Step::Store(value, place) => allocator.store(number, value, place),
            Step::Less(operands) => allocator.less(number, operands),
        }
        allocator.free_spills.append(&mut allocator.resting_spills);
    }
    if !matches!(routine.steps.last(), Some(Step::Less(_))) {
        allocator.encoder.nothing();
    }
    allocator.encoder.finish();
    Assembled {
        code: allocator.encoder.code,
        extents: allocator.extents,
        spills: allocator.spills as usize,
    }
}

struct Allocator<'a> {
    routine: &'a Routine,
    width: usize,
    set: VectorSet,
    encoder: Encoder,
    /// Number that is subtracted from every displacement of an array, so that more displacements fit into 8 bits.
    bias: [i32; 6],
    extents: [usize; 6],
    /// For each operand of each step, the next step that uses its value.
    following: Vec<[u32; 3]>,
    /// For each value, the next step that uses it.
    next_use: Vec<u32>,
    register_of: Vec<u32>,
    /// Place of the value in memory, if it has one.
    home: Vec<Option<Place>>,
    held: Vec<Option<Value>>,
    spills: u32,
    free_spills: Vec<u32>,
    /// Free after the present step, which may still read them.
    resting_spills: Vec<u32>,
}

impl<'a> Allocator<'a> {
    fn new(routine: &'a Routine, set: VectorSet, width: usize) -> Self {
        let mut next_use = vec![NONE; routine.homes.len()];
        let mut following = vec![[NONE; 3]; routine.steps.len()];
        for (number, step) in routine.steps.iter().enumerate().rev() {
            let operands = step.operands();
            for (k, &operand) in operands.iter().enumerate() {
                following[number][k] = next_use[operand as usize];
            }
            for &operand in operands {
                next_use[operand as usize] = number as u32;
            }
        }
        Self {
            routine,
            width,
            set,
            encoder: Encoder::new(set),
            bias: [0; 6],
            extents: [0; 6],
            following,
            register_of: vec![NONE; next_use.len()],
            next_use,
            home: routine.homes.clone(),
            held: vec![None; set.registers()],
            spills: 0,
            free_spills: Vec::new(),
            resting_spills: Vec::new(),
        }
    }

    /// With AVX-512, displacements from -128 to 127 vectors are short: the addresses of long
    /// arrays move to their middle.
    fn begin(&mut self) {
        if self.set != VectorSet::Avx512 {
            return;
        }
        let mut lengths = [0i32; 6];
        let stored = self.routine.steps.iter().filter_map(|step| match step {
            Step::Store(_, place) => Some(*place),
            Step::Compute(..) | Step::Less(_) => None,
        });
        for place in self.routine.homes.iter().copied().flatten().chain(stored) {
            let (base, offset, _) = self.locate(place);
            lengths[base as usize] = lengths[base as usize].max(offset);
        }
        for base in [Base::First, Base::Second, Base::Third, OUTPUT] {
            const HALF: i32 = 128 * 64;
            if lengths[base as usize] >= HALF {
                self.bias[base as usize] = HALF;
                self.encoder.advance(base, HALF);
            }
        }
    }

    /// Array, bytes from its beginning, and bytes that are there.
    fn locate(&self, place: Place) -> (Base, i32, usize) {
        let (base, offset, bytes) = match place {
            Place::Number { base, index, part } => {
                let parts = 2 * index as usize + usize::from(part);
                (base, parts * self.width * 8, self.set.bytes())
            }
            Place::Constant(number) => (CONSTANTS, number as usize * 8, 8),
            Place::Spill(slot) => {
                let bytes = self.set.bytes();
                (SPILL, slot as usize * bytes, bytes)
            }
        };
        let offset = i32::try_from(offset).expect("arrays are shorter than 2 GiB");
        (base, offset, bytes)
    }

    fn memory(&mut self, place: Place) -> Memory {
        let (base, offset, bytes) = self.locate(place);
        let extent = &mut self.extents[base as usize];
        *extent = (*extent).max(offset as usize + bytes);
        Memory {
            base,
            displacement: offset - self.bias[base as usize],
            broadcast: matches!(place, Place::Constant(_)),
        }
    }

    fn in_register(&self, value: Value) -> bool {
        self.register_of[value as usize] != NONE
    }

    /// Whether an instruction can take the value from where it stands in memory.
    fn may_stay(&self, value: Value) -> bool {
        self.set == VectorSet::Avx512
            || !matches!(self.home[value as usize], Some(Place::Constant(_)))
    }

    /// The register that is given up next: a free one, else the one needed last.
    fn candidate(&self, pinned: u32) -> usize {
        let mut best = (0, 0);
        for (register, held) in self.held.iter().enumerate() {
            if pinned >> register & 1 != 0 {
                continue;
            }
            let Some(value) = *held else {
                return register;
            };
            // Among equals the one that need not be written.
            let next = u64::from(self.next_use[value as usize]) + 1;
            let distance = 2 * next + u64::from(self.home[value as usize].is_some());
            if distance > best.0 {
                best = (distance, register);
            }
        }
        best.1
    }

    /// Makes a register free.
    fn take(&mut self, pinned: u32) -> u8 {
        let register = self.candidate(pinned);
        if let Some(value) = self.held[register].take() {
            if self.home[value as usize].is_none() {
                let slot = self.free_spills.pop().unwrap_or_else(|| {
                    self.spills += 1;
                    self.spills - 1
                });
                self.home[value as usize] = Some(Place::Spill(slot));
                let memory = self.memory(Place::Spill(slot));
                self.encoder.store(memory, register as u8);
            }
            self.register_of[value as usize] = NONE;
        }
        register as u8
    }

    fn place_of(&self, value: Value) -> Place {
        self.home[value as usize].expect("a value is in a register or in memory")
    }

    /// Brings a value into a register.
    fn bring(&mut self, value: Value, pinned: u32) -> u8 {
        if self.in_register(value) {
            return self.register_of[value as usize] as u8;
        }
        let register = self.take(pinned);
        let memory = self.memory(self.place_of(value));
        self.encoder.load(register, memory);
        self.held[usize::from(register)] = Some(value);
        self.register_of[value as usize] = u32::from(register);
        register
    }

    /// Whether a value in memory should get a register now, for a use to come.
    fn pays(&self, next: u32, pinned: u32) -> bool {
        next != NONE
            && match self.held[self.candidate(pinned)] {
                None => true,
                Some(victim) => {
                    self.home[victim as usize].is_some() && self.next_use[victim as usize] > next
                }
            }
    }

    /// A step has read its operands: what is needed no more gives up its register.
    fn release(&mut self, number: usize, operands: &[Value]) {
        for (k, &value) in operands.iter().enumerate() {
            let next = self.following[number][k];
            self.next_use[value as usize] = next;
            if next == NONE {
                if self.in_register(value) {
                    self.held[self.register_of[value as usize] as usize] = None;
                    self.register_of[value as usize] = NONE;
                }
                if let Some(Place::Spill(slot)) =
                    self.home[value as usize].take_if(|home| matches!(home, Place::Spill(_)))
                {
                    self.resting_spills.push(slot);
                }
            }
        }
    }

    fn define(&mut self, result: Value, register: u8) {
        if self.next_use[result as usize] != NONE {
            self.held[usize::from(register)] = Some(result);
            self.register_of[result as usize] = u32::from(register);
        }
    }

    /// Brings the operands into registers; at most one of the operands that may stay in memory stays there. Returns
    /// that operand and the registers in use.
    fn gather(
        &mut self,
        number: usize,
        operands: &[Value],
        staying: &[bool],
    ) -> (Option<Value>, u32) {
        let mut pinned = 0;
        for &value in operands {
            if self.in_register(value) {
                pinned |= 1 << self.register_of[value as usize];
            }
        }
        // The one whose next use is furthest stays, if any does.
        let mut stays: Option<(u32, Value)> = None;
        for (k, &value) in operands.iter().enumerate() {
            let once = operands.iter().filter(|&&other| other == value).count() == 1;
            let next = self.following[number][k];
            if staying[k]
                && once
                && !self.in_register(value)
                && self.may_stay(value)
                && stays.is_none_or(|(furthest, _)| next > furthest)
            {
                stays = Some((next, value));
            }
        }
        for &value in operands {
            if stays.is_none_or(|(_, stays)| stays != value) {
                pinned |= 1 << self.bring(value, pinned);
            }
        }
        if let Some((next, value)) = stays
            && self.pays(next, pinned)
        {
            pinned |= 1 << self.bring(value, pinned);
            stays = None;
        }
        (stays.map(|(_, value)| value), pinned)
    }

    fn source(&mut self, value: Value) -> Source {
        if self.in_register(value) {
            Source::Register(self.register_of[value as usize] as u8)
        } else {
            Source::Memory(self.memory(self.place_of(value)))
        }
    }

    fn register(&self, value: Value) -> u8 {
        self.register_of[value as usize] as u8
    }

    fn compute(
        &mut self,
        number: usize,
        operation: Operation,
        operands: [Value; 3],
        result: Value,
    ) {
        let [mut a, mut b, c] = operands;
        let (binary, commutes) = match operation {
            Operation::Fused(signs) => return self.fused(number, signs, [a, b, c], result),
            Operation::Add => (Binary::Add, true),
            Operation::Subtract => (Binary::Subtract, false),
            Operation::Multiply => (Binary::Multiply, true),
            Operation::Divide => (Binary::Divide, false),
            Operation::Xor => (Binary::Xor, true),
            Operation::Maximum => (Binary::Maximum, false),
        };
        let (stays, _) = self.gather(number, &[a, b], &[commutes, true]);
        if stays == Some(a) {
            (a, b) = (b, a);
        }
        let first = self.register(a);
        let second = self.source(b);
        self.release(number, &operands[..2]);
        // Whatever is given up here is written before the operands are read.
        let to = self.take(0);
        self.encoder.binary(binary, to, first, second);
        self.define(result, to);
    }

    /// `±a*b ± c`: the result takes the place of an operand that is needed no more.
    fn fused(&mut self, number: usize, signs: Signs, [a, b, c]: [Value; 3], result: Value) {
        let operands = [a, b, c];
        let (stays, pinned) = self.gather(number, &operands, &[true; 3]);
        let (a, b) = if stays == Some(a) { (b, a) } else { (a, b) };
        let dies = |this: &Self, value: Value| {
            let at = operands.iter().position(|&other| other == value);
            this.in_register(value) && at.is_some_and(|at| this.following[number][at] == NONE)
        };
        let form;
        let (to, first, last);
        if dies(self, c) && c != a && c != b {
            (form, to, first, last) = (
                Form::F231,
                self.register(c),
                self.register(a),
                self.source(b),
            );
        } else if dies(self, a) && a != c {
            let to_be = self.register(a);
            (form, to, first, last) = if self.in_register(b) {
                (Form::F213, to_be, self.register(b), self.source(c))
            } else {
                (Form::F132, to_be, self.register(c), self.source(b))
            };
        } else if dies(self, b) && b != c {
            (form, to, first, last) = (
                Form::F213,
                self.register(b),
                self.register(a),
                self.source(c),
            );
        } else if let Source::Memory(memory) = self.source(c) {
            let fresh = self.take(pinned);
            self.encoder.load(fresh, memory);
            (form, to, first, last) = (Form::F231, fresh, self.register(a), self.source(b));
        } else if let Source::Memory(memory) = self.source(b) {
            let fresh = self.take(pinned);
            self.encoder.load(fresh, memory);
            (form, to, first, last) = (Form::F213, fresh, self.register(a), self.source(c));
        } else {
            let fresh = self.take(pinned);
            self.encoder.copy(fresh, self.register(c));
            (form, to, first, last) = (Form::F231, fresh, self.register(a), self.source(b));
        }
        self.release(number, &operands);
        self.encoder.fused(form, signs, to, first, last);
        self.define(result, to);
    }

    fn store(&mut self, number: usize, value: Value, place: Place) {
        let register = self.bring(value, 0);
        let memory = self.memory(place);
        self.encoder.store(memory, register);
        self.home[value as usize].get_or_insert(place);
        self.release(number, &[value]);
    }

    /// The last step.
    fn less(&mut self, number: usize, operands: [Value; 2]) {
        self.gather(number, &operands, &[false; 2]);
        let [a, b] = operands.map(|value| self.register(value));
        self.encoder.less(a, b);
        self.release(number, &operands);
    }
}

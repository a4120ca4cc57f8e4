//! Encoder: vector instructions on doubles as bytes, EVEX for AVX-512 and VEX for AVX2 with FMA.
//!
//! Sources: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2, sections 2.3
//! (VEX) and 2.7 (EVEX), and the pages of the instructions; the tests hold bytes of GNU `as`.

/// Encoding of the instructions, which decides how wide a vector is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorSet {
    /// EVEX, vectors of 8 doubles, 32 registers, single doubles as operands of all lanes.
    Avx512,
    /// VEX, vectors of 4 doubles, 16 registers.
    Avx2,
}

impl VectorSet {
    /// Doubles of a vector.
    pub fn lanes(self) -> usize {
        match self {
            Self::Avx512 => 8,
            Self::Avx2 => 4,
        }
    }

    /// Bytes of a vector.
    pub fn bytes(self) -> usize {
        8 * self.lanes()
    }

    /// Number of vector registers.
    pub fn registers(self) -> usize {
        match self {
            Self::Avx512 => 32,
            Self::Avx2 => 16,
        }
    }
}

/// A general register that holds an address: the first six integer arguments of the System V
/// calling convention, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Base {
    /// `rdi`.
    First,
    /// `rsi`.
    Second,
    /// `rdx`.
    Third,
    /// `rcx`.
    Fourth,
    /// `r8`.
    Fifth,
    /// `r9`.
    Sixth,
}

impl Base {
    fn number(self) -> u8 {
        match self {
            Self::First => 7,
            Self::Second => 6,
            Self::Third => 2,
            Self::Fourth => 1,
            Self::Fifth => 8,
            Self::Sixth => 9,
        }
    }
}

/// A vector in memory, or with AVX-512 a double that serves all lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Holds the address.
    pub base: Base,
    /// Bytes to be added to it.
    pub displacement: i32,
    /// One double for all lanes (AVX-512 only).
    pub broadcast: bool,
}

/// The last operand of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A vector register.
    Register(u8),
    /// Memory.
    Memory(Memory),
}

/// `d = a op b`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// Exclusive or of the bits.
    Xor,
    /// `a` where `a > b`, else `b`, also where one is not a number.
    Maximum,
}

/// Order of the operands `d`, `a`, `b`: which are multiplied and which is added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `d = ±d*b ± a`.
    F132,
    /// `d = ±a*d ± b`.
    F213,
    /// `d = ±a*b ± d`.
    F231,
}

/// The signs of a fused multiply-add.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signs {
    /// The product is subtracted.
    pub product: bool,
    /// The addend is subtracted.
    pub addend: bool,
}

/// Opcode maps.
const MAP_0F: u8 = 1;
const MAP_0F38: u8 = 2;

/// Bytes of code under construction.
#[derive(Debug)]
pub struct Encoder {
    set: VectorSet,
    /// Bytes that are encoded so far.
    pub code: Vec<u8>,
}

impl Encoder {
    /// No code yet.
    pub fn new(set: VectorSet) -> Self {
        Self {
            set,
            code: Vec::new(),
        }
    }

    /// `register = source`, whole vectors or one double for all lanes.
    pub fn load(&mut self, register: u8, from: Memory) {
        if from.broadcast {
            // Here the broadcast is the instruction's own, not its operand's; its displacement
            // is counted in doubles all the same.
            self.vector(MAP_0F38, 0x19, register, 0, Source::Memory(from), true);
        } else {
            self.vector(MAP_0F, 0x10, register, 0, Source::Memory(from), false);
        }
    }

    /// `memory = register`.
    pub fn store(&mut self, to: Memory, register: u8) {
        self.vector(MAP_0F, 0x11, register, 0, Source::Memory(to), false);
    }

    /// `to = from`.
    pub fn copy(&mut self, to: u8, from: u8) {
        self.vector(MAP_0F, 0x28, to, 0, Source::Register(from), false);
    }

    /// `to = a op b`.
    pub fn binary(&mut self, operation: Binary, to: u8, a: u8, b: Source) {
        let opcode = match operation {
            Binary::Add => 0x58,
            Binary::Multiply => 0x59,
            Binary::Subtract => 0x5C,
            Binary::Divide => 0x5E,
            Binary::Xor => 0x57,
            Binary::Maximum => 0x5F,
        };
        self.vector(MAP_0F, opcode, to, a, b, false);
    }

    /// `to`, `a` and `b` multiplied and added as the form says, with one rounding.
    pub fn fused(&mut self, form: Form, signs: Signs, to: u8, a: u8, b: Source) {
        let form = match form {
            Form::F132 => 0x98,
            Form::F213 => 0xA8,
            Form::F231 => 0xB8,
        };
        let signs = match (signs.product, signs.addend) {
            (false, false) => 0,
            (false, true) => 2,
            (true, false) => 4,
            (true, true) => 6,
        };
        self.vector(MAP_0F38, form + signs, to, a, b, false);
    }

    /// `base += bytes`.
    pub fn advance(&mut self, base: Base, bytes: i32) {
        let number = base.number();
        self.code.extend([
            if number >= 8 { 0x49 } else { 0x48 },
            0x81,
            0xC0 | (number & 7),
        ]);
        self.code.extend(bytes.to_le_bytes());
    }

    /// Bit i of the result (`eax`) says whether `a < b` in lane i, which it is not where one of
    /// them is not a number. `a` is overwritten with AVX2.
    pub fn less(&mut self, a: u8, b: u8) {
        const LESS: u8 = 0x11;
        match self.set {
            VectorSet::Avx512 => {
                // Into mask register 1.
                self.vector(MAP_0F, 0xC2, 1, a, Source::Register(b), false);
                self.code.extend([LESS, 0xC5, 0xF8, 0x93, 0xC1]);
            }
            VectorSet::Avx2 => {
                self.vector(MAP_0F, 0xC2, a, a, Source::Register(b), false);
                self.code.push(LESS);
                self.vector(MAP_0F, 0x50, 0, 0, Source::Register(a), false);
            }
        }
    }

    /// Sets the result to 0.
    pub fn nothing(&mut self) {
        self.code.extend([0x31, 0xC0]);
    }

    /// Back to the caller, the upper halves of the registers clean.
    pub fn finish(&mut self) {
        self.code.extend([0xC5, 0xF8, 0x77, 0xC3]);
    }

    /// One instruction; `own_broadcast` for the one whose operand is a single double by itself.
    fn vector(&mut self, map: u8, opcode: u8, to: u8, a: u8, b: Source, own_broadcast: bool) {
        // Bits 3 and 4 of the last operand's register; a base has only the first.
        let (low, high) = match b {
            Source::Register(r) => (r >> 3 & 1, r >> 4 & 1),
            Source::Memory(m) => (m.base.number() >> 3 & 1, 0),
        };
        let inverted = |bit: u8, at: u8| (bit & 1 ^ 1) << at;
        match self.set {
            VectorSet::Avx512 => {
                let broadcast = matches!(b, Source::Memory(m) if m.broadcast && !own_broadcast);
                self.code.extend([
                    0x62,
                    inverted(to >> 3, 7)
                        | inverted(high, 6)
                        | inverted(low, 5)
                        | inverted(to >> 4, 4)
                        | map,
                    0x80 | (!a & 15) << 3 | 0b101,
                    0x40 | u8::from(broadcast) << 4 | inverted(a >> 4, 3),
                ]);
            }
            VectorSet::Avx2 => {
                let wide = map == MAP_0F38 && opcode != 0x19;
                self.code.extend([
                    0xC4,
                    inverted(to >> 3, 7) | inverted(high, 6) | inverted(low, 5) | map,
                    u8::from(wide) << 7 | (!a & 15) << 3 | 0b101,
                ]);
            }
        }
        self.code.push(opcode);
        let to = (to & 7) << 3;
        match b {
            Source::Register(r) => self.code.push(0xC0 | to | (r & 7)),
            Source::Memory(m) => {
                let base = m.base.number() & 7;
                let unit = match (self.set, m.broadcast) {
                    (VectorSet::Avx512, true) => 8,
                    (VectorSet::Avx512, false) => 64,
                    (VectorSet::Avx2, _) => 1,
                };
                let short = (m.displacement % unit == 0)
                    .then(|| i8::try_from(m.displacement / unit).ok())
                    .flatten();
                match short {
                    Some(0) => self.code.push(to | base),
                    Some(short) => self.code.extend([0x40 | to | base, short as u8]),
                    None => {
                        self.code.push(0x80 | to | base);
                        self.code.extend(m.displacement.to_le_bytes());
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(base: Base, displacement: i32) -> Memory {
        Memory {
            base,
            displacement,
            broadcast: false,
        }
    }

    fn single(displacement: i32) -> Source {
        Source::Memory(Memory {
            base: Base::Sixth,
            displacement,
            broadcast: true,
        })
    }

    fn signs(product: bool, addend: bool) -> Signs {
        Signs { product, addend }
    }

    /// As it is written, how it is emitted, and its bytes.
    type Case<'a> = (&'a str, &'a dyn Fn(&mut Encoder), &'a str);

    fn check(set: VectorSet, cases: &[Case<'_>]) {
        for (text, emit, expected) in cases {
            let mut encoder = Encoder::new(set);
            emit(&mut encoder);
            let bytes: Vec<String> = encoder.code.iter().map(|b| format!("{b:02x}")).collect();
            assert_eq!(&bytes.join(" "), expected, "{text}");
        }
    }

    #[test]
    fn evex_moves_are_what_an_assembler_makes_of_them() {
        check(
            VectorSet::Avx512,
            &[
                (
                    "vmovupd zmm0, [rdi]",
                    &|e| e.load(0, at(Base::First, 0)),
                    "62 f1 fd 48 10 07",
                ),
                (
                    "vmovupd zmm17, [rsi+64]",
                    &|e| e.load(17, at(Base::Second, 64)),
                    "62 e1 fd 48 10 4e 01",
                ),
                (
                    "vmovupd zmm31, [r8+8192]",
                    &|e| e.load(31, at(Base::Fifth, 8192)),
                    "62 41 fd 48 10 b8 00 20 00 00",
                ),
                (
                    "vmovupd [rcx-64], zmm9",
                    &|e| e.store(at(Base::Fourth, -64), 9),
                    "62 71 fd 48 11 49 ff",
                ),
                (
                    "vmovupd [r9+512], zmm30",
                    &|e| e.store(at(Base::Sixth, 512), 30),
                    "62 41 fd 48 11 71 08",
                ),
                (
                    "vmovapd zmm3, zmm29",
                    &|e| e.copy(3, 29),
                    "62 91 fd 48 28 dd",
                ),
                (
                    "vbroadcastsd zmm20, [r9+24]",
                    &|e| {
                        e.load(
                            20,
                            Memory {
                                broadcast: true,
                                ..at(Base::Sixth, 24)
                            },
                        )
                    },
                    "62 c2 fd 48 19 61 03",
                ),
            ],
        );
    }

    #[test]
    fn evex_arithmetic_is_what_an_assembler_makes_of_it() {
        use Source::{Memory as M, Register as R};
        check(
            VectorSet::Avx512,
            &[
                (
                    "vaddpd zmm1, zmm2, zmm3",
                    &|e| e.binary(Binary::Add, 1, 2, R(3)),
                    "62 f1 ed 48 58 cb",
                ),
                (
                    "vaddpd zmm18, zmm9, zmm27",
                    &|e| e.binary(Binary::Add, 18, 9, R(27)),
                    "62 81 b5 48 58 d3",
                ),
                (
                    "vsubpd zmm8, zmm16, [rdx+256]",
                    &|e| e.binary(Binary::Subtract, 8, 16, M(at(Base::Third, 256))),
                    "62 71 fd 40 5c 42 04",
                ),
                (
                    "vmulpd zmm15, zmm31, [r9+16]{1to8}",
                    &|e| e.binary(Binary::Multiply, 15, 31, single(16)),
                    "62 51 85 50 59 79 02",
                ),
                (
                    "vdivpd zmm1, zmm2, zmm19",
                    &|e| e.binary(Binary::Divide, 1, 2, R(19)),
                    "62 b1 ed 48 5e cb",
                ),
                (
                    "vxorpd zmm4, zmm5, [r9]{1to8}",
                    &|e| e.binary(Binary::Xor, 4, 5, single(0)),
                    "62 d1 d5 58 57 21",
                ),
                (
                    "vmaxpd zmm1, zmm18, zmm3",
                    &|e| e.binary(Binary::Maximum, 1, 18, R(3)),
                    "62 f1 ed 40 5f cb",
                ),
            ],
        );
    }

    #[test]
    fn evex_fused_arithmetic_is_what_an_assembler_makes_of_it() {
        use Source::{Memory as M, Register as R};
        check(
            VectorSet::Avx512,
            &[
                (
                    "vfmadd231pd zmm7, zmm6, zmm30",
                    &|e| e.fused(Form::F231, signs(false, false), 7, 6, R(30)),
                    "62 92 cd 48 b8 fe",
                ),
                (
                    "vfmadd213pd zmm7, zmm26, [rdi+4096]",
                    &|e| {
                        e.fused(
                            Form::F213,
                            signs(false, false),
                            7,
                            26,
                            M(at(Base::First, 4096)),
                        )
                    },
                    "62 f2 ad 40 a8 7f 40",
                ),
                (
                    "vfmadd132pd zmm17, zmm6, zmm3",
                    &|e| e.fused(Form::F132, signs(false, false), 17, 6, R(3)),
                    "62 e2 cd 48 98 cb",
                ),
                (
                    "vfmsub231pd zmm7, zmm6, zmm30",
                    &|e| e.fused(Form::F231, signs(false, true), 7, 6, R(30)),
                    "62 92 cd 48 ba fe",
                ),
                (
                    "vfnmadd231pd zmm7, zmm6, [rsi+7]",
                    &|e| e.fused(Form::F231, signs(true, false), 7, 6, M(at(Base::Second, 7))),
                    "62 f2 cd 48 bc be 07 00 00 00",
                ),
                (
                    "vfnmsub231pd zmm7, zmm6, [r9+2048]{1to8}",
                    &|e| e.fused(Form::F231, signs(true, true), 7, 6, single(2048)),
                    "62 d2 cd 58 be b9 00 08 00 00",
                ),
                (
                    "vfmsub213pd zmm1, zmm2, zmm3",
                    &|e| e.fused(Form::F213, signs(false, true), 1, 2, R(3)),
                    "62 f2 ed 48 aa cb",
                ),
                (
                    "vfnmadd132pd zmm1, zmm2, zmm3",
                    &|e| e.fused(Form::F132, signs(true, false), 1, 2, R(3)),
                    "62 f2 ed 48 9c cb",
                ),
            ],
        );
    }

    #[test]
    fn evex_control_is_what_an_assembler_makes_of_it() {
        check(
            VectorSet::Avx512,
            &[
                (
                    "add rcx, 8192",
                    &|e| e.advance(Base::Fourth, 8192),
                    "48 81 c1 00 20 00 00",
                ),
                (
                    "add r8, 8192",
                    &|e| e.advance(Base::Fifth, 8192),
                    "49 81 c0 00 20 00 00",
                ),
                (
                    "vcmplt_oqpd k1, zmm17, zmm30; kmovw eax, k1",
                    &|e| e.less(17, 30),
                    "62 91 f5 40 c2 ce 11 c5 f8 93 c1",
                ),
                ("xor eax, eax", &|e| e.nothing(), "31 c0"),
                ("vzeroupper; ret", &|e| e.finish(), "c5 f8 77 c3"),
            ],
        );
    }

    #[test]
    fn vex_moves_are_what_an_assembler_makes_of_them() {
        check(
            VectorSet::Avx2,
            &[
                (
                    "vmovupd ymm0, [rdi]",
                    &|e| e.load(0, at(Base::First, 0)),
                    "c4 e1 7d 10 07",
                ),
                (
                    "vmovupd ymm12, [r8+32]",
                    &|e| e.load(12, at(Base::Fifth, 32)),
                    "c4 41 7d 10 60 20",
                ),
                (
                    "vmovupd [rcx+4096], ymm9",
                    &|e| e.store(at(Base::Fourth, 4096), 9),
                    "c4 61 7d 11 89 00 10 00 00",
                ),
                ("vmovapd ymm3, ymm13", &|e| e.copy(3, 13), "c4 c1 7d 28 dd"),
                (
                    "vbroadcastsd ymm11, [r9+24]",
                    &|e| {
                        e.load(
                            11,
                            Memory {
                                broadcast: true,
                                ..at(Base::Sixth, 24)
                            },
                        )
                    },
                    "c4 42 7d 19 59 18",
                ),
            ],
        );
    }

    #[test]
    fn vex_arithmetic_is_what_an_assembler_makes_of_it() {
        use Source::{Memory as M, Register as R};
        check(
            VectorSet::Avx2,
            &[
                (
                    "vaddpd ymm1, ymm2, ymm13",
                    &|e| e.binary(Binary::Add, 1, 2, R(13)),
                    "c4 c1 6d 58 cd",
                ),
                (
                    "vsubpd ymm8, ymm14, [r9+32]",
                    &|e| e.binary(Binary::Subtract, 8, 14, M(at(Base::Sixth, 32))),
                    "c4 41 0d 5c 41 20",
                ),
                (
                    "vmulpd ymm8, ymm14, ymm7",
                    &|e| e.binary(Binary::Multiply, 8, 14, R(7)),
                    "c4 61 0d 59 c7",
                ),
                (
                    "vdivpd ymm8, ymm4, ymm7",
                    &|e| e.binary(Binary::Divide, 8, 4, R(7)),
                    "c4 61 5d 5e c7",
                ),
                (
                    "vmaxpd ymm1, ymm2, ymm13",
                    &|e| e.binary(Binary::Maximum, 1, 2, R(13)),
                    "c4 c1 6d 5f cd",
                ),
                (
                    "vxorpd ymm4, ymm5, [r9]",
                    &|e| e.binary(Binary::Xor, 4, 5, M(at(Base::Sixth, 0))),
                    "c4 c1 55 57 21",
                ),
            ],
        );
    }

    #[test]
    fn vex_fused_arithmetic_is_what_an_assembler_makes_of_it() {
        use Source::{Memory as M, Register as R};
        check(
            VectorSet::Avx2,
            &[
                (
                    "vfmadd231pd ymm7, ymm6, ymm10",
                    &|e| e.fused(Form::F231, signs(false, false), 7, 6, R(10)),
                    "c4 c2 cd b8 fa",
                ),
                (
                    "vfmadd213pd ymm7, ymm12, [rdi+4096]",
                    &|e| {
                        e.fused(
                            Form::F213,
                            signs(false, false),
                            7,
                            12,
                            M(at(Base::First, 4096)),
                        )
                    },
                    "c4 e2 9d a8 bf 00 10 00 00",
                ),
                (
                    "vfnmsub132pd ymm9, ymm6, [r8+32]",
                    &|e| e.fused(Form::F132, signs(true, true), 9, 6, M(at(Base::Fifth, 32))),
                    "c4 42 cd 9e 48 20",
                ),
                (
                    "vfmsub231pd ymm9, ymm6, ymm1",
                    &|e| e.fused(Form::F231, signs(false, true), 9, 6, R(1)),
                    "c4 62 cd ba c9",
                ),
                (
                    "vfnmadd231pd ymm9, ymm6, [rdx-128]",
                    &|e| {
                        e.fused(
                            Form::F231,
                            signs(true, false),
                            9,
                            6,
                            M(at(Base::Third, -128)),
                        )
                    },
                    "c4 62 cd bc 4a 80",
                ),
            ],
        );
    }

    #[test]
    fn vex_control_is_what_an_assembler_makes_of_it() {
        check(
            VectorSet::Avx2,
            &[(
                "vcmplt_oqpd ymm12, ymm12, ymm3; vmovmskpd eax, ymm12",
                &|e| e.less(12, 3),
                "c4 61 1d c2 e3 11 c4 c1 7d 50 c4",
            )],
        );
    }
}

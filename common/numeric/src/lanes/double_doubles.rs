//! Lanes of double-doubles whose operations are functions of their own.
//!
//! One multiply-add of eight double-doubles is hundreds of instructions before they become vectors.
//! Inlined wherever it is used, it multiplies the time that a tracker takes to compile by ten; called, it
//! costs a few nanoseconds more. Each operation is compiled once for each instruction set, which is a
//! part of the type.

use super::dispatch::{CompiledSet, Job};
use super::{LaneMask, Lanes};
use crate::rational::Rational;
use crate::scalar::{Complex, DoubleDouble, Real};
use std::marker::PhantomData;

/// Numbers of so many paths.
pub const WIDTH: usize = 8;

type Single = DoubleDouble<f64>;
type Eight = DoubleDouble<Lanes<WIDTH>>;

/// A double-double in each of eight lanes, for the instruction set `S`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct DoubleDoubleLanes<S> {
    number: Eight,
    set: PhantomData<S>,
}

impl<S> From<Eight> for DoubleDoubleLanes<S> {
    #[inline(always)]
    fn from(number: Eight) -> Self {
        Self {
            number,
            set: PhantomData,
        }
    }
}

/// Operations of [`Real`] that change a number in place, as work of their own.
macro_rules! operations {
    ($($job:ident: $method:ident($($argument:ident: $type:ty),*);)*) => {$(
        struct $job<'a> {
            number: &'a mut Eight,
            $($argument: &'a $type),*
        }

        impl Job for $job<'_> {
            type Output = ();
            #[inline(always)]
            fn run(self) {
                self.number.$method($(self.$argument),*);
            }
        }
    )*};
}

operations! {
    Add: add(other: Eight);
    Sub: sub(other: Eight);
    Mul: mul(other: Eight);
    Div: div(other: Eight);
    MulAdd: mul_add(a: Eight, b: Eight);
    MulSub: mul_sub(a: Eight, b: Eight);
    MulSingle: mul_single(c: Single);
    MulAddSingle: mul_add_single(c: Single, a: Eight);
    MulSubSingle: mul_sub_single(c: Single, a: Eight);
    Abs: abs();
    Sqrt: sqrt();
}

impl<S: CompiledSet> Complex<DoubleDoubleLanes<S>> {
    /// The number in one lane, with all its digits.
    #[inline(always)]
    pub fn single(&self, lane: usize) -> Complex<Single> {
        Complex {
            re: self.re.number.single(lane),
            im: self.im.number.single(lane),
        }
    }
}

impl<S: CompiledSet> DoubleDoubleLanes<S> {
    /// `self - other`.
    #[inline(always)]
    fn difference(&self, other: &Self) -> Lanes<WIDTH> {
        let mut difference = *self;
        difference.sub(other);
        difference.control()
    }
}

impl<S: CompiledSet> Real for DoubleDoubleLanes<S> {
    type Context = ();
    type Mask = LaneMask<WIDTH>;
    type Control = Lanes<WIDTH>;
    type Single = Single;
    const WIDTH: usize = WIDTH;

    #[inline(always)]
    fn from_f64(_: (), value: f64) -> Self {
        Eight::from_f64((), value).into()
    }
    fn from_rational(_: (), value: &Rational) -> Self {
        Eight::from_rational((), value).into()
    }
    #[inline(always)]
    fn from_control(_: (), value: &Lanes<WIDTH>) -> Self {
        Eight::from_control((), value).into()
    }
    fn bits(_: ()) -> u32 {
        Eight::bits(())
    }
    #[inline(always)]
    fn context(&self) -> Self::Context {}
    #[inline(always)]
    fn set(&mut self, other: &Self) {
        *self = *other;
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.number.set_lane(lane, value);
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.number.lane(lane)
    }
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        S::call(Add {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        S::call(Sub {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn mul(&mut self, other: &Self) {
        S::call(Mul {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn div(&mut self, other: &Self) {
        S::call(Div {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        S::call(MulAdd {
            number: &mut self.number,
            a: &a.number,
            b: &b.number,
        });
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        S::call(MulSub {
            number: &mut self.number,
            a: &a.number,
            b: &b.number,
        });
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &Single) {
        S::call(MulSingle {
            number: &mut self.number,
            c,
        });
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &Single, a: &Self) {
        S::call(MulAddSingle {
            number: &mut self.number,
            c,
            a: &a.number,
        });
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &Single, a: &Self) {
        S::call(MulSubSingle {
            number: &mut self.number,
            c,
            a: &a.number,
        });
    }
    #[inline(always)]
    fn neg(&mut self) {
        self.number.neg();
    }
    #[inline(always)]
    fn abs(&mut self) {
        S::call(Abs {
            number: &mut self.number,
        });
    }
    #[inline(always)]
    fn sqrt(&mut self) {
        S::call(Sqrt {
            number: &mut self.number,
        });
    }
    #[inline(always)]
    fn less(&self, other: &Self) -> Self::Mask {
        self.difference(other).less(&Lanes([0.0; WIDTH]))
    }
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> Self::Mask {
        self.difference(other).less_equal(&Lanes([0.0; WIDTH]))
    }
    #[inline(always)]
    fn select(&mut self, mask: Self::Mask, other: &Self) {
        self.number.select(mask, &other.number);
    }
    #[inline(always)]
    fn control(&self) -> Self::Control {
        self.number.control()
    }
    #[inline(always)]
    fn swap_lane(&mut self, other: &mut Self, lane: usize) {
        self.number.swap_lane(&mut other.number, lane);
    }
}

#[cfg(test)]
mod tests {
    use super::super::dispatch::{InstructionSet, JobOfSet, dispatch_set};
    use super::*;
    use crate::random::{Purpose, RandomStream};
    use crate::scalar::Mask;

    /// Some operations of each kind on numbers of a stream.
    struct Formula;

    fn value<R: Real<Context = ()>>() -> Vec<f64> {
        let mut stream = RandomStream::new(5, Purpose::Test, 0);
        let mut number = || {
            let mut x = R::from_f64((), 1.0);
            for lane in 0..R::WIDTH {
                x.set_lane(lane, 1.0 + stream.uniform());
            }
            x
        };
        let (a, b, mut r) = (number(), number(), number());
        let third = R::Single::from_rational((), &Rational::from((1, 3)));
        r.div(&a);
        r.mul_add(&a, &b);
        r.mul_sub(&b, &b);
        r.mul_single(&third);
        r.mul_add_single(&third, &a);
        r.mul_sub_single(&third, &b);
        r.abs();
        r.sqrt();
        r.add(&a);
        let greater = r.less(&b).or(b.less_equal(&r).not());
        r.select(greater, &b);
        r.neg();
        let mut low = r.clone();
        low.sub(&R::from_control((), &r.control()));
        let lanes = 0..R::WIDTH;
        lanes.flat_map(|k| [r.lane(k), low.lane(k)]).collect()
    }

    impl JobOfSet for Formula {
        type Output = Vec<f64>;
        #[inline(always)]
        fn run<S: CompiledSet>(self) -> Vec<f64> {
            value::<DoubleDoubleLanes<S>>()
        }
    }

    #[test]
    fn functions_give_the_bits_of_what_they_are_made_of() {
        let expected = value::<Eight>();
        for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
            assert_eq!(dispatch_set(set, Formula), expected, "{}", set.name());
        }
    }
}

//! Numbers in lanes whose operations are functions of their own.
//!
//! One multiply-add of eight double-doubles is hundreds of instructions before they become vectors, and one of
//! eight balls is dozens. Inlined wherever it is used, it multiplies the time that what uses it takes to compile,
//! and its size, by ten; called, it costs a few nanoseconds more. Each operation is compiled once for each
//! instruction set, and each call takes the one of this machine.

use super::Lanes;
use super::dispatch::{Job, call};
use crate::rational::Rational;
use crate::scalar::{
    Ball, Complex, DoubleDouble, Real, add_product, set_product, subtract_product,
};

/// Number of paths in one vector of lanes.
pub const WIDTH: usize = 8;

/// A double-double in each of eight lanes.
pub type DoubleDoubleLanes = Called<DoubleDouble<Lanes<WIDTH>>>;
/// A ball in each of eight lanes.
pub type BallLanes = Called<Ball<Lanes<WIDTH>>>;

/// Numbers `N` in eight lanes, whose operations are functions for the instruction set of this machine.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Called<N> {
    number: N,
}

impl<N> Called<N> {
    /// This number, with operations that are called.
    #[inline(always)]
    pub fn new(number: N) -> Self {
        Self { number }
    }

    /// The number as it is.
    #[inline(always)]
    pub fn number(&self) -> &N {
        &self.number
    }
}

/// Operations of [`Real`] as work of their own.
macro_rules! operations {
    ($($job:ident: $method:ident($($argument:ident: $type:ty),*);)*) => {$(
        struct $job<'a, N: Real> {
            number: &'a mut N,
            $($argument: &'a $type),*
        }

        impl<N: Real> Job for $job<'_, N> {
            type Output = ();
            #[inline(always)]
            fn run(self) {
                self.number.$method($(self.$argument),*);
            }
        }
    )*};
}

operations! {
    Add: add(other: N);
    Sub: sub(other: N);
    Mul: mul(other: N);
    Div: div(other: N);
    MulAdd: mul_add(a: N, b: N);
    MulSub: mul_sub(a: N, b: N);
    MulSingle: mul_single(c: N::Single);
    MulAddSingle: mul_add_single(c: N::Single, a: N);
    MulSubSingle: mul_sub_single(c: N::Single, a: N);
    Abs: abs();
    Sqrt: sqrt();
}

/// Products of complex numbers as work of their own.
macro_rules! products {
    ($($job:ident: $function:ident;)*) => {$(
        struct $job<'a, N: Real> {
            re: &'a mut N,
            im: &'a mut N,
            a: [&'a N; 2],
            b: [&'a N; 2],
        }

        impl<N: Real> Job for $job<'_, N> {
            type Output = ();
            #[inline(always)]
            fn run(self) {
                $function(self.re, self.im, self.a, self.b);
            }
        }
    )*};
}

products! {
    SetProduct: set_product;
    AddProduct: add_product;
    SubtractProduct: subtract_product;
}

/// A comparison as work of its own.
struct Less<'a, N> {
    a: &'a N,
    b: &'a N,
    or_equal: bool,
}

impl<N: Real> Job for Less<'_, N> {
    type Output = N::Mask;
    #[inline(always)]
    fn run(self) -> N::Mask {
        if self.or_equal {
            self.a.less_equal(self.b)
        } else {
            self.a.less(self.b)
        }
    }
}

impl Complex<DoubleDoubleLanes> {
    /// The number in one lane, with all its digits.
    #[inline(always)]
    pub fn single(&self, lane: usize) -> Complex<DoubleDouble<f64>> {
        Complex {
            re: self.re.number.single(lane),
            im: self.im.number.single(lane),
        }
    }
}

impl<N: Real + Copy> Real for Called<N> {
    type Context = N::Context;
    type Mask = N::Mask;
    type Control = N::Control;
    type Single = N::Single;
    const WIDTH: usize = N::WIDTH;
    const ENCLOSES: bool = N::ENCLOSES;

    #[inline(always)]
    fn from_f64(context: N::Context, value: f64) -> Self {
        Self::new(N::from_f64(context, value))
    }
    fn from_rational(context: N::Context, value: &Rational) -> Self {
        Self::new(N::from_rational(context, value))
    }
    fn between(context: N::Context, lower: &Rational, upper: &Rational) -> Self {
        Self::new(N::between(context, lower, upper))
    }
    #[inline(always)]
    fn from_control(context: N::Context, value: &N::Control) -> Self {
        Self::new(N::from_control(context, value))
    }
    fn bits(context: N::Context) -> u32 {
        N::bits(context)
    }
    #[inline(always)]
    fn context(&self) -> N::Context {
        self.number.context()
    }
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
        call(Add {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn sub(&mut self, other: &Self) {
        call(Sub {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn mul(&mut self, other: &Self) {
        call(Mul {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn div(&mut self, other: &Self) {
        call(Div {
            number: &mut self.number,
            other: &other.number,
        });
    }
    #[inline(always)]
    fn mul_add(&mut self, a: &Self, b: &Self) {
        call(MulAdd {
            number: &mut self.number,
            a: &a.number,
            b: &b.number,
        });
    }
    #[inline(always)]
    fn mul_sub(&mut self, a: &Self, b: &Self) {
        call(MulSub {
            number: &mut self.number,
            a: &a.number,
            b: &b.number,
        });
    }
    #[inline(always)]
    fn set_product(sum: &mut Complex<Self>, a: &Complex<Self>, b: &Complex<Self>) {
        call(SetProduct {
            re: &mut sum.re.number,
            im: &mut sum.im.number,
            a: [&a.re.number, &a.im.number],
            b: [&b.re.number, &b.im.number],
        });
    }
    #[inline(always)]
    fn add_product(sum: &mut Complex<Self>, a: &Complex<Self>, b: &Complex<Self>) {
        call(AddProduct {
            re: &mut sum.re.number,
            im: &mut sum.im.number,
            a: [&a.re.number, &a.im.number],
            b: [&b.re.number, &b.im.number],
        });
    }
    #[inline(always)]
    fn subtract_product(sum: &mut Complex<Self>, a: &Complex<Self>, b: &Complex<Self>) {
        call(SubtractProduct {
            re: &mut sum.re.number,
            im: &mut sum.im.number,
            a: [&a.re.number, &a.im.number],
            b: [&b.re.number, &b.im.number],
        });
    }
    #[inline(always)]
    fn mul_single(&mut self, c: &N::Single) {
        call(MulSingle {
            number: &mut self.number,
            c,
        });
    }
    #[inline(always)]
    fn mul_add_single(&mut self, c: &N::Single, a: &Self) {
        call(MulAddSingle {
            number: &mut self.number,
            c,
            a: &a.number,
        });
    }
    #[inline(always)]
    fn mul_sub_single(&mut self, c: &N::Single, a: &Self) {
        call(MulSubSingle {
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
        call(Abs {
            number: &mut self.number,
        });
    }
    #[inline(always)]
    fn sqrt(&mut self) {
        call(Sqrt {
            number: &mut self.number,
        });
    }
    #[inline(always)]
    fn less(&self, other: &Self) -> N::Mask {
        call(Less {
            a: &self.number,
            b: &other.number,
            or_equal: false,
        })
    }
    #[inline(always)]
    fn less_equal(&self, other: &Self) -> N::Mask {
        call(Less {
            a: &self.number,
            b: &other.number,
            or_equal: true,
        })
    }
    #[inline(always)]
    fn select(&mut self, mask: N::Mask, other: &Self) {
        self.number.select(mask, &other.number);
    }
    #[inline(always)]
    fn control(&self) -> N::Control {
        self.number.control()
    }
    #[inline(always)]
    fn swap_lane(&mut self, other: &mut Self, lane: usize) {
        self.number.swap_lane(&mut other.number, lane);
    }
    #[inline(always)]
    fn max(&mut self, other: &Self) {
        self.number.max(&other.number);
    }
    #[inline(always)]
    fn min(&mut self, other: &Self) {
        self.number.min(&other.number);
    }
}

#[cfg(test)]
mod tests {
    use super::super::dispatch::{InstructionSet, limited_to};
    use super::*;
    use crate::random::{Purpose, RandomStream};
    use crate::scalar::Mask;

    /// Some operations of each kind on numbers of a stream.
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
        let mut complex = Complex {
            re: r.clone(),
            im: a.clone(),
        };
        let other = Complex {
            re: b.clone(),
            im: r.clone(),
        };
        complex.mul(&other);
        complex.mul_add(&other, &other);
        complex.mul_sub(&other, &complex.clone());
        r.add(&complex.re);
        r.sub(&complex.im);
        r.neg();
        let mut low = r.clone();
        low.sub(&R::from_control((), &r.control()));
        let lanes = 0..R::WIDTH;
        lanes.flat_map(|k| [r.lane(k), low.lane(k)]).collect()
    }

    fn check<N: Real<Context = ()> + Copy>() {
        let expected = value::<N>();
        for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
            let values = limited_to(set, value::<Called<N>>);
            assert_eq!(values, expected, "{}", set.name());
        }
    }

    #[test]
    fn functions_give_the_bits_of_what_they_are_made_of() {
        check::<DoubleDouble<Lanes<WIDTH>>>();
        check::<Ball<Lanes<WIDTH>>>();
    }
}

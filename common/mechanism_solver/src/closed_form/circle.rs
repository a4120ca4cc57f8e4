//! Functions on the circle of turns, and their zeros: a linear one has two (subproblem 4 of A. Elias and J. T. Wen,
//! arXiv:2211.05737), a quadratic one four.

use super::quartic;
use super::turn::{NEAR_FOLD, Turn};
use num_complex::Complex64;

/// Moduli that differ from 1 by less than this are those of real turns: rounding of roots that are apart is far below.
const REAL: f64 = 1e-8;
/// Roots that are nearer to each other than this may be one.
const APART: f64 = 1e-5;

/// A real linear function of cosine and sine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linear {
    /// The constant.
    pub one: f64,
    /// The factor of the cosine.
    pub c: f64,
    /// The factor of the sine.
    pub s: f64,
}

impl Linear {
    /// A constant.
    pub fn constant(one: f64) -> Self {
        Self {
            one,
            ..Self::default()
        }
    }

    /// The value at a turn.
    pub fn at(&self, turn: &Turn) -> Complex64 {
        turn.c * self.c + turn.s * self.s + self.one
    }

    /// A multiple.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            one: self.one * factor,
            c: self.c * factor,
            s: self.s * factor,
        }
    }

    /// The sum with another.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            one: self.one + other.one,
            c: self.c + other.c,
            s: self.s + other.s,
        }
    }

    /// The square.
    pub fn square(&self) -> Quadratic {
        let Self { one, c, s } = *self;
        Quadratic {
            linear: Self {
                one: one * one,
                c: 2.0 * one * c,
                s: 2.0 * one * s,
            },
            cc: c * c,
            cs: 2.0 * c * s,
            ss: s * s,
        }
    }

    /// The two turns at which it is 0; `None` where it is nearly constant or they are nearly one.
    pub fn zeros(&self) -> Option<[Turn; 2]> {
        let Self { one, c, s } = *self;
        let square = c * c + s * s;
        let rest = square - one * one;
        if square <= NEAR_FOLD * (one * one).max(NEAR_FOLD) || rest.abs() <= NEAR_FOLD * square {
            return None;
        }
        let root = super::turn::square_root(rest.into());
        let turn = |root: Complex64| Turn {
            c: (-c * one - s * root) / square,
            s: (-s * one + c * root) / square,
        };
        Some([turn(root), turn(-root)])
    }
}

/// A real quadratic function of cosine and sine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quadratic {
    /// The part of lower degree.
    pub linear: Linear,
    /// The factor of the cosine's square.
    pub cc: f64,
    /// The factor of cosine times sine.
    pub cs: f64,
    /// The factor of the sine's square.
    pub ss: f64,
}

impl Quadratic {
    /// The sum of this one and `factor` times the other.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        Self {
            linear: self.linear.plus(&other.linear.times(factor)),
            cc: self.cc + factor * other.cc,
            cs: self.cs + factor * other.cs,
            ss: self.ss + factor * other.ss,
        }
    }

    /// A multiple.
    pub fn times(&self, factor: f64) -> Self {
        Self::default().plus(factor, self)
    }

    /// The value at a turn.
    pub fn at(&self, turn: &Turn) -> Complex64 {
        let (c, s) = (turn.c, turn.s);
        self.linear.at(turn) + c * c * self.cc + c * s * self.cs + s * s * self.ss
    }

    /// The four turns at which it is 0; `None` where there are fewer, or two are nearly one.
    ///
    /// With w = c + i s the cosine is (w + 1/w)/2 and the sine (w - 1/w)/2i: a polynomial of degree 4, whose roots of
    /// modulus 1 are the real turns.
    pub fn zeros(&self) -> Option<[Turn; 4]> {
        let Linear { one, c, s } = self.linear;
        let second = Complex64::new(self.cc - self.ss, -self.cs) / 4.0;
        let first = Complex64::new(c, -s) / 2.0;
        let middle = Complex64::new(one + (self.cc + self.ss) / 2.0, 0.0);
        let roots = quartic::roots(&[second.conj(), first.conj(), middle, first, second])?;
        for (k, root) in roots.iter().enumerate() {
            let border = APART * (1.0 + root.norm_sqr().sqrt());
            let mut others = roots[..k].iter();
            if others.any(|other| (root - other).norm_sqr() < border * border) {
                return None;
            }
        }
        Some(roots.map(turn))
    }
}

/// The turn of a root w = c + i s.
fn turn(w: Complex64) -> Turn {
    let size = w.norm_sqr().sqrt();
    if (size - 1.0).abs() < REAL {
        return Turn {
            c: (w.re / size).into(),
            s: (w.im / size).into(),
        };
    }
    let over = 1.0 / w;
    let twice = w - over;
    Turn {
        c: (w + over) / 2.0,
        s: Complex64::new(twice.im / 2.0, -twice.re / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    #[test]
    fn zeros_are_turns_at_which_functions_vanish() {
        let mut random = RandomStream::new(1, Purpose::Test, 72);
        let mut linear = || {
            let mut uniform = || 2.0 * random.uniform() - 1.0;
            Linear {
                one: uniform(),
                c: uniform(),
                s: uniform(),
            }
        };
        let is_turn = |turn: &Turn| {
            let size = turn.size();
            (turn.c * turn.c + turn.s * turn.s - 1.0).norm_sqr().sqrt() < 1e-12 * size * size
        };
        let (mut real, mut of_four) = (0, 0);
        for _ in 0..500 {
            let (first, second, third) = (linear(), linear(), linear());
            for turn in first.zeros().expect("two zeros") {
                assert!(is_turn(&turn) && first.at(&turn).norm_sqr() < 1e-24 * turn.size());
                assert_eq!(
                    turn.imaginary() == 0.0,
                    first.one.abs() < (first.c * first.c + first.s * first.s).sqrt()
                );
            }
            let conic = first
                .square()
                .plus(0.7, &second.square())
                .plus(-0.9, &third.square());
            let Some(zeros) = conic.zeros() else {
                continue;
            };
            of_four += 1;
            for turn in zeros {
                let size = turn.size();
                assert!(is_turn(&turn) && conic.at(&turn).norm_sqr().sqrt() < 1e-10 * size * size);
                real += usize::from(turn.imaginary() == 0.0);
            }
        }
        assert!(of_four > 490 && real > 500, "{of_four} {real}");
    }

    #[test]
    fn zeros_that_meet_are_refused() {
        let line = |one| Linear {
            one,
            c: 0.6,
            s: 0.8,
        };
        assert!(line(1.0 - 1e-12).zeros().is_none() && line(0.9).zeros().is_some());
        assert!(line(0.3).square().zeros().is_none());
        assert!(Linear::constant(0.2).zeros().is_none());
    }
}

//! TwoCircles: a turn and a vector of the plane, of which three equations are given. Arms whose last axes meet, and arms with
//! parallel axes, come down to it.

use super::circle::{Linear, Quadratic};
use super::turn::{NEAR_FOLD, Turn, square_root};
use num_complex::Complex64;

/// A factor below this is 0: of rounded lengths, in parts of the arm's size.
const ROUNDING: f64 = 1e-11;

/// Equations `a x = f`, `b y = g`, `x^2 + y^2 = h` with functions f, g, h of a turn: two circles in general position
/// (D. L. Pieper 1968; subproblems 5 and 6 of A. Elias and J. T. Wen, arXiv:2211.05737).
#[derive(Clone, Debug, PartialEq)]
pub struct TwoCircles {
    /// The factor a and the function f.
    pub first: (f64, Linear),
    /// The factor b and the function g.
    pub second: (f64, Linear),
    /// The function h.
    pub square: Quadratic,
}

/// A solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The turn.
    pub turn: Turn,
    /// The vector (x, y).
    pub vector: [Complex64; 2],
}

impl TwoCircles {
    /// The four solutions; `None` where two are nearly one, or there are fewer or more.
    pub fn meetings(&self) -> Option<[Meeting; 4]> {
        let ((a, f), (b, g)) = (&self.first, &self.second);
        match [a, b].map(|factor| factor.abs() <= ROUNDING) {
            [true, true] => None,
            [true, false] => self.on_line(f, |turn| [None, Some(g.at(turn) / *b)]),
            [false, true] => self.on_line(g, |turn| [Some(f.at(turn) / *a), None]),
            [false, false] => {
                let conic = f.square().times(b * b);
                let conic = conic.plus(a * a, &g.square());
                let zeros = conic.plus(-a * a * b * b, &self.square).zeros()?;
                Some(zeros.map(|turn| Meeting {
                    turn,
                    vector: [f.at(&turn) / *a, g.at(&turn) / *b],
                }))
            }
        }
    }

    /// The solutions where one function is 0, which gives two turns: the other gives one part of the vector, and the square
    /// the part that is `None`, up to its sign.
    fn on_line(
        &self,
        line: &Linear,
        parts: impl Fn(&Turn) -> [Option<Complex64>; 2],
    ) -> Option<[Meeting; 4]> {
        let meetings = |turn: Turn| {
            let parts = parts(&turn);
            let given = parts[0].or(parts[1])?;
            let square = self.square.at(&turn) - given * given;
            if square.norm_sqr() <= NEAR_FOLD * NEAR_FOLD {
                return None;
            }
            let root = square_root(square);
            Some([root, -root].map(|root| Meeting {
                turn,
                vector: parts.map(|part| part.unwrap_or(root)),
            }))
        };
        let [first, second] = line.zeros()?;
        let ([a, b], [c, d]) = (meetings(first)?, meetings(second)?);
        Some([a, b, c, d])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    /// Each solution solves the equations; those with a factor 0 are limits of the others.
    #[test]
    fn meetings_solve_their_equations() {
        let mut random = RandomStream::new(1, Purpose::Test, 73);
        let mut uniform = || 2.0 * random.uniform() - 1.0;
        for n in 0..300 {
            let mut linear = || Linear {
                one: uniform(),
                c: uniform(),
                s: uniform(),
            };
            let circles = TwoCircles {
                first: (if n % 3 == 0 { 0.0 } else { 0.4 }, linear()),
                second: (if n % 3 == 1 { 0.0 } else { 0.7 }, linear()),
                square: linear().square().plus(-0.5, &linear().square()),
            };
            let Some(meetings) = circles.meetings() else {
                continue;
            };
            for Meeting { turn, vector } in meetings {
                let [x, y] = vector;
                let gaps = [
                    x * circles.first.0 - circles.first.1.at(&turn),
                    y * circles.second.0 - circles.second.1.at(&turn),
                    x * x + y * y - circles.square.at(&turn),
                ];
                let size = turn.size() * turn.size();
                assert!(
                    gaps.iter().all(|gap| gap.norm_sqr().sqrt() < 1e-10 * size),
                    "{n}: {gaps:?}"
                );
            }
        }
    }

    #[test]
    fn two_functions_without_a_vector_are_refused() {
        let line = Linear {
            one: 0.1,
            c: 0.6,
            s: 0.8,
        };
        let circles = TwoCircles {
            first: (0.0, line),
            second: (0.0, line),
            square: Quadratic::default(),
        };
        assert_eq!(circles.meetings(), None);
    }
}

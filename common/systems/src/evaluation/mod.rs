//! Evaluate: values and derivatives of a system at a point, for any scalar and any width.
//!
//! [`Interpreter`] is what trackers use, [`Reference`] the slow and plain one
//! that says what its bits must be, [`conformance`] the suite for both and for
//! whatever evaluator comes later.

pub mod conformance;
mod direct;
mod interpreter;
mod reference;

pub use direct::{enclosed, values};
pub use interpreter::{Interpreter, Program, Scratch};
pub use reference::Reference;

use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};

/// Sizes of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Number of variables.
    pub variables: usize,
    /// Number of parameters.
    pub parameters: usize,
    /// Number of equations.
    pub equations: usize,
}

/// F(x; p) with its derivatives. Parameters are inputs, one value per lane.
pub trait Evaluate<R: Real>: Send + Sync {
    /// Work space: made once, after which no call allocates.
    type Scratch: Send;
    /// Sizes of the system.
    fn shape(&self) -> Shape;
    /// Work space for numbers of this context, with the constants rounded to it.
    fn scratch(&self, context: R::Context) -> Self::Scratch;
    /// [J | H | H_t], straight into the elimination's buffer: `out` has a row
    /// for each equation and `variables + 2` columns; column `variables` is H,
    /// column `variables + 1` is dH/dp * dp.
    fn linearize(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        dp: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Self::Scratch,
    );
    /// [J | H] alone: the same bits in these columns of `out`, and what was in the last one stays.
    fn jacobian(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Self::Scratch,
    );
    /// H alone, by its own shorter program.
    fn value(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut [Complex<R>],
        s: &mut Self::Scratch,
    );
}

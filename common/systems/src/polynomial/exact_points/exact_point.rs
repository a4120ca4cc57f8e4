//! ExactPoint: one solution of equations with rational coefficients, and solutions of one multiplicity by polynomials.

use cognate_numeric::rational::ComplexRational;
use num_complex::Complex64;

/// One solution of equations with rational coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactPoint {
    /// The unknowns, to more digits than were asked for; a part is 0 where it is 0 as far as twice as many bits show.
    pub values: Vec<ComplexRational>,
    /// The unknowns, rounded to doubles.
    pub rounded: Vec<Complex64>,
    /// Dimension of the local ring at the point.
    pub multiplicity: u64,
    /// Whether all unknowns are real.
    pub is_real: bool,
    /// Largest residual of an equation at the rounded point, relative to the sum of its terms' absolute values.
    pub residual: f64,
    /// Condition number of the Jacobian, equations in units of their terms and unknowns in their own; infinite at a multiple
    /// solution.
    pub condition: f64,
    /// Bits of the arithmetic in which the unknowns were computed.
    pub precision_bits: u32,
}

/// The solutions of one multiplicity.
pub(super) struct PointClass {
    pub multiplicity: u64,
    /// Polynomial whose roots are the values of the linear form; the leading coefficient is 1.
    pub polynomial: Vec<ComplexRational>,
    /// For each unknown, a polynomial: divided by the derivative of `polynomial`, it is the value of the unknown at
    /// each root.
    pub numerators: Vec<Vec<ComplexRational>>,
}

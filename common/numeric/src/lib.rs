//! Numbers: scalars, lanes, the precision ladder, small linear algebra, seeded randomness.
//!
//! In reading order: [`scalar`] is the arithmetic, [`lanes`] many numbers at
//! once, [`precision`] what a rung is, [`rational`] exact input, [`random`]
//! the only source of randomness, [`linear_algebra`] small dense systems.
//!
//! ```
//! use cognate_numeric::lanes::Lanes;
//! use cognate_numeric::scalar::{Complex, MultiplePrecision, Real};
//!
//! fn square<R: Real>(context: R::Context) -> f64 {
//!     let mut z = Complex::<R>::from_f64(context, 1.0, 2.0);
//!     let w = z.clone();
//!     z.mul(&w); // (1 + 2i)^2 = -3 + 4i
//!     z.im.lane(0)
//! }
//! assert_eq!(square::<f64>(()), 4.0);
//! assert_eq!(square::<Lanes<8>>(()), 4.0);
//! assert_eq!(square::<MultiplePrecision>(200), 4.0);
//! ```

pub mod counted;
pub mod decimal_text;
pub mod exact_text;
pub mod interruption;
pub mod lanes;
pub mod linear_algebra;
pub mod precision;
pub mod random;
pub mod rational;
pub mod roots_of_unity;
pub mod scalar;

/// Revision of everything that decides a path's bits.
///
/// It grows with every change after which a path's result differs in any bit;
/// jobs and workers name it, and a worker of another revision gets no chunk.
pub const NUMERICS_REVISION: u32 = 36;

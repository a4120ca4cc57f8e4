//! Numbers: scalars, lanes, the precision ladder, small linear algebra, seeded randomness.

pub mod rational;

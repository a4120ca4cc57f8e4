//! Predictors: from points on the path behind to a guess of the point ahead.
//!
//! Hermite extrapolation through the last accepted points with their tangents is
//! the cheapest per step where nothing is special about the path.

pub mod hermite;

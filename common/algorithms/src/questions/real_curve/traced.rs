//! Tracing: what is known of a real curve while it is followed.

use cognate_solutions::witness::real_curve::ProvedFibre;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// End of a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum End {
    Infinite,
    At {
        point: Vec<Complex64>,
        regular: bool,
    },
}

/// A real point where the form is critical or the curve singular.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Critical {
    pub point: Vec<Complex64>,
    pub value: f64,
    /// Whether the form is critical at the point in a regular way.
    pub regular: bool,
    /// Whether the point is known to all digits of a double.
    pub exact: bool,
}

/// Purpose of a stage between fibres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Task {
    pub slab: usize,
    /// The value to which the form goes.
    pub to: f64,
    /// The level at the end of the slab, by place; `None` for samples.
    pub level: Option<usize>,
    /// Whether a path that is lost leaves a doubt: samples near levels may be missing.
    pub needed: bool,
}

/// A point of a fibre in the middle of a slab.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct FibrePoint {
    pub point: Vec<Complex64>,
    pub real: bool,
    /// Whether the point is real and in the box that was asked for; any real point without a box.
    pub wanted: bool,
}

/// The current component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Tracing {
    /// The curve is not its own conjugate: its real points are some of the critical ones, and no arc is real.
    pub apart: bool,
    pub form: Vec<[i32; 2]>,
    /// Points on the slice of the level, then on all its forms.
    pub start: Vec<Vec<Complex64>>,
    pub critical: Vec<Critical>,
    /// Points where the curve leaves the box that was asked for.
    pub window: Vec<Critical>,
    /// Values of the form at the critical points and where the curve leaves the box, ascending, each once.
    pub levels: Vec<f64>,
    /// Values in the middle of the slabs: before the first level, between, after the last.
    pub middles: Vec<f64>,
    /// Values beyond all levels, below and above in turn.
    pub far: Vec<f64>,
    pub fibres: Vec<Vec<FibrePoint>>,
    /// Proved points of each fibre, if proofs were asked for.
    pub proofs: Vec<ProvedFibre>,
    /// Descriptions of the parts that are not proved.
    pub unproved: Vec<String>,
    pub tasks: Vec<Task>,
    /// Ends of the paths of each task's slab, in the order of the points.
    pub ends: Vec<Vec<Option<End>>>,
    pub doubts: Vec<String>,
}

/// The slice where the form has a value.
pub(in crate::questions) fn row_of(form: &[[i32; 2]], value: f64) -> Vec<Complex64> {
    let coefficients = form
        .iter()
        .map(|&[re, im]| Complex64::new(f64::from(re), f64::from(im)));
    std::iter::once(Complex64::new(-value, 0.0))
        .chain(coefficients)
        .collect()
}

/// The form at a point.
pub(in crate::questions) fn value(form: &[[i32; 2]], point: &[Complex64]) -> f64 {
    let row = row_of(form, 0.0);
    let terms = row[1..].iter().zip(point).map(|(c, x)| (c * x).re);
    terms.sum()
}

/// Distance relative to the size of the first, or to 1.
pub(super) fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let (mut apart, mut size) = (0.0, 1.0f64);
    for (x, y) in a.iter().zip(b) {
        apart += (x - y).norm_sqr();
        size += x.norm_sqr();
    }
    (apart / size).sqrt()
}

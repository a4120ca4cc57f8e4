//! Denominators: what an answer about components says without the points where a denominator of the given equations
//! is 0.
//!
//! Components are closures and stay. Components of a locus, real points, points of a real curve through which no real
//! branch passes, and points and curves of a real surface to which no sheet comes are answers by themselves: where a
//! denominator is 0 they are none.

use cognate_solutions::denominators::{AskedPoint, Denominator, Denominators};
use cognate_solutions::witness::answer::RealPoints;
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_solutions::witness::real_surface::RealSurface;
use num_complex::Complex64;

/// Errors of points that are known to all digits of a double, and of others, relative to their largest coordinates.
const REGULAR: f64 = 1e-13;
const SINGULAR: f64 = 1e-10;
/// Said where a real point was taken away from a component that may have others beside it.
const BESIDE: &str = "a denominator is 0 at a real point, which is no solution: whether others are beside it is not searched";
const NOT_CLEAR: &str = "whether a denominator is 0 at a real point is not clear";
/// Said of the real part of a surface where it is a curve.
const ON_CURVE: &str = "a denominator is 0, or nearly 0, on a curve of it to which no sheet comes: what of that is a solution is not clear";

/// Takes away real points that are no solutions.
pub(super) fn keep_real_points(real_points: &mut RealPoints, denominators: &Denominators<'_>) {
    let doubts = &mut real_points.doubts;
    let before = real_points.points.len();
    real_points.points.retain(|point| {
        let asked = asked(&point.point, point.regular);
        match denominators.at(asked) {
            Denominator::Nonzero => true,
            Denominator::Zero => false,
            Denominator::Doubtful => {
                doubts.push(NOT_CLEAR.into());
                true
            }
        }
    });
    if real_points.points.len() < before && real_points.id.dimension > 0 {
        doubts.push(BESIDE.into());
    }
}

/// Vertices that are the end of no arc are points of the real curve by themselves.
pub(super) fn keep_isolated_points(curve: &mut RealCurve, denominators: &Denominators<'_>) {
    let mut is_end = vec![false; curve.vertices.len()];
    for place in curve.edges.iter().flat_map(|edge| edge.ends).flatten() {
        is_end[place] = true;
    }
    let mut place_of = Vec::with_capacity(is_end.len());
    let vertices = std::mem::take(&mut curve.vertices);
    for (vertex, is_end) in vertices.into_iter().zip(is_end) {
        place_of.push(curve.vertices.len());
        let decision = match is_end {
            true => Denominator::Nonzero,
            false => denominators.at(asked(&vertex.point, !vertex.is_singular())),
        };
        if decision == Denominator::Doubtful {
            curve.doubts.push(NOT_CLEAR.into());
        }
        if decision != Denominator::Zero {
            curve.vertices.push(vertex);
        }
    }
    for end in curve.edges.iter_mut().flat_map(|edge| &mut edge.ends) {
        *end = end.map(|place| place_of[place]);
    }
}

/// Single points of a real surface are none of it where a denominator is 0; curves to which no sheet comes are in doubt
/// there.
pub(super) fn keep_parts_of_no_sheet(surface: &mut RealSurface, denominators: &Denominators<'_>) {
    let mesh = &mut surface.mesh;
    let mut is_on_sheet = vec![false; mesh.vertices.len()];
    for &corner in mesh.triangles.iter().flatten() {
        is_on_sheet[corner as usize] = true;
    }
    let mut is_on_curve = vec![false; mesh.vertices.len()];
    for &end in mesh.segments.iter().flatten() {
        is_on_curve[end as usize] = true;
    }
    let decide = |vertex: usize| {
        let values = mesh.vertices[vertex].map(|x| Complex64::new(x, 0.0));
        denominators.at(asked(&values, false))
    };
    let is_doubtful = |ends: &[u32; 2]| {
        let ends = ends.map(|end| end as usize);
        let no_sheet = ends.iter().any(|&end| !is_on_sheet[end]);
        no_sheet && ends.iter().all(|&end| decide(end) != Denominator::Nonzero)
    };
    if mesh.segments.iter().any(is_doubtful) {
        surface.doubts.push(ON_CURVE.into());
    }
    let mut place_of = Vec::with_capacity(mesh.vertices.len());
    let mut kept = Vec::with_capacity(mesh.vertices.len());
    for (vertex, &place) in mesh.vertices.iter().enumerate() {
        let decision = match is_on_sheet[vertex] || is_on_curve[vertex] {
            true => Denominator::Nonzero,
            false => decide(vertex),
        };
        place_of.push(kept.len() as u32);
        match decision {
            Denominator::Nonzero => kept.push(place),
            Denominator::Zero => surface.euler -= 1,
            Denominator::Doubtful => {
                surface.doubts.push(NOT_CLEAR.into());
                kept.push(place);
            }
        }
    }
    mesh.vertices = kept;
    let places = mesh.triangles.iter_mut().flatten();
    for place in places.chain(mesh.segments.iter_mut().flatten()) {
        *place = place_of[*place as usize];
    }
}

/// A point of a component: no isolated solution of the equations.
fn asked(values: &[Complex64], regular: bool) -> AskedPoint<'_> {
    AskedPoint {
        values,
        accuracy: if regular { REGULAR } else { SINGULAR },
        singular: !regular,
        isolated: false,
    }
}

//! Polyhedral start: as many paths as the mixed volume of the supports.
//!
//! Bernstein, The number of roots of a system of equations (1975); Huber and
//! Sturmfels, A polyhedral method for solving sparse polynomial systems (1995).

pub mod branches;
pub mod counting;
mod exact;
pub mod generic;
pub mod mixed_cells;
mod zero_coordinates;

pub use zero_coordinates::zeros_are_possible;

/// The supports whose mixed volume bounds the isolated solutions in all of C^n.
///
/// Where a solution can have a coordinate 0, the origin joins every support
/// (Li and Wang, The BKK root count in C^n, 1996); else none can be missed in
/// the torus, and the supports stay as they are. A variable of which `nonzero` says so is not 0.
pub fn affine_supports(supports: &[Vec<Vec<u32>>], nonzero: &[bool]) -> Vec<Vec<Vec<i64>>> {
    let zeros = zeros_are_possible(supports, nonzero);
    supports
        .iter()
        .map(|support| {
            let mut points: Vec<Vec<i64>> = support
                .iter()
                .map(|point| point.iter().copied().map(i64::from).collect())
                .collect();
            let origin = vec![0; points.first().map_or(0, Vec::len)];
            if zeros && !points.contains(&origin) {
                points.push(origin);
            }
            points.sort_unstable();
            points
        })
        .collect()
}

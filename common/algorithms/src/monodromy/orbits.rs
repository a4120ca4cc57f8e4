//! Orbits: regular solutions at generic parameters, told apart up to the symmetry of the system.

use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A regular solution, which stands for its orbit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RegularSolution {
    /// Values of the variables.
    pub values: Vec<Complex64>,
    /// Error bound: two solutions are the same when their distance is at most the sum of their radii.
    pub radius: f64,
}

/// Comparison of solutions up to a symmetry group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Orbits {
    /// The group; trivial as long as a declared symmetry is not confirmed.
    pub group: SymmetryGroup,
    /// Layout of the coordinates of solutions.
    pub shape: PointShape,
    /// Seed of the search for equal points.
    pub seed: u64,
}

impl Orbits {
    /// Different images of each solution in turn, the solution itself first.
    pub fn images<'a>(
        &self,
        solutions: impl IntoIterator<Item = &'a RegularSolution>,
    ) -> Vec<Vec<Complex64>> {
        let images = solutions.into_iter();
        images
            .flat_map(|solution| self.group.orbit(&solution.values, &self.shape))
            .collect()
    }

    /// Indices of the solutions of each orbit: members ascending, orbits by their first members.
    pub fn members<'a>(
        &self,
        solutions: impl IntoIterator<Item = &'a RegularSolution>,
    ) -> Vec<Vec<usize>> {
        let balls: Vec<(&[Complex64], f64)> = solutions
            .into_iter()
            .map(|solution| (solution.values.as_slice(), solution.radius))
            .collect();
        self.group.orbits(&balls, &self.shape, self.seed)
    }
}

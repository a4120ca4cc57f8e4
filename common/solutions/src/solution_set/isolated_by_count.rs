//! Singular points that dual spaces left undecided become solutions where an exact count says that all are isolated.

use super::SolutionSet;
use crate::classification::Tolerances;
use crate::involution::Involution;
use crate::path_crossing::singular_radius;
use crate::point_shape::PointShape;
use crate::real::{is_real, write_as_real};
use crate::solution::Solution;
use crate::unique_points::Neighbourhood;
use cognate_systems::system::System;
use num_complex::Complex64;

impl SolutionSet {
    /// Moves the undecided points to the solutions, in the order of their first paths, and decides which are real.
    ///
    /// `parameters` are the system's parameters. The caller knows that each point is isolated and has the multiplicity that
    /// it is listed with; the counts stay as they are.
    pub fn take_undecided_as_isolated(&mut self, system: &System, parameters: &[Complex64]) {
        let involution = Involution::of(system, parameters).ok();
        for mut point in std::mem::take(&mut self.undecided) {
            point.undecided = false;
            point.singular = point.multiplicity > 1;
            if let Some(involution) = &involution {
                decide_reality(&mut point, system, involution);
            }
            self.solutions.push(point);
        }
        self.solutions.sort_by_key(Solution::first_path);
    }
}

fn decide_reality(point: &mut Solution, system: &System, involution: &Involution) {
    let shape = PointShape::of(system);
    let roots: Vec<usize> = system.root_unknowns().map(|r| r.variable).collect();
    let values: Vec<Complex64> = point.variables.values().collect();
    let coordinates = shape.to_coordinates(&values);
    let tolerances = Tolerances::default();
    let end = Neighbourhood {
        point: &coordinates,
        radius: singular_radius(point.accuracy, point.precision_bits, &tolerances),
        refined: false,
    };
    let real = is_real(&end, &shape, involution, &roots);
    if real {
        write_as_real(&mut point.variables, &shape, involution, &roots);
    }
    point.real = Some(real);
}

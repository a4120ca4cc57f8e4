//! Synthetic results for this crate's tests.

use crate::point_shape::PointShape;
use cognate_continuation::path_result::{LocalDimension, PathResult};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_systems::system::{System, VariableGroup};
use num_complex::Complex64;

/// One affine group of this many variables.
pub fn affine_shape(variables: usize) -> PointShape {
    PointShape::of(&System {
        variables: (0..variables).map(|v| format!("x{v}")).collect(),
        groups: vec![VariableGroup {
            variables: (0..variables).collect(),
            homogeneous: false,
        }],
        ..System::default()
    })
}

/// x^degree = x in one variable.
pub fn roots_of_unity(degree: u32) -> System {
    let mut system = System {
        variables: vec!["x".into()],
        groups: vec![VariableGroup {
            variables: vec![0],
            homogeneous: false,
        }],
        equation_names: vec!["f".into()],
        ..System::default()
    };
    let e = &mut system.expressions;
    let x = e.variable(0);
    let power = e.power(x, degree);
    system.equations = vec![e.subtract(power, x)];
    system
}

/// A regular endpoint.
pub fn regular(path: u64, point: &[(f64, f64)]) -> PathResult {
    let point = point.iter().map(|&(re, im)| Complex64::new(re, im));
    PathResult {
        residual: 1e-16,
        condition: 10.0,
        accuracy: 1e-15,
        ..PathResult::untracked(path, 0, PathOutcome::Regular, point.collect())
    }
}

/// A singular endpoint.
pub fn singular(path: u64, point: &[(f64, f64)], winding: u32, turns: &[i32]) -> PathResult {
    PathResult {
        outcome: PathOutcome::Singular,
        condition: 1e14,
        accuracy: 1e-10,
        winding_number: Some(winding),
        infinity_turns: turns.to_vec(),
        ..regular(path, point)
    }
}

/// A singular endpoint whose dual space stops growing at this multiplicity.
pub fn isolated(
    path: u64,
    point: &[(f64, f64)],
    winding: u32,
    turns: &[i32],
    multiplicity: u32,
) -> PathResult {
    PathResult {
        local_dimension: Some(LocalDimension {
            dual_dimensions: vec![1, multiplicity, multiplicity],
            bound: u64::MAX,
            margin: 1e5,
            moved_slices: Vec::new(),
        }),
        ..singular(path, point, winding, turns)
    }
}

/// A failed path in a space of one variable.
pub fn failed(path: u64) -> PathResult {
    PathResult {
        outcome: PathOutcome::Failed(Failure::StepTooSmall),
        t: Complex64::new(0.25, 0.0),
        ..regular(path, &[(1.0, 0.0), (0.5, 0.0)])
    }
}

//! A system in homogeneous groups, in one affine group: each homogeneous group lies on a random patch.

use crate::expression::NodeId;
use crate::system::{System, VariableGroup};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};

/// Puts the variables of all groups into one affine group, with the same solutions: for each homogeneous group an
/// equation comes first that says that a random real linear form of its variables is 1. A set of solutions of dimension
/// m in projective space has dimension m.
///
/// Conjugates stay conjugates; everything else that is attached to the groups is left out.
pub fn affine_chart(system: &System, seed: u64) -> System {
    let mut chart = System {
        groups: vec![VariableGroup {
            variables: (0..system.variables.len()).collect(),
            homogeneous: false,
        }],
        equations: Vec::new(),
        equation_names: Vec::new(),
        symmetry: Vec::new(),
        ..system.clone()
    };
    for (g, group) in system.groups.iter().enumerate() {
        if !group.homogeneous {
            continue;
        }
        let mut random = RandomStream::new(seed, Purpose::Patch, g as u64);
        let e = &mut chart.expressions;
        let one = e.integer(-1);
        let patch = group.variables.iter().fold(one, |sum: NodeId, &v| {
            let size = Rational::from((16_384 + random.below(49_152), 65_536u32));
            let weight = if random.below(2) == 0 { size } else { -size };
            let weight = e.constant(ComplexRational::real(weight));
            let x = e.variable(v as u32);
            let term = e.multiply(weight, x);
            e.add(sum, term)
        });
        chart.equations.push(patch);
        chart.equation_names.push(format!("patch {}", g + 1));
    }
    chart.equations.extend(&system.equations);
    chart.equation_names.extend(system.equation_names.clone());
    chart
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_homogeneous_group_has_a_patch() {
        let text = b"CONFIG\nEND;\nINPUT\nhom_variable_group s, t; hom_variable_group x, y, z;\
                     function f, g; f = s*x + t*y; g = s*y + t*z;\nEND;\n";
        let problem = crate::formats::read("test", text);
        let system = problem.expect("a problem of this test").system;
        let chart = affine_chart(&system, 3);
        assert_eq!(chart.check(), Ok(()));
        assert_eq!((chart.equation_count(), chart.dimension()), (4, 5));
    }
}

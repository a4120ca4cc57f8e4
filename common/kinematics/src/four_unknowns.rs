//! Systems of one dyad: two plane vectors that four equations fix, in isotropic coordinates.

use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::system::{System, VariableGroup};

/// Four equations, the same but for their parameters, in unknowns z, Z, w, W of which capitals are
/// conjugates; each is bilinear in two groups of them.
///
/// `equation` makes one from the unknowns and the four parameters of its position.
///
/// # Panics
/// When that makes no system.
pub fn bilinear_system(
    variables: [&str; 4],
    groups: [[usize; 2]; 2],
    position: &str,
    parameters: [&str; 4],
    equation: impl Fn(&mut Expressions, [NodeId; 4], [NodeId; 4]) -> NodeId,
) -> System {
    let mut e = Expressions::new();
    let unknowns = [0, 1, 2, 3].map(|k| e.variable(k));
    let equations = (0..4)
        .map(|j| {
            let given = [0, 1, 2, 3].map(|k| e.parameter(4 * j + k));
            equation(&mut e, unknowns, given)
        })
        .collect();
    let group = |variables: [usize; 2]| VariableGroup {
        variables: variables.to_vec(),
        homogeneous: false,
    };
    let system = System {
        expressions: e,
        variables: variables.map(str::to_owned).to_vec(),
        parameters: (1..=4)
            .flat_map(|j| parameters.map(|s| format!("{s}{j}")))
            .collect(),
        groups: groups.map(group).to_vec(),
        equations,
        equation_names: (2..=5).map(|j| format!("{position}{j}")).collect(),
        conjugates: vec![(0, 1), (2, 3)],
        ..System::default()
    };
    if let Err(error) = system.check() {
        panic!("the system of a dyad is a system: {error}");
    }
    system
}

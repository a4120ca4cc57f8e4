//! Bent: a system beside the first and second derivatives of its solutions by the parameters.
//!
//! A regular solution of a square system moves with the parameters; how it moves solves equations that are square and
//! regular, too. A box that is proved to hold one solution of all of them encloses the derivatives.

use crate::expression::differentiate::directional;
use crate::expression::{Expressions, Node, NodeId};
use crate::scaling::Scaling;
use crate::system::{System, VariableGroup};
use foldhash::{HashMap, HashMapExt};

/// The equations F(x, p) = 0, F' = 0 and F'' = 0 along x(s), p + s q, at s = 0: in the variables x, x' and x'', as many
/// of each as the system has, with the parameters p and then q. All variables are one affine group.
pub fn bent(system: &System) -> System {
    let (n, parameters) = (system.variables.len(), system.parameters.len());
    let index = |k: usize| u32::try_from(k).expect("variables are counted in 32 bits");
    let mut e = system.expressions.clone();
    let mut along = |equations: &[NodeId]| -> Vec<NodeId> {
        let leaf = &mut |e: &mut Expressions, leaf: &Node| match leaf {
            // x'' is not differentiated: it is in none of the equations that are.
            Node::Variable(v) if (*v as usize) < 2 * n => Some(e.variable(*v + index(n))),
            Node::Parameter(p) if (*p as usize) < parameters => {
                Some(e.parameter(*p + index(parameters)))
            }
            _ => None,
        };
        let slopes = directional(&mut e, equations, leaf);
        let zero = e.integer(0);
        let slopes = slopes.into_iter();
        slopes.map(|slope| slope.unwrap_or(zero)).collect()
    };
    let first = along(&system.equations);
    let second = along(&first);
    let marked = |names: &[String], mark: &str| -> Vec<String> {
        // With a colon in it, it is the name of no variable in a file.
        names.iter().map(|name| format!("{mark}:{name}")).collect()
    };
    let thrice = |names: &[String]| {
        let (first, second) = (marked(names, "first"), marked(names, "second"));
        [names.to_vec(), first, second].concat()
    };
    System {
        expressions: e,
        equations: [system.equations.clone(), first, second].concat(),
        equation_names: thrice(&system.equation_names),
        variables: thrice(&system.variables),
        parameters: [
            system.parameters.clone(),
            marked(&system.parameters, "moved"),
        ]
        .concat(),
        groups: vec![VariableGroup {
            variables: (0..3 * n).collect(),
            homogeneous: false,
        }],
        path_variable: None,
        conjugates: Vec::new(),
        degenerate: Default::default(),
        symmetry: Vec::new(),
        helpers: Vec::new(),
        scaling: Scaling::default(),
    }
}

/// The first and the second derivative in s of the equations F(x + s u, p + s q), at s = 0: those of all equations, then
/// the others. x, u, p and q are all parameters, in this order, so that nothing has to be differentiated by them.
pub fn along_line(system: &System) -> (Expressions, Vec<NodeId>) {
    let index = |k: usize| u32::try_from(k).expect("variables are counted in 32 bits");
    let (n, parameters) = (
        index(system.variables.len()),
        index(system.parameters.len()),
    );
    let mut e = Expressions::new();
    let mut memory = HashMap::new();
    let mut copies = Vec::with_capacity(system.equations.len());
    for &equation in &system.equations {
        let leaf = &mut |e: &mut Expressions, leaf: &Node| match leaf {
            Node::Variable(v) => e.parameter(*v),
            Node::Parameter(p) => e.parameter(2 * n + *p),
            _ => unreachable!("a system has no other leaves"),
        };
        copies.push(e.import(&system.expressions, equation, &mut memory, leaf));
    }
    let mut along = |equations: &[NodeId]| -> Vec<NodeId> {
        let leaf = &mut |e: &mut Expressions, leaf: &Node| match leaf {
            Node::Parameter(k) if *k < n => Some(e.parameter(*k + n)),
            Node::Parameter(k) if (2 * n..2 * n + parameters).contains(k) => {
                Some(e.parameter(*k + parameters))
            }
            _ => None,
        };
        let slopes = directional(&mut e, equations, leaf);
        let zero = e.integer(0);
        let slopes = slopes.into_iter();
        slopes.map(|slope| slope.unwrap_or(zero)).collect()
    };
    let first = along(&copies);
    let second = along(&first);
    (e, [first, second].concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::{Evaluate, Interpreter};
    use cognate_numeric::scalar::Complex;

    #[test]
    fn a_moving_root_solves_all_equations() {
        // x^3 = 1 + s: x = 1, x' = 1/3, x'' = -2/9; y = p x with p = 2 + 5 s: y = 2, y' = 17/3, y'' = 26/9.
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; parameter c, p; function f, g;\
                     f = x^3 - c; g = y - p*x;\nEND;\n";
        let system = crate::formats::read("test", text).unwrap().system;
        let made = bent(&system);
        assert_eq!(made.check(), Ok(()));
        assert_eq!((made.equation_count(), made.variables.len()), (6, 6));
        let program = Interpreter::compile(&made.expressions, &made.equations, 6, 4);
        let numbers = |values: &[f64]| -> Vec<Complex<f64>> {
            let values = values.iter();
            values.map(|&re| Complex::from_f64((), re, 0.0)).collect()
        };
        let at = numbers(&[1.0, 2.0, 1.0 / 3.0, 17.0 / 3.0, -2.0 / 9.0, 26.0 / 9.0]);
        let mut values = vec![Complex::zero(()); 6];
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        let parameters = numbers(&[1.0, 2.0, 1.0, 5.0]);
        program.value(&at, &parameters, &mut values, &mut scratch);
        for value in values {
            assert!(value.norm_sqr() < 1e-28, "{value:?}");
        }
    }

    #[test]
    fn derivatives_along_a_line_are_those_of_calculus() {
        // f = x^2 y and c + a x + b y at (x, y) + s (u, v), with c, a and b that move.
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; function f;\nf = x^2*y;\nEND;\n";
        let system = crate::formats::read("test", text).unwrap().system;
        let (e, derivatives) = along_line(&crate::transform::slice(&system, 1, 2));
        let program = Interpreter::of_values(&e, &derivatives, 10);
        let values = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0];
        let values = values.map(|re| Complex { re, im: 0.0 });
        let mut out = vec![Complex { re: 0.0, im: 0.0 }; 4];
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        program.value(&[], &values, &mut out, &mut scratch);
        let expected = [
            2.0 * 6.0 * 5.0 + 4.0 * 7.0,
            19.0 + 23.0 * 2.0 + 29.0 * 3.0 + 13.0 * 5.0 + 17.0 * 7.0,
            2.0 * 3.0 * 25.0 + 4.0 * 2.0 * 35.0,
            2.0 * (23.0 * 5.0 + 29.0 * 7.0),
        ];
        let slopes: Vec<f64> = out.iter().map(|z| z.re).collect();
        assert_eq!(slopes, expected);
    }
}

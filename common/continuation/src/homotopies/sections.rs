//! The curve that the solutions of a family draw over a line of its parameters, cut by sections.
//!
//! On the line p + lambda v the solutions (x, lambda) of F(x; p + lambda v) = 0 are a curve, whose
//! points with lambda = 0 are the solutions at p. Its sections are where (a.x) lambda + b.x = 0:
//! hyperplanes in the coordinates x, lambda and x lambda, so that a trace test serves for them
//! (Leykin, Rodriguez, Sottile: Trace test, 2018, section 3; here with x in one group). At b = 0
//! they are the solutions at p, and the points with a.x = 0.

use crate::chart::exact;
use cognate_numeric::rational::ComplexRational;
use cognate_systems::expression::{Expressions, Imported, Node, NodeId};
use cognate_systems::scaling::exact_times;
use cognate_systems::system::{System, VariableGroup};
use num_complex::Complex64;

/// Variables of a section's linear forms; after them stands 1 where this says so. `None` where
/// the variables are not in affine groups or in one homogeneous group.
pub fn section_variables(system: &System) -> Option<(Vec<usize>, bool)> {
    match system.groups.as_slice() {
        [one] if one.homogeneous => Some((one.variables.clone(), false)),
        groups if groups.iter().all(|group| !group.homogeneous) => {
            Some(((0..system.variables.len()).collect(), true))
        }
        _ => None,
    }
}

/// The curve of a family with its sections: one variable more, lambda, in a group of its own; its
/// parameters are the coefficients of a and then those of b, each in the order of
/// [`section_variables`].
///
/// `None` where there are no sections, the lengths do not fit the system, or it is a homotopy.
pub fn sections(
    system: &System,
    parameters: &[Complex64],
    direction: &[Complex64],
) -> Option<System> {
    let (members, constant) = section_variables(system)?;
    let count = system.parameters.len();
    let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
    if parameters.len() != count
        || direction.len() != count
        || system.path_variable.is_some()
        || !parameters.iter().chain(direction).all(finite)
    {
        return None;
    }
    let n = system.variables.len();
    let mut out = Expressions::new();
    let lambda = out.variable(n as u32);
    let moving: Vec<NodeId> = parameters
        .iter()
        .zip(direction)
        .map(|(&p, &v)| {
            let (p, v) = (exact(&mut out, p), exact(&mut out, v));
            let way = out.multiply(v, lambda);
            out.add(p, way)
        })
        .collect();
    let mut memory = Imported::default();
    let mut equations: Vec<NodeId> = Vec::new();
    for &equation in &system.equations {
        let leaf = &mut |to: &mut Expressions, leaf: &Node| match leaf {
            Node::Parameter(p) => moving[*p as usize],
            other => to.insert(other.clone()),
        };
        equations.push(out.import(&system.expressions, equation, &mut memory, leaf));
    }
    // The forms are in the unknowns that are tracked.
    let unknown = |&v: &usize| {
        let variable = out.variable(v as u32);
        match system.scaling.exponent(v) {
            0 => variable,
            exponent => {
                let factor = exact_times(&ComplexRational::real(1), -i64::from(exponent));
                let factor = out.constant(factor);
                out.multiply(factor, variable)
            }
        }
    };
    let mut places: Vec<NodeId> = members.iter().map(unknown).collect();
    if constant {
        places.push(out.integer(1));
    }
    let mut form = |first: usize| {
        let mut sum = out.integer(0);
        for (k, &place) in places.iter().enumerate() {
            let coefficient = out.parameter((first + k) as u32);
            let term = out.multiply(coefficient, place);
            sum = out.add(sum, term);
        }
        sum
    };
    let (a, b) = (form(0), form(places.len()));
    let product = out.multiply(a, lambda);
    equations.push(out.add(product, b));
    let mut name = "lambda".to_string();
    while system.variables.contains(&name) {
        name.push('_');
    }
    let mut groups = system.groups.clone();
    groups.push(VariableGroup {
        variables: vec![n],
        homogeneous: false,
    });
    Some(System {
        expressions: out,
        variables: system.variables.iter().cloned().chain([name]).collect(),
        // No name that is read has a space.
        parameters: (1..=2 * places.len())
            .map(|k| format!("section {k}"))
            .collect(),
        groups,
        equations,
        equation_names: system
            .equation_names
            .iter()
            .cloned()
            .chain(["section".to_string()])
            .collect(),
        scaling: system.scaling.with_one_more(n),
        ..System::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::evaluation::values;

    fn number(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn read(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        match cognate_systems::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn the_curve_has_the_members_and_its_section_is_bilinear() {
        let family = read("variable_group x; parameter p, q; function f; f = x^2 - p*q;");
        let (p, v) = (
            [number(2.0, 0.0), number(3.0, 1.0)],
            [number(0.0, 1.0), number(1.0, 0.0)],
        );
        let curve = sections(&family, &p, &v).unwrap();
        assert_eq!(curve.check(), Ok(()));
        assert_eq!((curve.equation_count(), curve.dimension()), (2, 2));
        let (x, lambda) = (number(0.5, 0.25), number(-1.0, 2.0));
        let section = [1.0, 2.0, 3.0, 4.0].map(|c| number(c, 0.0));
        let section_values = values(&curve.expressions, &curve.equations, &[x, lambda], &section);
        let member = x * x - (p[0] + lambda * v[0]) * (p[1] + lambda * v[1]);
        let cut = (x + 2.0) * lambda + x * 3.0 + 4.0;
        assert!(
            (section_values[0] - member).norm_sqr() < 1e-28,
            "{section_values:?}"
        );
        assert!(
            (section_values[1] - cut).norm_sqr() < 1e-28,
            "{section_values:?}"
        );
        assert!(sections(&family, &p[..1], &v).is_none());
    }

    #[test]
    fn homogeneous_coordinates_have_no_constant_and_go_alone() {
        let one = read("hom_variable_group x, y; parameter p; function f; f = x^2 - p*y^2;");
        assert_eq!(section_variables(&one), Some((vec![0, 1], false)));
        let z = [number(1.0, 0.0)];
        assert_eq!(sections(&one, &z, &z).unwrap().parameters.len(), 4);
        let mixed = read(
            "hom_variable_group x, y; variable_group z; parameter p; function f, g; \
             f = x^2 - p*y^2; g = z - 1;",
        );
        assert_eq!(section_variables(&mixed), None);
    }
}

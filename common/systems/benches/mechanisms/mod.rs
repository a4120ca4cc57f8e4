//! Two mechanisms as systems to measure on: nine points, and a platform with six legs.

use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Expressions, NodeId};

/// Arguments of `Interpreter::compile`.
pub struct Plain {
    /// The arena.
    pub expressions: Expressions,
    /// F.
    pub equations: Vec<NodeId>,
    /// Number of variables.
    pub variables: usize,
    /// Number of parameters.
    pub parameters: usize,
}

/// The nine-point path synthesis of four-bars: see `named::nine_point`.
pub fn nine_points() -> Plain {
    let system = cognate_systems::named::nine_point().system;
    Plain {
        variables: system.variables.len(),
        parameters: system.parameters.len(),
        expressions: system.expressions,
        equations: system.equations,
    }
}

/// A general Stewart-Gough platform in Study coordinates x0..x3, y0..y3: six
/// leg quadrics with random coefficients, the Study quadric, and a patch.
pub fn platform() -> Plain {
    let mut e = Expressions::new();
    let v: Vec<NodeId> = (0..8).map(|i| e.variable(i)).collect();
    let mut stream = RandomStream::new(1, Purpose::Test, 0);
    let mut random = || Rational::from((stream.below(2001) as i64 - 1000, 1000));
    let mut equations = Vec::new();
    for leg in 0..7 {
        // Which products of coordinates occur in one leg: see the leg equation
        // of the survey, where each rotation entry is a quadric of x, each
        // translation entry bilinear in x and y.
        let mut sum = e.integer(0);
        for i in 0..8 {
            for j in i..8 {
                let study = leg == 6;
                let occurs = if study {
                    j == i + 4
                } else {
                    (j < 4) || (i < 4 && j != i + 4) || i == j
                };
                if !occurs {
                    continue;
                }
                let c = if study { Rational::from(1) } else { random() };
                let c = e.constant(ComplexRational::real(c));
                let product = e.multiply(v[i], v[j]);
                let term = e.multiply(c, product);
                sum = e.add(sum, term);
            }
        }
        equations.push(sum);
    }
    let mut patch = e.integer(-1);
    for &v in &v {
        let c = e.constant(ComplexRational::new(random(), random()));
        let term = e.multiply(c, v);
        patch = e.add(patch, term);
    }
    equations.push(patch);
    Plain {
        expressions: e,
        equations,
        variables: 8,
        parameters: 0,
    }
}

/// The straight-line homotopy p F + q G from G = x_i^2 - 1, as trackers make it:
/// both parameters run along the path.
pub fn straight_line(target: Plain) -> Plain {
    let mut e = target.expressions;
    let (p, q) = (e.parameter(0), e.parameter(1));
    let minus_one = e.integer(-1);
    let equations = target
        .equations
        .into_iter()
        .enumerate()
        .map(|(i, f)| {
            let x = e.variable(i as u32);
            let square = e.power(x, 2);
            let g = e.add(square, minus_one);
            let (f, g) = (e.multiply(p, f), e.multiply(q, g));
            e.add(f, g)
        })
        .collect();
    Plain {
        expressions: e,
        equations,
        variables: target.variables,
        parameters: 2,
    }
}

//! Fibre product: several copies of the variables of a family over common parameters, each copy on a general linear space.

use crate::expression::{Expressions, Imported, Node, NodeId};
use crate::system::{System, VariableGroup};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::ComplexRational;

/// Streams of random numbers from this one on are those of copies.
const STREAM: u64 = 1 << 53;
/// Coefficients of the linear spaces are multiples of 1/64 up to this many.
const MOST: i64 = 127;

/// The system F(z_1; q) = ... = F(z_k; q) = 0 of a family F(z; q), its parameters q the first variables, in one affine group.
/// In each copy the last `slices` variables are random affine combinations of the others, which says that z lies on a
/// general linear space of that codimension. A copy is the same whatever the number of copies.
///
/// # Panics
/// When there are more slices than variables.
pub fn fibre_product(family: &System, copies: usize, slices: usize, seed: u64) -> System {
    let parameters = family.parameters.len();
    let free = family.variables.len().checked_sub(slices);
    let free = free.expect("at most as many slices as variables");
    let mut product = System {
        variables: family.parameters.clone(),
        ..System::default()
    };
    for copy in 0..copies {
        let e = &mut product.expressions;
        let first = parameters + copy * free;
        let mut random = RandomStream::new(seed, Purpose::Question, STREAM + copy as u64);
        let mut values: Vec<NodeId> = (first..first + free)
            .map(|v| e.variable(index(v)))
            .collect();
        for _ in 0..slices {
            let combination = combination(e, &values[..free], &mut random);
            values.push(combination);
        }
        let mut memory = Imported::default();
        for (&equation, name) in family.equations.iter().zip(&family.equation_names) {
            let copied_equation = product.expressions.import(
                &family.expressions,
                equation,
                &mut memory,
                &mut |e, leaf| match leaf {
                    Node::Variable(v) => values[*v as usize],
                    Node::Parameter(p) => e.variable(*p),
                    _ => unreachable!("a system has no other leaves"),
                },
            );
            product.equations.push(copied_equation);
            product.equation_names.push(format!("{name}_{}", copy + 1));
        }
        for variable in &family.variables[..free] {
            let mut name = format!("{variable}_{}", copy + 1);
            while product.variables.contains(&name) {
                name.push('_');
            }
            product.variables.push(name);
        }
    }
    product.groups.push(VariableGroup {
        variables: (0..product.variables.len()).collect(),
        homogeneous: false,
    });
    product
}

/// A random affine combination of these.
fn combination(e: &mut Expressions, nodes: &[NodeId], random: &mut RandomStream) -> NodeId {
    let mut coefficient = |e: &mut Expressions| {
        let drawn = random.below(2 * MOST as u64) as i64 - MOST;
        let drawn = if drawn < 0 { drawn } else { drawn + 1 };
        e.constant(ComplexRational::real((drawn, 64)))
    };
    let mut sum = coefficient(e);
    for &node in nodes {
        let factor = coefficient(e);
        let term = e.multiply(factor, node);
        sum = e.add(sum, term);
    }
    sum
}

fn index(place: usize) -> u32 {
    u32::try_from(place).expect("variables are counted in 32 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::degrees;

    #[test]
    fn copies_share_the_parameters() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; parameter a, x_1; function f, g;\
                     f = a*x^2 - y; g = x*y - x_1;\nEND;\n";
        let family = crate::formats::read("test", text).unwrap().system;
        let product = fibre_product(&family, 2, 1, 1);
        assert_eq!(product.check(), Ok(()));
        assert_eq!(product.variables, ["a", "x_1", "x_1_", "x_2"]);
        assert_eq!(product.equation_names, ["f_1", "g_1", "f_2", "g_2"]);
        assert_eq!(degrees(&product).unwrap().total, [3, 2, 3, 2]);
        let fewer = fibre_product(&family, 1, 2, 1);
        assert_eq!(fewer.variables, ["a", "x_1"]);
        assert_eq!(degrees(&fewer).unwrap().total, [1, 1]);
    }
}

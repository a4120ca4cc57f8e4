//! A system in affine coordinates made homogeneous in each group, on the graph, without expansion.
//!
//! Every node carries its degree in each affine group; sums are padded with
//! powers of the homogenising coordinates. Where terms cancel, so that the form
//! has a higher degree than the equation, padding would leave a power of the
//! homogenising coordinate as a factor and with it false solutions at infinity;
//! then the homogeneous parts are formed one by one, and those above the exact
//! degree, which vanish, are left out.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use crate::polynomial::Degrees;
use crate::system::System;
use foldhash::{HashMap, HashMapExt};
use std::collections::BTreeMap;

/// Writes the homogenised equations into `out` and gives their nodes.
///
/// `coordinates[g]` stands for the homogeneous coordinates of group g: for an
/// affine group the homogenising coordinate first, then one for each variable of
/// the group; for a homogeneous group one for each variable. Any expression may
/// stand there. `parameters` stand for the parameters.
///
/// # Panics
/// When the lengths do not fit the system.
pub fn homogenize(
    system: &System,
    degrees: &Degrees,
    out: &mut Expressions,
    coordinates: &[Vec<NodeId>],
    parameters: &[NodeId],
) -> Vec<NodeId> {
    assert_eq!(coordinates.len(), system.groups.len());
    assert_eq!(parameters.len(), system.parameters.len());
    // Only affine groups are padded; the others are homogeneous already.
    let mut padding = Vec::new();
    let mut exact: Vec<Vec<u32>> = vec![Vec::new(); system.equations.len()];
    let mut places = vec![None; system.variable_count()];
    for (g, group) in system.groups.iter().enumerate() {
        let axis = (!group.homogeneous).then_some(padding.len());
        let first = usize::from(!group.homogeneous);
        assert_eq!(coordinates[g].len(), group.variables.len() + first);
        for (k, &v) in group.variables.iter().enumerate() {
            places[v] = Some((coordinates[g][first + k], axis));
        }
        if axis.is_some() {
            padding.push(coordinates[g][0]);
            for (exact, by_group) in exact.iter_mut().zip(&degrees.by_group) {
                exact.push(by_group[g]);
            }
        }
    }
    let places: Vec<(NodeId, Option<usize>)> = places
        .into_iter()
        .map(|place| place.expect("groups partition the variables"))
        .collect();
    let mut padded = Padded {
        from: &system.expressions,
        padding: &padding,
        places: &places,
        parameters,
        done: HashMap::new(),
    };
    system
        .equations
        .iter()
        .zip(&exact)
        .map(|(&equation, exact)| {
            let (node, degree) = padded.homogenize(out, equation);
            if degree == *exact {
                node
            } else {
                padded.by_parts(out, equation, exact)
            }
        })
        .collect()
}

/// Degree in each affine group.
type MultiDegree = Vec<u32>;

struct Padded<'a> {
    from: &'a Expressions,
    padding: &'a [NodeId],
    places: &'a [(NodeId, Option<usize>)],
    parameters: &'a [NodeId],
    done: HashMap<NodeId, (NodeId, MultiDegree)>,
}

impl Padded<'_> {
    fn zero(&self) -> MultiDegree {
        vec![0; self.padding.len()]
    }

    /// The node multiplied by the powers that raise it from one degree to another.
    fn raise(
        &self,
        out: &mut Expressions,
        node: NodeId,
        from: &MultiDegree,
        to: &MultiDegree,
    ) -> NodeId {
        let mut node = node;
        for (g, &coordinate) in self.padding.iter().enumerate() {
            let power = out.power(coordinate, to[g] - from[g]);
            node = out.multiply(power, node);
        }
        node
    }

    /// A leaf of the system: what stands for it, and its degree.
    fn leaf(&self, out: &mut Expressions, node: &Node) -> Option<(NodeId, MultiDegree)> {
        let mut degree = self.zero();
        match node {
            Node::Constant(c) => Some((out.constant(c.clone()), degree)),
            Node::Parameter(p) => Some((self.parameters[*p as usize], degree)),
            Node::Variable(v) => {
                let (place, axis) = self.places[*v as usize];
                if let Some(axis) = axis {
                    degree[axis] = 1;
                }
                Some((place, degree))
            }
            _ => None,
        }
    }

    /// Pads sums on the way up; the degree is that of the form.
    fn homogenize(&mut self, out: &mut Expressions, root: NodeId) -> (NodeId, MultiDegree) {
        for id in below(self.from, &[root]) {
            if self.done.contains_key(&id) {
                continue;
            }
            let node = self.from.node(id);
            let result = if let Some(leaf) = self.leaf(out, node) {
                leaf
            } else {
                match node {
                    Node::Add(a, b) | Node::Subtract(a, b) => {
                        let ((a, da), (b, db)) = (&self.done[a], &self.done[b]);
                        let degree: MultiDegree =
                            da.iter().zip(db).map(|(&x, &y)| x.max(y)).collect();
                        let a = self.raise(out, *a, da, &degree);
                        let b = self.raise(out, *b, db, &degree);
                        let sum = if matches!(node, Node::Add(..)) {
                            out.add(a, b)
                        } else {
                            out.subtract(a, b)
                        };
                        (sum, degree)
                    }
                    Node::Multiply(a, b) => {
                        let ((a, da), (b, db)) = (&self.done[a], &self.done[b]);
                        let degree = da
                            .iter()
                            .zip(db)
                            .map(|(x, y)| x.saturating_add(*y))
                            .collect();
                        (out.multiply(*a, *b), degree)
                    }
                    Node::Divide(a, b) => {
                        let ((a, da), (b, _)) = (&self.done[a], &self.done[b]);
                        (out.divide(*a, *b), da.clone())
                    }
                    Node::Negate(a) => {
                        let (a, da) = &self.done[a];
                        (out.negate(*a), da.clone())
                    }
                    Node::Power(a, exponent) => {
                        let (a, da) = &self.done[a];
                        let degree = da.iter().map(|d| d.saturating_mul(*exponent)).collect();
                        (out.power(*a, *exponent), degree)
                    }
                    Node::Root(a, exponent) => {
                        let root = out.root(self.done[a].0, exponent.clone());
                        (root, self.zero())
                    }
                    Node::Function(function, a) => {
                        (out.function(*function, self.done[a].0), self.zero())
                    }
                    Node::Constant(_) | Node::Parameter(_) | Node::Variable(_) => {
                        unreachable!("leaves were handled above")
                    }
                }
            };
            self.done.insert(id, result);
        }
        self.done[&root].clone()
    }

    /// The sum of all homogeneous parts up to the exact degree, each raised to it.
    fn by_parts(&mut self, out: &mut Expressions, root: NodeId, exact: &MultiDegree) -> NodeId {
        // Products only raise degrees and sums keep them, so what is above the
        // exact degree anywhere ends in parts of the root that vanish.
        let within = |degree: &MultiDegree| degree.iter().zip(exact).all(|(d, e)| d <= e);
        let mut parts: HashMap<NodeId, BTreeMap<MultiDegree, NodeId>> = HashMap::new();
        for id in below(self.from, &[root]) {
            let node = self.from.node(id);
            let mut result: BTreeMap<MultiDegree, NodeId> = BTreeMap::new();
            let product = |out: &mut Expressions,
                           a: &BTreeMap<MultiDegree, NodeId>,
                           b: &BTreeMap<MultiDegree, NodeId>| {
                let mut result = BTreeMap::new();
                for (da, &a) in a {
                    for (db, &b) in b {
                        let degree: MultiDegree = da
                            .iter()
                            .zip(db)
                            .map(|(x, y)| x.saturating_add(*y))
                            .collect();
                        if within(&degree) {
                            let term = out.multiply(a, b);
                            accumulate(out, &mut result, degree, term);
                        }
                    }
                }
                result
            };
            match node {
                Node::Add(a, b) | Node::Subtract(a, b) => {
                    result = parts[a].clone();
                    for (degree, &part) in &parts[b] {
                        let part = if matches!(node, Node::Add(..)) {
                            part
                        } else {
                            out.negate(part)
                        };
                        accumulate(out, &mut result, degree.clone(), part);
                    }
                }
                Node::Multiply(a, b) => result = product(out, &parts[a], &parts[b]),
                Node::Power(a, exponent) => {
                    let one = out.integer(1);
                    result.insert(self.zero(), one);
                    let mut square = parts[a].clone();
                    let mut e = *exponent;
                    while e > 0 {
                        if e & 1 == 1 {
                            result = product(out, &result, &square);
                        }
                        e >>= 1;
                        if e > 0 {
                            square = product(out, &square, &square);
                        }
                    }
                }
                Node::Divide(a, b) => {
                    let denominator = self.homogenize(out, *b).0;
                    for (degree, &part) in &parts[a] {
                        result.insert(degree.clone(), out.divide(part, denominator));
                    }
                }
                Node::Negate(a) => {
                    for (degree, &part) in &parts[a] {
                        result.insert(degree.clone(), out.negate(part));
                    }
                }
                Node::Constant(_)
                | Node::Parameter(_)
                | Node::Variable(_)
                | Node::Root(..)
                | Node::Function(..) => {
                    let (node, degree) = self.homogenize(out, id);
                    if within(&degree) {
                        result.insert(degree, node);
                    }
                }
            }
            parts.insert(id, result);
        }
        let mut sum = out.integer(0);
        for (degree, &part) in &parts[&root] {
            let raised = self.raise(out, part, degree, exact);
            sum = out.add(sum, raised);
        }
        sum
    }
}

/// Adds a part to those of its degree; what cancels is dropped.
fn accumulate(
    out: &mut Expressions,
    parts: &mut BTreeMap<MultiDegree, NodeId>,
    degree: MultiDegree,
    part: NodeId,
) {
    let sum = match parts.get(&degree) {
        Some(&sum) => out.add(sum, part),
        None => part,
    };
    if out.as_constant(sum).is_some_and(|c| c.is_zero()) {
        parts.remove(&degree);
    } else {
        parts.insert(degree, sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::exact;
    use crate::named;
    use crate::polynomial::degrees;
    use crate::system::VariableGroup;
    use cognate_numeric::rational::{ComplexRational, Rational};

    /// Homogenises with new variables for all coordinates; checks that 1 for
    /// the homogenising ones gives the system back, that each equation scales
    /// with its exact degree in each group, and that no power of a
    /// homogenising coordinate is a factor.
    fn check(system: &System) {
        let d = degrees(system).expect("polynomial");
        let mut out = Expressions::new();
        let mut next = 0..;
        let coordinates: Vec<Vec<NodeId>> = system
            .groups
            .iter()
            .map(|group| {
                let count = group.variables.len() + usize::from(!group.homogeneous);
                next.by_ref().take(count).map(|v| out.variable(v)).collect()
            })
            .collect();
        let parameters: Vec<NodeId> = (0..system.parameters.len() as u32)
            .map(|p| out.parameter(p))
            .collect();
        let nodes = homogenize(system, &d, &mut out, &coordinates, &parameters);
        let number = |k: usize| ComplexRational::new(Rational::from((k as i64 * 7 % 11 + 1, 3)), 2);
        let p: Vec<ComplexRational> = (0..parameters.len()).map(|k| number(k + 40)).collect();
        let x: Vec<ComplexRational> = (0..system.variable_count()).map(number).collect();
        let values = |scale: &[i64], homogenising: &[i64]| {
            let point: Vec<ComplexRational> = system
                .groups
                .iter()
                .zip(scale.iter().zip(homogenising))
                .flat_map(|(group, (&scale, &homogenising))| {
                    let first = (!group.homogeneous).then(|| ComplexRational::real(homogenising));
                    first
                        .into_iter()
                        .chain(group.variables.iter().map(|&v| x[v].clone()))
                        .map(move |z| z.multiply(&ComplexRational::real(scale)))
                })
                .collect();
            exact::values(&out, &nodes, &point, &p)
        };
        let ones = vec![1; system.groups.len()];
        let affine = exact::values(&system.expressions, &system.equations, &x, &p);
        assert_eq!(values(&ones, &ones), affine);
        let fives = vec![5; system.groups.len()];
        let at = values(&ones, &fives);
        for g in 0..system.groups.len() {
            let mut scale = ones.clone();
            scale[g] = 3;
            for (i, scaled) in values(&scale, &fives).into_iter().enumerate() {
                let factor = ComplexRational::real(3).power(d.by_group[i][g]);
                let expected = at[i].as_ref().map(|v| v.multiply(&factor));
                assert_eq!(scaled, expected, "equation {i}, group {g}");
            }
        }
        for g in 0..system.groups.len() {
            let mut at_infinity = ones.clone();
            at_infinity[g] = 0;
            for value in values(&ones, &at_infinity) {
                assert!(value.is_some_and(|v| !v.is_zero()), "a spurious factor");
            }
        }
    }

    #[test]
    fn classical_systems() {
        for named in [
            named::katsura(4),
            named::noon(4),
            named::eco(5),
            named::caprasse(),
            named::reimer(3),
        ] {
            let mut system = named.system;
            check(&system);
            let n = system.variable_count();
            system.groups = [0..2, 2..n]
                .map(|variables| VariableGroup {
                    variables: variables.collect(),
                    homogeneous: false,
                })
                .into();
            check(&system);
        }
    }

    /// x^2*((y + z/q)^5 - y^5) + p*u*x*y with x | y, z affine, u homogeneous
    /// and alone in the second term's group of u, v.
    #[test]
    fn cancellation_leaves_no_factor_at_infinity() {
        let mut e = Expressions::new();
        let [x, y, z, u, v] = [0, 1, 2, 3, 4].map(|k| e.variable(k));
        let (p, q) = (e.parameter(0), e.parameter(1));
        let one = e.integer(1);
        let shift = e.divide(one, q);
        let shifted = e.add(y, shift);
        let (a, b) = (e.power(shifted, 5), e.power(y, 5));
        let difference = e.subtract(a, b);
        let square = e.power(x, 2);
        let first = e.multiply(square, difference);
        let first = e.multiply(first, v);
        let second = e.multiply(p, u);
        let second = e.multiply(second, z);
        let f = e.add(first, second);
        // (x + z)^3 - x^3 - 3 x^2 z has degree 1 in x and 3 in z.
        let sum = e.add(x, z);
        let (a, b) = (e.power(sum, 3), e.power(x, 3));
        let cube = e.subtract(a, b);
        let three = e.integer(3);
        let middle = e.multiply(three, square);
        let middle = e.multiply(middle, z);
        let g = e.subtract(cube, middle);
        let system = System {
            expressions: e,
            variables: ["x", "y", "z", "u", "v"].map(String::from).into(),
            parameters: ["p", "q"].map(String::from).into(),
            equations: vec![f, g],
            groups: [(vec![0], false), (vec![1, 2], false), (vec![3, 4], true)]
                .map(|(variables, homogeneous)| VariableGroup {
                    variables,
                    homogeneous,
                })
                .into(),
            ..System::default()
        };
        let d = degrees(&system).expect("polynomial");
        assert_eq!(d.by_group, [[2, 4, 1], [1, 3, 0]]);
        check(&system);
    }
}

//! CountedEquations: the equations of a system over a prime field, with as many solutions as the system has.
//!
//! Rational numbers become residues. A square root of a rational number is one more unknown: all its conjugates are
//! counted, which have the same number of solutions. One transcendental number is a random residue, since there is no
//! relation that it fulfils. Of other constants, and of parameters with many digits, nobody knows which relations they
//! fulfil: with random residues the count is that of general values.

use super::chosen::is_chosen;
use super::groebner::Terms;
use super::monomial::{MOST_VARIABLES, Monomial};
use super::not_counted::NotCounted;
use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Function, Node, NodeId};
use crate::polynomial::Polynomial;
use crate::polynomial::dual_dimensions::{FIELD, PRIME};
use crate::system::System;
use crate::transform::clear_denominators::denominator_factors;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use foldhash::{HashMap, HashMapExt};
use num_complex::Complex64;

/// Square roots that are unknowns: each doubles the number of solutions that are counted.
const MOST_SQUARE_ROOTS: usize = 3;

/// Equations over the prime field.
pub(super) struct CountedEquations {
    /// Number of variables, those of square roots included.
    pub variables: usize,
    pub equations: Vec<Terms>,
    /// Polynomials that are 0 at no solution.
    pub denominators: Vec<Terms>,
    /// Number of conjugate systems that are counted together.
    pub conjugates: u64,
    /// Whether the numbers are those of general values of some constants or parameters.
    pub is_general: bool,
    /// Whether only parameters are general, each of which has the value of its double.
    pub is_exact: bool,
}

impl CountedEquations {
    /// The equations of a system whose parameters have these values.
    pub fn of(system: &System, parameters: &[Complex64]) -> Result<Self, NotCounted> {
        if parameters.len() != system.parameters.len() {
            return Err(NotCounted::Parameters);
        }
        let equations: Vec<NodeId> = system
            .equations
            .iter()
            .map(|&equation| without_constant_factors(&system.expressions, equation))
            .collect();
        let denominators = denominator_factors(system);
        let polynomials = [equations.as_slice(), denominators.as_slice()].concat();
        let mut constants = Constants::of(system, parameters, &polynomials)?;
        let variables = system.variable_count() + constants.radicands.len();
        if variables > MOST_VARIABLES {
            return Err(NotCounted::Unknowns);
        }
        let mut terms = constants.terms_of_each(&equations, variables)?;
        let denominators = constants.terms_of_each(&denominators, variables)?;
        for (k, radicand) in constants.radicands.iter().enumerate() {
            let root = Monomial::variable(variables, system.variable_count() + k);
            let radicand = FIELD.complex(&ComplexRational::real(radicand.clone()));
            let radicand = radicand.ok_or(NotCounted::Constants)?;
            terms.push(vec![
                (root.times(root), 1),
                (Monomial::default(), PRIME - radicand),
            ]);
        }
        for (g, group) in system.groups.iter().enumerate() {
            if group.homogeneous {
                terms.push(general_hyperplane(g, &group.variables, variables));
            }
        }
        Ok(Self {
            variables,
            equations: terms,
            denominators,
            conjugates: 1 << constants.radicands.len(),
            is_general: constants.is_general,
            is_exact: constants.is_exact,
        })
    }
}

/// Points of a projective space are those of an affine one where a general linear form is 1.
fn general_hyperplane(group: usize, members: &[usize], variables: usize) -> Terms {
    let mut stream = RandomStream::new(1 << 34, Purpose::Probe, group as u64);
    let mut terms: Terms = members
        .iter()
        .map(|&v| (Monomial::variable(variables, v), nonzero(&mut stream)))
        .collect();
    terms.sort_unstable_by_key(|&(monomial, _)| std::cmp::Reverse(monomial));
    terms.push((Monomial::default(), PRIME - 1));
    terms
}

fn nonzero(stream: &mut RandomStream) -> u64 {
    1 + stream.below(PRIME - 1)
}

/// An equation has the solutions that it has without a factor that is a number.
pub(in crate::polynomial) fn without_constant_factors(
    expressions: &Expressions,
    mut equation: NodeId,
) -> NodeId {
    loop {
        equation = match *expressions.node(equation) {
            Node::Multiply(a, b) if is_nonzero(expressions, a) => b,
            Node::Multiply(a, b) if is_nonzero(expressions, b) => a,
            Node::Divide(a, b) if is_nonzero(expressions, b) => a,
            Node::Negate(a) => a,
            _ => return equation,
        };
    }
}

/// Whether an expression is clearly a number that is not 0.
fn is_nonzero(expressions: &Expressions, id: NodeId) -> bool {
    match expressions.node(id) {
        Node::Constant(c) => !c.is_zero(),
        Node::Function(Function::Pi | Function::Exponential, _) => true,
        Node::Function(Function::SquareRoot, a) | Node::Power(a, _) | Node::Negate(a) => {
            is_nonzero(expressions, *a)
        }
        Node::Root(a, _) => is_nonzero(expressions, *a),
        Node::Multiply(a, b) | Node::Divide(a, b) => {
            is_nonzero(expressions, *a) && is_nonzero(expressions, *b)
        }
        _ => false,
    }
}

/// Representation of a constant that is not rational.
#[derive(Clone, Copy, PartialEq)]
enum Irrational {
    /// The root of the radicand with this number.
    SquareRoot(usize),
    /// The leaf with this number.
    Leaf(usize),
}

/// The numbers in the equations that are not rational.
struct Constants<'a> {
    system: &'a System,
    /// Positive rational numbers, of which no product of several is a square.
    radicands: Vec<Rational>,
    irrational: HashMap<NodeId, Irrational>,
    /// Residues of parameters and, after them, of leaves.
    leaves: Vec<u64>,
    is_general: bool,
    is_exact: bool,
}

/// Equations with rational coefficients in the unknowns of a system and, after them, square roots of rational numbers.
pub(in crate::polynomial) struct RationalForm {
    pub expressions: Expressions,
    pub equations: Vec<NodeId>,
    /// Polynomials that are 0 at no solution.
    pub denominators: Vec<NodeId>,
    /// Positive rational numbers, whose roots are unknowns.
    pub radicands: Vec<Rational>,
}

impl RationalForm {
    /// `None` where a constant is neither rational nor a square root of a rational number.
    pub fn of(system: &System) -> Option<Self> {
        let given = system.equations.iter();
        let given = given.map(|&equation| without_constant_factors(&system.expressions, equation));
        let given: Vec<NodeId> = given.collect();
        let given_denominators = denominator_factors(system);
        let polynomials = [given.as_slice(), given_denominators.as_slice()].concat();
        // Parameters stay parameters: their values are of no interest here.
        let values = vec![Complex64::default(); system.parameters.len()];
        let mut constants = Constants::of(system, &values, &polynomials).ok()?;
        let mut expressions = Expressions::new();
        let mut rational = |nodes: &[NodeId]| -> Vec<NodeId> {
            let nodes = nodes.iter();
            nodes
                .map(|&node| constants.rational(node, &mut expressions))
                .collect()
        };
        let equations = rational(&given);
        let denominators = rational(&given_denominators);
        let is_rational = constants.leaves.len() == system.parameters.len();
        is_rational.then_some(Self {
            expressions,
            equations,
            denominators,
            radicands: constants.radicands,
        })
    }
}

impl<'a> Constants<'a> {
    fn of(
        system: &'a System,
        parameters: &[Complex64],
        polynomials: &[NodeId],
    ) -> Result<Self, NotCounted> {
        let mut constants = Self {
            system,
            radicands: Vec::new(),
            irrational: HashMap::new(),
            leaves: Vec::new(),
            is_general: false,
            is_exact: true,
        };
        for value in parameters {
            let value = ComplexRational::from_doubles(*value).ok_or(NotCounted::Parameters)?;
            constants.is_general |= !is_chosen(&value);
            let residue = FIELD.complex(&value).ok_or(NotCounted::Parameters)?;
            constants.leaves.push(residue);
        }
        constants.find(polynomials);
        Ok(constants)
    }

    /// Finds the constants of the polynomials, and whether relations between them are known.
    fn find(&mut self, polynomials: &[NodeId]) {
        let expressions = &self.system.expressions;
        let nodes = below(expressions, polynomials);
        let mut radicands: Vec<Rational> = Vec::new();
        for id in &nodes {
            if let Some(radicand) = radicand(expressions, *id)
                && !radicands.contains(&radicand)
            {
                radicands.push(radicand);
            }
        }
        if radicands.len() <= MOST_SQUARE_ROOTS && are_independent(&radicands) {
            self.radicands = radicands;
        }
        let mut transcendental: Vec<Node> = Vec::new();
        for id in nodes {
            let node = expressions.node(id);
            if !matches!(node, Node::Function(..) | Node::Root(..)) {
                continue;
            }
            let root = radicand(expressions, id);
            let number = root.and_then(|root| self.radicands.iter().position(|r| *r == root));
            if let Some(root) = number {
                self.irrational.insert(id, Irrational::SquareRoot(root));
                continue;
            }
            match transcendental_source(expressions, id) {
                Some(source) if transcendental.contains(&source) => {}
                Some(source) => transcendental.push(source),
                None => self.stand_for_others(),
            }
            let residue = residue_of(node, id);
            self.new_leaf(id, residue);
        }
        if transcendental.len() > 1 {
            self.stand_for_others();
        }
    }

    /// A general number stands for a constant.
    fn stand_for_others(&mut self) {
        self.is_general = true;
        self.is_exact = false;
    }

    fn new_leaf(&mut self, id: NodeId, residue: u64) {
        self.irrational
            .insert(id, Irrational::Leaf(self.leaves.len()));
        self.leaves.push(residue);
    }

    /// Polynomials over the field.
    fn terms_of_each(
        &mut self,
        polynomials: &[NodeId],
        variables: usize,
    ) -> Result<Vec<Terms>, NotCounted> {
        let polynomials = polynomials.iter();
        polynomials.map(|&p| self.terms(p, variables)).collect()
    }

    /// A polynomial over the field.
    fn terms(&mut self, polynomial: NodeId, variables: usize) -> Result<Terms, NotCounted> {
        let mut rational = Expressions::new();
        let root = self.rational(polynomial, &mut rational);
        let polynomial = Polynomial::expand(&rational, root, variables, self.leaves.len());
        let polynomial = polynomial.ok_or(NotCounted::Terms)?;
        let mut residues: HashMap<Monomial, u64> = HashMap::new();
        for (exponents, c) in &polynomial.terms {
            let (of_variables, of_leaves) = exponents.split_at(variables);
            let monomial = Monomial::new(of_variables).ok_or(NotCounted::Degree)?;
            let mut residue = FIELD.complex(c).ok_or(NotCounted::Constants)?;
            for (&leaf, &exponent) in self.leaves.iter().zip(of_leaves) {
                residue = FIELD.mul(residue, FIELD.power(leaf, u64::from(exponent)));
            }
            let sum = residues.entry(monomial).or_default();
            *sum = (*sum + residue) % PRIME;
        }
        let mut terms: Terms = residues.into_iter().filter(|&(_, c)| c != 0).collect();
        terms.sort_unstable_by_key(|&(monomial, _)| std::cmp::Reverse(monomial));
        Ok(terms)
    }

    /// Rewrites an expression with unknowns for square roots and parameters for other constants that are not rational.
    fn rational(&mut self, root: NodeId, out: &mut Expressions) -> NodeId {
        let system = self.system;
        let expressions = &system.expressions;
        let square_root = |k: usize| (system.variable_count() + k) as u32;
        let mut copies: HashMap<NodeId, NodeId> = HashMap::new();
        for id in below(expressions, &[root]) {
            let copy = match expressions.node(id) {
                Node::Constant(c) => out.constant(c.clone()),
                Node::Variable(v) => out.variable(*v),
                Node::Parameter(p) => out.parameter(*p),
                Node::Add(a, b) => out.add(copies[a], copies[b]),
                Node::Subtract(a, b) => out.subtract(copies[a], copies[b]),
                Node::Multiply(a, b) => out.multiply(copies[a], copies[b]),
                Node::Negate(a) => out.negate(copies[a]),
                Node::Power(a, exponent) => out.power(copies[a], *exponent),
                Node::Root(..) | Node::Function(..) => match self.irrational[&id] {
                    Irrational::SquareRoot(k) => out.variable(square_root(k)),
                    Irrational::Leaf(k) => out.parameter(k as u32),
                },
                Node::Divide(a, b) => match self.irrational.get(b) {
                    _ if expressions.dependence(*b) == Dependence::Variables => {
                        out.insert(Node::Divide(copies[a], copies[b]))
                    }
                    // 1/s = s/r where s is the root of r.
                    Some(&Irrational::SquareRoot(k)) => {
                        let radicand = ComplexRational::real(self.radicands[k].clone());
                        let root = out.variable(square_root(k));
                        let product = out.multiply(copies[a], root);
                        let radicand = out.constant(radicand);
                        out.divide(product, radicand)
                    }
                    _ => {
                        let inverse = self.inverse_leaf(*b);
                        let inverse = out.parameter(inverse as u32);
                        out.multiply(copies[a], inverse)
                    }
                },
            };
            copies.insert(id, copy);
        }
        copies[&root]
    }

    /// The leaf of the inverse of a constant or a parameter.
    fn inverse_leaf(&mut self, denominator: NodeId) -> usize {
        let leaf = match (
            self.system.expressions.node(denominator),
            self.irrational.get(&denominator),
        ) {
            (Node::Parameter(p), _) => Some(*p as usize),
            (_, Some(&Irrational::Leaf(leaf))) => Some(leaf),
            _ => None,
        };
        let residue = match leaf.and_then(|leaf| FIELD.inverse(self.leaves[leaf])) {
            Some(inverse) => inverse,
            None => {
                self.stand_for_others();
                random_residue(5, u64::from(denominator.0))
            }
        };
        self.leaves.push(residue);
        self.leaves.len() - 1
    }
}

/// The positive rational number, no square, of which a node is the square root.
fn radicand(expressions: &Expressions, id: NodeId) -> Option<Rational> {
    let argument = match expressions.node(id) {
        Node::Function(Function::SquareRoot, a) => *a,
        Node::Root(a, exponent) if *exponent.numer() == 1 && *exponent.denom() == 2 => *a,
        _ => return None,
    };
    let c = expressions.as_constant(argument)?;
    (c.is_real() && c.re > 0 && !is_square(&c.re)).then(|| c.re.clone())
}

fn is_square(number: &Rational) -> bool {
    number.numer().is_perfect_square() && number.denom().is_perfect_square()
}

/// Whether no product of some of these numbers is a square: then any choice of signs of their roots is conjugate to
/// any other.
fn are_independent(numbers: &[Rational]) -> bool {
    (1u32..1 << numbers.len()).all(|chosen| {
        let mut product = Rational::from(1);
        for (k, number) in numbers.iter().enumerate() {
            if chosen >> k & 1 == 1 {
                product *= number;
            }
        }
        !is_square(&product)
    })
}

/// A transcendental number of which a node is a rational function: pi, or the exponential function, a logarithm or the
/// tangent of half of a rational number (F. Lindemann, Über die Zahl pi, 1882). `None` where a node is none, as far as
/// is known.
fn transcendental_source(expressions: &Expressions, id: NodeId) -> Option<Node> {
    let Node::Function(function, argument) = *expressions.node(id) else {
        return None;
    };
    if function == Function::Pi {
        return Some(Node::Function(Function::Pi, argument));
    }
    let c = expressions.as_constant(argument)?;
    let is_trivial = c.is_zero() || (function == Function::Logarithm && c.is_one());
    if is_trivial || !c.is_real() {
        return None;
    }
    match function {
        Function::Sine | Function::Cosine | Function::Tangent => {
            Some(Node::Function(Function::Tangent, argument))
        }
        Function::Exponential | Function::Logarithm => Some(Node::Function(function, argument)),
        Function::SquareRoot | Function::Pi => None,
    }
}

/// A random residue of a constant; sine, cosine and tangent of one number fit together.
fn residue_of(node: &Node, id: NodeId) -> u64 {
    let Node::Function(
        function @ (Function::Sine | Function::Cosine | Function::Tangent),
        argument,
    ) = node
    else {
        return random_residue(3, u64::from(id.0));
    };
    // From the tangent u of half of the angle: (1 - u^2, 2 u)/(1 + u^2).
    let u = random_residue(4, u64::from(argument.0));
    let square = FIELD.mul(u, u);
    let [more, less, double] = [FIELD.add(1, square), FIELD.sub(1, square), FIELD.add(u, u)];
    let [numerator, denominator] = match function {
        Function::Sine => [double, more],
        Function::Cosine => [less, more],
        _ => [double, less],
    };
    FIELD.mul(numerator, FIELD.inverse(denominator).unwrap_or(1))
}

fn random_residue(kind: u64, index: u64) -> u64 {
    nonzero(&mut RandomStream::new(
        (1 << 34) + kind,
        Purpose::Probe,
        index,
    ))
}

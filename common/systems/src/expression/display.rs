//! Display: expressions as text, with no more brackets than their structure needs.
//!
//! Reading the text again gives the same value, bit for bit in any arithmetic
//! that rounds symmetrically: only signs may move. Nothing here recurses.

use super::{Expressions, Function, Node, NodeId};
use cognate_numeric::rational::ComplexRational;
use std::borrow::Cow;
use std::collections::HashMap;

/// Differences between the notations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// The imaginary unit.
    pub imaginary: &'static str,
    /// Whether every constant that is no natural number stands in brackets, as PHCpack wants it.
    pub bracketed_constants: bool,
}

impl Style {
    /// Bertini-classic and our JSON.
    pub const BERTINI: Style = Style {
        imaginary: "I",
        bracketed_constants: false,
    };
    /// PHCpack.
    pub const PHCPACK: Style = Style {
        imaginary: "i",
        bracketed_constants: true,
    };
}

/// Strength with which the outermost operator of a text binds.
type Level = u8;
const SUM: Level = 1;
const PRODUCT: Level = 2;
const POWER: Level = 4;
const ATOM: Level = 5;

/// Context for printing the expressions of one system.
#[derive(Clone, Copy, Debug)]
pub struct Display<'a> {
    /// The graph.
    pub expressions: &'a Expressions,
    /// Names of the variables.
    pub variables: &'a [String],
    /// Names of the parameters.
    pub parameters: &'a [String],
    /// Subexpressions that have a name of their own.
    pub shared: &'a HashMap<NodeId, String>,
    /// The notation.
    pub style: Style,
}

enum Work {
    Text(Cow<'static, str>),
    /// A node, the weakest level that needs no brackets, whether it must not
    /// begin with a minus, and whether its sign is turned.
    Node {
        id: NodeId,
        level: Level,
        plain: bool,
        negated: bool,
    },
}

fn node(id: NodeId, level: Level, plain: bool) -> Work {
    Work::Node {
        id,
        level,
        plain,
        negated: false,
    }
}

impl Display<'_> {
    /// The text of a node; its own name is not used, only those of the nodes below it.
    pub fn text(&self, root: NodeId) -> String {
        let mut out = String::new();
        let mut work = Vec::new();
        self.open(root, false, &mut out, &mut work);
        while let Some(next) = work.pop() {
            match next {
                Work::Text(text) => out.push_str(&text),
                Work::Node {
                    id,
                    level,
                    plain,
                    negated,
                } => {
                    if let Some(name) = self.shared.get(&id).filter(|_| !negated) {
                        out.push_str(name);
                    } else if !negated && self.needs_brackets(id, level, plain) {
                        out.push('(');
                        work.push(Work::Text(")".into()));
                        self.open(id, false, &mut out, &mut work);
                    } else {
                        self.open(id, negated, &mut out, &mut work);
                    }
                }
            }
        }
        out
    }

    /// True when the node's text must stand in brackets as an operand.
    fn needs_brackets(&self, id: NodeId, level: Level, plain: bool) -> bool {
        self.level(id) < level || plain && self.begins_with_minus(id)
    }

    /// The operands of a node, and whether each of them stands in brackets.
    pub(crate) fn bracketed(&self, id: NodeId) -> [Option<(NodeId, bool)>; 2] {
        let operand = |id, level, plain| Some((id, self.needs_brackets(id, level, plain)));
        match self.expressions.node(id) {
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => [None, None],
            Node::Add(..) | Node::Subtract(..) => {
                let (a, b) = self.ordered(id);
                [operand(a, SUM, false), operand(b, PRODUCT, true)]
            }
            Node::Multiply(..) | Node::Divide(..) => {
                let (a, b) = self.ordered(id);
                [operand(a, PRODUCT, false), operand(b, POWER, true)]
            }
            Node::Negate(a) => [operand(*a, PRODUCT, true), None],
            Node::Power(a, _) | Node::Root(a, _) => [operand(*a, ATOM, true), None],
            Node::Function(_, a) => [Some((*a, true)), None],
        }
    }

    /// Writes what comes before the first operand, and puts the rest on the stack.
    fn open(&self, id: NodeId, negated: bool, out: &mut String, work: &mut Vec<Work>) {
        match self.expressions.node(id) {
            Node::Constant(c) if negated => self.constant(&c.negate(), out),
            Node::Constant(c) => self.constant(c, out),
            Node::Variable(v) => out.push_str(&self.variables[*v as usize]),
            Node::Parameter(p) => out.push_str(&self.parameters[*p as usize]),
            kind @ (Node::Add(..) | Node::Subtract(..)) => {
                let (a, b) = self.ordered(id);
                let minus = matches!(kind, Node::Subtract(..));
                let turn = self.is_negative(b);
                if turn {
                    work.push(Work::Node {
                        id: b,
                        level: SUM,
                        plain: false,
                        negated: true,
                    });
                } else {
                    work.push(node(b, PRODUCT, true));
                }
                work.push(Work::Text(if minus != turn {
                    " - ".into()
                } else {
                    " + ".into()
                }));
                work.push(node(a, SUM, false));
            }
            Node::Multiply(..) => {
                let (a, b) = self.ordered(id);
                work.push(node(b, POWER, true));
                work.push(Work::Text("*".into()));
                work.push(Work::Node {
                    id: a,
                    level: PRODUCT,
                    plain: false,
                    negated,
                });
            }
            Node::Divide(a, b) => {
                work.push(node(*b, POWER, true));
                work.push(Work::Text("/".into()));
                work.push(node(*a, PRODUCT, false));
            }
            Node::Negate(a) => {
                out.push('-');
                work.push(node(*a, PRODUCT, true));
            }
            Node::Power(a, exponent) => {
                work.push(Work::Text(format!("^{exponent}").into()));
                work.push(node(*a, ATOM, true));
            }
            Node::Root(a, exponent) => {
                work.push(Work::Text(format!("^({exponent})").into()));
                work.push(node(*a, ATOM, true));
            }
            Node::Function(Function::Pi, _) => out.push_str("Pi"),
            Node::Function(function, a) => {
                out.push_str(match function {
                    Function::SquareRoot => "sqrt(",
                    Function::Exponential => "exp(",
                    Function::Logarithm => "log(",
                    Function::Sine => "sin(",
                    Function::Cosine => "cos(",
                    Function::Tangent => "tan(",
                    Function::Pi => unreachable!("printed above"),
                });
                work.push(Work::Text(")".into()));
                work.push(node(*a, 0, false));
            }
        }
    }
    /// The operands in the order in which they are shown: what would need
    /// brackets on the right goes to the left, and a constant factor goes first.
    fn ordered(&self, id: NodeId) -> (NodeId, NodeId) {
        let (a, b) = match *self.expressions.node(id) {
            Node::Add(a, b) => {
                let turn = self.is_negative(a) && !self.is_negative(b)
                    || self.level(b) <= SUM && self.level(a) > SUM;
                return if turn { (b, a) } else { (a, b) };
            }
            Node::Multiply(a, b) => (a, b),
            Node::Subtract(a, b) | Node::Divide(a, b) => return (a, b),
            _ => unreachable!("only binary operations have two operands"),
        };
        let constant =
            |n| self.expressions.as_constant(n).is_some() && !self.shared.contains_key(&n);
        let turn = constant(b) && !constant(a)
            || !constant(a) && self.level(b) <= PRODUCT && self.level(a) > PRODUCT;
        if turn { (b, a) } else { (a, b) }
    }

    fn level(&self, id: NodeId) -> Level {
        if self.shared.contains_key(&id) {
            return ATOM;
        }
        match self.expressions.node(id) {
            Node::Constant(c) => self.constant_level(c),
            Node::Variable(_) | Node::Parameter(_) | Node::Function(..) => ATOM,
            Node::Add(..) | Node::Subtract(..) => SUM,
            Node::Multiply(..) | Node::Divide(..) | Node::Negate(_) => PRODUCT,
            Node::Power(..) | Node::Root(..) => POWER,
        }
    }

    fn constant_level(&self, c: &ComplexRational) -> Level {
        let whole = |n: &rug::Rational| *n.denom() == 1;
        if self.style.bracketed_constants || c.is_real() && whole(&c.re) && c.re >= 0 {
            ATOM
        } else if c.is_real() || c.re == 0 && c.im != 1 {
            PRODUCT
        } else if c.re == 0 {
            ATOM
        } else {
            SUM
        }
    }

    /// True when the sign of a node can be turned by turning that of its constant factor.
    fn is_negative(&self, id: NodeId) -> bool {
        if self.style.bracketed_constants || self.shared.contains_key(&id) {
            return false;
        }
        let constant = |id: NodeId| match self.expressions.node(id) {
            Node::Constant(c) if !self.shared.contains_key(&id) => {
                c.is_real() && c.re < 0 || c.re == 0 && c.im < 0
            }
            _ => false,
        };
        match self.expressions.node(id) {
            Node::Multiply(..) => constant(self.ordered(id).0),
            _ => constant(id),
        }
    }

    fn begins_with_minus(&self, id: NodeId) -> bool {
        let mut id = id;
        loop {
            if self.shared.contains_key(&id) {
                return false;
            }
            let first = match self.expressions.node(id) {
                Node::Constant(c) => {
                    let negative = c.re < 0 || c.re == 0 && c.im < 0;
                    return negative && !self.style.bracketed_constants;
                }
                Node::Negate(_) => return true,
                Node::Add(..) | Node::Subtract(..) | Node::Multiply(..) | Node::Divide(..) => {
                    let level = if self.level(id) == SUM { SUM } else { PRODUCT };
                    let first = self.ordered(id).0;
                    if self.level(first) < level {
                        return false;
                    }
                    first
                }
                // A base that begins with a minus stands in brackets.
                _ => return false,
            };
            id = first;
        }
    }

    fn constant(&self, c: &ComplexRational, out: &mut String) {
        let unit = self.style.imaginary;
        let imaginary = |im: &rug::Rational| {
            if *im == 1 {
                unit.to_string()
            } else if *im == -1 {
                format!("-{unit}")
            } else {
                format!("{im}*{unit}")
            }
        };
        if self.style.bracketed_constants {
            let natural = c.is_real() && *c.re.denom() == 1 && c.re >= 0;
            let text = match (natural, c.is_real(), c.re == 0) {
                (true, ..) => c.re.to_string(),
                (_, true, _) => format!("({})", c.re),
                (_, _, true) => format!("(({})*{unit})", c.im),
                _ => format!("(({})+({})*{unit})", c.re, c.im),
            };
            out.push_str(&text);
        } else if c.is_real() {
            out.push_str(&c.re.to_string());
        } else if c.re == 0 {
            out.push_str(&imaginary(&c.im));
        } else if c.im < 0 {
            let positive = rug::Rational::from(-&c.im);
            out.push_str(&format!("{} - {}", c.re, imaginary(&positive)));
        } else {
            out.push_str(&format!("{} + {}", c.re, imaginary(&c.im)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_stand_only_where_they_are_needed() {
        let names = ["x".to_string(), "y".to_string()];
        let mut e = Expressions::new();
        let (x, y) = (e.variable(0), e.variable(1));
        let (two, half) = (e.integer(2), e.constant(ComplexRational::real((-1, 2))));
        let complex = e.constant(ComplexRational::new((1, 2), -1));
        let sum = e.add(x, y);
        let product = e.multiply(x, y);
        let square = e.power(sum, 2);
        let tower = e.power(square, 3);
        let half_product = e.multiply(half, product);
        let cases = [
            (e.add(two, sum), "x + y + 2"),
            (e.subtract(x, sum), "x - (x + y)"),
            (e.add(x, half_product), "x - 1/2*(x*y)"),
            (e.subtract(x, half_product), "x + 1/2*(x*y)"),
            (e.multiply(product, x), "x*y*x"),
            (e.multiply(complex, x), "(1/2 - I)*x"),
            (e.negate(product), "-x*y"),
            (e.negate(sum), "-(x + y)"),
            (e.multiply(sum, square), "(x + y)*(x + y)^2"),
            (tower, "((x + y)^2)^3"),
            (e.root(two, (1, 2).into()), "2^(1/2)"),
            (e.insert(Node::Power(half, 3)), "(-1/2)^3"),
            (
                e.insert(Node::Divide(half_product, product)),
                "-1/2*(x*y)/(x*y)",
            ),
        ];
        let shared = HashMap::new();
        let display = Display {
            expressions: &e,
            variables: &names,
            parameters: &[],
            shared: &shared,
            style: Style::BERTINI,
        };
        for (node, text) in cases {
            assert_eq!(display.text(node), text);
        }
    }
}

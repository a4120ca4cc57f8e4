//! Condition: comparisons of expressions in unknowns and parameters, joined by `and`, `or` and `not`.
//!
//! Conditions select among the real solutions of a system. The formats read them; `solutions::selection` decides them
//! at a solution.

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};

/// Relation of the two sides of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
    /// `=`
    Equal,
    /// `!=`
    NotEqual,
}

impl Relation {
    /// The relation that holds where this one does not.
    fn opposite(self) -> Self {
        match self {
            Self::Less => Self::AtLeast,
            Self::AtMost => Self::Greater,
            Self::Greater => Self::AtMost,
            Self::AtLeast => Self::Less,
            Self::Equal => Self::NotEqual,
            Self::NotEqual => Self::Equal,
        }
    }

    /// The relation that holds on the border, too: `<=` of `<`.
    fn closed(self) -> Self {
        match self {
            Self::Less => Self::AtMost,
            Self::Greater => Self::AtLeast,
            other => other,
        }
    }
}

/// One condition. Comparisons name their difference, left side less right side, by its index in [`Conditions`].
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// A difference compared with 0.
    Comparison {
        /// Index of the difference.
        difference: usize,
        /// The relation of the difference to 0.
        relation: Relation,
    },
    /// Every one of these holds.
    Every(Vec<Condition>),
    /// At least one of these conditions holds.
    Any(Vec<Condition>),
    /// This condition does not hold.
    Not(Box<Condition>),
    /// One of two expressions with product 0 is 0, and the other is not negative.
    Complementary {
        /// Indices of the two expressions.
        differences: [usize; 2],
    },
}

/// A comparison of a difference with 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inequality {
    /// Index of the difference.
    pub difference: usize,
    /// Whether the difference is to be below 0, else above.
    pub is_upper: bool,
}

impl Condition {
    /// The condition, or where `is_negated` its negation, with the opposite comparison for `not` of a comparison.
    fn resolved(self, is_negated: bool) -> Self {
        let each = |conditions: Vec<Self>| {
            let conditions = conditions.into_iter();
            conditions.map(|c| c.resolved(is_negated)).collect()
        };
        match (self, is_negated) {
            (Self::Not(condition), _) => condition.resolved(!is_negated),
            (Self::Every(conditions), false) | (Self::Any(conditions), true) => {
                Self::Every(each(conditions))
            }
            (Self::Any(conditions), false) | (Self::Every(conditions), true) => {
                Self::Any(each(conditions))
            }
            (
                Self::Comparison {
                    difference,
                    relation,
                },
                true,
            ) => Self::Comparison {
                difference,
                relation: relation.opposite(),
            },
            (other, false) => other,
            (other, true) => Self::Not(Box::new(other)),
        }
    }
}

/// Conditions that hold together, over the unknowns and parameters of one system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Each condition as it was typed.
    pub texts: Vec<String>,
    /// The conditions, in the order of `texts`.
    pub conditions: Vec<Condition>,
    /// The graph of the differences.
    pub expressions: Expressions,
    /// The differences of all comparisons.
    pub differences: Vec<NodeId>,
}

impl Conditions {
    /// True where every solution is selected.
    pub fn is_empty(&self) -> bool {
        self.conditions.is_empty()
    }

    /// Whether differences have functions of unknowns or parameters, of which only values at points are known.
    pub fn have_functions(&self) -> bool {
        let e = &self.expressions;
        below(e, &self.differences).into_iter().any(|id| {
            matches!(e.node(id), Node::Root(..) | Node::Function(..))
                && e.dependence(id) != Dependence::Constant
        })
    }

    /// Adds the condition that a variable is at least 0, which was typed as this text.
    pub fn add_nonnegative(&mut self, variable: u32, text: String) {
        self.conditions.push(Condition::Comparison {
            difference: self.differences.len(),
            relation: Relation::AtLeast,
        });
        self.differences.push(self.expressions.variable(variable));
        self.texts.push(text);
    }

    /// Writes each `not` of a comparison as the opposite comparison.
    pub fn resolve_negations(&mut self) {
        for condition in &mut self.conditions {
            let given = std::mem::replace(condition, Condition::Every(Vec::new()));
            *condition = given.resolved(false);
        }
    }

    /// The comparisons with 0, where all conditions are `<`, `<=`, `>` or `>=` and hold together: the difference of each by
    /// its index, and whether it is to be negative. Else `None`.
    pub fn inequalities(&self) -> Option<Vec<Inequality>> {
        let mut inequalities = Vec::with_capacity(self.differences.len());
        let mut left: Vec<&Condition> = self.conditions.iter().rev().collect();
        while let Some(condition) = left.pop() {
            match condition {
                Condition::Every(conditions) => left.extend(conditions.iter().rev()),
                Condition::Comparison {
                    difference,
                    relation,
                } => inequalities.push(Inequality {
                    difference: *difference,
                    is_upper: match relation {
                        Relation::Less | Relation::AtMost => true,
                        Relation::Greater | Relation::AtLeast => false,
                        Relation::Equal | Relation::NotEqual => return None,
                    },
                }),
                _ => return None,
            }
        }
        Some(inequalities)
    }

    /// Closes the conditions: `<=` for `<` and `>=` for `>` in all comparisons that hold together.
    #[must_use]
    pub fn closed(&self) -> Self {
        let mut closed = self.clone();
        let mut left: Vec<&mut Condition> = closed.conditions.iter_mut().collect();
        while let Some(condition) = left.pop() {
            match condition {
                Condition::Every(conditions) => left.extend(conditions),
                Condition::Comparison { relation, .. } => *relation = relation.closed(),
                _ => {}
            }
        }
        closed
    }

    /// All conditions in one text.
    pub fn text(&self) -> String {
        match &self.texts[..] {
            [one] => one.clone(),
            several => {
                let is_alternative =
                    |text: &&String| text.split_whitespace().any(|word| word == "or");
                let joined = several.iter().map(|text| match is_alternative(&text) {
                    true => format!("({text})"),
                    false => text.clone(),
                });
                joined.collect::<Vec<String>>().join(" and ")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::conditions::add;
    use crate::system::System;

    /// `not` and `/=` were refused beside an objective (2026-11-30).
    #[test]
    fn negations_become_opposite_comparisons() {
        let system = System {
            variables: vec!["x".to_owned(), "y".to_owned()],
            ..System::default()
        };
        let read = |text: &str| {
            let mut conditions = Conditions::default();
            let read = add("--where", &[text.to_owned()], &system, &mut conditions);
            read.map(|()| conditions).expect(text)
        };
        let resolved = |text: &str| {
            let mut conditions = read(text);
            conditions.resolve_negations();
            conditions.conditions
        };
        let pairs = [
            ("not (x > 0 or y <= 1)", "x <= 0 and y > 1"),
            ("not (not (x < 0))", "x < 0"),
            ("not (x = 0 and y >= 1)", "x /= 0 or y < 1"),
        ];
        for (negated, expected) in pairs {
            assert_eq!(resolved(negated), read(expected).conditions, "{negated}");
        }
        assert_eq!(read("x /= 1").conditions, read("x != 1").conditions);
    }
}

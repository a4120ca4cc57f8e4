//! Constants among expressions: those in which no unknown and no parameter is left once all names are replaced. As an
//! equation, a constant holds always or never.

use super::text::Equations;
use crate::mechanism::{Mechanism, MechanismError};
use crate::plane::modulus;
use cognate_numeric::counted::counted;
use cognate_systems::evaluation;
use cognate_systems::expression::{Dependence, Node};
use num_complex::Complex64;

/// The unknown that is added to each expression, because an equation that is read must have one.
const ADDED: &str = "added_unknown";
/// Constants up to this are 0 in equations of rounded numbers, where lengths are about 1.
const ZERO: f64 = 1e-12;

impl Equations {
    /// The values of expressions; `None` of those that are no constants.
    pub(super) fn constants(
        &self,
        expressions: &[String],
        file: &str,
    ) -> Result<Vec<Option<Complex64>>, MechanismError> {
        let mut variables = self.variables();
        let added = variables.len();
        variables.push(ADDED.into());
        let sums = expressions.iter().map(|e| format!("({e})+{ADDED}"));
        let system = Self {
            groups: vec![variables],
            parameters: self.parameters.clone(),
            definitions: self.definitions.clone(),
            equations: sums.collect(),
            ..Self::default()
        }
        .system(file)?;
        let graph = &system.expressions;
        let is_added = |node: &Node| matches!(node, Node::Variable(v) if *v as usize == added);
        let value = |root: &_| {
            let constant = match graph.node(*root) {
                Node::Add(a, b) if is_added(graph.node(*b)) => (*a, 1.0),
                Node::Add(a, b) if is_added(graph.node(*a)) => (*b, 1.0),
                Node::Subtract(a, b) if is_added(graph.node(*a)) => (*b, -1.0),
                sum => return is_added(sum).then(Complex64::default),
            };
            let (node, sign) = constant;
            (graph.dependence(node) == Dependence::Constant)
                .then(|| evaluation::values(graph, &[node], &[], &[])[0] * sign)
        };
        Ok(system.equations.iter().map(value).collect())
    }

    /// As [`Self::drop_identities`]; where an equation does not hold two that contradict each other replace all.
    ///
    /// # Errors
    /// Where the equations have no unknowns: nothing moves.
    pub fn settle_constants(
        &mut self,
        mechanism: &Mechanism,
        length: f64,
    ) -> Result<Option<String>, MechanismError> {
        let gap = self.drop_identities(mechanism, length)?;
        let Some(unknown) = self.variables().into_iter().next() else {
            return Err(mechanism.error(match mechanism.graph().idle {
                0 => "nothing of it moves".to_owned(),
                idle => format!(
                    "nothing of it moves but for {}, of links about the lines of their balls",
                    counted(idle, "idle spin")
                ),
            }));
        };
        if gap.is_some() {
            // No equation may be a constant.
            self.equations = vec![unknown.clone(), format!("{unknown}-1")];
        }
        Ok(gap)
    }

    /// Takes out equations without unknowns, which hold up to rounding; a sentence where one does not hold. Lengths are
    /// about as long as `length`.
    pub(super) fn drop_identities(
        &mut self,
        mechanism: &Mechanism,
        length: f64,
    ) -> Result<Option<String>, MechanismError> {
        if self.equations.is_empty() {
            return Ok(None);
        }
        let constants = self.constants(&self.equations, &mechanism.file)?;
        let length = length.max(1.0);
        // Equations hold lengths, and squares of lengths.
        let is_open = |value: &&Complex64| modulus(**value) > ZERO * length * length;
        let gap = constants.iter().flatten().find(is_open);
        let gap = gap.map(|gap| format!(
            "a loop cannot close, whatever its joints do: one of its equations is {:.3e} and not 0",
            modulus(*gap)
        ));
        let mut values = constants.into_iter();
        self.equations.retain(|_| values.next().flatten().is_none());
        Ok(gap)
    }
}

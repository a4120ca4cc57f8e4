//! Conditions of options and of our JSON, in the unknowns and parameters of a system.

use super::json_value::Value;
use super::scope::{FieldFault, Scope, at};
use super::{FormatError, Source};
use crate::condition::{Condition, Conditions};
use crate::expression::build::Use;
use crate::expression::fault::{Fault, Span};
use crate::expression::{Expressions, NodeId};
use crate::system::System;

/// Adds conditions of an option, in the unknowns and parameters of a system, to those that there are.
///
/// # Errors
/// When a text is no condition, or uses a name that the system does not have; the message names `option`.
pub fn add(
    option: &str,
    texts: &[String],
    system: &System,
    conditions: &mut Conditions,
) -> Result<(), FormatError> {
    if texts.is_empty() {
        return Ok(());
    }
    let mut scope = Scope::of(&System {
        expressions: std::mem::take(&mut conditions.expressions),
        variables: system.variables.clone(),
        parameters: system.parameters.clone(),
        ..System::default()
    });
    for text in texts {
        let source = Source { name: option, text };
        let read = scope.condition(text, conditions);
        read.map_err(|fault| source.error(fault))?;
    }
    conditions.expressions = scope.into_expressions();
    Ok(())
}

/// The node of an expression of an option, such as that of `--sort`, with its graph.
///
/// # Errors
/// When the text is no expression, or uses a name that the system does not have.
pub fn expression(
    option: &str,
    text: &str,
    system: &System,
) -> Result<(Expressions, NodeId), FormatError> {
    let source = Source { name: option, text };
    let mut scope = Scope::of(system);
    let node = scope.expression(text);
    let node = node.map_err(|fault| source.error(fault))?;
    Ok((scope.into_expressions(), node))
}

/// The two expressions of each pair of the field `complementary` of our JSON, with their texts and the pair's place.
fn pairs(
    value: &Value<'_>,
    scope: &mut Scope,
) -> Result<Vec<([NodeId; 2], String, Span)>, FieldFault> {
    let mut pairs = Vec::new();
    let field = "complementary";
    let list = value.array("an array of pairs").map_err(at(field))?;
    for (i, pair) in list.iter().enumerate() {
        let field = format!("{field}[{i}]");
        let [first, second] = pair.array("a pair of expressions").map_err(at(&field))? else {
            let expected = "a pair of expressions";
            let fault = Fault::expected(pair.span, expected, "another number of them");
            return Err(FieldFault::new(field, fault));
        };
        let mut build = |value: &Value<'_>, place: usize| {
            let field = format!("{field}[{place}]");
            let text = value.text("an expression in quotes").map_err(at(&field))?;
            let text = format!("{} >= 0", text.text);
            let written = scope.parse(value, field)?;
            Ok::<_, FieldFault>((scope.build(&written, Use::Rational)?, text))
        };
        let (a, a_text) = build(first, 0)?;
        let (b, b_text) = build(second, 1)?;
        pairs.push(([a, b], format!("{a_text} and {b_text}"), pair.span));
    }
    Ok(pairs)
}

/// The products of the pairs of the field `complementary`, which become equations, with their places.
pub(crate) fn products(
    value: &Value<'_>,
    scope: &mut Scope,
) -> Result<Vec<(NodeId, Span)>, FieldFault> {
    let pairs = pairs(value, scope)?.into_iter();
    let product = |([a, b], _, place): ([NodeId; 2], String, Span)| {
        (scope.builder.expressions.multiply(a, b), place)
    };
    Ok(pairs.map(product).collect())
}

/// Adds the conditions of the field `complementary`. The graph of the scope is to become `conditions.expressions`.
pub(crate) fn complementary(
    value: &Value<'_>,
    scope: &mut Scope,
    conditions: &mut Conditions,
) -> Result<(), FieldFault> {
    for (expressions, text, _) in pairs(value, scope)? {
        let next = conditions.differences.len();
        conditions.differences.extend(expressions);
        conditions.texts.push(text);
        conditions.conditions.push(Condition::Complementary {
            differences: [next, next + 1],
        });
    }
    Ok(())
}

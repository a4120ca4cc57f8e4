//! Degenerate sets: named sets of endpoints that are no answers.

use super::json_value::{self, Value};
use super::scope::{FieldFault, Scope, at};
use super::{FormatError, Source, decode, limits};
use crate::expression::build::Use;
use crate::expression::fault::Fault;
use crate::system::{DegenerateSet, System};
use crate::transform::clear_denominators::ZERO_DENOMINATOR;
use std::collections::BTreeMap;

/// Reads a file of degenerate sets, `{"name": {"nonzero": "expression"}}` or
/// `{"name": {"equations": [..]}}`, in addition to those that the system has.
pub fn read(name: &str, content: &[u8], system: &mut System) -> Result<(), FormatError> {
    let text = decode(name, content, limits::FILE_BYTES)?;
    let source = Source { name, text };
    let value = json_value::parse(text, 0, text.len()).map_err(|fault| source.error(fault))?;
    let mut scope = Scope::of(system);
    let sets = sets(&value, "", &mut scope).map_err(|fault| fault.into_error(&source))?;
    let is_taken = |sets: &BTreeMap<_, _>| sets.contains_key(ZERO_DENOMINATOR);
    if is_taken(&sets) && is_taken(&system.degenerate) {
        let expected = "other names of sets than that of the equations' denominators";
        let fault = Fault::expected(value.span, expected, ZERO_DENOMINATOR);
        return Err(source.error(fault));
    }
    system.expressions = scope.builder.expressions;
    system.degenerate.extend(sets);
    Ok(())
}

/// The sets in a JSON value; `field` is its name in the file.
pub(crate) fn sets(
    value: &Value<'_>,
    field: &str,
    scope: &mut Scope,
) -> Result<BTreeMap<String, DegenerateSet>, FieldFault> {
    let mut sets = BTreeMap::new();
    for (name, set) in value.object("an object of named sets").map_err(at(field))? {
        let field = if field.is_empty() {
            name.text.to_string()
        } else {
            format!("{field}.{}", name.text)
        };
        let form = "{\"nonzero\": \"expression\"} or {\"equations\": [..]}";
        let [(kind, value)] = set.object(form).map_err(at(&field))? else {
            let fault = Fault::expected(set.span, form, "another number of fields");
            return Err(FieldFault::new(field, fault));
        };
        let set = match &*kind.text {
            "nonzero" => {
                let written = scope.parse(value, format!("{field}.nonzero"))?;
                DegenerateSet::Nonzero(scope.build(&written, Use::Polynomial)?)
            }
            "equations" => {
                let field = format!("{field}.equations");
                let mut equations = Vec::new();
                for (i, value) in value
                    .array("an array")
                    .map_err(at(&field))?
                    .iter()
                    .enumerate()
                {
                    let written = scope.parse(value, format!("{field}[{i}]"))?;
                    equations.push(scope.build(&written, Use::Polynomial)?);
                }
                if equations.is_empty() {
                    let fault = Fault::expected(value.span, "at least one equation", "none");
                    return Err(FieldFault::new(field, fault));
                }
                DegenerateSet::Equations(equations)
            }
            other => {
                let actual_input =
                    format!("the field \"{}\"", crate::expression::token::shorten(other));
                return Err(FieldFault::new(
                    field,
                    Fault::expected(set.span, form, actual_input),
                ));
            }
        };
        sets.insert(name.text.to_string(), set);
    }
    Ok(sets)
}

//! Symmetry: generators of a group that acts on the solutions.

use super::json_value::{self, Text, Value};
use super::scope::{FieldFault, Scope, at, variable};
use super::{FormatError, Source, decode, limits};
use crate::expression::build::Use;
use crate::expression::fault::{Fault, Problem, Span};
use crate::system::{SymmetryGenerator, System};

/// Reads a symmetry file, a list of `{"permutation": {"x": "y", "y": "x"}}` and
/// `{"map": {"x": "expression"}}`; it replaces what the system has.
///
/// Variables that a generator does not name stay as they are.
pub fn read(name: &str, content: &[u8], system: &mut System) -> Result<(), FormatError> {
    let text = decode(name, content, limits::FILE_BYTES)?;
    let source = Source { name, text };
    let value = json_value::parse(text, 0, text.len()).map_err(|fault| source.error(fault))?;
    let mut scope = Scope::of(system);
    let generators = generators(&value, "", &system.variables, &mut scope)
        .map_err(|fault| fault.into_error(&source))?;
    system.expressions = scope.builder.expressions;
    system.symmetry = generators;
    Ok(())
}

/// The generators in a JSON value; `field` is its name in the file.
pub(crate) fn generators(
    value: &Value<'_>,
    field: &str,
    variables: &[String],
    scope: &mut Scope,
) -> Result<Vec<SymmetryGenerator>, FieldFault> {
    let mut generators = Vec::new();
    for (i, value) in value
        .array("a list of generators")
        .map_err(at(field))?
        .iter()
        .enumerate()
    {
        let field = format!("{field}[{i}]");
        let form = "{\"permutation\": {..}} or {\"map\": {..}}";
        let [(kind, images)] = value.object(form).map_err(at(&field))? else {
            let fault = Fault::expected(value.span, form, "another number of fields");
            return Err(FieldFault::new(field, fault));
        };
        let field = format!("{field}.{}", kind.text);
        let generator = match &*kind.text {
            "permutation" => permutation(images, variables).map_err(at(&field))?,
            "map" => map(images, &field, variables, scope)?,
            _ => {
                let fault = Fault::expected(value.span, form, "another field");
                return Err(FieldFault::new(field, fault));
            }
        };
        generators.push(generator);
    }
    Ok(generators)
}

fn moved(name: &Text<'_>, variables: &[String]) -> Result<usize, Fault> {
    let span = Span {
        start: name.start,
        end: name.start + name.text.len(),
    };
    let unknown = || Fault::new(span, Problem::UnknownName(name.text.to_string()));
    variables
        .iter()
        .position(|v| *v == name.text)
        .ok_or_else(unknown)
}

fn permutation(images: &Value<'_>, variables: &[String]) -> Result<SymmetryGenerator, Fault> {
    let mut permutation: Vec<usize> = (0..variables.len()).collect();
    for (name, image) in images.object("an object of variables")? {
        permutation[moved(name, variables)?] = variable(image, variables)?;
    }
    let mut reached = vec![false; variables.len()];
    for &image in &permutation {
        if std::mem::replace(&mut reached[image], true) {
            let actual_input = format!("`{}` reached twice", variables[image]);
            return Err(Fault::expected(
                images.span,
                "a permutation of the variables",
                actual_input,
            ));
        }
    }
    Ok(SymmetryGenerator::Permutation(permutation))
}

fn map(
    images: &Value<'_>,
    field: &str,
    variables: &[String],
    scope: &mut Scope,
) -> Result<SymmetryGenerator, FieldFault> {
    let expressions = &mut scope.builder.expressions;
    let mut map: Vec<_> = (0..variables.len() as u32)
        .map(|v| expressions.variable(v))
        .collect();
    for (name, image) in images
        .object("an object of expressions")
        .map_err(at(field))?
    {
        let index = moved(name, variables).map_err(at(field))?;
        let written = scope.parse(image, format!("{field}.{}", name.text))?;
        map[index] = scope.build(&written, Use::Rational)?;
    }
    Ok(SymmetryGenerator::Map(map))
}

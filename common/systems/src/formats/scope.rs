//! Scope: what names mean in the expressions of a JSON text, and where its errors are.

use super::constants::constant;
use super::definitions::Definitions;
use super::json_value::{Kind, Text, Value};
use super::{FormatError, Source, parsed_condition};
use crate::condition::Conditions;
use crate::expression::build::{Builder, Use};
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::parse::{self, Dialect, Names, Parsed};
use crate::expression::token::{TokenKind, Tokens, is_name, shorten};
use crate::expression::{Expressions, NodeId};
use crate::system::System;
use cognate_numeric::rational::ComplexRational;
use std::borrow::Cow;
use std::collections::HashMap;

/// A fault in a field of a JSON text.
#[derive(Debug)]
pub(crate) struct FieldFault {
    fault: Fault,
    field: String,
    /// Byte where the field's own text begins, if the field is an expression.
    start: Option<usize>,
}

impl FieldFault {
    pub fn new(field: impl Into<String>, fault: Fault) -> Self {
        Self {
            fault,
            field: field.into(),
            start: None,
        }
    }

    pub fn into_error(self, source: &Source<'_>) -> FormatError {
        if self.field.is_empty() {
            source.error(self.fault)
        } else {
            source.field_error(self.fault, &self.field, self.start)
        }
    }
}

/// Puts the field's name to a fault.
pub(crate) fn at(field: &str) -> impl FnOnce(Fault) -> FieldFault {
    move |fault| FieldFault::new(field, fault)
}

/// An expression that was parsed, with the text that it was parsed from.
pub(crate) struct Written {
    parsed: Parsed,
    start: usize,
    place: Text<'static>,
    field: String,
}

impl Written {
    /// The place of the whole expression.
    pub fn span(&self) -> Span {
        self.place.span(self.parsed.span)
    }

    fn fault(&self, fault: Fault) -> FieldFault {
        FieldFault {
            fault: Fault {
                span: self.place.span(fault.span),
                ..fault
            },
            field: self.field.clone(),
            start: Some(self.start),
        }
    }
}

/// Meanings of names, and the graph that expressions are added to.
#[derive(Default)]
pub(crate) struct Scope {
    /// The graph.
    pub builder: Builder,
    names: Names,
    values: Vec<Option<NodeId>>,
    declared: HashMap<u32, &'static str>,
    totals: parse::Totals,
}

impl Scope {
    /// Largest relative accuracy of a rounded decimal so far.
    pub fn data_accuracy(&self) -> f64 {
        self.totals.data_accuracy
    }

    /// The variables and parameters of a system, and its graph.
    pub fn of(system: &System) -> Self {
        let mut scope = Self {
            builder: Builder::of(system),
            ..Self::default()
        };
        for (i, name) in system.variables.iter().enumerate() {
            let node = scope.builder.expressions.variable(i as u32);
            scope.enter(name, "a variable", Some(node));
        }
        for (i, name) in system.parameters.iter().enumerate() {
            let node = scope.builder.expressions.parameter(i as u32);
            scope.enter(name, "a parameter", Some(node));
        }
        scope
    }

    fn enter(&mut self, name: &str, kind: &'static str, value: Option<NodeId>) -> u32 {
        let number = self.names.intern(name);
        self.values.resize(self.names.count(), None);
        self.values[number as usize] = value;
        self.declared.insert(number, kind);
        number
    }

    /// Declares a name, which must be new and have no meaning of its own.
    pub fn declare(
        &mut self,
        name: &Text<'_>,
        span: Span,
        kind: &'static str,
        value: Option<NodeId>,
    ) -> Result<u32, Fault> {
        if !is_name(&name.text) {
            let actual_input = format!("\"{}\"", shorten(&name.text));
            let expected =
                "a name: a letter or `_`, then letters, digits, `_` and indices such as `[1]`";
            return Err(Fault::expected(span, expected, actual_input));
        }
        parse::check_free(&name.text, span, Dialect::BERTINI)?;
        if let Some(earlier) = self
            .names
            .find(&name.text)
            .and_then(|n| self.declared.get(&n))
        {
            let problem = Problem::DuplicateName {
                name: name.text.to_string(),
                first: format!("is {earlier} already"),
            };
            return Err(Fault::new(span, problem));
        }
        Ok(self.enter(&name.text, kind, value))
    }

    /// Parses an expression, which stands in quotes or is a number.
    pub fn parse(&mut self, value: &Value<'_>, field: String) -> Result<Written, FieldFault> {
        self.parse_sides(value, field, false)
    }

    /// Parses an expression that is to be 0, or two with `=` or `==` between them: their difference is.
    pub fn parse_equation(
        &mut self,
        value: &Value<'_>,
        field: String,
    ) -> Result<Written, FieldFault> {
        self.parse_sides(value, field, true)
    }

    fn parse_sides(
        &mut self,
        value: &Value<'_>,
        field: String,
        may_have_two: bool,
    ) -> Result<Written, FieldFault> {
        let text = match &value.kind {
            Kind::Text(text) => (**text).clone(),
            Kind::Number(number) => Text::plain(number, value.span.start),
            _ => {
                let expected = "an expression in quotes";
                return Err(FieldFault::new(
                    field,
                    Fault::expected(value.span, expected, value.describe()),
                ));
            }
        };
        let mut tokens = Tokens::new(&text.text, None);
        let end = "the end of the expression";
        let mut side = |tokens: &mut Tokens<'_>| {
            let dialect = Dialect::PLAIN;
            parse::expression(tokens, &mut self.names, dialect, end, &mut self.totals)
        };
        let mut result = side(&mut tokens);
        if may_have_two && result.is_ok() && tokens.take_symbol('=').is_some() {
            tokens.take_symbol('=');
            result = result.and_then(|left| Ok(left.minus(side(&mut tokens)?)));
        }
        let result = result.and_then(|parsed| match tokens.peek() {
            token if token.kind == TokenKind::End => Ok(parsed),
            token => {
                let expected = format!("an operator or {end}");
                Err(Fault::expected(token.span, expected, token.describe()))
            }
        });
        let written = |parsed| Written {
            parsed,
            start: text.start,
            place: text.without_text(),
            field,
        };
        match result {
            Ok(parsed) => Ok(written(parsed)),
            Err(fault) => Err(written(Parsed::default()).fault(fault)),
        }
    }

    /// Builds definitions in any order; they are declared already.
    pub fn define(&mut self, list: &[(u32, Written)]) -> Result<(), FieldFault> {
        self.values.resize(self.names.count(), None);
        if let Some(unit) = self.free_unit() {
            let i = self.builder.expressions.constant(ComplexRational::i());
            self.values[unit as usize] = Some(i);
        }
        let definitions = Definitions {
            names: &self.names,
            list: list
                .iter()
                .map(|(name, written)| (*name, &written.parsed))
                .collect(),
        };
        definitions.build(
            &mut self.builder,
            &mut self.values,
            Use::Rational,
            &mut |i, fault| list[i].1.fault(fault),
        )
    }

    /// `i` is the imaginary unit unless it is declared.
    fn free_unit(&self) -> Option<u32> {
        self.names
            .find("i")
            .filter(|n| !self.declared.contains_key(n))
    }

    /// Builds an expression.
    pub fn build(&mut self, written: &Written, usage: Use) -> Result<NodeId, FieldFault> {
        let node = self.node(&written.parsed, usage);
        node.map_err(|fault| written.fault(fault))
    }

    fn node(&mut self, parsed: &Parsed, usage: Use) -> Result<NodeId, Fault> {
        let Self {
            builder,
            names,
            values,
            ..
        } = self;
        builder.build(parsed, usage, &mut |expressions, name, at| {
            resolve(names, values, expressions, name, at)
        })
    }

    /// Adds conditions between commas to those that there are.
    pub fn condition(&mut self, text: &str, conditions: &mut Conditions) -> Result<(), Fault> {
        let whole = Span {
            start: 0,
            end: text.len(),
        };
        let mut parts: Vec<Span> = parsed_condition::parts(text, whole).collect();
        if parts.is_empty() {
            parts.push(whole);
        }
        let mut parts = parts.into_iter();
        parts.try_for_each(|part| self.one_condition(text, part, conditions))
    }

    fn one_condition(
        &mut self,
        text: &str,
        part: Span,
        conditions: &mut Conditions,
    ) -> Result<(), Fault> {
        // Decimals of a condition say nothing of the accuracy of the equations.
        let totals = &mut parse::Totals::default();
        let parsed = parsed_condition::parse(text, part, &mut self.names, totals)?;
        let Self {
            builder,
            names,
            values,
            ..
        } = self;
        conditions.add(parsed, builder, &mut |expressions, name, at| {
            resolve(names, values, expressions, name, at)
        })
    }

    /// Adds a condition that stands in quotes.
    pub fn condition_of(
        &mut self,
        value: &Value<'_>,
        field: String,
        conditions: &mut Conditions,
    ) -> Result<(), FieldFault> {
        let text = value.text("a condition in quotes").map_err(at(&field))?;
        self.condition(&text.text, conditions)
            .map_err(|fault| FieldFault {
                fault: Fault {
                    span: text.without_text().span(fault.span),
                    ..fault
                },
                field,
                start: Some(text.start),
            })
    }

    /// The node of an expression that is not in a JSON text.
    pub fn expression(&mut self, text: &str) -> Result<NodeId, Fault> {
        let mut tokens = Tokens::new(text, None);
        let end = "the end of the expression";
        let dialect = Dialect::PLAIN;
        let totals = &mut parse::Totals::default();
        let parsed = parse::expression(&mut tokens, &mut self.names, dialect, end, totals)?;
        let token = tokens.peek();
        if token.kind != TokenKind::End {
            let expected = format!("an operator or {end}");
            return Err(Fault::expected(token.span, expected, token.describe()));
        }
        self.node(&parsed, Use::Rational)
    }

    /// The graph with everything that was built.
    pub fn into_expressions(self) -> Expressions {
        self.builder.expressions
    }
}

/// Finds the node that a name stands for.
fn resolve(
    names: &Names,
    values: &[Option<NodeId>],
    expressions: &mut Expressions,
    name: u32,
    place: Span,
) -> Result<NodeId, Fault> {
    if let Some(value) = values.get(name as usize).copied().flatten() {
        return Ok(value);
    }
    if let Some(value) = constant(names, name, expressions) {
        return Ok(value);
    }
    match names.name(name) {
        "i" => Ok(expressions.constant(ComplexRational::i())),
        unknown => {
            let declared =
                (0..names.count()).filter(|&n| values.get(n).is_some_and(Option::is_some));
            let declared = declared.map(|n| names.name(n as u32));
            Err(Fault::new(place, Problem::unknown(unknown, declared)))
        }
    }
}

impl<'a> Text<'a> {
    /// A text without escapes that begins at a byte of the file.
    pub fn plain(text: &'a str, start: usize) -> Self {
        Self {
            text: Cow::Borrowed(text),
            start,
            escapes: Vec::new(),
        }
    }

    /// Only the map of places.
    fn without_text(&self) -> Text<'static> {
        Text {
            text: Cow::Borrowed(""),
            start: self.start,
            escapes: self.escapes.clone(),
        }
    }
}

/// The index of the variable that a string names.
pub(crate) fn variable(value: &Value<'_>, variables: &[String]) -> Result<usize, Fault> {
    let name = value.text("the name of a variable")?;
    let index = variables.iter().position(|v| *v == name.text);
    index.ok_or_else(|| Fault::expected(value.span, "the name of a variable", value.describe()))
}

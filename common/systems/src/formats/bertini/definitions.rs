//! From statements in any order to a system: definitions are built in the
//! order of their dependence, and a cycle among them is named.

use super::{Kind, Statements};
use crate::expression::Dependence;
use crate::expression::NodeId;
use crate::expression::build::{Builder, Use};
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::formats::definitions::Definitions;
use crate::system::{System, VariableGroup};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};

/// The declared random constant with this number: complex of modulus 1, or real between -1 and 1;
/// a multiple of 2^-40, so that it is cheap in exact arithmetic.
fn random_constant(seed: u64, number: u64, real: bool) -> ComplexRational {
    const GRID: i64 = 1 << 40;
    let mut random = RandomStream::new(seed, Purpose::DeclaredConstant, number);
    let part = |value: f64| Rational::from(((value * GRID as f64) as i64, GRID));
    match real {
        true => ComplexRational::real(part(2.0 * random.uniform() - 1.0)),
        false => {
            let z = random.unit();
            ComplexRational::new(part(z.re), part(z.im))
        }
    }
}

impl Statements {
    /// The system, the places of its equations, and the end of the input.
    /// `seed`: that of constants which are declared to be random.
    pub(super) fn into_system(self, seed: u64) -> Result<(System, Vec<Span>, Span), Fault> {
        let mut builder = Builder::default();
        let mut system = System::default();
        let mut values: Vec<Option<NodeId>> = vec![None; self.names.count()];
        let mut position = vec![0usize; self.names.count()];
        let mut randoms = 0;
        for &(name, kind, span) in &self.declared {
            let text = self.names.name(name).to_string();
            let defined = self.defined.get(&name).map(|&d| self.definitions[d].1);
            match (kind, defined) {
                (Kind::Variable | Kind::PathVariable | Kind::Random { .. }, Some(at)) => {
                    let first = format!("is declared as a {}", kind.describe());
                    return Err(Fault::new(at, What::DuplicateName { name: text, first }));
                }
                (Kind::Function | Kind::Constant, None) => {
                    return Err(Fault::new(span, What::Undefined(text)));
                }
                (Kind::Variable, None) => {
                    position[name as usize] = system.variables.len();
                    let index = system.variables.len() as u32;
                    values[name as usize] = Some(builder.expressions.variable(index));
                    system.variables.push(text);
                }
                // A parameter that is defined is a name for its definition, as in Bertini.
                (Kind::Parameter | Kind::PathVariable, None) => {
                    let index = system.parameters.len();
                    values[name as usize] = Some(builder.expressions.parameter(index as u32));
                    system.parameters.push(text);
                    if kind == Kind::PathVariable {
                        system.path_variable = Some(index);
                    }
                }
                (Kind::Random { real }, None) => {
                    let value = random_constant(seed, randoms, real);
                    values[name as usize] = Some(builder.expressions.constant(value));
                    randoms += 1;
                }
                (Kind::Function | Kind::Constant | Kind::Parameter, Some(_)) => {}
            }
        }
        let definitions = Definitions {
            names: &self.names,
            list: self
                .definitions
                .iter()
                .map(|(name, _, parsed)| (*name, parsed))
                .collect(),
        };
        definitions.build(&mut builder, &mut values, Use::Rational, &mut |_, fault| {
            fault
        })?;
        self.check_dependence(&builder, &values)?;
        let mut places = Vec::new();
        for &(name, kind, _) in &self.declared {
            if kind != Kind::Function {
                continue;
            }
            system
                .equations
                .push(values[name as usize].expect("every definition was built"));
            system.equation_names.push(self.names.name(name).into());
            places.push(self.definitions[self.defined[&name]].1);
        }
        system.groups = self.variable_groups(&position);
        builder.hand_over(&mut system, &places)?;
        Ok((system, places, self.end))
    }

    /// Refuses a constant that depends on variables or parameters, and a parameter that depends on variables.
    fn check_dependence(&self, builder: &Builder, values: &[Option<NodeId>]) -> Result<(), Fault> {
        for (name, span, _) in &self.definitions {
            let Some(value) = values[*name as usize] else {
                continue;
            };
            let dependence = builder.expressions.dependence(value);
            let (kind, without) = match self.kinds.get(name) {
                Some(Kind::Constant) if dependence != Dependence::Constant => {
                    ("constant", "variables and parameters")
                }
                Some(Kind::Parameter) if dependence == Dependence::Variables => {
                    ("parameter", "variables")
                }
                _ => continue,
            };
            let name = self.names.name(*name).to_string();
            return Err(Fault::new(
                *span,
                What::TooDependent {
                    name,
                    kind,
                    without,
                },
            ));
        }
        Ok(())
    }

    /// The groups of variables: declared groups first, then the variables that were declared without a group.
    /// `position`: the index of each variable by its name.
    fn variable_groups(&self, position: &[usize]) -> Vec<VariableGroup> {
        let index = |names: &[u32]| names.iter().map(|&n| position[n as usize]).collect();
        let mut groups: Vec<VariableGroup> = self
            .groups
            .iter()
            .map(|(homogeneous, names)| VariableGroup {
                variables: index(names),
                homogeneous: *homogeneous,
            })
            .collect();
        if !self.ungrouped.is_empty() {
            groups.push(VariableGroup {
                variables: index(&self.ungrouped),
                homogeneous: false,
            });
        }
        groups
    }
}

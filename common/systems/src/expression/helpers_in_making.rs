//! Helper unknowns while expressions are read: each function of unknowns has one, made when it first occurs.
//!
//! While a text is read nobody knows how many unknowns it has, so that helpers have indices past all limits; in the end
//! they become variables of the system, and their equations are added.

use super::angles::{CosineAndSine, NoCombination, power, refused};
use super::build::Builder;
use super::differentiate::below;
use super::fault::{Fault, Problem, Span};
use super::function_name::FunctionName;
use super::helper_drafts::{Draft, FIRST, HelpersInMaking};
use super::{Expressions, Imported, Node, NodeId};
use crate::formats::limits;
use crate::helper_unknown::{AngleUnit, AngleUnknowns, Branch, Helper, RootUnknown};
use crate::system::{DegenerateSet, System};
use rug::{Integer, Rational};
use std::collections::{BTreeMap, BTreeSet};

impl Builder {
    fn check_helper_count(&self, at: Span) -> Result<(), Fault> {
        match self.helpers.drafts.len() as u64 > limits::VARIABLES.value {
            true => Err(Fault::limit(at, limits::VARIABLES, "more")),
            false => Ok(()),
        }
    }

    /// The helper that is a root of an expression.
    pub(super) fn helper_root(
        &mut self,
        radicand: NodeId,
        degree: u32,
        branch: Branch,
        at: Span,
    ) -> Result<NodeId, Fault> {
        if self.helpers.are_values {
            return Ok(self.root_of_values(radicand, degree, branch));
        }
        self.check_helper_count(at)?;
        let root = Draft::Root {
            radicand,
            degree,
            branch,
        };
        if let Some(finished) = &self.helpers.finished {
            let same = finished.iter().find(|(draft, _)| *draft == root);
            let (_, variable) = same.ok_or_else(|| only_in_equations(at))?;
            return Ok(self.expressions.variable(*variable));
        }
        let drafts = &mut self.helpers.drafts;
        let place = drafts.iter().position(|draft| *draft == root);
        let place = place.unwrap_or_else(|| {
            drafts.push(root);
            drafts.len() - 1
        });
        let variable = self.helpers.variable(place);
        Ok(self.expressions.variable(variable))
    }

    /// The root of what has values at points. The real cube root of x is x / (x^2)^(1/3).
    fn root_of_values(&mut self, radicand: NodeId, degree: u32, branch: Branch) -> NodeId {
        let e = &mut self.expressions;
        let exponent = Rational::from((1, degree));
        match branch {
            Branch::Principal => e.insert(Node::Root(radicand, exponent)),
            Branch::Real => {
                let square = e.power(radicand, 2);
                let root = e.insert(Node::Root(square, exponent));
                e.divide(radicand, root)
            }
        }
    }

    /// The helpers that are cosine and sine of an unknown times a unit; `function` is for messages.
    pub(super) fn helper_angle(
        &mut self,
        angle: u32,
        unit: AngleUnit,
        function: FunctionName,
        at: Span,
    ) -> Result<CosineAndSine, Fault> {
        self.check_helper_count(at)?;
        if self.helpers.finished.is_some() {
            return Err(only_in_equations(at));
        }
        let HelpersInMaking { drafts, angles, .. } = &mut self.helpers;
        let units = angles.entry(angle).or_default();
        if units.keys().any(|other| other.pi_power != unit.pi_power) {
            return Err(refused(function, NoCombination::Coefficient, at));
        }
        let place = *units.entry(unit).or_insert_with(|| {
            drafts.extend([Draft::Cosine(angle, unit), Draft::Sine(angle, unit)]);
            drafts.len() - 2
        });
        if common_denominator(units).is_none() {
            return Err(Fault::limit(at, limits::EXPONENT, "more"));
        }
        let [cosine, sine] = [place, place + 1].map(|place| self.helpers.variable(place));
        let e = &mut self.expressions;
        Ok(CosineAndSine {
            cosine: e.variable(cosine),
            sine: e.variable(sine),
        })
    }

    /// Makes the helpers variables of a system whose expressions hold them; `place` is that of an equation.
    pub(super) fn finish_helpers(
        &mut self,
        system: &mut System,
        place: impl Fn(usize) -> Span,
    ) -> Result<(), Fault> {
        let helpers = std::mem::take(&mut self.helpers);
        if helpers.drafts.is_empty() {
            return Ok(());
        }
        refuse_attachments(system, place(0))?;
        helpers.refuse_angles_outside(system, &place)?;
        helpers.enter(system);
        Ok(())
    }
}

fn only_in_equations(at: Span) -> Fault {
    let expected = "functions of unknowns in equations and conditions only; elsewhere an unknown with the equation unknown = function";
    Fault::expected(at, expected, "a function that no equation has")
}

/// Groups of lines and maps of points do not know the helpers.
fn refuse_attachments(system: &System, at: Span) -> Result<(), Fault> {
    let attachments = [
        (
            system.groups.iter().any(|group| group.homogeneous),
            "homogeneous groups",
        ),
        (!system.symmetry.is_empty(), "a symmetry"),
        (!system.conjugates.is_empty(), "pairs of conjugates"),
    ];
    match attachments.iter().find(|(is_there, _)| *is_there) {
        Some((_, attachment)) => {
            let problem = format!("{attachment} beside functions of unknowns");
            Err(Fault::new(at, Problem::NotInThisVersion(problem)))
        }
        None => Ok(()),
    }
}

impl HelpersInMaking {
    fn radicands(&self) -> impl Iterator<Item = NodeId> {
        self.drafts.iter().filter_map(|draft| match draft {
            Draft::Root { radicand, .. } => Some(*radicand),
            Draft::Cosine(..) | Draft::Sine(..) => None,
        })
    }

    /// An unknown and its sine have no polynomial equation in common.
    fn refuse_angles_outside(
        &self,
        system: &System,
        place: &impl Fn(usize) -> Span,
    ) -> Result<(), Fault> {
        let e = &system.expressions;
        let equations = system.equations.iter().copied().enumerate();
        let sets = system
            .degenerate
            .values()
            .flat_map(DegenerateSet::nodes)
            .copied();
        let others = sets.chain(self.radicands()).map(|root| (0, root));
        for (equation, root) in equations.chain(others) {
            for id in below(e, &[root]) {
                let Node::Variable(v) = e.node(id) else {
                    continue;
                };
                if self.angles.contains_key(v) {
                    let name = &system.variables[*v as usize];
                    let expected = format!(
                        "the angle `{name}` only inside sin, cos, tan, cot, sec, csc and exp(I*..): an unknown together \
                         with its sine has no polynomial equation"
                    );
                    let actual_input = format!("`{name}` outside of them, too");
                    return Err(Fault::expected(place(equation), expected, actual_input));
                }
            }
        }
        Ok(())
    }

    /// The unit of which all units of an angle are multiples.
    fn common_unit(&self, angle: u32) -> AngleUnit {
        let units = &self.angles[&angle];
        let first = units.keys().next().expect("an angle has a unit");
        AngleUnit {
            denominator: common_denominator(units).expect("it was checked for each unit"),
            ..*first
        }
    }

    /// The variable of the system, or the function of two of them, that each helper is. The cosine of an angle in the common
    /// unit stands where the angle stood, other variables after all unknowns.
    fn meanings(&self, unknowns: usize) -> Vec<Meaning> {
        let mut next = unknowns;
        let mut new_variable = || {
            next += 1;
            next - 1
        };
        let mut sines: BTreeMap<u32, usize> = BTreeMap::new();
        let mut meanings = Vec::new();
        for draft in &self.drafts {
            let meaning = match *draft {
                Draft::Root { .. } => Meaning::Variable(new_variable()),
                Draft::Cosine(angle, unit) | Draft::Sine(angle, unit) => {
                    let is_cosine = matches!(draft, Draft::Cosine(..));
                    let cosine = angle as usize;
                    let common = self.common_unit(angle);
                    let multiple = u64::from(common.denominator / unit.denominator);
                    match (multiple, is_cosine) {
                        (1, true) => Meaning::Variable(cosine),
                        (1, false) => {
                            Meaning::Variable(*sines.entry(angle).or_insert_with(&mut new_variable))
                        }
                        _ => Meaning::OfMultiple {
                            cosine,
                            sine: *sines.entry(angle).or_insert_with(&mut new_variable),
                            multiple,
                            is_cosine,
                        },
                    }
                }
            };
            meanings.push(meaning);
        }
        meanings
    }

    fn enter(&self, system: &mut System) {
        let meanings = self.meanings(system.variables.len());
        let from = std::mem::take(&mut system.expressions);
        let mut renumbered = Renumbered {
            from: &from,
            meanings: &meanings,
            memory: Imported::default(),
        };
        let out = &mut system.expressions;
        for equation in &mut system.equations {
            *equation = renumbered.copy(out, *equation);
        }
        for set in system.degenerate.values_mut() {
            for node in set.nodes_mut() {
                *node = renumbered.copy(out, *node);
            }
        }
        let mut entered = BTreeSet::new();
        let mut roots = 0;
        for (draft, meaning) in self.drafts.iter().zip(&meanings) {
            match (*draft, *meaning) {
                (
                    Draft::Root {
                        radicand,
                        degree,
                        branch,
                    },
                    Meaning::Variable(variable),
                ) => {
                    let radicand = renumbered.copy(&mut system.expressions, radicand);
                    roots += 1;
                    enter_root(
                        system,
                        RootUnknown {
                            variable,
                            degree,
                            radicand,
                            branch,
                        },
                        roots,
                    );
                }
                (
                    Draft::Sine(angle, _),
                    Meaning::Variable(sine) | Meaning::OfMultiple { sine, .. },
                ) if entered.insert(angle) => {
                    enter_angle(system, angle as usize, sine, self.common_unit(angle));
                }
                _ => {}
            }
        }
    }
}

/// The least common multiple of the denominators of the units of an angle; `None` where it is too large.
fn common_denominator(units: &BTreeMap<AngleUnit, usize>) -> Option<u32> {
    let denominators = units.keys().map(|unit| Integer::from(unit.denominator));
    let common = denominators.fold(Integer::from(1), |common, other| common.lcm(&other));
    let is_small = common <= limits::EXPONENT.value;
    common.to_u32().filter(|_| is_small)
}

/// Meaning of a helper in the system.
#[derive(Clone, Copy, Debug)]
enum Meaning {
    /// A variable.
    Variable(usize),
    /// Cosine or sine of a multiple of the angle whose cosine and sine are these variables.
    OfMultiple {
        cosine: usize,
        sine: usize,
        multiple: u64,
        is_cosine: bool,
    },
}

impl Meaning {
    fn node(self, e: &mut Expressions) -> NodeId {
        let variable = |e: &mut Expressions, index: usize| {
            e.variable(u32::try_from(index).expect("variables are counted in 32 bits"))
        };
        match self {
            Self::Variable(index) => variable(e, index),
            Self::OfMultiple {
                cosine,
                sine,
                multiple,
                is_cosine,
            } => {
                let turn = CosineAndSine {
                    cosine: variable(e, cosine),
                    sine: variable(e, sine),
                };
                let turned = power(e, turn, multiple);
                if is_cosine {
                    turned.cosine
                } else {
                    turned.sine
                }
            }
        }
    }
}

/// Copies of expressions in which helpers are what they mean in the system.
struct Renumbered<'a> {
    from: &'a Expressions,
    meanings: &'a [Meaning],
    memory: Imported,
}

impl Renumbered<'_> {
    fn copy(&mut self, out: &mut Expressions, root: NodeId) -> NodeId {
        let meanings = self.meanings;
        out.import(
            self.from,
            root,
            &mut self.memory,
            &mut |out, leaf| match leaf {
                Node::Variable(v) if *v >= FIRST => meanings[(*v - FIRST) as usize].node(out),
                other => out.insert(other.clone()),
            },
        )
    }
}

/// Adds a root with its equation.
fn enter_root(system: &mut System, root: RootUnknown, number: usize) {
    let e = &mut system.expressions;
    let variable = e.variable(root.variable as u32);
    let power = e.power(variable, root.degree);
    let equation = e.subtract(power, root.radicand);
    let first = below(e, &[root.radicand])
        .into_iter()
        .find_map(|id| match e.node(id) {
            Node::Variable(v) => Some(*v as usize),
            _ => None,
        });
    let name = free_name(system, format!("root_{number}"));
    system.variables.push(name.clone());
    join_group(system, root.variable, first);
    system.equations.push(equation);
    system.equation_names.push(name);
    system.helpers.push(Helper::Root(root));
}

/// Makes the variable of an angle its cosine, and adds its sine with the equation of the circle.
fn enter_angle(system: &mut System, cosine: usize, sine: usize, unit: AngleUnit) {
    let e = &mut system.expressions;
    let [c, s] = [cosine, sine].map(|v| e.variable(v as u32));
    let (cosine_square, sine_square, one) = (e.power(c, 2), e.power(s, 2), e.integer(1));
    let squares = e.add(cosine_square, sine_square);
    let equation = e.subtract(squares, one);
    let angle = system.variables[cosine].clone();
    system.variables[cosine] = free_name(system, format!("cos_{angle}"));
    let name = free_name(system, format!("sin_{angle}"));
    system.variables.push(name);
    join_group(system, sine, Some(cosine));
    system.equations.push(equation);
    let name = free_name(system, format!("circle_{angle}"));
    system.equation_names.push(name);
    system.helpers.push(Helper::Angle(AngleUnknowns {
        name: angle,
        cosine,
        sine,
        unit,
    }));
}

/// Puts a new variable into the group of another, or into the last.
fn join_group(system: &mut System, variable: usize, other: Option<usize>) {
    let holds = |v: usize| move |group: &crate::system::VariableGroup| group.variables.contains(&v);
    let last = system.groups.len().saturating_sub(1);
    let place = other.and_then(|v| system.groups.iter().position(holds(v)));
    if let Some(group) = system.groups.get_mut(place.unwrap_or(last)) {
        group.variables.push(variable);
    }
}

/// A name that nothing else has.
fn free_name(system: &System, mut name: String) -> String {
    let others = [
        &system.variables,
        &system.parameters,
        &system.equation_names,
    ];
    while others.iter().any(|names| names.contains(&name)) {
        name.push('_');
    }
    name
}

//! Helper unknowns while expressions are read: each function of unknowns has one, made when it first occurs.
//!
//! While a text is read nobody knows how many unknowns it has, so that helpers have indices past all limits; in the end
//! they become variables of the system, and their equations are added.

use super::angles::CosineAndSine;
use super::build::Builder;
use super::differentiate::below;
use super::fault::{Fault, Problem, Span};
use super::helper_drafts::{Draft, FIRST, HelpersInMaking};
use super::{Expressions, Imported, Node, NodeId};
use crate::formats::limits;
use crate::helper_unknown::{AngleUnknowns, Branch, Helper, RootUnknown};
use crate::system::{DegenerateSet, System};

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

    /// The helpers that are cosine and sine of an unknown.
    pub(super) fn helper_angle(&mut self, angle: u32, at: Span) -> Result<CosineAndSine, Fault> {
        self.check_helper_count(at)?;
        if self.helpers.finished.is_some() {
            return Err(only_in_equations(at));
        }
        let HelpersInMaking { drafts, angles, .. } = &mut self.helpers;
        let place = *angles.entry(angle).or_insert_with(|| {
            drafts.extend([Draft::Cosine(angle), Draft::Sine(angle)]);
            drafts.len() - 2
        });
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
    let expected = "functions of unknowns in equations only; elsewhere an unknown with the equation unknown = function";
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
            Draft::Cosine(_) | Draft::Sine(_) => None,
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

    /// The index in the system of every helper: a cosine stands where its angle stood, others after all unknowns.
    fn indices(&self, unknowns: usize) -> Vec<usize> {
        let mut next = unknowns;
        let each = self.drafts.iter().map(|draft| match draft {
            Draft::Cosine(angle) => *angle as usize,
            Draft::Root { .. } | Draft::Sine(_) => {
                next += 1;
                next - 1
            }
        });
        each.collect()
    }

    fn enter(&self, system: &mut System) {
        let indices = self.indices(system.variables.len());
        let from = std::mem::take(&mut system.expressions);
        let mut renumbered = Renumbered {
            from: &from,
            indices: &indices,
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
        let mut roots = 0;
        for (place, draft) in self.drafts.iter().enumerate() {
            let variable = indices[place];
            match *draft {
                Draft::Root {
                    radicand,
                    degree,
                    branch,
                } => {
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
                Draft::Cosine(_) => enter_angle(system, variable, indices[place + 1]),
                Draft::Sine(_) => {}
            }
        }
    }
}

/// Copies of expressions in which helpers have their indices in the system.
struct Renumbered<'a> {
    from: &'a Expressions,
    indices: &'a [usize],
    memory: Imported,
}

impl Renumbered<'_> {
    fn copy(&mut self, out: &mut Expressions, root: NodeId) -> NodeId {
        let indices = self.indices;
        out.import(
            self.from,
            root,
            &mut self.memory,
            &mut |out, leaf| match leaf {
                Node::Variable(v) if *v >= FIRST => {
                    let index = indices[(*v - FIRST) as usize];
                    out.variable(u32::try_from(index).expect("variables are counted in 32 bits"))
                }
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
fn enter_angle(system: &mut System, cosine: usize, sine: usize) {
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

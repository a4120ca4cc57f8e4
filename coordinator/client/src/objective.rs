//! Objective: the expression of which the least, the largest or all critical values are asked.

use super::error::ClientError;
use super::text_change::is_of_name;
use clap::Args;
use cognate_solutions::critical::{Alternative, Alternatives, Critical};
use cognate_solutions::selection::Selector;
use cognate_systems::condition::{Conditions, Inequality};
use cognate_systems::expression::differentiate::below;
use cognate_systems::expression::{Expressions, Imported, Node, NodeId};
use cognate_systems::formats::conditions;
use cognate_systems::helper_unknown::Branch;
use cognate_systems::objective::{Goal, Objective};
use cognate_systems::polynomial::attained::lower_bound;
use cognate_systems::polynomial::{Polynomial, independent_equations};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::{clear_denominators, denominator_factors};
use cognate_systems::transform::critical_points;

/// The objective, as typed.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Objective")]
#[group(multiple = false)]
pub struct ObjectiveArguments {
    /// Find the least value of this expression on the real solutions of the equations that meet the conditions, by all its
    /// critical points
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    pub minimize: Option<String>,
    /// Find the largest value of this expression
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    pub maximize: Option<String>,
    /// Find all critical points of this expression on the solutions of the equations
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    pub critical: Option<String>,
}

impl ObjectiveArguments {
    /// The objective as a line of plain equations.
    pub fn line(&self) -> Option<String> {
        let (goal, text) = self.typed()?;
        Some(format!("{}: {text}", goal.name()))
    }

    fn typed(&self) -> Option<(Goal, &str)> {
        let texts = [&self.minimize, &self.maximize, &self.critical];
        let typed = Goal::ALL.into_iter().zip(texts);
        typed
            .filter_map(|(goal, text)| Some((goal, text.as_deref()?)))
            .next()
    }
}

/// The word for conditions in messages.
pub const CONDITIONS: &str = "conditions";

/// Puts the critical points of the objective, where there is one, in the place of a system. The objective of the command
/// line goes before that of the file, which is `given`. Each of the conditions is active at a point or not.
///
/// # Errors
/// When a text is no expression, or when its critical points are not supported by this version.
pub fn critical(
    system: &mut System,
    given: Option<Objective>,
    typed: &ObjectiveArguments,
    conditions: &mut Conditions,
) -> Result<Option<Critical>, ClientError> {
    let objective = match typed.typed() {
        None => given,
        Some((goal, text)) => {
            check(system, goal.name())?;
            let option = format!("--{}", goal.name());
            if given.is_some_and(|given| given.is_free) {
                return Err(refused(
                    &option,
                    "the file has an objective and no equations",
                ));
            }
            if let Some(angle) = angle_in(text, system) {
                let goal = goal.name();
                let message = format!(
                    "expected functions of the angle `{angle}` only, such as `cos({angle})`, or the line `{goal}: ...` \
                     beside the equations"
                );
                return Err(refused(&option, &message));
            }
            let read = conditions::expression(&option, text, system);
            let (expressions, node) = read.map_err(|e| ClientError::Format(e.to_string()))?;
            system.expressions = expressions;
            Some(Objective {
                goal,
                text: text.to_owned(),
                node,
                is_free: false,
            })
        }
    };
    let Some(objective) = objective else {
        return Ok(None);
    };
    let name = objective.goal.name();
    check(system, name)?;
    conditions.resolve_negations();
    refuse_angles(system, conditions)?;
    if conditions.have_functions() {
        let message = "expected no functions of unknowns beside an objective (not in this version): an unknown with an \
                       equation stands for each\n  try: cognate solve -e \"r = sqrt(x)\" --minimize \"(x - 3)^2\" --where \
                       \"r >= 1\"";
        return Err(refused(CONDITIONS, message));
    }
    let meanings = system.helper_meanings();
    for root in system.root_unknowns() {
        // A real value of the principal root is at least 0; every real radicand has a real cube root.
        if root.branch == Branch::Principal {
            let name = &system.variables[root.variable];
            let meaning = meanings.iter().find(|meaning| meaning.name == *name);
            let function = &meaning.expect("each helper stands for a function").is;
            conditions.add_nonnegative(root.variable as u32, format!("{function} >= 0"));
        }
    }
    let with_helpers = Some(system.clone()).filter(|system| !system.helpers.is_empty());
    // Helpers are unknowns like others from here on: the conditions choose their branches.
    system.helpers.clear();
    let mut alternatives = alternatives(system, conditions)?;
    for alternative in &mut alternatives {
        alternative.has_multiplier =
            !is_root_of_even_powers(system, with_helpers.as_ref(), alternative);
    }
    alternatives.sort_by_key(|alternative| !alternative.has_multiplier);
    let unknowns = system.variables.len();
    if objective.is_free {
        system.equations.clear();
        system.equation_names.clear();
    }
    make_gradients_independent(system);
    let with_multiplier = alternatives
        .iter()
        .filter(|alternative| alternative.has_multiplier);
    let inequalities: Vec<NodeId> = with_multiplier.map(|a| a.expression).collect();
    let equations = critical_points(system, objective.node, &inequalities);
    *system = equations.clone();
    clear_denominators(system);
    system.check().map_err(|e| refused(name, &e.to_string()))?;
    let closed = conditions.closed();
    let alternatives = (!alternatives.is_empty()).then(|| Alternatives {
        alternatives,
        excludes_equality: closed != *conditions,
        closed: Selector::new(closed, unknowns, system.parameters.len(), None),
        differences: conditions.differences.len(),
    });
    let mut critical = Critical::new(objective, equations, unknowns, alternatives);
    critical.with_helpers = with_helpers;
    critical.has_denominators = !denominator_factors(system).is_empty();
    Ok(Some(critical))
}

/// Leaves out equations that are linear combinations of others or have one as a factor, and takes each factor of an equation
/// once: at the solutions of others the gradients depend on each other, so that all of them would be critical.
fn make_gradients_independent(system: &mut System) {
    let expressions = &mut system.expressions;
    let products = system.equations.iter();
    let products: Vec<Vec<NodeId>> = products.map(|e| factors(expressions, *e)).collect();
    let follows = |factors: &Vec<NodeId>| {
        let is_equation = |factor: &NodeId| products.iter().any(|other| other[..] == [*factor]);
        factors.len() > 1 && factors.iter().any(is_equation)
    };
    for (equation, factors) in system.equations.iter_mut().zip(&products) {
        let factors = if follows(factors) { &[][..] } else { factors };
        let product = factors.iter().copied();
        let product = product.reduce(|product, factor| expressions.multiply(product, factor));
        // An equation that follows from another one is 0 = 0, and is left out below.
        *equation = product.unwrap_or_else(|| expressions.integer(0));
    }
    let independent = independent_equations(system);
    let names = &system.equation_names;
    system.equation_names = independent
        .iter()
        .filter_map(|&i| names.get(i).cloned())
        .collect();
    let equations = &system.equations;
    system.equations = independent.iter().map(|&i| equations[i]).collect();
}

/// The factors of an expression as it is typed, each once, without exponents and signs.
fn factors(expressions: &Expressions, expression: NodeId) -> Vec<NodeId> {
    let mut factors = Vec::new();
    let mut left = vec![expression];
    while let Some(node) = left.pop() {
        match expressions.node(node) {
            Node::Power(base, _) | Node::Negate(base) => left.push(*base),
            Node::Multiply(a, b) => left.extend([*b, *a]),
            _ if factors.contains(&node) => {}
            _ => factors.push(node),
        }
    }
    factors
}

/// An angle of the system that a text names.
fn angle_in<'a>(text: &str, system: &'a System) -> Option<&'a str> {
    let has = |name: &str| text.split(|c| !is_of_name(c)).any(|word| word == name);
    let mut names = system.angle_unknowns().map(|angle| angle.name.as_str());
    names.find(|name| has(name))
}

/// Expressions that the conditions require to be at least 0, put into the graph of the system. Those that are positive
/// multiples of each other are one: their gradients depend on each other, so that multipliers would not be determined.
fn alternatives(
    system: &mut System,
    conditions: &Conditions,
) -> Result<Vec<Alternative>, ClientError> {
    let Some(inequalities) = conditions.inequalities() else {
        let message = "expected comparisons `<`, `<=`, `>`, `>=` that hold together beside an objective; an equality is \
                       typed as an equation, and alternatives (`or`, `!=`) are solved one after the other";
        return Err(refused(CONDITIONS, message));
    };
    let (variables, parameters) = (system.variables.len(), system.parameters.len());
    let (graph, mut imported) = (&mut system.expressions, Imported::default());
    let mut alternatives: Vec<Alternative> = Vec::with_capacity(inequalities.len());
    let mut polynomials: Vec<Option<Polynomial>> = Vec::new();
    for Inequality {
        difference,
        is_upper,
    } in inequalities
    {
        let root = conditions.differences[difference];
        let copy = graph.import(
            &conditions.expressions,
            root,
            &mut imported,
            &mut |graph, leaf| graph.insert(leaf.clone()),
        );
        let expression = match is_upper {
            true => graph.negate(copy),
            false => copy,
        };
        let expanded = Polynomial::expand(graph, expression, variables, parameters);
        let is_same = |other: &Option<Polynomial>| {
            let pair = expanded.as_ref().zip(other.as_ref());
            pair.is_some_and(|(a, b)| a.is_positive_multiple_of(b))
        };
        match polynomials.iter().position(is_same) {
            Some(first) => alternatives[first].differences.push(difference),
            None => {
                polynomials.push(expanded);
                alternatives.push(Alternative {
                    expression,
                    differences: vec![difference],
                    has_multiplier: true,
                });
            }
        }
    }
    Ok(alternatives)
}

/// Whether an alternative is that a root of a sum of even powers is at least 0: where the radicand is 0 it is least, so that
/// the gradient of the root's equation is 0, and the point is critical for any objective.
fn is_root_of_even_powers(
    system: &System,
    with_helpers: Option<&System>,
    alternative: &Alternative,
) -> bool {
    let Node::Variable(variable) = system.expressions.node(alternative.expression) else {
        return false;
    };
    let mut roots = with_helpers.into_iter().flat_map(System::root_unknowns);
    roots.any(|root| {
        root.variable == *variable as usize
            && lower_bound(&system.expressions, root.radicand, &[]).is_some_and(|b| b >= 0.0)
    })
}

/// Refuses conditions on angles, which are no polynomial inequalities.
fn refuse_angles(system: &System, conditions: &Conditions) -> Result<(), ClientError> {
    for angle in system.angle_unknowns() {
        let is_angle = |id: NodeId| match conditions.expressions.node(id) {
            Node::Variable(variable) => *variable as usize == angle.cosine,
            _ => false,
        };
        let nodes = below(&conditions.expressions, &conditions.differences);
        if nodes.into_iter().any(is_angle) {
            let message = format!(
                "expected no condition on the angle `{}` beside an objective (not in this version)",
                angle.name
            );
            return Err(refused(CONDITIONS, &message));
        }
    }
    Ok(())
}

/// Refuses systems of which the points are no affine ones.
fn check(system: &System, name: &str) -> Result<(), ClientError> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return Err(refused(
            name,
            "homogeneous groups have no values of an expression",
        ));
    }
    if !system.conjugates.is_empty() {
        let message = "pairs of conjugates do not go with an objective in this version";
        return Err(refused(name, message));
    }
    match system.path_variable {
        Some(_) => Err(refused(
            name,
            "does not go with a homotopy of the user's own",
        )),
        None => Ok(()),
    }
}

fn refused(origin: &str, message: &str) -> ClientError {
    ClientError::Input {
        origin: origin.into(),
        message: message.into(),
    }
}

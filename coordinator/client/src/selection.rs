//! Selection: which solutions are wanted, and in which order.

use super::error::ClientError;
use clap::Args;
use cognate_solutions::critical::{Critical, CriticalCounts, CriticalPoint};
use cognate_solutions::selection::{Selector, Verdict};
use cognate_solutions::solution::Solution;
use cognate_solutions::witness::WitnessSet;
use cognate_systems::condition::Conditions;
use cognate_systems::evaluation::values;
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::formats::{FormatError, conditions};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::clear_denominators;
use num_complex::Complex64;

/// The solutions that are wanted, as typed.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Selection")]
pub struct SelectionArguments {
    /// Show only real solutions; the counts stay those of all
    #[arg(long)]
    pub real: bool,
    /// Show only real solutions with all unknowns greater than 0
    #[arg(long)]
    pub positive: bool,
    /// Show only real solutions that meet a condition in the unknowns and parameters, such as "x > 0 and y < 2*x"; several
    /// hold together
    #[arg(long = "where", value_name = "CONDITION", allow_hyphen_values = true)]
    pub conditions: Vec<String>,
    /// Order of the solutions: by ascending values of this expression
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    pub sort: Option<String>,
}

impl SelectionArguments {
    /// True where all solutions are shown as they come.
    pub fn is_empty(&self) -> bool {
        !self.real && !self.positive && self.conditions.is_empty() && self.sort.is_none()
    }

    /// The conditions of the options, added to those of the system's file.
    ///
    /// # Errors
    /// When a text is no condition, or names a variable that the system does not have.
    pub fn conditions(
        &self,
        system: &System,
        mut wanted: Conditions,
    ) -> Result<Conditions, ClientError> {
        let described = |e: FormatError| ClientError::Format(e.to_string());
        if self.positive {
            let positive: Vec<String> = system
                .variables
                .iter()
                .map(|name| format!("{name} > 0"))
                .collect();
            let text = [positive.join(" and ")];
            conditions::add("--positive", &text, system, &mut wanted).map_err(described)?;
        }
        conditions::add("--where", &self.conditions, system, &mut wanted).map_err(described)?;
        Ok(wanted)
    }

    /// View of the solutions of a system, of which the equations may not be at hand: then only the names of its
    /// unknowns count. `wanted` are the conditions, in this number of variables, `parameters` the values at each target.
    ///
    /// # Errors
    /// When a text is no expression, or names a variable that the system does not have.
    pub fn view(
        &self,
        system: &System,
        variables: usize,
        wanted: Conditions,
        parameters: Vec<Vec<Complex64>>,
    ) -> Result<View, ClientError> {
        let order = self
            .sort
            .as_ref()
            .map(|text| conditions::expression("--sort", text, system));
        let order = order.transpose();
        let order = order.map_err(|e| ClientError::Format(e.to_string()))?;
        let selects = self.real || !wanted.is_empty();
        let equations = Some(system.clone()).filter(|system| !system.equations.is_empty());
        let count = system.parameters.len();
        // Solutions at values that nobody gave: what holds a parameter is not known.
        let unknown = || vec![vec![Complex64::new(f64::NAN, f64::NAN); count]];
        let parameters = match parameters.is_empty() {
            true => unknown(),
            false => parameters,
        };
        Ok(View {
            unknowns: system.variables.clone(),
            selector: selects.then(|| Selector::new(wanted, variables, count, equations)),
            order: order.map(|(expressions, node)| Order { expressions, node }),
            parameter_names: system.parameters.clone(),
            parameters,
            critical: None,
        })
    }
}

/// The expression that gives the order of the solutions.
#[derive(Debug)]
struct Order {
    expressions: Expressions,
    node: NodeId,
}

/// A solution as it is shown.
#[derive(Clone, Debug)]
pub struct Presented {
    /// The solution.
    pub solution: Solution,
    /// Kind of critical point, if an objective was asked.
    pub critical: Option<CriticalPoint>,
    /// Whether it is selected; `None` where all are shown.
    pub verdict: Option<Verdict>,
}

/// Selection and order of the solutions of one system, as they are shown.
#[derive(Debug, Default)]
pub struct View {
    /// Names of the unknowns, where they are at hand.
    unknowns: Vec<String>,
    selector: Option<Selector>,
    order: Option<Order>,
    parameter_names: Vec<String>,
    /// Values of the parameters at each target; empty where there are none.
    parameters: Vec<Vec<Complex64>>,
    /// The objective of which the solutions are critical points.
    critical: Option<Critical>,
}

impl View {
    /// The view of the critical points of an objective, where there is one.
    #[must_use]
    pub fn with_critical(self, critical: Option<Critical>) -> Self {
        Self { critical, ..self }
    }

    /// True where the solutions are critical points.
    pub fn is_critical(&self) -> bool {
        self.critical.is_some()
    }

    /// A solution at a target as it is shown, with its kind of critical point, and whether it is selected.
    pub fn presented(&mut self, solution: Solution, target: u32) -> Presented {
        let parameters = self.parameters.get(target as usize);
        let parameters = parameters.map_or(&[][..], Vec::as_slice);
        let selector = self.selector.as_mut();
        match &mut self.critical {
            None => Presented {
                verdict: selector.map(|selector| selector.verdict(&solution, parameters)),
                solution,
                critical: None,
            },
            Some(critical) => {
                let presented = critical.present(solution, parameters, selector);
                Presented {
                    solution: presented.solution,
                    critical: Some(presented.point),
                    verdict: presented.verdict,
                }
            }
        }
    }

    /// The critical points that were presented, counted; `doubt` says why they are not known to be all.
    pub fn critical_counts(&self, doubt: Option<String>) -> Option<CriticalCounts> {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        let critical = self.critical.as_ref();
        critical.map(|critical| critical.counts(parameters, doubt))
    }

    /// Adds the components of a whole decomposition of the critical points.
    pub fn add_critical_sets(&mut self, sets: &[WitnessSet]) {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        if let Some(critical) = &mut self.critical {
            critical.add_sets(sets, parameters);
        }
    }

    /// The system of which solutions tell whether values on sets of critical points are taken; `None` where none is needed.
    pub fn near_critical_sets(&self) -> Option<System> {
        let mut system = self.critical.as_ref()?.near_sets()?;
        clear_denominators(&mut system);
        Some(system)
    }

    /// Adds the solutions of that system; `are_all` says that there are no others.
    pub fn add_points_near_critical_sets(&mut self, solutions: Vec<Solution>, are_all: bool) {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        if let Some(critical) = &mut self.critical {
            critical.add_points_near_sets(solutions, are_all, parameters);
        }
    }

    /// The system of which the solutions bound the values on the points that meet the conditions; `None` where none is
    /// needed.
    pub fn farthest(&self) -> Option<System> {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        let mut system = self.critical.as_ref()?.farthest(parameters)?;
        clear_denominators(&mut system);
        Some(system)
    }

    /// Adds all solutions of that system.
    pub fn add_farthest_points(&mut self, solutions: Vec<Solution>) {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        if let Some(critical) = &mut self.critical {
            critical.add_farthest_points(solutions, parameters);
        }
    }

    /// The system of the points where the curve of extremes on spheres turns back; `None` where none is needed.
    pub fn turning_points(&self, critical: &[Solution]) -> Option<System> {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        self.critical.as_ref()?.turning_points(critical, parameters)
    }

    /// The system of the critical points on a sphere that these points lie in.
    pub fn on_sphere(&self, turning: &[Solution], critical: &[Solution]) -> Option<System> {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        let objective = self.critical.as_ref()?;
        Some(objective.on_sphere(turning, critical, parameters))
    }

    /// Adds all solutions of that system.
    pub fn add_points_on_sphere(&mut self, points: &[Solution]) {
        let parameters = self.parameters.first().map_or(&[][..], Vec::as_slice);
        if let Some(critical) = &mut self.critical {
            critical.add_points_on_sphere(points, parameters);
        }
    }

    /// The critical points at which only multipliers move, to be presented as solutions are; they are in no count of
    /// solutions.
    pub fn single_critical_points(&self) -> Vec<Solution> {
        let critical = self.critical.as_ref();
        critical.map_or(Vec::new(), |critical| critical.single_points().to_vec())
    }

    /// How many critical points are isolated by a whole decomposition, where one was made.
    pub fn isolated_critical_points(&self) -> Option<u64> {
        self.critical.as_ref().and_then(Critical::isolated)
    }

    /// The conditions in one text, where there are some.
    pub fn condition(&self) -> Option<String> {
        self.selector.as_ref().map(Selector::text)
    }

    /// Names of the unknowns, where they are at hand.
    pub fn unknowns(&self) -> &[String] {
        &self.unknowns
    }

    /// Names of the parameters, where they are at hand.
    pub fn parameter_names(&self) -> &[String] {
        &self.parameter_names
    }

    /// Values of the parameters at each target.
    pub fn targets(&self) -> &[Vec<Complex64>] {
        &self.parameters
    }

    /// True where solutions come in another order than that of their paths: that of the expression that was asked, else
    /// critical points in that of the objective.
    pub fn is_sorted(&self) -> bool {
        self.order.is_some() || self.critical.is_some()
    }

    fn values(&self, target: u32) -> &[Complex64] {
        self.parameters
            .get(target as usize)
            .map_or(&[], Vec::as_slice)
    }

    /// The number by which a solution is sorted; not a number goes last.
    pub fn key(&self, presented: &Presented, target: u32) -> f64 {
        let Some(Order { expressions, node }) = &self.order else {
            return presented.critical.map_or(0.0, |point| point.objective);
        };
        let point: Vec<Complex64> = presented.solution.variables.values().collect();
        let value = values(expressions, &[*node], &point, self.values(target));
        match value[0].re {
            key if key.is_nan() => f64::NAN,
            key => key,
        }
    }
}

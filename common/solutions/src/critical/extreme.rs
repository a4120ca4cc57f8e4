//! The least or largest value of an objective: which it is, and the reason why it is taken.

use super::value::{Place, Value};
use super::{Alternative, Critical, CriticalCounts, CriticalSets, Extreme};
use cognate_systems::expression::{Node, NodeId};
use cognate_systems::objective::Goal;
use cognate_systems::polynomial::Polynomial;
use cognate_systems::polynomial::attained::{Attained, Region, attained, lower_bound};
use cognate_systems::polynomial::quotient::Quotient;
use cognate_systems::polynomial::sublevel_set::takes_its_extreme;
use num_complex::Complex64;

impl Critical {
    /// The counts. `doubt` says why not all critical points are known, where that is so.
    pub fn counts(&self, parameters: &[Complex64], doubt: Option<String>) -> CriticalCounts {
        let [minima, maxima, saddles, degenerate] = self.counts;
        let mut counts = CriticalCounts {
            objective: self.text.clone(),
            minimum: None,
            maximum: None,
            minima,
            maxima,
            saddles,
            degenerate,
            outside: self.alternatives.as_ref().map(|_| self.outside),
            with_sets_of_multipliers: Some(self.single_points().len() as u64)
                .filter(|count| *count > 0),
            sets_of_multipliers_only: self.sets.as_ref().is_some_and(|sets| sets.count == 0),
            reason: "critical points were asked, not the least or the largest value".into(),
        };
        let sign = match self.goal {
            Goal::Critical => return counts,
            Goal::Minimize => 1.0,
            Goal::Maximize => -1.0,
        };
        let (extreme, reason) = self.extreme(sign, parameters, doubt);
        counts.reason = reason;
        match self.goal {
            Goal::Maximize => counts.maximum = extreme,
            _ => counts.minimum = extreme,
        }
        counts
    }

    /// The least value (`sign` 1) or the largest (`sign` -1), where it is known, and the reason.
    fn extreme(
        &self,
        sign: f64,
        parameters: &[Complex64],
        doubt: Option<String>,
    ) -> (Option<Extreme>, String) {
        let least = if sign > 0.0 { "least" } else { "largest" };
        if let Some(doubt) = doubt {
            return (None, format!("not all critical points are known: {doubt}"));
        }
        if self.values.iter().any(|value| !value.error.is_finite()) {
            return (None, "the accuracy of a critical point is not known".into());
        }
        // Where all points are known one that the conditions exclude is no neighbour of others.
        let is_finite = self.has_finitely_many_points();
        let allowed = self.values.iter();
        let allowed = allowed.filter(|value| !(is_finite && value.place == Place::Excluded));
        let by_value = |a: &&Value, b: &&Value| (sign * a.value).total_cmp(&(sign * b.value));
        let best = allowed.min_by(by_value);
        let best = best.and_then(|best| self.near(best).min_by_key(|value| value.place));
        if let Some(reason) = best.and_then(Value::doubt) {
            return (None, reason);
        }
        let expressions = &self.system.expressions;
        let variable_of = |alternative: &Alternative| match expressions.node(alternative.expression)
        {
            Node::Variable(variable) => Some(*variable as usize),
            _ => None,
        };
        let nonnegative: Vec<usize> = self.alternatives().iter().filter_map(variable_of).collect();
        let bound = (sign > 0.0).then(|| lower_bound(expressions, self.objective, &nonnegative));
        let by_bound = || {
            let reaches = |bound: &f64| best.is_some_and(|best| best.value - best.error <= *bound);
            bound
                .flatten()
                .filter(reaches)
                .map(|_| Attained::LowerBound)
        };
        let finite = is_finite.then_some(Attained::Finite);
        let attained = finite.or_else(|| self.attained(sign, parameters));
        let attained = attained.or_else(by_bound);
        let by_sublevel_set = || {
            let bounds = self.bounds_sublevel_set(sign, best?.value, parameters);
            bounds.then_some(Attained::BoundedSublevelSet)
        };
        let attained = attained.or_else(by_sublevel_set);
        let beyond = || {
            let lower = if sign > 0.0 { "lower" } else { "larger" };
            let near = if self.has_denominators {
                ", or near the zeros of a denominator,"
            } else {
                ""
            };
            format!("a {lower} value towards infinity{near} is not excluded")
        };
        if let Some(Value {
            value,
            place: Place::Limit,
            ..
        }) = best
        {
            let also = attained.map_or_else(|| format!("; {}", beyond()), |_| String::new());
            let reason = format!(
                "there is none: values come as near as one likes to {value}, at a point that the conditions \
                 exclude{also}"
            );
            return (None, reason);
        }
        let Some(attained) = attained else {
            return (None, format!("all critical points are known; {}", beyond()));
        };
        let Some(best) = best else {
            let reason = "there is no real solution: the value would be taken at one";
            return (None, reason.into());
        };
        let inside = |value: &&Value| value.place == Place::Inside;
        let extreme = Extreme {
            value: best.value,
            points: self.near(best).filter(inside).count() as u64,
        };
        let because = self.because(attained);
        let on_sets = match &self.sets {
            Some(CriticalSets { count: 0, .. }) | None => String::new(),
            Some(CriticalSets { count, .. }) => {
                format!(", also on {count} positive-dimensional sets of critical points")
            }
        };
        let reason =
            format!("the {least} of all critical values{on_sets}, which is taken since {because}");
        (Some(extreme), reason)
    }

    /// The reason why a value is taken, in words.
    fn because(&self, attained: Attained) -> String {
        let given = match (self.constraints(), self.alternatives().len()) {
            (_, 0) => "equations",
            (0, _) => "conditions",
            _ => "equations and conditions",
        };
        match attained {
            Attained::Finite => "the equations have finitely many solutions".to_owned(),
            Attained::Bounded => format!("the {given} bound all unknowns"),
            Attained::Grows => format!(
                "the objective grows towards infinity in every direction that the {given} leave"
            ),
            Attained::LowerBound => "no sum of even powers is below it".to_owned(),
            Attained::BoundedSublevelSet => {
                "the points with values as good are a bounded set, away from zeros of denominators"
                    .to_owned()
            }
        }
    }

    /// Whether the equations have finitely many solutions, all of which are critical points: there are as many equations as
    /// unknowns, so that at each solution multipliers solve the gradient's equations.
    fn has_finitely_many_points(&self) -> bool {
        let sets = self.sets.as_ref();
        self.constraints() >= self.unknowns && sets.is_none_or(|sets| sets.count == 0)
    }

    /// The values that may be the same as this one.
    fn near<'a>(&'a self, value: &'a Value) -> impl Iterator<Item = &'a Value> {
        self.values.iter().filter(|other| other.is_near(value))
    }

    fn attained(&self, sign: f64, parameters: &[Complex64]) -> Option<Attained> {
        if self.has_denominators {
            return None;
        }
        let objective = self.expanded(self.objective)?;
        let equations = self.given_equations().filter_map(|e| self.expanded(e));
        let equations: Vec<Polynomial> = equations.collect();
        let inequalities = self.alternatives().iter();
        let inequalities = inequalities.filter_map(|a| self.expanded(a.expression));
        let inequalities: Vec<Polynomial> = inequalities.collect();
        let region = Region {
            equations: &equations,
            inequalities: &inequalities,
            parameters,
        };
        attained(&objective, &region, sign)
    }

    /// Whether the points with values that are no worse than this one are a bounded set, away from zeros of denominators.
    fn bounds_sublevel_set(&self, sign: f64, value: f64, parameters: &[Complex64]) -> bool {
        let expressions = &self.system.expressions;
        let objective = Quotient::of(expressions, self.objective, self.unknowns, parameters);
        let equations = self.given_equations().map(|e| self.expanded(e));
        let inequalities = self.alternatives().iter();
        let inequalities = inequalities.map(|a| self.expanded(a.expression));
        // The region is closed: its equations and conditions have no denominators.
        let parts: (Option<Vec<_>>, Option<Vec<_>>) = (equations.collect(), inequalities.collect());
        let (Some(objective), (Some(equations), Some(inequalities))) = (objective, parts) else {
            return false;
        };
        let region = Region {
            equations: &equations,
            inequalities: &inequalities,
            parameters,
        };
        takes_its_extreme(&objective, &region, sign, value)
    }

    /// The equations that were given.
    fn given_equations(&self) -> impl Iterator<Item = NodeId> + '_ {
        let equations = &self.system.equations[self.unknowns..];
        equations[..self.constraints()].iter().copied()
    }

    /// An expression as a polynomial in the unknowns without multipliers, which do not occur in it.
    fn expanded(&self, node: NodeId) -> Option<Polynomial> {
        let (n, total) = (self.unknowns, self.system.variables.len());
        let parameters = self.system.parameters.len();
        let expanded = Polynomial::expand(&self.system.expressions, node, total, parameters)?;
        let terms = expanded.terms.into_iter().map(|(mut key, coefficient)| {
            key.drain(n..total);
            (key, coefficient)
        });
        Some(Polynomial {
            terms: terms.collect(),
            variables: n,
        })
    }
}

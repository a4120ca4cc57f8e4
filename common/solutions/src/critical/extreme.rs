//! The least or largest value of an objective: which it is, and the reason why it is taken.

use super::value::{Place, Value};
use super::{Alternative, Critical, CriticalCounts, CriticalSets, Extreme};
use cognate_numeric::counted::counted;
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
        let bound = (sign > 0.0).then(|| self.lower_bound()).flatten();
        let allowed = self.values_that_may_be_taken(bound, sign);
        let by_value = |a: &&Value, b: &&Value| (sign * a.value).total_cmp(&(sign * b.value));
        let first = allowed.iter().min_by(by_value);
        let best = first.and_then(|first| near(&allowed, first).min_by_key(|value| value.place));
        let on_set = best.filter(|best| best.place == Place::OnSet);
        let proof = on_set.and_then(|best| self.point_that_proves(best, &allowed, sign));
        if proof.is_none()
            && let Some(reason) = best.and_then(Value::doubt)
        {
            return (None, reason);
        }
        let attained = self.why_taken(best, bound, sign, parameters);
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
            points: near(&allowed, best).filter(inside).count() as u64,
        };
        let because = self.because(attained);
        let on_sets = match (&self.sets, proof) {
            (Some(CriticalSets { count: 0, .. }) | None, _) => String::new(),
            (Some(CriticalSets { count, .. }), None) => {
                format!(
                    ", those on {} included",
                    counted(*count, "positive-dimensional set")
                )
            }
            (Some(_), Some(point)) => {
                let example = self.example(point);
                format!(", on a positive-dimensional set of critical points{example}")
            }
        };
        let reason =
            format!("the {least} of all critical values{on_sets}, which is taken since {because}");
        (Some(extreme), reason)
    }

    /// A bound below the objective on the points that meet the conditions, where its form gives one.
    pub(super) fn lower_bound(&self) -> Option<f64> {
        let expressions = &self.system.expressions;
        let variable_of = |alternative: &Alternative| match expressions.node(alternative.expression)
        {
            Node::Variable(variable) => Some(*variable as usize),
            _ => None,
        };
        let nonnegative: Vec<usize> = self.alternatives().iter().filter_map(variable_of).collect();
        lower_bound(expressions, self.objective, &nonnegative)
    }

    /// The critical values without those that no point takes which meets the conditions: on sets they lie below a bound,
    /// and where all points are known one that the conditions exclude is no neighbour of others.
    fn values_that_may_be_taken(&self, bound: Option<f64>, sign: f64) -> Vec<Value> {
        let is_finite = self.has_finitely_many_points();
        let bounds = [bound, self.least_inside];
        let may_be_taken = |value: &&Value| match value.place {
            Place::Excluded => !is_finite,
            Place::OnSet => {
                let mut bounds = bounds.iter().flatten();
                bounds.all(|bound| sign * value.value + value.error >= *bound)
            }
            _ => true,
        };
        self.values.iter().filter(may_be_taken).copied().collect()
    }

    /// The reason why the best of the critical values is taken.
    fn why_taken(
        &self,
        best: Option<&Value>,
        bound: Option<f64>,
        sign: f64,
        parameters: &[Complex64],
    ) -> Option<Attained> {
        if self.has_finitely_many_points() {
            return Some(Attained::Finite);
        }
        let by_form = self.attained(sign, parameters);
        let Some(best) = best else { return by_form };
        let reaches_bound = || bound.is_some_and(|bound| best.value - best.error <= bound);
        if by_form.is_some() {
            by_form
        } else if reaches_bound() {
            Some(Attained::LowerBound)
        } else if self.bounds_sublevel_set(sign, best.value, parameters) {
            Some(Attained::BoundedSublevelSet)
        } else if self.grows_beyond(best.value, sign) {
            Some(Attained::GrowsOutwards)
        } else {
            None
        }
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
            Attained::GrowsOutwards => {
                "all values on and beyond a sphere around the critical points are worse".to_owned()
            }
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

    pub(super) fn attained(&self, sign: f64, parameters: &[Complex64]) -> Option<Attained> {
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

/// The values that may be the same as this one.
fn near<'a>(values: &'a [Value], value: &Value) -> impl Iterator<Item = &'a Value> {
    values.iter().filter(move |other| other.is_near(value))
}

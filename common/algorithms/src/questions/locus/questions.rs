//! Questions whose answers are loci: intersections and singular loci.

use super::super::error::QuestionError;
use super::{Locus, Wanted};
use crate::decomposition::operand::MOST_WITNESS_POINTS;
use cognate_solutions::witness::WitnessSet;
use cognate_solutions::witness::question::SecondSet;
use cognate_systems::system::System;
use cognate_systems::transform::MOST_CRITICAL_VARIABLES;

impl Locus {
    /// Intersection of these components with a second set.
    pub fn intersection(
        system: &System,
        components: &[WitnessSet],
        second: &SecondSet,
    ) -> Result<Self, QuestionError> {
        check_second(second, components, system.equations.len())?;
        let wanted = if second.components.is_empty() {
            Wanted::Equations { from: second.from }
        } else {
            Wanted::Others
        };
        Ok(Self {
            second: Some(second.clone()),
            ..Self::new(wanted, 0..components.len())
        })
    }

    /// Singular loci of these components.
    pub fn singular(system: &System, components: &[WitnessSet]) -> Result<Self, QuestionError> {
        let n = system.variables.len();
        if n > MOST_CRITICAL_VARIABLES && components.iter().any(|c| c.dimension() > 0) {
            return Err(QuestionError::wish(
                "singular locus",
                format!("{n} variables"),
                format!("at most {MOST_CRITICAL_VARIABLES}"),
            ));
        }
        Ok(Self::new(Wanted::Singular, 0..components.len()))
    }
}

/// Whether a second set is one, with not too many paths.
fn check_second(
    second: &SecondSet,
    components: &[WitnessSet],
    equations: usize,
) -> Result<(), QuestionError> {
    let wrong = |value, expected| Err(QuestionError::wish("intersect", value, expected));
    let (component_equations, from) = (second.own as usize, second.from as usize);
    if component_equations == 0
        || component_equations > equations
        || from > component_equations
        || from == equations
    {
        let description = format!(
            "equations 1 to {component_equations} of the components, from {} of the others",
            from + 1
        );
        let expected =
            format!("some of {equations} for each, and all of them for one or the other");
        return wrong(description, expected);
    }
    let points = |sets: &[WitnessSet]| sets.iter().map(|set| set.points.len()).sum::<usize>();
    let paths = points(components).saturating_mul(points(&second.components));
    if paths > MOST_WITNESS_POINTS {
        let expected = format!("at most {MOST_WITNESS_POINTS}");
        return wrong(format!("{paths} pairs of witness points"), expected);
    }
    Ok(())
}

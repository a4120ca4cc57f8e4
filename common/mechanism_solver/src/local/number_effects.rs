//! Effects of numbers: whether a mechanism keeps its freedoms at a configuration where one number of its file is changed a
//! little, and no other.
//!
//! With the number p as one more coordinate, the configurations (q, p) around (q0, p0) contain those with p = p0, which have
//! the local dimension m. They have dimension m + 1 exactly if over other values of p near p0 there are m freedoms near q0:
//! only a part that lies over all of these values can be larger than m. So the question is that of a local dimension again.

use super::assembly::Assembly;
use super::conditions::{Condition, Place, Square, Step};
use super::field::{Doubles, Residues};
use super::local_ring::{Doubt, LocalRing, first_order, local_ring};
use super::mobility::{Mobility, nearly_singular};
use super::moved_parts::NUMBER;
use super::nearby::{has_dimension_over, refined};
use cognate_kinematics::mechanism::configuration::GivenConfiguration;
use cognate_kinematics::mechanism::file_number::{FileNumber, Moves};
use cognate_kinematics::mechanism::{Body, Mechanism};

/// Effect of a small change of one number on the freedoms of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberEffect {
    /// The number.
    pub number: FileNumber,
    /// Whether there are as many freedoms near the configuration; `None` in doubt.
    pub keeps: Option<bool>,
    /// Whether the mechanism can be assembled near the configuration; `None` where that is not decided.
    pub assembles: Option<bool>,
    /// A sentence.
    pub reason: String,
}

impl NumberEffect {
    fn kept(number: FileNumber, reason: impl Into<String>) -> Self {
        Self {
            number,
            keeps: Some(true),
            assembles: Some(true),
            reason: reason.into(),
        }
    }

    fn in_doubt(number: FileNumber, reason: impl Into<String>) -> Self {
        Self {
            number,
            keeps: None,
            assembles: None,
            reason: format!("in doubt: {}", reason.into()),
        }
    }
}

/// The effect of each number of the file at a configuration that has this mobility.
pub fn number_effects(
    mechanism: &Mechanism,
    given: &GivenConfiguration,
    mobility: &Mobility,
    seed: u64,
) -> Result<Vec<NumberEffect>, String> {
    let numbers = mechanism.file_numbers();
    let (Some(freedoms), Some(infinitesimal)) = (mobility.local, mobility.infinitesimal) else {
        let reason = "the freedoms at this configuration are in doubt themselves";
        let effect = |number| NumberEffect::in_doubt(number, reason);
        return Ok(numbers.into_iter().map(effect).collect());
    };
    let mut assembly = Assembly::of(mechanism, given)?;
    if !mobility.is_exact {
        assembly = refined(assembly);
    }
    let place = Configuration {
        mechanism,
        given,
        assembly,
        is_exact: mobility.is_exact,
        freedoms,
        infinitesimal,
        seed,
    };
    let is_regular = place.is_regular();
    let effect = |number: FileNumber| match number.moves {
        _ if is_regular => Ok(NumberEffect::kept(
            number,
            "the conditions are independent to the first order, whatever the number",
        )),
        Moves::Nothing => Ok(NumberEffect::kept(
            number,
            "only the zero of the joint's value depends on it",
        )),
        Moves::NotFollowed => Ok(NumberEffect::in_doubt(
            number,
            "not in this version: the orientation of a base or tool, and the direction of a shift in space in the coordinates of links",
        )),
        _ => place.effect(number),
    };
    numbers.into_iter().map(effect).collect()
}

/// A mechanism at a configuration of which the freedoms are known.
struct Configuration<'a> {
    mechanism: &'a Mechanism,
    given: &'a GivenConfiguration,
    assembly: Assembly,
    is_exact: bool,
    /// The local dimension.
    freedoms: usize,
    /// Freedoms to the first order.
    infinitesimal: usize,
    seed: u64,
}

impl Configuration<'_> {
    /// Whether every condition takes one freedom to the first order.
    fn is_regular(&self) -> bool {
        let (_, rows) = first_order(&Doubles, &self.assembly);
        let conditions = rows.len() - self.assembly.constant_conditions();
        self.assembly.values.len() == self.infinitesimal + conditions
    }

    fn effect(&self, number: FileNumber) -> Result<NumberEffect, String> {
        let mut assembly = Assembly::with_number(self.mechanism, self.given, &number.moves)?;
        // The number's coordinate is the first one.
        let offset = self.assembly.offset.iter().cloned();
        assembly.offset.splice(NUMBER + 1.., offset);
        if !depends_on_number(&assembly) {
            return Ok(NumberEffect::kept(number, "no condition depends on it"));
        }
        let (ring, is_exact) = self.ring(&assembly, self.freedoms);
        Ok(match ring {
            Ok(mut ring) => {
                if ring.most_dimension > self.freedoms && !ring.is_regular {
                    self.bound_by_slices(&mut ring, &assembly);
                }
                self.told(number, &ring, &assembly, is_exact)
            }
            Err(Doubt::Open) => NumberEffect::in_doubt(
                number,
                "Newton's method does not close the mechanism near the configuration that is given",
            ),
            Err(Doubt::SingularValue(part)) => NumberEffect::in_doubt(
                number,
                format!("a singular value of {part:.1e} of the largest may be 0 or not"),
            ),
        })
    }

    /// The local ring of an assembly, of which the dimension is known to be at least `least_dimension`, and whether it is that
    /// of exact numbers.
    fn ring(
        &self,
        assembly: &Assembly,
        least_dimension: usize,
    ) -> (Result<LocalRing, Doubt>, bool) {
        let residues = match self.is_exact {
            true => Residues::of(&assembly.constants(), 0),
            false => None,
        };
        match residues {
            Some(field) => (local_ring(&field, assembly, least_dimension), true),
            None => (local_ring(&Doubles, assembly, least_dimension), false),
        }
    }

    /// Bounds the dimension by that of as many general slices through the configuration as there are freedoms: each takes one
    /// dimension at most. Their ring has fewer coordinates, so that it is known to a higher order.
    fn bound_by_slices(&self, ring: &mut LocalRing, assembly: &Assembly) {
        let sliced = assembly.clone().sliced(self.freedoms, self.seed);
        if let (Ok(on_slices), _) = self.ring(&sliced, 0) {
            let bound = self.freedoms + on_slices.most_dimension;
            ring.most_dimension = ring.most_dimension.min(bound);
        }
    }

    /// Effect by the local ring with the number as a coordinate, and by configurations with other values of the number.
    fn told(
        &self,
        number: FileNumber,
        ring: &LocalRing,
        assembly: &Assembly,
        is_exact: bool,
    ) -> NumberEffect {
        if is_exact && let Some(part) = nearly_singular(assembly, ring.infinitesimal) {
            return NumberEffect::in_doubt(
                number,
                format!(
                    "by the numbers as they are written it takes part in the conditions, but a singular value is only {part:.1e} of the largest"
                ),
            );
        }
        let (freedoms, least, most) = (self.freedoms, ring.least_dimension, ring.most_dimension);
        if most <= freedoms {
            let reason = match ring.infinitesimal <= freedoms {
                true => "other values do not close the mechanism near there, to the first order",
                false => "by the growth of the local ring with the number as one more unknown",
            };
            return NumberEffect {
                number,
                keeps: Some(false),
                assembles: self.assembles(ring, assembly),
                reason: reason.into(),
            };
        }
        if ring.is_regular {
            return NumberEffect::kept(
                number,
                "the conditions are independent to the first order, with the number as one more unknown",
            );
        }
        if least > freedoms {
            return NumberEffect::kept(number, "every condition takes one freedom at most");
        }
        if has_dimension_over(assembly, NUMBER, freedoms + 1, self.seed) {
            return NumberEffect::kept(
                number,
                format!("positions with other values and {freedoms} freedoms were met beside it"),
            );
        }
        NumberEffect::in_doubt(
            number,
            format!(
                "with the number as one more unknown the local dimension is between {freedoms} and {most}, and no position with another \
                 value and as many freedoms was met beside it"
            ),
        )
    }

    /// Whether the mechanism closes near the configuration for other values of a number that takes a freedom away.
    fn assembles(&self, ring: &LocalRing, assembly: &Assembly) -> Option<bool> {
        let is_home = *self.given == GivenConfiguration::Home;
        if is_home && matches!(&self.mechanism.body, Body::Linkage(linkage) if linkage.at_home) {
            // Joints are given where they are closed.
            return Some(true);
        }
        if ring.infinitesimal == self.freedoms {
            // The configurations with the number as it is are all, a manifold.
            return Some(false);
        }
        let mut dimensions = 1..=self.freedoms;
        let is_met =
            dimensions.any(|dimension| has_dimension_over(assembly, NUMBER, dimension, self.seed));
        is_met.then_some(true)
    }
}

/// Whether the number's coordinate occurs in a condition.
fn depends_on_number(assembly: &Assembly) -> bool {
    let is_number = |step: &Step| match step {
        Step::Fixed(_) => false,
        Step::Turn { coordinate, .. }
        | Step::Shift { coordinate, .. }
        | Step::Spin { coordinate, .. } => *coordinate == NUMBER,
    };
    let in_places = |places: &[Place]| places.iter().any(|place| place.steps.iter().any(is_number));
    assembly.conditions.iter().any(|condition| match condition {
        Condition::Loop(steps) => steps.iter().any(is_number),
        Condition::Meet(places) => in_places(&**places),
        Condition::Slice(_) => false,
        Condition::Distance(parts) => {
            let in_square = match &parts.1 {
                Square::Number(_) => false,
                Square::Changed { .. } => true,
                Square::Between(places) => in_places(&**places),
            };
            in_square || in_places(&parts.0)
        }
    })
}

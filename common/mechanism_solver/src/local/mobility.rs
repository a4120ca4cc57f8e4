//! Mobility: the freedoms of a mechanism at one configuration, to the first order and in earnest.

use super::assembly::Assembly;
use super::field::{Doubles, Residues};
use super::local_ring::{Doubt, LocalRing, first_order, local_ring};
use super::nearby::{CLOSES, gap, has_dimension, refined};
use super::ranks::{NONZERO, singular_values};
use cognate_kinematics::mechanism::Mechanism;
use cognate_kinematics::mechanism::configuration::GivenConfiguration;

/// Freedoms at a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    /// Freedoms to the first order; `None` where that is in doubt.
    pub infinitesimal: Option<usize>,
    /// Dimension of the configurations around it; `None` where that is in doubt.
    pub local: Option<usize>,
    /// Lengths of the local ring modulo the powers of its maximal ideal, from the first power on.
    pub dimensions_by_order: Vec<u64>,
    /// How often the configuration counts, where it is isolated.
    pub multiplicity: Option<u64>,
    /// Whether file and configuration are exact, so that no rounding enters.
    pub is_exact: bool,
    /// A sentence.
    pub reason: String,
}

impl Mobility {
    /// Whether nothing is in doubt.
    pub fn is_settled(&self) -> bool {
        self.infinitesimal.is_some() && self.local.is_some()
    }

    fn in_doubt(reason: String) -> Self {
        Self {
            infinitesimal: None,
            local: None,
            dimensions_by_order: Vec::new(),
            multiplicity: None,
            is_exact: false,
            reason,
        }
    }
}

/// The mobility of a mechanism at a configuration; an error where it does not close there, or cannot be read.
pub fn mobility(
    mechanism: &Mechanism,
    given: &GivenConfiguration,
    seed: u64,
) -> Result<Mobility, String> {
    let assembly = Assembly::of(mechanism, given)?;
    let open = gap(&assembly);
    if open.is_nan() || open > CLOSES {
        return Err(format!(
            "the mechanism does not close there: its loops or bars are off by {open:.1e} of its size, and {CLOSES:.0e} is allowed"
        ));
    }
    let residues = Residues::of(&assembly.constants(), 0);
    let exact = residues.map(|field| local_ring(&field, &assembly, 0));
    let (ring, assembly, is_exact) = match exact {
        Some(Ok(ring)) => (Ok(ring), assembly, true),
        _ => {
            let assembly = refined(assembly);
            (local_ring(&Doubles, &assembly, 0), assembly, false)
        }
    };
    match ring {
        Ok(ring) => Ok(told(&ring, &assembly, is_exact, seed)),
        Err(Doubt::Open) => Ok(Mobility::in_doubt(
            "in doubt: Newton's method does not close the mechanism near the configuration that is given".into(),
        )),
        Err(Doubt::SingularValue(part)) => Ok(Mobility::in_doubt(format!(
            "in doubt: a singular value of {part:.1e} of the largest may be 0 or not; give exact numbers, such as \"3/5\", or more digits"
        ))),
    }
}

/// Mobility by the local ring, and by the configurations nearby if the ring leaves the dimension open.
fn told(ring: &LocalRing, assembly: &Assembly, is_exact: bool, seed: u64) -> Mobility {
    let mut mobility = Mobility {
        infinitesimal: Some(ring.infinitesimal),
        local: None,
        dimensions_by_order: ring.lengths.clone(),
        multiplicity: None,
        is_exact,
        reason: String::new(),
    };
    let (least, most) = (ring.least_dimension, ring.most_dimension);
    if is_exact && let Some(part) = nearly_singular(assembly, ring.infinitesimal) {
        mobility.local = None;
        mobility.infinitesimal = None;
        mobility.reason = format!(
            "in doubt: by the numbers as they are written there are {} freedoms to the first order, but a singular value is only {part:.1e} of \
             the largest; where these numbers are rounded, give exact ones, such as \"sqrt(3)/2\"",
            ring.infinitesimal
        );
        return mobility;
    }
    if ring.is_regular {
        mobility.local = Some(ring.infinitesimal);
        mobility.multiplicity = (ring.infinitesimal == 0).then_some(1);
        mobility.reason = "regular: the conditions are independent to the first order".into();
    } else if most == 0 {
        mobility.local = Some(0);
        mobility.multiplicity = ring.lengths.last().copied();
        let order = ring
            .lengths
            .windows(2)
            .position(|w| w[0] == w[1])
            .unwrap_or(0);
        mobility.reason = match ring.infinitesimal {
            0 => "rigid to the first order".into(),
            _ => format!("isolated: what moves to order {order} does not move to the next"),
        };
    } else if least == most || has_dimension(assembly, most, seed) {
        mobility.local = Some(most);
        let how = match least == most {
            true => "every condition takes one freedom at most",
            false => "configurations were met on slices beside it",
        };
        mobility.reason = format!(
            "at least {most} because {how}, at most {most} by the growth of the local ring"
        );
    } else {
        mobility.reason = format!(
            "in doubt: the local dimension is between {least} and {most}, and no configuration was met on slices beside it"
        );
    }
    mobility
}

/// The least singular value that counts, as a part of the largest, where it is nearly 0.
pub(super) fn nearly_singular(assembly: &Assembly, freedoms: usize) -> Option<f64> {
    let n = assembly.values.len();
    let (_, rows) = first_order(&Doubles, assembly);
    let values = singular_values(&rows, n);
    let least = (n - freedoms).checked_sub(1).and_then(|k| values.get(k))?;
    let part = least / values.first()?;
    (part < NONZERO / 10.0).then_some(part)
}

//! Boxes of certificates in intervals wide enough to hold them, and the charts of homogeneous groups.

use cognate_continuation::certification::Certificate;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::directed::Directed;
use cognate_numeric::scalar::{Complex, Interval, Real};
use cognate_systems::system::System;

/// A box, coordinate by coordinate.
pub type Coordinates<R> = Vec<Complex<Interval<R>>>;

/// The homogeneous groups of a system, each with its variables.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    /// Variables of each homogeneous group.
    pub homogeneous: Vec<Vec<usize>>,
    /// All other variables.
    pub affine: Vec<usize>,
}

impl Groups {
    /// The groups of variables of a system.
    pub fn of(system: &System) -> Self {
        let variables = |homogeneous| {
            let of_kind = system
                .groups
                .iter()
                .filter(move |g| g.homogeneous == homogeneous);
            of_kind.map(|g| g.variables.clone())
        };
        Self {
            homogeneous: variables(true).collect(),
            affine: variables(false).flatten().collect(),
        }
    }

    /// The variable of a group that a certificate fixes at 1.
    pub fn fixed(group: &[usize], certificate: &Certificate) -> Option<usize> {
        let one = ComplexRational::real(1);
        let mut variables = group.iter().copied();
        variables.find(|&v| certificate.radius[v] == 0.0 && certificate.centre[v] == one)
    }

    /// Divides each homogeneous group by its value at the variable that a certificate fixes, so
    /// that both are in one chart. Invalid where that value may be 0.
    pub fn to_chart_of<R: Directed>(
        &self,
        certificate: &Certificate,
        mut values: Coordinates<R>,
    ) -> Coordinates<R> {
        for group in &self.homogeneous {
            let Some(fixed) = Self::fixed(group, certificate) else {
                continue;
            };
            let divisor = values[fixed].clone();
            if !divisor.is_one() {
                for &v in group {
                    values[v].div(&divisor);
                }
            }
        }
        values
    }
}

/// Bits in which sums of the certificate's numbers lose nothing that matters.
pub fn bits(certificate: &Certificate) -> u32 {
    certificate.precision_bits + 64
}

/// Every number of the interval is less than `radius` from the centre, by more than what is lost to rounding.
fn within<R: Directed>(part: &Interval<R>, centre: &Rational, radius: f64) -> bool {
    let mut difference = part.clone();
    difference.sub(&Interval::from_rational(part.context(), centre));
    difference.magnitude() < radius
}

/// True when these values, in the certificate's chart, lie in the interior of its box.
pub fn inside<R: Directed>(values: &Coordinates<R>, certificate: &Certificate) -> bool {
    let coordinates = values.iter().zip(&certificate.centre);
    coordinates
        .zip(&certificate.radius)
        .all(|((value, centre), &radius)| {
            // A coordinate that is fixed at 1 has the value 1 in the same chart, too.
            radius == 0.0
                || (within(&value.re, &centre.re, radius) && within(&value.im, &centre.im, radius))
        })
}

/// True when some coordinate has no value in common.
pub fn disjoint<R: Directed>(a: &Coordinates<R>, b: &Coordinates<R>) -> bool {
    a.iter().zip(b).any(|(a, b)| a.is_disjoint(b))
}

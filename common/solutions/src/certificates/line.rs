//! The fields for a certificate in `solutions.jsonl` and in `certificates.json`.

use super::distinct::Distinctness;
use cognate_continuation::certification::{Certificate, Certification};
use cognate_numeric::exact_text::{exact_text, exact_text_of_double};
use cognate_numeric::rational::Rational;
use cognate_systems::formats;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Result of the attempt to certify one path's endpoint; `None` where the attempt itself was lost with its worker.
pub type Attempt = Option<Certification>;

/// Certificate of one solution, or the reason why there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolutionCertificate {
    /// In the box there is exactly one solution of the square system.
    pub certified: bool,
    /// Reason why the solution is not certified.
    pub reason: Option<String>,
    /// The solution is proved to differ from every other certified solution.
    pub distinct: Option<bool>,
    /// The solution is proved to be real, or proved not to be real; null where neither is proved.
    pub real: Option<bool>,
    /// Bits of the arithmetic that sufficed.
    pub precision_bits: Option<u32>,
    /// A bound of the contraction over the box; below 0.7.
    pub contraction: Option<f64>,
    /// The box, in exact numbers (see [`exact_text`]); empty where there is none.
    pub coordinates: Vec<CertifiedCoordinate>,
}

/// One side of a box: |Re (z - c)| <= radius and |Im (z - c)| <= radius, with c = re + i im.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CertifiedCoordinate {
    /// The variable's name.
    pub variable: String,
    /// Real part of the centre.
    pub re: String,
    /// Imaginary part of the centre.
    pub im: String,
    /// Half of the box's side; 0 for a variable that is fixed at 1 in a homogeneous group.
    pub radius: String,
    /// The solution is not farther than this from the centre, in either part.
    pub error: String,
}

/// The system to which the certificates refer. A checker needs this and the problem file only.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CertifiedSystem {
    /// The variables, in order.
    pub variables: Vec<String>,
    /// The homogeneous groups.
    pub homogeneous: Vec<Vec<String>>,
    /// Values of the parameters, in exact numbers.
    pub parameters: Vec<(String, [String; 2])>,
    /// Pairs of variables that the involution exchanges.
    pub conjugates: Vec<[String; 2]>,
    /// The system is invariant under the involution, so that real means something.
    pub invariant: bool,
    /// Combinations of the equations were certified, as many as unknowns.
    pub squared_up: bool,
    /// The combinations, as a problem in our JSON.
    pub combinations: Option<String>,
}

fn dyadic(value: &Rational) -> String {
    exact_text(value).expect("numbers of a certificate are dyadic")
}

fn double(value: f64) -> String {
    exact_text_of_double(value).unwrap_or_else(|| "not finite".into())
}

impl SolutionCertificate {
    /// The certificate of a solution without a proof.
    pub(super) fn refused(singular: bool, attempt: Option<&Attempt>) -> Self {
        let reason = match attempt {
            _ if singular => "it is singular: a box can show only a regular solution",
            None => "no attempt was made",
            Some(None) => "the attempt was given up: workers died of it",
            Some(Some(Certification::Uncertified(reason))) => reason.describe(),
            Some(Some(Certification::Certified(_))) => "its certificate is damaged",
        };
        Self {
            reason: Some(reason.into()),
            ..Self::default()
        }
    }

    /// The certificate of a certified solution.
    pub(super) fn proved(
        certificate: &Certificate,
        system: &System,
        distinctness: Distinctness,
        real: Option<bool>,
    ) -> Self {
        Self {
            certified: true,
            reason: match distinctness {
                Distinctness::Proved => None,
                Distinctness::Duplicate => Some("it is the same as another solution".into()),
                Distinctness::Undecided => Some("its box meets another solution's".into()),
            },
            distinct: Some(distinctness == Distinctness::Proved),
            real,
            precision_bits: Some(certificate.precision_bits),
            contraction: Some(certificate.contraction),
            coordinates: (0..certificate.dimension())
                .map(|v| CertifiedCoordinate {
                    variable: system.variables[v].clone(),
                    re: dyadic(&certificate.centre[v].re),
                    im: dyadic(&certificate.centre[v].im),
                    radius: double(certificate.radius[v]),
                    error: double(certificate.error[v]),
                })
                .collect(),
        }
    }
}

impl CertifiedSystem {
    /// Describes a system at these values of its parameters, and the system that was certified instead of it.
    pub(super) fn of(
        system: &System,
        parameters: &[Complex64],
        invariant: bool,
        combinations: Option<&System>,
    ) -> Self {
        let name = |v: &usize| system.variables[*v].clone();
        Self {
            variables: system.variables.clone(),
            homogeneous: system
                .groups
                .iter()
                .filter(|group| group.homogeneous)
                .map(|group| group.variables.iter().map(name).collect())
                .collect(),
            parameters: system
                .parameters
                .iter()
                .cloned()
                .zip(parameters.iter().map(|z| [double(z.re), double(z.im)]))
                .collect(),
            conjugates: system
                .conjugates
                .iter()
                .map(|(a, b)| [name(a), name(b)])
                .collect(),
            invariant,
            squared_up: system.equation_count() > system.dimension(),
            combinations: combinations.and_then(|square| formats::json::write(square).ok()),
        }
    }
}

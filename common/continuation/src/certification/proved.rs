//! Proved: what Krawczyk's test shows of one point in its chart.

use super::certificate::Certificate;
use cognate_numeric::rational::ComplexRational;

/// A successful Krawczyk test in a chart, with one entry for each free variable of the chart.
#[derive(Clone, Debug)]
pub(super) struct Proved {
    /// Exact values of all variables in the box's centre.
    pub centre: Vec<ComplexRational>,
    /// Half of the sides of the box.
    pub radius: Vec<f64>,
    /// Distance from the centre to which the operator leads.
    pub needed: Vec<f64>,
    /// A bound of ||1 - C J||.
    pub contraction: f64,
    /// Bits of the arithmetic.
    pub precision_bits: u32,
}

impl Proved {
    /// The certificate for all variables.
    pub fn certificate(self, free: &[usize]) -> Certificate {
        let variables = self.centre.len();
        let mut certificate = Certificate {
            centre: self.centre,
            radius: vec![0.0; variables],
            error: vec![0.0; variables],
            contraction: self.contraction,
            precision_bits: self.precision_bits,
        };
        for ((&v, &radius), &needed) in free.iter().zip(&self.radius).zip(&self.needed) {
            certificate.radius[v] = radius;
            // More than what was found, so that who checks it in another arithmetic finds less.
            let more = f64::min(2.0 * needed, 0.5 * (needed + radius));
            certificate.error[v] = if more < radius { more } else { needed };
        }
        certificate
    }
}

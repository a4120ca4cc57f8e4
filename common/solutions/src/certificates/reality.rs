//! Whether a certified solution is proved to be real, or not to be.
//!
//! The involution maps solutions to solutions. The image of the solution of a
//! box is therefore the same solution as soon as it lies in the box, and
//! another one where the image has nothing in common with it.

use super::boxes::{self, Groups};
use crate::involution::Involution;
use cognate_continuation::certification::Certificate;
use cognate_numeric::scalar::MultiplePrecision;
use cognate_numeric::scalar::directed::Directed;

/// `None` where neither is proved.
pub fn judge(certificate: &Certificate, groups: &Groups, involution: &Involution) -> Option<bool> {
    // Doubles prove it of most, and it is true in whatever numbers it is proved.
    judge_in::<f64>((), certificate, groups, involution).or_else(|| {
        let bits = boxes::bits(certificate);
        judge_in::<MultiplePrecision>(bits, certificate, groups, involution)
    })
}

fn judge_in<R: Directed>(
    context: R::Context,
    certificate: &Certificate,
    groups: &Groups,
    involution: &Involution,
) -> Option<bool> {
    let values = certificate.lies_in::<R>(context);
    let image = involution
        .partner
        .iter()
        .map(|&partner| {
            let mut z = values[partner].clone();
            z.conjugate();
            z
        })
        .collect();
    let image = groups.to_chart_of(certificate, image);
    if boxes::inside(&image, certificate) {
        Some(true)
    } else if boxes::disjoint(&image, &values) {
        Some(false)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::rational::{ComplexRational, Rational};

    fn certificate(centre: &[(f64, f64)], fixed: Option<usize>) -> Certificate {
        let exact = |x: f64| Rational::from_f64(x).unwrap();
        let size = |v: f64| {
            let one = |k: usize| if fixed == Some(k) { 0.0 } else { v };
            (0..centre.len()).map(one).collect()
        };
        Certificate {
            centre: centre
                .iter()
                .map(|&(re, im)| ComplexRational::new(exact(re), exact(im)))
                .collect(),
            radius: size(1e-6),
            error: size(1e-9),
            contraction: 0.1,
            precision_bits: 53,
        }
    }

    #[test]
    fn pairs_are_exchanged_and_factors_do_not_matter() {
        let pair = Involution {
            partner: vec![1, 0],
        };
        let plain_conjugation = Involution {
            partner: vec![0, 1],
        };
        let affine = Groups {
            homogeneous: vec![],
            affine: vec![0, 1],
        };
        let conjugates = certificate(&[(0.5, 0.25), (0.5, -0.25)], None);
        assert_eq!(judge(&conjugates, &affine, &pair), Some(true));
        assert_eq!(judge(&conjugates, &affine, &plain_conjugation), Some(false));
        let real = certificate(&[(0.5, 1e-10), (3.0, 0.0)], None);
        assert_eq!(judge(&real, &affine, &plain_conjugation), Some(true));
        assert_eq!(judge(&real, &affine, &pair), Some(false));
        // Nearer to its image than its error, yet the image is not in its box.
        let mut vague = certificate(&[(0.5, 5e-7), (3.0, 0.0)], None);
        vague.error = vec![9e-7, 9e-7];
        assert_eq!(judge(&vague, &affine, &plain_conjugation), None);
        // (1 : i) is fixed when the two are exchanged: the image (-i : 1) is i times itself.
        let projective = Groups {
            homogeneous: vec![vec![0, 1]],
            affine: vec![],
        };
        let point = certificate(&[(1.0, 0.0), (0.0, 1.0)], Some(0));
        assert_eq!(judge(&point, &projective, &pair), Some(true));
        assert_eq!(judge(&point, &projective, &plain_conjugation), Some(false));
    }
}

//! Inclusion discs: a disc around each approximation, which together hold all roots; one that meets no other holds one
//! (B. T. Smith, Error bounds for zeros of a polynomial based upon Gerschgorin's theorems, 1970).

use super::evaluation::RoundedPolynomial;
use super::square_free::SymmetricFactor;
use super::wide::Wide;
use rug::{Assign, Complex};

/// More than the rounding of sums and products of up to 10^6 sizes adds.
const ROUNDING: f64 = 1.000_01;

/// Accuracy to which roots are wanted.
pub(super) struct Wanted {
    /// Radius of a disc beside each part of the number that is not 0, as a power of two.
    pub bits: u32,
}

/// A root within a disc that holds no other.
#[derive(Clone, Debug)]
pub(super) struct Approximation {
    /// Centre of the disc, on an axis where the root is.
    pub centre: Complex,
    /// Radius of the disc.
    pub radius: Wide,
}

/// Discs around all approximations of the roots of one polynomial.
pub(super) struct InclusionDiscs<'a> {
    points: &'a [Complex],
    radii: Vec<Wide>,
}

impl<'a> InclusionDiscs<'a> {
    /// The radius is n |p(z_k)| / |a_n| over the product of the distances to the others.
    pub fn new(polynomial: &RoundedPolynomial, points: &'a [Complex]) -> Self {
        let rounding = Wide::new(ROUNDING, 0);
        let degree = Wide::new(points.len() as f64, 0).times(rounding);
        let leading = polynomial.leading_size();
        let mut discs = Self {
            points,
            radii: Vec::new(),
        };
        for (k, point) in points.iter().enumerate() {
            let at = polynomial.at(point);
            let value = Wide::of_complex(&at.value).plus(at.error);
            let mut product = leading;
            for j in (0..points.len()).filter(|&j| j != k) {
                product = product.times(discs.distance(k, j));
            }
            // Equal approximations have no discs.
            discs.radii.push(match product.is_zero() {
                true => Wide::power_of_two(i64::MAX / 4),
                false => value.times(degree).over(product).times(rounding),
            });
        }
        discs
    }

    fn distance(&self, k: usize, j: usize) -> Wide {
        let bits = self.points[k].prec().0;
        let mut difference = Complex::new(bits);
        difference.assign(&self.points[k] - &self.points[j]);
        Wide::of_complex(&difference)
    }

    /// Whether a disc with this centre and the radius of disc k meets no disc but k.
    fn meets_no_other(&self, centre: &Complex, k: usize) -> bool {
        let mut difference = Complex::new(centre.prec());
        self.points.iter().enumerate().all(|(j, other)| {
            if j == k {
                return true;
            }
            difference.assign(centre - other);
            let reach = self.radii[k]
                .plus(self.radii[j])
                .times(Wide::new(ROUNDING, 0));
            reach < Wide::of_complex(&difference)
        })
    }

    /// For each disc its root, where it holds one that is known as well as it is wanted.
    ///
    /// Roots closed under a reflection: where a disc meets the axis and its mirror image no other disc, the image of the
    /// root is in the disc, too, and so the root itself: it is on the axis. Where they are not closed none is on the axis.
    pub fn settle(&self, factor: &SymmetricFactor, wanted: &Wanted) -> Vec<Option<Approximation>> {
        let each = 0..self.points.len();
        each.map(|k| self.settle_one(k, factor, wanted)).collect()
    }

    fn settle_one(
        &self,
        k: usize,
        factor: &SymmetricFactor,
        wanted: &Wanted,
    ) -> Option<Approximation> {
        let (point, radius) = (&self.points[k], self.radii[k]);
        let reach = radius.times(Wide::power_of_two(i64::from(wanted.bits)));
        // Most discs are too large at first.
        if Wide::of_complex(point) < reach || !self.meets_no_other(point, k) {
            return None;
        }
        let mut centre = point.clone();
        if Wide::of_float(point.imag()) < reach {
            let image = Complex::with_val(point.prec(), point.conj_ref());
            if !factor.is_real || !self.is_own_image(&image, k) {
                return None;
            }
            centre.mut_imag().assign(0);
        }
        if Wide::of_float(point.real()) < reach {
            let mut image = Complex::with_val(point.prec(), point.conj_ref());
            image = -image;
            if !factor.is_mirrored || !self.is_own_image(&image, k) {
                return None;
            }
            centre.mut_real().assign(0);
        }
        Some(Approximation { centre, radius })
    }

    /// Whether the mirror image of the root of disc k, in the disc around the image of the centre, is in disc k.
    fn is_own_image(&self, image: &Complex, k: usize) -> bool {
        let difference = Complex::with_val(image.prec(), image - &self.points[k]);
        let reach = self.radii[k].times(Wide::new(2.0, 0));
        // The discs overlap, and the image has all of its roots in discs.
        Wide::of_complex(&difference) <= reach && self.meets_no_other(image, k)
    }
}

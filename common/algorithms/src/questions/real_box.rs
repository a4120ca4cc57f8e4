//! RealBox: real points with bounds for each variable; of a pair of conjugates for its real and its imaginary part.

use super::error::QuestionError;
use cognate_solutions::involution::Involution;
use num_complex::Complex64;

/// Error assumed for a point of a curve, relative to its size or to 1.
pub(super) const ERROR: f64 = 1e-9;

/// Whether a point is in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    Inside,
    Outside,
    /// The point is as near to a face as its error.
    OnFace,
}

/// A box, of which nothing is known but that it has bounds for each variable.
#[derive(Clone, Copy, Debug)]
pub(super) struct RealBox<'a> {
    bounds: &'a [[f64; 2]],
    involution: &'a Involution,
}

/// Checks that there are bounds for each of the `variables` variables, or none at all.
pub(super) fn checked(bounds: &[[f64; 2]], variables: usize) -> Result<(), QuestionError> {
    let wrong = |value, expected| Err(QuestionError::wish("box", value, expected));
    if !bounds.is_empty() && bounds.len() != variables {
        let expected = format!("{variables}, one for each variable");
        return wrong(format!("{} pairs", bounds.len()), expected);
    }
    for [low, high] in bounds {
        if !(low.is_finite() && high.is_finite() && low < high) {
            let expected = "two finite numbers, the lower first".to_owned();
            return wrong(format!("{low} to {high}"), expected);
        }
    }
    Ok(())
}

impl<'a> RealBox<'a> {
    /// The box with these bounds; `None` where there are none.
    pub fn new(bounds: &'a [[f64; 2]], involution: &'a Involution) -> Option<Self> {
        (!bounds.is_empty()).then_some(Self { bounds, involution })
    }

    /// The real coordinate that a variable's bounds are for, as a linear form in the variables.
    pub fn coordinate(&self, variable: usize) -> Vec<(usize, Complex64)> {
        let partner = self.involution.partner[variable];
        let half = Complex64::new(0.5, 0.0);
        let half_turn = Complex64::new(0.0, -0.5);
        match partner.cmp(&variable) {
            std::cmp::Ordering::Equal => vec![(variable, Complex64::new(1.0, 0.0))],
            std::cmp::Ordering::Greater => vec![(variable, half), (partner, half)],
            std::cmp::Ordering::Less => vec![(partner, half_turn), (variable, -half_turn)],
        }
    }

    /// Where a real point is; `error`: how far it may be off, relative to its size or to 1; `face`: the variable on
    /// whose bound it is known to be.
    pub fn place(&self, point: &[Complex64], error: f64, face: Option<usize>) -> Place {
        let squares = point.iter().map(|z| z.norm_sqr()).sum::<f64>();
        let error = error * squares.sqrt().max(1.0);
        let mut place = Place::Inside;
        let bounds = self.bounds.iter().enumerate();
        for (variable, [low, high]) in bounds.filter(|(v, _)| Some(*v) != face) {
            let terms = self.coordinate(variable);
            let value: f64 = terms.iter().map(|(v, c)| (c * point[*v]).re).sum();
            if value < low - error || value > high + error {
                return Place::Outside;
            }
            if value <= low + error || value >= high - error {
                place = Place::OnFace;
            }
        }
        place
    }

    /// Every face: the variable whose bound it is, and the bound.
    pub fn faces(&self) -> impl Iterator<Item = (usize, f64)> {
        let bounds = self.bounds.iter().enumerate();
        bounds.flat_map(|(variable, bounds)| bounds.map(|bound| (variable, bound)))
    }

    /// The point whose coordinates are these parts of the way through the box.
    pub fn point(&self, parts: &[f64]) -> Vec<Complex64> {
        let value = |v: usize| {
            let [low, high] = self.bounds[v];
            low + (high - low) * parts[v]
        };
        let coordinate = |(v, &partner): (usize, &usize)| match partner.cmp(&v) {
            std::cmp::Ordering::Equal => Complex64::new(value(v), 0.0),
            std::cmp::Ordering::Greater => Complex64::new(value(v), value(partner)),
            std::cmp::Ordering::Less => Complex64::new(value(partner), -value(v)),
        };
        let partners = self.involution.partner.iter().enumerate();
        partners.map(coordinate).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_has_bounds_for_both_of_its_parts() {
        let involution = Involution {
            partner: vec![1, 0, 2],
        };
        let bounds = [[0.0, 2.0], [-3.0, -1.0], [5.0, 6.0]];
        let wanted = RealBox::new(&bounds, &involution).unwrap();
        let point = wanted.point(&[0.5, 0.25, 1.0]);
        let expected = [(1.0, -2.5), (1.0, 2.5), (6.0, 0.0)];
        assert_eq!(point, expected.map(|(re, im)| Complex64::new(re, im)));
        assert_eq!(wanted.place(&point, 1e-9, None), Place::OnFace);
        assert_eq!(wanted.place(&point, 1e-9, Some(2)), Place::Inside);
        let inside = wanted.point(&[0.5, 0.25, 0.5]);
        assert_eq!(wanted.place(&inside, 1e-9, None), Place::Inside);
        let outside = wanted.point(&[0.5, -0.25, 0.5]);
        assert_eq!(wanted.place(&outside, 1e-9, None), Place::Outside);
        assert_eq!(wanted.faces().count(), 6);
    }
}

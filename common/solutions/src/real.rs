//! Whether one solution is real: a fixed point, up to factors, of the system's involution; and how a real one is written.

use crate::involution::Involution;
use crate::point_shape::PointShape;
use crate::solution::NamedValues;
use crate::unique_points::Neighbourhood;
use num_complex::Complex64;

/// True when the point and its image coincide by the same measure by which two
/// endpoints do: the image of a solution is a solution, so nearer than two
/// solutions can be means equal.
///
/// `roots`: variables that are not asked, helpers that may be complex at a real solution.
pub fn is_real(
    end: &Neighbourhood<'_>,
    shape: &PointShape,
    involution: &Involution,
    roots: &[usize],
) -> bool {
    let values = shape.to_variables(end.point);
    let mut image = involution.image(&values);
    for &root in roots {
        image[root] = values[root];
    }
    let image = Neighbourhood {
        point: &shape.to_coordinates(&image),
        ..*end
    };
    end.meets(&image, shape)
}

/// Writes a real solution with real numbers, and partners as exact conjugates: the point of the involution that is nearest.
///
/// A homogeneous group whose variables are exchanged is left as it is: its point is fixed only up to a factor. So are
/// `roots`, helpers that may be complex.
pub fn write_as_real(
    values: &mut NamedValues,
    shape: &PointShape,
    involution: &Involution,
    roots: &[usize],
) {
    for span in shape.spans() {
        let is_alone = |v: &usize| involution.partner[*v] == *v;
        if span.group.homogeneous && !span.group.variables.iter().all(is_alone) {
            continue;
        }
        for &v in span.group.variables.iter().filter(|v| !roots.contains(v)) {
            let partner = involution.partner[v];
            let (value, image) = (values.0[v].value, values.0[partner].value.conj());
            if partner == v {
                values.0[v].value = Complex64::new(value.re, 0.0);
            } else if value != image {
                let mean = 0.5 * value + 0.5 * image;
                values.0[v].value = mean;
                values.0[partner].value = mean.conj();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::affine_shape;
    use cognate_systems::system::{System, VariableGroup};

    fn complex(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn rough(point: &[Complex64], radius: f64) -> Neighbourhood<'_> {
        Neighbourhood {
            point,
            radius,
            refined: false,
        }
    }

    /// y = 2^33 and x = 0.3 i: a rough end is as near to its conjugate as its error.
    #[test]
    fn a_refined_end_is_real_where_each_value_is() {
        let shape = affine_shape(2);
        let conjugation = Involution {
            partner: vec![0, 1],
        };
        let unit = 2.0f64.powi(-33);
        let is_real_with = |x: Complex64, refined: bool| {
            let point = [complex(unit, 0.0), unit * x, complex(1.0, 0.0)];
            let end = Neighbourhood {
                refined,
                ..rough(&point, 1e-10)
            };
            is_real(&end, &shape, &conjugation, &[])
        };
        assert!(is_real_with(complex(0.1, 0.3), false));
        assert!(!is_real_with(complex(0.1, 0.3), true));
        // Errors of values are parts of the largest one.
        assert!(is_real_with(complex(0.1, 1e-8), true));
    }

    #[test]
    fn conjugate_pairs_are_exchanged_and_scaling_is_ignored() {
        let shape = affine_shape(2);
        let pair = Involution {
            partner: vec![1, 0],
        };
        let plain_conjugation = Involution {
            partner: vec![0, 1],
        };
        let scale = complex(0.3, -0.8);
        let point = [scale, scale * complex(0.5, 0.6), scale * complex(0.5, -0.6)];
        assert!(is_real(&rough(&point, 1e-12), &shape, &pair, &[]));
        assert!(!is_real(
            &rough(&point, 1e-12),
            &shape,
            &plain_conjugation,
            &[]
        ));
        let point = [scale, scale * 0.5, scale * -2.0];
        assert!(is_real(
            &rough(&point, 1e-12),
            &shape,
            &plain_conjugation,
            &[]
        ));
        assert!(!is_real(&rough(&point, 1e-12), &shape, &pair, &[]));
    }

    #[test]
    fn real_solutions_are_written_with_real_numbers_and_exact_conjugates() {
        let shape = affine_shape(3);
        let involution = Involution {
            partner: vec![1, 0, 2],
        };
        let names = ["p", "q", "r"].map(String::from).into_iter();
        let values = [complex(0.5, 0.6), complex(0.75, -0.6), complex(3.0, 1e-17)];
        let mut values: NamedValues = names.zip(values).collect();
        write_as_real(&mut values, &shape, &involution, &[]);
        let written: Vec<Complex64> = values.values().collect();
        let mean = complex(0.625, 0.6);
        assert_eq!(written, [mean, mean.conj(), complex(3.0, 0.0)]);
    }

    #[test]
    fn a_projective_point_is_real_with_any_factor() {
        let shape = PointShape::of(&System {
            variables: vec!["x".into(), "y".into()],
            groups: vec![VariableGroup {
                variables: vec![0, 1],
                homogeneous: true,
            }],
            ..System::default()
        });
        let plain_conjugation = Involution {
            partner: vec![0, 1],
        };
        let factor = complex(0.6, 0.8);
        assert!(is_real(
            &rough(&[factor, factor * -0.25], 1e-12),
            &shape,
            &plain_conjugation,
            &[]
        ));
        assert!(!is_real(
            &rough(&[factor, complex(-0.25, 0.0)], 1e-12),
            &shape,
            &plain_conjugation,
            &[]
        ));
    }
}

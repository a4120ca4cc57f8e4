//! Sums of squares that are made smaller: the method of Levenberg (1944) and Marquardt (1963).

/// Damping at the beginning, relative to the diagonal of the normal matrix.
const FIRST_DAMPING: f64 = 1e-2;
/// Damping at which a step is too small to help.
const MOST_DAMPING: f64 = 1e12;
/// A step that makes the sum smaller by less than this fraction is the last one.
const NO_DECREASE: f64 = 1e-14;

/// A residual and its derivatives by the N unknowns.
#[derive(Clone, Copy, Debug)]
pub struct Residual<const N: usize> {
    /// The residual.
    pub value: f64,
    /// Derivatives of the residual.
    pub gradient: [f64; N],
}

/// Where the steps ended.
#[derive(Clone, Copy, Debug)]
pub struct Improved<const N: usize> {
    /// The unknowns.
    pub point: [f64; N],
    /// The sum of squares there.
    pub sum: f64,
}

/// Improves a point by at most `steps` steps; `None` where the residuals are not defined at it.
pub fn improve<const N: usize>(
    start: [f64; N],
    steps: usize,
    residuals: impl Fn(&[f64; N]) -> Option<Vec<Residual<N>>>,
) -> Option<Improved<N>> {
    let mut point = start;
    let mut current = residuals(&point)?;
    let mut sum = sum_of_squares(&current);
    let mut damping = FIRST_DAMPING;
    for _ in 0..steps {
        let (normal, gradient) = normal_equations(&current);
        let mut better = None;
        while better.is_none() && damping < MOST_DAMPING {
            let step = damped_step(&normal, &gradient, damping);
            let next = step.map(|step| std::array::from_fn(|k| point[k] - step[k]));
            let values = next.and_then(|next| Some((next, residuals(&next)?)));
            better = values.filter(|(_, values)| sum_of_squares(values) < sum);
            damping *= if better.is_some() { 0.2 } else { 4.0 };
        }
        let Some((next, values)) = better else {
            break;
        };
        let before = sum;
        point = next;
        sum = sum_of_squares(&values);
        current = values;
        if before - sum <= NO_DECREASE * before {
            break;
        }
    }
    Some(Improved { point, sum })
}

fn sum_of_squares<const N: usize>(residuals: &[Residual<N>]) -> f64 {
    residuals.iter().map(|r| r.value * r.value).sum()
}

/// Adds the products of the entries of a gradient with each other.
pub fn add_square<const N: usize>(rows: &mut [[f64; N]; N], gradient: &[f64; N]) {
    for (row, first) in rows.iter_mut().zip(gradient) {
        for (entry, second) in row.iter_mut().zip(gradient) {
            *entry += first * second;
        }
    }
}

/// The normal matrix and half the gradient of the sum of squares.
fn normal_equations<const N: usize>(residuals: &[Residual<N>]) -> ([[f64; N]; N], [f64; N]) {
    let mut normal = [[0.0; N]; N];
    let mut gradient = [0.0; N];
    for residual in residuals {
        for (i, first) in residual.gradient.into_iter().enumerate() {
            gradient[i] += first * residual.value;
        }
        add_square(&mut normal, &residual.gradient);
    }
    (normal, gradient)
}

/// The step of the damped normal equations, by Cholesky's factors; `None` where they are not positive definite.
pub fn damped_step<const N: usize>(
    normal: &[[f64; N]; N],
    gradient: &[f64; N],
    damping: f64,
) -> Option<[f64; N]> {
    let mut factor = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let damped = normal[i][j] * if i == j { 1.0 + damping } else { 1.0 };
            let rest = damped - dot;
            if i == j {
                if rest.is_nan() || rest <= f64::EPSILON * damped {
                    return None;
                }
                factor[i][i] = rest.sqrt();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    let mut step = *gradient;
    for i in 0..N {
        let dot: f64 = (0..i).map(|k| factor[i][k] * step[k]).sum();
        step[i] = (step[i] - dot) / factor[i][i];
    }
    for i in (0..N).rev() {
        let dot: f64 = (i + 1..N).map(|k| factor[k][i] * step[k]).sum();
        step[i] = (step[i] - dot) / factor[i][i];
    }
    Some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley (1960): residuals 10 (y - x^2) and 1 - x, both 0 at (1, 1).
    #[test]
    fn the_end_of_a_curved_valley_is_reached() {
        let residuals = |p: &[f64; 2]| {
            let [x, y] = *p;
            Some(vec![
                Residual {
                    value: 10.0 * (y - x * x),
                    gradient: [-20.0 * x, 10.0],
                },
                Residual {
                    value: 1.0 - x,
                    gradient: [-1.0, 0.0],
                },
            ])
        };
        let end = improve([-1.2, 1.0], 200, residuals).expect("residuals are defined everywhere");
        assert!(end.sum < 1e-20, "{end:?}");
        assert!(end.point.iter().all(|x| (x - 1.0).abs() < 1e-9), "{end:?}");
    }
}

//! Positive-dimensional sets of critical points: the value on each, and the points at which only multipliers move.

use super::value::{Place, Value};
use super::{Critical, CriticalSets};
use crate::point_shape::{largest, modulus};
use crate::solution::Solution;
use crate::witness::WitnessSet;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::precision::DOUBLE;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::evaluation::values;
use num_complex::Complex64;

/// A singular value of the equations' derivatives by the multipliers, in units of their sizes at general points as far out,
/// counts as 0 below this: half of the digits of a double, since the point may be singular. All may be 0.
const ZERO_SINGULAR_VALUE: f64 = 1e-8;

/// Error of the objective at a witness point, relative to 1 and its size: half of the digits of a double, since the point may
/// be singular.
const ERROR_ON_A_SET: f64 = 1e-8;

/// Values of the unknowns at a point with a set of multipliers.
struct SinglePoint(Vec<Complex64>);

impl SinglePoint {
    fn is_real(&self) -> bool {
        let size = 1.0 + largest(&self.0);
        self.0.iter().all(|z| z.im.abs() <= ERROR_ON_A_SET * size)
    }
}

impl Critical {
    /// Number of critical points that are isolated by a whole decomposition, where one was made.
    pub fn isolated(&self) -> Option<u64> {
        self.sets.as_ref().map(|sets| sets.isolated)
    }

    /// Adds the components of a whole decomposition of the system of critical points. Where the multiplier of the objective
    /// is not 0 its derivatives along a component are 0, so that it has one value there: that of a witness point. Nothing
    /// is added where the multiplier is 0 on a component, or the values at its witness points differ.
    pub fn add_sets(&mut self, sets: &[WitnessSet], parameters: &[Complex64]) {
        let mut values = Vec::new();
        let mut single_points = Vec::new();
        let (isolated, mut curves): (Vec<&WitnessSet>, Vec<&WitnessSet>) =
            sets.iter().partition(|set| set.id.dimension == 0);
        curves.retain(|set| match self.single_point(set, parameters) {
            Some(point) => {
                single_points.extend(point.is_real().then(|| self.solution_at(&point.0)));
                false
            }
            None => true,
        });
        for set in &curves {
            let Some(value) = self.value_on(set, parameters) else {
                return;
            };
            // At a real point the objective is real.
            let error = ERROR_ON_A_SET * (1.0 + modulus(value));
            if value.im.abs() <= error {
                // A value that may be 0 by its error is 0.
                let is_zero = value.re.abs() <= error;
                values.push(Value {
                    value: if is_zero { 0.0 } else { value.re },
                    error,
                    place: Place::OnSet,
                });
            }
        }
        self.values.extend(values);
        self.sets = Some(CriticalSets {
            isolated: isolated.iter().map(|set| set.degree).sum(),
            count: curves.len() as u64,
            single_points,
        });
    }

    /// The real points at which only multipliers move, to be presented as solutions are.
    pub fn single_points(&self) -> &[Solution] {
        let sets = self.sets.as_ref();
        sets.map_or(&[], |sets| &sets.single_points)
    }

    /// The values of the unknowns that a component has all over, where only multipliers move on it.
    ///
    /// Multipliers enter linearly: those that belong to a point are a linear space in projective space, and where its dimension is that of
    /// the component, which is irreducible, both are the same.
    fn single_point(&mut self, set: &WitnessSet, parameters: &[Complex64]) -> Option<SinglePoint> {
        let (n, variables) = (self.unknowns, self.system.variables.len());
        let [point] = &set.points[..] else {
            return None;
        };
        if point.len() != variables || variables == n {
            return None;
        }
        let columns = self.columns_of_multipliers(point, parameters);
        let mut stream = RandomStream::new(0, Purpose::Probe, 0);
        let size = largest(&point[..n]).max(1.0);
        let general_point: Vec<Complex64> = point.iter().map(|_| stream.unit() * size).collect();
        let general_columns = self.columns_of_multipliers(&general_point, parameters);
        let pairs = columns.into_iter().zip(general_columns);
        let in_units = pairs.map(|(mut column, general)| {
            let unit = largest(&general).max(f64::MIN_POSITIVE);
            column.iter_mut().for_each(|z| *z /= unit);
            column
        });
        let singular_values = Svd::of(in_units.collect()).values;
        let rank = singular_values
            .iter()
            .filter(|value| **value > ZERO_SINGULAR_VALUE);
        let free = variables - n - rank.count();
        (free == set.id.dimension as usize + 1).then(|| SinglePoint(point[..n].to_vec()))
    }

    /// The equations' derivatives by each multiplier.
    fn columns_of_multipliers(
        &mut self,
        point: &[Complex64],
        parameters: &[Complex64],
    ) -> Vec<Vec<Complex64>> {
        let jacobian = self.jacobian(point, parameters);
        let entry = |i: usize, j: usize| {
            let z = jacobian.at(i, j);
            Complex64::new(z.re, z.im)
        };
        let column = |j: usize| (0..jacobian.rows()).map(|i| entry(i, j)).collect();
        (self.unknowns..point.len()).map(column).collect()
    }

    /// A real point with these values of the unknowns as a singular solution, without multipliers.
    fn solution_at(&self, unknowns: &[Complex64]) -> Solution {
        let real = unknowns.iter().map(|z| Complex64::new(z.re, 0.0));
        let values = real.chain(std::iter::repeat(Complex64::default()));
        Solution {
            variables: self.system.variables.iter().cloned().zip(values).collect(),
            multiplicity: 1,
            real: Some(true),
            singular: true,
            condition: f64::INFINITY,
            accuracy: ERROR_ON_A_SET,
            precision_bits: DOUBLE,
            ..Solution::default()
        }
    }

    /// The value of the objective on a component.
    fn value_on(&self, set: &WitnessSet, parameters: &[Complex64]) -> Option<Complex64> {
        let (expressions, n) = (&self.system.expressions, self.unknowns);
        let value = |point: &Vec<Complex64>| {
            let is_regular = match point.get(n) {
                Some(first) => modulus(*first) > ERROR_ON_A_SET * largest(&point[n..]),
                None => true,
            };
            let value = values(expressions, &[self.objective], point, parameters)[0];
            (is_regular && value.is_finite()).then_some(value)
        };
        let mut values = set.points.iter().map(value);
        let first = values.next()??;
        let is_same = |value: Option<Complex64>| {
            value.is_some_and(|z| modulus(z - first) <= ERROR_ON_A_SET * (1.0 + modulus(first)))
        };
        values.all(is_same).then_some(first)
    }
}

//! Total-degree start system: `y_i^(d_i) = y_0^(d_i)`, whose solutions are all tuples of roots of unity.

use crate::chart::Chart;
use cognate_numeric::roots_of_unity::roots_of_unity;
use cognate_systems::expression::{Expressions, NodeId};
use num_complex::Complex64;

/// The start system of one group and its solutions by index.
#[derive(Clone, Debug)]
pub struct TotalDegree {
    degrees: Vec<u32>,
    roots: Vec<Vec<Complex64>>,
}

impl TotalDegree {
    /// The start system for equations of these degrees.
    pub fn new(degrees: &[u32]) -> Self {
        Self {
            degrees: degrees.to_vec(),
            roots: degrees.iter().map(|&d| roots_of_unity(d)).collect(),
        }
    }

    /// The equations over the homogeneous coordinates of the only group.
    pub fn equations(&self, out: &mut Expressions, coordinates: &[NodeId]) -> Vec<NodeId> {
        self.degrees
            .iter()
            .enumerate()
            .map(|(i, &d)| {
                let y = out.power(coordinates[i + 1], d);
                let y0 = out.power(coordinates[0], d);
                out.subtract(y, y0)
            })
            .collect()
    }

    /// Start point number `index`: the digits of the index choose the roots.
    pub fn point(&self, chart: &Chart, mut index: u64) -> Option<Vec<Complex64>> {
        let mut coordinates = vec![Complex64::new(1.0, 0.0)];
        for roots in &self.roots {
            let d = roots.len() as u64;
            coordinates.push(roots[(index % d) as usize]);
            index /= d;
        }
        chart.point(&coordinates)
    }
}

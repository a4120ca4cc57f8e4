//! Segment: the equations between two neighbouring samples.

use super::curve::Curve;
use super::fold::FoldSystem;
use crate::prepared_mechanism::PathEquations;
use cognate_continuation::certification::certified_system;
use cognate_systems::evaluation::Interpreter;
use cognate_systems::expression::Node;
use cognate_systems::system::System;
use num_complex::Complex64;

/// The square system of a path of targets, compiled.
pub struct Equations {
    square: System,
    program: Interpreter,
    homogeneous: Vec<Vec<usize>>,
    blocks: Vec<Vec<usize>>,
    /// All numbers in it are real, so that its real solutions are real numbers.
    is_real: bool,
}

impl Equations {
    /// Compiles.
    pub fn new(path: &PathEquations<'_>) -> Result<Self, String> {
        let square = certified_system(path.system, path.seed)
            .map_err(|e| e.to_string())?
            .into_owned();
        Ok(Self::of_square(square, path.blocks.clone()))
    }

    /// Of a square system, with the blocks of its parameters that count up to a factor.
    pub fn of_square(square: System, blocks: Vec<Vec<usize>>) -> Self {
        let program = Interpreter::compile(
            &square.expressions,
            &square.equations,
            square.variables.len(),
            square.parameters.len(),
        );
        let groups = square.groups.iter().filter(|group| group.homogeneous);
        let real = |node: &Node| match node {
            Node::Constant(value) => value.is_real(),
            Node::Root(..) | Node::Function(..) => false,
            _ => true,
        };
        Self {
            homogeneous: groups.map(|group| group.variables.clone()).collect(),
            is_real: square.expressions.nodes().iter().all(real),
            blocks,
            program,
            square,
        }
    }
}

/// The equations between two samples.
pub struct Segment<'a> {
    equations: &'a Equations,
    start: Vec<Complex64>,
    end: Vec<Complex64>,
}

/// Variables that are held at 1, one for each homogeneous group, and those that are free.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    fixed: Vec<usize>,
    free: Vec<usize>,
}

impl<'a> Segment<'a> {
    /// From the parameters of one sample to those of the next; blocks that count up to a factor take the nearer sign.
    pub fn new(equations: &'a Equations, start: &[Complex64], end: &[Complex64]) -> Self {
        let mut end = end.to_vec();
        for block in &equations.blocks {
            let along: f64 = block.iter().map(|p| start[*p].re * end[*p].re).sum();
            if along < 0.0 {
                block.iter().for_each(|p| end[*p] = -end[*p]);
            }
        }
        Self {
            equations,
            start: start.to_vec(),
            end,
        }
    }

    /// The segment from the end to the start.
    pub fn reversed(&self) -> Self {
        Self {
            equations: self.equations,
            start: self.end.clone(),
            end: self.start.clone(),
        }
    }

    /// The curve in a chart.
    pub fn curve(&self, chart: &Chart) -> Curve<'_> {
        let free = chart.free.clone();
        Curve::new(&self.equations.program, free, &self.start, &self.end)
    }

    /// The equations of folds in a chart.
    pub fn folds(&self, chart: &Chart) -> FoldSystem {
        FoldSystem::new(&self.equations.square, &chart.free)
    }

    /// Whether real solutions of the equations are real numbers.
    pub fn is_real(&self) -> bool {
        self.equations.is_real
    }

    /// The parameters at both ends.
    pub fn ends(&self) -> (&[Complex64], &[Complex64]) {
        (&self.start, &self.end)
    }

    /// The chart in which the largest variable of each homogeneous group of a point is 1.
    pub fn chart(&self, point: &[Complex64]) -> Chart {
        let size = |v: usize| point[v].norm_sqr();
        let largest = |group: &Vec<usize>| {
            group.iter().copied().fold(
                group[0],
                |best, v| {
                    if size(v) > size(best) { v } else { best }
                },
            )
        };
        let fixed: Vec<usize> = self.equations.homogeneous.iter().map(largest).collect();
        let free = (0..point.len()).filter(|v| !fixed.contains(v)).collect();
        Chart { fixed, free }
    }

    /// A point in a chart; real numbers are real there. `None` where it lies on the chart's edge.
    pub fn in_chart(&self, chart: &Chart, point: &[Complex64]) -> Option<Vec<Complex64>> {
        let mut point = point.to_vec();
        for (group, fixed) in self.equations.homogeneous.iter().zip(&chart.fixed) {
            let scale = point[*fixed];
            if scale.norm_sqr() == 0.0 {
                return None;
            }
            group.iter().for_each(|v| point[*v] /= scale);
            point[*fixed] = Complex64::new(1.0, 0.0);
        }
        if self.equations.is_real {
            point.iter_mut().for_each(|z| z.im = 0.0);
        }
        Some(point)
    }
}

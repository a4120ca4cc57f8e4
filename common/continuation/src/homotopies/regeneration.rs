//! The rows of a level of a regeneration, and how their parameters move.

use super::HomotopyKind;
use crate::start_systems::linear_product::linear_form;
use crate::start_systems::slices::form;
use cognate_systems::expression::{Expressions, NodeId};
use num_complex::Complex64;

/// One level of a regeneration: the equations that hold and the number of unknowns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level<'a> {
    pub order: &'a [u32],
    pub level: usize,
    /// Number of forms that the slice moves to; `None` where a product of forms becomes the equation.
    slides: Option<u32>,
    seed: u64,
}

impl<'a> Level<'a> {
    /// The level of a homotopy that is one of a regeneration.
    pub(crate) fn of(kind: &'a HomotopyKind, seed: u64) -> Option<Self> {
        let (order, level, slides) = kind.level()?;
        Some(Self {
            order,
            level: level as usize,
            slides,
            seed,
        })
    }

    fn form(&self, level: usize, number: u32) -> Vec<Complex64> {
        form(self.seed, level as u32, number, self.order.len())
    }

    /// The equation that comes next.
    pub(crate) fn next(&self) -> usize {
        self.order[self.level] as usize
    }

    /// The product of the level's forms, as many as the degree of its equation.
    pub(crate) fn product(
        &self,
        out: &mut Expressions,
        coordinates: &[NodeId],
        degree: u32,
    ) -> NodeId {
        let mut product = out.integer(1);
        for number in 0..degree {
            let form = linear_form(out, &self.form(self.level, number), coordinates);
            product = out.multiply(product, form);
        }
        product
    }

    /// All rows: the equations that hold, `moving` for the level, the slices after it.
    pub(crate) fn rows(
        &self,
        out: &mut Expressions,
        coordinates: &[NodeId],
        equations: &[NodeId],
        moving: NodeId,
    ) -> Vec<NodeId> {
        let held = self.order[..self.level].iter();
        let mut rows: Vec<NodeId> = held.map(|&i| equations[i as usize]).collect();
        rows.push(moving);
        for level in self.level + 1..self.order.len() {
            rows.push(linear_form(out, &self.form(level, 0), coordinates));
        }
        rows
    }

    /// The slice as a form whose coefficients are the program's parameters.
    pub(crate) fn moving_form(out: &mut Expressions, coordinates: &[NodeId]) -> NodeId {
        let mut sum = out.integer(0);
        for (k, &y) in (0u32..).zip(coordinates) {
            let c = out.parameter(k);
            let term = out.multiply(c, y);
            sum = out.add(sum, term);
        }
        sum
    }

    /// Coefficients of the slice, and of each form that it moves to.
    pub(crate) fn ends(&self) -> (Vec<Complex64>, Vec<Vec<Complex64>>) {
        let targets = 1..=self.slides.unwrap_or(0);
        let targets = targets
            .map(|number| self.form(self.level, number))
            .collect();
        (self.form(self.level, 0), targets)
    }

    /// Degree of each row; `degrees[equation]` in the one group, `next` of the level's row.
    pub(crate) fn row_degrees(&self, degrees: &[Vec<u32>]) -> Vec<Vec<u32>> {
        let held = self.order[..self.level].iter();
        let mut rows: Vec<Vec<u32>> = held.map(|&i| degrees[i as usize].clone()).collect();
        rows.push(match self.slides {
            Some(_) => vec![1],
            None => degrees[self.next()].clone(),
        });
        rows.resize(self.order.len(), vec![1]);
        rows
    }
}

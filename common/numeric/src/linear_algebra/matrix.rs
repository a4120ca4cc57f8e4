//! Dense row-major matrix of complex numbers; its storage is reused between steps.

use crate::scalar::{Complex, Real};

/// A dense matrix, row after row.
#[derive(Clone, Debug)]
pub struct Matrix<R> {
    rows: usize,
    columns: usize,
    /// Entry (i, j) stands at `i * columns + j`.
    pub entries: Vec<Complex<R>>,
}

impl<R: Real> Matrix<R> {
    /// A matrix of zeros.
    pub fn zeros(context: R::Context, rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            entries: vec![Complex::zero(context); rows * columns],
        }
    }

    /// Number of rows.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Entry in row i, column j.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize) -> &Complex<R> {
        &self.entries[i * self.columns + j]
    }

    /// Entry in row i, column j.
    #[inline(always)]
    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut Complex<R> {
        &mut self.entries[i * self.columns + j]
    }
}

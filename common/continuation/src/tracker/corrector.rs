//! Corrector: Newton's method from the predicted points of all lanes to points of their paths.
//!
//! The last round finds the tangent from the same factorisation.

use super::batch::Batch;
use super::limits::{MOST_ROUNDS, control};
use super::prediction::Prediction;
use crate::chart::LEAST_NORM;
use crate::homotopies::Homotopy;
use cognate_machine_code::Evaluator;
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::Evaluate;

/// Newton's method at one t in each lane, with its work space.
pub(super) struct Corrector<'a, R: Real> {
    homotopy: &'a Homotopy,
    context: R::Context,
    rounds: usize,
    scratch: <Evaluator as Evaluate<R>>::Scratch,
    /// [J | value | derivative by t]
    matrix: Matrix<R>,
    /// Parameters at t, and their derivatives by t.
    p: Vec<Complex<R>>,
    dp: Vec<Complex<R>>,
}

/// Corrections of Newton's method in a step.
pub(super) struct Corrections<R: Real> {
    /// Each round's correction, relative to the largest coordinate; 0 in rounds that were not made.
    pub relative: [R::Control; MOST_ROUNDS],
    /// Largest coordinate of the corrected point.
    pub size: R::Control,
}

/// Points after Newton's method, and tangents there.
pub(super) struct Corrected<R: Real> {
    pub x: Vec<Complex<R>>,
    pub tangent: Vec<Complex<R>>,
    pub corrections: Corrections<R>,
}

impl<'a, R: Real> Corrector<'a, R> {
    #[inline(always)]
    pub fn new(homotopy: &'a Homotopy, context: R::Context, rounds: usize) -> Self {
        let n = homotopy.dimension();
        let parameters = homotopy.parameter_count();
        Self {
            homotopy,
            context,
            rounds,
            scratch: Evaluate::<R>::scratch(homotopy.evaluator(), context),
            matrix: Matrix::zeros(context, n, n + 2),
            p: vec![Complex::zero(context); parameters],
            dp: vec![Complex::zero(context); parameters],
        }
    }

    /// Newton rounds of a step.
    pub fn rounds(&self) -> usize {
        self.rounds
    }

    /// Newton; then Newton and tangent from one factorisation.
    #[inline(always)]
    pub fn correct(
        &mut self,
        batch: &mut Batch<R>,
        t: &Complex<R::Control>,
        predicted: Prediction<R>,
    ) -> Corrected<R> {
        let Prediction {
            mut x, mut tangent, ..
        } = predicted;
        let n = x.len();
        let (evaluator, elimination) = (self.homotopy.evaluator(), self.homotopy.elimination());
        let (matrix, scratch) = (&mut self.matrix, &mut self.scratch);
        dispatch_baseline(ParametersAt {
            homotopy: self.homotopy,
            context: self.context,
            t,
            ends: [&batch.a, &batch.b],
            p: &mut self.p,
            dp: &mut self.dp,
        });
        let mut relative: [R::Control; MOST_ROUNDS] = std::array::from_fn(|_| control::<R>(0.0));
        let mut size = control::<R>(0.0);
        for (round, correction) in relative.iter_mut().enumerate().take(self.rounds) {
            if round + 1 < self.rounds {
                evaluator.jacobian(&x, &self.p, matrix, scratch);
                elimination.eliminate::<R, 1>(matrix, &mut batch.exchanges);
            } else {
                evaluator.linearize(&x, &self.p, &self.dp, matrix, scratch);
                elimination.eliminate::<R, 2>(matrix, &mut batch.exchanges);
            }
            size = control::<R>(LEAST_NORM * LEAST_NORM);
            for i in 0..n {
                let delta = matrix.at(i, n);
                correction.max(&delta.norm_sqr().control());
                x[i].sub(delta);
                size.max(&x[i].norm_sqr().control());
            }
        }
        for i in 0..n {
            tangent[i].set(matrix.at(i, n + 1));
            tangent[i].neg();
        }
        size.sqrt();
        for correction in &mut relative {
            correction.sqrt();
            correction.div(&size);
        }
        Corrected {
            x,
            tangent,
            corrections: Corrections { relative, size },
        }
    }
}

/// The parameters at t in each lane, and their derivatives by t.
struct ParametersAt<'a, R: Real> {
    homotopy: &'a Homotopy,
    context: R::Context,
    t: &'a Complex<R::Control>,
    /// Parameters at t = 1 and at t = 0.
    ends: [&'a [Complex<R>]; 2],
    p: &'a mut [Complex<R>],
    dp: &'a mut [Complex<R>],
}

impl<R: Real> Job for ParametersAt<'_, R> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let [a, b] = self.ends;
        let path = self.homotopy.path();
        path.at(self.context, self.t, a, b, self.p, self.dp);
    }
}

//! Centred: a question about real curves and surfaces far from the origin is asked about their centre.
//!
//! Slices and linear forms of a random start pass near the origin. From far away equations nearly cancel on all of a
//! component, and paths from the product of forms to an equation that is small there do not move until it is too late.

use super::real_box::RealBox;
use crate::decomposition::DecompositionOptions;
use crate::decomposition::problem::{Problem, with_values};
use cognate_solutions::involution::Involution;
use cognate_solutions::witness::question::CurveWish;
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_solutions::witness::{Answer, Question, WitnessSet};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use cognate_systems::units::about_centre;
use num_complex::Complex64;
use std::sync::Arc;

/// The question about the centre.
pub(super) struct Centred {
    pub system: System,
    pub options: DecompositionOptions,
    pub components: Vec<WitnessSet>,
    pub question: Question,
    pub centre: Vec<Complex64>,
}

/// The question moved to the centre of the system; `None` if that gains nothing.
pub(super) fn centred(
    system: &System,
    options: &DecompositionOptions,
    components: &[WitnessSet],
    question: &Question,
) -> Option<Centred> {
    if !matches!(
        question,
        Question::RealCurve(_) | Question::RealSurface { .. }
    ) {
        return None;
    }
    // About its centre a system is written without what is attached to it.
    if !denominator_factors(system).is_empty() {
        return None;
    }
    let system = with_values(system, &options.parameters).ok()?;
    let involution = Involution::of(&system, &[]).ok()?;
    let (system, centre) = about_centre(&system, &involution.partner)?;
    let fits = |set: &WitnessSet| {
        let rows = set.slice.iter().map(|row| row.len() == centre.len() + 1);
        let points = set.points.iter().map(|p| p.len() == centre.len());
        rows.chain(points).all(|fits| fits)
    };
    if !components.iter().all(fits) {
        return None;
    }
    let components = components.iter().map(|set| moved(set, &centre)).collect();
    let question = match question {
        Question::RealCurve(wish) => Question::RealCurve(about(wish, &centre, &involution)),
        other => other.clone(),
    };
    let options = DecompositionOptions {
        parameters: Vec::new(),
        ..options.clone()
    };
    Some(Centred {
        system,
        options,
        components,
        question,
        centre,
    })
}

/// A witness set seen from the centre.
fn moved(set: &WitnessSet, centre: &[Complex64]) -> WitnessSet {
    let row = |row: &Vec<Complex64>| {
        let terms = row[1..].iter().zip(centre).map(|(a, c)| a * c);
        let constant = row[0] + terms.sum::<Complex64>();
        std::iter::once(constant)
            .chain(row[1..].iter().copied())
            .collect()
    };
    let point = |point: &Vec<Complex64>| point.iter().zip(centre).map(|(x, c)| x - c).collect();
    WitnessSet {
        slice: Arc::new(set.slice.iter().map(row).collect()),
        points: set.points.iter().map(point).collect(),
        ..set.clone()
    }
}

/// A wish with its box seen from the centre.
fn about(wish: &CurveWish, centre: &[Complex64], involution: &Involution) -> CurveWish {
    let mut within = wish.within.clone();
    if let Some(given) =
        RealBox::new(&wish.within, involution).filter(|_| within.len() == centre.len())
    {
        for (variable, bounds) in within.iter_mut().enumerate() {
            let terms = given.coordinate(variable);
            let offset: f64 = terms.iter().map(|(v, c)| (c * centre[*v]).re).sum();
            *bounds = bounds.map(|bound| bound - offset);
        }
    }
    CurveWish {
        within,
        ..wish.clone()
    }
}

/// Moves the answer back to the original origin.
pub(super) fn back(answer: &mut Answer, centre: &[Complex64], problem: &Problem) {
    match answer {
        Answer::RealCurve(curves) => {
            let unknowns = problem.to_unknowns(centre);
            for curve in curves {
                curve_back(curve, centre, &unknowns);
            }
        }
        Answer::RealSurface(surfaces) => {
            for vertex in surfaces.iter_mut().flat_map(|s| &mut s.mesh.vertices) {
                for (x, c) in vertex.iter_mut().zip(centre) {
                    *x += c.re;
                }
            }
        }
        _ => {}
    }
}

fn curve_back(curve: &mut RealCurve, centre: &[Complex64], unknowns: &[Complex64]) {
    let offset = super::real_curve::value(&curve.form, unknowns);
    let samples = curve.edges.iter_mut().flat_map(|edge| &mut edge.samples);
    let vertices = curve.vertices.iter_mut().map(|vertex| {
        vertex.value += offset;
        &mut vertex.point
    });
    for point in samples.chain(vertices) {
        for (x, c) in point.iter_mut().zip(centre) {
            *x += c;
        }
    }
    for proof in &mut curve.proofs {
        proof.value += offset;
    }
}

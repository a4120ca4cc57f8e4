//! Real surfaces: the real part of components of dimension 2 in space, triangulated.
//!
//! Two random real forms u and v show the surface on a plane. Its outline there, the curve where both are critical, and
//! its singular curves are real curves; their points where u is critical are levels of u, between which sections of the
//! surface are alike. A section is known by its fibres over the strips between its marks, the points on those curves
//! ([`section`]); arcs of neighbouring sections with the same ends bound a face ([`mesh`]). (After Besana, Di Rocco,
//! Hauenstein, Sommese, Wampler: Cell decomposition of almost smooth real algebraic surfaces, Numer. Algorithms 63,
//! 2013; sheets are told by their order instead of by paths between sections, which takes one stage for all fibres.) A
//! surface that is not its own conjugate has only curves and points that are real ([`conjugates`]).

mod conjugates;
mod equations;
mod mesh;
mod plan;
mod reduced;
mod section;
mod squares;

use super::context::Context;
use super::denominators::keep_parts_of_no_sheet;
use super::error::{QuestionError, check_number};
use super::levels::{Change, levels};
use super::member::Member;
use super::mirror::conjugates_to_slice;
use super::procedure::{GivenSystem, Procedure};
use super::real_curve::{RealCurves, row_of, size_of};
use super::{AnyProcedure, QuestionSolve};
use crate::decomposition::deflated::equal_ones_merged;
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use crate::decomposition::problem::ProblemError;
use crate::decomposition::{DecompositionOptions, DecompositionSolve};
use crate::solve::Solve;
use cognate_continuation::bend::doubles_of;
use cognate_continuation::path_result::PathResult;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Decision, Verdict};
use cognate_solutions::witness::real_curve::{CurveVertex, RealCurve, VertexKind};
use cognate_solutions::witness::real_surface::{Mesh, RealSurface};
use cognate_solutions::witness::{Answer, TrackedPaths, WitnessSet};
use cognate_systems::polynomial::PolynomialError;
use cognate_systems::system::System;
use mesh::{Builder, links};
use num_complex::Complex64;
use plan::{Collected, Plan};
use section::Fibre;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Most samples on either side of the middle of a slab.
const MOST_SURFACE_SAMPLES: u64 = 50;
/// Forms that are tried until one leaves no doubt.
const MOST_FORMS: u32 = 6;
/// An end that looks singular is a regular point this near to it, relative to its size.
const MOVED_SINGULAR: f64 = 1e-6;
/// Points of fibres, which are known to 32 digits, are real below this imaginary part.
const REAL: f64 = 1e-15;
/// Points of fibres are not real above this imaginary part.
const NOT_REAL: f64 = 1e-12;

/// Step of the work on the current component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    Begin,
    /// Conjugates of the witness points go back to their slice.
    Mirror,
    /// The singular curves are decomposed, among which a surface meets its conjugate.
    Meeting,
    /// Points of the singular curves are asked whether they are on the surface.
    Membership,
    /// The real part of the curves, of this number, in which a surface meets its conjugate.
    MeetingCurves(usize),
    /// The outline is decomposed.
    Outline,
    /// The singular curves are decomposed.
    Singular,
    /// Levels of u on the curves of this number: points where u is critical.
    Levels(usize),
    /// The arcs of the curves of this number between all levels.
    Arcs(usize),
    /// All fibres.
    Fibres,
}

/// A solve inside this one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Child {
    Decomposition(Box<DecompositionSolve>),
    Curves(Box<QuestionSolve>),
    /// Equations that have no solution, since one of them is a constant other than 0.
    Empty,
}

/// Curves on the surface, of one system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Curves {
    system: Arc<System>,
    components: Vec<WitnessSet>,
    singular: bool,
    found: Vec<RealCurve>,
}

/// The current component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Viewing {
    /// Coefficients of the forms u, v and the third form.
    forms: [Vec<[i32; 2]>; 3],
    curves: Vec<Curves>,
    /// Singular curves of which is asked whether they are on the surface.
    asked: Vec<WitnessSet>,
    membership: Option<Member>,
    levels: Vec<f64>,
    /// Degree of the multiple components of the outline: curves along which the surface is singular.
    multiple: u64,
    doubts: Vec<String>,
}

/// Component by component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RealSurfaces {
    /// Sections and fibres on either side of a middle.
    samples: u32,
    found: Vec<RealSurface>,
    phase: Phase,
    number: u32,
    now: Viewing,
    child: Option<Child>,
    /// Paths of all children that are done.
    paths: TrackedPaths,
}

impl Procedure for RealSurfaces {
    fn advance(&mut self, context: &mut Context<'_>, mut done: Option<Job>) -> Option<Job> {
        loop {
            let operand = context.operands.get(self.found.len())?;
            let phase = self.phase.clone();
            let job = match (phase, self.child.take(), done.take()) {
                (Phase::Begin, ..) => self.begin(context, operand),
                (Phase::Mirror, _, Some(job)) => self.mirrored(context, operand, &job),
                (Phase::Meeting, Some(child), _) => self.meet(context, operand, child),
                (Phase::Membership, _, Some(job)) => {
                    self.ask_membership(context, operand, Some(job))
                }
                (Phase::MeetingCurves(k), Some(child), _) => {
                    self.meeting_followed(context, operand, k, child)
                }
                (Phase::Outline, Some(child), _) => self.outlined(context, child),
                (Phase::Singular, Some(child), _) => self.with_singular(context, child),
                (Phase::Levels(k), Some(child), _) => self.levelled(context, k, child),
                (Phase::Arcs(k), Some(child), _) => self.followed(context, k, child),
                (Phase::Fibres, _, Some(job)) => self.assemble(context, operand, &job),
                (phase, ..) => unreachable!("{phase:?} waits for something"),
            };
            match self.child {
                Some(Child::Empty) => continue,
                None if job.is_none() => {}
                _ => return job,
            }
            if !self.now.doubts.is_empty() && self.number + 1 < MOST_FORMS && self.begun() {
                self.number += 1;
                self.now = Viewing::default();
                self.phase = Phase::Begin;
                continue;
            }
            if self.phase != Phase::Begin {
                self.settle(operand, None);
            }
        }
    }

    fn answer(&mut self, given: &GivenSystem<'_>) -> Answer {
        Answer::RealSurface(given.take_solutions(&mut self.found, keep_parts_of_no_sheet))
    }

    fn description(&self) -> &'static str {
        match self.phase {
            Phase::Begin | Phase::Outline => "decomposing the outline of a surface",
            Phase::Mirror => "moving conjugates of witness points to their slice",
            Phase::Meeting | Phase::Membership => "finding where a surface meets its conjugate",
            Phase::MeetingCurves(_) => "following curves in which a surface meets its conjugate",
            Phase::Singular => "decomposing singular curves of a surface",
            Phase::Levels(_) => "finding levels at which sections change",
            Phase::Arcs(_) => "following curves on the surface between levels",
            Phase::Fibres => "moving slices to all fibres",
        }
    }

    fn inner(&mut self) -> Option<&mut dyn Solve> {
        match &mut self.child {
            Some(Child::Decomposition(solve)) => Some(&mut **solve),
            Some(Child::Curves(solve)) => Some(&mut **solve),
            Some(Child::Empty) | None => None,
        }
    }

    fn inner_paths(&self) -> TrackedPaths {
        self.paths
    }

    /// No: of fibres all points are compared.
    fn doubts_crossings(&self) -> bool {
        false
    }
}

impl RealSurfaces {
    /// Real surfaces with this number of samples on either side of a middle.
    pub fn new(samples: u32) -> Result<Self, QuestionError> {
        check_number("samples", samples.into(), MOST_SURFACE_SAMPLES)?;
        Ok(Self {
            samples,
            found: Vec::new(),
            phase: Phase::Begin,
            number: 0,
            now: Viewing::default(),
            child: None,
            paths: TrackedPaths::default(),
        })
    }

    fn begun(&self) -> bool {
        !self.now.forms[0].is_empty()
    }

    /// Writes down what is known of the component.
    fn settle(&mut self, operand: &Operand, surface: Option<RealSurface>) {
        let viewing = std::mem::take(&mut self.now);
        self.number = 0;
        self.phase = Phase::Begin;
        self.found.push(surface.unwrap_or(RealSurface {
            id: operand.id,
            degree: operand.degree() as u64,
            compact: false,
            euler: 0,
            levels: viewing.levels,
            mesh: Mesh::default(),
            doubts: viewing.doubts,
        }));
    }

    fn doubt<T>(&mut self, doubt: impl Into<String>) -> Option<T> {
        self.now.doubts.push(doubt.into());
        None
    }

    fn begin(&mut self, context: &mut Context<'_>, operand: &Operand) -> Option<Job> {
        let problem = context.problem;
        let n = problem.variables();
        let refused = match (&problem.involution, operand.dimension()) {
            (_, dimension) if dimension != 2 => {
                Some(format!("it has dimension {dimension}; surfaces have 2"))
            }
            _ if n != 3 => Some(format!("{n} variables; surfaces are drawn in 3")),
            _ if !operand.set.ranks.is_empty() => Some("it is multiple".into()),
            (None, _) => Some("complex conjugation does not map solutions to solutions".into()),
            (Some(i), _) if i.partner != [0, 1, 2] => {
                Some("conjugation exchanges variables; surfaces are drawn in real ones".into())
            }
            _ => None,
        };
        if let Some(refused) = refused {
            self.now.doubts.push(refused);
            self.settle(operand, None);
            return None;
        }
        match (&problem.involution, self.number) {
            (Some(involution), 0) => {
                self.phase = Phase::Mirror;
                Some(conjugates_to_slice(context, operand, involution))
            }
            _ => self.outline(context),
        }
    }

    /// Begins with the outline under random forms.
    fn outline(&mut self, context: &Context<'_>) -> Option<Job> {
        self.now.forms = forms(context, self.number);
        self.phase = Phase::Outline;
        let [u, v, _] = &self.now.forms;
        let system = equations::outline(context.problem, &[u.clone(), v.clone()]);
        self.decompose(context, system, 1..=1)
    }

    /// Begins to decompose the curves of a system, or what it has of these dimensions.
    fn decompose(
        &mut self,
        context: &Context<'_>,
        system: System,
        dimensions: RangeInclusive<u32>,
    ) -> Option<Job> {
        let options = DecompositionOptions {
            dimensions: Some(dimensions),
            ..self.options(context)
        };
        self.now.curves.push(Curves {
            singular: self.phase == Phase::Singular,
            system: Arc::new(system),
            components: Vec::new(),
            found: Vec::new(),
        });
        let system = &self.now.curves[self.now.curves.len() - 1].system;
        match DecompositionSolve::new(system, &options) {
            Ok(solve) => {
                self.child = Some(Child::Decomposition(Box::new(solve)));
                None
            }
            // A plane has no outline, and parallel planes none, whose equations depend on one form only.
            Err(ProblemError::Degrees(PolynomialError::Constant(_)))
            | Err(ProblemError::Dimensions { least: 2.., .. }) => {
                self.child = Some(Child::Empty);
                None
            }
            Err(error) => self.doubt(error.to_string()),
        }
    }

    fn options(&self, context: &Context<'_>) -> DecompositionOptions {
        let tracking = &context.problem.tracking;
        DecompositionOptions {
            seed: tracking.seed,
            settings: tracking.settings.clone(),
            tolerances: tracking.tolerances.clone(),
            max_retries: tracking.max_retries,
            own_units: false,
            ..DecompositionOptions::default()
        }
    }

    /// The curves of a system: reduced ones, and multiple ones.
    fn components(&mut self, child: Child) -> Option<[Vec<WitnessSet>; 2]> {
        let solve = match child {
            Child::Decomposition(solve) => solve,
            Child::Empty => return Some([Vec::new(), Vec::new()]),
            Child::Curves(_) => unreachable!("curves are decomposed first"),
        };
        let decomposition = solve.decomposition().expect("it is done");
        self.paths.add(&decomposition.paths);
        self.paths.add(&decomposition.paths_of_loops);
        let curves = decomposition
            .components
            .iter()
            .filter(|c| c.dimension() == 1);
        let unsettled = curves.clone().any(|c| !c.settled());
        if unsettled
            || decomposition
                .dimensions
                .iter()
                .any(|d| !d.doubts.is_empty())
        {
            return self.doubt("its critical or singular curves are not settled");
        }
        let (plain, multiple) = curves.cloned().partition(|c| c.deflation.is_empty());
        Some([plain, multiple])
    }

    fn outlined(&mut self, context: &mut Context<'_>, child: Child) -> Option<Job> {
        let [plain, multiple] = self.components(child)?;
        self.now.curves[0].components = plain;
        let multiple: u64 = multiple.iter().map(|c| c.degree).sum();
        if multiple == 0 {
            return self.next_levels(context, 0);
        }
        self.now.multiple = multiple;
        self.phase = Phase::Singular;
        let system = equations::singular(context.problem);
        self.decompose(context, system, 1..=1)
    }

    fn with_singular(&mut self, context: &mut Context<'_>, child: Child) -> Option<Job> {
        let [plain, multiple] = self.components(child)?;
        if !multiple.is_empty() {
            return self.doubt("it is singular along a curve where its derivatives vanish twice");
        }
        if plain.iter().map(|c| c.degree).sum::<u64>() != self.now.multiple {
            return self.doubt("its singular curves are not the multiple ones of its outline");
        }
        self.now.curves[1].components = plain;
        self.next_levels(context, 0)
    }

    /// The stage of curves that comes first from this number on.
    fn next_levels(&mut self, context: &mut Context<'_>, number: usize) -> Option<Job> {
        let later_curves = self.now.curves.iter().enumerate().skip(number);
        let mut left = later_curves.filter(|(_, curves)| !curves.components.is_empty());
        match left.next() {
            Some((k, _)) => {
                self.phase = Phase::Levels(k);
                self.curves(context, k, 1, Vec::new())
            }
            None => {
                let changes_of = |curves: &Curves| -> Vec<Change> {
                    let vertices = curves.found.iter().flat_map(|curve| &curve.vertices);
                    let vertices = vertices.filter(|v| v.kind != VertexKind::Regular);
                    let exact =
                        |v: &CurveVertex| !curves.singular && v.kind == VertexKind::Critical;
                    let change = |v: &CurveVertex| Change {
                        value: v.value,
                        exact: exact(v),
                    };
                    vertices.map(change).collect()
                };
                match levels(self.now.curves.iter().flat_map(changes_of).collect()) {
                    Some(levels) => self.now.levels = levels,
                    None => return self.doubt("two levels are nearly the same"),
                }
                self.next_arcs(context, 0)
            }
        }
    }

    fn curves(
        &mut self,
        context: &Context<'_>,
        number: usize,
        samples: u32,
        levels: Vec<f64>,
    ) -> Option<Job> {
        let options = self.options(context);
        let curves = &self.now.curves[number];
        let form = self.now.forms[0].clone();
        let size = size_of(&context.operands[self.found.len()], &form);
        let along = RealCurves::along(samples, form, levels, size);
        let along = AnyProcedure::RealCurve(Box::new(along));
        match QuestionSolve::begin(&curves.system, &options, &curves.components, along) {
            Ok(solve) => {
                self.child = Some(Child::Curves(Box::new(solve)));
                None
            }
            Err(error) => self.doubt(error.to_string()),
        }
    }

    fn take_curves(&mut self, number: usize, child: Child) -> Option<()> {
        let Child::Curves(solve) = child else {
            unreachable!("curves are followed")
        };
        self.paths.add(&solve.paths());
        if let Some(doubt) = solve.doubts().first() {
            return self.doubt(format!("a curve on it: {doubt}"));
        }
        let Some(Answer::RealCurve(real_curves)) = solve.answer() else {
            unreachable!("real curves were asked")
        };
        self.now.curves[number].found = real_curves.clone();
        Some(())
    }

    fn levelled(&mut self, context: &mut Context<'_>, number: usize, child: Child) -> Option<Job> {
        self.take_curves(number, child)?;
        self.next_levels(context, number + 1)
    }

    fn next_arcs(&mut self, context: &mut Context<'_>, number: usize) -> Option<Job> {
        let later_curves = self.now.curves.iter().enumerate().skip(number);
        let mut left = later_curves.filter(|(_, curves)| !curves.components.is_empty());
        if let Some((k, _)) = left.next() {
            self.phase = Phase::Arcs(k);
            return self.curves(context, k, self.samples, self.now.levels.clone());
        }
        let operand = &context.operands[self.found.len()];
        let plan = self.plan(operand)?;
        let targets = self.targets(&plan);
        if targets.len() > operand.most_targets() {
            return self.doubt(format!(
                "{} fibres are too many; fewer samples take fewer",
                targets.len()
            ));
        }
        self.phase = Phase::Fibres;
        Some(operand.moved_to(&mut context.of_components(), targets))
    }

    fn followed(&mut self, context: &mut Context<'_>, number: usize, child: Child) -> Option<Job> {
        self.take_curves(number, child)?;
        self.next_arcs(context, number + 1)
    }

    /// All sections with their marks.
    fn plan(&mut self, operand: &Operand) -> Option<Plan> {
        let viewing = &self.now;
        let sizes = [0, 1].map(|k| size_of(operand, &viewing.forms[k]));
        let mut collection = Collected::new(&viewing.levels, sizes, self.samples);
        for curves in &viewing.curves {
            for curve in &curves.found {
                if let Err(u) = collection.add(curve, curves.singular, &viewing.forms) {
                    return self.doubt(format!("points of a curve on it over {u:.6} are missing"));
                }
            }
        }
        Some(collection.plan(&viewing.levels))
    }

    /// The slices of all fibres, in the order of [`Self::fill`].
    fn targets(&self, plan: &Plan) -> Vec<Vec<Vec<Complex64>>> {
        let row = |form: usize, value: f64| row_of(&self.now.forms[form], value);
        let mut targets = Vec::new();
        plan.each_fibre(&mut |u, v| targets.push(vec![row(0, u), row(1, v)]));
        targets
    }

    /// Puts the real points of all fibres into the plan, and the arcs of sections together; `None` where some are not
    /// clear.
    fn fill(
        &mut self,
        context: &mut Context<'_>,
        operand: &Operand,
        job: &Job,
        plan: &mut Plan,
    ) -> Option<()> {
        let targets = self.targets(plan);
        let ends = job.ends();
        let mut fibres = Vec::with_capacity(targets.len());
        for (rows, ends) in targets.iter().zip(ends.chunks(operand.degree())) {
            fibres.push(self.fibre(context, rows, ends));
        }
        let mut fibres = fibres.into_iter();
        for section in &mut plan.sections {
            let filled = section.fill(&mut fibres);
            if let Err(doubt) = filled.and_then(|()| section.connect()) {
                return self.doubt(doubt);
            }
        }
        for sections in plan.near.iter_mut().flatten() {
            // Sections near levels that are not clear are left out: they are no help, and no doubt.
            sections.retain_mut(|section| {
                let filled = section.fill(&mut fibres);
                filled.and_then(|()| section.connect()).is_ok()
            });
        }
        Some(())
    }

    /// The real points over the slice of a fibre, to which these paths came; what is not clear.
    fn fibre(
        &self,
        context: &mut Context<'_>,
        rows: &[Vec<Complex64>],
        ends: &[(&PathResult, Decision, Vec<Complex64>)],
    ) -> Result<Fibre, String> {
        let (u, v) = (-rows[0][0].re, -rows[1][0].re);
        // Beside a mark points lie near one another, and look singular to a path: whether they are, all digits tell.
        let lost = |d: &Decision| matches!(d.verdict, Verdict::Failed | Verdict::AtInfinity);
        if ends.iter().any(|(_, d, _)| lost(d)) {
            return Err(format!("points of the fibre at ({u:.6}, {v:.6}) were lost"));
        }
        let points: Vec<Vec<Complex64>> = ends.iter().map(|(_, _, v)| v.clone()).collect();
        let refined = context
            .deflations
            .points_on(context.problem, (rows, &[]), &points);
        let mut fibre = Fibre {
            v,
            ..Fibre::default()
        };
        let ends = refined.into_iter().zip(ends);
        let clear = ends.map(|(refined, (_, decision, _))| {
            refined.filter(|r| decision.verdict == Verdict::Finite || r.moved < MOVED_SINGULAR)
        });
        let Some(refined) = clear.collect::<Option<Vec<_>>>() else {
            return Err(format!("the fibre at ({u:.6}, {v:.6}) is not regular"));
        };
        let apart = refined.iter().map(|p| (p.clone(), 1)).collect();
        if equal_ones_merged(apart).len() < points.len() {
            return Err(format!("two paths met in the fibre at ({u:.6}, {v:.6})"));
        }
        let third = row_of(&self.now.forms[2], 0.0);
        for refined in refined {
            let point = doubles_of(&refined.point);
            let apart = point.iter().map(|z| z.im.abs()).fold(0.0, f64::max);
            if (REAL..NOT_REAL).contains(&apart) {
                return Err("a point is neither clearly real nor clearly not".into());
            }
            let value: Complex64 = third[1..].iter().zip(&point).map(|(c, x)| c * x).sum();
            fibre.third.push([value.re, value.im]);
            if apart < REAL {
                fibre.real.push([u, v, value.re]);
            }
        }
        fibre.real.sort_by(|a, b| a[2].total_cmp(&b[2]));
        Ok(fibre)
    }

    /// Puts sections and triangles together.
    fn assemble(&mut self, context: &mut Context<'_>, operand: &Operand, job: &Job) -> Option<Job> {
        let mut plan = self.plan(operand)?;
        self.fill(context, operand, job, &mut plan)?;
        let built = match built(&plan) {
            Ok(built) => built,
            Err(doubt) => return self.doubt(doubt),
        };
        let inverse = inverse(&self.now.forms);
        let mesh = built.finish(|place| {
            let unknowns = inverse.map(|row| {
                let sum: f64 = row.iter().zip(place).map(|(c, x)| c * x).sum();
                Complex64::new(sum, 0.0)
            });
            let point = context.problem.to_variables(&unknowns);
            [point[0].re, point[1].re, point[2].re]
        });
        let (euler, compact) = plan.cells();
        let mut surface = RealSurface {
            id: operand.id,
            degree: operand.degree() as u64,
            compact,
            euler,
            levels: self.now.levels.clone(),
            mesh,
            doubts: Vec::new(),
        };
        surface.check();
        if !surface.doubts.is_empty() {
            self.now.doubts.append(&mut surface.doubts);
            return None;
        }
        self.settle(operand, Some(surface));
        None
    }
}

/// All triangles.
fn built(plan: &Plan) -> Result<Builder, String> {
    let mut builder = Builder::default();
    let section = |k: usize| (k, &plan.sections[k]);
    for k in 0..plan.sections.len() {
        let numbered_section = section(k);
        for mark in (0..numbered_section.1.marks.len()).filter(|&m| numbered_section.1.on[m]) {
            builder.mark(numbered_section, mark);
        }
        let Some(level) = plan.levels[k] else {
            if k > 0 && plan.levels[k - 1].is_none() {
                builder.between(section(k - 1), numbered_section)?;
                curves(&mut builder, plan, [k - 1, k]);
            }
            continue;
        };
        for (side, beside) in [k - 1, k + 1].into_iter().enumerate() {
            let limits = &plan.limits[level][side];
            let near = &plan.near[level][side];
            let links = links(numbered_section.1, &plan.sections[beside], near, limits)?;
            builder.at_level(numbered_section, section(beside), limits, &links)?;
            let other = &plan.sections[beside];
            for (m, mark) in other.marks.iter().enumerate() {
                let on = plan.singular[mark.name] && other.on[m];
                if let Some(&limit) = limits.get(&mark.name).filter(|_| on) {
                    let ends = (
                        builder.mark(numbered_section, limit),
                        builder.mark(section(beside), m),
                    );
                    builder.segment(ends.0, ends.1);
                }
            }
        }
    }
    Ok(builder)
}

/// Singular curves between two sections of one slab.
fn curves(builder: &mut Builder, plan: &Plan, [a, b]: [usize; 2]) {
    let (of_a, of_b) = (&plan.sections[a], &plan.sections[b]);
    for (m, mark) in of_a.marks.iter().enumerate() {
        let same = of_b.marks.iter().position(|other| other.name == mark.name);
        if let Some(other) = same
            && plan.singular[mark.name]
            && of_a.on[m]
        {
            let ends = (builder.mark((a, of_a), m), builder.mark((b, of_b), other));
            builder.segment(ends.0, ends.1);
        }
    }
}

/// Three random real forms.
fn forms(context: &Context<'_>, number: u32) -> [Vec<[i32; 2]>; 3] {
    let index = (1 << 51) | u64::from(number);
    let mut random = RandomStream::new(context.problem.seed(), Purpose::Question, index);
    let mut part = || {
        let size = 200 + random.below(800) as i32;
        if random.below(2) == 0 { size } else { -size }
    };
    loop {
        let forms = [(); 3].map(|()| (0..3).map(|_| [part(), 0]).collect::<Vec<_>>());
        // Not nearly dependent.
        if determinant(&forms).abs() > 1.5e8 {
            return forms;
        }
    }
}

fn determinant(forms: &[Vec<[i32; 2]>; 3]) -> f64 {
    let at = |i: usize, j: usize| f64::from(forms[i][j % 3][0]);
    let minors =
        (0..3).map(|j| at(0, j) * (at(1, j + 1) * at(2, j + 2) - at(1, j + 2) * at(2, j + 1)));
    minors.sum()
}

/// The unknowns by the values of the forms.
fn inverse(forms: &[Vec<[i32; 2]>; 3]) -> [[f64; 3]; 3] {
    let at = |i: usize, j: usize| f64::from(forms[i % 3][j % 3][0]);
    let determinant_of_forms = determinant(forms);
    [0, 1, 2].map(|j| {
        [0, 1, 2].map(|i| {
            (at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1))
                / determinant_of_forms
        })
    })
}

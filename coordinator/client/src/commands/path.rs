//! `cognate path`: one path again, in this process, step by step.
//!
//! A path's result is a pure function of the problem and its number, so this
//! is the path that a job tracked, bit for bit; where a job puts it aside, it is followed to its end here.

use crate::arguments::{Format, TracePath};
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::drawing;
use crate::output::text::{Columns, Look, complex, counted, magnitude, real};
use crate::problem;
use cognate_algorithms::plan::PLANNING_OPERATIONS;
use cognate_algorithms::start_costs::{StartCosts, StartKind};
use cognate_algorithms::{Next, PathAlgorithm};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::observer::StepEvent;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::work::Work;
use cognate_coordinator::intake;
use cognate_coordinator::jobs::planning::plan_job;
use cognate_solutions::classification::{Tolerances, Verdict, classify};
use cognate_solutions::point_shape::PointShape;
use cognate_systems::system::System;
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

/// One path with its steps and its result.
struct Traced {
    system: System,
    start: String,
    paths: u64,
    result: PathResult,
    steps: Vec<StepEvent>,
    verdict: Verdict,
    values: Option<Vec<num_complex::Complex64>>,
}

/// Tracks the path and shows it.
pub fn run(a: &TracePath) -> Result<Exit, ClientError> {
    let mut prepared = problem::prepare(&a.problem)?;
    prepared.refuse_other_run(&[])?;
    prepared.refuse_objective()?;
    prepared.leave_conditions("a path is shown whether its end meets them or not");
    for warning in &prepared.submission.options.warnings {
        eprintln!("warning: {warning}");
    }
    let name = prepared.name.clone();
    let traced = trace(prepared, a.index)?;
    let drawing = if a.trace {
        let path = a
            .svg
            .clone()
            .unwrap_or_else(|| PathBuf::from(format!("path_{}.svg", a.index)));
        let title = format!("{name}, path {}", a.index);
        let svg = drawing::path(&title, &traced.steps);
        std::fs::write(&path, svg).map_err(|source| ClientError::File {
            action: "cannot write",
            path: path.clone(),
            source,
        })?;
        Some(path)
    } else {
        None
    };
    let text = match a.format {
        Format::Json => {
            let answer = json!({
                "path": a.index,
                "verdict": verdict_name(traced.verdict),
                "result": traced.result,
                "steps": if a.trace { json!(traced.steps) } else { json!(null) },
                "svg": drawing,
            });
            format!("{answer:#}\n")
        }
        Format::Table => {
            let look = Look::of_standard_output();
            let mut text = summary(&name, &traced, look);
            if a.trace {
                text.push('\n');
                text.push_str(&steps(&traced.steps, look));
            }
            if let Some(path) = drawing {
                let _ = writeln!(text, "\n  drawn in {}", path.display());
            }
            text
        }
    };
    output::print(&text)?;
    Ok(match traced.verdict {
        Verdict::Failed => Exit::Unsettled,
        _ => Exit::Solved,
    })
}

/// The refusal of a start without paths; it names the starts that have some.
fn without_paths(start: StartKind, system: &System) -> ClientError {
    let costs = StartCosts::of(system).ok();
    let counts = costs.map(|costs| {
        [
            (StartKind::TotalDegree, costs.total_degree),
            (StartKind::Multihomogeneous, costs.multihomogeneous.number),
            (StartKind::Polyhedral, costs.mixed_volume),
        ]
    });
    let counts = counts.into_iter().flatten();
    let with_paths = counts.filter_map(|(kind, paths)| {
        let paths = paths.filter(|paths| *paths > 0)?;
        Some(format!("--start {kind} has {}", counted(paths, "path")))
    });
    let with_paths: Vec<String> = with_paths.collect();
    ClientError::Input {
        origin: "--index".into(),
        message: match with_paths.is_empty() {
            true => format!("the {start} start solves this problem without paths"),
            false => format!(
                "the {start} start solves this problem without paths; {}",
                with_paths.join(", ")
            ),
        },
    }
}

fn trace(prepared: problem::Prepared, index: u64) -> Result<Traced, ClientError> {
    let wrong = |e: &dyn std::fmt::Display| ClientError::Input {
        origin: prepared.name.clone(),
        message: e.to_string(),
    };
    let taken = intake::take(prepared.submission.clone()).map_err(|e| wrong(&e))?;
    let start = taken.start_solutions.as_deref();
    let mut plan = plan_job(&taken.system, &taken.options, start, PLANNING_OPERATIONS)
        .map_err(|e| wrong(&e))?;
    let opening = loop {
        let Next::Open(opening) = plan.algorithm.next() else {
            return Err(match plan.algorithm.failure() {
                Some(why) => ClientError::Local(why),
                None => without_paths(plan.start, &taken.system),
            });
        };
        if opening.stage.work != Work::CountMixedCells {
            break opening;
        }
        // The paths of this stage are not numbered before all mixed cells are counted.
        let counting =
            PreparedWork::new(&plan.system, &opening.stage, &|_| None).map_err(|e| wrong(&e))?;
        let mut counts = counting.run(0..counting.items(), 1).into_iter();
        plan.algorithm.absorb(opening.stage.id, &mut counts);
    };
    let paths = plan.paths.or(opening.stage.items()).unwrap_or_default();
    if index >= paths {
        return Err(ClientError::Input {
            origin: "--index".into(),
            message: format!(
                "there is no path {index}: the {} start has paths 0 to {}",
                plan.start,
                paths.saturating_sub(1)
            ),
        });
    }
    let points = match start {
        None => None,
        Some(bytes) => Some(Arc::new(
            StoredPoints::from_bytes(bytes).map_err(|e| wrong(&e))?,
        )),
    };
    // A first stage asks for its own objects, or else for the start solutions.
    let objects = |wanted: Digest| opening.object(wanted).or_else(|| points.clone());
    let mut stage = opening.stage.clone();
    stage.settings.max_endgame_bits = u32::MAX;
    let stage = PreparedStage::new(&plan.system, &stage, &objects).map_err(|e| wrong(&e))?;
    let (result, steps) = stage.trace(index);
    let shape = PointShape::of(&plan.system);
    let verdict = classify(&result, &shape, &Tolerances::default()).verdict;
    let finite = verdict == Verdict::Finite || verdict.may_be_multiple();
    let values = finite.then(|| shape.to_variables(result.endpoint.to_double()));
    Ok(Traced {
        start: plan.start.to_string(),
        paths,
        system: plan.system,
        result,
        steps,
        verdict,
        values,
    })
}

/// A verdict, as the classes of the result table are called.
fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Failed => "failed",
        Verdict::AtInfinity => "at infinity",
        Verdict::Removed => {
            "removed: a denominator of the given equations is 0, or a root is on a false branch"
        }
        Verdict::ExcessSolution => "excess: no solution before randomisation",
        Verdict::PositiveDimensional => "on a positive-dimensional set",
        Verdict::Undecided => "singular; whether it is isolated is asked of all paths together",
        Verdict::WithinDataAccuracy => "of another class within the accuracy of the data",
        Verdict::Singular => "singular",
        Verdict::Finite => "finite",
    }
}

/// Width of the column of names.
const LABEL: usize = 18;

fn summary(name: &str, traced: &Traced, look: Look) -> String {
    let r = &traced.result;
    let verdict = verdict_name(traced.verdict);
    let mut text = format!(
        "{} {}: {}\n\n",
        look.bold(name),
        look.bold(&format!("path {}", r.origin.0)),
        match traced.verdict {
            Verdict::Failed => look.bad(verdict),
            _ => look.good(verdict),
        }
    );
    let mut line = |label: &str, content: String| {
        let _ = writeln!(text, "  {label:<LABEL$}{content}");
    };
    line(
        "start",
        format!("{}, one of {}", traced.start, counted(traced.paths, "path")),
    );
    if let PathOutcome::Failed(why) = r.outcome {
        line("why", why.describe().into());
        line("stopped at t =", complex(r.t, 6, 0.0));
    }
    line("residual", magnitude(r.residual));
    line("condition", magnitude(r.condition));
    line("accuracy", magnitude(r.accuracy));
    if let Some(winding) = r.winding_number {
        line("winding number", winding.to_string());
    }
    let c = &r.counts;
    line(
        "work",
        format!(
            "{}, {} rejected, {}",
            counted(u64::from(c.steps), "step"),
            c.rejections,
            counted(u64::from(c.evaluations), "evaluation")
        ),
    );
    if let Some(values) = &traced.values {
        let names = &traced.system.variables;
        let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
        text.push('\n');
        for (name, z) in names.iter().zip(values) {
            let part = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
            let z = num_complex::Complex64::new(part(z.re), part(z.im));
            let _ = writeln!(text, "  {name:<width$} = {}", complex(z, 15, 0.0));
        }
    }
    text
}

/// Every attempted step in a line.
fn steps(steps: &[StepEvent], look: Look) -> String {
    let mut columns = Columns::new(&[
        ">STEP",
        "PHASE",
        "T",
        ">LENGTH",
        ">BITS",
        "",
        ">PREDICTOR ERROR",
        ">CORRECTION",
    ]);
    for (i, s) in steps.iter().enumerate() {
        columns.row(vec![
            (i + 1).to_string(),
            s.phase.to_string(),
            complex(s.t, 6, 0.0),
            real(s.step, 3),
            s.precision_bits.to_string(),
            if s.accepted { "" } else { "rejected" }.into(),
            magnitude(s.predictor_error),
            magnitude(s.correction),
        ]);
    }
    columns.render(look)
}

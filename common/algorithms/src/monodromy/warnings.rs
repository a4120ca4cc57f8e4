//! Warnings of what the end of the loops leaves open, and the claim about missing solutions.

use super::counts::{LoopCounts, Stop};
use super::estimate;
use super::graph::BASE;
use super::search::{LoopSearch, Symmetry};
use super::trace::MOST_DEVIATION;
use crate::completeness_claim::CompletenessClaim;
use crate::limits::MAX_PATHS;
use cognate_numeric::counted::counted;

/// How likely loops in a row leave the one orbit alone that is not known beside `known_orbits` others,
/// where each permutes all of them at random: one of known_orbits + 1 does.
pub(super) fn probability_of_hiding(known_orbits: u64, loops: u64) -> f64 {
    let each = 1.0 / (known_orbits as f64 + 1.0);
    (0..loops).fold(1.0, |product, _| product * each)
}

/// Warning that a declared symmetry is not used.
pub(super) fn of_symmetry(search: &LoopSearch) -> Option<String> {
    match &search.symmetry {
        Symmetry::Refused(reason) => Some(format!("the symmetry group is not used: {reason}")),
        Symmetry::Unchecked(_) | Symmetry::InUse => None,
    }
}

/// Warnings of a search that has ended with solutions.
pub(super) fn of_end(search: &LoopSearch) -> Vec<String> {
    let stop = of_stop(search);
    stop.into_iter()
        .chain(of_trace_test(search))
        .chain(of_classes(search))
        .collect()
}

/// Warning of what the reason of the stop leaves open.
fn of_stop(search: &LoopSearch) -> Option<String> {
    let counts = &search.counts;
    let solutions = counted(counts.solutions, "solution");
    let idle_loops = counted(counts.idle_loops, "loop");
    Some(match counts.stop? {
        Stop::Confidence => format!(
            "monodromy found {solutions} at generic parameters; if loops permute all solutions \
             at random, as they permute the known ones, that is all with a probability of {}: \
             evidence, but no proof",
            estimate::percent(counts.estimate.as_ref().map_or(0.0, |e| e.confidence)),
        ),
        Stop::IdleLoops => match search.limits.count {
            Some(wanted) => format!(
                "{} asked for; monodromy found {}, and {idle_loops} more brought nothing new",
                counted(wanted, "solution"),
                counts.solutions,
            ),
            None => {
                let evidence = if failed_trace_test(counts).is_some() {
                    String::new()
                } else {
                    evidence(counts)
                };
                format!(
                    "monodromy found {solutions} at generic parameters, and {idle_loops} more \
                     brought nothing new{evidence}"
                )
            }
        },
        Stop::PathLimit => {
            format!("loops ended at the limit of {MAX_PATHS} paths: solutions may be missing")
        }
        Stop::Count | Stop::TraceTest | Stop::NoStart => return None,
    })
}

/// Distance from a line and number of points of a trace test that says that solutions are missing.
fn failed_trace_test(counts: &LoopCounts) -> Option<(f64, u64)> {
    let test = counts.trace_test.as_ref()?;
    let deviation = test.deviation.filter(|&off| off > MOST_DEVIATION)?;
    Some((deviation, test.points))
}

/// Warning of a trace test that failed or did not come to an end.
fn of_trace_test(search: &LoopSearch) -> Option<String> {
    if let Some((deviation, points)) = failed_trace_test(&search.counts) {
        return Some(format!(
            "the trace test failed: the sum of {points} points is off a line by {deviation:.0e} of \
             their size, so that solutions are missing"
        ));
    }
    let has_no_proof = matches!(
        search.counts.stop,
        Some(Stop::IdleLoops | Stop::Confidence | Stop::PathLimit)
    );
    (has_no_proof && search.trace_test.is_some()).then(|| {
        "the trace test did not come to an end: a path of it was lost, or loops do not \
         reach a solution that it found"
            .to_string()
    })
}

/// Warning that more classes are known at another place than at the base.
fn of_classes(search: &LoopSearch) -> Option<String> {
    let base_points = search.graph.base_points().len();
    let others = search.graph.vertices[BASE + 1..].iter();
    let most = others.map(|vertex| vertex.points.len()).max()?;
    (most > base_points && search.counts.stop != Some(Stop::Count)).then(|| {
        format!(
            "at other generic parameters {most} classes of solutions were counted, at the base \
             {base_points}: some are missing, or one was counted twice where a map of the symmetry \
             is badly conditioned"
        )
    })
}

/// Evidence of idle loops for completeness, as the end of a sentence.
fn evidence(counts: &LoopCounts) -> String {
    let moving = counts.idle_moving;
    if counts.classes == 1 {
        ": loops cannot move a single solution, so that they say nothing about others".to_string()
    } else if counts.are_mixing() {
        format!(
            "; {moving} of them moved known solutions. If loops permute all solutions at random, \
             as they permute the known ones, one is missing with a probability of {:.0e} at most: \
             evidence, but no proof",
            probability_of_hiding(counts.classes, moving)
        )
    } else {
        format!(
            "; {moving} of them moved known solutions, and loops do not permute these as random \
             ones do (they leave {:.1} in place on average): that is no evidence that none is missing",
            counts.mixing.fixed.unwrap_or(0.0)
        )
    }
}

/// Whether all solutions that loops can connect are known: `None` while loops are made. `expected` is the number that the
/// user expects.
pub(super) fn completeness(
    counts: &LoopCounts,
    expected: Option<u64>,
) -> Option<CompletenessClaim> {
    let solutions = counted(counts.solutions, "solution");
    let missing = expected.filter(|expected| *expected > counts.solutions);
    Some(match (counts.stop?, missing) {
        (Stop::Count, _) => CompletenessClaim::yes(format!("{solutions} were asked for")),
        (Stop::TraceTest, _) => CompletenessClaim::yes(format!(
            "the trace test says that loops connect no others with these {}, which are all where \
             the solutions of all members are one irreducible set",
            counts.solutions
        )),
        (Stop::IdleLoops | Stop::Confidence | Stop::PathLimit, Some(expected)) => {
            CompletenessClaim::no(format!(
                "{} expected, and loops found {}",
                counted(expected, "solution"),
                counts.solutions
            ))
        }
        (Stop::IdleLoops | Stop::Confidence, None) => CompletenessClaim::not_known(format!(
            "loops found {solutions} at generic parameters, and nothing proves that they reach all; \
             --trace-test asks, --expect says how many there are"
        )),
        (Stop::PathLimit, None) => {
            CompletenessClaim::not_known(format!("loops ended at the limit of {MAX_PATHS} paths"))
        }
        (Stop::NoStart, _) => {
            CompletenessClaim::not_known("no start solution could be followed".to_string())
        }
    })
}

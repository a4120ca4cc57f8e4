//! How a trace test ends loops: what it needs is tracked beside them, or by a solve of its own.

use super::counts::{Stop, Tested, TraceCounts, TraceForm};
use super::estimate;
use super::graph::Known;
use super::trace::{Curve, MOST_DEVIATION, Pencil, Test, deviation};
use super::{BASE, LoopStart, MonodromySolve, Phase, edge_seed};
use crate::completeness_claim::CompletenessClaim;
use crate::limits::MAX_PATHS;
use cognate_continuation::start_points::StoredPoints;
use cognate_numeric::counted::counted;
use cognate_solutions::symmetry::SymmetryGroup;
use num_complex::Complex64;

/// Least |lambda| of a point that does not lie at the parameters where a curve begins.
const NOT_THERE: f64 = 1e-9;

/// How likely loops in a row leave the one orbit alone that is not known beside `known_orbits` others,
/// where each permutes all of them at random: one of known_orbits + 1 does.
pub(super) fn probability_of_hiding(known_orbits: usize, loops: u64) -> f64 {
    let each = 1.0 / (known_orbits as f64 + 1.0);
    (0..loops).fold(1.0, |product, _| product * each)
}

impl MonodromySolve {
    /// Asks whether all is known, when nothing is left to track. `exhausted`: loops would end now.
    pub(super) fn test_completeness(&mut self, exhausted: bool) -> Tested {
        let base_points = self.graph.vertices[BASE].points.len();
        let said = self.counts.trace_test.as_ref();
        if self.tested == Some(base_points) {
            return match said.is_some_and(|said| said.complete) {
                true => Tested::Complete,
                false => Tested::No,
            };
        }
        match self.test.clone() {
            None => Tested::No,
            Some(Test::Pencil { moved: None, .. }) if self.counts.loops == 0 => Tested::No,
            Some(Test::Pencil {
                pencil,
                moved: None,
            }) => {
                self.move_slices(pencil);
                Tested::Begun
            }
            Some(Test::Pencil {
                pencil,
                moved: Some(moved),
            }) => {
                let counts = self.trace_of(&pencil, moved);
                let complete = counts.complete;
                self.counts.trace_test = Some(counts);
                self.tested = Some(base_points);
                match complete {
                    true => Tested::Complete,
                    false => Tested::No,
                }
            }
            Some(Test::Curve(_)) if !exhausted => Tested::No,
            Some(Test::Curve(curve)) => {
                self.phase = Phase::Sections(Box::new(self.on_sections(*curve)));
                Tested::Begun
            }
        }
    }

    /// Two vertices at equal distances, and on a curve the one where it began.
    fn move_slices(&mut self, pencil: Pencil) {
        let base = self.graph.vertices[BASE].parameters.clone();
        let size = |z: &Complex64| z.norm_sqr().sqrt();
        let scale = base.iter().map(size).fold(0.0, f64::max);
        let moved = [1.0, 2.0].map(|times| {
            let steps = base.iter().zip(&pencil.direction);
            let there = steps.map(|(p, d)| p + d * (times * scale)).collect();
            self.lead_to(there)
        });
        if self.curve.is_some() {
            self.lead_to(self.start.parameters.clone());
        }
        self.test = Some(Test::Pencil {
            pencil,
            moved: Some(moved),
        });
    }

    /// Whether a vertex serves the trace test only.
    pub(super) fn is_beside(&self, vertex: usize) -> bool {
        let moved = match self.test {
            Some(Test::Pencil { moved, .. }) => moved,
            Some(Test::Curve(_)) | None => None,
        };
        let last = |moved: [usize; 2]| moved[1] + usize::from(self.curve.is_some());
        moved.is_some_and(|moved| (moved[0]..=last(moved)).contains(&vertex))
    }

    /// A vertex with one edge from the base.
    fn lead_to(&mut self, parameters: Vec<Complex64>) -> usize {
        let vertex = self.graph.add_vertex(parameters);
        let seed = edge_seed(self.seed, self.graph.edges.len());
        self.graph.add_edge(BASE, vertex, seed, true);
        vertex
    }

    /// The points that all of the base lead to there, orbit by orbit; `None` where one is lost.
    fn led_to(&self, vertex: usize) -> Option<Vec<Vec<Complex64>>> {
        let edges = &self.graph.edges;
        let edge = edges.iter().position(|edge| edge.ends[1] == vertex)?;
        let reached = self.graph.reached(edge)?;
        Some(reached.iter().flat_map(|point| self.orbit(point)).collect())
    }

    /// The sums at the base and at the two places beside it.
    pub(super) fn trace_of(&self, pencil: &Pencil, moved: [usize; 2]) -> TraceCounts {
        let base = &self.graph.vertices[BASE].points;
        let here: Vec<_> = base.iter().flat_map(|point| self.orbit(point)).collect();
        let ways = moved.map(|vertex| self.led_to(vertex));
        let back = self.curve.is_none() || self.led_to(moved[1] + 1).is_some();
        let bent = match &ways {
            [Some(one), Some(two)] if back => Some(deviation([&here, one, two], pencil)),
            _ => None,
        };
        TraceCounts {
            form: TraceForm::Slices,
            points: here.len() as u64,
            deviation: bent.filter(|bent| bent.is_finite()),
            complete: bent.is_some_and(|bent| bent <= MOST_DEVIATION),
        }
    }

    /// Loops among the sections of the curve, from all that is known at the base.
    fn on_sections(&self, curve: Curve) -> MonodromySolve {
        let arriving_points = self.arriving_points();
        let mut coordinates = Vec::new();
        for k in 0..arriving_points.len() {
            coordinates.extend_from_slice(arriving_points.point(k));
            coordinates.push(Complex64::default());
        }
        let points = StoredPoints {
            dimension: arriving_points.dimension + 1,
            coordinates,
        };
        let start = LoopStart {
            parameters: curve.known.clone(),
            points: points.as_start(),
            count: points.len() as u64,
            found: Some(points.coordinates),
        };
        let mut limits = self.limits;
        limits.count = None;
        let mut inner = Self::begin(
            curve.shape.clone(),
            SymmetryGroup::trivial(),
            start,
            limits,
            self.settings.clone(),
            self.tolerances.clone(),
            edge_seed(self.seed, usize::MAX - 1),
        );
        inner.max_retries = self.max_retries;
        inner.test = Some(Test::Pencil {
            pencil: curve.pencil.clone(),
            moved: None,
        });
        inner.curve = Some(Box::new(curve));
        inner
    }

    /// Takes in the result of the loops among the sections. Solutions that they found are known from then on.
    pub(super) fn take_in_sections(&mut self) {
        let Phase::Sections(inner) = std::mem::replace(&mut self.phase, Phase::Loops(Vec::new()))
        else {
            unreachable!("it is asked for in this phase only");
        };
        let (counts, of_inner) = (&mut self.counts, inner.counts());
        counts.tracked += of_inner.tracked;
        counts.lost += of_inner.lost;
        counts.crossings_found += of_inner.crossings_found;
        counts.crossings_resolved += of_inner.crossings_resolved;
        let base_solutions = inner.solutions_found();
        let new = (self.graph).learn(BASE, &base_solutions, &self.group, &self.shape, self.seed);
        self.counts.solutions = self.count_solutions();
        let whole = new == 0 && base_solutions.len() as u64 == self.counts.solutions;
        let form = self.test.as_ref().map(Test::form);
        self.counts.trace_test = of_inner.trace_test.clone().map(|said| TraceCounts {
            form: form.unwrap_or(said.form),
            complete: of_inner.stop == Some(Stop::TraceTest) && whole,
            ..said
        });
        self.stages.extend(inner.stages.iter().copied());
        self.tested = (new == 0).then(|| self.graph.vertices[BASE].points.len());
    }

    /// Points of a curve at the parameters where the curve begins, without the curve's own coordinate.
    fn solutions_found(&self) -> Vec<Known> {
        let Some(Test::Pencil {
            moved: Some([_, last]),
            ..
        }) = self.test
        else {
            return Vec::new();
        };
        let edges = &self.graph.edges;
        let back = edges.iter().position(|edge| edge.ends[1] == last + 1);
        let reached = back.and_then(|edge| self.graph.reached(edge));
        let there = reached.unwrap_or_default().into_iter().filter(|point| {
            let lambda = point.values.last().copied().unwrap_or_default();
            lambda.norm_sqr().sqrt() < NOT_THERE
        });
        let without = there.map(|point| Known {
            values: point.values[..point.values.len() - 1].to_vec(),
            radius: point.radius,
        });
        without.collect()
    }

    /// Warns of what the end of the loops leaves open.
    pub(super) fn warn_of_the_end(&mut self) {
        let counts = &self.counts;
        let base_points = self.graph.vertices[BASE].points.len();
        let mut warnings = Vec::new();
        let bent = counts.trace_test.as_ref().filter(|test| {
            let off = test.deviation;
            off.is_some_and(|off| off > MOST_DEVIATION)
        });
        match counts.stop {
            Some(Stop::Confidence) => warnings.push(format!(
                "monodromy found {} at generic parameters; if loops permute all solutions \
                 at random, as they permute the known ones, that is all with a probability of {}: \
                 evidence, but no proof",
                counted(counts.solutions, "solution"),
                estimate::percent(counts.estimate.as_ref().map_or(0.0, |e| e.confidence)),
            )),
            Some(Stop::IdleLoops) => warnings.push(match (self.limits.count, bent) {
                (Some(wanted), _) => format!(
                    "{} asked for; monodromy found {}, and {} more brought nothing new",
                    counted(wanted, "solution"),
                    counts.solutions,
                    counted(counts.idle_loops, "loop")
                ),
                (None, Some(_)) => format!(
                    "monodromy found {} at generic parameters, and {} more brought nothing new",
                    counted(counts.solutions, "solution"),
                    counted(counts.idle_loops, "loop")
                ),
                (None, None) => format!(
                    "monodromy found {} at generic parameters, and {} more brought nothing new{}",
                    counted(counts.solutions, "solution"),
                    counted(counts.idle_loops, "loop"),
                    self.evidence()
                ),
            }),
            Some(Stop::PathLimit) => warnings.push(format!(
                "loops ended at the limit of {MAX_PATHS} paths: solutions may be missing"
            )),
            _ => {}
        }
        let ended = matches!(
            counts.stop,
            Some(Stop::IdleLoops | Stop::Confidence | Stop::PathLimit)
        );
        if let Some(test) = bent {
            warnings.push(format!(
                "the trace test failed: the sum of {} points is off a line by {:.0e} of their size, \
                 so that solutions are missing",
                test.points,
                test.deviation.unwrap_or_default()
            ));
        } else if ended && self.test.is_some() {
            warnings.push(
                "the trace test did not come to an end: a path of it was lost, or loops do not \
                 reach a solution that it found"
                    .to_string(),
            );
        }
        let more = self.graph.vertices[BASE + 1..].iter();
        let most = more.map(|vertex| vertex.points.len()).max().unwrap_or(0);
        if most > base_points && counts.stop != Some(Stop::Count) {
            warnings.push(format!(
                "at other generic parameters {most} classes of solutions were counted, at the base \
                 {base_points}: some are missing, or one was counted twice where a map of the symmetry \
                 is badly conditioned"
            ));
        }
        self.warnings.extend(warnings);
    }

    /// Evidence of idle loops for completeness, as the end of a sentence.
    fn evidence(&self) -> String {
        let counts = &self.counts;
        let base_points = self.graph.vertices[BASE].points.len();
        if base_points == 1 {
            return ": loops cannot move a single solution, so that they say nothing about others"
                .into();
        }
        match self.is_mixing() {
            true => format!(
                "; {} of them moved known solutions. If loops permute all solutions at random, as \
                 they permute the known ones, one is missing with a probability of {:.0e} at most: \
                 evidence, but no proof",
                counts.idle_moving,
                probability_of_hiding(base_points, counts.idle_moving)
            ),
            false => format!(
                "; {} of them moved known solutions, and loops do not permute these as random ones \
                 do (they leave {:.1} in place on average): that is no evidence that none is missing",
                counts.idle_moving,
                counts.mixing.fixed.unwrap_or(0.0)
            ),
        }
    }

    /// Whether all solutions that loops can connect are known: `None` while loops are made.
    pub fn completeness(&self) -> Option<CompletenessClaim> {
        let solution_count = self.counts.solutions;
        Some(match self.counts.stop? {
            Stop::Count => {
                CompletenessClaim::yes(format!("{solution_count} solutions were asked for"))
            }
            Stop::TraceTest => CompletenessClaim::yes(format!(
                "the trace test says that loops connect no others with these {solution_count}"
            )),
            Stop::IdleLoops | Stop::Confidence => CompletenessClaim::not_known(format!(
                "loops found {solution_count} solutions at generic parameters, and nothing proves that they \
                 reach all; --trace-test asks, --expect says how many there are"
            )),
            Stop::PathLimit => CompletenessClaim::not_known(format!(
                "loops ended at the limit of {MAX_PATHS} paths"
            )),
            Stop::NoStart => {
                CompletenessClaim::not_known("no start solution could be followed".to_string())
            }
        })
    }
}

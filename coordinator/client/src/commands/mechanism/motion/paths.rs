//! Paths: the degree of the curve, or other set, that a point of a link draws in each mode.

use super::meetings::SIDE_BY_SIDE;
use super::{TRACED, Work};
use crate::commands::question;
use crate::error::ClientError;
use cognate_kinematics::compile::formulation::PathText;
use cognate_kinematics::compile::text::Equations;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::point_shape::{largest, modulus};
use cognate_solutions::witness::Question;
use cognate_solutions::witness::question::SecondSet;
use cognate_summary::question_answer::QuestionAnswer;
use cognate_systems::evaluation;
use cognate_systems::formats;
use cognate_systems::system::System;
use cognate_systems::transform::join;
use futures::StreamExt;
use num_complex::Complex64;

/// Planes that must cut a path in the same number of points.
const PLANES: u64 = 2;
/// Largest distance of two points of a path, relative to their size, at which they are one point.
const SAME: f64 = 1e-7;
/// Smallest distance of two points of a path, relative to their size, at which they are two points.
const OTHER: f64 = 1e-5;
/// A factor with which an unknown is added to expressions that may have none.
const OFF: i32 = 7;
/// Largest square of a quaternion that counts as 0, as a part of the coordinates' squares.
const ZERO: f64 = 1e-7;
/// Smallest square of a quaternion that does not count as 0, as a part of the coordinates' squares.
const NOT_ZERO: f64 = 1e-5;

/// How many points of a path are on a plane.
struct Cut {
    points: Option<u64>,
    doubt: Option<String>,
}

impl Cut {
    fn in_doubt(reason: impl Into<String>) -> Self {
        Self {
            points: None,
            doubt: Some(reason.into()),
        }
    }
}

impl Work<'_> {
    /// Degrees of the path in all modes.
    pub(super) async fn find_path_degrees(&mut self) -> Result<(), ClientError> {
        if self.asked.traces {
            return self.project().await;
        }
        let Some(path) = self.asked.motion.path.clone() else {
            return Ok(());
        };
        let curves = (0..self.components.len()).filter(|k| self.answer.modes[*k].dimension == 1);
        let curves: Vec<usize> = curves.collect();
        for place in (0..self.components.len()).filter(|k| !curves.contains(k)) {
            let id = self.answer.modes[place].id.clone();
            self.doubt(format!(
                "mode {id} has more than one freedom: the degree of what the point sweeps is not in this version"
            ));
        }
        let planes = curves
            .iter()
            .flat_map(|place| (0..PLANES).map(move |number| (*place, number)));
        let cuts = planes.map(|(place, number)| self.points_on_plane(place, &path, number));
        let cuts = futures::stream::iter(cuts).buffered(SIDE_BY_SIDE);
        let cuts: Vec<Result<Cut, ClientError>> = cuts.collect().await;
        let cuts = cuts.into_iter().collect::<Result<Vec<Cut>, _>>()?;
        for (place, cuts) in curves.into_iter().zip(cuts.chunks(PLANES as usize)) {
            let first = cuts[0].points;
            if first.is_some() && cuts.iter().all(|cut| cut.points == first) {
                // A point that stays where it is draws a point.
                self.answer.modes[place].path_degree = first.map(|points| points.max(1));
                continue;
            }
            let id = self.answer.modes[place].id.clone();
            let counts: Vec<Option<u64>> = cuts.iter().map(|cut| cut.points).collect();
            let reasons: Vec<&str> = cuts.iter().filter_map(|cut| cut.doubt.as_deref()).collect();
            self.doubt(format!(
                "the degree of the path in mode {id} is not clear: planes cut it in {counts:?} points; {}",
                reasons.join("; ")
            ));
        }
        Ok(())
    }

    /// Degrees where the point's coordinates are unknowns of the decomposition.
    async fn project(&mut self) -> Result<(), ClientError> {
        let variables = &self.asked.system.variables;
        let place = |name: &str| variables.iter().position(|v| v == name);
        let onto = TRACED.iter().filter_map(|name| place(name));
        let onto = onto.map(|place| place as u32).collect();
        let set = self.only(&self.components);
        let question = Question::Project { onto };
        let Some(QuestionAnswer::Project(images)) = self.ask(&set, question).await? else {
            return Ok(());
        };
        for image in images.components {
            if let Some(place) = self.mode_of(&image.id) {
                self.answer.modes[place].path_degree = image.degree;
            }
        }
        Ok(())
    }

    /// The number of points in which a general plane, or line in the plane, cuts the path in a mode; `None` in doubt.
    async fn points_on_plane(
        &self,
        place: usize,
        path: &PathText,
        number: u64,
    ) -> Result<Cut, ClientError> {
        let mut set = self.only(&[self.components[place]]);
        let equation_count = set.system.equations.len();
        let plane = plane(path, self.wishes.seed, number);
        let plane = self.system_of(vec![plane])?;
        let joined = join(&set.system, &plane);
        set.system = joined.map_err(|e| ClientError::GaveUp(e.to_string()))?;
        let equation_count = u32::try_from(equation_count).unwrap_or(u32::MAX);
        let second = SecondSet {
            own: equation_count,
            from: equation_count,
            components: Vec::new(),
        };
        let prepared = question::prepared(self.wishes.preset, &set, Question::Intersect(second))?;
        let (summary, common) = match self.jobs.decompose(prepared, None).await {
            Ok(common) => common,
            Err(ClientError::GaveUp(message) | ClientError::Refused(message)) => {
                return Ok(Cut::in_doubt(message));
            }
            Err(error) => return Err(error),
        };
        let mut coordinates = path.coordinates.clone();
        coordinates.push(path.denominator.clone());
        // Expressions without an unknown are no equations: one is added, and taken off the values. Those in homogeneous
        // unknowns have some.
        let off = match self.asked.equations.homogeneous {
            true => 0,
            false => OFF,
        };
        let first = self.asked.system.variables[0].clone();
        let shifted = coordinates.iter().map(|x| format!("({x})+{off}*{first}"));
        let coordinates = self.system_of(shifted.collect())?;
        let mut images = Vec::new();
        for component in &common.components {
            let point = &component.set.points[0];
            let values =
                evaluation::values(&coordinates.expressions, &coordinates.equations, point, &[]);
            let values: Vec<Complex64> = values
                .iter()
                .map(|x| x - f64::from(off) * point[0])
                .collect();
            let (denominator, numerators) = values.split_last().expect("there is a denominator");
            if self.asked.equations.homogeneous {
                match modulus(*denominator) / largest(point).powi(2) {
                    part if part < ZERO => continue,
                    part if part < NOT_ZERO => {
                        return Ok(Cut::in_doubt(
                            "whether a point on a plane is a pose is not clear",
                        ));
                    }
                    _ => {}
                }
            }
            if component.set.dimension() > 0 {
                return Ok(Cut::in_doubt("a plane holds the path"));
            }
            // A general plane cuts a mode that is not multiple in regular points, but where there is no pose, at points that
            // all planes share (Bertini's theorem): multiple ends in doubt are no points of the path.
            if !component.set.settled() {
                return Ok(Cut::in_doubt("a point on a plane is not settled"));
            }
            images.push(numerators.iter().map(|x| x / denominator).collect());
        }
        let lost: u64 = summary
            .decomposition
            .by_dimension
            .values()
            .map(|d| d.failed)
            .sum();
        if summary.paths.superset.failed + lost > 0 {
            return Ok(Cut::in_doubt("paths to a plane failed"));
        }
        if self.answer.modes[place].multiplicity != Some(1) && !summary.settled {
            return Ok(Cut::in_doubt("points of a multiple mode are in doubt"));
        }
        Ok(match different(&images) {
            Some(points) => Cut {
                points: Some(points),
                doubt: None,
            },
            None => Cut::in_doubt("points on a plane are neither equal nor different"),
        })
    }

    /// Expressions in the unknowns of the decomposition as a system.
    fn system_of(&self, expressions: Vec<String>) -> Result<System, ClientError> {
        let equations = Equations {
            equations: expressions,
            degenerate: Vec::new(),
            conjugates: Vec::new(),
            symmetry: Vec::new(),
            ..self.asked.equations.clone()
        };
        let read = formats::read("the path", equations.json().as_bytes());
        let read = read.map_err(|e| ClientError::Format(e.to_string()))?;
        Ok(read.system)
    }
}

/// A general plane for the point, as an equation in the unknowns.
fn plane(path: &PathText, seed: u64, number: u64) -> String {
    let mut random = RandomStream::new(seed, Purpose::Question, number);
    let mut coefficient = || {
        let k = random.below(1801) as i64 - 900;
        format!("({}/997)", if k == 0 { 1 } else { k })
    };
    let mut terms: Vec<String> = path
        .coordinates
        .iter()
        .map(|x| format!("{}*({x})", coefficient()))
        .collect();
    terms.push(format!("{}*({})", coefficient(), path.denominator));
    terms.join("+")
}

/// The number of different points; `None` where two are neither equal nor different.
fn different(points: &[Vec<Complex64>]) -> Option<u64> {
    let mut distinct_points: Vec<&Vec<Complex64>> = Vec::new();
    for point in points {
        let size = point.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
        let gap = |other: &&Vec<Complex64>| {
            let pairs = point.iter().zip(other.iter());
            let square = pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>();
            square.sqrt() / size.max(1.0)
        };
        match distinct_points
            .iter()
            .map(gap)
            .fold(f64::INFINITY, f64::min)
        {
            gap if gap <= SAME => {}
            gap if gap <= OTHER => return None,
            _ => distinct_points.push(point),
        }
    }
    Some(distinct_points.len() as u64)
}

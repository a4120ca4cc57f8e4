//! Check of reported ends: regular ends are checked by Newton's method, started at each of them.
//!
//! Results of a stage's paths come in. The places of results go out that are not what their paths give, or may not be.
//! A step in doubles suffices where rounding is small beside the error that an end claims; elsewhere the method
//! is that of `iterative_refinement`, so that an end that has its digits is at rest. Singular ends and paths that
//! diverge are not checked, nor whether an end is that of its path: only the path tells.

use super::iterative_refinement::{NewtonAtEnds, RoughEnd, StepInDoubles, largest_part};
use crate::item_result::ItemResult;
use crate::path_result::PathResult;
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use crate::tracker::outcome::PathOutcome;
use cognate_numeric::lanes::called::WIDTH;
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs};
use cognate_numeric::scalar::MultiplePrecision;
use num_complex::Complex64;

/// Newton's method moves an end by at most this many times the error that the end claims.
const MARGIN: f64 = 64.0;
/// Newton's method moves an end by at most this part of its largest coordinate, whatever error it claims.
const MOST_RELATIVE_MOVE: f64 = 1e-6;
/// Newton's method moves an end by at most this distance where all coordinates are small, as at the solution 0:
/// absolute.
const MOST_MOVE_NEAR_ZERO: f64 = 1e-12;
/// Bound of the coordinates of an end: in each group the largest one has modulus about 1.
const MOST_COORDINATE: f64 = 4.0;

/// A regular end that a worker reports.
#[derive(Clone)]
struct ReportedEnd {
    end: RoughEnd,
    /// The accuracy that the worker claims.
    accuracy: f64,
}

impl PreparedStage {
    /// Places of results, of the items from `first` on, that are not what their paths give, or may not be.
    pub(crate) fn doubtful_ends(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let mut doubtful = Vec::new();
        let mut regular = Vec::new();
        for (place, result) in results.iter().enumerate() {
            let (_, target) = self.item(first + place as u64);
            let Some(path) = result
                .path()
                .filter(|path| self.is_consistent(path, target))
            else {
                doubtful.push(place);
                continue;
            };
            if path.outcome != PathOutcome::Regular {
                continue;
            }
            match self.homotopy().chart().point(path.endpoint.to_double()) {
                None => doubtful.push(place),
                Some(point) => regular.push(ReportedEnd {
                    end: RoughEnd {
                        place,
                        point,
                        target,
                    },
                    accuracy: path.accuracy,
                }),
            }
        }
        doubtful.extend(self.not_at_rest(&regular));
        doubtful.sort_unstable();
        doubtful
    }

    /// Whether an end has as many coordinates as it must have, of the right size, and solves the equations that are asked
    /// as well as it claims.
    fn is_consistent(&self, path: &PathResult, target: u64) -> bool {
        if matches!(path.outcome, PathOutcome::Failed(_)) {
            return true;
        }
        let chart = self.homotopy().chart();
        let coordinates: usize = (0..chart.group_count())
            .map(|group| chart.group_size(group))
            .sum();
        let end = path.endpoint.to_double();
        // A comparison that a NaN fails.
        let is_scaled =
            |z: &Complex64| z.re.abs() <= MOST_COORDINATE && z.im.abs() <= MOST_COORDINATE;
        let has_coordinates = end.len() == coordinates && end.iter().all(is_scaled);
        has_coordinates && path.asked == self.fit_of_asked(path, target)
    }

    /// Places of the ends that Newton's method moves too far, or at which it does not settle.
    fn not_at_rest(&self, ends: &[ReportedEnd]) -> Vec<usize> {
        if ends.is_empty() {
            return Vec::new();
        }
        let mut newton = NewtonAtEnds::new(self.homotopy());
        let mut to_refine = Vec::new();
        for ends in ends.chunks(WIDTH) {
            let rough: Vec<RoughEnd> = ends.iter().map(|reported| reported.end.clone()).collect();
            let steps = newton.steps_in_doubles(&rough);
            // A comparison that a NaN fails.
            let is_at_rest = |reported: &ReportedEnd, step: &StepInDoubles| {
                step.correction + step.rounding <= self.most_move(reported.accuracy, step.largest)
            };
            let both = ends.iter().zip(&steps);
            let in_doubt = both.filter(|(reported, step)| !is_at_rest(reported, step));
            to_refine.extend(in_doubt.map(|(reported, _)| reported.clone()));
        }
        let mut moved_too_far = Vec::new();
        for ends in to_refine.chunks(WIDTH) {
            let rough: Vec<RoughEnd> = ends.iter().map(|reported| reported.end.clone()).collect();
            for (reported, settled) in ends.iter().zip(newton.refine(&rough)) {
                let point = &reported.end.point;
                let settled = settled.map(|point| point.x.iter().map(|x| x.lane(0)).collect());
                let settled: Option<Vec<Complex64>> =
                    settled.or_else(|| self.settled(&reported.end));
                let is_at_rest = settled.is_some_and(|settled| {
                    let largest = largest_part(point.iter().copied());
                    let moved = largest_part(settled.iter().zip(point).map(|(a, b)| a - b));
                    moved <= self.most_move(reported.accuracy, largest)
                });
                if !is_at_rest {
                    moved_too_far.push(reported.end.place);
                }
            }
        }
        moved_too_far
    }

    /// Farthest that Newton's method may move an end of this accuracy and size.
    fn most_move(&self, accuracy: f64, largest: f64) -> f64 {
        let relative = match self.ends_at_the_system() {
            true => (MARGIN * accuracy.max(f64::EPSILON)).min(MOST_RELATIVE_MOVE),
            // A stage that is not the last gives start points, which the next one refines.
            false => MOST_RELATIVE_MOVE,
        };
        (relative * largest).max(MOST_MOVE_NEAR_ZERO)
    }

    /// The point at which Newton's method settles on the rungs above double-doubles.
    fn settled(&self, end: &RoughEnd) -> Option<Vec<Complex64>> {
        let mut above = rungs(DOUBLE_DOUBLE, self.settings().max_precision_bits).skip(1);
        above.find_map(|bits| {
            let mut point = end.point.clone();
            let refiner = Refiner::<MultiplePrecision>::new(self.homotopy(), bits);
            let report = refiner.with_all_digits().refine(&mut point, end.target);
            report.converged.then_some(point)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::homotopies::HomotopyKind;
    use crate::path_result::Coordinates;
    use crate::prepared_check::PreparedCheck;
    use crate::prepared_work::PreparedWork;
    use crate::start_points::StartPoints;
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, Work};
    use cognate_systems::formats::read;

    /// A system, ready to be solved by total degree, and for its ends to be checked.
    fn prepared(equations: &str, degrees: &[u32]) -> (PreparedWork, PreparedCheck) {
        let text = format!("CONFIG\nEND;\nINPUT\n{equations}\nEND;\n");
        let system = read("test", text.as_bytes()).unwrap().system;
        let stage = Stage::new(
            Work::Track,
            HomotopyKind::StraightLine {
                parameters: Vec::new(),
            },
            StartPoints::TotalDegree {
                degrees: degrees.to_vec(),
            },
            Settings::default(),
            3,
        );
        let work = PreparedWork::new(&system, &stage, &|_| None).unwrap();
        let check = PreparedCheck::new(&system, &stage, &|_| None).unwrap();
        (work, check)
    }

    /// Moves each regular end in these results by `part` of its size.
    fn moved(results: &[ItemResult], part: f64) -> Vec<ItemResult> {
        let mut moved = results.to_vec();
        for result in &mut moved {
            if let ItemResult::Track(path) = result
                && path.outcome == PathOutcome::Regular
            {
                let Coordinates::Double(end) = &mut path.endpoint;
                for z in end.iter_mut().skip(1) {
                    *z *= 1.0 + part;
                }
            }
        }
        moved
    }

    #[test]
    fn right_ends_are_at_rest_and_moved_ends_are_not() {
        let regular = "variable_group x, y; function f, g;
            f = x^4 + 2*x*y^2 - 3*y + 1; g = y^4 - x^3*y + 2*x - 5;";
        let with_infinity = "variable_group x, y; function f, g;
            f = x^2*y - x + 1; g = x*y^2 + y - 3;";
        let with_zero =
            "variable_group x, y; function f, g; f = x^2 - 3*x + y; g = y^2 + x*y - 2*y;";
        // Condition numbers of about 10^7: doubles do not tell whether an end is at rest.
        let close_roots =
            "variable_group x; function f; f = (x - 1)*(x - 1.0001)*(x - 1.0003)*(x + 2);";
        for (equations, degrees, regular_ends) in [
            (regular, &[4, 4][..], 16),
            (with_infinity, &[3, 3], 3),
            (with_zero, &[2, 2], 4),
            (close_roots, &[4], 4),
        ] {
            let (work, check) = prepared(equations, degrees);
            let results = work.run(0..work.items(), 8);
            assert!(check.doubtful(0, &results).is_empty(), "{equations}");
            let paths = results.iter().enumerate();
            let paths =
                paths.filter(|(_, result)| result.path().unwrap().outcome == PathOutcome::Regular);
            let places: Vec<usize> = paths.map(|(place, _)| place).collect();
            assert_eq!(places.len(), regular_ends, "{equations}");
            for part in [1e-3, 1e-9] {
                let doubtful = check.doubtful(0, &moved(&results, part));
                let ends_at_zero = places.len() - doubtful.len();
                assert!(doubtful.iter().all(|place| places.contains(place)));
                assert!(
                    ends_at_zero <= usize::from(equations == with_zero),
                    "{equations} {part}"
                );
            }
            // A part of the items is checked as the whole is.
            let wrong = moved(&results, 1e-6);
            let last = wrong.len() - 1;
            let of_whole = check.doubtful(0, &wrong).contains(&last);
            assert_eq!(check.doubtful(last as u64, &wrong[last..]) == [0], of_whole);
        }
    }

    #[test]
    fn ends_of_a_wrong_shape_are_in_doubt() {
        let (work, check) = prepared("variable_group x; function f; f = x^2 - 2;", &[2]);
        let right = work.run(0..2, 8);
        let with_end = |end: Vec<Complex64>| {
            let mut results = right.clone();
            if let ItemResult::Track(path) = &mut results[1] {
                path.endpoint = Coordinates::Double(end);
            }
            check.doubtful(0, &results)
        };
        let one = Complex64::new(1.0, 0.0);
        assert_eq!(with_end(vec![one]), [1]);
        assert_eq!(with_end(vec![one; 3]), [1]);
        assert_eq!(with_end(vec![one, one * f64::NAN]), [1]);
        assert_eq!(with_end(vec![one * 1e9, one * 2.0_f64.sqrt() * 1e9]), [1]);
        assert_eq!(with_end(vec![Complex64::default(); 2]), [1]);
    }
}

//! ClassRecord: the state of each of the 1442 classes of linkages, path after path.
//!
//! A class is finite if one of its three cognates is: where a representative runs away or is lost, the others are
//! followed, along the same parameters, so that they end in the same class.

use super::Point;
use super::cognates::{Newton, cognates, is_finite, least_determinant};
use super::family::{CLASSES, representatives};
use cognate_solutions::classification::{Tolerances, error_bound};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::named::nine_point;
use num_complex::Complex64;

/// Relative determinants below this are 0: see [`least_determinant`]. Rounding leaves 1e-16
/// times the condition of the solution.
const NO_LINKAGE: f64 = 1e-9;

/// One cognate of one class's representative, as it is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Number of the class, from 0.
    pub class: usize,
    /// Number of the cognate of the representative: 0, 1, 2.
    pub cognate: usize,
}

/// A point that a path arrived at.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrived {
    /// The solution.
    pub point: Point,
    /// Estimated error of the solution, relative to its largest coordinate.
    pub accuracy: f64,
    /// Whether conjugation fixes the solution; `None` if that was not asked.
    pub real: Option<bool>,
    /// Whether the solution is proved to exist, to be alone, and to differ from the others.
    pub certified: bool,
    /// Whether the solution is proved to be real.
    pub certified_real: bool,
}

/// How a path ended.
#[derive(Clone, Debug, PartialEq)]
pub enum PathEnd {
    /// At a regular solution.
    Regular(Arrived),
    /// At an isolated solution where the Jacobian is singular.
    Singular(Arrived),
    /// On a set of positive dimension.
    PositiveDimensional,
    /// At infinity.
    AtInfinity,
    /// Nowhere: it was given up, for this reason.
    Failed(String),
}

/// State of a class of solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ClassEnd {
    /// A regular linkage.
    Finite,
    /// A linkage where several classes meet, or that is singular for another reason.
    Multiple,
    /// The solution is no linkage: links without length, two equal sides, or a set of positive dimension.
    Degenerate,
    /// All cognates of the class are at infinity.
    AtInfinity,
    /// The class is not settled, because a path was lost.
    Failed,
}

/// A class that has a linkage.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Number of the class; of several that end at one linkage the first.
    pub class: usize,
    /// The cognate of the class that lies best.
    pub arrived: Arrived,
    /// How many classes end here: 1 where it is regular.
    pub classes: usize,
}

/// All that is known of the classes.
pub struct ClassRecord {
    parameters: Vec<Complex64>,
    representatives: Vec<Point>,
    group: SymmetryGroup,
    shape: PointShape,
    arrivals: Vec<Vec<(usize, PathEnd)>>,
    /// Classes that arrived where an earlier class is: a path jumped.
    clashing: Vec<Option<usize>>,
    /// Linkages of classes whose own paths were lost, found in another way.
    derived: Vec<Option<Arrived>>,
}

impl ClassRecord {
    /// An empty record for these parameters (those of [`super::PathPoints`]).
    pub fn new(parameters: Vec<Complex64>) -> Self {
        let system = nine_point().system;
        let shape = PointShape::of(&system);
        let representatives = representatives();
        let mut group =
            SymmetryGroup::of(&system).expect("the named system has rational generators");
        group
            .close(&representatives[0], &shape)
            .expect("exchange and cognates are a group of six");
        Self {
            parameters,
            representatives,
            group,
            shape,
            arrivals: vec![Vec::new(); CLASSES],
            clashing: vec![None; CLASSES],
            derived: vec![None; CLASSES],
        }
    }

    /// Where the path of a member starts, at the parameters of [`super::family`].
    pub fn start(&self, member: Member) -> Point {
        cognates(&self.representatives[member.class])[member.cognate]
    }

    /// The first round: the representative of each class.
    pub fn first_round() -> Vec<Member> {
        (0..CLASSES)
            .map(|class| Member { class, cognate: 0 })
            .collect()
    }

    /// The other cognates of every class that is not settled yet.
    pub fn other_cognates(&self) -> Vec<Member> {
        let open = (0..CLASSES).filter(|&class| self.end(class) != ClassEnd::Finite);
        let members = open.flat_map(|class| [1, 2].map(|cognate| Member { class, cognate }));
        members
            .filter(|&member| is_finite(&self.start(member)))
            .collect()
    }

    /// All cognates of every class that has no regular linkage, and of those where its paths
    /// jumped to: lost paths, and those that seem to end at a singular linkage or at none.
    pub fn open(&self) -> Vec<Member> {
        let mut open: Vec<usize> = (0..CLASSES)
            .filter(|&class| self.end(class) != ClassEnd::Finite)
            .collect();
        open.extend(self.clashing.iter().flatten());
        open.sort_unstable();
        open.dedup();
        let members = open
            .into_iter()
            .flat_map(|class| [0, 1, 2].map(|cognate| Member { class, cognate }));
        members
            .filter(|&member| is_finite(&self.start(member)))
            .collect()
    }

    /// Notes how a path ended. The last note on a class counts.
    ///
    /// # Panics
    /// When there is no such class.
    pub fn note(&mut self, member: Member, arrival: PathEnd) {
        self.arrivals[member.class].push((member.cognate, arrival));
    }

    /// A path's point, where it is a linkage: the cognate that is farthest from degenerate.
    fn best(&self, arrived: &Arrived) -> Option<Arrived> {
        let mut best: Option<(f64, Point)> = None;
        for member in cognates(&arrived.point) {
            if !is_finite(&member) {
                continue;
            }
            let determinant = least_determinant(&member, &self.parameters);
            if best.is_none_or(|(other, _)| determinant > other) {
                best = Some((determinant, member));
            }
        }
        let (determinant, point) = best?;
        (determinant > NO_LINKAGE).then(|| Arrived {
            point,
            ..arrived.clone()
        })
    }

    /// The regular linkage of a class, as its last path found it.
    fn regular(&self, class: usize) -> Option<&Arrived> {
        let arrival = self.arrivals[class]
            .iter()
            .rev()
            .find_map(|(_, a)| match a {
                PathEnd::Regular(arrived) if self.best(arrived).is_some() => Some(arrived),
                _ => None,
            });
        let arrival = arrival.filter(|_| self.clashing[class].is_none());
        self.derived[class].as_ref().or(arrival)
    }

    /// Looks for classes that arrived at one linkage: of them only one can belong there. Gives
    /// their number.
    pub fn compare(&mut self) -> usize {
        self.clashing = vec![None; CLASSES];
        let regular_arrivals: Vec<(usize, &Arrived)> = (0..CLASSES)
            .filter_map(|class| Some((class, self.regular(class)?)))
            .collect();
        let points = regular_arrivals.iter().map(|(_, arrived)| *arrived);
        let orbits = self.orbits(&points.collect::<Vec<_>>());
        let mut clashing = vec![None; CLASSES];
        for orbit in &orbits {
            for &place in &orbit[1..] {
                clashing[regular_arrivals[place].0] = Some(regular_arrivals[orbit[0]].0);
            }
        }
        self.clashing = clashing;
        self.clashing.iter().flatten().count()
    }

    fn orbits(&self, points: &[&Arrived]) -> Vec<Vec<usize>> {
        let tolerances = Tolerances::default();
        let radius = |arrived: &Arrived| {
            let (factor, floor) = (tolerances.coincidence_factor, tolerances.coincidence_floor);
            error_bound(arrived.accuracy, factor, floor)
        };
        let points: Vec<(&[Complex64], f64)> = points
            .iter()
            .map(|arrived| (&arrived.point[..], radius(arrived)))
            .collect();
        self.group.orbits(&points, &self.shape, 1)
    }

    /// Present state of a class.
    pub fn end(&self, class: usize) -> ClassEnd {
        if self.regular(class).is_some() {
            return ClassEnd::Finite;
        }
        if self.clashing[class].is_some() {
            return ClassEnd::Failed;
        }
        let arrivals = self.arrivals[class].iter().map(|(_, arrival)| arrival);
        let mut end = None;
        for arrival in arrivals {
            let this = match arrival {
                PathEnd::Singular(arrived) if self.best(arrived).is_some() => ClassEnd::Multiple,
                PathEnd::Regular(_) | PathEnd::Singular(_) | PathEnd::PositiveDimensional => {
                    ClassEnd::Degenerate
                }
                PathEnd::AtInfinity => ClassEnd::AtInfinity,
                PathEnd::Failed(_) => ClassEnd::Failed,
            };
            // Ends by weight: a linkage, a lost path, a degenerate linkage, infinity.
            let rank = |end: ClassEnd| match end {
                ClassEnd::Finite | ClassEnd::Multiple => 3,
                ClassEnd::Failed => 2,
                ClassEnd::Degenerate => 1,
                ClassEnd::AtInfinity => 0,
            };
            if end.is_none_or(|before| rank(this) > rank(before)) {
                end = Some(this);
            }
        }
        end.unwrap_or(ClassEnd::Failed)
    }

    /// Why a class is not settled.
    pub fn reason(&self, class: usize) -> String {
        if let Some(other) = self.clashing[class] {
            return format!("it arrives at the linkage of class {other}, however it is followed");
        }
        let reasons = self.arrivals[class].iter().rev();
        let mut failures = reasons.filter_map(|(_, arrival)| match arrival {
            PathEnd::Failed(reason) => Some(reason.clone()),
            _ => None,
        });
        failures
            .next()
            .unwrap_or_else(|| "it was not followed".into())
    }

    /// Solutions that must be there and are in no class yet give lost classes their linkages.
    /// For real points every linkage's conjugate is one, too. `others` are regular solutions
    /// that were found in another way, along other parameters for instance. Gives the
    /// number of classes that are settled by this.
    pub fn derive(&mut self, others: &[Arrived], conjugates: bool) -> usize {
        let open: Vec<usize> = (0..CLASSES)
            .filter(|&class| self.end(class) == ClassEnd::Failed)
            .collect();
        if open.is_empty() {
            return 0;
        }
        let regular_linkages: Vec<Arrived> = (0..CLASSES)
            .filter_map(|class| self.regular(class).cloned())
            .collect();
        let mut linkages = regular_linkages.clone();
        linkages.extend(others.iter().filter_map(|arrived| self.best(arrived)));
        if conjugates {
            let mirrored = |arrived: &Arrived| Arrived {
                point: std::array::from_fn(|k| arrived.point[k ^ 1].conj()),
                ..arrived.clone()
            };
            let images: Vec<Arrived> = linkages.iter().map(mirrored).collect();
            linkages.extend(images);
        }
        let orbits = self.orbits(&linkages.iter().collect::<Vec<_>>());
        let mut newton = Newton::new();
        let mut settled = 0;
        let mut open = open.into_iter();
        for orbit in orbits
            .iter()
            .filter(|orbit| orbit[0] >= regular_linkages.len())
        {
            let arrived = &linkages[orbit[0]];
            // Only what Newton's method confirms.
            let Some((point, _)) = newton.polish(&arrived.point, &self.parameters) else {
                continue;
            };
            let Some(class) = open.next() else { break };
            self.derived[class] = Some(Arrived {
                point,
                certified: false,
                certified_real: false,
                ..arrived.clone()
            });
            settled += 1;
        }
        settled
    }

    /// How many classes have come to each end: the numbers add up to 1442.
    pub fn counts(&self) -> Vec<(ClassEnd, usize)> {
        let ends = [
            ClassEnd::Finite,
            ClassEnd::Multiple,
            ClassEnd::Degenerate,
            ClassEnd::AtInfinity,
            ClassEnd::Failed,
        ];
        let mut counts = ends.map(|end| (end, 0));
        for class in 0..CLASSES {
            let end = self.end(class);
            for (kind, count) in &mut counts {
                *count += usize::from(*kind == end);
            }
        }
        counts.to_vec()
    }

    /// The classes that were settled in another way than by a path of their own.
    pub fn derived(&self) -> usize {
        let is_derived =
            |class: &usize| self.derived[*class].is_some() && self.end(*class) == ClassEnd::Finite;
        (0..CLASSES).filter(is_derived).count()
    }

    /// Every linkage that was found, each once, ascending by class.
    pub fn found(&self) -> Vec<Found> {
        let mut linkages: Vec<Found> = Vec::new();
        let mut singular: Vec<(usize, Arrived)> = Vec::new();
        for class in 0..CLASSES {
            match self.end(class) {
                ClassEnd::Finite => linkages.extend(self.regular(class).and_then(|arrived| {
                    Some(Found {
                        class,
                        arrived: self.best(arrived)?,
                        classes: 1,
                    })
                })),
                ClassEnd::Multiple => {
                    let arrivals = self.arrivals[class].iter();
                    singular.extend(arrivals.rev().find_map(|(_, arrival)| match arrival {
                        PathEnd::Singular(arrived) => Some((class, self.best(arrived)?)),
                        _ => None,
                    }));
                }
                _ => {}
            }
        }
        let points: Vec<&Arrived> = singular.iter().map(|(_, arrived)| arrived).collect();
        for orbit in self.orbits(&points) {
            let (class, arrived) = &singular[orbit[0]];
            linkages.push(Found {
                class: *class,
                arrived: arrived.clone(),
                classes: orbit.len(),
            });
        }
        linkages.sort_by_key(|linkage| linkage.class);
        linkages
    }
}

#[cfg(test)]
mod tests {
    use super::super::family;
    use super::*;

    fn arrived(point: Point) -> Arrived {
        Arrived {
            point,
            accuracy: 1e-14,
            real: None,
            certified: false,
            certified_real: false,
        }
    }

    fn count(record: &ClassRecord, end: ClassEnd) -> usize {
        let counts = record.counts();
        assert_eq!(counts.iter().map(|(_, n)| n).sum::<usize>(), CLASSES);
        counts
            .iter()
            .find(|(kind, _)| *kind == end)
            .expect("all are there")
            .1
    }

    /// A record of paths that stayed where they started.
    fn full() -> ClassRecord {
        let mut record = ClassRecord::new(family::parameters());
        for member in ClassRecord::first_round() {
            let point = record.start(member);
            record.note(member, PathEnd::Regular(arrived(point)));
        }
        record
    }

    #[test]
    fn a_class_is_finite_if_one_of_its_cognates_is() {
        let mut record = full();
        assert_eq!(record.compare(), 0);
        assert_eq!(count(&record, ClassEnd::Finite), CLASSES);
        assert!(record.other_cognates().is_empty() && record.open().is_empty());
        let linkages = record.found();
        assert_eq!(linkages.len(), CLASSES);

        let mut record = ClassRecord::new(family::parameters());
        for member in ClassRecord::first_round() {
            let point = record.start(member);
            let arrival = match member.class {
                7 => PathEnd::AtInfinity,
                8 => PathEnd::Failed("lost".into()),
                9 => PathEnd::PositiveDimensional,
                _ => PathEnd::Regular(arrived(point)),
            };
            record.note(member, arrival);
        }
        let others = record.other_cognates();
        let classes: Vec<usize> = others.iter().map(|m| m.class).collect();
        assert_eq!(classes, [7, 7, 8, 8, 9, 9]);
        for member in others {
            let arrival = match (member.class, member.cognate) {
                (7, 2) | (8, 1) => PathEnd::Regular(arrived(record.start(member))),
                _ => PathEnd::AtInfinity,
            };
            record.note(member, arrival);
        }
        assert_eq!(record.compare(), 0);
        assert_eq!(count(&record, ClassEnd::Finite), CLASSES - 1);
        assert_eq!(record.end(9), ClassEnd::Degenerate);
    }

    #[test]
    fn a_class_that_arrives_where_another_is_has_jumped() {
        let mut record = full();
        // Class 30 at a cognate of class 12.
        let member = Member {
            class: 30,
            cognate: 0,
        };
        let elsewhere = record.start(Member {
            class: 12,
            cognate: 2,
        });
        record.note(member, PathEnd::Regular(arrived(elsewhere)));
        assert_eq!(record.compare(), 1);
        assert_eq!(record.end(30), ClassEnd::Failed);
        assert!(record.reason(30).contains("class 12"));
        let open_classes: Vec<usize> = record.open().iter().map(|m| m.class).collect();
        assert_eq!(open_classes, [12, 12, 12, 30, 30, 30]);
        // Nothing else is known: it stays lost. Then it is found along another way.
        assert_eq!(record.derive(&[], false), 0);
        let arrival = arrived(record.start(Member {
            class: 5,
            cognate: 1,
        }));
        let missing = arrived(record.start(Member {
            class: 30,
            cognate: 1,
        }));
        assert_eq!(record.derive(&[arrival, missing], false), 1);
        assert_eq!(count(&record, ClassEnd::Finite), CLASSES);
        assert_eq!(record.derived(), 1);
        assert_eq!(record.compare(), 0);
    }

    #[test]
    fn several_classes_at_one_singular_linkage_are_listed_once() {
        let mut record = full();
        for class in [3, 4] {
            record.arrivals[class].clear();
            let member = Member { class, cognate: 0 };
            let point = record.start(Member {
                class: 3,
                cognate: class - 3,
            });
            record.note(member, PathEnd::Singular(arrived(point)));
        }
        assert_eq!(record.compare(), 0);
        assert_eq!(count(&record, ClassEnd::Multiple), 2);
        let linkages = record.found();
        assert_eq!(linkages.len(), CLASSES - 1);
        assert_eq!((linkages[3].class, linkages[3].classes), (3, 2));
    }
}

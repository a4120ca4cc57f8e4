//! Search: the paths to follow, round after round, until every class of linkages is settled.
//!
//! A state machine that knows no service: [`Search::next_round`] says which solutions of the generic member are to be
//! followed to the points; the caller follows them and hands their ends to [`Search::absorb`].

use super::class_record::{Arrived, ClassEnd, ClassRecord, Member, PathEnd};
use super::{PathPoints, Point};
use std::collections::BTreeMap;

/// One round: paths to follow from the generic member (`family`) to the points.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// Purpose of the round, in words for the user.
    pub purpose: &'static str,
    /// Solutions of the generic member; a path is named by its place here.
    pub starts: Vec<Point>,
    /// Added to the seed, for another way through the parameters; 0 on the first way.
    pub way: u64,
    /// True where paths are followed with the preset `careful`, whatever was asked.
    pub careful: bool,
}

/// The rounds, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// A representative of each class.
    Representatives,
    /// The other two cognates of classes that have no linkage yet.
    OtherCognates,
    /// All cognates of classes that have none still, or arrived where another class did.
    Carefully,
    /// All representatives along other parameters, where a class is still lost.
    OtherWay,
    /// All rounds are done.
    Done,
}

impl Phase {
    fn following(self) -> Self {
        match self {
            Self::Representatives => Self::OtherCognates,
            Self::OtherCognates => Self::Carefully,
            Self::Carefully => Self::OtherWay,
            Self::OtherWay | Self::Done => Self::Done,
        }
    }
}

/// A synthesis under way.
pub struct Search {
    record: ClassRecord,
    /// Whether the points are real, so that linkages come with their conjugates.
    real: bool,
    phase: Phase,
    /// Members that the open round follows, in the order of its starts.
    members: Vec<Member>,
    derived: usize,
}

impl Search {
    /// A search that has followed nothing yet.
    pub fn new(points: &PathPoints) -> Self {
        Self {
            record: ClassRecord::new(points.parameters()),
            real: points.is_real(),
            phase: Phase::Representatives,
            members: Vec::new(),
            derived: 0,
        }
    }

    /// The next round; `None` when all that can be done is done. Every round is absorbed before the next.
    pub fn next_round(&mut self) -> Option<Round> {
        loop {
            if !matches!(self.phase, Phase::Representatives | Phase::Done) {
                self.record.compare();
            }
            let (purpose, members) = match self.phase {
                Phase::Representatives => ("one of each class", ClassRecord::first_round()),
                Phase::OtherCognates => ("other cognates", self.record.other_cognates()),
                Phase::Carefully => ("again, carefully", self.record.open()),
                Phase::OtherWay => ("another way", self.lost()),
                Phase::Done => return None,
            };
            if members.is_empty() {
                self.phase = self.phase.following();
                continue;
            }
            let starts = members.iter().map(|&member| self.record.start(member));
            let round = Round {
                purpose,
                starts: starts.collect(),
                way: u64::from(self.phase == Phase::OtherWay),
                careful: self.phase == Phase::Carefully,
            };
            self.members = members;
            return Some(round);
        }
    }

    /// All representatives where a class is lost that the others do not imply; none elsewhere.
    fn lost(&mut self) -> Vec<Member> {
        self.derived = self.record.derive(&[], self.real);
        match self.record.counts().contains(&(ClassEnd::Failed, 0)) {
            true => Vec::new(),
            false => ClassRecord::first_round(),
        }
    }

    /// Takes how the paths of the open round ended, by their places; a path without an end failed.
    pub fn absorb(&mut self, mut ends: BTreeMap<usize, PathEnd>) {
        if self.phase == Phase::OtherWay {
            // Along other parameters every class may end as another one: only solutions that are found count.
            let regular = |arrival| match arrival {
                PathEnd::Regular(arrived) => Some(arrived),
                _ => None,
            };
            let others: Vec<Arrived> = ends.into_values().filter_map(regular).collect();
            self.derived += self.record.derive(&others, self.real);
        } else {
            for (place, &member) in self.members.iter().enumerate() {
                let unknown = || PathEnd::Failed("the service says nothing of its path".into());
                self.record
                    .note(member, ends.remove(&place).unwrap_or_else(unknown));
            }
        }
        self.members.clear();
        self.phase = self.phase.following();
    }

    /// The record of all classes, and the number of classes that were settled by implied solutions, not by what their
    /// own paths found.
    pub fn finish(self) -> (ClassRecord, usize) {
        (self.record, self.derived)
    }
}

#[cfg(test)]
mod tests {
    use super::super::family::{self, CLASSES};
    use super::*;

    /// Points whose parameters are those of the generic member: every path stays where it starts.
    fn still() -> Search {
        Search {
            record: ClassRecord::new(family::parameters()),
            real: false,
            phase: Phase::Representatives,
            members: Vec::new(),
            derived: 0,
        }
    }

    fn regular(point: Point) -> PathEnd {
        PathEnd::Regular(Arrived {
            point,
            accuracy: 1e-15,
            real: None,
            certified: false,
            certified_real: false,
        })
    }

    /// Drives a search whose paths stay where they are, but for some, by round and place.
    fn drive(lost: impl Fn(usize, usize) -> bool) -> (Vec<(&'static str, usize)>, ClassRecord) {
        let mut search = still();
        let mut rounds = Vec::new();
        while let Some(round) = search.next_round() {
            assert_eq!(round.way, u64::from(round.purpose == "another way"));
            assert_eq!(round.careful, round.purpose == "again, carefully");
            let ends = round.starts.iter().enumerate();
            let arrived = ends.filter(|(place, _)| !lost(rounds.len(), *place));
            let ends = arrived
                .map(|(place, &start)| (place, regular(start)))
                .collect();
            rounds.push((round.purpose, round.starts.len()));
            search.absorb(ends);
        }
        assert!(search.next_round().is_none(), "it stays done");
        (rounds, search.finish().0)
    }

    #[test]
    fn one_round_is_enough_where_every_path_arrives() {
        let (rounds, record) = drive(|_, _| false);
        assert_eq!(rounds, [("one of each class", CLASSES)]);
        assert!(record.counts().contains(&(ClassEnd::Finite, CLASSES)));
    }

    #[test]
    fn other_cognates_settle_a_class_whose_representative_is_lost() {
        let (rounds, record) = drive(|round, place| round == 0 && place == 7);
        assert_eq!(
            rounds,
            [("one of each class", CLASSES), ("other cognates", 2)]
        );
        assert!(record.counts().contains(&(ClassEnd::Finite, CLASSES)));
    }

    #[test]
    fn a_class_that_no_cognate_reaches_is_found_on_another_way_or_named() {
        let expected = [
            ("one of each class", CLASSES),
            ("other cognates", 2),
            ("again, carefully", 3),
            ("another way", CLASSES),
        ];
        // Along other parameters the path of the class arrives.
        let lost = |round, place| round == 0 && place == 7 || round == 1 || round == 2;
        let (rounds, record) = drive(lost);
        assert_eq!(rounds, expected);
        assert!(record.counts().contains(&(ClassEnd::Finite, CLASSES)));
        assert_eq!(record.derived(), 1);
        // The path of the class fails along other parameters, too.
        let (rounds, record) = drive(|round, place| lost(round, place) || place == 7);
        assert_eq!(rounds, expected);
        assert!(record.counts().contains(&(ClassEnd::Failed, 1)));
    }
}

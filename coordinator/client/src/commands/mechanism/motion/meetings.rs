//! Meetings: the positions that two modes of a motion have in common.

use super::Work;
use crate::commands::question;
use crate::error::ClientError;
use crate::mechanism::motion_answer::{Meeting, MeetingPoint};
use cognate_solutions::witness::Question;
use cognate_solutions::witness::question::SecondSet;
use futures::StreamExt;

/// Largest number of pairs of modes that are intersected; more leave a doubt.
const MOST_PAIRS: usize = 120;

/// Number of jobs that the coordinator has at once: each is short, and waits most of its time.
pub(super) const SIDE_BY_SIDE: usize = 4;

/// Intersection of two modes, with the doubts about it.
struct Intersected {
    /// The common positions; `None` if the modes do not meet.
    meeting: Option<Meeting>,
    doubts: Vec<String>,
}

impl Work<'_> {
    /// Intersects every two modes.
    pub(super) async fn find_meetings(&mut self) -> Result<(), ClientError> {
        let count = self.components.len();
        if count * count.saturating_sub(1) / 2 > MOST_PAIRS {
            self.doubt(format!(
                "{count} modes: too many pairs to say where each two meet"
            ));
            return Ok(());
        }
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        let meetings = futures::stream::iter(pairs.map(|pair| self.meeting(pair)));
        let meetings: Vec<Result<Intersected, ClientError>> =
            meetings.buffered(SIDE_BY_SIDE).collect().await;
        for meeting in meetings {
            let Intersected { meeting, doubts } = meeting?;
            self.answer.meetings.extend(meeting);
            self.answer.doubts.extend(doubts);
        }
        Ok(())
    }

    /// Intersects two modes.
    async fn meeting(&self, [first, second]: [usize; 2]) -> Result<Intersected, ClientError> {
        let modes = [first, second].map(|k| self.answer.modes[k].id.clone());
        let set = self.only(&[self.components[first]]);
        let other = self.only(&[self.components[second]]);
        let equation_count = u32::try_from(set.system.equations.len()).unwrap_or(u32::MAX);
        let common = SecondSet {
            own: equation_count,
            from: 0,
            components: other.sets(),
        };
        let prepared = question::prepared(self.wishes.preset, &set, Question::Intersect(common))?;
        let [a, b] = modes.clone();
        let in_doubt = |doubt: &str| Intersected {
            doubts: vec![format!("where {a} and {b} meet: {doubt}")],
            meeting: Some(Meeting {
                modes: [a.clone(), b.clone()],
                points: None,
            }),
        };
        let (summary, common) = match self.jobs.decompose(prepared, None).await {
            Ok(common) => common,
            Err(ClientError::GaveUp(message) | ClientError::Refused(message)) => {
                return Ok(in_doubt(&message));
            }
            Err(error) => return Err(error),
        };
        if !summary.settled {
            return Ok(in_doubt(&summary.decomposition.unsettled.join("; ")));
        }
        let mut points = Vec::new();
        let mut doubts = Vec::new();
        for component in &common.components {
            let set = &component.set;
            let is_position = set.points.iter().any(|p| self.asked.placed(p).is_some());
            if !is_position {
                continue;
            }
            if set.dimension() > 0 {
                // Infinitely many common positions are no doubt.
                return Ok(Intersected {
                    doubts: Vec::new(),
                    ..in_doubt("")
                });
            }
            let is_real = self.asked.is_real(&set.points[0]);
            if is_real.is_none() {
                doubts.push(format!(
                    "whether a common position of {a} and {b} is real is not clear"
                ));
            }
            points.push(MeetingPoint {
                is_real,
                placed: match is_real {
                    Some(true) => self.asked.placed(&set.points[0]),
                    _ => None,
                },
                solution: set.points[0].clone(),
            });
        }
        points.sort_by_key(|point| point.is_real != Some(true));
        let meeting = (!points.is_empty()).then_some(Meeting {
            modes,
            points: Some(points),
        });
        Ok(Intersected { meeting, doubts })
    }
}

//! Meetings: the positions that two modes of a motion have in common.

use super::Work;
use crate::commands::question;
use crate::error::ClientError;
use crate::mechanism::motion_answer::{Meeting, MeetingPoint};
use cognate_solutions::witness::Question;
use cognate_solutions::witness::question::SecondSet;

/// So many pairs of modes are intersected; more leave a doubt.
const MOST_PAIRS: usize = 120;

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
        for first in 0..count {
            for second in first + 1..count {
                if let Some(meeting) = self.meeting(first, second).await? {
                    self.answer.meetings.push(meeting);
                }
            }
        }
        Ok(())
    }

    /// What two modes have in common; `None` where that is nothing.
    async fn meeting(
        &mut self,
        first: usize,
        second: usize,
    ) -> Result<Option<Meeting>, ClientError> {
        let modes = [first, second].map(|k| self.answer.modes[k].id.clone());
        let set = self.only(&[self.components[first]]);
        let other = self.only(&[self.components[second]]);
        let own = u32::try_from(set.system.equations.len()).unwrap_or(u32::MAX);
        let common = SecondSet {
            own,
            from: 0,
            components: other.sets(),
        };
        let prepared = question::prepared(self.a.preset, &set, Question::Intersect(common))?;
        let unknown = |modes| Meeting {
            modes,
            points: None,
        };
        let (summary, common) = match self.jobs.decompose(prepared, None).await {
            Ok(common) => common,
            Err(ClientError::GaveUp(message) | ClientError::Refused(message)) => {
                self.doubt(format!(
                    "where {} and {} meet: {message}",
                    modes[0], modes[1]
                ));
                return Ok(Some(unknown(modes)));
            }
            Err(error) => return Err(error),
        };
        if !summary.settled {
            let doubts = summary.decomposition.unsettled.join("; ");
            self.doubt(format!(
                "where {} and {} meet: {doubts}",
                modes[0], modes[1]
            ));
            return Ok(Some(unknown(modes)));
        }
        let mut points = Vec::new();
        for known in &common.components {
            let set = &known.set;
            let is_position = set.points.iter().any(|p| self.asked.placed(p).is_some());
            if !is_position {
                continue;
            }
            if set.dimension() > 0 {
                return Ok(Some(unknown(modes)));
            }
            let is_real = self.asked.is_real(&set.points[0]);
            if is_real.is_none() {
                self.doubt(format!(
                    "whether a common position of {} and {} is real is not clear",
                    modes[0], modes[1]
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
        Ok((!points.is_empty()).then_some(Meeting {
            modes,
            points: Some(points),
        }))
    }
}

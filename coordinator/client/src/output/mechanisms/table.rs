//! Positions of a mechanism as a table for people.

use super::listing::{Finished, Listing};
use super::view::{View, pose_columns, pose_numbers};
use crate::error::ClientError;
use crate::output;
use crate::output::text::{Columns, Look, count, counted, magnitude, real, seconds};
use cognate_kinematics::compile::Problem;
use cognate_mechanism_solver::postures::{Counts, Position, PostureSet, Postures};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Largest number of positions that are listed in a table.
const MOST_LISTED: usize = 64;
/// Number of targets above which targets with the same counts share a row.
const MOST_ROWS: usize = 100;

/// A number that is only rounding beside degrees, radians and lengths of a mechanism is shown as 0; files have all digits.
const ROUNDING: f64 = 1e-11;

fn without_rounding(x: f64) -> f64 {
    if x.abs() < ROUNDING { 0.0 } else { x }
}

/// Table of the counts of targets, with the positions of the first targets.
pub struct Table<'a> {
    view: View<'a>,
    look: Look,
    /// The counts of the first targets in the order of columns: one more than [`MOST_ROWS`] at most.
    rows: Vec<Vec<u64>>,
    /// How many targets have these counts, and which of them came first.
    alike: BTreeMap<Vec<u64>, (u64, u64)>,
    has_proofs: bool,
    /// The counts of all targets together.
    total: Counts,
    /// How many targets were answered by each route.
    routes: BTreeMap<String, u64>,
    /// The joints that are held at each of the first targets for it alone.
    held: Vec<String>,
    /// The first positions, numbered by target and in it.
    positions: Vec<(u64, usize, Position)>,
    listed: u64,
    /// The first targets with singular real positions, each with the number of solutions at other singular positions.
    complex_singular: Vec<(u64, u64)>,
    /// The first sets of postures, by target.
    sets: Vec<(u64, PostureSet)>,
}

impl Listing for Table<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        let counts = &answer.counts;
        self.total.add(counts);
        let mut row = vec![counts.complex, counts.real];
        *self.routes.entry(answer.route.name()).or_default() += 1;
        self.has_proofs |= counts.certified_real.is_some();
        row.extend(counts.certified_real);
        if self.has_limits() {
            row.push(counts.within_limits);
        }
        row.extend([
            counts.singular,
            counts.at_infinity,
            counts.positive_dimensional,
            counts.degenerate,
            counts.failed,
        ]);
        if self.rows.len() <= MOST_ROWS {
            self.rows.push(row.clone());
            let held = answer.held.iter();
            let held =
                held.map(|(joint, x)| format!("{joint} = {}", self.view.with_unit(joint, *x)));
            self.held.push(held.collect::<Vec<String>>().join(" "));
        }
        self.alike.entry(row).or_insert((0, index + 1)).0 += 1;
        let listed = answer.positions.iter().filter(|p| self.view.lists(p));
        for (k, position) in listed.enumerate() {
            if self.positions.len() < MOST_LISTED {
                self.positions.push((index + 1, k + 1, position.clone()));
            }
            self.listed += 1;
        }
        let at_real = answer
            .positions
            .iter()
            .filter(|p| p.is_singular && p.is_real);
        let at_real: u64 = at_real.map(|p| p.multiplicity).sum();
        let elsewhere = counts.singular.saturating_sub(at_real);
        if answer.settled
            && at_real > 0
            && elsewhere > 0
            && self.complex_singular.len() < MOST_LISTED
        {
            self.complex_singular.push((index + 1, elsewhere));
        }
        let room = MOST_LISTED.saturating_sub(self.sets.len());
        let sets = answer.sets.iter().take(room);
        self.sets.extend(sets.map(|set| (index + 1, set.clone())));
        Ok(())
    }

    fn finish(self: Box<Self>, end: &Finished<'_>) -> Result<(), ClientError> {
        output::print(&self.text(end))
    }
}

impl<'a> Table<'a> {
    /// An empty table.
    pub fn new(view: View<'a>, look: Look) -> Self {
        Self {
            view,
            look,
            rows: Vec::new(),
            alike: BTreeMap::new(),
            has_proofs: false,
            total: Counts::default(),
            routes: BTreeMap::new(),
            held: Vec::new(),
            positions: Vec::new(),
            listed: 0,
            complex_singular: Vec::new(),
            sets: Vec::new(),
        }
    }

    fn has_limits(&self) -> bool {
        !self.view.mechanism.limits.is_empty()
    }

    fn text(&self, end: &Finished<'_>) -> String {
        let (prepared, look) = (self.view.preparation, self.look);
        let family = &prepared.family;
        let number = match (prepared.here, family.expected) {
            _ if !prepared.reason.is_empty() => prepared.reason.clone(),
            (Some(here), Some(expected)) if here == expected => {
                format!("{here} for every target  ({})", family.source)
            }
            (Some(here), _) => format!("{here} for a general target"),
            (None, Some(expected)) => format!("at most {expected}  ({})", family.source),
            (None, None) => "no number is known beforehand".into(),
        };
        let mut text = format!(
            "{}: {}: {number}\n\n{}",
            look.bold(&self.view.mechanism.name),
            family.name,
            self.targets()
        );
        let targets = end.summary.targets;
        let kept = if prepared.from_cache {
            "  prepared before"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "\n  Time  {} for {}, {} of CPU each{kept}\n{}",
            seconds(end.wall_seconds),
            counted(targets, "target"),
            seconds(end.cpu_seconds / targets.max(1) as f64),
            self.routes()
        );
        text.push_str(&match self.positions.is_empty() {
            true => format!("  no position to show: {}\n", self.why_none(end)),
            false => self.positions(),
        });
        if !end.summary.settled {
            let _ = writeln!(
                text,
                "  {}",
                look.warn("not everything is settled: see the counts and warnings")
            );
        }
        text
    }

    /// A line that says by which routes targets were answered, where an arm has a closed form.
    fn routes(&self) -> String {
        let is_closed = |route: &String| route.starts_with("closed form: ");
        if !self.routes.keys().any(is_closed) {
            return String::new();
        }
        let routes = self.routes.iter();
        let routes = routes.map(|(route, targets)| match self.routes.len() {
            1 => route.clone(),
            _ => format!("{route} for {}", count(*targets)),
        });
        let routes: Vec<String> = routes.collect();
        format!("  Route {}\n", routes.join("; "))
    }

    /// A row for each target, or for all with the same counts, the most frequent first.
    fn targets(&self) -> String {
        let is_grouped = self.rows.len() > MOST_ROWS;
        let mut headings = match is_grouped {
            true => vec![">targets", ">first"],
            false => vec![">target"],
        };
        let is_held = !is_grouped && self.held.iter().any(|held| !held.is_empty());
        if is_held {
            headings.push("held");
        }
        headings.extend([">complex", ">real"]);
        if self.has_proofs {
            headings.push(">proved");
        }
        if self.has_limits() {
            headings.push(">within limits");
        }
        headings.extend([
            ">singular",
            ">at infinity",
            ">on sets",
            ">no position",
            ">failed",
        ]);
        let mut columns = Columns::new(&headings);
        let numbers = |row: &[u64]| row.iter().map(u64::to_string).collect::<Vec<String>>();
        if is_grouped {
            let mut groups: Vec<_> = self.alike.iter().collect();
            groups.sort_by_key(|(_, (targets, first))| (std::cmp::Reverse(*targets), *first));
            for (row, (targets, first)) in groups {
                let mut cells = vec![count(*targets), first.to_string()];
                cells.extend(numbers(row));
                columns.row(cells);
            }
        } else {
            for (i, row) in self.rows.iter().enumerate() {
                let mut cells = vec![(i + 1).to_string()];
                cells.extend(is_held.then(|| self.held[i].clone()));
                cells.extend(numbers(row));
                columns.row(cells);
            }
        }
        columns.render(self.look)
    }

    /// Why no position of any target is listed.
    pub(super) fn why_none(&self, end: &Finished<'_>) -> String {
        let Counts {
            complex,
            real,
            singular,
            positive_dimensional,
            ..
        } = self.total;
        let special = singular + positive_dimensional;
        if !end.summary.settled {
            return "not every path is accounted for, so that there may be some".into();
        }
        match real {
            0 => {}
            1 => return "the one real position is beyond limits".into(),
            real => return format!("none of {} real positions is within limits", count(real)),
        }
        let what = match (self.view.problem, end.summary.targets) {
            (Problem::Inverse, 1) => "the pose is out of reach".to_owned(),
            (Problem::Inverse, poses) => format!("all {} poses are out of reach", count(poses)),
            (_, 1) => "the mechanism cannot be assembled so".to_owned(),
            (_, targets) => format!(
                "it cannot be assembled at any of {} targets",
                count(targets)
            ),
        };
        match (complex, special) {
            (0, 0) => what,
            (1, 0) => format!("{what}; its only position is complex"),
            (regular, 0) => format!("{what}; all {} are complex", counted(regular, "position")),
            (regular, special) => format!(
                "{what}; {} and {special} at singular ones are complex",
                counted(regular, "position")
            ),
        }
    }

    fn positions(&self) -> String {
        let view = &self.view;
        let Some((_, _, first)) = self.positions.first() else {
            return String::new();
        };
        let forward = view.problem != Problem::Inverse;
        let mut headings: Vec<String> = vec![">#".into()];
        let values = &first.configuration.values;
        headings.extend(values.iter().map(|(name, _)| format!(">{name}")));
        if forward && first.configuration.output.is_some() {
            headings.extend(pose_columns(view).iter().map(|h| format!(">{h}")));
        }
        if self.has_limits() {
            headings.push("limits".into());
        }
        headings.push(">condition".into());
        let names: Vec<&str> = headings.iter().map(String::as_str).collect();
        let mut columns = Columns::new(&names);
        for (i, k, position) in &self.positions {
            let mut row = vec![format!("{i}.{k}")];
            let values = &position.configuration.values;
            row.extend(
                values
                    .iter()
                    .map(|(_, v)| real(without_rounding(view.value(v)), 6)),
            );
            if forward && let Some(pose) = &position.configuration.output {
                row.extend(
                    pose_numbers(view, pose)
                        .iter()
                        .map(|x| real(without_rounding(*x), 6)),
                );
            }
            if self.has_limits() {
                row.push(match position.violated.is_empty() {
                    true => "in".into(),
                    false => position.violated.join(" "),
                });
            }
            row.push(magnitude(position.condition));
            columns.row(row);
        }
        let mut text = columns.render(self.look);
        text.push_str(&self.singular());
        let shown = self.positions.len() as u64;
        if self.listed > shown {
            let _ = writeln!(
                text,
                "  {} more; all of them with --format json",
                count(self.listed - shown)
            );
        }
        text
    }

    /// The counts of all targets together.
    pub(super) fn total(&self) -> &Counts {
        &self.total
    }

    /// A line for each listed position that is one of a set.
    pub(super) fn set_lines(&self) -> Vec<String> {
        let positions = self.positions.iter();
        positions.filter_map(|p| self.set_line(p)).collect()
    }

    /// The line of a position that is one of a set; `None` where it stands alone.
    fn set_line(&self, (i, k, position): &(u64, usize, Position)) -> Option<String> {
        let mut sets = self.sets.iter();
        let (_, set) = sets.find(|(target, set)| target == i && set.posture == *position)?;
        let spans = set.spans.iter();
        let spans = spans.map(|(joint, span)| self.view.span(joint, *span));
        let spans = spans.collect::<Vec<String>>().join(", ");
        Some(format!(
            "{i}.{k} is one of a set of dimension {}: {} move while the tool is at rest{}{spans}",
            set.dimension,
            position.dependent.join(", "),
            if spans.is_empty() { "" } else { "; " },
        ))
    }

    /// A line for each singular posture, and for each set.
    fn singular(&self) -> String {
        let mut text = String::new();
        let singular = self.positions.iter().filter(|(_, _, p)| p.is_singular);
        for listed in singular {
            let (i, k, position) = listed;
            let joints = position.dependent.join(", ");
            let _ = match self.set_line(listed) {
                Some(line) => writeln!(text, "  {line}"),
                None if joints.is_empty() => writeln!(text, "  {i}.{k} is singular"),
                None => writeln!(
                    text,
                    "  {i}.{k} is singular, counted {} times: {joints} can begin to move while the tool is at rest",
                    position.multiplicity
                ),
            };
        }
        for (target, number) in &self.complex_singular {
            let _ = match number {
                1 => writeln!(
                    text,
                    "  the other 1 solution counted as singular for target {target} is complex"
                ),
                number => writeln!(
                    text,
                    "  the other {number} solutions counted as singular for target {target} are complex"
                ),
            };
        }
        text
    }
}

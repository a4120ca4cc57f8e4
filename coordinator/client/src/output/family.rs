//! A family at many values of its parameters, for people and for programs: the list of components at each, and where it
//! changes.

use super::text::{Columns, Look, complex, count, counted};
use crate::error::Exit;
use cognate_summary::decomposition::DecompositionSummary;
use num_complex::Complex64;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Parameters whose values the table shows.
const PARAMETERS_SHOWN: usize = 4;

/// The family at some values.
pub struct Member {
    values: Vec<Complex64>,
    found: DecompositionSummary,
}

/// Dimension, degree and multiplicity of components, with how many there are.
type Listed = BTreeMap<(u32, u64, Option<u64>), u64>;

impl Member {
    /// A member of the family: the values and the decomposition at these values.
    pub fn new(values: Vec<Complex64>, summary: DecompositionSummary) -> Self {
        Self {
            values,
            found: summary,
        }
    }

    fn listed(&self) -> Listed {
        let mut listed = Listed::new();
        for c in &self.found.decomposition.components {
            let key = (c.dimension, c.degree, c.multiplicity);
            *listed.entry(key).or_default() += c.count;
        }
        listed
    }
}

/// The family at all values.
pub struct Sweep {
    /// Name of the problem.
    pub name: String,
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// The member at general values.
    pub general: Member,
    /// The members at the values that were given, in their order.
    pub members: Vec<Member>,
}

impl Sweep {
    /// The exit code that this answer has.
    pub fn exit(&self) -> Exit {
        let settled = |member: &Member| member.found.settled;
        Exit::of_settled(settled(&self.general) && self.members.iter().all(settled))
    }

    /// Whether the list at each values is another than at the values before, at the first than at general ones.
    fn changes(&self) -> Vec<bool> {
        let before = std::iter::once(&self.general).chain(&self.members);
        let pairs = before.zip(&self.members);
        pairs.map(|(a, b)| a.listed() != b.listed()).collect()
    }

    /// One JSON object.
    pub fn json(&self) -> String {
        let member = |member: &Member| {
            let pairs = self.parameters.iter().zip(&member.values);
            let values: Map<String, Value> = pairs
                .map(|(name, z)| (name.clone(), json!([z.re, z.im])))
                .collect();
            json!({"parameters": values, "settled": member.found.settled,
                   "decomposition": member.found.decomposition})
        };
        let mut members: Vec<Value> = self.members.iter().map(member).collect();
        for (value, changed) in members.iter_mut().zip(self.changes()) {
            value["changed"] = json!(changed);
        }
        let settled = self.exit() == Exit::Solved;
        let whole = json!({"name": self.name, "settled": settled, "general": member(&self.general),
                           "members": members});
        format!("{whole:#}\n")
    }

    /// The table; `files` is the folder with a set for each member.
    pub fn table(&self, files: Option<&Path>) -> String {
        let look = Look::of_standard_output();
        let changes = self.changes();
        let changed = changes.iter().filter(|changed| **changed).count() as u64;
        let mut text = format!(
            "{}: {} of parameters; the list of components changes {}\n\n",
            look.bold(&self.name),
            counted(self.members.len() as u64, "set"),
            counted(changed, "time"),
        );
        let shown = self.parameters.len().min(PARAMETERS_SHOWN);
        let mut headings = vec![">#"];
        headings.extend(self.parameters[..shown].iter().map(String::as_str));
        headings.extend(["components", "", "from the general ones"]);
        let mut columns = Columns::new(&headings);
        let general = std::iter::once(("general".to_owned(), &self.general, false));
        let others = self.members.iter().zip(&changes).enumerate();
        let others = others.map(|(k, (member, changed))| ((k + 1).to_string(), member, *changed));
        for (name, member, changed) in general.chain(others) {
            let mut row = vec![name];
            row.extend(member.values[..shown].iter().map(|&z| complex(z, 6, 1e-12)));
            row.push(in_words(&member.listed()));
            row.push(match (member.found.settled, changed) {
                (false, _) => look.warn("not settled"),
                (true, true) => look.bold("changed"),
                (true, false) => String::new(),
            });
            row.push(carried(member));
            columns.row(row);
        }
        text.push_str(&columns.render(look));
        if let Some(folder) = files {
            let _ = writeln!(
                text,
                "\n{}",
                look.dim(&format!("sets are in {}", folder.display()))
            );
        }
        text
    }
}

/// The list of components by dimension, highest first.
fn in_words(listed: &Listed) -> String {
    let mut text = String::new();
    let mut last = None;
    for (&(dimension, degree, multiplicity), &n) in listed.iter().rev() {
        match last == Some(dimension) {
            true => text.push_str(" + "),
            false if text.is_empty() => {}
            false => text.push_str("; "),
        }
        if last != Some(dimension) {
            let _ = write!(text, "dimension {dimension}: ");
        }
        last = Some(dimension);
        if n > 1 {
            let _ = write!(text, "{} x ", count(n));
        }
        let _ = match dimension {
            0 => write!(text, "point"),
            _ => write!(text, "degree {}", count(degree)),
        };
        let _ = match multiplicity {
            Some(1) => Ok(()),
            Some(m) => write!(text, " ({m} times)"),
            None => write!(text, " (? times)"),
        };
    }
    match text.is_empty() {
        true => "none".into(),
        false => text,
    }
}

/// Which components of the general member split and join, or why that is not known.
fn carried(member: &Member) -> String {
    let Some(family) = &member.found.decomposition.family else {
        return String::new();
    };
    if family.dimension.is_none() {
        return format!("found anew: {}", family.reason);
    }
    let mut parts = Vec::new();
    if !family.split.is_empty() {
        let split = family.components.iter().filter(|c| c.becomes.len() > 1);
        parts.extend(split.map(|c| {
            let into: Vec<&str> = c.becomes.iter().map(|b| b.id.as_str()).collect();
            format!("{} splits into {}", c.id, into.join(", "))
        }));
    }
    parts.extend(family.joined.iter().map(|id| {
        let from = family.components.iter();
        let from = from.filter(|c| c.becomes.iter().any(|b| &b.id == id));
        let from: Vec<&str> = from.map(|c| c.id.as_str()).collect();
        format!("{} join in {id}", from.join(", "))
    }));
    let infinite: u64 = family.components.iter().map(|c| c.at_infinity).sum();
    if infinite > 0 {
        parts.push(format!("{} to infinity", counted(infinite, "point")));
    }
    let elsewhere: u64 = family.components.iter().map(|c| c.elsewhere).sum();
    if elsewhere > 0 {
        parts.push(format!("{} to higher sets", counted(elsewhere, "point")));
    }
    parts.join("; ")
}

//! Definitions: named expressions that may use each other in any order.
//!
//! They are built so that each comes after those that it uses; the walk keeps
//! its own stack, so that a long chain of definitions cannot exhaust the machine's.

use super::constants::constant;
use crate::expression::NodeId;
use crate::expression::build::{Builder, Use};
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::parse::{Names, Parsed};

/// Definitions of one file.
pub(crate) struct Definitions<'a> {
    /// The file's names.
    pub names: &'a Names,
    /// Each name that is defined, with its expression.
    pub list: Vec<(u32, &'a Parsed)>,
}

impl Definitions<'_> {
    /// Builds all of them: fills `values`, which holds already what is not defined but declared. Names of constants that are
    /// neither get these as values.
    ///
    /// `place` may add to a fault where the definition with an index stands.
    pub(crate) fn build<E>(
        &self,
        builder: &mut Builder,
        values: &mut [Option<NodeId>],
        usage: Use,
        place: &mut dyn FnMut(usize, Fault) -> E,
    ) -> Result<(), E> {
        let mut definition_of: Vec<Option<usize>> = vec![None; self.names.count()];
        for (i, (name, _)) in self.list.iter().enumerate() {
            definition_of[*name as usize] = Some(i);
        }
        for name in 0..self.names.count() {
            if values[name].is_none() && definition_of[name].is_none() {
                values[name] = constant(self.names, name as u32, &mut builder.expressions);
            }
        }
        let uses: Vec<Vec<(u32, Span)>> = self.list.iter().map(|(_, p)| names_in(p)).collect();
        for (i, used) in uses.iter().enumerate() {
            for &(name, span) in used {
                if values[name as usize].is_none() && definition_of[name as usize].is_none() {
                    let declared = (0..self.names.count())
                        .filter(|&n| values[n].is_some() || definition_of[n].is_some());
                    let declared = declared.map(|n| self.names.name(n as u32));
                    let problem = Problem::unknown(self.names.name(name), declared);
                    return Err(place(i, Fault::new(span, problem)));
                }
            }
        }
        let mut open = vec![false; self.list.len()];
        for root in 0..self.list.len() {
            // Definitions that wait for others, each with the next name to look at.
            let mut waiting = vec![(root, 0)];
            while let Some(&mut (i, ref mut next)) = waiting.last_mut() {
                let name = self.list[i].0;
                if values[name as usize].is_some() {
                    waiting.pop();
                    continue;
                }
                open[i] = true;
                let missing = uses[i][*next..]
                    .iter()
                    .position(|&(used, _)| values[used as usize].is_none());
                if let Some(offset) = missing {
                    let (used, span) = uses[i][*next + offset];
                    *next += offset;
                    let needed = definition_of[used as usize].expect("unknown names are refused");
                    if open[needed] {
                        let from = waiting.iter().position(|&(w, _)| w == needed).unwrap_or(0);
                        let mut cycle: Vec<String> = waiting[from..]
                            .iter()
                            .map(|&(w, _)| self.names.name(self.list[w].0).to_string())
                            .collect();
                        cycle.push(self.names.name(used).to_string());
                        return Err(place(i, Fault::new(span, Problem::Cycle(cycle))));
                    }
                    waiting.push((needed, 0));
                    continue;
                }
                let built = builder
                    .build(self.list[i].1, usage, &mut |_, name, _| {
                        Ok(values[name as usize].expect("what a definition uses was built before"))
                    })
                    .map_err(|fault| place(i, fault))?;
                values[name as usize] = Some(built);
                open[i] = false;
                waiting.pop();
            }
        }
        Ok(())
    }
}

/// The names in an expression, each once, in order of appearance.
fn names_in(parsed: &Parsed) -> Vec<(u32, Span)> {
    let mut seen = std::collections::HashSet::new();
    let names = parsed.names();
    names.filter(|(name, _)| seen.insert(*name)).collect()
}

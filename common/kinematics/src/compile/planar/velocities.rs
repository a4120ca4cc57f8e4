//! First-order motions of a planar linkage: how far its loops open, and its driven joints or its output move, by the velocities
//! of turns and shifts. The rank of these rows is smaller where the linkage is singular.
//!
//! The velocity w of a turn g is a logarithmic derivative: dg = g w and dG = -G w, so that no row for g G = 1 is left.

use super::Planar;
use crate::compile::text;
use crate::mechanism::{Joint, JointKind, Output};

/// The part of a mechanism that stands still while another part may move.
pub(in crate::compile) enum Held<'a> {
    /// Joints, by name.
    Joints(&'a [String]),
    /// The output, or a point of it.
    Output(&'a Output),
}

/// Linear conditions on first-order motions.
pub(in crate::compile) struct VelocityMatrix {
    /// Conditions, each with an entry for every column.
    pub rows: Vec<Vec<String>>,
    /// Velocities that are not 0 already because something is held.
    pub columns: usize,
    /// Turns and shifts less the equations of loops: the freedoms by counting.
    pub freedoms: i64,
    /// Velocities that are held.
    pub held: usize,
    /// Whether there are loops.
    pub has_loops: bool,
}

/// A linear form in the velocities: of each column the terms that its coefficient is the sum of.
#[derive(Clone)]
struct Form(Vec<Vec<String>>);

impl Form {
    fn add(&mut self, column: usize, is_negative: bool, term: &str) {
        if term != "0" {
            self.0[column].push(match is_negative {
                true => format!("(-{term})"),
                false => term.to_owned(),
            });
        }
    }

    fn subtract(&mut self, other: &Self) {
        for (terms, subtracted) in self.0.iter_mut().zip(&other.0) {
            terms.extend(subtracted.iter().map(|term| format!("(-{term})")));
        }
    }
}

/// Velocities that are equal: of each the number of its set. The first belongs to the ground, and is 0.
struct EqualVelocities(Vec<usize>);

impl EqualVelocities {
    /// Makes two velocities equal; `false` where they are already.
    fn join(&mut self, first: usize, second: usize) -> bool {
        let [first, second] = [self.0[first], self.0[second]];
        for set in &mut self.0 {
            if *set == second {
                *set = first;
            }
        }
        first != second
    }

    /// Coefficients of the sets that are not the ground's.
    fn coefficients(&self, form: &Form) -> Vec<String> {
        let coefficient = |set: usize| {
            let columns = self.0.iter().skip(1).zip(&form.0);
            let terms = columns.filter(|(other, _)| **other == set);
            let terms: Vec<String> = terms.flat_map(|(_, terms)| terms.clone()).collect();
            text::sum(&terms)
        };
        self.sets().into_iter().map(coefficient).collect()
    }

    fn sets(&self) -> Vec<usize> {
        let mut sets: Vec<usize> = self.0.clone();
        sets.retain(|set| *set != self.0[0]);
        sets.sort_unstable();
        sets.dedup();
        sets
    }
}

impl Planar {
    /// Joints that shift, each of which has a column after those of the turns.
    fn shifts(&self) -> Vec<usize> {
        let joints = self.linkage.joints.iter().enumerate();
        let shifts = joints.filter(|(_, joint)| joint.kind == JointKind::P);
        shifts.map(|(j, _)| j).collect()
    }

    /// Adds how an expression changes that turns with a link.
    fn add_turned(&self, form: &mut Form, link: usize, bar: bool, signed: (bool, &str)) {
        let (is_negative, term) = signed;
        if let Some(column) = self.turns[link].class.checked_sub(1) {
            form.add(column, is_negative != bar, term);
        }
    }

    fn add_arm(&self, form: &mut Form, joint: &Joint, side: usize, bar: bool) {
        let arm = self.arm_text(joint, side, bar);
        self.add_turned(form, joint.links[side], bar, (false, &arm));
    }

    fn subtract_arm(&self, form: &mut Form, joint: &Joint, side: usize, bar: bool) {
        let arm = self.arm_text(joint, side, bar);
        self.add_turned(form, joint.links[side], bar, (true, &arm));
    }

    fn add_shift(&self, form: &mut Form, j: usize, bar: bool, is_negative: bool) {
        let joint = &self.linkage.joints[j];
        let Some(place) = self.shifts().iter().position(|other| *other == j) else {
            return;
        };
        let along = self.direction_text(joint, bar);
        let turned = text::times(&self.turn_text(joint.links[0], bar), &along);
        form.add(self.classes() + place, is_negative, &turned);
        let shift = self.shift_text(j, bar);
        self.add_turned(form, joint.links[0], bar, (is_negative, &shift));
    }

    /// How the places of the links change.
    fn place_forms(&self, bar: bool) -> Vec<Form> {
        let columns = self.classes() + self.shifts().len();
        let mut forms = vec![Form(vec![Vec::new(); columns]); self.linkage.links.len()];
        for (j, from) in &self.tree {
            let joint = &self.linkage.joints[*j];
            let mut form = forms[joint.links[*from]].clone();
            self.add_arm(&mut form, joint, *from, bar);
            self.add_shift(&mut form, *j, bar, *from != 0);
            self.subtract_arm(&mut form, joint, 1 - from, bar);
            forms[joint.links[1 - from]] = form;
        }
        forms
    }

    /// How far the loops open, two forms for each.
    fn loop_forms(&self) -> Vec<Form> {
        let tree: Vec<usize> = self.tree.iter().map(|(j, _)| *j).collect();
        let places = [false, true].map(|bar| self.place_forms(bar));
        let mut forms = Vec::new();
        for (j, joint) in self.linkage.joints.iter().enumerate() {
            if tree.contains(&j) {
                continue;
            }
            for bar in [false, true] {
                let places = &places[usize::from(bar)];
                let mut form = places[joint.links[0]].clone();
                self.add_arm(&mut form, joint, 0, bar);
                self.add_shift(&mut form, j, bar, false);
                form.subtract(&places[joint.links[1]]);
                self.subtract_arm(&mut form, joint, 1, bar);
                forms.push(form);
            }
        }
        forms
    }

    /// Conditions on the motions that are left while something is held; an error where that is held already by the rest.
    pub(in crate::compile) fn velocities(&self, held: &Held<'_>) -> Result<VelocityMatrix, String> {
        let mut forms = self.loop_forms();
        let columns = self.classes() + self.shifts().len();
        let freedoms = columns as i64 - forms.len() as i64;
        let has_loops = !forms.is_empty();
        let mut equal = EqualVelocities((0..=columns).collect());
        let count = match held {
            Held::Joints(names) => {
                self.hold_joints(names, &mut equal)?;
                names.len()
            }
            Held::Output(output) => {
                let output_forms = self.hold_output(output, &mut equal)?;
                forms.extend(output_forms);
                if output.point.is_some() { 2 } else { 3 }
            }
        };
        let rows = forms.iter().map(|form| equal.coefficients(form));
        // A condition without a velocity holds in all positions.
        let rows = rows.filter(|row| row.iter().any(|entry| entry != "0"));
        Ok(VelocityMatrix {
            rows: rows.collect(),
            columns: equal.sets().len(),
            freedoms,
            held: count,
            has_loops,
        })
    }

    fn hold_joints(&self, names: &[String], equal: &mut EqualVelocities) -> Result<(), String> {
        for name in names {
            let joints = &self.linkage.joints;
            let j = joints.iter().position(|joint| joint.name == *name);
            let j = j.ok_or_else(|| format!("--input {name}: there is no such joint"))?;
            let shift = self.shifts().iter().position(|other| *other == j);
            let [first, second] = match shift {
                Some(place) => [0, 1 + self.classes() + place],
                None => joints[j].links.map(|link| self.turns[link].class),
            };
            if !equal.join(first, second) {
                return Err(format!(
                    "input {name} follows from the other inputs in every position: leave it out"
                ));
            }
        }
        Ok(())
    }

    fn hold_output(
        &self,
        output: &Output,
        equal: &mut EqualVelocities,
    ) -> Result<Vec<Form>, String> {
        let links = &self.linkage.links;
        let link = links.iter().position(|name| *name == output.link);
        let link = link.ok_or_else(|| format!("there is no link {}", output.link))?;
        let form = |bar: bool| {
            let mut form = self.place_forms(bar).swap_remove(link);
            if let Some(point) = &output.point {
                let arm = text::times(&self.turn_text(link, bar), &self.number_pair(point, bar));
                self.add_turned(&mut form, link, bar, (false, &arm));
            }
            form
        };
        if output.point.is_none() {
            equal.join(0, self.turns[link].class);
        }
        Ok([false, true].map(form).to_vec())
    }
}

//! Plan: over which values of u the sections of a surface are taken, and the marks of each.
//!
//! The input are the curves on the surface, tracked between the levels. The output are sections without points, and the
//! fibres that they need.

use super::super::real_curve::{NEAR_LEVELS, sections, value};
use super::mesh::helpful;
use super::section::{Approach, Mark, Place, Section};
use cognate_solutions::witness::real_curve::{RealCurve, VertexKind};
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::ops::Range;

/// Marks of a level nearer than this, relative to their size, are one. At a level near another one, folds come near
/// each other that are two, and sheets pass between them.
const SAME_MARK: f64 = 1e-9;
/// Marks of a level where the surface is singular, of which fewer digits are known, are one within this, relative to
/// their size.
const SAME_SINGULAR_MARK: f64 = 1e-5;
/// A vertex is at a level within this part of the range.
const AT_LEVEL: f64 = 1e-6;
/// A point of a curve is one of a section within this part of the distance to the nearest other section.
const SAME_SECTION: f64 = 1e-2;

/// All sections of a component, with what comes to the levels.
pub(super) struct Plan {
    /// Sections by growing u; of levels and of slabs.
    pub sections: Vec<Section>,
    /// For each section the level that it is of.
    pub levels: Vec<Option<usize>>,
    /// For each level the mark to which each arc of critical points comes from below and from above.
    pub limits: Vec<[BTreeMap<usize, usize>; 2]>,
    /// Sections still nearer to each level, below and above: by them sheets of the level are told where those of the
    /// others lie over other values of v. The nearest last.
    pub near: Vec<[Vec<Section>; 2]>,
    /// Whether points are singular, by name of their arc.
    pub singular: Vec<bool>,
}

/// The marks of all sections.
pub(super) struct Collected {
    levels: Vec<f64>,
    /// The range of the levels, or the size of u.
    range: f64,
    /// The order of magnitude of v.
    size: f64,
    samples: u32,
    /// Values of u in each slab, ascending, with the values near levels.
    values: Vec<Vec<f64>>,
    /// Distance to the next section, by slab and section.
    nearest: Vec<Vec<f64>>,
    /// Marks by slab and section; `None` near a level where some are missing.
    marks: Vec<Vec<Option<Vec<Mark>>>>,
    at_levels: Vec<Vec<Mark>>,
    /// For each level the mark to which each arc of critical points comes from below and from above.
    limits: Vec<[BTreeMap<usize, usize>; 2]>,
    /// Whether points are singular, by name of their arc.
    singular: Vec<bool>,
}

impl Collected {
    /// Nothing yet; `sizes`: orders of magnitude of u and v.
    pub fn new(levels: &[f64], sizes: [f64; 2], samples: u32) -> Self {
        let range = match (levels.first(), levels.last()) {
            (Some(first), Some(last)) if last > first => last - first,
            _ => sizes[0],
        };
        let values = sections(levels, sizes[0], samples);
        Self {
            levels: levels.to_vec(),
            range,
            size: sizes[1],
            samples,
            nearest: values.iter().map(|v| gaps(v)).collect(),
            marks: values
                .iter()
                .map(|v| vec![Some(Vec::new()); v.len()])
                .collect(),
            values,
            at_levels: vec![Vec::new(); levels.len()],
            limits: vec![[BTreeMap::new(), BTreeMap::new()]; levels.len()],
            singular: Vec::new(),
        }
    }

    /// The marks of a curve; a value of u over which some are missing.
    pub fn add(
        &mut self,
        curve: &RealCurve,
        singular: bool,
        forms: &[Vec<[i32; 2]>; 3],
    ) -> Result<(), f64> {
        let place = |point: &[Complex64]| [0, 1, 2].map(|k| value(&forms[k], point));
        let mut marks = Vec::with_capacity(curve.vertices.len());
        for vertex in &curve.vertices {
            // Where the outline is singular, sheets come as near as beside a double curve.
            let approach = match vertex.kind {
                _ if singular || vertex.is_singular() => Approach::Singular,
                VertexKind::Regular => Approach::Fold,
                _ => Approach::Critical,
            };
            let level = self.level_of(vertex.value);
            marks.push(level.map(|level| {
                let mark = self.at_level(level, place(&vertex.point), approach);
                (level, mark)
            }));
        }
        for edge in &curve.edges {
            let name = self.singular.len();
            self.singular.push(singular);
            let places: Vec<Place> = edge.samples.iter().map(|p| place(p)).collect();
            let middle = places[places.len() / 2][0];
            let slab = self.levels.partition_point(|&level| level < middle);
            let mut places = places.into_iter().peekable();
            let needed = self.needed(slab);
            for (k, &value) in self.values[slab].iter().enumerate() {
                let near = |place: &Place| {
                    (value - place[0]).abs() <= SAME_SECTION * self.nearest[slab][k]
                };
                let Some(place) = places.next_if(near) else {
                    match needed.contains(&k) {
                        true => return Err(value),
                        false => self.marks[slab][k] = None,
                    }
                    continue;
                };
                if let Some(marks) = &mut self.marks[slab][k] {
                    marks.push(Mark {
                        place,
                        name,
                        approach: match singular {
                            true => Approach::Singular,
                            false => Approach::Fold,
                        },
                    });
                }
            }
            if let Some(place) = places.next() {
                return Err(place[0]);
            }
            for (side, end) in edge.ends.iter().enumerate() {
                if let Some((level, mark)) = end.and_then(|end| marks[end]) {
                    // The lower end of an arc is at a level that the arc reaches from above.
                    self.limits[level][1 - side].insert(name, mark);
                }
            }
        }
        Ok(())
    }

    /// The sections of a slab that are not only near levels.
    fn needed(&self, slab: usize) -> Range<usize> {
        let near = |level: bool| if level { NEAR_LEVELS.len() } else { 0 };
        near(slab > 0)..self.values[slab].len() - near(slab < self.levels.len())
    }

    /// The level nearest to a value, where it is that one.
    fn level_of(&self, value: f64) -> Option<usize> {
        let apart = |k: &usize| (self.levels[*k] - value).abs();
        let nearest = (0..self.levels.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest.filter(|k| apart(k) <= AT_LEVEL * self.range)
    }

    /// The mark of a level at this place, by name.
    fn at_level(&mut self, level: usize, place: Place, approach: Approach) -> usize {
        let marks = &mut self.at_levels[level];
        let same = |m: &&mut Mark| {
            let within = match m.approach.max(approach) {
                Approach::Singular => SAME_SINGULAR_MARK,
                Approach::Fold | Approach::Critical => SAME_MARK,
            };
            apart(&m.place, &place) <= within
        };
        if let Some(mark) = marks.iter_mut().find(same) {
            mark.approach = mark.approach.max(approach);
            return mark.name;
        }
        let name = marks.len();
        marks.push(Mark {
            place,
            name,
            approach,
        });
        name
    }

    /// A range of v with all marks well inside.
    fn window(&self) -> [f64; 2] {
        let of_slabs = self.marks.iter().flatten().flatten();
        let marks = of_slabs.chain(&self.at_levels).flatten();
        let limits = (f64::INFINITY, f64::NEG_INFINITY);
        let values = marks.map(|mark| mark.place[1]);
        let (low, high) = values.fold(limits, |(low, high), v| (low.min(v), high.max(v)));
        let margin = match high > low {
            true => 0.4 * (high - low),
            false => self.size,
        };
        match low <= high {
            true => [low - margin, high + margin],
            false => [-margin, margin],
        }
    }

    /// All sections with their marks.
    pub fn plan(mut self, levels: &[f64]) -> Plan {
        let window = self.window();
        let needed: Vec<Range<usize>> = (0..self.values.len()).map(|k| self.needed(k)).collect();
        let mut plan = Plan {
            sections: Vec::new(),
            levels: Vec::new(),
            limits: Vec::new(),
            near: vec![[Vec::new(), Vec::new()]; levels.len()],
            singular: self.singular,
        };
        let last = levels.len();
        for (slab, (marks, values)) in self.marks.into_iter().zip(&self.values).enumerate() {
            let needed = &needed[slab];
            for (k, (marks, &u)) in marks.into_iter().zip(values).enumerate() {
                let Some(marks) = marks else { continue };
                if needed.contains(&k) {
                    let section = Section::new(u, marks, window, self.samples);
                    plan.sections.push(section);
                    plan.levels.push(None);
                    continue;
                }
                let section = Section::new(u, marks, window, 0);
                match k < needed.start {
                    true => plan.near[slab - 1][1].insert(0, section),
                    false => plan.near[slab][0].push(section),
                }
            }
            if slab < last {
                let level_marks = std::mem::take(&mut self.at_levels[slab]);
                let section = Section::new(levels[slab], level_marks, window, self.samples);
                // Names become places in order of v.
                for side in &mut self.limits[slab] {
                    for mark in side.values_mut() {
                        let is = |m: &Mark| m.name == *mark;
                        let place = section.marks.iter().position(is);
                        *mark = place.expect("it is one of them");
                    }
                }
                plan.sections.push(section);
                plan.levels.push(Some(slab));
            }
        }
        plan.limits = self.limits;
        plan.keep_helpful();
        plan
    }
}

impl Plan {
    /// Keeps of the sections near levels only those that tell something.
    fn keep_helpful(&mut self) {
        for (k, level) in self.levels.iter().enumerate() {
            let Some(level) = *level else { continue };
            for (side, beside) in [k - 1, k + 1].into_iter().enumerate() {
                let near = std::mem::take(&mut self.near[level][side]);
                let (level_section, beside) = (&self.sections[k], &self.sections[beside]);
                self.near[level][side] =
                    helpful(level_section, beside, near, &self.limits[level][side]);
            }
        }
    }

    /// Calls `take` with u and v of each fibre: first of the sections, then of the sections near levels.
    pub fn each_fibre(&self, take: &mut dyn FnMut(f64, f64)) {
        let near = self.near.iter().flatten().flatten();
        for section in self.sections.iter().chain(near) {
            for fibre in section.strips.iter().flat_map(|s| &s.fibres) {
                take(section.u, fibre.v);
            }
        }
    }

    /// Euler characteristic with compact support, and whether nothing goes to infinity.
    pub fn cells(&self) -> (i64, bool) {
        let mut euler = 0;
        let mut compact = true;
        let last = self.sections.len() - 1;
        let mut first_of_slab = true;
        for (section, level) in self.sections.iter().zip(&self.levels) {
            match level {
                Some(_) => {
                    euler += section.euler();
                    first_of_slab = true;
                }
                None if first_of_slab => {
                    euler -= section.euler();
                    first_of_slab = false;
                }
                None => {}
            }
            compact &= section
                .arcs
                .iter()
                .all(|arc| arc.ends.iter().all(Option::is_some));
        }
        let empty = |section: &Section| section.euler() == 0 && section.arcs.is_empty();
        compact &= empty(&self.sections[0]) && empty(&self.sections[last]);
        (euler, compact)
    }
}

/// Distance from each of these ascending values to the next one.
fn gaps(values: &[f64]) -> Vec<f64> {
    let gap = |k: usize| {
        let before = k.checked_sub(1).map(|before| values[k] - values[before]);
        let after = values.get(k + 1).map(|after| after - values[k]);
        let least = before
            .into_iter()
            .chain(after)
            .fold(f64::INFINITY, f64::min);
        // Alone, any distance is near.
        if least.is_finite() {
            least
        } else {
            values[k].abs().max(1.0)
        }
    };
    (0..values.len()).map(gap).collect()
}

/// The largest difference relative to the size of the first.
fn apart(a: &Place, b: &Place) -> f64 {
    let pairs = a.iter().zip(b);
    let apart = pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    apart / a.iter().map(|x| x.abs()).fold(1.0, f64::max)
}

//! The triangles between sections of a surface: arcs of neighbouring sections with the same ends belong together, and
//! at a level, where sections change, each arc has a chain of arcs of the level's section as its limit.

use super::section::{Mark, Place, Section, Strip};
use cognate_solutions::witness::real_surface::Mesh;
use std::collections::BTreeMap;

/// Parts of a strip of a level at which sections beside it are compared.
const LOOKS: [f64; 5] = [0.5, 0.25, 0.75, 0.1, 0.9];

/// A vertex of the mesh by where it is made: section, then a mark, or a strip, a fibre and a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Origin {
    Mark([usize; 2]),
    Sheet([usize; 4]),
}

/// Vertices with their values of v.
type Line = Vec<(f64, u32)>;

/// A mesh that grows; vertices are still in the three forms.
#[derive(Default)]
pub(super) struct Builder {
    places: Vec<Place>,
    known: BTreeMap<Origin, u32>,
    triangles: Vec<[u32; 3]>,
    segments: Vec<[u32; 2]>,
}

impl Builder {
    /// The mesh with its vertices in the variables.
    pub fn finish(self, to_variables: impl Fn(&Place) -> [f64; 3]) -> Mesh {
        Mesh {
            vertices: self.places.iter().map(to_variables).collect(),
            triangles: self.triangles,
            segments: self.segments,
        }
    }

    fn vertex(&mut self, origin: Origin, place: Place) -> u32 {
        let places = &mut self.places;
        *self.known.entry(origin).or_insert_with(|| {
            places.push(place);
            (places.len() - 1) as u32
        })
    }

    /// A mark of a section.
    pub fn mark(&mut self, (number, section): (usize, &Section), mark: usize) -> u32 {
        self.vertex(Origin::Mark([number, mark]), section.marks[mark].place)
    }

    /// The points of a sheet over a strip.
    fn sheet(&mut self, (number, section): (usize, &Section), [strip, sheet]: [usize; 2]) -> Line {
        let fibres = section.strips[strip].fibres.iter().enumerate();
        fibres
            .map(|(k, fibre)| {
                let origin = Origin::Sheet([number, strip, k, sheet]);
                (fibre.v, self.vertex(origin, fibre.real[sheet]))
            })
            .collect()
    }

    /// The points of an arc with its ends.
    fn arc(&mut self, numbered_section: (usize, &Section), arc: usize) -> Line {
        let section = numbered_section.1;
        let [from, to] = section.arcs[arc].ends;
        let mut line = Line::new();
        line.extend(from.map(|m| (section.marks[m].place[1], self.mark(numbered_section, m))));
        for &at in &section.arcs[arc].chain {
            line.extend(self.sheet(numbered_section, at));
        }
        line.extend(to.map(|m| (section.marks[m].place[1], self.mark(numbered_section, m))));
        line
    }

    /// A piece of a curve of marks.
    pub fn segment(&mut self, a: u32, b: u32) {
        if a != b {
            self.segments.push([a.min(b), a.max(b)]);
        }
    }

    /// Triangles between two lines, both by growing v.
    fn stitch(&mut self, a: &Line, b: &Line) {
        let part = |line: &Line, k: usize| {
            let (first, last) = (line[0].0, line[line.len() - 1].0);
            (line[k].0 - first) / (last - first).max(f64::MIN_POSITIVE)
        };
        let (mut i, mut j) = (0, 0);
        while i + 1 < a.len() || j + 1 < b.len() {
            let in_a = j + 1 == b.len() || (i + 1 < a.len() && part(a, i + 1) <= part(b, j + 1));
            let triangle = match in_a {
                true => [a[i].1, a[i + 1].1, b[j].1],
                false => [a[i].1, b[j + 1].1, b[j].1],
            };
            let [x, y, z] = triangle;
            if x != y && y != z && z != x {
                self.triangles.push(triangle);
            }
            match in_a {
                true => i += 1,
                false => j += 1,
            }
        }
    }

    /// The triangles between two sections of one slab; what does not fit.
    pub fn between(&mut self, a: (usize, &Section), b: (usize, &Section)) -> Result<(), String> {
        let (of_a, of_b) = (a.1.keys(), b.1.keys());
        let mut pairs = Vec::with_capacity(of_a.len());
        for (k, key) in of_a.iter().enumerate() {
            pairs.extend(of_b.iter().position(|other| other == key).map(|l| (k, l)));
        }
        if pairs.len() < of_a.len() || of_a.len() < of_b.len() {
            return Err(format!(
                "sections over {:.6} and {:.6} are not alike, though nothing lies between them",
                a.1.u, b.1.u
            ));
        }
        for (k, l) in pairs {
            let (first, second) = (self.arc(a, k), self.arc(b, l));
            self.stitch(&first, &second);
        }
        Ok(())
    }

    /// The triangles between the section of a level and the nearest one beside it. `limits`: the mark of the level to
    /// which each arc of critical points comes; `links`: the arc of the section beside it that comes to each sheet of
    /// each strip of the level.
    pub fn at_level(
        &mut self,
        level: (usize, &Section),
        beside: (usize, &Section),
        limits: &BTreeMap<usize, usize>,
        links: &[Vec<usize>],
    ) -> Result<(), String> {
        let unclear = |what: &str| format!("{what} at the level {:.6}", level.1.u);
        let (section, other) = (level.1, beside.1);
        let group_of = |mark: usize| {
            let group = section.groups.iter().position(|g| g.contains(&mark));
            group.expect("every mark is in a group")
        };
        let mut used = 0;
        for (k, arc) in other.arcs.iter().enumerate() {
            let limit = |end: Option<usize>| match end {
                None => Ok(None),
                Some(mark) => match limits.get(&other.marks[mark].name) {
                    Some(&mark) => Ok(Some(mark)),
                    None => Err(unclear("an arc of critical points ends nowhere")),
                },
            };
            let [from, to] = [limit(arc.ends[0])?, limit(arc.ends[1])?];
            let first = from.map_or(0, |mark| group_of(mark) + 1);
            let after = to.map_or(section.strips.len(), |mark| group_of(mark) + 1);
            let mut line = Line::new();
            line.extend(from.map(|m| (section.marks[m].place[1], self.mark(level, m))));
            let mut last: Option<usize> = None;
            for (strip, sheets) in links.iter().enumerate().take(after).skip(first) {
                let sheets_of_arc: Vec<usize> = sheets
                    .iter()
                    .enumerate()
                    .filter(|(_, arc)| **arc == k)
                    .map(|(sheet, _)| sheet)
                    .collect();
                let &[sheet] = sheets_of_arc.as_slice() else {
                    return Err(unclear("which sheet an arc comes to is not clear"));
                };
                used += 1;
                let arcs = section.arcs.iter();
                let mut arcs = arcs.enumerate();
                let here = arcs.find(|(_, a)| a.chain.contains(&[strip, sheet]));
                let (here, arc) = here.expect("every sheet is on an arc");
                // A mark of the level on the way.
                if last != Some(here) {
                    let begins = arc.ends[0].filter(|_| arc.chain[0] == [strip, sheet]);
                    let expected = if last.is_none() { from } else { begins };
                    if begins != expected || (last.is_some() && begins.is_none()) {
                        return Err(unclear(
                            "an arc does not begin where its critical point comes",
                        ));
                    }
                    if last.is_some() {
                        let mark = begins.expect("it is there");
                        line.push((section.marks[mark].place[1], self.mark(level, mark)));
                    }
                }
                last = Some(here);
                line.extend(self.sheet(level, [strip, sheet]));
            }
            if let Some(here) = last
                && section.arcs[here].ends[1] != to
            {
                return Err(unclear(
                    "an arc does not end where its critical point comes",
                ));
            }
            if from.is_none() || from != to {
                line.extend(to.map(|m| (section.marks[m].place[1], self.mark(level, m))));
            }
            if line.is_empty() {
                return Err(unclear("an arc has no limit"));
            }
            let arc_line = self.arc(beside, k);
            self.stitch(&arc_line, &line);
        }
        let sheets: usize = links.iter().map(Vec::len).sum();
        match used == sheets {
            true => Ok(()),
            false => Err(unclear("sheets are left over")),
        }
    }
}

/// The arc of a section that comes to each sheet of each strip of a level beside it. Where no value of v divides the
/// marks of both alike, one of the sections that are still nearer to the level, and have the same arcs, tells.
pub(super) fn links(
    level: &Section,
    beside: &Section,
    near: &[Section],
    limits: &BTreeMap<usize, usize>,
) -> Result<Vec<Vec<usize>>, String> {
    let arc_indices: Vec<usize> = (0..beside.arcs.len()).collect();
    let mut others = vec![(beside, arc_indices)];
    let keys = beside.keys();
    for other in near {
        let same = |key| keys.iter().position(|beside_key| beside_key == key);
        let arcs: Option<Vec<usize>> = other.keys().iter().map(same).collect();
        let arcs = arcs.filter(|arcs| arcs.len() == keys.len());
        others.extend(arcs.map(|arcs| (other, arcs)));
    }
    let mut links = Vec::with_capacity(level.strips.len());
    for strip in 0..level.strips.len() {
        let linked_arcs = others.iter().find_map(|(other, names)| {
            let arcs = LOOKS
                .into_iter()
                .find_map(|part| linked(level, strip, part, other, limits))?;
            Some(arcs.into_iter().map(|arc| names[arc]).collect())
        });
        links.push(linked_arcs.ok_or_else(|| {
            format!(
                "the sections over {:.6} and {:.6} do not go together",
                level.u, beside.u
            )
        })?);
    }
    Ok(links)
}

/// The arcs of a section over the value of v that divides a strip of a level in these parts; `None` where the marks do
/// not lie on the same sides of it, or there are not as many sheets.
fn linked(
    level: &Section,
    strip: usize,
    part: f64,
    other: &Section,
    limits: &BTreeMap<usize, usize>,
) -> Option<Vec<usize>> {
    let v = divided(level, strip, part, other, limits)?;
    let over = other.strip_at(v)?;
    let sheets = level.sheets(strip);
    if other.sheets(over) != sheets {
        return None;
    }
    let arc_of = |sheet: usize| {
        let mut arcs = other.arcs.iter();
        arcs.position(|arc| arc.chain.contains(&[over, sheet]))
    };
    (0..sheets).map(arc_of).collect()
}

/// The value of v that divides a strip of a level in these parts, where it divides the marks of a section beside the
/// level as it divides those of the level to which they come.
fn divided(
    level: &Section,
    strip: usize,
    part: f64,
    other: &Section,
    limits: &BTreeMap<usize, usize>,
) -> Option<f64> {
    let Strip { from, to, .. } = level.strips[strip];
    let v = from + part * (to - from);
    let stays = |(mark, on): (&Mark, &bool)| match limits.get(&mark.name) {
        Some(&limit) => (level.marks[limit].place[1] < v) == (mark.place[1] < v),
        None => !on,
    };
    let mut marks = other.marks.iter().zip(&other.on);
    marks.all(stays).then_some(v)
}

/// Of sections near a level, nearest last, those that divide a strip of the level as neither the section beside it nor
/// one before them does.
pub(super) fn helpful(
    level: &Section,
    beside: &Section,
    near: Vec<Section>,
    limits: &BTreeMap<usize, usize>,
) -> Vec<Section> {
    let clear = |strip: usize, other: &Section| {
        let mut values = LOOKS.into_iter();
        values.any(|part| divided(level, strip, part, other, limits).is_some())
    };
    let mut left: Vec<usize> = (0..level.strips.len()).collect();
    left.retain(|&strip| !clear(strip, beside));
    let mut helpful = near;
    helpful.retain(|other| {
        let before = left.len();
        left.retain(|&strip| !clear(strip, other));
        left.len() < before
    });
    helpful
}

#[cfg(test)]
mod tests {
    use super::super::section::{Approach, Fibre};
    use super::*;

    /// A circle in the section over u, between two values of v.
    fn circle(u: f64, ends: [f64; 2]) -> Section {
        let mark = |(name, v): (usize, f64)| Mark {
            place: [u, v, 0.0],
            name,
            approach: Approach::Fold,
        };
        let marks = ends.into_iter().enumerate().map(mark).collect();
        let mut section = Section::new(u, marks, [-10.0, 10.0], 1);
        let fibre = |v: f64| {
            let square = (v - ends[0]) * (ends[1] - v);
            let root = square.abs().sqrt();
            let real = |third: f64| [u, v, third];
            Ok(match square > 0.0 {
                true => Fibre {
                    v,
                    real: vec![real(-root), real(root)],
                    third: vec![[-root, 0.0], [root, 0.0]],
                    lost: None,
                },
                false => Fibre {
                    v,
                    third: vec![[0.0, -root], [0.0, root]],
                    ..Fibre::default()
                },
            })
        };
        let strips = section.strips.iter();
        let values: Vec<f64> = strips.flat_map(|s| &s.fibres).map(|f| f.v).collect();
        let filled = section.fill(&mut values.into_iter().map(fibre));
        filled.and_then(|()| section.connect()).expect("a circle");
        section
    }

    #[test]
    fn a_section_near_a_level_tells_where_the_others_lie_over_other_values() {
        let level = circle(0.0, [0.0, 1.0]);
        let limits = BTreeMap::from([(0, 0), (1, 1)]);
        let sheets = vec![vec![], vec![0, 1], vec![]];
        let beside = circle(1.0, [0.2, 1.1]);
        assert_eq!(links(&level, &beside, &[], &limits), Ok(sheets.clone()));
        assert!(helpful(&level, &beside, vec![circle(0.1, [0.1, 1.0])], &limits).is_empty());

        let far = circle(1.0, [1.5, 2.5]);
        assert!(links(&level, &far, &[], &limits).is_err());
        let near = circle(0.01, [0.1, 1.1]);
        let near = helpful(&level, &far, vec![near.clone(), near], &limits);
        assert_eq!(near.len(), 1);
        assert_eq!(links(&level, &far, &near, &limits), Ok(sheets));
    }

    /// The numbers of sheets are the same, the sheets are not.
    #[test]
    fn marks_on_the_other_side_are_no_link() {
        let level = circle(0.0, [0.0, 1.0]);
        let limits = BTreeMap::from([(0, 1), (1, 0)]);
        let crossed = circle(1.0, [0.0, 1.0]);
        assert!(links(&level, &crossed, &[], &limits).is_err());
    }
}

//! Section: a surface in space over one value of a real form u, by its fibres over values of a second form v.
//!
//! Marks are the points of the section where v is critical or the surface singular. Between their values the sheets of
//! the surface, ordered by a third form, do not meet. Beside a mark the sheets that come to it approach it faster than
//! in proportion to the others, which go on to the next strip in their order.

/// A real point in the three forms: u, v and the third.
pub(super) type Place = [f64; 3];

/// Part of the distance to the nearest other mark from which the sheets beside a mark are looked at: a sheet that
/// passes the mark nearer than this part would be taken for one that comes to it. Beside a pinch point marks come
/// together, and sheets look as beside a cusp from farther away.
const BESIDE: f64 = 2e-5;
/// Part of the distance to the nearest other mark from which sheets are looked at beside a mark where the surface is
/// singular: sheets come as near to one another there.
const BESIDE_SINGULAR: f64 = 2e-3;
/// Part of the distance to the nearest other mark from which sheets are looked at beside a mark where u is critical:
/// sheets come as near to one another there, too.
const BESIDE_CRITICAL: f64 = 2e-4;
/// Distance of the next look, as a part of the distance of the present one.
const NEARER: f64 = 1.0 / 16.0;
/// Least distance of a look, as a part of the size of v: marks are known to about 1e-15.
const NEAREST: f64 = 1e-11;
/// Least distance of a look beside a mark where u is critical, as a part of the size of v. The section is the one over
/// a u that is rounded to 1e-16, and it turns beside the mark by the square root of the rounding error.
const NEAREST_CRITICAL: f64 = 3e-6;
/// A sheet whose distance to the mark shrinks at least to this part comes to it: at a fold it shrinks to a quarter, at
/// a cusp of the projection to 0.4.
const COMES: f64 = 0.45;
/// A sheet whose distance to the mark stays above this part does not come to it.
const STAYS: f64 = 0.55;
/// Values of v nearer than this part of the size of their points are one: they are known to about 1e-15.
const SAME: f64 = 1e-12;
/// Values of v where the surface is singular are one within this part of the size of their points: half as many digits
/// are known.
const SAME_SINGULAR: f64 = 1e-7;
/// Sheets are looked at from no more than this part of the distance to the nearest other mark.
const FARTHEST: f64 = 0.1;

/// Form in which sheets come to a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Approach {
    /// The sheets turn at the mark: by the root of the distance in v.
    Fold,
    /// u is critical: at a node or an isolated point of the section in proportion to the distance, at a cusp of the
    /// outline by its third root.
    Critical,
    /// The surface is singular.
    Singular,
}

/// A point of the section where v is critical or the surface singular.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    pub place: Place,
    /// The arc of critical points that it is on, or its vertex.
    pub name: usize,
    pub approach: Approach,
}

/// The fibre over a value of v.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fibre {
    pub v: f64,
    /// The real points, by the third form.
    pub real: Vec<Place>,
    /// All points: v of u and v fixed, third forms as complex numbers.
    pub third: Vec<[f64; 2]>,
    /// Why its points are not known, beside a mark where others that are known may do.
    pub lost: Option<String>,
}

/// A strip of values of v between those of marks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Strip {
    /// At its ends; where no mark is, those of the window.
    pub from: f64,
    pub to: f64,
    /// Fibres by growing v.
    pub fibres: Vec<Fibre>,
    /// How many of the first and of the last are there to look at the marks at its ends.
    pub looks: [usize; 2],
}

/// A curve of the section on which v grows, between marks or to infinity.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Arc {
    /// Marks at its ends, by place.
    pub ends: [Option<usize>; 2],
    /// Strips and sheets that it passes.
    pub chain: Vec<[usize; 2]>,
}

/// The surface over one value of u.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Section {
    pub u: f64,
    /// Marks by growing v.
    pub marks: Vec<Mark>,
    /// Marks with one value of v, by place in `marks`.
    pub groups: Vec<Vec<usize>>,
    pub strips: Vec<Strip>,
    pub arcs: Vec<Arc>,
    /// Marks that are on the surface.
    pub on: Vec<bool>,
}

/// Sheets that come to a group of marks.
struct Beside {
    /// For each sheet of the strip before the group the mark to which it comes; `None`: it goes on.
    coming: Vec<Option<usize>>,
    /// For each sheet of the strip after the group the mark to which it comes; `None`: it goes on.
    leaving: Vec<Option<usize>>,
    /// For each mark whether it is on the surface.
    on: Vec<bool>,
}

impl Strip {
    /// Number of sheets.
    fn sheets(&self) -> usize {
        let whole_fibre = self.fibres.iter().find(|fibre| fibre.lost.is_none());
        whole_fibre.map_or(0, |fibre| fibre.real.len())
    }
}

/// Parts of a strip at which fibres are taken; `looks`: those beside the marks at its ends, from the border on, nearest
/// first; none where no mark is.
fn parts(samples: u32, looks: [&[f64]; 2]) -> Vec<f64> {
    let mut parts = vec![0.5];
    let count = f64::from(samples + 1);
    let farthest = looks.map(|looks| looks.last().copied().unwrap_or(0.0));
    for k in 1..=samples {
        let t = f64::from(k) / count;
        // Denser near the ends, where arcs turn; what looks at marks is nearer still.
        let part = 0.5 * t * (2.0 - t);
        parts.extend((0.5 - part > 2.0 * farthest[0]).then_some(0.5 - part));
        parts.extend((0.5 - part > 2.0 * farthest[1]).then_some(0.5 + part));
    }
    for (end, looks) in looks.into_iter().enumerate() {
        let from = |part: f64| if end == 0 { part } else { 1.0 - part };
        match looks {
            [] => parts.push(from(0.0)),
            looks => parts.extend(looks.iter().map(|&part| from(part))),
        }
    }
    parts.sort_by(f64::total_cmp);
    parts.dedup();
    parts
}

impl Section {
    /// The strips between these marks, in a window of v that holds all of them; fibres have no points yet.
    pub fn new(u: f64, mut marks: Vec<Mark>, window: [f64; 2], samples: u32) -> Self {
        marks.sort_by(|a, b| a.place[1].total_cmp(&b.place[1]));
        let size = |mark: &Mark| {
            mark.place
                .iter()
                .fold(0.0, |size: f64, x| size.max(x.abs()))
        };
        let same = |a: &Mark, b: &Mark| {
            let part = match a.approach.max(b.approach) {
                Approach::Singular => SAME_SINGULAR,
                Approach::Fold | Approach::Critical => SAME,
            };
            (a.place[1] - b.place[1]).abs() <= part * size(a).max(size(b))
        };
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (k, mark) in marks.iter().enumerate() {
            match groups.last_mut() {
                Some(group) if same(&marks[group[0]], mark) => group.push(k),
                _ => groups.push(vec![k]),
            }
        }
        let at = |group: &Vec<usize>| marks[group[0]].place[1];
        let mut borders = vec![window[0]];
        borders.extend(groups.iter().map(at));
        borders.push(window[1]);
        // How far from a group of marks its sheets are looked at, nearest first.
        let beside = |j: usize| -> Vec<f64> {
            let approach = groups[j].iter().map(|&m| marks[m].approach).max();
            let nearest = (borders[j + 1] - borders[j]).min(borders[j + 2] - borders[j + 1]);
            let size = groups[j]
                .iter()
                .map(|&m| size(&marks[m]))
                .fold(0.0, f64::max);
            let (part, least) = match approach {
                Some(Approach::Singular) => (BESIDE_SINGULAR, NEAREST),
                Some(Approach::Critical) => (BESIDE_CRITICAL, NEAREST_CRITICAL),
                Some(Approach::Fold) | None => (BESIDE, NEAREST),
            };
            let far = (part * nearest).max((least * size).min(FARTHEST * nearest));
            vec![far * NEARER, far]
        };
        let beside: Vec<Vec<f64>> = (0..groups.len()).map(beside).collect();
        let mut strips = Vec::new();
        for j in 0..=groups.len() {
            let (from, to) = (borders[j], borders[j + 1]);
            let ends = [j.checked_sub(1), (j < groups.len()).then_some(j)];
            let looks = ends.map(|group| {
                let looks = group.map(|group| beside[group].iter().map(|x| x / (to - from)));
                looks.into_iter().flatten().collect::<Vec<f64>>()
            });
            let values = parts(samples, [&looks[0], &looks[1]]);
            let fibre = |part: f64| Fibre {
                v: from + part * (to - from),
                ..Fibre::default()
            };
            strips.push(Strip {
                from,
                to,
                fibres: values.into_iter().map(fibre).collect(),
                looks: looks.map(|looks| looks.len()),
            });
        }
        Self {
            u,
            on: vec![true; marks.len()],
            marks,
            groups,
            strips,
            arcs: Vec::new(),
        }
    }

    /// Number of sheets in a strip.
    pub fn sheets(&self, strip: usize) -> usize {
        self.strips[strip].sheets()
    }

    /// The strip that holds a value of v.
    pub fn strip_at(&self, v: f64) -> Option<usize> {
        self.strips.iter().position(|s| s.from < v && v < s.to)
    }

    /// Takes its fibres from the next of these; what is not clear of one of them, where it is not one of several that
    /// look at a mark. All are taken in any case.
    pub fn fill(
        &mut self,
        fibres: &mut impl Iterator<Item = Result<Fibre, String>>,
    ) -> Result<(), String> {
        let mut clear = Ok(());
        for strip in &mut self.strips {
            let needed = strip.looks[0]..strip.fibres.len() - strip.looks[1];
            for (k, place) in strip.fibres.iter_mut().enumerate() {
                match fibres.next().expect("a fibre for each place") {
                    Ok(fibre) => *place = fibre,
                    Err(doubt) if !needed.contains(&k) => place.lost = Some(doubt),
                    Err(doubt) if clear.is_ok() => clear = Err(doubt),
                    Err(_) => {}
                }
            }
        }
        clear
    }

    /// Puts the arcs together; what does not fit.
    pub fn connect(&mut self) -> Result<(), String> {
        let u = self.u;
        for strip in &self.strips {
            let sheets = strip.sheets();
            let mut whole_fibres = strip.fibres.iter().filter(|f| f.lost.is_none());
            if whole_fibres.any(|f| f.real.len() != sheets) {
                return Err(format!(
                    "the number of real points changes between {:.6} and {:.6} over {u:.6}",
                    strip.from, strip.to
                ));
            }
        }
        // Arcs under way, by sheet.
        let mut open: Vec<usize> = Vec::new();
        for sheet in 0..self.sheets(0) {
            open.push(self.begin(None, [0, sheet]));
        }
        for j in 0..self.groups.len() {
            let Beside {
                coming,
                leaving,
                on,
            } = self.beside(j)?;
            for (&m, on) in self.groups[j].iter().zip(on) {
                self.on[m] = on;
            }
            let passing: Vec<usize> = coming
                .iter()
                .zip(&open)
                .filter(|(mark, _)| mark.is_none())
                .map(|(_, &arc)| arc)
                .collect();
            for (mark, &arc) in coming.iter().zip(&open) {
                if mark.is_some() {
                    self.arcs[arc].ends[1] = *mark;
                }
            }
            let mut passing = passing.into_iter();
            let mut next = Vec::with_capacity(leaving.len());
            for (sheet, mark) in leaving.iter().enumerate() {
                let at = [j + 1, sheet];
                next.push(match mark {
                    Some(_) => self.begin(*mark, at),
                    None => {
                        let arc = passing.next().expect("as many go on as come");
                        self.arcs[arc].chain.push(at);
                        arc
                    }
                });
            }
            open = next;
        }
        for strip in &mut self.strips {
            strip.fibres.retain(|fibre| fibre.lost.is_none());
        }
        Ok(())
    }

    /// Sheets that come to a group of marks and leave it, by the looks on either side. Looks from farther away are not
    /// used: beside pinch points other sheets seem to come.
    fn beside(&self, group: usize) -> Result<Beside, String> {
        let (left, right) = (&self.strips[group], &self.strips[group + 1]);
        let left: Vec<&Fibre> = left.fibres.iter().rev().take(left.looks[1]).collect();
        let right: Vec<&Fibre> = right.fibres.iter().take(right.looks[0]).collect();
        let mut doubts = Vec::new();
        for left in left.windows(2) {
            for right in right.windows(2) {
                let loss_of = |pair: &[&Fibre]| pair.iter().find_map(|fibre| fibre.lost.clone());
                let outcome = match loss_of(left).or_else(|| loss_of(right)) {
                    Some(lost) => Err(lost),
                    None => self.looked_at(group, [left[1], left[0]], [right[1], right[0]]),
                };
                match outcome {
                    Ok(beside) => return Ok(beside),
                    Err(doubt) => doubts.push(doubt),
                }
            }
        }
        Err(doubts.into_iter().next().expect("every mark is looked at"))
    }

    /// Sheets that come to a group of marks, by a farther and a nearer fibre on either side; the error is the doubt.
    fn looked_at(
        &self,
        group: usize,
        left: [&Fibre; 2],
        right: [&Fibre; 2],
    ) -> Result<Beside, String> {
        let coming = self.coming(group, left)?;
        let leaving = self.coming(group, right)?;
        let mut on = Vec::with_capacity(self.groups[group].len());
        for &m in &self.groups[group] {
            let count = |marks: &[Option<usize>]| marks.iter().filter(|c| **c == Some(m)).count();
            let (a, b) = (count(&coming), count(&leaving));
            if (a + b) % 2 == 1 {
                let (u, v) = (self.u, self.marks[m].place[1]);
                return Err(format!(
                    "{a} and {b} branches come to a critical point at ({u:.6}, {v:.6})"
                ));
            }
            on.push(a + b > 0 || self.is_on(m, left));
        }
        let passing = |marks: &[Option<usize>]| marks.iter().filter(|mark| mark.is_none()).count();
        let (past, goes_on) = (passing(&coming), passing(&leaving));
        match past == goes_on {
            true => Ok(Beside {
                coming,
                leaving,
                on,
            }),
            false => Err(format!(
                "{past} branches come past ({:.6}, {:.6}) and {goes_on} go on",
                self.u, self.strips[group].to
            )),
        }
    }

    fn begin(&mut self, mark: Option<usize>, at: [usize; 2]) -> usize {
        self.arcs.push(Arc {
            ends: [mark, None],
            chain: vec![at],
        });
        self.arcs.len() - 1
    }

    /// The mark of a group to which each sheet comes, by a farther and a nearer fibre beside it.
    fn coming(&self, group: usize, [far, near]: [&Fibre; 2]) -> Result<Vec<Option<usize>>, String> {
        let mut coming = vec![None; near.real.len()];
        for &m in &self.groups[group] {
            let mark = &self.marks[m].place;
            for (k, (far, near)) in far.real.iter().zip(&near.real).enumerate() {
                let part =
                    (near[2] - mark[2]).abs() / (far[2] - mark[2]).abs().max(f64::MIN_POSITIVE);
                if part < COMES {
                    coming[k] = Some(m);
                } else if part < STAYS {
                    let (u, v) = (self.u, mark[1]);
                    return Err(format!(
                        "whether a branch comes to the critical point at ({u:.6}, {v:.6}) is not clear"
                    ));
                }
            }
        }
        Ok(coming)
    }

    /// Whether two complex points of fibres beside a mark, to which no real ones come, come to it.
    fn is_on(&self, mark: usize, fibres: [&Fibre; 2]) -> bool {
        let third = self.marks[mark].place[2];
        let [far, near] = fibres.map(|fibre| {
            let distance = |z: &[f64; 2]| ((z[0] - third).powi(2) + z[1].powi(2)).sqrt();
            let mut distances: Vec<f64> = fibre.third.iter().map(distance).collect();
            distances.sort_by(f64::total_cmp);
            distances.get(1).copied()
        });
        far.zip(near).is_some_and(|(far, near)| near < COMES * far)
    }

    /// Places of the marks at the ends of each arc, by their names, and how many arcs with the same names begin before
    /// it, in the order of the arcs.
    pub fn keys(&self) -> Vec<(Option<usize>, Option<usize>, usize)> {
        let mut order: Vec<usize> = (0..self.arcs.len()).collect();
        order.sort_by_key(|&k| self.arcs[k].chain[0]);
        let mut keys = vec![(None, None, 0); self.arcs.len()];
        let mut seen: Vec<(Option<usize>, Option<usize>)> = Vec::new();
        for k in order {
            let [from, to] = self.arcs[k].ends.map(|end| end.map(|m| self.marks[m].name));
            let rank = seen
                .iter()
                .filter(|&&name_pair| name_pair == (from, to))
                .count();
            seen.push((from, to));
            keys[k] = (from, to, rank);
        }
        keys
    }

    /// Euler characteristic with compact support.
    pub fn euler(&self) -> i64 {
        self.on.iter().filter(|on| **on).count() as i64 - self.arcs.len() as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Else a sample would be taken for a look, from which sheets that come to a mark do not seem to come nearer.
    #[test]
    fn samples_come_no_nearer_to_a_mark_than_what_looks_at_it() {
        let looks = [1e-4, 2e-3, 3e-2];
        for samples in [1, 4, 20, 50] {
            let parts = parts(samples, [&looks, &[]]);
            assert_eq!(parts[..3], looks, "{samples}");
            assert!(parts[3] > 2.0 * looks[2], "{samples}");
            assert_eq!(parts.last(), Some(&1.0));
        }
    }
}

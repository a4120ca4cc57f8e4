//! The witness points of each component in files of their own: as objects of points, and as Bertini's track type 4 prints
//! them.

use super::files::{create, make_folder, scientific, write_file};
use crate::error::ClientError;
use cognate_continuation::start_points::StoredPoints;
use cognate_solutions::witness::WitnessSet;
use num_complex::Complex64;
use std::fmt::Write as _;
use std::path::Path;

/// Components of a dimension at most that have files of their own. More of them are isolated points, which are in one file.
const MOST_FILES: usize = 1000;

/// Writes `points/DIMENSION.COMPONENT.points`, or `points/0.points` for many isolated points; every bit of them.
pub(super) fn points(folder: &Path, sets: &[WitnessSet]) -> Result<(), ClientError> {
    let folder = folder.join("points");
    make_folder(&folder)?;
    for alike in sets.chunk_by(|a, b| a.id.dimension == b.id.dimension) {
        if alike.len() > MOST_FILES {
            let points = alike.iter().flat_map(|set| &set.points);
            let name = format!("{}.points", alike[0].id.dimension);
            write_points(&folder, &name, points)?;
            continue;
        }
        for set in alike {
            write_points(&folder, &format!("{}.points", set.id), set.points.iter())?;
        }
    }
    Ok(())
}

fn write_points<'a>(
    folder: &Path,
    name: &str,
    points: impl Iterator<Item = &'a Vec<Complex64>>,
) -> Result<(), ClientError> {
    let mut points = points.peekable();
    let dimension = points.peek().map_or(0, |point| point.len());
    let stored = StoredPoints {
        dimension,
        coordinates: points.flatten().copied().collect(),
    };
    let mut out = create(folder, name)?;
    out.write_bytes(&stored.to_bytes())?;
    out.finish()
}

/// Writes `witness_set_DIMENSION_COMPONENT`: the number of the points, then one coordinate a line, an empty line between
/// points.
pub(super) fn witness_sets(folder: &Path, sets: &[WitnessSet]) -> Result<(), ClientError> {
    for alike in sets.chunk_by(|a, b| a.id.dimension == b.id.dimension) {
        if alike.len() > MOST_FILES {
            continue;
        }
        for set in alike {
            let name = format!("witness_set_{}_{}", set.id.dimension, set.id.number);
            write_file(folder, &name, &list_of_points(&set.points))?;
        }
    }
    Ok(())
}

fn list_of_points(points: &[Vec<Complex64>]) -> String {
    let mut text = format!("{}\n\n", points.len());
    for point in points {
        for z in point {
            let _ = writeln!(text, "{} {}", scientific(z.re), scientific(z.im));
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_solutions::witness::{ComponentId, Evidence, Irreducible, Multiplicity};
    use std::sync::Arc;

    fn set(dimension: u32, number: u32) -> WitnessSet {
        let x = f64::from(number);
        let points = vec![vec![Complex64::new(x, -0.5), Complex64::new(1.0 / 3.0, 0.0)]; 2];
        WitnessSet {
            id: ComponentId { dimension, number },
            degree: 2,
            multiplicity: Multiplicity {
                scheme: Some(1),
                tracked: 1,
                dual_dimensions: Vec::new(),
            },
            irreducible: Irreducible::Yes,
            deflation: Vec::new(),
            self_conjugate: None,
            orbit: None,
            slice: Arc::new(Vec::new()),
            points,
            evidence: Evidence::default(),
        }
    }

    /// The folder of `decompose --output` lacked the files of components that were promised (2026-11-30).
    #[test]
    fn each_component_has_its_files_and_many_isolated_points_one() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut sets = vec![set(1, 1), set(1, 2)];
        sets.extend((1..=1001).map(|number| set(0, number)));
        points(folder.path(), &sets).expect("written");
        witness_sets(folder.path(), &sets).expect("written");
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect(name);
        let stored = StoredPoints::from_bytes(&read("points/1.2.points")).expect("points");
        assert_eq!(stored.coordinates, sets[1].points.concat());
        let isolated = StoredPoints::from_bytes(&read("points/0.points")).expect("points");
        assert_eq!(isolated.len(), 2002);
        let listed = String::from_utf8(read("witness_set_1_2")).expect("text");
        let lines: Vec<&str> = listed.lines().collect();
        assert_eq!((lines.len(), lines[0], lines[1]), (8, "2", ""));
        let numbers = lines[2].split(' ').map(|x| x.parse().expect("a number"));
        assert_eq!(numbers.collect::<Vec<f64>>(), [2.0, -0.5]);
        assert!(!folder.path().join("witness_set_0_1").exists());
    }
}

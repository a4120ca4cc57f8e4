//! The folder of --output: summary.json, solutions.jsonl, and Bertini's files of solutions.
//!
//! Everything is written as it comes, so that memory does not grow with the
//! number of solutions; counts go in front of Bertini's files at the end.

use super::listed::Listed;
use crate::error::ClientError;
use cognate_continuation::start_points::StoredPoints;
use cognate_solutions::solution::Solution;
use num_complex::Complex64;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::Permissions;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A folder that is being filled.
pub struct Folder {
    path: PathBuf,
    lines: Written,
    finite: BertiniFile,
    real_finite: BertiniFile,
    nonsingular: BertiniFile,
    singular: BertiniFile,
    /// Nonsingular solutions as an object of points, where a later solve may start from them.
    points: Option<Written>,
}

/// A file that has its name once it is whole: beside it until then, and gone where something fails. A
/// link of this name is replaced, not followed.
pub struct Written {
    path: PathBuf,
    file: BufWriter<NamedTempFile>,
}

/// A file without a name of its own yet, in a folder.
pub(super) fn unnamed(folder: &Path) -> std::io::Result<NamedTempFile> {
    tempfile::Builder::new()
        .prefix(".cognate-")
        // As the user's mask says.
        .permissions(Permissions::from_mode(0o666))
        .tempfile_in(folder)
}

/// A new file in the folder.
pub(super) fn create(folder: &Path, name: &str) -> Result<Written, ClientError> {
    Written::create(folder, name)
}

/// Makes the folder where it is not there.
pub(super) fn make_folder(path: &Path) -> Result<(), ClientError> {
    std::fs::create_dir_all(path).map_err(|e| cannot_write(path, e))
}

/// A file in a folder, which is there, with this text.
pub(crate) fn write_file(folder: &Path, name: &str, text: &str) -> Result<(), ClientError> {
    let mut out = create(folder, name)?;
    out.write(text)?;
    out.finish()
}

impl Written {
    fn create(folder: &Path, name: &str) -> Result<Self, ClientError> {
        let path = folder.join(name);
        let file = unnamed(folder).map_err(|e| cannot_write(&path, e))?;
        Ok(Self {
            path,
            file: BufWriter::new(file),
        })
    }

    pub(super) fn write(&mut self, text: &str) -> Result<(), ClientError> {
        self.write_bytes(text.as_bytes())
    }

    /// Writes a JSON object, laid out for reading.
    pub(super) fn write_json(&mut self, value: &impl Serialize) -> Result<(), ClientError> {
        let Self { path, file } = self;
        let written = serde_json::to_writer_pretty(&mut *file, value).map_err(std::io::Error::from);
        written
            .and_then(|()| file.write_all(b"\n"))
            .map_err(|e| cannot_write(path, e))
    }

    pub(super) fn write_bytes(&mut self, bytes: &[u8]) -> Result<(), ClientError> {
        let Self { path, file } = self;
        file.write_all(bytes).map_err(|e| cannot_write(path, e))
    }

    pub(super) fn finish(self) -> Result<(), ClientError> {
        let Self { path, file } = self;
        let whole = file.into_inner().map_err(|e| e.into_error());
        let named = whole.and_then(|file| file.persist(&path).map_err(|e| e.error));
        named.map(drop).map_err(|e| cannot_write(&path, e))
    }
}

pub(super) fn cannot_write(path: &Path, source: std::io::Error) -> ClientError {
    ClientError::File {
        action: "cannot write",
        path: path.to_path_buf(),
        source,
    }
}

/// Places kept for the count at the head of a file, which is known at the end.
const COUNT_PLACES: usize = 20;

/// Bertini's list of points: their number, then one coordinate a line, an empty line between points.
struct BertiniFile {
    out: Written,
    count: u64,
}

impl BertiniFile {
    fn create(folder: &Path, name: &str) -> Result<Self, ClientError> {
        let mut out = Written::create(folder, name)?;
        out.write(&format!("{:<COUNT_PLACES$}\n\n", 0))?;
        Ok(Self { out, count: 0 })
    }

    fn point(&mut self, solution: &Solution) -> Result<(), ClientError> {
        let mut text = String::new();
        for variable in &solution.variables.0 {
            let [re, im] = match &variable.digits {
                Some(digits) => digits.clone(),
                None => [scientific(variable.value.re), scientific(variable.value.im)],
            };
            text.push_str(&format!("{re} {im}\n"));
        }
        text.push('\n');
        self.count += 1;
        self.out.write(&text)
    }

    fn finish(mut self) -> Result<(), ClientError> {
        let head = format!("{:<COUNT_PLACES$}", self.count);
        let Written { path, file } = &mut self.out;
        file.seek(SeekFrom::Start(0))
            .and_then(|_| file.write_all(head.as_bytes()))
            .map_err(|e| cannot_write(path, e))?;
        self.out.finish()
    }
}

/// As Bertini and C write it: 17 significant digits, a sign and two digits in the exponent.
pub(super) fn scientific(x: f64) -> String {
    let text = format!("{x:.16e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            let (sign, digits) = match exponent.strip_prefix('-') {
                Some(digits) => ('-', digits),
                None => ('+', exponent),
            };
            format!("{mantissa}e{sign}{digits:0>2}")
        }
        None => text,
    }
}

impl Folder {
    /// Makes the folder where it does not exist, and the files in it.
    pub fn create(path: &Path) -> Result<Self, ClientError> {
        make_folder(path)?;
        Ok(Self {
            path: path.to_path_buf(),
            lines: Written::create(path, "solutions.jsonl")?,
            finite: BertiniFile::create(path, "finite_solutions")?,
            real_finite: BertiniFile::create(path, "real_finite_solutions")?,
            nonsingular: BertiniFile::create(path, "nonsingular_solutions")?,
            singular: BertiniFile::create(path, "singular_solutions")?,
            points: None,
        })
    }

    /// Writes the line of a solution that is shown.
    pub fn line(&mut self, listed: &Listed) -> Result<(), ClientError> {
        self.lines.write(&listed.line())
    }

    /// Writes one solution to every file of Bertini's that it belongs to, whether it is shown or not.
    pub fn solution(&mut self, solution: &Solution) -> Result<(), ClientError> {
        // Bertini's files have no mark for a point that may be no solution.
        if solution.undecided {
            return Ok(());
        }
        self.finite.point(solution)?;
        if solution.real == Some(true) {
            self.real_finite.point(solution)?;
        }
        if solution.singular {
            return self.singular.point(solution);
        }
        if let Some(points) = &mut self.points {
            if self.nonsingular.count == 0 {
                points.write_bytes(&StoredPoints::head(solution.variables.0.len()))?;
            }
            for z in solution.variables.values() {
                points.write_bytes(&StoredPoints::coordinate_bytes(z))?;
            }
        }
        self.nonsingular.point(solution)
    }

    /// The solutions that follow are a family: with these parameters of theirs they are what later
    /// solves start from. `solutions.points` has every bit of them in little space.
    pub fn family(&mut self, values: &BTreeMap<String, Complex64>) -> Result<(), ClientError> {
        self.points = Some(Written::create(&self.path, "solutions.points")?);
        let mut out = Written::create(&self.path, "parameters.json")?;
        let text = serde_json::to_string_pretty(values).expect("names and numbers are JSON");
        out.write(&format!("{text}\n"))?;
        out.finish()
    }

    /// Writes the summary and completes all files.
    pub fn finish(self, summary: &str) -> Result<(), ClientError> {
        self.lines.finish()?;
        if let Some(points) = self.points {
            points.finish()?;
        }
        for file in [
            self.finite,
            self.real_finite,
            self.nonsingular,
            self.singular,
        ] {
            file.finish()?;
        }
        let mut out = Written::create(&self.path, "summary.json")?;
        out.write(summary)?;
        out.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    fn solution(re: f64, real: bool, singular: bool) -> Solution {
        let values = [
            ("x", Complex64::new(re, 0.0)),
            ("y", Complex64::new(-1.5, 1e-100)),
        ];
        let variables = values.map(|(name, z)| (name.to_string(), z));
        Solution {
            variables: variables.into_iter().collect(),
            multiplicity: 1,
            cycles: vec![1],
            real: Some(real),
            singular,
            residual: 0.0,
            condition: 1.0,
            accuracy: 1e-16,
            precision_bits: 53,
            class: None,
            paths: vec![0],
            certificate: None,
            deflations: None,
            undecided: false,
        }
    }

    #[test]
    fn a_family_is_read_back_with_every_bit() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut files = Folder::create(folder.path()).expect("files");
        let value = Complex64::new(0.1, -1e-300);
        files
            .family(&[("p".to_string(), value)].into())
            .expect("files");
        for (re, singular) in [(0.1, false), (5.0, true), (-0.0, false)] {
            let solution = solution(re, false, singular);
            files.solution(&solution).expect("a line");
        }
        files.finish("{}").expect("files");
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect("it is there");
        let points = StoredPoints::from_bytes(&read("solutions.points")).expect("points");
        assert_eq!((points.len(), points.dimension), (2, 2));
        assert_eq!(points.point(0)[0].re.to_bits(), 0.1f64.to_bits());
        assert_eq!(points.point(1)[0].re.to_bits(), (-0.0f64).to_bits());
        let names = ["p".to_string()];
        let text = read("parameters.json");
        let parameters = cognate_systems::formats::points::read_parameters("p", &text, &names);
        assert_eq!(parameters.expect("parameters"), [[value]]);
    }

    #[test]
    fn every_solution_is_in_the_files_that_it_belongs_to() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut files = Folder::create(folder.path()).expect("files");
        for s in [
            solution(1.0, true, false),
            solution(2.0, false, false),
            solution(3.0, true, true),
            Solution {
                undecided: true,
                ..solution(4.0, true, true)
            },
        ] {
            files.solution(&s).expect("written");
            let listed = Listed {
                solution: s,
                target: Some(3),
                verdict: None,
                critical: None,
            };
            files.line(&listed).expect("written");
        }
        files
            .finish("{\"paths\": {\"total\": 3}}")
            .expect("finished");
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
        let count = |name: &str| read(name).lines().next().map(|l| l.trim().to_string());
        assert_eq!(count("finite_solutions").as_deref(), Some("3"));
        assert_eq!(count("real_finite_solutions").as_deref(), Some("2"));
        assert_eq!(count("nonsingular_solutions").as_deref(), Some("2"));
        assert_eq!(count("singular_solutions").as_deref(), Some("1"));
        let singular = read("singular_solutions");
        let rest: Vec<&str> = singular.lines().skip(1).collect();
        assert_eq!(
            rest,
            [
                "",
                "3.0000000000000000e+00 0.0000000000000000e+00",
                "-1.5000000000000000e+00 1.0000000000000000e-100",
                ""
            ]
        );
        let lines = read("solutions.jsonl");
        assert_eq!(lines.lines().count(), 4);
        assert_eq!(lines.matches("\"undecided\":true").count(), 1);
        assert_eq!(lines.matches("\"target\":3}").count(), 4);
        assert!(read("summary.json").contains("\"total\": 3"));
    }

    #[test]
    fn a_link_is_replaced_and_what_fails_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let victim = folder.path().join("victim");
        std::fs::write(&victim, "precious").unwrap();
        let name = folder.path().join("summary.json");
        std::os::unix::fs::symlink(&victim, &name).unwrap();
        write_file(folder.path(), "summary.json", "{}").unwrap();
        assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
        assert_eq!(std::fs::read_to_string(&name).unwrap(), "{}");
        let mut half = create(folder.path(), "solutions.jsonl").unwrap();
        half.write("half of it").unwrap();
        drop(half);
        let left = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 2, "the victim and the summary");
    }
}

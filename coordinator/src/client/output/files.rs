//! The folder of --output: summary.json, solutions.jsonl, and Bertini's files of solutions.
//!
//! Everything is written as it comes, so that memory does not grow with the
//! number of solutions; counts go in front of Bertini's files at the end.

use super::json;
use crate::client::error::ClientError;
use cognate_solutions::solution::Solution;
use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A folder that is being filled.
pub struct Folder {
    path: PathBuf,
    lines: Written,
    finite: BertiniFile,
    real_finite: BertiniFile,
    nonsingular: BertiniFile,
    singular: BertiniFile,
}

/// A file with its name, for messages.
struct Written {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Written {
    fn create(folder: &Path, name: &str) -> Result<Self, ClientError> {
        let path = folder.join(name);
        let file = File::create(&path).map_err(|e| cannot_write(&path, e))?;
        Ok(Self {
            path,
            file: BufWriter::new(file),
        })
    }

    fn write(&mut self, text: &str) -> Result<(), ClientError> {
        let Self { path, file } = self;
        file.write_all(text.as_bytes())
            .map_err(|e| cannot_write(path, e))
    }

    fn finish(mut self) -> Result<(), ClientError> {
        self.file.flush().map_err(|e| cannot_write(&self.path, e))
    }
}

fn cannot_write(path: &Path, source: std::io::Error) -> ClientError {
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
        for (_, z) in &solution.variables.0 {
            text.push_str(&format!(
                "{} {}
",
                scientific(z.re),
                scientific(z.im)
            ));
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
fn scientific(x: f64) -> String {
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
        std::fs::create_dir_all(path).map_err(|e| cannot_write(path, e))?;
        Ok(Self {
            path: path.to_path_buf(),
            lines: Written::create(path, "solutions.jsonl")?,
            finite: BertiniFile::create(path, "finite_solutions")?,
            real_finite: BertiniFile::create(path, "real_finite_solutions")?,
            nonsingular: BertiniFile::create(path, "nonsingular_solutions")?,
            singular: BertiniFile::create(path, "singular_solutions")?,
        })
    }

    /// Writes one solution to every file that it belongs to.
    pub fn solution(&mut self, solution: &Solution) -> Result<(), ClientError> {
        self.lines
            .write(&format!("{}\n", json::solution_line(solution)))?;
        self.finite.point(solution)?;
        if solution.real == Some(true) {
            self.real_finite.point(solution)?;
        }
        if solution.singular {
            self.singular.point(solution)
        } else {
            self.nonsingular.point(solution)
        }
    }

    /// Writes the summary and completes all files.
    pub fn finish(self, summary: &str) -> Result<(), ClientError> {
        self.lines.finish()?;
        for file in [
            self.finite,
            self.real_finite,
            self.nonsingular,
            self.singular,
        ] {
            file.finish()?;
        }
        let mut out = Written::create(&self.path, "summary.json")?;
        out.write(&json::summary(summary))?;
        out.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_solutions::solution::NamedValues;
    use num_complex::Complex64;

    fn solution(re: f64, real: bool, singular: bool) -> Solution {
        let values = [
            ("x", Complex64::new(re, 0.0)),
            ("y", Complex64::new(-1.5, 1e-100)),
        ];
        let variables = values.map(|(name, z)| (name.to_string(), z));
        Solution {
            variables: NamedValues(variables.into()),
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
        }
    }

    #[test]
    fn every_solution_is_in_the_files_that_it_belongs_to() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut files = Folder::create(folder.path()).expect("files");
        for s in [
            solution(1.0, true, false),
            solution(2.0, false, false),
            solution(3.0, true, true),
        ] {
            files.solution(&s).expect("written");
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
        assert_eq!(read("solutions.jsonl").lines().count(), 3);
        assert!(read("summary.json").contains("\"total\": 3"));
    }
}

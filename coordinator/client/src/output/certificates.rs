//! certificates.json of --output: every box in exact numbers, for a program that checks them.
//!
//! Written as the solutions come. `tests/certificate_checker` reads it, with the
//! problem's file, and proves everything again.

use super::files::{Written, create};
use crate::error::ClientError;
use cognate_solutions::solution::Solution;
use cognate_summary::solve::{Summary, TargetBlock};
use serde_json::json;
use std::path::Path;

/// Value of the field `format`, the first in the file; another number is another layout.
const FORMAT: &str = "cognate certificates 1";

/// The file, while it is being filled.
pub struct Certificates {
    out: Written,
    /// Head of each target, and how many of the solutions to come are its own.
    targets: std::vec::IntoIter<(String, u64)>,
    /// Solutions of this target that have not come yet.
    left: u64,
    number: u64,
    first: bool,
}

impl Certificates {
    /// Begins the file, if the job has certificates.
    pub fn create(folder: &Path, summary: &Summary) -> Result<Option<Self>, ClientError> {
        let whole = [TargetBlock {
            paths: summary.paths.clone(),
            solutions: summary.solutions.clone(),
            classes: summary.classes.clone(),
            certification: summary.certification.clone(),
            settled: summary.settled,
        }];
        let blocks = match summary.targets.as_slice() {
            [] => &whole[..],
            several => several,
        };
        if blocks.iter().all(|block| block.certification.is_none()) {
            return Ok(None);
        }
        let head = |block: &TargetBlock| {
            let claims = json!({
                "certified": block.solutions.certified,
                "real": block.solutions.certified_real,
            });
            // The object stays open: its certificates follow.
            let system = serde_json::to_string(&block.certification)
                .expect("names and numbers can be written as JSON");
            let head = format!("{{\"system\": {system}, \"claims\": {claims}");
            (head, block.solutions.distinct)
        };
        let targets: Vec<_> = blocks.iter().map(head).collect();
        let problem = serde_json::to_value(&summary.problem)
            .expect("names and numbers can be written as JSON");
        let mut out = create(folder, "certificates.json")?;
        out.write(&format!(
            "{{\"format\": \"{FORMAT}\",\n \"problem\": {problem},\n \"targets\": ["
        ))?;
        let mut file = Self {
            out,
            targets: targets.into_iter(),
            left: 0,
            number: 0,
            first: true,
        };
        file.begin_target("")?;
        Ok(Some(file))
    }

    fn begin_target(&mut self, between: &str) -> Result<(), ClientError> {
        let mut between = between;
        for (head, count) in self.targets.by_ref() {
            self.out
                .write(&format!("{between}\n{head}, \"certificates\": ["))?;
            self.left = count;
            self.first = true;
            if count > 0 {
                return Ok(());
            }
            between = "\n]},";
        }
        Ok(())
    }

    /// Takes the next solution; one that is not certified leaves nothing.
    pub fn solution(&mut self, solution: &Solution) -> Result<(), ClientError> {
        if self.left == 0 {
            self.begin_target("\n]},")?;
        }
        self.left = self.left.saturating_sub(1);
        let number = self.number;
        self.number += 1;
        let Some(certificate) = solution.certificate.as_ref().filter(|c| c.certified) else {
            return Ok(());
        };
        let mut line =
            serde_json::to_value(certificate).expect("names and numbers can be written as JSON");
        line["solution"] = json!(number);
        line["paths"] = json!(solution.paths);
        let comma = if self.first { "" } else { "," };
        self.first = false;
        self.out.write(&format!("{comma}\n  {line}"))
    }

    /// Ends the file.
    pub fn finish(mut self) -> Result<(), ClientError> {
        while self.targets.len() > 0 {
            self.begin_target("\n]},")?;
        }
        self.out.write("\n]}\n]}\n")?;
        self.out.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::summary;
    use cognate_solutions::certificates::{CertifiedSystem, SolutionCertificate};
    use cognate_solutions::solution::NamedValues;
    use serde_json::Value;

    fn solution(certified: bool) -> Solution {
        Solution {
            variables: NamedValues::default(),
            multiplicity: 1,
            cycles: vec![1],
            real: None,
            singular: false,
            residual: 0.0,
            condition: 1.0,
            accuracy: 1e-16,
            precision_bits: 53,
            class: None,
            paths: vec![7],
            certificate: Some(SolutionCertificate {
                certified,
                ..SolutionCertificate::default()
            }),
            deflations: None,
            undecided: false,
        }
    }

    fn of_counts(distinct: &[u64]) -> Summary {
        let text = r#"{
  "job": "01j9", "settled": true, "failures": {},
  "problem": {"name": "a", "digest": "5f0c", "variables": 8, "equations": 7, "start": "given", "seed": 42},
  "paths": {"total": 0, "finite": 0, "singular": 0, "positive_dimensional": 0, "excess": 0, "at_infinity": 0,
            "failed": 0, "retracked": 0, "crossings_found": 0, "crossings_resolved": 0,
            "decided_by_precision_limit": 0, "by_precision": {}, "highest_precision_bits": 53},
  "solutions": {"distinct": 0, "nonsingular": 0, "singular": 0, "real": 0, "real_reason": null,
                "with_multiplicity": 0, "certified": 0, "positive_dimensional": false, "degenerate": {}},
  "classes": {"count": null, "group_order": null, "complete": null},
  "time": {"wall_seconds": 0.1, "cpu_seconds": 0.1, "tracking_cpu_seconds": 0.1, "paths_per_second": 1.0},
  "workers": [], "warnings": []
}"#;
        let mut summary = summary::read(text).expect("a summary");
        summary.targets = distinct
            .iter()
            .map(|&distinct| {
                let mut solutions = summary.solutions.clone();
                solutions.distinct = distinct;
                TargetBlock {
                    paths: summary.paths.clone(),
                    solutions,
                    classes: summary.classes.clone(),
                    certification: Some(CertifiedSystem::default()),
                    settled: true,
                }
            })
            .collect();
        summary
    }

    #[test]
    fn each_target_holds_its_own_certificates() {
        for (counts, expected) in [
            (vec![2, 0, 3], vec![1, 0, 2]),
            (vec![0, 0, 2], vec![0, 0, 1]),
            (vec![1, 0], vec![1, 0]),
        ] {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let summary = of_counts(&counts);
            let file = Certificates::create(folder.path(), &summary).expect("written");
            let mut file = file.expect("there are certificates");
            for number in 0..counts.iter().sum() {
                // Every second one is certified.
                file.solution(&solution(number % 2 == 0)).expect("written");
            }
            file.finish().expect("written");
            let text = std::fs::read_to_string(folder.path().join("certificates.json"));
            let content: Value = serde_json::from_str(&text.expect("a file")).expect("JSON");
            let certificate_counts: Vec<usize> = content["targets"]
                .as_array()
                .expect("targets")
                .iter()
                .map(|target| target["certificates"].as_array().expect("a list").len())
                .collect();
            assert_eq!(certificate_counts, expected);
            assert_eq!(
                content["targets"][0]["certificates"][0]["paths"][0].as_u64(),
                { (expected[0] > 0).then_some(7) }
            );
        }
        let none = of_counts(&[]);
        let folder = tempfile::tempdir().expect("a temporary folder");
        assert!(
            Certificates::create(folder.path(), &none)
                .expect("nothing is written")
                .is_none()
        );
    }
}

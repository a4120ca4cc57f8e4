//! All isolated solutions of a system, as `cognate solve` finds them.

use super::refused;
use crate::commands::{serve, solve as command};
use crate::error::{ClientError, Exit};
use crate::system_source::SystemSource;

/// Solves a system in any format. `options` are those of `cognate solve`, without the system.
///
/// Gives the exit code of the command, and JSON: `{"summary": {..}, "solutions": [..]}` or `{"error": ".."}`. The fields of
/// both are those of `summary.json` and of the lines of `solutions.jsonl`.
pub fn solve(system: &[u8], options: &[String]) -> (Exit, String) {
    match solved(system, options) {
        Ok((exit, fields)) => (exit, format!("{{{fields}}}")),
        Err(error) => refused(&error),
    }
}

fn solved(system: &[u8], options: &[String]) -> Result<(Exit, String), ClientError> {
    // A source is demanded by the command line; this one is replaced.
    let mut arguments = options.to_vec();
    arguments.push("-".to_owned());
    let mut asked = serve::asked_solve(&mut serve::solve_command(), &arguments)?;
    asked.problem.system = SystemSource {
        content: Some(system.to_vec()),
        ..SystemSource::default()
    };
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(|e| ClientError::Local(format!("the runtime could not be started: {e}")))?;
    let answer = runtime.block_on(command::answer_in_process(&asked))?;
    serve::fields(&answer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn options(words: &[&str]) -> Vec<String> {
        words.iter().map(|word| (*word).to_owned()).collect()
    }

    #[test]
    fn a_circle_and_a_hyperbola_meet_four_times() {
        let (exit, answer) = solve(b"x^2 + y^2 = 5\nx*y = 2\n", &options(&["--certify"]));
        let answer: Value = serde_json::from_str(&answer).expect("JSON");
        assert_eq!(exit, Exit::Solved, "{answer}");
        assert_eq!(answer["summary"]["solutions"]["real"], 4);
        assert_eq!(answer["summary"]["solutions"]["certified"], 4);
        assert_eq!(answer["solutions"].as_array().map(Vec::len), Some(4));
    }

    #[test]
    fn mistakes_are_errors_with_their_place() {
        let (exit, answer) = solve(b"x^2 + = 5\n", &[]);
        assert_eq!(exit, Exit::BadInput);
        assert!(answer.contains("system:1:"), "{answer}");
        let (exit, answer) = solve(b"x^2 = 5\n", &options(&["--certfy"]));
        assert_eq!(exit, Exit::BadInput);
        assert!(answer.contains("--certify"), "{answer}");
        let (exit, answer) = solve(b"", &[]);
        assert_eq!(exit, Exit::BadInput, "{answer}");
    }
}

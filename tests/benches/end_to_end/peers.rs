//! Other programs on the same file: CPU seconds of their solve and how many solutions they report.
//!
//! Each program is called in its plainest way, on one thread. A program that is not installed is named and left out; a
//! program that takes longer than the limit is stopped, and the output says so.

use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::system::System;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Answer of a program to a system.
pub enum Answer {
    /// CPU seconds of its solve, and solutions that it reports.
    Found { seconds: f64, count: u64 },
    /// The program was stopped after this number of CPU seconds.
    Stopped(u32),
    /// Why there is no answer.
    None(String),
}

/// The number of the signal that the limit of CPU seconds sends.
const SIGXCPU: i32 = 24;

/// Folder, inputs and time limit of the programs.
pub struct Peers<'a> {
    /// The system as a PHCpack file.
    pub input: &'a Path,
    /// The system, for programs that read another format.
    pub system: &'a System,
    /// Folder for the files that the programs write.
    pub folder: &'a Path,
    /// CPU seconds after which a program is stopped.
    pub patience: u32,
}

impl Peers<'_> {
    /// Answers of all programs, in the order of the table.
    pub fn answers(&self) -> [(&'static str, Answer); 4] {
        let phc = self.phc();
        [
            ("phc -b", phc.unwrap_or_else(Answer::None)),
            ("bertini2", self.bertini().unwrap_or_else(Answer::None)),
            ("Macaulay2", self.macaulay().unwrap_or_else(Answer::None)),
            ("POLSYS_PLP", self.polsys().unwrap_or_else(Answer::None)),
        ]
    }

    /// Output of a command under the limit; `Err(answer)` if it does not end well.
    fn shell(&self, script: &str, arguments: &[&Path]) -> Result<String, Answer> {
        let output = Command::new("bash")
            .arg("-c")
            .arg(format!("ulimit -t {}; {script}", self.patience))
            .arg("bash")
            .args(arguments)
            .env("BERTINI_NUM_THREADS", "1")
            .env("OMP_NUM_THREADS", "1")
            .env("GC_MARKERS", "1")
            .output()
            .map_err(|error| Answer::None(error.to_string()))?;
        match (output.status.code(), output.status.signal()) {
            (Some(0), _) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            (Some(code), _) if code == 128 + SIGXCPU || code == 128 + 9 => {
                Err(Answer::Stopped(self.patience))
            }
            (_, Some(SIGXCPU | 9)) => Err(Answer::Stopped(self.patience)),
            (Some(127), _) => Err(Answer::None("not installed".into())),
            _ => {
                let why = String::from_utf8_lossy(&output.stderr);
                let last = why.lines().last().unwrap_or("it failed").to_string();
                Err(Answer::None(last))
            }
        }
    }

    /// A program of a peer that prints the seconds of its solve and the number of solutions.
    fn program(&self, script: &str, arguments: &[&Path]) -> Answer {
        let text = match self.shell(script, arguments) {
            Ok(text) => text,
            Err(answer) => return answer,
        };
        let line = text.lines().last().unwrap_or("");
        let mut words = line.split_whitespace();
        let seconds = words.next().and_then(|word| word.parse().ok());
        let count = words.next().and_then(|word| word.parse().ok());
        match seconds.zip(count) {
            Some((seconds, count)) => Answer::Found { seconds, count },
            None => Answer::None(format!("it says: {line}")),
        }
    }

    fn write(&self, name: &str, text: &str) -> Result<PathBuf, String> {
        let path = self.folder.join(name);
        std::fs::write(&path, text).map_err(|error| error.to_string())?;
        Ok(path)
    }

    /// `phc -b -0`, with its mixed volumes and its start-up of milliseconds.
    fn phc(&self) -> Result<Answer, String> {
        let copy = self.folder.join("phc_input"); // phc writes into its input
        std::fs::copy(self.input, &copy).map_err(|error| error.to_string())?;
        let output = self.folder.join("phc_output");
        let _ = std::fs::remove_file(&output);
        let script = "command -v phc >/dev/null || exit 127; TIMEFORMAT='%U %S'; \
                      { time phc -b -0 \"$1\" \"$2\" >/dev/null 2>&1; } 2>&1";
        let text = match self.shell(script, &[&copy, &output]) {
            Ok(text) => text,
            Err(answer) => return Ok(answer),
        };
        let words = text.split_whitespace();
        let times: Vec<f64> = words.filter_map(|t| t.parse().ok()).collect();
        let solution_text = std::fs::read_to_string(&copy).unwrap_or_default();
        // "THE SOLUTIONS :" and on the next line their number and dimension.
        let mut lines = solution_text
            .lines()
            .skip_while(|line| !line.contains("THE SOLUTIONS"));
        let count = lines
            .nth(1)
            .and_then(|line| line.split_whitespace().next()?.parse().ok());
        Ok(match (&times[..], count) {
            ([user, system], Some(count)) => Answer::Found {
                seconds: user + system,
                count,
            },
            _ => Answer::None("it lists no solutions".into()),
        })
    }

    /// `bertini.solve` with its default settings, in the file's groups.
    fn bertini(&self) -> Result<Answer, String> {
        let python = std::env::var("BERTINI_PYTHON")
            .map_err(|_| "BERTINI_PYTHON names no Python that has it".to_string())?;
        // It refuses names of which one begins another, as u1 and u10.
        let mut system = self.system.clone();
        for (name, letter) in system.variables.iter_mut().zip('a'..='z') {
            *name = format!("v{letter}");
        }
        let text = formats::write(Format::Bertini, &system, &FileSettings::default())
            .map_err(|error| error.to_string())?;
        let inner = text.split_once("INPUT").map_or("", |(_, rest)| rest);
        let inner = inner.split("END;").next().unwrap_or("");
        let script = "import sys, time, tempfile, bertini\n\
                      system = bertini.parse.system(open(sys.argv[1]).read())\n\
                      before = time.process_time()\n\
                      found = bertini.solve(system, seed=1, directory=tempfile.mkdtemp(), show_progress=False)\n\
                      print(time.process_time() - before, len(found))\n";
        let input = self.write("bertini_input", inner)?;
        let program = self.write("by_bertini.py", script)?;
        Ok(self.program(
            "\"$1\" \"$2\" \"$3\"",
            &[Path::new(&python), &program, &input],
        ))
    }

    /// `solveSystem` of its package NumericalAlgebraicGeometry: the regular ones, equal ones merged.
    fn macaulay(&self) -> Result<Answer, String> {
        let (variables, equations) = self.listed()?;
        let script = format!(
            "needsPackage \"NumericalAlgebraicGeometry\"\n\
             i = ii\nR = CC[{}]\nF = {{{}}}\nt = cpuTime()\nS = solveSystem F\nt = cpuTime() - t\n\
             S = select(S, p -> status p === Regular)\n\
             print(format(0, t) | \" \" | toString(#solutionsWithMultiplicity S))\n",
            variables.join(","),
            equations.join(",\n").replace("**", "^")
        );
        let program = self.write("system.m2", &script)?;
        let script = "command -v M2 >/dev/null || exit 127; M2 --script \"$1\"";
        Ok(self.program(script, &[&program]))
    }

    /// POLSYS_PLP by its Python package, by total degree: roots of small residual, merged.
    fn polsys(&self) -> Result<Answer, String> {
        let python = std::env::var("POLSYS_PYTHON")
            .map_err(|_| "POLSYS_PYTHON names no Python that has pypolsys".to_string())?;
        let (variables, equations) = self.listed()?;
        let script = "import sys, time, re\n\
                      import numpy as np, sympy as sym\n\
                      from pypolsys import polsys, utils\n\
                      lines = open(sys.argv[1]).read().split('\\n')\n\
                      x = sym.symbols(lines[0].split())\n\
                      names = {**{str(v): v for v in x}, 'i': sym.I}\n\
                      P = [sym.poly(sym.sympify(l, locals=names, rational=True), x) for l in lines[1:] if l]\n\
                      polsys.init_poly(*utils.fromSympy(P))\n\
                      polsys.init_partition(*utils.make_h_part(len(x)))\n\
                      before = time.process_time()\n\
                      polsys.solve(1e-8, 1e-14, 0.0)\n\
                      seconds = time.process_time() - before\n\
                      F = [[(np.array(m), complex(c)) for m, c in p.terms()] for p in P]\n\
                      found = []\n\
                      for z in polsys.myroots.T:\n    \
                          z = z[:-1]\n    \
                          if not np.all(np.isfinite(z)) or np.max(np.abs(z)) > 1e8: continue\n    \
                          bad = 0\n    \
                          for f in F:\n        \
                              t = [c * np.prod(z ** m) for m, c in f]\n        \
                              bad = max(bad, abs(sum(t)) / max(map(abs, t)))\n    \
                          if bad > 1e-8: continue\n    \
                          if all(np.max(np.abs(z - y)) > 1e-6 * max(1, np.max(np.abs(z))) for y in found): found.append(z)\n\
                      print(seconds, len(found))\n";
        let input = format!("{}\n{}\n", variables.join(" "), equations.join("\n"));
        let input = self.write("polsys_input", &input)?;
        let program = self.write("by_polsys.py", script)?;
        Ok(self.program(
            "\"$1\" \"$2\" \"$3\"",
            &[Path::new(&python), &program, &input],
        ))
    }

    /// Variables and equations as they stand in the PHCpack file.
    fn listed(&self) -> Result<(Vec<String>, Vec<String>), String> {
        let text = std::fs::read_to_string(self.input).map_err(|error| error.to_string())?;
        let body = text.split_once('\n').map_or("", |(_, rest)| rest);
        let equations: Vec<String> = body
            .split(';')
            .map(|equation| equation.split_whitespace().collect::<Vec<_>>().join(" "))
            .filter(|equation| !equation.is_empty())
            .collect();
        match equations.len() == self.system.equations.len() {
            true => Ok((self.system.variables.clone(), equations)),
            false => Err("the file has other equations".into()),
        }
    }
}

//! Lines with the problem that was typed: with another command, with a value of an option, in the words of this program.

use super::{TypedLine, joined, one, quoted};
use crate::arguments::Arguments;
use crate::other_words::{condition_of_others, loose_equations, option_of_others};
use crate::text_change::is_of_name;
use clap::error::{ContextKind, ErrorKind};
use clap::{Command, CommandFactory, Parser};
use cognate_systems::condition::Conditions;
use cognate_systems::formats;
use cognate_systems::objective::Goal;
use cognate_systems::system::System;
use std::path::Path;

/// Words of the refusal of components of a system with functions of unknowns.
const OF_FUNCTIONS: &str = "components of equations with functions of unknowns";
/// A function of an unknown as an unknown of its own.
const WITHOUT_FUNCTIONS: &str = "cognate decompose -e \"s^2 = x\" -e \"s*y = 0\"";

impl TypedLine {
    /// The line that asks for components of a system without isolated solutions, or for isolated solutions of a system whose
    /// components are not there.
    pub(super) fn other_question(&self, text: &str) -> Option<String> {
        let has_functions = text.contains(OF_FUNCTIONS);
        if !has_functions && !text.contains("`cognate decompose FILE`") {
            return None;
        }
        let command = match self.0.first()?.as_str() {
            "solve" => "decompose",
            "decompose" => "solve",
            _ => return None,
        };
        let system = self.system();
        if let Some(line) = system
            .as_ref()
            .and_then(|system| self.with_products(system))
        {
            return Some(line);
        }
        let is_free = |system: &System| system.equations.len() < system.dimension();
        let has_helpers = system.as_ref().is_some_and(|s| !s.helpers.is_empty());
        if has_functions || has_helpers {
            return match system.filter(is_free) {
                None if has_functions => Some(self.with_command(command)),
                None => None,
                Some(system) => {
                    let line = self.with_fixed_unknowns(&system);
                    Some(line.unwrap_or_else(|| WITHOUT_FUNCTIONS.to_owned()))
                }
            };
        }
        Some(self.with_command(command))
    }

    /// The system that was typed, or that a typed file holds.
    fn system(&self) -> Option<System> {
        let equations = self.equations();
        let problem = match equations.is_empty() {
            true => {
                let path = self
                    .0
                    .iter()
                    .skip(1)
                    .find(|word| Path::new(word).is_file())?;
                formats::read(path, &std::fs::read(path).ok()?)
            }
            false => formats::plain::typed("-e", &joined(&equations)),
        };
        Some(problem.ok()?.system)
    }

    /// The line with another command, without options where that has not all of them.
    fn with_command(&self, name: &str) -> String {
        let command = Arguments::command();
        let command = command.find_subcommand(name);
        let has = |word: &String| {
            let long = word.strip_prefix("--").map(|word| word.split('=').next());
            let mut arguments = command.into_iter().flat_map(Command::get_arguments);
            long.is_none_or(|long| arguments.any(|argument| argument.get_long() == long))
        };
        if self.0.iter().all(has) {
            return self.with_word(0, name);
        }
        format!("cognate {name}{}", self.problem().unwrap_or_default())
    }

    /// The line with a product in the place of each unknown whose letters are unknowns, where as many equations are left as
    /// unknowns.
    fn with_products(&self, system: &System) -> Option<String> {
        let names = &system.variables;
        let product = |word: &str| {
            let number = word.len() - word.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (number, name) = word.split_at(number);
            let letters: Vec<String> = name.chars().map(String::from).collect();
            let is_product = letters.len() > 1 && letters.iter().all(|c| names.contains(c));
            match is_product && names.iter().any(|other| other == name) {
                true => format!("{number}{}", letters.join("*")),
                false => word.to_owned(),
            }
        };
        let with_products = |text: &str| {
            let ends = text.split_inclusive(|c: char| !is_of_name(c));
            let changed = ends.map(|part| {
                let word = part.trim_end_matches(|c: char| !is_of_name(c));
                format!("{}{}", product(word), &part[word.len()..])
            });
            changed.collect::<String>()
        };
        let equations = self.equations().into_iter();
        let lines: Vec<String> = equations.map(|(_, text)| with_products(&text)).collect();
        let read = formats::plain::typed("-e", &lines.join("\n")).ok()?.system;
        let is_changed = read.variables.len() < names.len();
        let words = lines.iter().map(|line| format!(" -e {}", quoted(line)));
        let words: String = words.collect();
        (is_changed && read.equations.len() >= read.dimension())
            .then(|| format!("cognate solve{words}"))
    }

    /// The line with values of as many unknowns as there are more than equations.
    fn with_fixed_unknowns(&self, system: &System) -> Option<String> {
        let equations: Vec<String> = self.equations().into_iter().map(|(_, text)| text).collect();
        let mut lines = equations.clone();
        let missing = |system: &System| system.dimension().saturating_sub(system.equations.len());
        let mut open = missing(system);
        for name in system.typed_system().variables.iter().rev() {
            let mut more = lines.clone();
            more.push(format!("{name} = 1"));
            let Ok(problem) = formats::plain::typed("-e", &more.join("\n")) else {
                continue;
            };
            if open > 0 && missing(&problem.system) < open {
                (lines, open) = (more, missing(&problem.system));
            }
        }
        let words = lines.iter().map(|line| format!(" -e {}", quoted(line)));
        let words: String = words.collect();
        (open == 0 && !equations.is_empty()).then(|| format!("cognate solve{words}"))
    }

    /// The problem that was typed, as words of a line: a file or equations.
    pub(super) fn problem(&self) -> Option<String> {
        let equations = self.equations();
        if !equations.is_empty() {
            let words = equations
                .iter()
                .map(|(_, text)| format!(" -e {}", quoted(text)));
            return Some(words.collect());
        }
        let file = self
            .0
            .iter()
            .skip(1)
            .find(|word| Path::new(word).is_file())?;
        Some(format!(" {}", quoted(file)))
    }

    /// The line with a value of the option at fault that its problem takes.
    pub(super) fn with_value(&self, text: &str) -> Option<String> {
        let option = match text.starts_with("--") {
            true => text.split([':', ',', ' ']).next().map(str::to_owned),
            false => self.option_at_fault(text),
        }?;
        let system = self.system()?;
        if let Some(line) = self.with_line_of_objective(&option, &system) {
            return Some(line);
        }
        let typed = system.typed_system().variables.first()?.clone();
        let is_angle = system.angle_unknowns().any(|angle| angle.name == typed);
        let unknown = match is_angle && option != "--where" && option != "--sort" {
            true => format!("cos({typed})"),
            false => typed,
        };
        let value = match &option[..] {
            "--targets" | "--target-parameters" => {
                let values = system.parameters.iter().map(|name| format!("{name}=1"));
                values.collect::<Vec<String>>().join(", ")
            }
            "--where" => {
                let typed = self.0.iter().skip_while(|word| **word != option).nth(1)?;
                let typed = [condition_of_others(typed)];
                let (system, mut conditions) = (system.typed_system(), Conditions::default());
                let read = formats::conditions::add("--where", &typed, &system, &mut conditions);
                let [typed] = typed;
                read.map_or_else(|_| format!("{unknown} > 0"), |()| typed)
            }
            "--sort" | "--minimize" | "--maximize" | "--critical" => unknown,
            _ => return None,
        };
        let line = format!("{}{}", self.named().name, self.problem()?);
        Some(match value.is_empty() {
            true => line,
            false => format!("{line} {option} {}", quoted(&value)),
        })
    }

    /// The line with an equation in the place of a condition that is one, or with the first of the alternatives of a condition.
    pub(super) fn with_inequality(&self) -> Option<String> {
        let place = self.0.iter().position(|word| word == "--where")?;
        let typed = self.0.get(place + 1)?;
        let mut words = self.0.clone();
        let first = typed.split(" or ").next().unwrap_or(typed);
        let is_order = |text: &str| text.contains(['<', '>', '≤', '≥']);
        let not_equal = ["!=", "/=", "≠"];
        if let Some(relation) = not_equal.iter().find(|relation| first.contains(*relation)) {
            words[place + 1] = first.replacen(relation, ">", 1);
        } else if is_order(first) {
            words[place + 1] = first.to_owned();
        } else {
            words[place] = "-e".to_owned();
        }
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        Some(format!("cognate {}", words.join(" ")))
    }

    /// The line with the objective among the equations, where it may have an unknown that they do not have.
    fn with_line_of_objective(&self, option: &str, system: &System) -> Option<String> {
        let goal = Goal::ALL
            .iter()
            .find(|goal| option.strip_prefix("--") == Some(goal.name()))?;
        let place = self.0.iter().position(|word| word == option)?;
        let objective = format!("{}: {}", goal.name(), self.0.get(place + 1)?);
        let equations = joined(&self.equations());
        // A name that is like another one is misspelt.
        let is_new = |equations: &str| {
            let read = formats::plain::typed("-e", &format!("{equations}\n{objective}"));
            read.is_ok_and(|problem| problem.warnings.is_empty())
        };
        if equations.is_empty() {
            let mut files = self.0.iter().skip(1);
            let file = files.find(|word| Path::new(word).is_file())?;
            let names: Vec<&str> = objective.split(|c| !is_of_name(c)).collect();
            let is_shared = |name: &String| names.contains(&name.as_str());
            let is_about = system.typed_system().variables.iter().any(is_shared);
            let is_meant = is_about && is_new(&std::fs::read_to_string(file).ok()?);
            return is_meant.then(|| format!("one more line in {file}: {objective}"));
        }
        let is_new = is_new(&equations);
        let mut words = self.0.clone();
        words.splice(place..place + 2, ["-e".to_owned(), objective]);
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        is_new.then(|| format!("cognate {}", words.join(" ")))
    }

    /// The line in the words of this program, where those of others or no quotation marks were typed.
    pub(super) fn in_other_words(&self, refusal: &clap::Error) -> Option<String> {
        let wrong = match refusal.kind() {
            ErrorKind::InvalidSubcommand => ContextKind::InvalidSubcommand,
            _ => ContextKind::InvalidArg,
        };
        let wrong = refusal.get(wrong).and_then(one).unwrap_or_default();
        let is_wrong = |word: &String| *word == wrong || word.split('=').next() == Some(&wrong);
        let place = self.0.iter().position(is_wrong);
        let with_option = place.and_then(|place| self.with_option_of_others(place, &wrong));
        let with_command = place.and_then(|place| self.with_missing_command(place, &wrong));
        let lines = [with_option, with_command, self.with_loose_equations()];
        let line = lines.into_iter().flatten().find(|words| is_parsed(words))?;
        let words: Vec<String> = line.iter().map(|word| quoted(word)).collect();
        Some(format!("cognate {}", words.join(" ")))
    }

    /// The words with an option of another program replaced.
    fn with_option_of_others(&self, place: usize, wrong: &str) -> Option<Vec<String>> {
        let words = option_of_others(wrong)?
            .iter()
            .map(|word| (*word).to_owned());
        let value = self.0[place].split_once('=');
        let value = value.map(|(_, value)| value.to_owned());
        let mut line = self.0.clone();
        line.splice(place..=place, words.chain(value));
        Some(line)
    }

    /// The words with the command that a file or an equation in its place is for.
    fn with_missing_command(&self, place: usize, wrong: &str) -> Option<Vec<String>> {
        let (before, typed) = self.0.split_at(place);
        let content = std::fs::read(wrong).ok();
        let is_system = content
            .as_ref()
            .is_some_and(|c| formats::read(wrong, c).is_ok());
        let before: Vec<&str> = before.iter().map(String::as_str).collect();
        let command: &[&str] = match (&before[..], content) {
            ([], Some(_)) if is_system => &["solve"],
            ([] | ["mechanism"], Some(_)) => &["mechanism", "info"],
            ([], None) if wrong == "-e" => &["solve"],
            ([], None) if wrong.contains('=') => &["solve", "-e"],
            _ => return None,
        };
        let command = command.iter().map(|word| (*word).to_owned());
        Some(command.chain(typed.iter().cloned()).collect())
    }

    /// The words with a mark before each equation.
    fn with_loose_equations(&self) -> Option<Vec<String>> {
        if !self.named().has_argument("equation") {
            return None;
        }
        let (command, words) = self.0.split_first()?;
        let (equations, options) = loose_equations(words)?;
        let equations = equations.into_iter();
        let equations = equations.flat_map(|text| ["-e".to_owned(), text]);
        let line = std::iter::once(command.clone()).chain(equations);
        Some(line.chain(options.iter().cloned()).collect())
    }
}

/// Whether words are a line that the program understands.
fn is_parsed(words: &[String]) -> bool {
    let program = std::iter::once("cognate");
    let words = program.chain(words.iter().map(String::as_str));
    Arguments::try_parse_from(words).is_ok()
}

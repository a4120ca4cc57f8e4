//! Remedies: the line to type that ends a refusal.
//!
//! Input: the typed line, and the reason of the refusal. Output: the typed line with misspelt words mended, else an
//! example of the same command from its help, with the option that is at fault.

mod problem_lines;

use super::arguments::Arguments;
use super::correction::corrected;
use super::error::{ClientError, Exit};
use super::objective::CONDITIONS;
use super::other_words::command_of_others;
use super::standard_input;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory};
use cognate_systems::formats;
use std::ffi::OsString;
use std::io;
use std::path::Path;

/// Text before the line that the user can type.
const LEAD: &str = "  try: ";
/// How clap ends a refusal; ours ends with a line of the command itself.
const END_OF_CLAP: &str = "For more information, try ";
/// A name is meant instead of another where they are at least this similar (Jaro and Winkler; 1 is equal).
const SIMILAR: f64 = 0.85;

/// How the message of an option begins that goes with some starts only.
pub const ONLY_WITH_START: &str = "only goes with --start ";
/// The long name of the option for an equation.
const LONG_EQUATION: &str = "--equation";

/// The command's name with its words, and the command.
struct Named {
    name: String,
    command: Command,
}

/// The typed words, without the program's name.
pub struct TypedLine(Vec<String>);

impl TypedLine {
    /// The arguments of a process.
    pub fn new(arguments: impl IntoIterator<Item = OsString>) -> Self {
        let words = arguments.into_iter().skip(1);
        Self(words.map(|w| w.to_string_lossy().into_owned()).collect())
    }

    /// Whether nothing was typed but the program's name.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The refusal of what clap does not understand.
    pub fn misunderstood(&self, refusal: &clap::Error, color: bool) -> String {
        let rendered = refusal.render();
        let text = match color {
            true => rendered.ansi().to_string(),
            false => rendered.to_string(),
        };
        let text = text.split(END_OF_CLAP).next().unwrap_or_default();
        let text = &without_tips(text, refusal);
        let line = self.mended(refusal).unwrap_or_else(|| {
            // Examples have the short form.
            let options = options_in(text).into_iter();
            let options = options.map(|option| match option.as_str() {
                LONG_EQUATION => "-e".to_owned(),
                _ => option,
            });
            self.fitting_example(&options.collect::<Vec<String>>())
        });
        format!("{}\n{LEAD}{line}\n", text.trim_end())
    }

    /// The last line of the refusal of a line that was parsed; `None` if the error has one, or needs none.
    pub fn remedy(&self, error: &ClientError) -> Option<String> {
        let text = error.to_string();
        let is_line = |line: &str| line.starts_with(LEAD) || line.contains("cognate ");
        let is_said = text.lines().last().is_some_and(is_line);
        if error.exit() != Exit::BadInput {
            return None;
        }
        if let Some(line) = self.other_question(&text) {
            return Some(format!("{LEAD}{line}"));
        }
        if is_said {
            return None;
        }
        let line = match error {
            ClientError::WithoutValues { names, .. } => self.with_values(names),
            ClientError::File { path, source, .. } if source.kind() == io::ErrorKind::NotFound => {
                self.with_file(path)
            }
            ClientError::Input { origin, .. } if origin == CONDITIONS => self.with_inequality(),
            ClientError::Input { message, .. } => self.with_start(message),
            ClientError::Format(_) => self.corrected(&text),
            ClientError::Refused(_) if self.named().has_argument("job") => {
                Some("cognate jobs".to_owned())
            }
            _ => None,
        };
        let line = line.or_else(|| self.with_value(&text));
        let line = line.unwrap_or_else(|| self.example(error, &text));
        Some(format!("{LEAD}{line}"))
    }

    /// An example of the command with the option or word at fault.
    fn example(&self, error: &ClientError, text: &str) -> String {
        let named = self.named();
        let mut options = options_in(text);
        options.splice(0..0, self.option_at_fault(text));
        if options.is_empty() && matches!(error, ClientError::Format(_)) {
            if named.name.starts_with("cognate mechanism") && has_line(text) {
                return form_of_mechanism(text).to_owned();
            }
            if named.has_argument("equation") {
                options.push("-e".to_owned());
            }
        }
        self.fitting_example(&options)
    }

    /// The option that names a file at fault.
    fn option_at_fault(&self, text: &str) -> Option<String> {
        let about = text.strip_prefix("cannot read ").unwrap_or(text);
        let mut pairs = self.0.windows(2);
        let pair = pairs.rfind(|pair| pair[0].starts_with("--") && about.starts_with(&pair[1]));
        let with_sign = || {
            let mut words = self.0.iter().filter_map(|word| word.split_once('='));
            words.rfind(|(option, value)| {
                option.starts_with("--") && !value.is_empty() && about.starts_with(value)
            })
        };
        let option = pair.map(|pair| pair[0].as_str());
        let option = option.or_else(|| with_sign().map(|(option, _)| option));
        option.map(str::to_owned)
    }

    /// An example of the command with the typed file in the place of its own; one of which all files are there, if one is.
    fn fitting_example(&self, options: &[String]) -> String {
        let named = self.named();
        let words = named.name.split(' ').count();
        let is_there = |word: &&String| Path::new(word).is_file();
        let typed = self.0.iter().skip(words - 1).find(is_there);
        let equations = named.has_argument("equation").then(|| self.problem());
        let equations = equations.flatten().filter(|_| typed.is_none());
        let typed = typed.map(|file| quoted(file)).or(equations);
        let fitted = |example: String| {
            let Some(typed) = typed.as_ref().filter(|_| example.starts_with(&named.name)) else {
                return example;
            };
            let mut parts: Vec<String> = example.split(' ').map(str::to_owned).collect();
            if let Some(part) = parts.get_mut(words).filter(|part| is_file_name(part)) {
                *part = typed.trim_start().to_owned();
            }
            parts.join(" ")
        };
        let all_there = |example: &String| {
            let mut files = example.split(' ').filter(|word| is_file_name(word));
            files.all(|word| Path::new(word).is_file())
        };
        let first = named.example(options);
        let with_option = named.examples_with(options);
        let is_usage = with_option.is_empty() && !options.is_empty();
        let examples = match with_option.is_empty() {
            true => named.examples(),
            false => with_option,
        };
        let mut examples = examples.into_iter().map(fitted);
        let fitting = examples.find(all_there).filter(|_| !is_usage);
        fitting.unwrap_or_else(|| fitted(first))
    }

    /// The command that was typed, as far as its words are understood.
    fn named(&self) -> Named {
        let mut named = Named {
            name: "cognate".to_owned(),
            command: Arguments::command(),
        };
        for word in &self.0 {
            let Some(command) = named.command.find_subcommand(word) else {
                break;
            };
            named = Named {
                name: format!("{} {}", named.name, command.get_name()),
                command: command.clone(),
            };
        }
        named
    }

    /// The line with the word at a place replaced by others.
    fn with_word(&self, place: usize, words: &str) -> String {
        let typed = self.0.iter().enumerate();
        let typed = typed.map(|(k, word)| match k == place {
            true => words.to_owned(),
            false => quoted(word),
        });
        let typed: Vec<String> = typed.collect();
        format!("cognate {}", typed.join(" "))
    }

    /// The line with what clap suggests, or with the command of this name at another place.
    fn mended(&self, refusal: &clap::Error) -> Option<String> {
        if let Some(line) = self.in_other_words(refusal) {
            return Some(line);
        }
        let (wrong, right) = match refusal.kind() {
            ErrorKind::InvalidSubcommand => (
                ContextKind::InvalidSubcommand,
                ContextKind::SuggestedSubcommand,
            ),
            ErrorKind::UnknownArgument => (ContextKind::InvalidArg, ContextKind::SuggestedArg),
            ErrorKind::InvalidValue => (ContextKind::InvalidValue, ContextKind::SuggestedValue),
            _ => return None,
        };
        let wrong = one(refusal.get(wrong)?)?;
        let place = self.0.iter().position(|word| {
            let is_value = word
                .split_once('=')
                .is_some_and(|(_, value)| value == wrong);
            *word == wrong || word.starts_with(&format!("{wrong}=")) || is_value
        })?;
        let typed = &self.0[place];
        if refusal.kind() == ErrorKind::InvalidSubcommand
            && let Some(words) = elsewhere(&Arguments::command(), "", command_of_others(&wrong))
        {
            let rest: Vec<String> = self.0[place + 1..].iter().map(|w| quoted(w)).collect();
            let line = format!("cognate {words} {}", rest.join(" "));
            return Some(line.trim_end().to_owned());
        }
        let suggested = suggestion(refusal.get(right)?, &wrong)?;
        if refusal.kind() == ErrorKind::UnknownArgument && !is_similar(&wrong, &suggested) {
            return None;
        }
        Some(self.with_word(place, &typed.replacen(&wrong, &suggested, 1)))
    }

    /// The line with a value for each of these parameters.
    fn with_values(&self, names: &[String]) -> Option<String> {
        let last = self.0.len().checked_sub(1)?;
        let values = names.iter().map(|name| format!(" --targets \"{name}=1\""));
        let line = self.with_word(last, &quoted(&self.0[last]));
        Some(format!("{line}{}", values.collect::<String>()))
    }

    /// The line with the start that an option goes with.
    fn with_start(&self, message: &str) -> Option<String> {
        let starts = message.strip_prefix(ONLY_WITH_START)?;
        let start = starts.split([',', ' ']).next()?;
        let option = format!("--start {start}");
        let typed = self.0.iter().position(|word| word == "--start");
        if let Some(place) = typed.filter(|place| place + 1 < self.0.len()) {
            return Some(self.with_word(place + 1, start));
        }
        if let Some(place) = self.0.iter().position(|word| word.starts_with("--start=")) {
            return Some(self.with_word(place, &option));
        }
        let last = self.0.len().checked_sub(1)?;
        let line = self.with_word(last, &quoted(&self.0[last]));
        Some(format!("{line} {option}"))
    }

    /// The typed equations, or the line of a file, with slips of notation put right.
    fn corrected(&self, text: &str) -> Option<String> {
        if !self.named().has_argument("equation") {
            return None;
        }
        let equations = self.equations();
        if equations.is_empty() {
            return self.corrected_file(text);
        }
        let read = |text: &str| formats::plain::typed("-e", text).map(drop);
        let corrected = corrected(&joined(&equations), read)?;
        let lines: Vec<&str> = corrected.split('\n').collect();
        if lines.len() != equations.len() {
            return None;
        }
        let mut words = self.0.clone();
        for ((place, _), line) in equations.iter().zip(lines) {
            let option = words[*place].split_once('=').map(|(option, _)| option);
            words[*place] = match option.filter(|option| *option == LONG_EQUATION) {
                Some(option) => format!("{option}={line}"),
                None => line.to_owned(),
            };
        }
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        Some(format!("cognate {}", words.join(" ")))
    }

    /// The typed equations, each with the place of its word.
    fn equations(&self) -> Vec<(usize, String)> {
        let mut equations = Vec::new();
        let mut is_next = false;
        for (place, word) in self.0.iter().enumerate() {
            let long = word
                .strip_prefix(LONG_EQUATION)
                .and_then(|rest| rest.strip_prefix('='));
            if is_next {
                equations.push((place, word.clone()));
            } else if let Some(equation) = long {
                equations.push((place, equation.to_owned()));
            }
            is_next = !is_next && (word == "-e" || word == LONG_EQUATION);
        }
        equations
    }

    /// The line that a message names of a typed file, or of standard input, with slips of notation put right.
    fn corrected_file(&self, text: &str) -> Option<String> {
        let is_named = |word: &&String| text.starts_with(&format!("{word}:"));
        let (path, content) = match self.0.iter().find(is_named) {
            Some(path) => (&path[..], std::fs::read_to_string(path).ok()?),
            None if text.starts_with(&format!("{}:", standard_input::NAME)) => {
                (standard_input::NAME, standard_input::kept()?.to_owned())
            }
            None => return None,
        };
        let read = |text: &str| formats::read(path, text.as_bytes()).map(drop);
        let corrected = corrected(&content, read)?;
        let lines = content.lines().zip(corrected.lines()).enumerate();
        let mut changed = lines.filter(|(_, (old, new))| old != new);
        let (number, (_, line)) = changed.next()?;
        Some(format!("line {} of {path}: {}", number + 1, line.trim()))
    }

    /// The line with the file that was meant: one of a similar name, or an equation that was typed in its place.
    fn with_file(&self, path: &Path) -> Option<String> {
        let typed = path.to_str()?;
        let place = self.0.iter().position(|word| word == typed)?;
        let option = place.checked_sub(1).map(|before| &self.0[before][..]);
        let option = option.filter(|word| word.starts_with("--"));
        let is_number = |word: &str| word.parse::<f64>().is_ok();
        if option == Some("--poses") && typed.split_whitespace().all(is_number) {
            let mut words = self.0.clone();
            words[place - 1] = "--pose".to_owned();
            return Some(TypedLine(words).with_word(place, &quoted(typed)));
        }
        let is_equation = option.is_none()
            && typed.contains(['=', '^', '*'])
            && self.named().has_argument("equation");
        if is_equation {
            return Some(self.with_word(place, &format!("-e {}", quoted(typed))));
        }
        let name = path.file_name()?.to_str()?;
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let nearest = nearest(name, names)?;
        let there = path.with_file_name(nearest);
        Some(self.with_word(place, &quoted(there.to_str()?)))
    }
}

impl Named {
    /// Whether the command has an argument of this name.
    fn has_argument(&self, id: &str) -> bool {
        self.command.get_arguments().any(|a| a.get_id() == id)
    }

    /// The examples of the command's help, without the remarks beside them.
    fn examples(&self) -> Vec<String> {
        let help = self.command.get_after_help();
        let mut help = help.map(ToString::to_string).unwrap_or_default();
        // A long example goes on in the next line.
        while let Some(at) = help.find("\\\n") {
            let rest = help[at + 2..].trim_start().to_owned();
            help.truncate(at);
            help.push_str(&rest);
        }
        let lines = help.lines().filter(|line| line.starts_with("  cognate "));
        let example = |line: &str| line.trim().split("   ").next().map(str::to_owned);
        lines.filter_map(example).collect()
    }

    /// An example with one of these options; else with what the first of them takes; else the first example.
    fn example(&self, options: &[String]) -> String {
        let examples = self.examples();
        if let Some(example) = self.examples_with(options).first() {
            return example.clone();
        }
        let usage = options.iter().find_map(|option| self.usage(option));
        let help = || format!("{} --help", self.name);
        usage.unwrap_or_else(|| examples.first().cloned().unwrap_or_else(help))
    }

    /// The examples with these options, those of the first option first.
    fn examples_with(&self, options: &[String]) -> Vec<String> {
        let has = |example: &String, option: &String| {
            let mut words = example.split([' ', '=']);
            words.any(|word| word == option)
        };
        let with = |option: &String| -> Vec<String> {
            let examples = self.examples().into_iter();
            examples.filter(|example| has(example, option)).collect()
        };
        options.iter().flat_map(with).collect()
    }

    /// The command with an option that it has.
    fn usage(&self, option: &str) -> Option<String> {
        let long = option.strip_prefix("--")?;
        let mut arguments = self.command.get_arguments();
        let argument = arguments.find(|a| a.get_long() == Some(long))?;
        let names = |argument: &clap::Arg| {
            let names = argument.get_value_names().unwrap_or_default();
            let names: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
            names.join(" ")
        };
        let positionals = self.command.get_positionals();
        let positionals = positionals.map(|a| match names(a).as_str() {
            "" => a.get_id().as_str().to_uppercase(),
            names => names.to_owned(),
        });
        let positionals: Vec<String> = positionals.collect();
        let value = match argument.get_action().takes_values() {
            true => format!(" {}", names(argument)),
            false => String::new(),
        };
        let line = format!("{} {} {option}{value}", self.name, positionals.join(" "));
        Some(line.split_whitespace().collect::<Vec<&str>>().join(" "))
    }
}

/// The five things that people want, where nothing was typed but the program's name.
pub fn five_things() -> &'static str {
    "\
Cognate finds all solutions of polynomial equations, and all positions of mechanisms. Five things to type:

  cognate solve -e \"x^2 + y^2 = 5\" -e \"x*y = 2\"            the solutions of equations, typed or in a file
  cognate decompose -e \"x*y = 0\"                           curves, surfaces, ... of solutions
  cognate mechanism inverse arm.urdf --poses poses.csv     the postures of an arm
  cognate mechanism motion linkage.json                    how a linkage moves
  cognate synthesize nine-point points.csv                 the linkages that pass through points

All commands: cognate --help
"
}

/// The refusal of arguments behind the words of a command, in the words of the command line, without a line to type.
pub fn misunderstood(refusal: &clap::Error, words: &[&str], arguments: &[String]) -> ClientError {
    let words = words.iter().map(OsString::from);
    let typed = TypedLine::new(words.chain(arguments.iter().map(OsString::from)));
    let said = typed.misunderstood(refusal, false);
    ClientError::Misfit(without_remedy(&said).to_owned())
}

/// Text of a refusal, without `error: ` before it and the line to type after it.
fn without_remedy(said: &str) -> &str {
    let said = said.strip_prefix("error: ").unwrap_or(said);
    let end = said.find(&format!("\n{LEAD}")).unwrap_or(said.len());
    said[..end].trim_end()
}

/// The text of a refusal without suggestions of options that are not alike.
fn without_tips(text: &str, refusal: &clap::Error) -> String {
    let wrong = refusal.get(ContextKind::InvalidArg).and_then(one);
    let suggested = refusal.get(ContextKind::SuggestedArg);
    let is_meant = wrong.zip(suggested).is_none_or(|(wrong, suggested)| {
        suggestion(suggested, &wrong).is_some_and(|word| is_similar(&wrong, &word))
    });
    let is_said = |line: &&str| {
        let (is_of_value, is_similar) =
            (line.contains("to pass "), line.contains("similar argument"));
        !is_of_value && (is_meant || !is_similar)
    };
    let lines: Vec<&str> = text.lines().filter(is_said).collect();
    lines.join("\n").replace("\n\n\n", "\n\n")
}

/// Whether a word of an example is the name of a file.
fn is_file_name(word: &str) -> bool {
    let end = word.rsplit_once('.').map_or("", |(_, end)| end);
    let is_letter = |c: char| c.is_ascii_lowercase();
    word.starts_with(is_letter) && end.len() > 1 && end.chars().all(is_letter)
}

/// Whether an option is meant by a word that is like it.
fn is_similar(word: &str, option: &str) -> bool {
    let (word, option) = (word.trim_start_matches('-'), option.trim_start_matches('-'));
    let is_begin = word.len() >= 3 && option.starts_with(word);
    is_begin || strsim::jaro_winkler(word, option) >= SIMILAR
}

/// Equations as the lines of a text.
fn joined(equations: &[(usize, String)]) -> String {
    let lines: Vec<&str> = equations.iter().map(|(_, text)| text.as_str()).collect();
    lines.join("\n")
}

/// Whether a message names a line of a file: it begins with `FILE:LINE: `.
fn has_line(text: &str) -> bool {
    let place = text.split(": ").next().unwrap_or_default();
    let line = place.rsplit_once(':').map_or("", |(_, line)| line);
    !line.is_empty() && line.bytes().all(|b| b.is_ascii_digit())
}

/// The line that shows how a mechanism's file is written, in the notation of the file that a message names.
fn form_of_mechanism(text: &str) -> &'static str {
    let file = text.split(':').next().unwrap_or_default();
    if file.ends_with(".csv") {
        r"printf 'name,theta,d,a,alpha\nq1,0,0.1,0.4,90deg\n' | cognate mechanism info -"
    } else if file.ends_with(".urdf") {
        "echo '<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"q1\" type=\"continuous\"><parent link=\"a\"/>\
         <child link=\"b\"/><axis xyz=\"0 0 1\"/></joint></robot>' | cognate mechanism info -"
    } else {
        "cognate mechanism schema"
    }
}

/// Options that a text names, in its order.
fn options_in(text: &str) -> Vec<String> {
    let is_of_option = |c: char| c.is_ascii_lowercase() || c == '-' || c.is_ascii_digit();
    let mut options: Vec<String> = Vec::new();
    for (at, _) in text.match_indices("--") {
        let rest = &text[at..];
        let end = rest.find(|c| !is_of_option(c)).unwrap_or(rest.len());
        let option = rest[..end].trim_end_matches('-').to_owned();
        if option.len() > 2 && !options.contains(&option) {
            options.push(option);
        }
    }
    options
}

/// One word of clap's description of an error.
fn one(value: &ContextValue) -> Option<String> {
    match value {
        ContextValue::String(word) => Some(word.clone()),
        ContextValue::Strings(words) => words.first().cloned(),
        _ => None,
    }
}

/// Word that clap suggests instead of a typed word: of several suggestions the one that takes the fewest slips of the
/// fingers.
fn suggestion(suggested: &ContextValue, wrong: &str) -> Option<String> {
    match suggested {
        ContextValue::Strings(words) => {
            let slips = |word: &&String| strsim::damerau_levenshtein(word, wrong);
            words.iter().min_by_key(slips).cloned()
        }
        suggested => one(suggested),
    }
}

/// The words of the command of this name, wherever it stands.
fn elsewhere(within: &Command, before: &str, name: &str) -> Option<String> {
    within.get_subcommands().find_map(|command| {
        let words = format!("{before} {}", command.get_name()).trim().to_owned();
        match command.get_name() == name {
            true => Some(words),
            false => elsewhere(command, &words, name),
        }
    })
}

/// The name that is most similar to this one, where one is similar.
pub fn nearest(name: &str, names: impl IntoIterator<Item = String>) -> Option<String> {
    let similarity = |other: &String| strsim::jaro_winkler(name, other);
    let scored = names.into_iter().map(|other| (similarity(&other), other));
    let best = scored.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (best.0 >= SIMILAR).then_some(best.1)
}

/// A word as a shell takes it.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_./:=,+-@%".contains(c);
    match (
        word.is_empty() || !word.chars().all(is_plain),
        word.contains(['"', '$', '`', '\\']),
    ) {
        (false, _) => word.to_owned(),
        (true, false) => format!("\"{word}\""),
        (true, true) => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(words: &[&str]) -> TypedLine {
        let program = std::iter::once("cognate");
        TypedLine::new(program.chain(words.iter().copied()).map(OsString::from))
    }

    fn misunderstood(words: &[&str]) -> String {
        use clap::Parser;
        let program = std::iter::once("cognate");
        let refusal = Arguments::try_parse_from(program.chain(words.iter().copied()));
        let text = typed(words).misunderstood(&refusal.expect_err("a mistake"), false);
        text.lines().last().unwrap_or_default().to_owned()
    }

    #[test]
    fn what_is_misspelt_is_mended_in_the_line() {
        assert_eq!(
            misunderstood(&["slove", "a b.txt"]),
            "  try: cognate solve \"a b.txt\""
        );
        assert_eq!(
            misunderstood(&["solve", "f.txt", "--formt=json"]),
            "  try: cognate solve f.txt --format=json"
        );
        assert_eq!(
            misunderstood(&["solve", "f.txt", "--format", "jsn"]),
            "  try: cognate solve f.txt --format json"
        );
        assert_eq!(
            misunderstood(&["inverse", "arm.json"]),
            "  try: cognate mechanism inverse arm.json"
        );
    }

    fn refused(words: &[&str], message: &str) -> String {
        let error = ClientError::Format(message.to_owned());
        let line = typed(words).remedy(&error);
        line.unwrap_or_default()
    }

    #[test]
    fn slips_of_notation_are_mended_in_the_line() {
        assert_eq!(
            refused(&["solve", "-e", "2 x = 1", "--certify"], "-e:1:3: expected"),
            "  try: cognate solve -e \"2*x = 1\" --certify"
        );
        assert_eq!(
            refused(
                &["decompose", "--equation=x = 1", "--equation=2 y = 4"],
                "-e:2:3: expected"
            ),
            "  try: cognate decompose \"--equation=x = 1\" \"--equation=2*y = 4\""
        );
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.txt");
        std::fs::write(&path, "x = 1\n  2 y = 3 # two\n").expect("it is writable");
        let path = path.to_str().expect("a name");
        assert_eq!(
            refused(&["info", path], &format!("{path}:2:5: expected")),
            format!("  try: line 2 of {path}: 2*y = 3 # two")
        );
        // If the meaning of the typed line is not clear, the remedy is an example.
        assert_eq!(
            refused(&["solve", "-e", "x + = 1"], "-e:1:5: expected"),
            "  try: cognate solve -e \"x^2 + y^2 = 5\" -e \"x*y = 2\""
        );
    }

    #[test]
    fn an_option_that_goes_with_a_start_gets_it() {
        let wrong = ClientError::Input {
            origin: "--idle-loops".into(),
            message: format!("{ONLY_WITH_START}monodromy"),
        };
        let remedy = |words: &[&str]| typed(words).remedy(&wrong).unwrap_or_default();
        assert_eq!(
            remedy(&["solve", "f.txt", "--idle-loops", "3"]),
            "  try: cognate solve f.txt --idle-loops 3 --start monodromy"
        );
        assert_eq!(
            remedy(&["solve", "f.txt", "--start", "polyhedral", "--idle-loops=3"]),
            "  try: cognate solve f.txt --start monodromy --idle-loops=3"
        );
    }

    #[test]
    fn an_unknown_of_the_objective_alone_stands_among_the_equations() {
        let refused = |objective: &str| {
            let line = ["solve", "-e", "x^2 + why^2 = 2", "--minimize", objective];
            refused(&line, "--minimize:1:1: expected")
        };
        assert_eq!(
            refused("x + z^2"),
            "  try: cognate solve -e \"x^2 + why^2 = 2\" -e \"minimize: x + z^2\""
        );
        assert_eq!(
            refused("x + Why^2"),
            "  try: cognate solve -e \"x^2 + why^2 = 2\" --minimize x"
        );
    }

    /// The line to type left the condition and the objective out (2026-11-30).
    #[test]
    fn a_condition_that_an_objective_does_not_take_is_changed_in_the_line() {
        let changed = |condition: &str| {
            let line = [
                "solve",
                "-e",
                "x^2 = 4",
                "--minimize",
                "x",
                "--where",
                condition,
            ];
            let error = ClientError::Input {
                origin: CONDITIONS.to_owned(),
                message: "expected comparisons".to_owned(),
            };
            let line = typed(&line).remedy(&error).expect("a line");
            let start = format!("{LEAD}cognate solve -e \"x^2 = 4\" --minimize x ");
            line.strip_prefix(&start).expect(&line).to_owned()
        };
        assert_eq!(changed("x > 0 or x < -1"), "--where \"x > 0\"");
        assert_eq!(changed("x != 0"), "--where \"x > 0\"");
        assert_eq!(changed("x = 2"), "-e \"x = 2\"");
    }

    #[test]
    fn a_command_without_a_problem_gets_one() {
        let example = "cognate solve -e \"x^2 + y^2 = 5\" -e \"x*y = 2\"";
        assert_eq!(misunderstood(&["solve"]), format!("  try: {example}"));
    }

    #[test]
    fn an_example_has_the_option_that_is_at_fault() {
        let wrong = ClientError::Input {
            origin: "--box".into(),
            message: "1 range; expected 2".into(),
        };
        let line = typed(&["sample", "set", "--box", "0..1"]).remedy(&wrong);
        assert_eq!(
            line.as_deref(),
            Some(
                "  try: cognate sample here --component 1.1 --count 20 --real --box '0..1,-1..1,-1..1'"
            )
        );
        let missing = ClientError::WithoutValues {
            origin: "family.txt".into(),
            names: vec!["p".into(), "q".into()],
        };
        let line = typed(&["solve", "family.txt"]).remedy(&missing);
        let expected = "  try: cognate solve family.txt --targets \"p=1\" --targets \"q=1\"";
        assert_eq!(line.as_deref(), Some(expected));
    }

    /// A refusal can always end with an example of the command.
    #[test]
    fn every_command_has_an_example() {
        fn check(name: &str, command: &Command) {
            if command.has_subcommands() {
                for below in command.get_subcommands() {
                    check(&format!("{name} {}", below.get_name()), below);
                }
                return;
            }
            let named = Named {
                name: name.to_owned(),
                command: command.clone(),
            };
            let examples = named.examples();
            let is_own = |example: &&String| example.starts_with(name);
            assert!(examples.iter().any(|e| is_own(&e)), "{name}: {examples:?}");
        }
        check("cognate", &Arguments::command());
    }
}

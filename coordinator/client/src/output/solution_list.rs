//! The first solutions as a table: a column each for number, kind, condition, and as many variables as fit.

use super::listed::Listed;
use super::text::{Look, complex, count, counted, magnitude, real, wrapped};
use crate::common_arguments::Shown;
use cognate_solutions::selection::Verdict;
use cognate_solutions::solution::Solution;
use num_complex::Complex64;
use std::fmt::Write as _;
use std::path::Path;

/// Solutions that a table lists at least, where their number is not asked.
const LEAST_SHOWN: usize = 8;
/// Solutions that a table lists where standard output is no terminal.
const SHOWN_WITHOUT_TERMINAL: usize = 1000;
/// Lines of a terminal that the counts above the list take.
const LINES_OF_COUNTS: usize = 30;

/// Names of variables without a column that are listed.
const NAMES_LISTED: usize = 20;

/// How many solutions are listed: as many as were asked, else what fits the terminal.
pub fn solutions_shown(show: Option<Shown>) -> usize {
    match show {
        Some(Shown::First(number)) => number,
        Some(Shown::All) => usize::MAX,
        None => {
            console::Term::stdout()
                .size_checked()
                .map_or(SHOWN_WITHOUT_TERMINAL, |(lines, _)| {
                    usize::from(lines)
                        .saturating_sub(LINES_OF_COUNTS)
                        .max(LEAST_SHOWN)
                })
        }
    }
}

/// Significant figures of a coordinate in a table; files have all of them.
const FIGURES: usize = 6;
/// Largest accuracy (error over the largest coordinate) of solutions whose coordinates are each rounded to doubles once:
/// the rounding (2^-52) and an error that it hides (2^-57), see `iterative_refinement`.
const ROUNDED_ONCE: f64 = 1.03125 * f64::EPSILON;

/// A heading, and a cell for each solution.
struct Column {
    name: String,
    cells: Vec<String>,
}

impl Column {
    fn new(name: &str, cells: impl Iterator<Item = String>) -> Self {
        Self {
            name: name.to_owned(),
            cells: cells.collect(),
        }
    }

    fn numbers(solutions: &[Listed]) -> Self {
        let digits = solutions.len().to_string().len();
        let numbers = (1..=solutions.len()).map(|i| format!("{i:>digits$}"));
        Self::new("#", numbers)
    }

    fn kinds(solutions: &[Listed]) -> Self {
        Self::new("kind", solutions.iter().map(kind))
    }

    fn conditions(solutions: &[Listed]) -> Self {
        let conditions = solutions
            .iter()
            .map(|listed| magnitude(listed.solution.condition));
        Self::new("condition", conditions)
    }

    fn objectives(solutions: &[Listed]) -> Self {
        let value = |listed: &Listed| {
            let value = listed.critical.map(|point| real(point.objective, FIGURES));
            value.unwrap_or_default()
        };
        Self::new("objective", solutions.iter().map(value))
    }

    /// Values of the variable at this place.
    fn variable(name: &str, place: usize, solutions: &[Listed]) -> Self {
        let cell = |listed: &Listed| {
            let solution = &listed.solution;
            let named = solution.variables.0.get(place);
            named.map_or(String::new(), |v| match &v.digits {
                Some([re, im]) if v.value == Complex64::default() => below_doubles(re, im),
                _ => coordinate(solution, v.value),
            })
        };
        let mut column = Self::new(name, solutions.iter().map(cell));
        // Signs stand in a column of their own.
        if column.cells.iter().any(|c| c.starts_with('-')) {
            for cell in column.cells.iter_mut().filter(|c| !c.starts_with('-')) {
                cell.insert(0, ' ');
            }
        }
        column
    }

    fn width(&self) -> usize {
        let texts = self.cells.iter().chain([&self.name]);
        texts.map(|c| c.chars().count()).max().unwrap_or(0)
    }
}

/// A number of which doubles hold no digit, by the digits of its parts.
fn below_doubles(re: &str, im: &str) -> String {
    let short = |part: &str| {
        let (digits, exponent) = part.split_once('e').unwrap_or((part, "0"));
        let figures = FIGURES + 1 + usize::from(digits.starts_with('-'));
        let digits: String = digits.chars().take(figures).collect();
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        match (digits, exponent) {
            ("" | "-", _) => "0".to_owned(),
            (digits, "0") => digits.to_owned(),
            (digits, exponent) => format!("{digits}e{exponent}"),
        }
    };
    match (short(re), short(im)) {
        (re, im) if im == "0" => re,
        (re, im) if re == "0" => format!("{im}i"),
        (re, im) if im.starts_with('-') => format!("{re}{im}i"),
        (re, im) => format!("{re}+{im}i"),
    }
}

/// Solutions, one a line, as many variables as fit; `total` is how many there are.
pub fn solution_list(shown: &[Listed], total: u64, files: Option<&Path>, look: Look) -> String {
    let Some(first) = shown.first() else {
        return String::new();
    };
    let mut columns = vec![Column::numbers(shown)];
    let kinds = Column::kinds(shown);
    if !kinds.cells.iter().all(String::is_empty) {
        columns.push(kinds);
    }
    columns.push(Column::conditions(shown));
    if first.critical.is_some() {
        columns.push(Column::objectives(shown));
    }
    let fixed = columns.len();
    let variables = first.solution.variables.0.iter().enumerate();
    columns.extend(variables.map(|(v, named)| Column::variable(&named.name, v, shown)));
    let fitting = fitting(&columns, fixed, look.width);
    let left_out: Vec<String> = columns.drain(fitting..).map(|column| column.name).collect();
    let mut text = lines(&columns, shown.len(), left_out.len(), look);
    let more = total.saturating_sub(shown.len() as u64);
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        notes.push(not_shown(&left_out, fitting - fixed, shown));
    }
    if more > 0 || !left_out.is_empty() || files.is_some() {
        notes.push(note(more, files));
    }
    for line in notes.iter().flat_map(|note| wrapped(note, look.width - 2)) {
        let _ = writeln!(text, "  {}", look.dim(&line));
    }
    text
}

/// The variables that are not shown, the first of which has this place, and the largest of their values.
fn not_shown(names: &[String], first: usize, shown: &[Listed]) -> String {
    let values = shown.iter().enumerate().flat_map(|(row, listed)| {
        let variables = listed.solution.variables.0.iter().skip(first);
        variables.map(move |variable| (variable.value.norm_sqr(), row, variable))
    });
    let largest = values.max_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let largest = largest.map_or(String::new(), |(square, row, variable)| {
        let size = magnitude(square.sqrt());
        format!(
            "; the largest of these values is {size} ({} of {})",
            variable.name,
            row + 1
        )
    });
    let more = match names.len().saturating_sub(NAMES_LISTED) {
        0 => String::new(),
        more => format!(" and {}", counted(more as u64, "other")),
    };
    let listed = names[..names.len().min(NAMES_LISTED)].join(", ");
    format!("not shown: {listed}{more}{largest}")
}

/// How many columns fit: at least one variable, with room to say how many are left out.
fn fitting(columns: &[Column], fixed: usize, width: usize) -> usize {
    let widths: Vec<usize> = columns.iter().map(Column::width).collect();
    let mut used = widths[..fixed].iter().map(|w| w + 2).sum::<usize>();
    let mut fitting = fixed;
    for (i, w) in widths.iter().enumerate().skip(fixed) {
        let mark = match columns.len() - i - 1 {
            0 => 0,
            left => format!("  +{left} more").len(),
        };
        if i > fixed && used + w + 2 + mark > width {
            break;
        }
        used += w + 2;
        fitting = i + 1;
    }
    fitting
}

/// The heading, and a line for each solution.
fn lines(columns: &[Column], rows: usize, left_out: usize, look: Look) -> String {
    let widths: Vec<usize> = columns.iter().map(Column::width).collect();
    let line = |cell: &dyn Fn(&Column) -> String| {
        let cells = columns.iter().zip(&widths);
        let padded = cells.map(|(column, width)| format!("  {:<width$}", cell(column)));
        padded.collect::<String>()
    };
    let mut heading = line(&|column| column.name.clone());
    if left_out > 0 {
        let _ = write!(heading, "  +{left_out} more");
    }
    let mut text = String::new();
    let _ = writeln!(text, "{}", look.bold(heading.trim_end()));
    for row in 0..rows {
        let line = line(&|column| column.cells[row].clone());
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// How many solutions are not shown, and where they are.
fn note(more: u64, files: Option<&Path>) -> String {
    let mut note = String::new();
    if more > 0 {
        let _ = write!(note, "and {} more (--show all); ", count(more));
    }
    match files {
        Some(folder) => {
            let folder = folder.display();
            let _ = write!(note, "all digits of all of them are in {folder}");
        }
        None => note.push_str("--output DIR or --format csv writes all digits of all of them"),
    }
    note
}

/// Real or complex, singular or undecided, and how often it counts.
fn kind(listed: &Listed) -> String {
    let solution = &listed.solution;
    let mut words = Vec::new();
    words.extend(solution.real.map(|real| match real {
        true => "real".to_owned(),
        false => "complex".to_owned(),
    }));
    if solution.undecided {
        words.push("undecided".to_owned());
    } else if solution.singular {
        words.push("singular".to_owned());
    }
    if solution.multiplicity > 1 {
        words.push(format!("x{}", solution.multiplicity));
    }
    words.extend(
        listed
            .critical
            .and_then(|point| point.kind)
            .map(|kind| kind.name().to_owned()),
    );
    match listed.verdict {
        Some(Verdict::OnBorder) => words.push("on border".to_owned()),
        Some(Verdict::Undecided) => words.push("not decided".to_owned()),
        _ => {}
    }
    words.join(" ")
}

/// A coordinate without parts that are only rounding.
fn coordinate(solution: &Solution, z: Complex64) -> String {
    // Parts of coordinates that are rounded to doubles once are 0 where their error may make them 0.
    let is_rounded_once = !solution.singular && solution.accuracy <= ROUNDED_ONCE;
    // Of others a part below the solution's own error estimate says nothing. Nor does one that is below the shown figures
    // of the other part by a thousand.
    let values = solution.variables.0.iter();
    let parts = values.map(|v| v.value.re.abs().max(v.value.im.abs()));
    let noise = match is_rounded_once {
        true => 0.0,
        false => solution.accuracy.clamp(1e-14, 1e-6) * parts.fold(1.0, f64::max),
    };
    let keep = |part: f64| if part.abs() <= noise { 0.0 } else { part };
    complex(Complex64::new(keep(z.re), keep(z.im)), FIGURES, 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_below_the_doubles_have_their_first_figures() {
        let text = |re: &str, im: &str| below_doubles(re, im);
        assert_eq!(text("-1.000000000000000e-350", "0"), "-1e-350");
        assert_eq!(text("0", "1.234567891e-400"), "1.23456e-400i");
        assert_eq!(text("2.5e-350", "-1.5e-350"), "2.5e-350-1.5e-350i");
        assert_eq!(text("0", "0"), "0");
    }
}

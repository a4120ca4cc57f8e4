//! The first solutions as a table: a column each for number, kind, condition, and as many variables as fit.

use super::text::{Look, complex, count, cut, magnitude, wrapped};
use cognate_solutions::solution::Solution;
use num_complex::Complex64;
use std::fmt::Write as _;
use std::path::Path;

/// Solutions shown before a table says how many more there are.
pub const SOLUTIONS_SHOWN: usize = 8;

/// Significant figures of a coordinate in a table; files have all of them.
const FIGURES: usize = 6;

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

    fn numbers(solutions: &[Solution]) -> Self {
        let digits = solutions.len().to_string().len();
        let numbers = (1..=solutions.len()).map(|i| format!("{i:>digits$}"));
        Self::new("#", numbers)
    }

    fn kinds(solutions: &[Solution]) -> Self {
        Self::new("kind", solutions.iter().map(kind))
    }

    fn conditions(solutions: &[Solution]) -> Self {
        let conditions = solutions.iter().map(|s| magnitude(s.condition));
        Self::new("condition", conditions)
    }

    /// Values of the variable at this place.
    fn variable(name: &str, place: usize, solutions: &[Solution]) -> Self {
        let cell = |s: &Solution| {
            let named = s.variables.0.get(place);
            named.map_or(String::new(), |v| coordinate(s, v.value))
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
        let all = self.cells.iter().chain([&self.name]);
        all.map(|c| c.chars().count()).max().unwrap_or(0)
    }
}

/// The first solutions, one a line, as many variables as fit; `total` is how many there are.
pub fn solution_list(
    solutions: &[Solution],
    total: u64,
    files: Option<&Path>,
    look: Look,
) -> String {
    let Some(first) = solutions.first() else {
        return String::new();
    };
    let shown = &solutions[..solutions.len().min(SOLUTIONS_SHOWN)];
    let mut columns = vec![Column::numbers(shown)];
    let kinds = Column::kinds(shown);
    if !kinds.cells.iter().all(String::is_empty) {
        columns.push(kinds);
    }
    columns.push(Column::conditions(shown));
    let fixed = columns.len();
    let variables = first.variables.0.iter().enumerate();
    columns.extend(variables.map(|(v, named)| Column::variable(&named.name, v, shown)));
    let fitting = fitting(&columns, fixed, look.width);
    let left_out = columns.len() - fitting;
    columns.truncate(fitting);
    let mut text = lines(&columns, shown.len(), left_out, look);
    let more = total.saturating_sub(shown.len() as u64);
    if more > 0 || left_out > 0 || files.is_some() {
        text.push_str(&note(more, files, look));
    }
    text
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
    let _ = writeln!(text, "{}", look.bold(&cut(heading.trim_end(), look.width)));
    for row in 0..rows {
        let line = line(&|column| column.cells[row].clone());
        let _ = writeln!(text, "{}", cut(line.trim_end(), look.width));
    }
    text
}

/// What is not shown, and where it is.
fn note(more: u64, files: Option<&Path>, look: Look) -> String {
    let mut note = String::new();
    if more > 0 {
        let _ = write!(note, "and {} more; ", count(more));
    }
    match files {
        Some(folder) => {
            let folder = folder.display();
            let _ = write!(note, "all digits of all of them are in {folder}");
        }
        None => note.push_str("--output DIR writes all digits of all of them"),
    }
    let mut text = String::new();
    for line in wrapped(&note, look.width - 2) {
        let _ = writeln!(text, "  {}", look.dim(&line));
    }
    text
}

/// Real or complex, singular or undecided, and how often it counts.
fn kind(solution: &Solution) -> String {
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
    words.join(" ")
}

/// A coordinate without what is only rounding.
fn coordinate(solution: &Solution, z: Complex64) -> String {
    // A part below the solution's own error estimate says nothing; nor does one that is below
    // the shown figures of the other by a thousand.
    let values = solution
        .variables
        .0
        .iter()
        .map(|v| v.value.re.abs().max(v.value.im.abs()));
    let noise = solution.accuracy.clamp(1e-14, 1e-6) * values.fold(1.0, f64::max);
    let keep = |part: f64| if part.abs() <= noise { 0.0 } else { part };
    complex(Complex64::new(keep(z.re), keep(z.im)), FIGURES, 1e-9)
}

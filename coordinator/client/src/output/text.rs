//! How numbers, times and styles become text for people: one look for all tables.

use num_complex::Complex64;
use std::fmt::Write as _;

/// Properties of the reader's terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Width of the terminal, in columns.
    pub width: usize,
    /// Whether colours are wanted: a terminal, and `NO_COLOR` is not set.
    pub color: bool,
}

impl Look {
    /// The look of standard output.
    pub fn of_standard_output() -> Self {
        Self::of(&console::Term::stdout(), console::colors_enabled())
    }

    /// The look of standard error.
    pub fn of_standard_error() -> Self {
        Self::of(&console::Term::stderr(), console::colors_enabled_stderr())
    }

    fn of(term: &console::Term, color: bool) -> Self {
        // A pipe has no width; 100 columns suit logs and mail.
        let width = term
            .size_checked()
            .map_or(100, |(_, columns)| usize::from(columns));
        Self {
            width: width.clamp(60, 160),
            color,
        }
    }

    /// Headings and the numbers that answer the question.
    pub fn bold(&self, text: &str) -> String {
        self.styled(text, "1")
    }

    /// Explanations.
    pub fn dim(&self, text: &str) -> String {
        self.styled(text, "2")
    }

    /// All is well.
    pub fn good(&self, text: &str) -> String {
        self.styled(text, "32")
    }

    /// Somebody should look.
    pub fn warn(&self, text: &str) -> String {
        self.styled(text, "33")
    }

    /// Something went wrong.
    pub fn bad(&self, text: &str) -> String {
        self.styled(text, "31")
    }

    fn styled(&self, text: &str, code: &str) -> String {
        if self.color && !text.is_empty() {
            format!("\x1b[{code}m{text}\x1b[0m")
        } else {
            text.to_string()
        }
    }
}

/// A count with its thousands apart: 143,360.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `1 path`, `2 paths`.
pub fn counted(n: u64, noun: &str) -> String {
    let words = cognate_numeric::counted::counted(n, noun);
    words.replacen(&n.to_string(), &count(n), 1)
}

/// A time in the unit that suits it: `4.1 ms`, `0.41 s`, `2 min 05 s`, `3 h 20 min`.
pub fn seconds(s: f64) -> String {
    if !s.is_finite() || s < 0.0 {
        "?".into()
    } else if s < 0.0995 {
        format!("{:.1} ms", s * 1e3)
    } else if s < 9.995 {
        format!("{s:.2} s")
    } else if s < 59.95 {
        format!("{s:.1} s")
    } else if s < 3599.5 {
        let whole = s.round() as u64;
        format!("{} min {:02} s", whole / 60, whole % 60)
    } else {
        let minutes = (s / 60.0).round() as u64;
        format!("{} h {:02} min", minutes / 60, minutes % 60)
    }
}

/// A rate with three figures: 12.4, 312, 9,160.
pub fn rate(per_second: f64) -> String {
    if !per_second.is_finite() || per_second < 0.0 {
        "?".into()
    } else if per_second < 99.95 {
        format!("{per_second:.1}")
    } else {
        count(per_second.round() as u64)
    }
}

/// A magnitude by two figures: 3.5e1, 1e-16; `-` where it is unknown.
pub fn magnitude(x: f64) -> String {
    if x.is_nan() {
        "-".into()
    } else if x.is_infinite() {
        "inf".into()
    } else if x == 0.0 {
        "0".into()
    } else {
        format!("{x:.1e}")
    }
}

/// A coordinate with `figures` significant figures, without needless zeros.
pub fn real(x: f64, figures: usize) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return x.to_string();
    }
    // Rust's own conversion says the decimal exponent after rounding.
    let scientific = format!("{x:.*e}", figures - 1);
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = (figures as i32 - 1 - exponent).max(0) as usize;
        trimmed(&format!("{x:.decimals$}"))
    } else {
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        format!("{}e{exponent}", trimmed(mantissa))
    }
}

fn trimmed(decimal: &str) -> String {
    if decimal.contains('.') {
        let text = decimal.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" {
            "0".into()
        } else {
            text.into()
        }
    } else {
        decimal.into()
    }
}

/// A complex coordinate. A part below `noise` times the other is rounding, and not shown.
pub fn complex(z: Complex64, figures: usize, noise: f64) -> String {
    let scale = z.re.abs().max(z.im.abs());
    let keep = |part: f64| {
        if part.abs() <= noise * scale {
            0.0
        } else {
            part
        }
    };
    let (re, im) = (keep(z.re), keep(z.im));
    if im == 0.0 {
        return real(re, figures);
    }
    let imaginary = real(im, figures);
    if re == 0.0 {
        return format!("{imaginary}i");
    }
    let sign = if imaginary.starts_with('-') { "" } else { "+" };
    format!("{}{sign}{imaginary}i", real(re, figures))
}

/// Breaks a text into lines of at most `width` columns at its spaces.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![];
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// A text cut to `width` columns, with a mark where something is missing: for a line of a screen.
pub fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.into();
    }
    let mut short: String = text.chars().take(width.saturating_sub(1)).collect();
    short.push('…');
    short
}

/// Columns of a last column of sentences that is wrapped in its place, at least.
const LEAST_WRAPPED: usize = 24;

/// Columns of text, the first row a heading: left- or right-aligned, two spaces between.
#[derive(Clone, Debug)]
pub struct Columns {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
    /// How many of the first columns tell a row from others.
    keys: usize,
}

impl Columns {
    /// The headings; one that begins with `>` stands over a right-aligned column.
    pub fn new(headings: &[&str]) -> Self {
        Self {
            right: headings.iter().map(|h| h.starts_with('>')).collect(),
            rows: vec![
                headings
                    .iter()
                    .map(|h| h.trim_start_matches('>').to_string())
                    .collect(),
            ],
            keys: 1,
        }
    }

    /// The columns, with the number of first columns that tell a row from others.
    #[must_use]
    pub fn with_keys(self, keys: usize) -> Self {
        Self { keys, ..self }
    }

    /// Adds one row.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    fn widths(&self) -> Vec<usize> {
        let widest = |c: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(c));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        (0..self.right.len()).map(widest).collect()
    }

    /// The lines, with every cell whole. Where they would be wider than the look, sentences in the last column go on below
    /// themselves; else columns that do not fit stand in further blocks, each of which begins with the keys.
    pub fn render(&self, look: Look) -> String {
        if let Some(narrow) = self.wrapped_at_end(look.width) {
            return narrow.lines_of(&narrow.all(), look);
        }
        let blocks = self.blocks(look.width);
        let blocks = blocks.iter().map(|block| self.lines_of(block, look));
        blocks.collect::<Vec<String>>().join("\n")
    }

    /// The lines, cut to the look's width: for a screen on which a row is one line.
    pub fn cut_lines(&self, look: Look) -> Vec<String> {
        let lines = self.plain_lines(&self.all()).into_iter().enumerate();
        let lines = lines.map(|(r, line)| {
            let line = cut(&line, look.width);
            if r == 0 { look.bold(&line) } else { line }
        });
        lines.collect()
    }

    fn all(&self) -> Vec<usize> {
        (0..self.right.len()).collect()
    }

    /// The places of the columns of each block.
    fn blocks(&self, width: usize) -> Vec<Vec<usize>> {
        let widths = self.widths();
        let keys: Vec<usize> = (0..self.keys.min(widths.len())).collect();
        let room = |block: &[usize]| block.iter().map(|&c| widths[c] + 2).sum::<usize>();
        let mut blocks = Vec::new();
        let mut block = keys.clone();
        for c in keys.len()..widths.len() {
            if block.len() > keys.len() && room(&block) + widths[c] > width {
                blocks.push(std::mem::replace(&mut block, keys.clone()));
            }
            block.push(c);
        }
        blocks.push(block);
        blocks
    }

    /// The columns with the sentences of the last column on several lines; `None` if this is not needed or does not
    /// make them fit.
    fn wrapped_at_end(&self, width: usize) -> Option<Self> {
        let widths = self.widths();
        let (last, before) = widths.split_last()?;
        let lead = before.iter().map(|w| w + 2).sum::<usize>();
        let room = width.checked_sub(lead).filter(|r| *r >= LEAST_WRAPPED)?;
        if *last <= room || self.right.last() == Some(&true) {
            return None;
        }
        let mut rows = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            let Some((sentence, cells)) = row.split_last().filter(|_| row.len() == widths.len())
            else {
                rows.push(row.clone());
                continue;
            };
            let mut parts = wrapped(sentence, room).into_iter();
            let mut first = cells.to_vec();
            first.push(parts.next().unwrap_or_default());
            rows.push(first);
            for part in parts {
                let mut below = vec![String::new(); cells.len()];
                below.push(part);
                rows.push(below);
            }
        }
        let narrow = Self {
            rows,
            ..self.clone()
        };
        // A word may be wider than the room.
        (narrow.widths().last() <= Some(&room)).then_some(narrow)
    }

    /// The lines of these columns.
    fn plain_lines(&self, columns: &[usize]) -> Vec<String> {
        let widths = self.widths();
        let line = |row: &Vec<String>| {
            let mut line = String::new();
            for (k, &c) in columns.iter().enumerate() {
                let cell = row.get(c).map_or("", String::as_str);
                let pad = " ".repeat(widths[c] - cell.chars().count());
                let between = if k > 0 { "  " } else { "" };
                let _ = match self.right[c] {
                    true => write!(line, "{between}{pad}{cell}"),
                    false => write!(line, "{between}{cell}{pad}"),
                };
            }
            line.trim_end().to_owned()
        };
        self.rows.iter().map(line).collect()
    }

    fn lines_of(&self, columns: &[usize], look: Look) -> String {
        let mut text = String::new();
        for (r, line) in self.plain_lines(columns).iter().enumerate() {
            let line = if r == 0 { &look.bold(line) } else { line };
            let _ = writeln!(text, "{line}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_their_thousands_apart() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(143_360), "143,360");
        assert_eq!(counted(1, "path"), "1 path");
        assert_eq!(counted(2, "path"), "2 paths");
    }

    #[test]
    fn times_have_the_unit_that_suits() {
        assert_eq!(seconds(0.0041), "4.1 ms");
        assert_eq!(seconds(0.0999), "0.10 s");
        assert_eq!(seconds(0.41), "0.41 s");
        assert_eq!(seconds(59.96), "1 min 00 s");
        assert_eq!(seconds(125.0), "2 min 05 s");
        assert_eq!(seconds(12_000.0), "3 h 20 min");
        assert_eq!(seconds(f64::NAN), "?");
    }

    #[test]
    fn coordinates_keep_their_figures() {
        assert_eq!(real(0.0, 6), "0");
        assert_eq!(real(1.0, 6), "1");
        assert_eq!(real(-0.656_749_052_6, 6), "-0.656749");
        assert_eq!(real(12_345.678, 6), "12345.7");
        assert_eq!(real(1.234_567_8e9, 6), "1.23457e9");
        assert_eq!(real(9.999_999_9e-5, 6), "0.0001");
        assert_eq!(real(3.0e-8, 6), "3e-8");
        assert_eq!(real(999_999.9, 6), "1e6");
    }

    #[test]
    fn a_part_that_is_rounding_is_not_shown() {
        let z = |re, im| Complex64::new(re, im);
        assert_eq!(complex(z(1.5, 1e-17), 6, 1e-12), "1.5");
        assert_eq!(complex(z(1e-17, -2.0), 6, 1e-12), "-2i");
        assert_eq!(complex(z(0.25, -0.5), 6, 1e-12), "0.25-0.5i");
        assert_eq!(complex(z(0.25, 0.5), 6, 1e-12), "0.25+0.5i");
        assert_eq!(complex(z(0.0, 0.0), 6, 1e-12), "0");
    }

    fn look(width: usize) -> Look {
        Look {
            width,
            color: false,
        }
    }

    #[test]
    fn columns_align_and_stand_in_blocks_where_they_do_not_fit() {
        let mut columns = Columns::new(&["job", ">paths", "state"]);
        columns.row(vec!["a".into(), "12".into(), "done".into()]);
        columns.row(vec!["abc".into(), "1,234".into(), "runs".into()]);
        assert_eq!(
            columns.render(look(60)),
            "job  paths  state\na       12  done\nabc  1,234  runs\n"
        );
        assert_eq!(
            columns.render(look(12)),
            "job  paths\na       12\nabc  1,234\n\njob  state\na    done\nabc  runs\n"
        );
        assert!(
            columns
                .cut_lines(look(8))
                .iter()
                .all(|line| line.chars().count() <= 8 && line.ends_with('…'))
        );
    }

    #[test]
    fn sentences_in_the_last_column_go_on_below_themselves() {
        let mut columns = Columns::new(&[">point", "reason"]);
        columns.row(vec!["1".into(), "one two three four five six".into()]);
        assert_eq!(
            columns.render(look(31)),
            "point  reason\n    1  one two three four five\n       six\n"
        );
        columns.row(vec!["2".into(), "w".repeat(40)]);
        let text = columns.render(look(31));
        assert!(
            !text.contains('…') && text.contains(&"w".repeat(40)),
            "{text}"
        );
    }

    #[test]
    fn long_texts_are_wrapped_at_spaces() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("", 7), Vec::<String>::new());
    }
}

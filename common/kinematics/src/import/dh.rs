//! Tables of Denavit and Hartenberg: a row for each joint, with columns `theta`, `d`, `a`, `alpha` and, if wanted, `type`,
//! `name`, `offset` (added to the joint's value, as `theta` is), `min` and `max`.
//!
//! The cell of the variable may hold a name, as books print it: `q2`, `theta2 - 90`, `q2 + pi/2`. Without a column `type`, a
//! row with a name in `d` and a number in `theta` shifts, and all others turn.
//!
//! Cells are separated by commas, semicolons or tabs. A line that begins with `#` is a comment, which may say the unit of
//! angles and the convention: `# angles: rad`, `# convention: modified`. An angle is in the unit that its cell (`pi/2`,
//! `1.2 rad`), its column (`alpha_rad`) or the table names, else in degrees. A number that is a right angle in radians is
//! refused where nothing names a unit.

use super::dh_variable::{ANGLES, Cell, LENGTHS, Variable};
use crate::mechanism::chain::{Chain, ChainJoint};
use crate::mechanism::document::{Document, MechanismError};
use crate::mechanism::exact::{Angle, Number, looks_like_radians, read_angle};
use crate::mechanism::pose::Pose;
use crate::mechanism::read_bodies::of_modified;
use crate::mechanism::read_options::ReadOptions;
use crate::mechanism::table_comments::Directives;
use crate::mechanism::{Body, Limits, MOST_PARTS, Mechanism, Snapped, Space, noted};
use csv::{ReaderBuilder, StringRecord, Trim};

/// Separators of cells, in the order in which they are looked for in the header.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];
/// Units of lengths in headings. A table is in one unit, and so is its answer.
const LENGTH_UNITS: [&str; 3] = ["m", "cm", "mm"];
const COLUMNS: &str =
    "type, theta, d, a, alpha, name, offset, min, max (angles: theta_deg, alpha_rad)";

/// The quantity that a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Type,
    Theta,
    D,
    A,
    Alpha,
    Name,
    Offset,
    Lowest,
    Highest,
}

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Column {
    quantity: Quantity,
    /// Whether angles are in degrees, where the heading says so.
    degrees: Option<bool>,
    /// The unit of lengths, where the heading says one.
    length: Option<&'static str>,
}

impl Column {
    /// From a heading: `alpha`, `Alpha_rad`, `theta [deg]`. `None` for another word.
    fn of_heading(heading: &str) -> Option<Self> {
        let heading = heading.to_lowercase();
        let (word, unit) = match heading.split_once(['_', ' ', '[', '(']) {
            Some((word, unit)) => (word, unit.trim_matches(['[', ']', '(', ')', ' '])),
            None => (heading.as_str(), ""),
        };
        let quantity = match word {
            "type" => Quantity::Type,
            "theta" | "θ" => Quantity::Theta,
            "d" => Quantity::D,
            "a" => Quantity::A,
            "alpha" | "α" => Quantity::Alpha,
            "name" | "joint" => Quantity::Name,
            "offset" => Quantity::Offset,
            "min" | "lower" | "qmin" => Quantity::Lowest,
            "max" | "upper" | "qmax" => Quantity::Highest,
            _ => return None,
        };
        let is_angle = !matches!(
            quantity,
            Quantity::Type | Quantity::Name | Quantity::D | Quantity::A
        );
        let is_length = matches!(quantity, Quantity::D | Quantity::A);
        let length = LENGTH_UNITS
            .into_iter()
            .find(|word| is_length && *word == unit);
        let degrees = match unit {
            "" => None,
            _ if length.is_some() => None,
            "deg" | "degrees" | "°" if is_angle => Some(true),
            "rad" | "radians" if is_angle => Some(false),
            _ => return None,
        };
        Some(Self {
            quantity,
            degrees,
            length,
        })
    }
}

/// The separator of a heading line.
fn separator(line: &str) -> u8 {
    let present = |&separator: &u8| line.as_bytes().contains(&separator);
    SEPARATORS.into_iter().find(present).unwrap_or(b',')
}

/// The first line that is no comment.
fn heading_line(text: &str) -> Option<&str> {
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    lines.find(|line| !line.is_empty() && !line.starts_with('#'))
}

/// Whether a text is such a table: the first line that is no comment heads a column of twists and another one.
pub fn is_table(text: &str) -> bool {
    let Some(header) = heading_line(text) else {
        return false;
    };
    let cells = header.split(char::from(separator(header)));
    let quantities: Vec<Quantity> = cells
        .filter_map(|cell| Column::of_heading(cell.trim().trim_matches('"')))
        .map(|column| column.quantity)
        .collect();
    quantities.contains(&Quantity::Alpha) && quantities.len() > 1
}

/// The motion of a row's joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowKind {
    Turns,
    Shifts,
    Fixed,
}

impl RowKind {
    /// From a cell of the column `type`.
    fn of_word(word: &str) -> Option<Self> {
        match word.to_lowercase().as_str() {
            "r" | "revolute" | "continuous" => Some(Self::Turns),
            "p" | "prismatic" => Some(Self::Shifts),
            "fixed" => Some(Self::Fixed),
            _ => None,
        }
    }
}

/// A row of the table.
struct Row<'t> {
    document: &'t Document<'t>,
    columns: &'t [Column],
    cells: &'t StringRecord,
    /// Number of the row, from 1.
    number: usize,
    /// First byte in the file.
    at: usize,
}

impl Row<'_> {
    fn cell(&self, quantity: Quantity) -> Option<(&str, Column)> {
        let place = self.columns.iter().position(|c| c.quantity == quantity)?;
        Some((self.cells.get(place)?, self.columns[place]))
    }

    fn error(&self, field: &str, message: String) -> MechanismError {
        self.document.error(self.at, field, message)
    }

    /// A length; 0 where there is no such column.
    fn length(&self, quantity: Quantity, field: &str) -> Result<f64, MechanismError> {
        let Some((text, _)) = self.cell(quantity) else {
            return Ok(0.0);
        };
        let text = match quantity {
            Quantity::D => &Cell::read(text, LENGTHS).number,
            _ => text,
        };
        let number = Number::read(text).map(|n| n.to_f64());
        number
            .filter(|x| x.is_finite())
            .ok_or_else(|| self.error(field, format!("expected a length, found \"{text}\"")))
    }

    /// An angle; 0 where there is no such column.
    fn angle(
        &self,
        quantity: Quantity,
        field: &str,
        reading: &mut Reading,
    ) -> Result<Angle, MechanismError> {
        let Some((text, column)) = self.cell(quantity) else {
            return Ok(Angle::ZERO);
        };
        let text = match quantity {
            Quantity::Theta => &Cell::read(text, ANGLES).number,
            _ => text,
        };
        let unit = match column.degrees {
            Some(degrees) => Some(degrees),
            None => reading.directives.degrees.clone()?,
        };
        if unit.is_none() && looks_like_radians(text) {
            let message = format!(
                "{text} is a right angle in radians, and nothing names the unit of angles, which is degrees then: \
                 add the line \"# angles: rad\", or \"# angles: deg\" where degrees are meant"
            );
            return Err(self.error(field, message));
        }
        let read = read_angle(text, unit.unwrap_or(true), reading.snap);
        let read =
            read.ok_or_else(|| self.error(field, format!("expected an angle, found \"{text}\"")))?;
        let place = format!("row {} {field}", self.number);
        Ok(noted(read, &place, &mut reading.snapped))
    }

    /// The name of a variable in `theta` or `d`.
    fn variable(&self, quantity: Quantity, names: &[&str]) -> Option<Variable> {
        let (text, _) = self.cell(quantity)?;
        Cell::read(text, names).variable
    }

    /// The kind of the joint, by the column `type`, or else by the cell that names a variable, and that variable.
    fn kind(&self) -> Result<(RowKind, Option<NamedVariable>), MechanismError> {
        let kind = match self.cell(Quantity::Type) {
            None => None,
            Some((word, _)) => Some(RowKind::of_word(word).ok_or_else(|| {
                let message = format!("expected R, P or fixed, found \"{word}\"");
                self.error("type", message)
            })?),
        };
        let named = |field: &'static str, variable: Variable| NamedVariable {
            variable,
            field,
            at: self.at,
        };
        let theta = self.variable(Quantity::Theta, ANGLES);
        let d = self.variable(Quantity::D, LENGTHS);
        let theta = theta.map(|variable| named("theta", variable));
        let d = d.map(|variable| named("d", variable));
        let has_theta = self.cell(Quantity::Theta).is_some();
        match (kind, theta, d) {
            (None | Some(RowKind::Turns), theta, None) => Ok((RowKind::Turns, theta)),
            (Some(RowKind::Shifts), None, d) => Ok((RowKind::Shifts, d)),
            (None, None, d) if has_theta => Ok((RowKind::Shifts, d)),
            (Some(RowKind::Fixed), None, None) => Ok((RowKind::Fixed, None)),
            (Some(RowKind::Turns), _, Some(cell)) => {
                Err(self.no_value(&cell, "turns", "P as its type where it shifts"))
            }
            (None, _, Some(cell)) => {
                Err(self.no_value(&cell, "turns", "add a column type with P where it shifts"))
            }
            (Some(RowKind::Shifts), Some(cell), _) => {
                Err(self.no_value(&cell, "shifts", "R as its type where it turns"))
            }
            (Some(RowKind::Fixed), theta, d) => {
                let cell = theta.or(d).expect("one of the cells names a variable");
                Err(self.no_value(&cell, "is fixed", "R or P as its type where it moves"))
            }
        }
    }

    /// The refusal of a name that stands where a number is needed.
    fn no_value(&self, cell: &NamedVariable, motion: &str, other: &str) -> MechanismError {
        let name = &cell.variable.name;
        let message = format!(
            "{name} has no value in a row that {motion}: write a number in place of {name}, or {other}"
        );
        self.error(cell.field, message)
    }

    /// The joint, its kind and its variable.
    fn joint(&self, reading: &mut Reading) -> Result<JointRow, MechanismError> {
        let (kind, named) = self.kind()?;
        let default_name = || match (kind, &named) {
            (RowKind::Fixed, _) => format!("row{}", self.number),
            (_, Some(cell)) => {
                let joint = cell.variable.joint();
                joint.unwrap_or_else(|| format!("q{}", self.number))
            }
            (_, None) => format!("q{}", self.number),
        };
        let name = self.cell(Quantity::Name);
        let is_angle = kind != RowKind::Shifts;
        let mut joint = ChainJoint {
            name: name.map_or_else(default_name, |(name, _)| name.to_owned()),
            is_angle,
            a: self.length(Quantity::A, "a")?,
            alpha: self.angle(Quantity::Alpha, "alpha", reading)?,
            d: self.length(Quantity::D, "d")?,
            theta: self.angle(Quantity::Theta, "theta", reading)?,
        };
        if is_angle {
            let offset = self.angle(Quantity::Offset, "offset", reading)?;
            joint.theta = joint.theta.plus(&offset);
        } else {
            joint.d += self.length(Quantity::Offset, "offset")?;
        }
        Ok(JointRow { joint, kind, named })
    }

    /// The limits of the joint of this row: radians or lengths; `None` where the cells are empty or there are none.
    fn limits(
        &self,
        joint: &ChainJoint,
        reading: &mut Reading,
    ) -> Result<Option<Limits>, MechanismError> {
        let is_empty = |quantity| self.cell(quantity).is_none_or(|(text, _)| text.is_empty());
        match [Quantity::Lowest, Quantity::Highest].map(is_empty) {
            [true, true] => return Ok(None),
            [false, false] => {}
            _ => return Err(self.error("min", "expected a min and a max, or neither".to_owned())),
        }
        let mut value = |quantity, field| match joint.is_angle {
            true => Ok(self.angle(quantity, field, reading)?.radians),
            false => self.length(quantity, field),
        };
        let range = [
            value(Quantity::Lowest, "min")?,
            value(Quantity::Highest, "max")?,
        ];
        if range[0] > range[1] {
            let message = "limits are reversed: min is above max".to_owned();
            return Err(self.error("min", message));
        }
        Ok(Some(Limits {
            joint: joint.name.clone(),
            range,
        }))
    }
}

/// The column of a table's row that names the variable of the joint.
struct NamedVariable {
    variable: Variable,
    /// Heading of the column.
    field: &'static str,
    /// First byte of the row.
    at: usize,
}

/// A row that was read.
struct JointRow {
    joint: ChainJoint,
    kind: RowKind,
    /// The variable, if the row names it.
    named: Option<NamedVariable>,
}

/// Directives of a table, and the right angles that were taken for rounded ones.
struct Reading {
    directives: Directives,
    snap: bool,
    snapped: Vec<Snapped>,
}

/// The columns of the headings, each at most once.
fn columns(
    document: &Document<'_>,
    at: usize,
    headings: &StringRecord,
) -> Result<Vec<Column>, MechanismError> {
    let mut columns: Vec<Column> = Vec::new();
    let blank = headings
        .iter()
        .rev()
        .take_while(|heading| heading.is_empty())
        .count();
    for heading in headings.iter().take(headings.len() - blank) {
        let column = Column::of_heading(heading);
        let column = column.filter(|c| columns.iter().all(|other| other.quantity != c.quantity));
        columns.push(column.ok_or_else(|| {
            let message = format!("column \"{heading}\": expected each of {COLUMNS} at most once");
            document.error(at, "", message)
        })?);
    }
    let lengths = columns
        .iter()
        .filter(|c| matches!(c.quantity, Quantity::D | Quantity::A));
    let mut units = lengths.map(|column| column.length);
    let first = units.next().flatten();
    if units.any(|unit| unit != first) {
        let message = "expected one unit of lengths, or none, in the headings of d and a";
        return Err(document.error(at, "", message));
    }
    Ok(columns)
}

/// Checks the variables of a table against each other: numbers rise from row to row, no row has the name of another row's
/// variable, and a table without types names a variable in each row if a name in `d` makes a row shift.
fn check_variables(
    document: &Document<'_>,
    columns: &[Column],
    rows: &[JointRow],
) -> Result<(), MechanismError> {
    let error =
        |cell: &NamedVariable, message: String| document.error(cell.at, cell.field, message);
    let name = |cell: &NamedVariable| cell.variable.name.clone();
    let mut above: Vec<&NamedVariable> = Vec::new();
    for row in rows {
        let Some(cell) = &row.named else { continue };
        let is_out_of_order = |other: &&&NamedVariable| {
            let (index, other_index) = (cell.variable.index, other.variable.index);
            name(cell) == name(other) || index.zip(other_index).is_some_and(|(i, j)| i <= j)
        };
        if let Some(other) = above.iter().find(is_out_of_order) {
            let (name, other) = (name(cell), name(other));
            let message = format!(
                "{name} stands below {other}, and a row is one joint, in the order of the joints: \
                 write names whose numbers rise from row to row, or numbers and a column name"
            );
            return Err(error(cell, message));
        }
        let has_its_name = |other: &&JointRow| {
            !std::ptr::eq(*other, row) && other.joint.name.eq_ignore_ascii_case(&cell.variable.name)
        };
        if let Some(other) = rows.iter().find(has_its_name) {
            let message = format!(
                "{} is the variable of the joint \"{}\", and another joint has the name \"{}\": \
                 write one name for one joint, or a number in place of {}",
                name(cell),
                row.joint.name,
                other.joint.name,
                name(cell)
            );
            return Err(error(cell, message));
        }
        above.push(cell);
    }
    let has_types = columns.iter().any(|c| c.quantity == Quantity::Type);
    let shift = above.iter().find(|cell| cell.field == "d");
    if let Some(cell) = shift.filter(|_| !has_types && above.len() < rows.len()) {
        let name = name(cell);
        let message = format!(
            "{name} may be the variable of a joint that shifts or a length without a value, because other rows name \
             no variable: add a column type with P, or write a number in place of {name}"
        );
        return Err(error(cell, message));
    }
    Ok(())
}

/// Reads a table. Rows of type `fixed` move nothing; their transformations are multiplied into the chain.
///
/// # Errors
/// Names the line and the column of a cell that does not fit the column.
pub fn read(document: &Document<'_>, options: &ReadOptions) -> Result<Mechanism, MechanismError> {
    let text = document.text.trim_start_matches('\u{feff}');
    let mark = document.text.len() - text.len();
    let mut reader = ReaderBuilder::new()
        .delimiter(separator(heading_line(text).unwrap_or_default()))
        .comment(Some(b'#'))
        .trim(Trim::All)
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut reading = Reading {
        directives: Directives::of(document)?,
        snap: !options.no_snap,
        snapped: Vec::new(),
    };
    let mut headings: Option<Vec<Column>> = None;
    let mut rows: Vec<JointRow> = Vec::new();
    let mut limits: Vec<Limits> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| document.error(0, "", e.to_string()))?;
        let at = mark + record.position().map_or(0, |p| p.byte() as usize);
        let Some(columns_of_table) = &headings else {
            headings = Some(columns(document, at, &record)?);
            continue;
        };
        // A line of nothing but separators, as spreadsheets write it.
        if record.iter().all(str::is_empty) {
            continue;
        }
        let has_more = record
            .iter()
            .skip(columns_of_table.len())
            .any(|cell| !cell.is_empty());
        if record.len() < columns_of_table.len() || has_more || rows.len() >= MOST_PARTS {
            let message = format!(
                "expected {} values in one of at most {MOST_PARTS} rows, found {}",
                columns_of_table.len(),
                record.len()
            );
            return Err(document.error(at, "", message));
        }
        let row = Row {
            document,
            columns: columns_of_table,
            cells: &record,
            number: rows.len() + 1,
            at,
        };
        let read = row.joint(&mut reading)?;
        if rows.iter().any(|other| other.joint.name == read.joint.name) {
            let message = format!("the name \"{}\" stands for two joints", read.joint.name);
            return Err(row.error("name", message));
        }
        if read.kind != RowKind::Fixed {
            limits.extend(row.limits(&read.joint, &mut reading)?);
        }
        rows.push(read);
    }
    let is_moving = |row: &JointRow| row.kind != RowKind::Fixed;
    if !rows.iter().any(is_moving) {
        let message = "expected at least one row of a joint that moves";
        return Err(document.error(document.text.len(), "", message));
    }
    let columns_of_table = headings.unwrap_or_default();
    check_variables(document, &columns_of_table, &rows)?;
    let held: Vec<Option<f64>> = rows
        .iter()
        .map(|row| (!is_moving(row)).then_some(0.0))
        .collect();
    let joints = rows.into_iter().map(|row| row.joint).collect();
    let mut chain = Chain {
        joints,
        base: Pose::IDENTITY,
        tool: Pose::IDENTITY,
        closed: false,
        first_normal: None,
    };
    if reading.directives.modified {
        of_modified(&mut chain);
    }
    if held.iter().any(Option::is_some) {
        chain = chain
            .with_held(&held)
            .ok_or_else(|| document.error(0, "", "the rows make no chain of joints"))?;
    }
    let degrees = reading.directives.degrees.unwrap_or_default();
    let columns_in_radians = columns_of_table.iter().any(|c| c.degrees == Some(false));
    Ok(Mechanism {
        file: document.file.to_owned(),
        name: document.file.to_owned(),
        space: Space::Spatial,
        degrees: degrees.unwrap_or(!columns_in_radians),
        body: Body::Chain(Box::new(chain)),
        inputs: Vec::new(),
        output: None,
        limits,
        snapped: reading.snapped,
        warnings: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism;
    use crate::mechanism::chain::JointValue;

    fn table(text: &str) -> Result<Mechanism, String> {
        let read = mechanism::read("arm.csv", text.as_bytes(), &ReadOptions::default());
        read.map_err(|e| e.to_string())
    }

    fn chain(text: &str) -> Chain {
        match table(text).map(|m| m.body) {
            Ok(Body::Chain(chain)) => *chain,
            other => panic!("{other:?}"),
        }
    }

    const DEGREES: &str =
        "type,theta,d,a,alpha,name\nR,10,0.4,0.1,90,one\nR,0,0,0.5,-90,two\nP,30,0.2,0,0,three\n";

    #[test]
    fn units_and_separators_are_told_apart() {
        let expected = chain(DEGREES);
        for text in [
            "Type;Theta;d;a;Alpha;Name\nr;10;0.4;0.1;90;one\nR;0;0;0.5;-90;two\nprismatic;30;0.2;0;0;three\n",
            "# a comment\n# angles: deg\nname\ttype\talpha\ta\td\ttheta\none\tR\t90\t0.1\t0.4\t10\n\
             two\tR\t-90\t0.5\t0\t0\nthree\tP\t0\t0\t0.2\t30\n",
            "type,theta_deg,d,a,alpha_rad,name\nR,10,0.4,0.1,1.5708,one\nR,0,0,0.5,-1.5708,\"two\"\nP,30,0.2,0,0,three\n",
            "\u{feff}type,theta [deg],d,a,alpha (rad),name\r\nR,10,0.4,0.1,pi/2,one\r\nR,0,0,0.5,-pi/2,two\r\n,,,,,\r\nP,30,0.2,0,0,three\r\n",
        ] {
            assert_eq!(chain(text), expected, "{text}");
        }
    }

    #[test]
    fn right_angles_in_radians_without_a_unit_are_refused() {
        for twist in ["1.5707963", "-1.57", "3.14159", "-3.1416", "6.2832"] {
            let text = format!("theta,d,a,alpha\n0,0.1,0,{twist}\n");
            let error = table(&text).unwrap_err();
            assert!(error.contains("arm.csv:2: alpha"), "{error}");
            assert!(error.contains("\"# angles: rad\""), "{error}");
            assert!(table(&format!("# angles: deg\n{text}")).is_ok());
            let radians = table(&format!("# angles: rad\n{text}")).unwrap();
            assert!(!radians.degrees);
        }
        assert!(table("theta,d,a,alpha\n0,0.1,0,1.6\n").is_ok());
    }

    #[test]
    fn variables_offsets_and_limits_are_read() {
        let expected = chain(
            "type,theta,d,a,alpha\nR,0,0.4,0.1,90\nR,-90,0,0.5,-90\nP,30,0.2,0,0\nR,90,0,0,0\n",
        );
        for text in [
            "type,theta,d,a,alpha\nR,q1,0.4,0.1,90\nR,q2 - 90,0,0.5,-90\nP,30,d3+0.2,0,0\nR,90 + theta_4,0,0,0\n",
            "type,theta,d,a,alpha\nR,θ1,0.4,0.1,90\nR,θ2-pi/2,0,0.5,-90\nP,30,0.2 + q3,0,0\nR,pi/2+q4,0,0,0\n",
            "type,theta,d,a,alpha,offset\nR,0,0.4,0.1,90,0\nR,0,0,0.5,-90,-90\nP,30,0,0,0,0.2\nR,45,0,0,0,45\n",
        ] {
            assert_eq!(chain(text), expected, "{text}");
        }
        let limited =
            "theta,d,a,alpha,min,max\n0,0.4,0.1,90,-170,170\n0,0,0.5,-90,,\n0,0,0,0,-2*pi,2*pi\n";
        let arm = table(limited).unwrap();
        let degrees = |joint: &str| arm.limits_of(joint).map(|range| range.map(f64::to_degrees));
        assert_eq!(
            degrees("q1").map(|range| range.map(f64::round)),
            Some([-170.0, 170.0])
        );
        assert_eq!(degrees("q2"), None);
        assert_eq!(
            degrees("q3").map(|range| range.map(f64::round)),
            Some([-360.0, 360.0])
        );
        let written = mechanism::write::dh_csv(&arm).unwrap();
        assert_eq!(table(&written).unwrap().limits, arm.limits, "{written}");
        for (row, part) in [
            ("0,0,0,0,10,-10", "min is above max"),
            ("0,0,0,0,10,", "expected a min and a max"),
            ("q,0,0,0,1,2", "expected an angle"),
            ("q1-x,0,0,0,1,2", "expected an angle"),
        ] {
            let error = table(&format!("theta,d,a,alpha,min,max\n{row}\n")).unwrap_err();
            assert!(
                error.contains("arm.csv:2") && error.contains(part),
                "{error}"
            );
        }
    }

    #[test]
    fn typeset_cells_and_blank_cells_at_the_end_are_read() {
        let expected = chain("theta,d,a,alpha\nq1,0,0.1,-90\nq2 - 90,0,0.2,90\n");
        for text in [
            "theta,d,a,alpha\nq1,0,0.1,−90\nq2 − 90,0,0.2,π/2\n",
            "theta,d,a,alpha,,\nq1,0,0.1,−π/2,,\nq2 - π/2,0,0.2,90\n",
            "theta [deg],d (m),a [m],alpha (°)\nq1,0,0.1,-90\nq2 - 90,0,0.2,90\n",
        ] {
            assert_eq!(chain(text), expected, "{text}");
        }
        let error = table("theta,d,a,alpha\nq1,0,0.1,90,,7\n").unwrap_err();
        assert!(error.contains("expected 4 values"), "{error}");
        for headings in ["theta,d (mm),a (m),alpha", "theta,d (mm),a,alpha"] {
            let error = table(&format!("{headings}\nq1,0,0.1,90\n")).unwrap_err();
            assert!(
                error.contains("arm.csv:1: expected one unit of lengths"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_name_in_d_is_a_shift_where_no_type_says_otherwise() {
        let typed =
            "type,theta,d,a,alpha\nR,0,0.412,0,-90\nR,0,0.154,0,90\nP,-90,0,0,0\nR,0,0.1,0,0\n";
        let expected = chain(typed);
        for text in [
            "theta,d,a,alpha\ntheta1,0.412,0,-90\ntheta2,0.154,0,90\n-90,d3,0,0\ntheta4,0.1,0,0\n",
            "alpha,a,theta,d\n-90,0,θ1,0.412\n90,0,θ2,0.154\n0,0,-90,q3\n0,0,θ4,0.1\n",
            "type,theta,d,a,alpha\nR,θ₁,0.412,0,-90\nR,θ₂,0.154,0,90\nP,-90,d₃,0,0\nR,θ₄,0.1,0,0\n",
        ] {
            assert_eq!(chain(text), expected, "{text}");
        }
    }

    #[test]
    fn names_without_a_value_are_refused() {
        for (text, wanted) in [
            (
                "theta,d,a,alpha\nq1,0.1,0,90\nq2,d2,0,0\n",
                "arm.csv:3: d: d2 has no value in a row that turns: write a number in place of d2, or add a column type",
            ),
            (
                "type,theta,d,a,alpha\nR,q1,d1,0,90\n",
                "arm.csv:2: d: d1 has no value in a row that turns",
            ),
            (
                "type,theta,d,a,alpha\nP,theta1,0,0,90\n",
                "arm.csv:2: theta: theta1 has no value in a row that shifts",
            ),
            (
                "type,theta,d,a,alpha\nR,0,0,0,90\nfixed,0,d2,0,0\n",
                "arm.csv:3: d: d2 has no value in a row that is fixed",
            ),
            ("d,a,alpha\nd1,0,90\n", "arm.csv:2: d: d1 has no value"),
            (
                "theta,d,a,alpha\n0,d1,0.2,0\n0,0,0.3,90\n",
                "arm.csv:2: d: d1 may be the variable of a joint that shifts or a length",
            ),
            (
                "theta,d,a,alpha\nd1,0,0.2,0\n",
                "arm.csv:2: theta: expected an angle, found \"d1\"",
            ),
            (
                "theta,d,a,alpha\n0,theta1,0.2,0\n",
                "arm.csv:2: d: expected a length, found \"theta1\"",
            ),
        ] {
            let error = table(text).unwrap_err();
            assert!(error.starts_with(wanted), "{error}\n instead of\n{wanted}");
        }
    }

    #[test]
    fn names_that_contradict_the_rows_are_refused() {
        let arm = |names: [&str; 3]| {
            let [a, b, c] = names;
            table(&format!(
                "theta,d,a,alpha\n{a},0.1,0,90\n{b},0,0.4,0\n{c},0,0.3,0\n"
            ))
        };
        for names in [
            ["q2", "q1", "q3"],
            ["q1", "q1", "q2"],
            ["q1", "theta1", "q3"],
            ["θ1", "θ3", "θ2"],
            ["q2", "0", "q3"],
        ] {
            assert!(arm(names).is_err(), "{names:?}");
        }
        let error = arm(["q2", "q1", "q3"]).unwrap_err();
        assert!(
            error.starts_with("arm.csv:3: theta: q1 stands below q2"),
            "{error}"
        );
        let error = table("name,theta,d,a,alpha\nq2,q1,0,1,0\nq1,q2,0,1,0\n").unwrap_err();
        assert!(
            error.starts_with("arm.csv:2: theta: q1 is the variable of the joint \"q2\""),
            "{error}"
        );
        let joints = |names: [&str; 3]| match arm(names).map(|m| m.body) {
            Ok(Body::Chain(chain)) => chain.joints.iter().map(|j| j.name.clone()).collect(),
            _ => Vec::new(),
        };
        assert_eq!(joints(["theta1", "theta2", "theta3"]), ["q1", "q2", "q3"]);
        assert_eq!(joints(["q0", "q1 - 90", "q_2"]), ["q0", "q1", "q2"]);
        let fixed = chain("type,theta,d,a,alpha\nR,q1,0,1,0\nfixed,0,0,1,90\nR,q2,0,1,0\n");
        assert_eq!(fixed.joints[1].name, "q2");
    }

    /// A table in the convention of Craig describes the same arm as a table in the standard convention.
    #[test]
    fn modified_rows_are_read() {
        let modified = "# convention: modified\ntheta,d,a,alpha,type\n0,0.4,0,0,R\n0,0,0.1,90,R\n0,0,0.5,-90,R\n";
        let standard = "theta,d,a,alpha,type\n0,0.4,0.1,90,R\n0,0,0.5,-90,R\n0,0,0,0,R\n";
        let values = [0.3, -0.7, 1.1].map(|x| JointValue::of_real(x, true));
        let pose = |text: &str| chain(text).tool_pose(&values);
        assert_eq!(pose(modified), pose(standard));
        let error = table("# convention: paul\ntheta,d,a,alpha\n0,0,0,0\n").unwrap_err();
        assert!(
            error.contains("arm.csv:1: convention: expected standard or modified"),
            "{error}"
        );
    }

    #[test]
    fn fixed_rows_are_multiplied_out() {
        let fixed = "type,theta,d,a,alpha\nfixed,20,0.3,0.1,90\nR,0,0.4,0.1,90\nfixed,30,0,0.2,-40\nR,0,0,0.5,-90\nfixed,0,0.1,0,0\n";
        let moving = fixed.replace("fixed", "R");
        let [a, b] = [0.3, -0.7].map(|x| JointValue::of_real(x, true));
        let zero = JointValue::of_real(0.0, true);
        let all_rows = chain(&moving);
        let expected = all_rows.tool_pose(&[zero, a, zero, b, zero]);
        let arm = chain(fixed);
        assert_eq!(arm.joints.len(), 2);
        let pose = arm.tool_pose(&[a, b]);
        for (x, y) in pose
            .rotation
            .iter()
            .flatten()
            .zip(expected.rotation.iter().flatten())
        {
            assert!((x - y).norm_sqr() < 1e-28, "{pose:?} {expected:?}");
        }
        for (x, y) in pose.position.iter().zip(&expected.position) {
            assert!((x - y).norm_sqr() < 1e-28, "{pose:?} {expected:?}");
        }
        assert!(table("type,theta,d,a,alpha\nfixed,0,0,0,0\n").is_err());
    }
}

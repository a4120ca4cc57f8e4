//! Tables of Denavit and Hartenberg: a row for each joint, with columns `theta`, `d`, `a`, `alpha` and, if wanted, `type`,
//! `name`, `offset` (added to the joint's value, as `theta` is), `min` and `max`.
//!
//! The cell of the variable may hold a name, as books print it: `q2`, `theta2 - 90`, `q2 + pi/2`.
//!
//! Cells are separated by commas, semicolons or tabs. A line that begins with `#` is a comment; two comments are read:
//! `# angles: rad` (or `deg`) and `# convention: modified` (or `standard`). An angle is in the unit that its cell (`pi/2`,
//! `1.2 rad`), its column (`alpha_rad`) or the table names, else in degrees. A number that is a right angle in radians is
//! refused where nothing names a unit.

use crate::mechanism::chain::{Chain, ChainJoint};
use crate::mechanism::document::{Document, MechanismError};
use crate::mechanism::exact::{Angle, Number, looks_like_radians, read_angle};
use crate::mechanism::pose::Pose;
use crate::mechanism::read_bodies::of_modified;
use crate::mechanism::read_options::ReadOptions;
use crate::mechanism::{Body, Limits, MOST_PARTS, Mechanism, Snapped, Space, noted};
use csv::{ReaderBuilder, StringRecord, Trim};

/// Separators of cells, in the order in which they are looked for in the header.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];
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

/// A column, and whether its angles are in degrees where its heading says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Column {
    quantity: Quantity,
    degrees: Option<bool>,
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
        let degrees = match unit {
            "" => None,
            "deg" | "degrees" if is_angle => Some(true),
            "rad" | "radians" if is_angle => Some(false),
            _ => return None,
        };
        Some(Self { quantity, degrees })
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

/// Settings that the comments of a table give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Directives {
    /// Whether angles are in degrees; `None` where no comment says so.
    degrees: Option<bool>,
    /// Rows are Rx(alpha) Tx(a) Rz(theta) Tz(d) (J. J. Craig, Introduction to Robotics, 1986), else Rz(theta) Tz(d) Tx(a)
    /// Rx(alpha) (J. Denavit and R. S. Hartenberg, 1955).
    modified: bool,
}

impl Directives {
    fn of(document: &Document<'_>) -> Result<Self, MechanismError> {
        let mut directives = Self::default();
        let mut at = 0;
        for line in document.text.split_inclusive('\n') {
            let place = at;
            at += line.len();
            let Some(comment) = line.trim_start_matches('\u{feff}').trim().strip_prefix('#') else {
                continue;
            };
            let Some((name, value)) = comment.split_once([':', '=']) else {
                continue;
            };
            let value = value.trim().trim_matches('"').to_lowercase();
            let wrong = |field: &str, expected: &str| {
                let message = format!("expected {expected}, found \"{value}\"");
                Err(document.error(place, field, message))
            };
            match name.trim().to_lowercase().as_str() {
                "angles" => match value.as_str() {
                    "deg" | "degrees" => directives.degrees = Some(true),
                    "rad" | "radians" => directives.degrees = Some(false),
                    _ => return wrong("angles", "deg or rad"),
                },
                "convention" => match value.as_str() {
                    "standard" => directives.modified = false,
                    "modified" | "craig" => directives.modified = true,
                    _ => return wrong("convention", "standard or modified"),
                },
                _ => {}
            }
        }
        Ok(directives)
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
            Quantity::D => &without_variable(text),
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
            Quantity::Theta => &without_variable(text),
            _ => text,
        };
        let unit = column.degrees.or(reading.directives.degrees);
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

    /// The joint, and whether it is held at 0.
    fn joint(&self, reading: &mut Reading) -> Result<(ChainJoint, bool), MechanismError> {
        let kind = self.cell(Quantity::Type).map_or("R", |(text, _)| text);
        let (is_angle, is_fixed) = match kind.to_lowercase().as_str() {
            "r" | "revolute" | "continuous" => (true, false),
            "p" | "prismatic" => (false, false),
            "fixed" => (true, true),
            _ => {
                let message = format!("expected R, P or fixed, found \"{kind}\"");
                return Err(self.error("type", message));
            }
        };
        let name = self.cell(Quantity::Name);
        let mut joint = ChainJoint {
            name: name.map_or_else(|| format!("q{}", self.number), |(name, _)| name.to_owned()),
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
        Ok((joint, is_fixed))
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

/// The number of a cell that may name the variable of its joint: `q2` is 0, `q2 - 90` and `-90 + q2` are -90.
fn without_variable(text: &str) -> String {
    let is_variable = |word: &str| {
        let letters: &str = word.trim_end_matches(|c: char| c.is_numeric() || c == '_');
        let is_name = matches!(
            letters.trim_end_matches('_').to_lowercase().as_str(),
            "q" | "d" | "t" | "th" | "theta" | "θ" | "phi" | "φ" | "j" | "joint"
        );
        is_name && letters.len() < word.len()
    };
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let start = text.find(|c| !is_part(c)).unwrap_or(text.len());
    if is_variable(&text[..start]) {
        let rest: String = text[start..].split_whitespace().collect();
        return match rest.strip_prefix('+') {
            _ if rest.is_empty() => "0".to_owned(),
            Some(number) => number.to_owned(),
            None => rest,
        };
    }
    let end = text.rfind(|c| !is_part(c)).map_or(0, |place| {
        place + text[place..].chars().next().map_or(0, char::len_utf8)
    });
    let before = text[..end].trim_end();
    match before.strip_suffix('+') {
        Some(number) if is_variable(&text[end..]) => number.trim_end().to_owned(),
        _ => text.to_owned(),
    }
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
    for heading in headings {
        let column = Column::of_heading(heading);
        let column = column.filter(|c| columns.iter().all(|other| other.quantity != c.quantity));
        columns.push(column.ok_or_else(|| {
            let message = format!("column \"{heading}\": expected each of {COLUMNS} at most once");
            document.error(at, "", message)
        })?);
    }
    Ok(columns)
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
    let mut joints: Vec<ChainJoint> = Vec::new();
    let mut held: Vec<Option<f64>> = Vec::new();
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
        if record.len() != columns_of_table.len() || joints.len() >= MOST_PARTS {
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
            number: joints.len() + 1,
            at,
        };
        let (joint, is_fixed) = row.joint(&mut reading)?;
        if joints.iter().any(|other| other.name == joint.name) {
            let message = format!("the name \"{}\" stands for two joints", joint.name);
            return Err(row.error("name", message));
        }
        if !is_fixed {
            limits.extend(row.limits(&joint, &mut reading)?);
        }
        joints.push(joint);
        held.push(is_fixed.then_some(0.0));
    }
    if held.iter().all(Option::is_some) {
        let message = "expected at least one row of a joint that moves";
        return Err(document.error(document.text.len(), "", message));
    }
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
    let columns_in_radians = headings.iter().flatten().any(|c| c.degrees == Some(false));
    Ok(Mechanism {
        file: document.file.to_owned(),
        name: document.file.to_owned(),
        space: Space::Spatial,
        degrees: reading.directives.degrees.unwrap_or(!columns_in_radians),
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

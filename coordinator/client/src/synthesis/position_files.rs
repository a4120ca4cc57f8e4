//! Positions: poses of a body, points with angles of a crank, pairs of angles, poses and points mixed;
//! as CSV or as JSON, checked line by line. Angles are in degrees, or in the unit that the file names: `# angles: rad` in a
//! comment of a table, `"angles": "rad"` beside the list in JSON, and `"unit"` where the list itself has the name `angles`.

use super::arguments::SpatialChain;
use super::designs::Sister;
use super::point_files::{
    Placed, complex, decoded, is_json, kind, only_fields, parsed, rows, rows_with_blanks,
};
use cognate_kinematics::body_guidance::{PoseFault, Poses};
use cognate_kinematics::function_generation::{AngleFault, AnglePairs};
use cognate_kinematics::mechanism::document::Document;
use cognate_kinematics::mechanism::exact::Angle;
use cognate_kinematics::mechanism::pose::{Pose, ReadPose};
use cognate_kinematics::mechanism::targets::{self, PoseForm};
use cognate_kinematics::mechanism::{Space, table_comments};
use cognate_kinematics::path_timing::TimedPoints;
use cognate_kinematics::plane::direction;
use cognate_kinematics::poses_and_points::{MixtureFault, PosesAndPoints};
use cognate_kinematics::spatial_dyads::{Chain, SpatialPoseFault, SpatialPoses};
use cognate_kinematics::timed_poses::TimedPoses;
use num_complex::Complex64;
use serde_json::Value;

/// Reads five poses of a body: CSV with a header `x,y,angle`, or JSON `{"poses": [[x, y, angle], ...]}`. Angles turn
/// counterclockwise; in JSON they may also be `[cos, sin]`.
pub fn read_poses(name: &str, content: &[u8]) -> Result<Sister, String> {
    let (at, places, turns) = directed(name, content, "poses")?;
    let poses = Poses::new(places, turns).map_err(|fault| match fault {
        PoseFault::NotFinite(k) => format!("{name}: {}: {fault}", at[k]),
        PoseFault::Same(j, k) => format!("{name}: {} and {}: {fault}", at[j], at[k]),
        PoseFault::Trivial(_) | PoseFault::Extent(_) => format!("{name}: {fault}"),
    })?;
    Ok(Sister::Poses(poses))
}

/// Reads five points of a path with the crank's angles: CSV with a header `x,y,angle`, or JSON
/// `{"points": [[x, y, angle], ...]}`, angles as in poses.
pub fn read_timed_points(name: &str, content: &[u8]) -> Result<Sister, String> {
    let (at, places, turns) = directed(name, content, "points")?;
    let points = TimedPoints::new(places, turns).map_err(|fault| match fault {
        PoseFault::NotFinite(k) => format!("{name}: {}: expected finite numbers", at[k]),
        PoseFault::Same(j, k) => format!(
            "{name}: {} and {}: the same point at the same angle; expected five different ones",
            at[j], at[k]
        ),
        PoseFault::Trivial("turn") => format!("{name}: the crank does not turn"),
        PoseFault::Trivial(_) => format!("{name}: the points are one"),
        PoseFault::Extent(_) => format!("{name}: {fault}"),
    })?;
    Ok(Sister::TimedPoints(points))
}

/// Reads five pairs of angles: CSV with a header `input,output`, or JSON `{"angles": [[input,
/// output], ...]}`, angles as in poses.
pub fn read_angles(name: &str, content: &[u8]) -> Result<Sister, String> {
    let text = decoded(name, content)?;
    let pairs: Vec<Placed<[Complex64; 2]>> = if is_json(text) {
        listed(name, text, "angles", "[input, output]", |pair, unit| {
            let [input, output] = pair.as_array()?.as_slice() else {
                return None;
            };
            Some([unit.angle(input)?, unit.angle(output)?])
        })?
    } else {
        let unit = Unit::of_table(name, text)?;
        let rows = rows(name, text, ["input", "output"])?.into_iter();
        let directions = |row: [f64; 2]| row.map(|angle| unit.direction(angle));
        rows.map(|(row, at)| (directions(row), at)).collect()
    };
    let pairs = five(name, pairs, "pairs of angles")?;
    let at = |k: usize| &pairs[k].1;
    let angle_pairs =
        AnglePairs::new(std::array::from_fn(|k| pairs[k].0)).map_err(|fault| match fault {
            AngleFault::NotFinite(k) => format!("{name}: {}: {fault}", at(k)),
            AngleFault::Same(j, k) => format!("{name}: {} and {}: {fault}", at(j), at(k)),
            AngleFault::Trivial(_) => format!("{name}: {fault}"),
        })?;
    Ok(Sister::AnglePairs(angle_pairs))
}

/// Reads poses and points mixed: CSV with a header `x,y,angle`, the angle left empty at points, or JSON
/// `{"positions": [[x, y, angle], [x, y], ...]}`, angles as in poses.
pub fn read_poses_and_points(name: &str, content: &[u8]) -> Result<Sister, String> {
    let text = decoded(name, content)?;
    let placed_positions: Vec<Placed<(Complex64, Option<Complex64>)>> = if is_json(text) {
        let expected = "[x, y] or [x, y, angle] or [x, y, [cos, sin]]";
        listed(name, text, "positions", expected, |item, unit| {
            let (x, y, turn) = match item.as_array()?.as_slice() {
                [x, y] => (x, y, None),
                [x, y, turn] => (x, y, Some(unit.angle(turn)?)),
                _ => return None,
            };
            Some((Complex64::new(x.as_f64()?, y.as_f64()?), turn))
        })?
    } else {
        let unit = Unit::of_table(name, text)?;
        let rows = rows_with_blanks(name, text, ["x", "y", "angle"], &["angle"])?.into_iter();
        let read = |[x, y, angle]: [Option<f64>; 3]| {
            let place = Complex64::new(x.unwrap_or(f64::NAN), y.unwrap_or(f64::NAN));
            (place, angle.map(|angle| unit.direction(angle)))
        };
        rows.map(|(row, at)| (read(row), at)).collect()
    };
    let at = |k: usize| &placed_positions[k].1;
    let positions: Vec<_> = placed_positions
        .iter()
        .map(|(position, _)| *position)
        .collect();
    let given = PosesAndPoints::new(&positions).map_err(|fault| match fault {
        MixtureFault::NotFinite(k) => format!("{name}: {}: {fault}", at(k)),
        MixtureFault::Same(j, k) => format!("{name}: {} and {}: {fault}", at(j), at(k)),
        MixtureFault::Count { .. } | MixtureFault::Extent(_) => format!("{name}: {fault}"),
    })?;
    Ok(Sister::PosesAndPoints(given))
}

/// Reads poses of a body in space, as `mechanism inverse` reads them.
pub fn read_spatial_poses(
    name: &str,
    content: &[u8],
    chain: SpatialChain,
) -> Result<SpatialPoses, String> {
    let chain = match chain {
        SpatialChain::BallBall => Chain::BallBall,
        SpatialChain::PlaneBall => Chain::PlaneBall,
        SpatialChain::Cylinders => Chain::Cylinders,
        SpatialChain::CylinderBall => Chain::CylinderBall,
        SpatialChain::HingeSliderBall => Chain::HingeSliderBall,
        SpatialChain::SphericalHinges => Chain::SphericalHinges,
    };
    let form = PoseForm::whole(Space::Spatial, true);
    let poses = targets::poses(name, content, form).map_err(|error| error.to_string())?;
    if let Some(warning) = ReadPose::warning(&poses) {
        eprintln!("warning: {warning}");
    }
    let poses: Vec<Pose> = poses.iter().map(|read| read.pose).collect();
    SpatialPoses::new(chain, &poses).map_err(|fault| {
        let line = match fault {
            SpatialPoseFault::Count { given: 7, .. } => " --chain SS",
            SpatialPoseFault::Count { given: 6, .. } => " --chain PPS",
            SpatialPoseFault::Count { given: 5, .. } => " --chain CC",
            SpatialPoseFault::Count { given: 8, .. } => " --chain CS",
            SpatialPoseFault::Count { given: 10, .. } => " --chain RPS",
            SpatialPoseFault::OneAxis => {
                return format!("{name}: {fault}; for motions in a plane there is cognate synthesize body-guidance");
            }
            _ => return format!("{name}: {fault}"),
        };
        format!("{name}: {fault}\n  try: cognate synthesize spatial-dyads {name}{line}")
    })
}

/// Reads three poses of a body with the crank's angles: CSV with a header `x,y,angle,crank`, or JSON `{"poses": [[x, y, angle,
/// crank], ...]}`, angles as in poses.
pub fn read_timed_poses(name: &str, content: &[u8]) -> Result<TimedPoses, String> {
    let text = decoded(name, content)?;
    let poses: Vec<Placed<[Complex64; 3]>> = if is_json(text) {
        let expected = "[x, y, angle, crank]";
        listed(name, text, "poses", expected, |item, unit| {
            let [x, y, turn, crank] = item.as_array()?.as_slice() else {
                return None;
            };
            let place = Complex64::new(x.as_f64()?, y.as_f64()?);
            Some([place, unit.angle(turn)?, unit.angle(crank)?])
        })?
    } else {
        let unit = Unit::of_table(name, text)?;
        let rows = rows(name, text, ["x", "y", "angle", "crank"])?.into_iter();
        let read = |[x, y, turn, crank]: [f64; 4]| {
            let directions = [turn, crank].map(|angle| unit.direction(angle));
            [Complex64::new(x, y), directions[0], directions[1]]
        };
        rows.map(|(row, at)| (read(row), at)).collect()
    };
    let number = poses.len();
    let poses = <[Placed<[Complex64; 3]>; 3]>::try_from(poses)
        .map_err(|_| format!("{name}: expected three poses, found {number}"))?;
    let part = |k: usize| poses.each_ref().map(|(pose, _)| pose[k]);
    let at = |k: usize| &poses[k].1;
    TimedPoses::new(part(0), part(1), part(2)).map_err(|fault| match fault {
        PoseFault::NotFinite(k) => format!("{name}: {}: {fault}", at(k)),
        PoseFault::Same(j, k) => format!(
            "{name}: {} and {}: the same pose; expected three different ones",
            at(j),
            at(k)
        ),
        PoseFault::Trivial("move") => {
            format!("{name}: the body turns about one point, or stands still")
        }
        PoseFault::Trivial(_) => format!("{name}: the crank does not turn"),
        PoseFault::Extent(_) => format!("{name}: {fault}"),
    })
}

/// Where they stand, places and directions.
type Directed = ([String; 5], [Complex64; 5], [Complex64; 5]);

/// Five rows of `x,y,angle`, or a list of that name.
fn directed(name: &str, content: &[u8], field: &str) -> Result<Directed, String> {
    let text = decoded(name, content)?;
    let positions: Vec<Placed<[Complex64; 2]>> = if is_json(text) {
        listed(
            name,
            text,
            field,
            "[x, y, angle] or [x, y, [cos, sin]]",
            |item, unit| {
                let [x, y, turn] = item.as_array()?.as_slice() else {
                    return None;
                };
                Some([Complex64::new(x.as_f64()?, y.as_f64()?), unit.angle(turn)?])
            },
        )?
    } else {
        let unit = Unit::of_table(name, text)?;
        let rows = rows(name, text, ["x", "y", "angle"])?.into_iter();
        let directed = |[x, y, angle]: [f64; 3]| [Complex64::new(x, y), unit.direction(angle)];
        rows.map(|(row, at)| (directed(row), at)).collect()
    };
    let positions = five(name, positions, field)?;
    let part = |k: usize| positions.each_ref().map(|(item, _)| item[k]);
    Ok((
        positions.each_ref().map(|(_, at)| at.clone()),
        part(0),
        part(1),
    ))
}

/// Unit of the angles of a file.
#[derive(Clone, Copy, Debug)]
enum Unit {
    Degrees,
    Radians,
}

impl Unit {
    /// The unit that the comments of a table name; degrees where they name none.
    fn of_table(name: &str, text: &str) -> Result<Self, String> {
        let degrees = table_comments::degrees(&Document { file: name, text });
        Ok(match degrees.map_err(|e| e.to_string())? {
            None | Some(true) => Self::Degrees,
            Some(false) => Self::Radians,
        })
    }

    /// The unit that a field of JSON names.
    fn of_field(name: &str, field: &str, value: &Value) -> Result<Self, String> {
        match value.as_str().map(table_comments::degrees_of_word) {
            Some(Some(true)) => Ok(Self::Degrees),
            Some(Some(false)) => Ok(Self::Radians),
            _ => Err(format!(
                "{name}: {field}: expected \"deg\" or \"rad\", found {value}"
            )),
        }
    }

    /// The unit vector of an angle.
    fn direction(self, angle: f64) -> Complex64 {
        match self {
            Self::Degrees => direction(angle),
            Self::Radians => {
                let [c, s] = Angle::of_radians(angle).direction;
                Complex64::new(c, s)
            }
        }
    }

    /// The unit vector of an angle in JSON: of a number, or `[cos, sin]` where that is known exactly.
    fn angle(self, value: &Value) -> Option<Complex64> {
        match value {
            Value::Array(_) => complex(value),
            angle => Some(self.direction(angle.as_f64()?)),
        }
    }
}

/// The items of a JSON list: the value itself, or a field of it, beside which the unit of angles may be named.
fn listed<T>(
    name: &str,
    text: &str,
    field: &str,
    expected: &str,
    read: impl Fn(&Value, Unit) -> Option<T>,
) -> Result<Vec<Placed<T>>, String> {
    let value = parsed(name, text)?;
    let mut unit = Unit::Degrees;
    if let Value::Object(fields) = &value {
        let unit_field = if field == "angles" { "unit" } else { "angles" };
        only_fields(name, fields, &[field, unit_field])?;
        if let Some(word) = fields.get(unit_field) {
            unit = Unit::of_field(name, unit_field, word)?;
        }
    }
    let list = value.get(field).unwrap_or(&value);
    let list = list
        .as_array()
        .ok_or_else(|| format!("{name}: expected the field \"{field}\", a list of {expected}"))?;
    let items = list.iter().enumerate().map(|(k, item)| {
        let at = format!("{field}[{k}]");
        let wrong = || {
            let json_kind = kind(item);
            format!("{name}: {at}: expected {expected}, found {json_kind}")
        };
        Ok((read(item, unit).ok_or_else(wrong)?, at))
    });
    items.collect()
}

fn five<T>(name: &str, placed_items: Vec<Placed<T>>, what: &str) -> Result<[Placed<T>; 5], String> {
    let count = placed_items.len();
    let five = placed_items.try_into();
    five.map_err(|_| format!("{name}: expected five {what}, found {count}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_read_and_their_mistakes_named() {
        let rows = ["0,0,0", "1,0,90", "2,1,45", "3,1,30", "4,0,-60"];
        let file = |rows: &[&str]| format!("x,y,angle\n{}\n", rows.join("\n"));
        let poses = read_poses("p.csv", file(&rows).as_bytes()).expect("poses");
        let Sister::Poses(read) = &poses else {
            panic!("{poses:?}")
        };
        assert_eq!(read.turns()[1], Complex64::new(0.0, 1.0));
        let list = rows.map(|row| format!("[{row}]")).join(", ");
        let json = format!("{{\"poses\": [{list}]}}");
        assert_eq!(read_poses("p.json", json.as_bytes()), Ok(poses.clone()));
        let exact = json.replace("[1,0,90]", "[1, 0, [0, 2]]");
        assert_eq!(read_poses("p.json", exact.as_bytes()), Ok(poses));
        let fault = |text: String| read_poses("p.csv", text.as_bytes()).expect_err("not right");
        let cases = [
            (file(&rows[..4]), "expected five poses, found 4"),
            (
                file(&["0,0,0", "1,0,x"]),
                "p.csv:3: angle: expected a finite number, found `x`",
            ),
            (
                file(&["0,0,0", "1,0"]),
                "p.csv:3: expected 3 numbers, x,y,angle, found 2 fields",
            ),
            (
                file(&[rows[0], rows[1], rows[2], rows[3], "1,0,450"]),
                "line 3 and line 6: poses 2 and 5",
            ),
            (
                file(&rows).replace("x,y,angle", "x,y"),
                "expected the header x,y,angle",
            ),
            (
                "{\"poses\": [[1, 2]]}".into(),
                "poses[0]: expected [x, y, angle]",
            ),
        ];
        for (text, expected) in cases {
            let message = fault(text);
            assert!(message.contains(expected), "{message}\nexpected {expected}");
        }
    }

    #[test]
    fn the_unit_of_angles_that_a_file_names_is_followed() {
        type Reader = fn(&str, &[u8]) -> Result<Sister, String>;
        let places = ["0,0,", "1,0,", "2,1,", "3,1,", "4,0,"];
        let [degrees, radians] = [
            ["0", "30", "60", "90", "135"],
            ["0", "0.5", "1", "-2", "4.5"],
        ];
        let rows = |places: [&str; 5], angles: [&str; 5]| {
            std::array::from_fn::<String, 5, _>(|k| places[k].to_owned() + angles[k])
        };
        let positions = |angles| rows(places, angles);
        let pairs = |angles| rows(["0,", "0.25,", "0.75,", "1.5,", "-1,"], angles);
        let readers: [(Reader, &str, &str, [[String; 5]; 2]); 3] = [
            (
                read_poses,
                "x,y,angle",
                "poses",
                [degrees, radians].map(positions),
            ),
            (
                read_timed_points,
                "x,y,angle",
                "points",
                [degrees, radians].map(positions),
            ),
            (
                read_angles,
                "input,output",
                "angles",
                [degrees, radians].map(pairs),
            ),
        ];
        for (read, header, field, [degrees, radians]) in readers {
            let unit = if field == "angles" { "unit" } else { "angles" };
            let table = |comment: &str, rows: &[String; 5]| {
                let text = format!("{comment}{header}\n{}\n", rows.join("\n"));
                read("p.csv", text.as_bytes())
            };
            let json = |word: &str, rows: &[String; 5]| {
                let list = format!("[{}]", rows.join("], ["));
                let text = format!("{{\"{unit}\": \"{word}\", \"{field}\": [{list}]}}");
                read("p.csv", text.as_bytes())
            };
            let plain = table("", &degrees).expect("degrees");
            assert_eq!(table("# angles: deg\n", &degrees), Ok(plain.clone()));
            assert_eq!(json("degrees", &degrees), Ok(plain));
            let stated = table("# angles: rad\n", &radians).expect("radians");
            assert_ne!(table("", &radians), Ok(stated.clone()));
            assert_eq!(
                table("# all angles in radians\n", &radians),
                Ok(stated.clone())
            );
            assert_eq!(json("rad", &radians), Ok(stated));
            for (fault, expected) in [
                (
                    table("# limits in rad\n", &radians),
                    "p.csv:1: angles: this comment can be read",
                ),
                (
                    json("grad", &radians),
                    "expected \"deg\" or \"rad\", found \"grad\"",
                ),
                (
                    read("p.csv", b"{\"foo\": 1}"),
                    "p.csv: unknown field \"foo\"; expected \"",
                ),
            ] {
                let message = fault.expect_err(expected);
                assert!(message.contains(expected), "{message}\nexpected {expected}");
            }
        }
        let mixed = "x,y,angle\n0,0,0\n1,0,\n2,1,1\n3,1,-2\n4,0,\n5,1,0.5\n";
        let degrees = read_poses_and_points("p.csv", mixed.as_bytes());
        let radians = read_poses_and_points("p.csv", format!("# angles: rad\n{mixed}").as_bytes());
        assert!(radians.is_ok() && radians != degrees, "{radians:?}");
    }

    #[test]
    fn timed_points_are_read_and_their_mistakes_named() {
        let text = "x,y,angle\n0,0,0\n1,0,30\n2,1,60\n3,1,90\n4,0,120\n";
        let csv = read_timed_points("p.csv", text.as_bytes()).expect("points");
        let json = "{\"points\": [[0,0,0], [1,0,30], [2,1,60], [3,1,[0,1]], [4,0,120]]}";
        assert_eq!(read_timed_points("p.json", json.as_bytes()), Ok(csv));
        let cases = [
            (
                text.replace("4,0,120", "1,0,30"),
                "line 3 and line 6: the same point",
            ),
            (
                text.replace("4,0,120\n", ""),
                "expected five points, found 4",
            ),
            (
                "x,y,angle\n0,0,7\n1,0,7\n2,1,7\n3,1,7\n4,0,7\n".into(),
                "the crank does not turn",
            ),
        ];
        for (text, expected) in cases {
            let fault = read_timed_points("p.csv", text.as_bytes()).expect_err("not right");
            assert!(fault.contains(expected), "{fault}\nexpected {expected}");
        }
    }

    #[test]
    fn angles_are_read_and_their_mistakes_named() {
        let text = "input,output\n0,0\n30,10\n60,25\n90,45\n120,70\n";
        let csv = read_angles("p.csv", text.as_bytes()).expect("angles");
        let json = "[[0,0], [30,10], [60,25], [[0,1],45], [120,70]]";
        assert_eq!(read_angles("p.json", json.as_bytes()), Ok(csv));
        let cases = [
            (
                text.replace("120,70", "390,370"),
                "line 3 and line 6: pairs 2 and 5",
            ),
            (
                text.replace("70", "x"),
                "p.csv:6: output: expected a finite number, found `x`",
            ),
            (
                text.replace("120,70\n", ""),
                "expected five pairs of angles, found 4",
            ),
            (
                text.replace("input,output", "x,y"),
                "expected the header input,output",
            ),
            (
                "input,output\n0,0\n3,3\n6,6\n9,9\n12,12\n".into(),
                "input and output turn alike",
            ),
            (
                "{\"angles\": [[1]]}".into(),
                "angles[0]: expected [input, output]",
            ),
        ];
        for (text, expected) in cases {
            let fault = read_angles("p.csv", text.as_bytes()).expect_err("not right");
            assert!(fault.contains(expected), "{fault}\nexpected {expected}");
        }
    }

    #[test]
    fn poses_and_points_are_read_and_their_mistakes_named() {
        let text = "x,y,angle\n0,0,0\n1,0,\n2,1,60\n3,1,90\n4,0,\n5,1,7\n";
        let csv = read_poses_and_points("p.csv", text.as_bytes()).expect("a mixture");
        let Sister::PosesAndPoints(given) = &csv else {
            panic!("{csv:?}")
        };
        assert_eq!((given.mixture().poses(), given.mixture().points()), (4, 2));
        let json = "{\"positions\": [[0,0,0], [1,0], [2,1,60], [3,1,[0,1]], [4,0], [5,1,7]]}";
        assert_eq!(read_poses_and_points("p.json", json.as_bytes()), Ok(csv));
        let cases = [
            (
                text.replace("4,0,", "1,0,"),
                "line 3 and line 6: positions 2 and 5",
            ),
            (
                text.replace("5,1,7", "5,1,"),
                "with 6, 4 or 2 points, found 3 and 3",
            ),
            (
                text.replace("4,0,\n", "4,,\n"),
                "p.csv:6: y: expected a finite number, found ``",
            ),
            (
                text.replace("60", "x"),
                "p.csv:4: angle: expected a finite number, found `x`",
            ),
            (
                "[[1]]".into(),
                "positions[0]: expected [x, y] or [x, y, angle]",
            ),
        ];
        for (text, expected) in cases {
            let fault = read_poses_and_points("p.csv", text.as_bytes()).expect_err("not right");
            assert!(fault.contains(expected), "{fault}\nexpected {expected}");
        }
    }
}

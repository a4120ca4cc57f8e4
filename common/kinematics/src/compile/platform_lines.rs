//! Singular poses of a planar platform on three struts whose lengths are driven: the lines of the struts pass through one
//! point, or are parallel (Gosselin and Angeles 1990). At a held orientation they form a conic in the plane of the position.

use super::configurations::{DegreeIn, Motion, Placed};
use super::minors::add_minors;
use super::planar_platform::isotropic_pose;
use super::singular_kind::{Extent, SingularKind, SingularPositions};
use super::text::{self, Equations, complex};
use crate::mechanism::exact::{Angle, Number, double_expression};
use crate::mechanism::pose::Pose;
use crate::mechanism::{LegKind, Mechanism, MechanismError, Platform, Vector};
use num_complex::Complex64;

/// Legs whose lines are compared.
const LEGS: usize = 3;
/// The determinant is 0 for all positions below this part of what its terms are.
const ZERO: f64 = 1e-13;
/// The determinant is not 0 for all positions above this part of what its terms are.
const NOT_ZERO: f64 = 1e-9;

/// The two ends of a strut.
struct Strut<'a> {
    from: &'a Vector,
    to: &'a Vector,
}

/// The line of a strut, as expressions.
struct Line {
    /// Direction of the line, less the position of the platform.
    offset: [String; 2],
    /// Moment of the line about the platform's origin.
    moment: String,
}

/// Equations of the singular poses.
pub(super) fn singular_positions(
    mechanism: &Mechanism,
    platform: &Platform,
    kind: &SingularKind,
    orientation: Option<&Angle>,
) -> Result<SingularPositions, MechanismError> {
    let struts = struts(mechanism, platform, kind)?;
    let (mut motion, zero) = match orientation {
        Some(angle) => at_orientation(&struts, angle),
        None => in_all_poses(&struts),
    };
    motion.warnings = super::motion::rounded_numbers(mechanism);
    let closing = motion.equations.equations.len();
    let extent = match orientation {
        Some(angle) if is_always_singular(mechanism, &struts, angle)? => Extent::Everywhere,
        _ => add_minors(mechanism, vec![zero], &mut motion)?,
    };
    Ok(SingularPositions {
        motion,
        extent,
        closing,
        whole_from: if orientation.is_some() { 2 } else { 3 },
        maybe_whole_from: u32::MAX,
    })
}

/// The struts; an error where the platform is on other legs.
fn struts<'a>(
    mechanism: &Mechanism,
    platform: &'a Platform,
    kind: &SingularKind,
) -> Result<Vec<Strut<'a>>, MechanismError> {
    let SingularKind::Inputs(inputs) = kind else {
        return Err(mechanism.error(
            "the pose of a platform on legs of free length is singular nowhere; ask for --inputs",
        ));
    };
    let mut struts = Vec::new();
    for leg in &platform.legs {
        match &leg.kind {
            LegKind::Strut {
                from, length: None, ..
            } => struts.push(Strut { from, to: &leg.to }),
            _ => {
                return Err(mechanism.error(format!(
                    "not in this version: all singular poses with leg {} of type {}; write it as links and joints, or ask about single poses with --at FILE",
                    leg.name, leg.word
                )));
            }
        }
    }
    let is_driven = |name: &str| inputs.is_empty() || inputs.iter().any(|input| input == name);
    if struts.len() != LEGS || !platform.legs.iter().all(|leg| is_driven(&leg.name)) {
        return Err(mechanism.error(format!(
            "three driven legs hold a platform in the plane, and {} of {} are; name all three, or ask about single poses with --at FILE",
            platform.legs.iter().filter(|leg| is_driven(&leg.name)).count(),
            platform.legs.len()
        )));
    }
    Ok(struts)
}

/// Whether the lines are dependent in all positions, by values of the determinant.
fn is_always_singular(
    mechanism: &Mechanism,
    struts: &[Strut<'_>],
    angle: &Angle,
) -> Result<bool, MechanismError> {
    let [c, s] = angle.direction;
    let ends = struts.iter().flat_map(|strut| [strut.from, strut.to]);
    let lengths = ends.flat_map(|end| end.iter().map(Number::to_f64));
    let size = lengths.fold(0.0f64, |largest, x| largest.max(x.abs()));
    let mut largest = 0.0f64;
    for [x, y] in [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [0.0, -1.0],
        [1.0, 1.0],
    ] {
        let [x, y] = [x * size, y * size];
        let line = |strut: &Strut<'_>| {
            let [bx, by] = [0, 1].map(|i| strut.to[i].to_f64());
            let [ax, ay] = [0, 1].map(|i| strut.from[i].to_f64());
            let [rx, ry] = [c * bx - s * by, s * bx + c * by];
            [x + rx - ax, y + ry - ay, rx * (y - ay) - ry * (x - ax)]
        };
        let [p, q, r]: [[f64; 3]; LEGS] = [0, 1, 2].map(|k| line(&struts[k]));
        let determinant = p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
            + p[2] * (q[0] * r[1] - q[1] * r[0]);
        largest = largest.max(determinant.abs() / size.powi(4).max(f64::MIN_POSITIVE));
    }
    match largest {
        part if part < ZERO => Ok(true),
        part if part > NOT_ZERO => Ok(false),
        _ => Err(mechanism.error(
            "whether the platform is singular in every position at this orientation is not clear: its numbers are rounded",
        )),
    }
}

/// The determinant of three lines. The first line is subtracted from the others: terms that all directions share
/// cancel, so that the degree is seen.
fn determinant(position: [&str; 2], lines: &[Line], equations: &mut Equations) -> String {
    let parts = |line: &Line| [&line.offset[0], &line.offset[1], &line.moment].map(String::clone);
    let first = parts(&lines[0]);
    let mut difference = |k: usize, i: usize| {
        let difference = text::minus(&parts(&lines[k])[i], &first[i]);
        equations.define(format!("line{}_{}", k + 1, i + 1), difference)
    };
    let [second, third] = [1, 2].map(|k| [0, 1, 2].map(|i| difference(k, i)));
    let minor = |i: usize, j: usize| {
        text::minus(
            &text::times(&second[i], &third[j]),
            &text::times(&second[j], &third[i]),
        )
    };
    let [x, y] = [0, 1].map(|i| text::sum(&[position[i].to_owned(), first[i].clone()]));
    text::sum(&[
        text::times(&x, &minor(1, 2)),
        text::times(&y, &minor(2, 0)),
        text::times(&first[2], &minor(0, 1)),
    ])
}

/// Equations in the coordinates x and y of the platform, which stands at an angle, and the determinant.
fn at_orientation(struts: &[Strut<'_>], angle: &Angle) -> (Motion, String) {
    let mut equations = Equations {
        groups: vec![vec!["x".into(), "y".into()]],
        ..Equations::default()
    };
    // The doubles of the half of the angle are taken as exact, so that cosine and sine are those of a turn.
    let [w, t] = angle.half.map(double_expression);
    let square = format!("({w}^2+{t}^2)");
    let c = equations.define("turn_c".into(), format!("({w}^2-{t}^2)/{square}"));
    let s = equations.define("turn_s".into(), format!("2*{w}*{t}/{square}"));
    let mut lines: Vec<Line> = Vec::new();
    for (k, strut) in struts.iter().enumerate() {
        let [bx, by] = [0, 1].map(|i| strut.to[i].exact_expression());
        let [ax, ay] = [0, 1].map(|i| strut.from[i].exact_expression());
        let arm_x = text::minus(&text::times(&c, &bx), &text::times(&s, &by));
        let arm_y = text::sum(&[text::times(&s, &bx), text::times(&c, &by)]);
        let arm_x = equations.define(format!("arm{}_x", k + 1), arm_x);
        let arm_y = equations.define(format!("arm{}_y", k + 1), arm_y);
        lines.push(Line {
            moment: text::minus(
                &text::times(&arm_x, &text::minus("y", &ay)),
                &text::times(&arm_y, &text::minus("x", &ax)),
            ),
            offset: [text::minus(&arm_x, &ax), text::minus(&arm_y, &ay)],
        });
    }
    let zero = determinant(["x", "y"], &lines, &mut equations);
    let direction = angle.direction;
    let motion = motion_of(equations, move |solution| {
        let [c, s] = direction.map(Into::into);
        Pose {
            position: [solution[0], solution[1], Default::default()],
            ..Pose::about_z(c, s)
        }
    });
    (motion, zero)
}

/// Equations in isotropic coordinates p, P of the platform and its turn g, G, and the determinant.
fn in_all_poses(struts: &[Strut<'_>]) -> (Motion, String) {
    let mut equations = Equations {
        groups: vec![vec!["p".into(), "g".into()], vec!["P".into(), "G".into()]],
        conjugates: vec![("p".into(), "P".into()), ("g".into(), "G".into())],
        equations: vec!["g*G-1".into()],
        ..Equations::default()
    };
    let pair = |v: &Vector| {
        let [x, y] = [0, 1].map(|i| v[i].exact_expression());
        [false, true].map(|bar| complex(&x, &y, bar))
    };
    let line = |strut: &Strut<'_>| {
        let [[b, b_bar], [a, a_bar]] = [pair(strut.to), pair(strut.from)];
        let [arm, arm_bar] = [text::times("g", &b), text::times("G", &b_bar)];
        Line {
            moment: text::minus(
                &text::times(&arm, &text::minus("P", &a_bar)),
                &text::times(&arm_bar, &text::minus("p", &a)),
            ),
            offset: [text::minus(&arm, &a), text::minus(&arm_bar, &a_bar)],
        }
    };
    let lines: Vec<Line> = struts.iter().map(line).collect();
    let zero = determinant(["p", "P"], &lines, &mut equations);
    let motion = motion_of(equations, |solution| {
        isotropic_pose(solution[0], solution[2], solution[1], solution[3])
    });
    (motion, zero)
}

fn motion_of(
    equations: Equations,
    pose: impl Fn(&[Complex64]) -> Pose + Send + Sync + 'static,
) -> Motion {
    Motion {
        equations,
        degree_in: DegreeIn::Pose,
        home: None,
        path: None,
        warnings: Vec::new(),
        placing: Box::new(move |solution| Some(Placed::Pose(pose(solution)))),
    }
}

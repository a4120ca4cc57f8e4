//! Families of mechanisms: systems with parameters, and members of them by number.

use crate::systems::{SerialArm, axis_equations};
use cognate_systems::formats;
use cognate_systems::system::System;

/// A family and how its members are drawn.
pub struct Family {
    /// Common name of the family.
    pub name: &'static str,
    /// The equations, with parameters.
    pub system: System,
    /// Solutions of a general member.
    pub solutions: u64,
    /// Parameters of the real member that these numbers between 0 and 1 give; as many are drawn
    /// as it asks for.
    pub member: fn(&mut dyn FnMut() -> f64) -> Vec<f64>,
}

fn read(text: &str) -> System {
    match formats::read("family", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

fn quoted(words: &[String]) -> String {
    let words: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
    words.join(", ")
}

/// The length of a leg in Study's coordinates: the survey's (31) with the base point `a`, the
/// platform point `b` and the squared length `l`.
fn leg(a: [&str; 3], b: [&str; 3], l: &str) -> String {
    let [a1, a2, a3] = a;
    let [b1, b2, b3] = b;
    let square = |p: [&str; 3]| format!("{0}^2+{1}^2+{2}^2", p[0], p[1], p[2]);
    format!(
        "y0^2+y1^2+y2^2+y3^2+({}+{}-{l})*(x0^2+x1^2+x2^2+x3^2)\
         -2*{a1}*(x0*y1-x1*y0+x2*y3-x3*y2)-2*{a2}*(x0*y2-x1*y3-x2*y0+x3*y1)\
         -2*{a3}*(x0*y3+x1*y2-x2*y1-x3*y0)+2*{b1}*(x0*y1-x1*y0-x2*y3+x3*y2)\
         +2*{b2}*(x0*y2+x1*y3-x2*y0-x3*y1)+2*{b3}*(x0*y3-x1*y2+x2*y1-x3*y0)\
         -2*{a1}*{b1}*(x0^2+x1^2-x2^2-x3^2)-2*{a2}*{b2}*(x0^2-x1^2+x2^2-x3^2)\
         -2*{a3}*{b3}*(x0^2-x1^2-x2^2+x3^2)+4*{a1}*{b2}*(x0*x3-x1*x2)\
         -4*{a1}*{b3}*(x0*x2+x1*x3)-4*{a2}*{b1}*(x0*x3+x1*x2)+4*{a2}*{b3}*(x0*x1-x2*x3)\
         +4*{a3}*{b1}*(x0*x2-x1*x3)-4*{a3}*{b2}*(x0*x1+x2*x3)",
        square(a),
        square(b)
    )
}

fn platform(parameters: &[String], legs: &[String], more: &str) -> System {
    let mut equations = legs.to_vec();
    equations.push("x0*y0+x1*y1+x2*y2+x3*y3".into());
    let variables: Vec<String> = ["x", "y"]
        .iter()
        .flat_map(|c| (0..4).map(move |k| format!("{c}{k}")))
        .collect();
    read(&format!(
        "{{\"variables\": [{}], \"homogeneous\": true, \"parameters\": [{}], \"equations\": [{}]{more}}}",
        quoted(&variables),
        quoted(parameters),
        quoted(&equations)
    ))
}

/// The matrix of a unit quaternion times its squared norm, which is given too.
fn turned(e: [f64; 4], p: [f64; 3]) -> [f64; 3] {
    let [w, x, y, z] = e;
    let norm = w * w + x * x + y * y + z * z;
    let rows = [
        [
            w * w + x * x - y * y - z * z,
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            w * w - x * x + y * y - z * z,
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            w * w - x * x - y * y + z * z,
        ],
    ];
    rows.map(|row| (row[0] * p[0] + row[1] * p[1] + row[2] * p[2]) / norm)
}

/// The squared distance of a base point from a platform point in a pose.
fn length(a: [f64; 3], b: [f64; 3], e: [f64; 4], p: [f64; 3]) -> f64 {
    let b = turned(e, b);
    (0..3).map(|i| b[i] + p[i] - a[i]).map(|d| d * d).sum()
}

/// A random pose: not far, and with the platform above the base.
fn pose(draw: &mut dyn FnMut() -> f64) -> ([f64; 4], [f64; 3]) {
    let e = std::array::from_fn(|i| if i == 0 { 1.0 } else { draw() - 0.5 });
    let p = [draw() - 0.5, draw() - 0.5, 1.0 + draw()];
    (e, p)
}

/// General Stewart-Gough platforms: six legs between any points (40 assemblies; Raghavan 1993,
/// Wampler 1996). 42 parameters, homogeneous coordinates of Study's quadric.
pub fn stewart_gough() -> Family {
    let mut parameters = Vec::new();
    let mut legs = Vec::new();
    for j in 1..=6 {
        let names: Vec<String> = ["a", "b"]
            .iter()
            .flat_map(|c| (1..=3).map(move |i| format!("{c}{j}_{i}")))
            .chain([format!("l{j}")])
            .collect();
        let at = |k: usize| names[k].as_str();
        legs.push(leg([at(0), at(1), at(2)], [at(3), at(4), at(5)], at(6)));
        parameters.extend(names);
    }
    Family {
        name: "Stewart-Gough",
        system: platform(&parameters, &legs, ""),
        solutions: 40,
        member: |draw| {
            let (e, p) = pose(draw);
            let mut values = Vec::new();
            for _ in 0..6 {
                let mut point = || std::array::from_fn(|_| 2.0 * draw() - 1.0);
                let (a, b): ([f64; 3], [f64; 3]) = (point(), point());
                values.extend(a);
                values.extend(b);
                values.push(length(a, b, e, p));
            }
            values
        },
    }
}

/// Octahedral platforms: base and platform are triangles whose corners the legs join like the
/// edges of an octahedron; 16 assemblies in 8 pairs, which the mirror in the base takes to each
/// other.
pub fn octahedral() -> Family {
    let mut parameters = Vec::new();
    for c in ["a", "b"] {
        for j in 1..=3 {
            parameters.extend([format!("{c}{j}_1"), format!("{c}{j}_2")]);
        }
    }
    let mut legs = Vec::new();
    for j in 0..6 {
        let name = |c: &str, k: usize, i: usize| format!("{c}{}_{i}", k % 3 + 1);
        let (a, b) = EDGES[j];
        let (a1, a2) = (name("a", a, 1), name("a", a, 2));
        let (b1, b2) = (name("b", b, 1), name("b", b, 2));
        let l = format!("l{}", j + 1);
        legs.push(leg([&a1, &a2, "0"], [&b1, &b2, "0"], &l));
        parameters.push(l);
    }
    let mirror = ", \"symmetry\": [{\"map\": {\"x1\": \"-x1\", \"x2\": \"-x2\", \
                  \"y0\": \"-y0\", \"y3\": \"-y3\"}}]";
    Family {
        name: "octahedral",
        system: platform(&parameters, &legs, mirror),
        solutions: 16,
        member: |draw| {
            let (e, p) = pose(draw);
            let mut corner = |k: usize| {
                // Not far from an equilateral triangle.
                let place = [[1.0, 0.0], [-0.5, 0.8], [-0.5, -0.8]][k];
                place.map(|c| c + 0.6 * (draw() - 0.5))
            };
            let base: [[f64; 2]; 3] = std::array::from_fn(&mut corner);
            let top: [[f64; 2]; 3] = std::array::from_fn(&mut corner);
            let mut values: Vec<f64> = base.iter().chain(&top).flatten().copied().collect();
            let flat = |p: [f64; 2]| [p[0], p[1], 0.0];
            for (a, b) in EDGES {
                values.push(length(flat(base[a]), flat(top[b]), e, p));
            }
            values
        },
    }
}

/// Pairs of corners that the legs of an octahedral platform join.
const EDGES: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (1, 2), (2, 2), (2, 0)];

/// General 6R arms by the directions of their inner axes (16 postures; Tsai and Morgan 1985):
/// lengths, offsets, the hand's position, and for twists and the hand's direction numbers that
/// stand for points of the unit circle and of SO(3) wherever they are: the tangent of half a
/// twist, and a quaternion. So members in between have twists and a direction too.
pub fn six_revolute() -> Family {
    let mut parameters = Vec::new();
    for k in 1..=5 {
        parameters.extend([format!("t{k}"), format!("a{k}"), format!("d{k}")]);
    }
    parameters.extend(["q0", "q1", "q2", "q3", "p1", "p2", "p3"].map(String::from));
    let z = |k: usize| -> [String; 3] {
        match k {
            1 => ["0", "0", "1"].map(String::from),
            6 => ["h1", "h2", "h3"].map(String::from),
            k => ["x", "y", "w"].map(|c| format!("{c}{k}")),
        }
    };
    let mut definitions = vec![
        "\"n\": \"q0^2+q1^2+q2^2+q3^2\"".to_string(),
        "\"h1\": \"2*(q1*q3+q0*q2)/n\"".into(),
        "\"h2\": \"2*(q2*q3-q0*q1)/n\"".into(),
        "\"h3\": \"(q0^2-q1^2-q2^2+q3^2)/n\"".into(),
    ];
    for k in 1..=5 {
        definitions.push(format!("\"cosine{k}\": \"(1-t{k}^2)/(1+t{k}^2)\""));
        // a over the sine.
        definitions.push(format!("\"r{k}\": \"a{k}*(1+t{k}^2)/(2*t{k})\""));
    }
    let equations = axis_equations(&SerialArm {
        axis: &z,
        cosine: &|k| format!("cosine{k}"),
        length: &|k| format!("r{k}"),
        offset: &|k| format!("d{k}"),
        place: &|c| format!("p{}", c + 1),
    });
    let variables: Vec<String> = (2..=5).flat_map(z).collect();
    // Parameters below a line hide the monomials from the search for groups; these have 320 paths.
    let variable_group = |a: usize, b: usize| quoted(&[z(a), z(b)].concat());
    let groups = format!("[{}], [{}]", variable_group(2, 4), variable_group(3, 5));
    let system = read(&format!(
        "{{\"variables\": [{}], \"groups\": [{groups}], \"parameters\": [{}], \"definitions\": {{{}}}, \"equations\": [{}]}}",
        quoted(&variables),
        quoted(&parameters),
        definitions.join(", "),
        quoted(&equations)
    ));
    Family {
        name: "6R by its axes",
        system,
        solutions: 16,
        member: |draw| {
            let mut values = Vec::new();
            for _ in 0..5 {
                // Twists from 23 to 138 degrees, to either side.
                let side = if draw() < 0.5 { -1.0 } else { 1.0 };
                values.extend([side * (0.2 + 2.4 * draw()), draw(), draw()]);
            }
            // A quaternion in any direction; how far the hand reaches.
            for _ in 0..4 {
                values.push(2.0 * draw() - 1.0);
            }
            for _ in 0..3 {
                values.push(3.0 * (draw() - 0.5));
            }
            values
        },
    }
}

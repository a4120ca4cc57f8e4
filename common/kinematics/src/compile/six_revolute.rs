//! The family of all 6R arms and the poses of their hands, as eight quadrics (L.-W. Tsai and A. Morgan 1985).
//!
//! Parameters: t_j/w_j half-tangent of the twist from axis j to axis j + 1, a_j length of their common normal, d_j
//! offset along axis j + 1, (zu, zv, zw) stereographic numbers of the direction of axis 6 up to a factor, (px, py, pz) a
//! point of it. On these parameters the 16 true solutions are one component and 16 mirrored ones another.

use super::formulation::KnownMember;
use super::text::Equations;
use cognate_systems::formats::points;

/// The unknowns, in the order of the system.
pub const VARIABLES: [&str; 8] = ["c1", "s1", "c4", "s4", "c2", "s2", "c5", "s5"];

/// A general complex member, made by loops from one solution and followed to where it is well conditioned;
/// `deploy/families/README.md` says how.
const PARAMETERS: &str = include_str!("../../../../deploy/families/six_revolute/parameters.json");
const SOLUTIONS: &str = include_str!("../../../../deploy/families/six_revolute/solutions.jsonl");

fn parameters() -> Vec<String> {
    let numbered = |letter: &str| {
        (1..=5)
            .map(|j| format!("{letter}{j}"))
            .collect::<Vec<String>>()
    };
    let mut names: Vec<String> = ["t", "w", "a", "d"]
        .into_iter()
        .flat_map(numbered)
        .collect();
    names.extend(["zu", "zv", "zw", "px", "py", "pz"].map(String::from));
    names
}

/// The family's equations.
pub fn equations() -> Equations {
    let group = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
    let pair = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
    Equations {
        groups: vec![group(&VARIABLES[..4]), group(&VARIABLES[4..])],
        parameters: parameters(),
        definitions: DEFINITIONS.iter().map(pair).collect(),
        equations: EQUATIONS.iter().map(|e| (*e).to_owned()).collect(),
        ..Equations::default()
    }
}

/// The sixteen solutions of a general member.
pub fn known_member() -> Option<KnownMember> {
    let variables = VARIABLES.map(String::from);
    let values =
        points::read_parameters("parameters", PARAMETERS.as_bytes(), &parameters()).ok()?;
    let points = points::read_solutions("solutions", SOLUTIONS.as_bytes(), &variables).ok()?;
    Some(KnownMember {
        parameters: values.into_iter().next()?,
        points: points.into_iter().flatten().collect(),
    })
}

/// Names for parts of the equations, as in the text above.
const DEFINITIONS: [(&str, &str); 60] = [
    ("al1", "(w1^2-t1^2)/(w1^2+t1^2)"),
    ("be1", "2*t1*w1/(w1^2+t1^2)"),
    ("ty1", "-be1*d1"),
    ("tz1", "al1*d1"),
    ("al2", "(w2^2-t2^2)/(w2^2+t2^2)"),
    ("be2", "2*t2*w2/(w2^2+t2^2)"),
    ("ty2", "-be2*d2"),
    ("tz2", "al2*d2"),
    ("al3", "(w3^2-t3^2)/(w3^2+t3^2)"),
    ("be3", "2*t3*w3/(w3^2+t3^2)"),
    ("ty3", "-be3*d3"),
    ("tz3", "al3*d3"),
    ("al4", "(w4^2-t4^2)/(w4^2+t4^2)"),
    ("be4", "2*t4*w4/(w4^2+t4^2)"),
    ("ty4", "-be4*d4"),
    ("tz4", "al4*d4"),
    ("al5", "(w5^2-t5^2)/(w5^2+t5^2)"),
    ("be5", "2*t5*w5/(w5^2+t5^2)"),
    ("ty5", "-be5*d5"),
    ("tz5", "al5*d5"),
    ("hx", "2*zu*zw/(zu^2+zv^2+zw^2)"),
    ("hy", "2*zv*zw/(zu^2+zv^2+zw^2)"),
    ("hz", "(zw^2-zu^2-zv^2)/(zu^2+zv^2+zw^2)"),
    ("ux", "c1*px+s1*py"),
    ("uy", "c1*py-s1*px"),
    ("mx", "c1*hx+s1*hy"),
    ("my", "c1*hy-s1*hx"),
    ("kx", "ux-a1"),
    ("ky", "al1*uy+be1*pz"),
    ("kz", "al1*pz-be1*uy-d1"),
    ("ny", "al1*my+be1*hz"),
    ("nz", "al1*hz-be1*my"),
    ("vx", "c2*kx+s2*ky"),
    ("vy", "c2*ky-s2*kx"),
    ("qx", "c2*mx+s2*ny"),
    ("qy", "c2*ny-s2*mx"),
    ("wx", "vx-a2"),
    ("wy", "al2*vy+be2*kz"),
    ("wz", "al2*kz-be2*vy-d2"),
    ("yy", "al2*qy+be2*nz"),
    ("yz", "al2*nz-be2*qy"),
    ("e5x", "c5*a5-s5*ty5"),
    ("e5y", "s5*a5+c5*ty5"),
    ("g5x", "s5*be5"),
    ("g5y", "-c5*be5"),
    ("b4y", "al4*e5y-be4*tz5"),
    ("b4z", "be4*e5y+al4*tz5"),
    ("x4x", "e5x+a4"),
    ("x4y", "b4y+ty4"),
    ("x4z", "b4z+tz4"),
    ("zetay", "al4*g5y-be4*al5"),
    ("zetaz", "be4*g5y+al4*al5"),
    ("r4x", "c4*x4x-s4*x4y"),
    ("r4y", "s4*x4x+c4*x4y"),
    ("o4x", "c4*g5x-s4*zetay"),
    ("o4y", "s4*g5x+c4*zetay"),
    ("h3y", "al3*r4y-be3*x4z"),
    ("h3z", "be3*r4y+al3*x4z"),
    ("i3y", "al3*o4y-be3*zetaz"),
    ("i3z", "be3*o4y+al3*zetaz"),
];

const EQUATIONS: [&str; 8] = [
    "yz-i3z",
    "wz-(h3z+tz3)",
    "(px^2+py^2+pz^2)-2*(a1*ux+ty1*uy+tz1*pz)+(a1^2+d1^2)-2*(a2*vx+ty2*vy+tz2*kz)+(a2^2+d2^2)-((a5^2+d5^2)+(a4^2+d4^2)+2*(a4*e5x+ty4*b4y+tz4*b4z)+(a3^2+d3^2)+2*(a3*r4x+ty3*h3y+tz3*h3z))",
    "(px*hx+py*hy+pz*hz)-(a1*mx+ty1*my+tz1*hz)-(a2*qx+ty2*qy+tz2*nz)-((ty5*(0-be5)+tz5*al5)+(a4*g5x+ty4*zetay+tz4*zetaz)+(a3*o4x+ty3*i3y+tz3*i3z))",
    "c1^2+s1^2-1",
    "c2^2+s2^2-1",
    "c4^2+s4^2-1",
    "c5^2+s5^2-1",
];

//! Curves in the plane that can bound where an output can be: images of singular postures, and of postures at limits.
//!
//! They are circles for chains of turns, for two such arms that meet in a joint, and for platforms that are held at an angle. A
//! list is complete, or there is none.

use super::arms::Arms;
use super::circle::Circle;
use super::collinear::{extent, signs_from_first};
use super::planar_chain::{BORDER, HeldChain, PlanarChain};
use super::reach::{MOST_JOINTS, violations};
use cognate_kinematics::mechanism::exact::Angle;
use cognate_kinematics::mechanism::{
    Body, Leg, LegKind, Linkage, Mechanism, Platform, Space, Vector,
};
use cognate_kinematics::plane::{modulus, unit};
use num_complex::Complex64;

/// Most joints of a chain without limits whose circles are listed: 2^(n-1) of them.
const MOST_FREE_JOINTS: usize = 6;

/// Why a curve can bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The output has lost a direction, whatever the limits.
    Singularity,
    /// The joints or legs with these names are at their limits.
    Limit(Vec<String>),
}

/// A circle that can bound where the output can be.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The circle.
    pub circle: Circle,
    /// Why it can bound.
    pub cause: Cause,
}

/// All curves that can bound where the output of a mechanism can be; with those of limits where `with_limits`. An error says why
/// there is no such list.
pub fn curves(
    mechanism: &Mechanism,
    orientation: Option<Angle>,
    with_limits: bool,
) -> Result<Vec<Curve>, String> {
    let refused = |reason: &str| Err(format!("not in this version: {reason}"));
    if mechanism.space != Space::Planar {
        return refused("boundaries of mechanisms that are not in the plane");
    }
    match &mechanism.body {
        Body::Platform(platform) => {
            let angle = match (platform.fixed_orientation, orientation) {
                (true, _) => Angle::ZERO,
                (false, Some(angle)) => angle,
                (false, None) => return refused("the boundary of a platform that turns"),
            };
            curves_of_platform(mechanism, platform, angle, with_limits)
        }
        Body::Linkage(linkage) => {
            let output = mechanism.output.as_ref();
            let place = output.and_then(|output| output.point.as_ref());
            let link =
                output.and_then(|output| linkage.links.iter().position(|l| *l == output.link));
            let (Some(link), Some(place)) = (link, place) else {
                return refused("the boundary of an output that is no point");
            };
            curves_of_linkage(mechanism, linkage, (link, place), with_limits)
        }
        Body::Chain(_) | Body::Framework(_) => refused("the boundary of a mechanism of this kind"),
    }
}

fn curves_of_linkage(
    mechanism: &Mechanism,
    linkage: &Linkage,
    (link, place): (usize, &Vector),
    with_limits: bool,
) -> Result<Vec<Curve>, String> {
    if let Some(chain) = PlanarChain::open(mechanism, linkage, link, place) {
        let count = chain.turns.len();
        let limited = with_limits && chain.has_limits();
        let most = if limited {
            MOST_JOINTS
        } else {
            MOST_FREE_JOINTS
        };
        if count < 2 {
            return Err(
                "a chain of one joint moves its output on a circle, which bounds no area".into(),
            );
        }
        if count > most {
            return Err(format!(
                "not in this version: the boundary of a chain of {count} joints{}, at most {most}",
                if limited { " with limits" } else { "" }
            ));
        }
        return Ok(once(curves_of_chain(&chain, with_limits)));
    }
    let Some(arms) = Arms::of(mechanism, linkage, (link, place)) else {
        return Err(
            "not in this version: boundaries of linkages other than chains of turns, and five-bars whose output is the joint \
             between the rods"
                .into(),
        );
    };
    let turn = 2.0 * std::f64::consts::PI;
    let between = mechanism.limits_of(&arms.between);
    if with_limits && between.is_some_and(|[low, high]| high - low < turn) {
        return Err(format!(
            "not in this version: limits of {}, the joint between the rods, make a boundary that is no circle",
            arms.between
        ));
    }
    let curves = arms
        .chains
        .iter()
        .map(|chain| curves_of_chain(chain, with_limits));
    Ok(once(curves.flatten()))
}

/// The curves without those that another one with the same cause repeats, as both ends of symmetric limits do.
fn once(curves: impl IntoIterator<Item = Curve>) -> Vec<Curve> {
    let mut kept: Vec<Curve> = Vec::new();
    for curve in curves {
        let none = BORDER * curve.circle.radius;
        let repeats =
            |other: &Curve| other.cause == curve.cause && other.circle.is_same(&curve.circle, none);
        if !kept.iter().any(repeats) {
            kept.push(curve);
        }
    }
    kept
}

/// Circles of a chain: some of its joints are at limits, and the free ones on a line with the point. The point then turns
/// about the first free joint.
fn curves_of_chain(chain: &PlanarChain, with_limits: bool) -> Vec<Curve> {
    let mut curves = Vec::new();
    let mut open = vec![(chain.free(), 0, Vec::new())];
    while let Some((held, first, names)) = open.pop() {
        curves.extend(collinear_curves(chain, &held, &names));
        for place in (0..held.free.len()).filter(|_| with_limits && held.free.len() > 1) {
            let joint = held.free[place];
            let Some(range) = chain.turns[joint].range.filter(|_| joint >= first) else {
                continue;
            };
            for end in range {
                let names = [&names[..], &[chain.turns[joint].name.clone()]].concat();
                open.push((held.held(place, end), joint + 1, names));
            }
        }
    }
    curves
}

/// Circles of a chain whose free joints are on a line with the point. Where joints are held at limits, postures beyond the
/// limits of the free joints bound nothing.
fn collinear_curves(chain: &PlanarChain, held: &HeldChain, names: &[String]) -> Vec<Curve> {
    let (lengths, none) = (held.lengths(), BORDER * chain.size());
    let is_attained = |signs: &[f64]| {
        let ways: Vec<Complex64> = signs
            .iter()
            .map(|sign| Complex64::new(*sign, 0.0))
            .collect();
        // All turns of the first free joint make the circle.
        let beyond = violations(held, &ways);
        let has_length = lengths.iter().all(|length| *length > none);
        !has_length || beyond.iter().all(|joint| *joint == held.free[0])
    };
    let patterns = signs_from_first(lengths.len());
    let patterns = patterns.filter(|signs| names.is_empty() || is_attained(signs));
    let circles = patterns.map(|signs| Circle {
        center: held.base,
        radius: extent(&lengths, &signs).abs(),
    });
    let cause = match names {
        [] => Cause::Singularity,
        _ => Cause::Limit(names.to_vec()),
    };
    circles
        .filter(|circle| circle.radius > none)
        .map(|circle| Curve {
            circle,
            cause: cause.clone(),
        })
        .collect()
}

/// Circles of a platform that is held at an angle: of each leg, about the place of the output where the leg's ends would meet.
fn curves_of_platform(
    mechanism: &Mechanism,
    platform: &Platform,
    angle: Angle,
    with_limits: bool,
) -> Result<Vec<Curve>, String> {
    let turned = Complex64::new(angle.direction[0], angle.direction[1]);
    let output = Complex64::new(platform.output_point[0], platform.output_point[1]);
    let mut curves = Vec::new();
    for leg in &platform.legs {
        let offset = turned * (complex(&leg.to) - output);
        let range = mechanism.limits_of(&leg.name).filter(|_| with_limits);
        let circles = circles_of_leg(leg, range)?;
        curves.extend(circles.into_iter().map(|mut curve| {
            curve.circle.center -= offset;
            curve
        }));
    }
    Ok(curves)
}

/// Circles of the platform's end of a leg.
fn circles_of_leg(leg: &Leg, range: Option<[f64; 2]>) -> Result<Vec<Curve>, String> {
    let curve = |center: Complex64, radius: f64, cause: Cause| Curve {
        circle: Circle { center, radius },
        cause,
    };
    let limit = || Cause::Limit(vec![leg.name.clone()]);
    let mut curves = match &leg.kind {
        LegKind::Strut {
            length: Some(_), ..
        } => {
            return Err(format!(
                "leg {} has a fixed length: the output of a platform that is held at an angle moves on a circle",
                leg.name
            ));
        }
        LegKind::Slider { .. } => {
            return Err(format!(
                "not in this version: leg {} has a slider, whose boundary is no circle",
                leg.name
            ));
        }
        LegKind::Strut { from, .. } => {
            let radii = range.into_iter().flatten();
            radii
                .map(|radius| curve(complex(from), radius, limit()))
                .collect()
        }
        LegKind::Crank {
            center,
            axis,
            zero,
            length,
            rod,
        } => {
            let (center, zero) = (complex(center), unit(complex(zero)));
            let (length, rod) = (length.to_f64(), rod.to_f64());
            let sense = if axis[2].to_f64() < 0.0 { -1.0 } else { 1.0 };
            let turn = 2.0 * std::f64::consts::PI;
            let ends = range
                .filter(|[low, high]| high - low < turn)
                .into_iter()
                .flatten();
            let tip = |radians: f64| {
                let [c, s] = Angle::of_radians(radians).direction;
                center + zero * Complex64::new(c, sense * s) * length
            };
            let limits = ends.map(|radians| curve(tip(radians), rod, limit()));
            let dead = [length + rod, (length - rod).abs()];
            let dead = dead.map(|radius| curve(center, radius, Cause::Singularity));
            dead.into_iter().chain(limits).collect::<Vec<_>>()
        }
    };
    let size = curves
        .iter()
        .map(|curve| curve.circle.radius.abs())
        .fold(0.0, f64::max);
    // A leg of length 0 or less is at no limit: the length reaches 0 in a point.
    curves.retain(|curve| curve.circle.radius > BORDER * size);
    Ok(curves)
}

fn complex(v: &Vector) -> Complex64 {
    Complex64::new(v[0].to_f64(), v[1].to_f64())
}

/// A length of the drawing of curves: the largest distance of their points from the first centre.
pub fn size(curves: &[Curve]) -> f64 {
    let Some(first) = curves.first() else {
        return 1.0;
    };
    let extent =
        |curve: &Curve| modulus(curve.circle.center - first.circle.center) + curve.circle.radius;
    curves.iter().map(extent).fold(0.0, f64::max)
}

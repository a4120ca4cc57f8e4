//! Singularity: whether a mechanism at one configuration loses control by its inputs, or loses motions of its output.

use super::assembly::Assembly;
use super::conditions::{Condition, Evaluation, Square};
use super::field::{Constant, Doubles};
use super::nearby::{CLOSES, corrected, gap, largest, linearized, refined};
use super::ranks::{Matrix, NONZERO, Ranks, singular_values};
use super::series::SeriesSpace;
use cognate_kinematics::compile::singular_positions::SingularKind;
use cognate_kinematics::mechanism::chain::Chain;
use cognate_kinematics::mechanism::configuration::GivenConfiguration;
use cognate_kinematics::mechanism::exact::Angle;
use cognate_kinematics::mechanism::pose::{cross, dot};
use cognate_kinematics::mechanism::{Body, Mechanism, Space};
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Singular values below this are those of a singular configuration.
const SINGULAR: f64 = 1e-7;
/// Interval of singular values for which it is in doubt whether the configuration is singular: one that is typed to
/// seven digits may be.
const IN_DOUBT: [f64; 2] = [2e-8, 5e-7];
/// General positions that are looked for.
const POSITIONS: u64 = 6;
/// Number of general positions that must be found.
const NEEDED: usize = 2;
/// How far general positions are, as half-tangents or parts of the size.
const DISTANCE: f64 = 0.6;
/// Corrections at most.
const MOST_CORRECTIONS: usize = 40;

/// Singularity of a configuration: whether it is singular, and the loss of rank.
#[derive(Clone, Debug, PartialEq)]
pub struct Singularity {
    /// Whether it is singular; `None` where that is in doubt.
    pub is_singular: Option<bool>,
    /// Whether inputs leave something free in the general positions near it, too.
    pub is_everywhere: bool,
    /// Difference of the rank in a general position and the rank in this configuration.
    pub rank_loss: usize,
    /// The least singular value with inputs held; with the output held, the least of those that are not 0 in a general position.
    /// Lengths are in parts of the size.
    pub value: f64,
    /// Singular classes of an arm with a wrist: `elbow`, `shoulder`, `wrist`.
    pub classes: Vec<&'static str>,
    /// Reason for a doubt; `None` if nothing is in doubt.
    pub doubt: Option<String>,
}

impl Singularity {
    fn in_doubt(value: f64, reason: &str) -> Self {
        Self {
            is_singular: None,
            is_everywhere: false,
            rank_loss: 0,
            value,
            classes: Vec::new(),
            doubt: Some(format!("in doubt: {reason}")),
        }
    }
}

/// The singularity of a configuration; an error if it does not close, or if the mechanism does not have these inputs or
/// this output.
pub fn singularity(
    mechanism: &Mechanism,
    given: &GivenConfiguration,
    kind: &SingularKind,
    seed: u64,
) -> Result<Singularity, String> {
    let assembly = Assembly::of(mechanism, given)?;
    let open = gap(&assembly);
    if open.is_nan() || open > CLOSES {
        return Err(format!(
            "the mechanism does not close there: its loops or bars are off by {open:.1e} of its size, and {CLOSES:.0e} is allowed"
        ));
    }
    let assembly = refined(assembly);
    let map = VelocityMap::of(mechanism, &assembly, kind)?;
    let at: Vec<Complex64> = assembly.offset.iter().map(|x| x.double.into()).collect();
    let here = map.values(&at);
    let general = general_rank(&map, &at, seed);
    if here.iter().any(|value| !value.is_finite()) {
        let reason = "velocities are not defined there, as where a leg has length 0";
        return Ok(Singularity::in_doubt(f64::NAN, reason));
    }
    let rank = match general {
        Some(rank) if here.len() >= rank => rank,
        _ => {
            let value = here.last().copied().unwrap_or(0.0);
            let reason = "no general position was met near the configuration, with which its rank could be compared";
            return Ok(Singularity::in_doubt(value, reason));
        }
    };
    // Inputs must hold every coordinate; an output need not move in every direction.
    let wanted = match kind {
        SingularKind::Inputs(_) => here.len(),
        SingularKind::Outputs => rank,
    };
    let counted = &here[..wanted];
    let value = counted.last().copied().unwrap_or(0.0);
    let between = counted
        .iter()
        .find(|x| (IN_DOUBT[0]..IN_DOUBT[1]).contains(*x));
    let lost = counted.iter().filter(|x| **x < SINGULAR).count();
    let rank_loss = lost.saturating_sub(wanted - rank);
    let classes = match (&mechanism.body, kind) {
        (Body::Chain(chain), SingularKind::Outputs) if rank_loss > 0 => {
            wrist_classes(chain, &assembly)
        }
        _ => Vec::new(),
    };
    Ok(Singularity {
        is_singular: between.is_none().then_some(lost > 0),
        is_everywhere: between.is_none() && lost > 0 && rank < wanted,
        rank_loss,
        value,
        classes,
        doubt: between.map(|x| {
            format!("in doubt: the singular value {x:.1e} is neither that of a regular nor surely that of a singular configuration; give more digits")
        }),
    })
}

/// A linear map of velocities of which the rank is compared.
struct VelocityMap<'a> {
    assembly: &'a Assembly,
    kind: MapKind,
}

enum MapKind {
    /// The conditions, and the velocities of coordinates and legs.
    Inputs {
        coordinates: Vec<usize>,
        legs: Vec<Condition>,
    },
    /// The output's velocity, of those that the conditions allow.
    Output {
        link: usize,
        point: [Constant; 3],
        is_position: bool,
    },
}

impl<'a> VelocityMap<'a> {
    fn of(
        mechanism: &Mechanism,
        assembly: &'a Assembly,
        kind: &SingularKind,
    ) -> Result<Self, String> {
        let kind = match kind {
            SingularKind::Inputs(names) => inputs(mechanism, assembly, names)?,
            SingularKind::Outputs => output(mechanism, assembly)?,
        };
        Ok(Self { assembly, kind })
    }

    /// Singular values at coordinates, in descending order.
    fn values(&self, at: &[Complex64]) -> Vec<f64> {
        let n = at.len();
        let mut rows = linearized(self.assembly, at).rows;
        match &self.kind {
            MapKind::Inputs { coordinates, legs } => {
                let unit = |k: &usize| -> Vec<Complex64> {
                    (0..n)
                        .map(|i| f64::from(u8::from(i == *k)).into())
                        .collect()
                };
                rows.extend(coordinates.iter().map(unit));
                rows.extend(legs.iter().map(|leg| self.leg_velocity(leg, at)));
                let mut values = singular_values(&rows, n);
                values.resize(n, 0.0);
                values
            }
            MapKind::Output {
                link,
                point,
                is_position,
            } => {
                let Ok(reduction) = Doubles.reduce(&rows, n) else {
                    return Vec::new();
                };
                let velocity = self.output_velocity((*link, point, *is_position), at);
                let free = reduction.kernel.len();
                let image = |row: &Vec<Complex64>| {
                    let product = |v: &Vec<Complex64>| row.iter().zip(v).map(|(a, b)| a * b).sum();
                    reduction.kernel.iter().map(product).collect()
                };
                let image: Matrix<Complex64> = velocity.iter().map(image).collect();
                let mut values = singular_values(&image, free);
                values.resize(velocity.len().min(free), 0.0);
                values
            }
        }
    }

    fn evaluate<T>(&self, at: &[Complex64], read: impl FnOnce(&Evaluation<'_, Doubles>) -> T) -> T {
        let space = SeriesSpace::new(&Doubles, at.len(), 1);
        let coordinates: Vec<_> = at
            .iter()
            .enumerate()
            .map(|(v, x)| space.add(&space.variable(v), &space.constant(*x)))
            .collect();
        read(&Evaluation {
            space: &space,
            values: &self.assembly.values,
            coordinates: &coordinates,
            size: &self.assembly.size,
        })
    }

    /// How the length of a leg changes, in parts of the size.
    fn leg_velocity(&self, leg: &Condition, at: &[Complex64]) -> Vec<Complex64> {
        self.evaluate(at, |evaluation| {
            let squares = evaluation.residuals(leg, self.assembly.space);
            let over = 1.0 / (squares[0][0].re.sqrt() * 2.0);
            squares[0][1..].iter().map(|x| x * over).collect()
        })
    }

    fn output_velocity(
        &self,
        (link, point, is_position): (usize, &[Constant; 3], bool),
        at: &[Complex64],
    ) -> Matrix<Complex64> {
        let space = self.assembly.space;
        self.evaluate(at, |evaluation| {
            let (_, steps) = &self.assembly.links[link];
            let pose = evaluation.pose(steps);
            let place = point
                .each_ref()
                .map(|c| evaluation.space.constant(c.double.into()));
            let place = evaluation.image(&pose, &place);
            let mut rows: Matrix<Complex64> = Vec::new();
            if space != Space::Spherical {
                let axes = if space == Space::Planar { 2 } else { 3 };
                let over = 1.0 / self.assembly.size.double;
                let row = |series: &Vec<Complex64>| series[1..].iter().map(|x| x * over).collect();
                rows.extend(place.iter().take(axes).map(row));
            }
            if !is_position {
                // The velocity of a rotation R: the odd part of dR R^T.
                let axes: &[(usize, usize)] = match space {
                    Space::Planar => &[(1, 0)],
                    _ => &[(2, 1), (0, 2), (1, 0)],
                };
                for (i, j) in axes {
                    let entry = |v: usize| {
                        (0..3)
                            .map(|k| pose.rotation[*i][k][v] * pose.rotation[*j][k][0])
                            .sum()
                    };
                    rows.push((1..=at.len()).map(entry).collect());
                }
            }
            rows
        })
    }
}

fn inputs(mechanism: &Mechanism, assembly: &Assembly, names: &[String]) -> Result<MapKind, String> {
    if names.is_empty() {
        return Err("no inputs: name the joints that drive it with --input".into());
    }
    let (mut coordinates, mut legs) = (Vec::new(), Vec::new());
    for name in names {
        let joint = assembly.named.iter().find(|(n, _)| n == name);
        let leg = assembly.legs.iter().find(|(n, _)| n == name);
        match (joint, leg) {
            (Some((_, coordinate)), _) => coordinates.push(*coordinate),
            (None, Some((_, places))) => {
                let zero = Constant::integer(0);
                let square = Square::Number(zero);
                legs.push(Condition::Distance(Box::new((places.clone(), square))));
            }
            (None, None) => {
                let values: Vec<String> = mechanism.values().into_iter().map(|(n, _)| n).collect();
                return Err(format!(
                    "there is no input {name}; there are {}",
                    values.join(", ")
                ));
            }
        }
    }
    Ok(MapKind::Inputs { coordinates, legs })
}

fn output(mechanism: &Mechanism, assembly: &Assembly) -> Result<MapKind, String> {
    let zero = [0; 3].map(Constant::integer);
    let output = mechanism.output.as_ref();
    match &mechanism.body {
        Body::Framework(_) => Err("a framework has no output".into()),
        Body::Chain(chain) if !chain.closed => Ok(MapKind::Output {
            link: assembly.links.len() - 1,
            point: zero,
            // A point of an arm that makes poses is the origin of its poses.
            is_position: chain.joints.len() < 6 && output.is_some_and(|o| o.point.is_some()),
        }),
        _ => {
            let output = output.ok_or("the file names no output")?;
            let link = assembly
                .links
                .iter()
                .position(|(name, _)| *name == output.link);
            let link = link.ok_or_else(|| format!("there is no link {}", output.link))?;
            let point = output.point.as_ref();
            Ok(MapKind::Output {
                link,
                point: point.map_or(zero, |p| p.each_ref().map(Constant::of)),
                is_position: point.is_some() && !matches!(mechanism.body, Body::Platform(_)),
            })
        }
    }
}

/// The rank in general positions: some way along random motions that the conditions allow.
fn general_rank(map: &VelocityMap<'_>, origin: &[Complex64], seed: u64) -> Option<usize> {
    let n = origin.len();
    let mut ranks = Vec::new();
    for index in 0..POSITIONS {
        let mut random = RandomStream::new(seed, Purpose::Probe, 100 + index);
        let rows = linearized(map.assembly, origin).rows;
        let Ok(reduction) = Doubles.reduce(&rows, n) else {
            continue;
        };
        let mut at = origin.to_vec();
        for vector in &reduction.kernel {
            let factor = DISTANCE * (2.0 * random.uniform() - 1.0);
            for (x, v) in at.iter_mut().zip(vector) {
                *x += factor * v.re;
            }
        }
        let mut is_met = false;
        for _ in 0..MOST_CORRECTIONS {
            let near = linearized(map.assembly, &at);
            if largest(&near.gaps) < 1e-13 {
                is_met = true;
                break;
            }
            corrected(&mut at, &near.rows, &near.gaps, NONZERO);
        }
        if is_met {
            let values = map.values(&at);
            let first = values.first().copied().unwrap_or(0.0);
            // Weak control by inputs is control.
            let least = match map.kind {
                MapKind::Inputs { .. } => IN_DOUBT[1],
                MapKind::Output { .. } => NONZERO * first,
            };
            ranks.push(values.iter().filter(|x| **x > least).count());
        }
    }
    (ranks.len() >= NEEDED).then(|| ranks.into_iter().max())?
}

/// The angle with this half-tangent, in radians.
fn half_tangent_angle(t: f64) -> f64 {
    Angle::of_direction(Complex64::new(1.0 - t * t, 2.0 * t)).radians
}

/// Kinds of singularities of a chain of six turns of which the last three axes meet: its wrist's axes lie in a plane; the wrist's
/// centre is at the reach of the arm; it is in the plane of the first two axes.
fn wrist_classes(chain: &Chain, assembly: &Assembly) -> Vec<&'static str> {
    let is_six = chain.joints.len() == 6 && chain.joints.iter().all(|j| j.is_angle);
    if !is_six || chain.joints[3].a != 0.0 || chain.joints[4].a != 0.0 || chain.joints[4].d != 0.0 {
        return Vec::new();
    }
    let angle = |k: usize| match &assembly.values[k] {
        super::conditions::Value::Turn([c, s]) => {
            Angle::of_direction(Complex64::new(c.double, s.double)).radians
                + half_tangent_angle(assembly.offset[k].double)
        }
        _ => 0.0,
    };
    let values: Vec<f64> = (0..6).map(angle).collect();
    let (axes, _) = chain.axes(&values);
    let center = axes[4].point;
    let size = chain.size();
    let toward = |k: usize| {
        let arm: [f64; 3] = std::array::from_fn(|i| (center[i] - axes[k].point[i]) / size);
        cross(axes[k].direction, arm)
    };
    let length = |v: [f64; 3]| dot(v, v).sqrt();
    let mut classes = Vec::new();
    let are_parallel = length(cross(axes[1].direction, axes[2].direction)) < 1e-12;
    if are_parallel && length(cross(toward(1), toward(2))) < SINGULAR {
        classes.push("elbow");
    }
    if are_parallel && dot(toward(0), axes[1].direction).abs() < SINGULAR {
        classes.push("shoulder");
    }
    if length(cross(axes[3].direction, axes[5].direction)) < SINGULAR {
        classes.push("wrist");
    }
    classes
}

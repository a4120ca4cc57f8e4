//! A platform on legs, inverse: every leg by itself, a length, or a circle and a sphere.

use super::formulation::{Configuration, Family, Formulation, Lifted, Target};
use super::platform::{crank_frame, crank_tip, size, slide_direction};
use super::text::{self, Equations};
use crate::mechanism::chain::JointValue;
use crate::mechanism::exact::double_expression;
use crate::mechanism::pose::{Pose, Vector3};
use crate::mechanism::{Leg, LegKind, Mechanism, MechanismError, PLATFORM, Platform, Space};
use crate::plane::modulus;
use num_complex::Complex64;
use std::sync::Arc;

/// The formulation of a platform's inverse question.
pub fn compile(
    mechanism: &Mechanism,
    platform: &Platform,
) -> Result<Box<dyn Formulation>, MechanismError> {
    if platform.legs.iter().any(|l| !l.is_driven()) {
        return Err(mechanism.error(
            "a leg of fixed length lets the platform reach special poses only: a general pose has no answer",
        ));
    }
    let planar = mechanism.space == Space::Planar;
    let mut equations = Equations::default();
    for (k, leg) in platform.legs.iter().enumerate() {
        let number = k + 1;
        let head: [String; 3] = std::array::from_fn(|i| match (planar, i) {
            (true, 2) => "0".into(),
            _ => format!("h{number}_{}", i + 1),
        });
        let tip = match &leg.kind {
            LegKind::Strut { .. } => continue,
            LegKind::Crank { .. } => {
                let (c, s) = (format!("c{number}"), format!("s{number}"));
                equations.groups.push(vec![c.clone(), s.clone()]);
                equations.equations.push(format!("{c}^2+{s}^2-1"));
                crank_tip(leg, &c, &s)
            }
            LegKind::Slider { origin, .. } => {
                let name = format!("s{number}");
                equations.groups.push(vec![name.clone()]);
                let along = slide_direction(leg);
                std::array::from_fn(|i| {
                    let shift = text::times(&double_expression(along[i]), &name);
                    text::sum(&[origin[i].expression(), shift])
                })
            }
        };
        let parameters = head.iter().filter(|h| *h != "0").cloned();
        equations.parameters.extend(parameters);
        let equation = match &leg.kind {
            // |tip - center|^2 is the square of the crank: linear in cosine and sine.
            LegKind::Crank {
                center,
                length,
                rod,
                ..
            } => {
                let center = text::vector(center);
                let arm: [String; 3] = std::array::from_fn(|i| text::minus(&tip[i], &center[i]));
                let away: [String; 3] = std::array::from_fn(|i| text::minus(&center[i], &head[i]));
                format!(
                    "2*{}+{}+{}^2-{}^2",
                    text::dot(&arm, &away),
                    text::dot(&away, &away),
                    length.expression(),
                    rod.expression()
                )
            }
            LegKind::Slider { rod, .. } => {
                let away: [String; 3] = std::array::from_fn(|i| text::minus(&tip[i], &head[i]));
                format!("{}-{}^2", text::dot(&away, &away), rod.expression())
            }
            LegKind::Strut { .. } => continue,
        };
        equations.equations.push(equation);
    }
    let loops = equations.groups.len() as u32;
    let words: Vec<&str> = platform.legs.iter().map(|l| l.word.as_str()).collect();
    let same = words.iter().all(|w| *w == words[0]);
    Ok(Box::new(Inverse {
        platform: platform.clone(),
        family: Family {
            name: format!(
                "{}-{}",
                words.len(),
                if same {
                    words[0].to_owned()
                } else {
                    words.join("+")
                }
            ),
            expected: 2u64.checked_pow(loops),
            source: "two ways for every crank or slider",
            representation: if loops == 0 {
                "none: closed form"
            } else {
                "cosine and sine of every crank, a group each"
            },
        },
        planar,
        equations: (loops > 0).then_some(equations),
    }))
}

struct Inverse {
    platform: Platform,
    family: Family,
    planar: bool,
    equations: Option<Equations>,
}

impl Inverse {
    fn heads(&self, pose: &Pose) -> Vec<Vector3> {
        let place = |leg: &Leg| {
            let to = [leg.to[0].to_f64(), leg.to[1].to_f64(), leg.to[2].to_f64()];
            pose.point(to.map(Complex64::from))
        };
        self.platform.legs.iter().map(place).collect()
    }

    /// Values of all legs for heads at these places, and the largest error of a rod.
    fn values(
        &self,
        heads: &[Vector3],
        mut point: &[Complex64],
    ) -> (Vec<(Arc<str>, JointValue)>, f64) {
        let mut next = || match point.split_first() {
            Some((first, rest)) => {
                point = rest;
                *first
            }
            None => Complex64::default(),
        };
        let size = size(&self.platform);
        let (mut values, mut most) = (Vec::new(), 0.0f64);
        for (leg, head) in self.platform.legs.iter().zip(heads) {
            let real = |v: &crate::mechanism::Vector| [v[0].to_f64(), v[1].to_f64(), v[2].to_f64()];
            let (value, tip, rod): (JointValue, Vector3, f64) = match &leg.kind {
                LegKind::Strut { from, .. } => {
                    let from = real(from);
                    let away: Vector3 = std::array::from_fn(|i| head[i] - from[i]);
                    let square: f64 = away.iter().map(|c| c.re * c.re).sum();
                    values.push((
                        leg.name.as_str().into(),
                        JointValue::Shift(square.sqrt().into()),
                    ));
                    continue;
                }
                LegKind::Crank {
                    center,
                    length,
                    rod,
                    ..
                } => {
                    let (c, s) = (next(), next());
                    let (along, aside) = crank_frame(leg);
                    let center = real(center);
                    let reach = length.to_f64();
                    let tip =
                        std::array::from_fn(|i| (c * along[i] + s * aside[i]) * reach + center[i]);
                    most = most
                        .max(modulus(c * c + s * s - 1.0) / (1.0 + c.norm_sqr() + s.norm_sqr()));
                    (JointValue::Turn(c, s), tip, rod.to_f64())
                }
                LegKind::Slider { origin, rod, .. } => {
                    let shift = next();
                    let (origin, along) = (real(origin), slide_direction(leg));
                    let tip = std::array::from_fn(|i| shift * along[i] + origin[i]);
                    (JointValue::Shift(shift), tip, rod.to_f64())
                }
            };
            let away: Vector3 = std::array::from_fn(|i| head[i] - tip[i]);
            let square: Complex64 = away.iter().map(|c| c * c).sum();
            let scale: f64 = away.iter().map(|c| c.norm_sqr()).sum::<f64>() + size * size;
            most = most.max(modulus(square - rod * rod) / scale);
            values.push((leg.name.as_str().into(), value));
        }
        (values, most)
    }
}

impl Formulation for Inverse {
    fn family(&self) -> &Family {
        &self.family
    }

    fn inputs(&self) -> &[String] {
        &[]
    }

    fn equations(&self) -> Option<&Equations> {
        self.equations.as_ref()
    }

    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        let pose = &self.platform.body(target.pose()?);
        let coordinates = if self.planar { 2 } else { 3 };
        let legs = self.platform.legs.iter().zip(self.heads(pose));
        let solved = legs.filter(|(leg, _)| !matches!(leg.kind, LegKind::Strut { .. }));
        Ok(solved
            .flat_map(|(_, head)| head.into_iter().take(coordinates))
            .collect())
    }

    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        let size = size(&self.platform);
        let count = self.equations.as_ref()?.parameters.len();
        Some((0..count).map(|_| draw() * size).collect())
    }

    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted {
        let Some(Target::Pose(output)) = target else {
            // Heads anywhere: those of solved legs in order, others do not matter.
            let coordinates = if self.planar { 2 } else { 3 };
            let mut chunks = parameters.chunks(coordinates);
            let heads: Vec<Vector3> = self
                .platform
                .legs
                .iter()
                .map(|leg| {
                    let mut head = [Complex64::default(); 3];
                    if !matches!(leg.kind, LegKind::Strut { .. })
                        && let Some(chunk) = chunks.next()
                    {
                        head[..chunk.len()].copy_from_slice(chunk);
                    }
                    head
                })
                .collect();
            let (values, residual) = self.values(&heads, point);
            return Lifted::Position(Box::new(Configuration {
                values,
                output: None,
                bodies: Vec::new(),
                residual,
            }));
        };
        let pose = self.platform.body(output);
        let (values, residual) = self.values(&self.heads(&pose), point);
        Lifted::Position(Box::new(Configuration {
            values,
            output: Some(*output),
            bodies: vec![(PLATFORM.into(), pose)],
            residual,
        }))
    }

    fn direct(&self, target: &Target) -> Vec<Configuration> {
        match self.lift(Some(target), &[], &[]) {
            Lifted::Position(position) => vec![*position],
            Lifted::Degenerate(_) | Lifted::Moving(_) => Vec::new(),
        }
    }
}

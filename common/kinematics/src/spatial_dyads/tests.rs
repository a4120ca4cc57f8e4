//! Chains that made the poses are solutions; positions of simulated spherical four-bars have the grade of the simulation.

use super::spherical::linkage;
use super::{
    Chain, Part, Reading, SpatialDyad, SpatialPoseFault, SpatialPoses, Vector, minus, plus,
};
use crate::assessment::Grade;
use crate::mechanism::pose::{Pose, cross, dot, unit};
use crate::test_linkages::residual;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

fn vector(random: &mut RandomStream) -> Vector {
    std::array::from_fn(|_| 2.0 * random.uniform() - 1.0)
}

fn direction(random: &mut RandomStream) -> Vector {
    unit(vector(random)).expect("not 0")
}

/// A turn about a line, by twice the angle with this half-tangent, and a slide along it.
fn screw(point: Vector, axis: Vector, half_tangent: f64, slide: f64) -> Pose {
    let [x, y, z] = axis.map(|c| Complex64::from(c * half_tangent));
    let turn =
        Pose::of_quaternion([1.0.into(), x, y, z], [Complex64::default(); 3]).expect("a turn");
    let turned = turn.rotation.map(|row| dot(row.map(|z| z.re), point));
    let shift: Vector = std::array::from_fn(|k| point[k] - turned[k] + axis[k] * slide);
    Pose {
        position: shift.map(Complex64::from),
        ..turn
    }
}

fn placed(pose: &Pose, x: Vector) -> Vector {
    plus(rotated(pose, x), pose.position.map(|z| z.re))
}

fn rotated(pose: &Pose, x: Vector) -> Vector {
    pose.rotation.map(|row| dot(row.map(|z| z.re), x))
}

/// Poses that a chain of these parts makes: points, or a point and a direction each, in the first pose.
fn made_by(
    chain: Chain,
    [fixed, moving]: [[Vector; 2]; 2],
    random: &mut RandomStream,
) -> Vec<Pose> {
    // The body's first pose is no identity.
    let first = screw(
        vector(random),
        direction(random),
        random.uniform(),
        random.uniform(),
    );
    let length = minus(moving[0], fixed[0]);
    let displacement = |random: &mut RandomStream| match chain {
        Chain::Cylinders | Chain::SphericalHinges => {
            let [mut of_fixed, mut of_moving] = [fixed, moving].map(|[point, axis]| {
                let [tangent, slide] = [0, 1].map(|_| 2.0 * random.uniform() - 1.0);
                screw(point, axis, tangent, slide)
            });
            if chain == Chain::SphericalHinges {
                of_fixed.position = [Complex64::default(); 3];
                of_moving.position = [Complex64::default(); 3];
            }
            of_fixed.then(&of_moving)
        }
        _ => {
            let turn = screw([0.0; 3], direction(random), random.uniform(), 0.0);
            let [centre, axis] = fixed;
            // A turn and a slide about the axis keep a cylinder; a turn and a slide along a ruling keep a hyperboloid.
            let goal = match chain {
                Chain::BallBall => {
                    let size = dot(length, length).sqrt();
                    plus(centre, direction(random).map(|c| c * size))
                }
                Chain::PlaneBall => plus(moving[0], cross(axis, vector(random))),
                Chain::CylinderBall => {
                    let turn = screw(centre, axis, random.uniform() - 0.5, random.uniform());
                    placed(&turn, moving[0])
                }
                _ => {
                    let turn = screw(centre, axis, random.uniform() - 0.5, 0.0);
                    let slide = random.uniform() - 0.5;
                    let along = moving[1].map(|c| c * slide);
                    placed(&turn, plus(moving[0], along))
                }
            };
            let shift = minus(goal, rotated(&turn, moving[0]));
            Pose {
                position: shift.map(Complex64::from),
                ..turn
            }
        }
    };
    let count = chain.poses();
    let displacements = (0..count).map(|k| match k {
        0 => Pose::IDENTITY,
        _ => displacement(random),
    });
    displacements.map(|d| d.then(&first)).collect()
}

#[test]
fn a_chain_that_made_the_poses_is_a_solution() {
    for chain in [
        Chain::BallBall,
        Chain::PlaneBall,
        Chain::Cylinders,
        Chain::SphericalHinges,
        Chain::CylinderBall,
        Chain::HingeSliderBall,
    ] {
        for seed in 0..20 {
            let mut random = RandomStream::new(seed, Purpose::Test, 4);
            let parts = [0, 1].map(|_| [vector(&mut random), direction(&mut random)]);
            let poses = made_by(chain, parts, &mut random);
            let poses = SpatialPoses::new(chain, &poses).expect("poses");
            let inside = |x: Vector| {
                let shifted = minus(x, poses.origin);
                shifted.map(|c| Complex64::from(c / poses.scale))
            };
            let [fixed, moving] = parts;
            let factor = random.unit();
            let axis = |x: Vector| x.map(|c| factor * c);
            let ball = inside(moving[0]);
            let groups = match chain {
                Chain::BallBall => vec![inside(fixed[0]), ball],
                Chain::PlaneBall => vec![axis(fixed[1]), ball],
                Chain::Cylinders | Chain::SphericalHinges => vec![axis(fixed[1]), axis(moving[1])],
                Chain::CylinderBall => {
                    let point = inside(fixed[0]).map(|z| z.re);
                    let along = dot(point, fixed[1]);
                    let nearest = minus(point, fixed[1].map(|c| c * along));
                    vec![axis(fixed[1]), nearest.map(Complex64::from), ball]
                }
                Chain::HingeSliderBall => {
                    // The hyperboloid of a ruling about the axis: |x - c|^2 - (m.(x - c))^2 = constant.
                    let ruling = Ruling::new(fixed, moving);
                    let centre = inside(ruling.centre).map(|z| z.re);
                    let m = fixed[1].map(|c| c * (1.0 + ruling.slope * ruling.slope).sqrt());
                    let m = if super::largest_is_negative(m) {
                        m.map(|c| -c)
                    } else {
                        m
                    };
                    let along = dot(m, centre);
                    let e: Vector = std::array::from_fn(|k| 2.0 * (centre[k] - m[k] * along));
                    vec![e.map(Complex64::from), m.map(Complex64::from), ball]
                }
            };
            let solution = groups.concat();
            let left = residual(&poses.system(), &solution, &[]);
            assert!(left < 1e-11, "{chain:?}, seed {seed}: {left:e}");
            let Reading::Chain(dyad) = poses.read(&solution) else {
                panic!("{chain:?}, seed {seed}: no chain");
            };
            assert!(
                dyad.error < 1e-9,
                "{chain:?}, seed {seed}: {:e}",
                dyad.error
            );
            let is_near = |a: Vector, b: Vector| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-8);
            let is_on = |x: Vector, p: Vector, u: Vector| is_near(cross(minus(x, p), u), [0.0; 3]);
            let agrees = |part: Part, [point, axis]: [Vector; 2]| match part {
                Part::Point(x) => is_near(x, point),
                Part::Direction(u) => is_near(cross(u, axis), [0.0; 3]),
                Part::Line(x, u) => is_near(cross(u, axis), [0.0; 3]) && is_on(x, point, u),
                Part::Hyperboloid(x, u, slope) => {
                    let ruling = Ruling::new(fixed, moving);
                    is_near(cross(u, axis), [0.0; 3])
                        && is_near(x, ruling.centre)
                        && (slope - ruling.slope).abs() < 1e-8
                }
                Part::Plane(x, n) => {
                    is_near(cross(n, axis), [0.0; 3]) && dot(n, minus(x, moving[0])).abs() < 1e-8
                }
            };
            assert!(
                agrees(dyad.fixed, fixed) && agrees(dyad.moving, moving),
                "{chain:?}, seed {seed}: {dyad:?} for {parts:?}"
            );
        }
    }
}

/// The hyperboloid that a line makes about an axis: the axis' point that is nearest to the line, and the tangent of their angle.
struct Ruling {
    centre: Vector,
    slope: f64,
}

impl Ruling {
    fn new([point, axis]: [Vector; 2], [through, ruling]: [Vector; 2]) -> Self {
        let normal = cross(axis, ruling);
        let away = minus(through, point);
        // The lines' common normal meets the axis where the rest of the way is along the ruling and the normal.
        let along = dot(cross(away, ruling), normal) / dot(normal, normal);
        Self {
            centre: plus(point, axis.map(|c| c * along)),
            slope: dot(normal, normal).sqrt() / dot(axis, ruling).abs(),
        }
    }
}

#[test]
fn bad_poses_in_space_are_named() {
    let mut random = RandomStream::new(1, Purpose::Test, 5);
    let parts = [0, 1].map(|_| [vector(&mut random), direction(&mut random)]);
    let poses = made_by(Chain::BallBall, parts, &mut random);
    let fault = |chain, poses: &[Pose]| SpatialPoses::new(chain, poses).expect_err("not right");
    let count = SpatialPoseFault::Count {
        expected: 6,
        given: 7,
    };
    assert_eq!(fault(Chain::PlaneBall, &poses), count);
    let mut twice = poses.clone();
    twice[4] = twice[1];
    assert_eq!(fault(Chain::BallBall, &twice), SpatialPoseFault::Same(1, 4));
    let straight: Vec<Pose> = (0..7)
        .map(|k| Pose::shift(f64::from(k), 0.0, 0.0))
        .collect();
    assert_eq!(fault(Chain::BallBall, &straight), SpatialPoseFault::OneAxis);
    let axis = direction(&mut random);
    let about_one: Vec<Pose> = (0..7)
        .map(|k| {
            screw(
                vector(&mut random),
                axis,
                0.1 * f64::from(k),
                random.uniform(),
            )
        })
        .collect();
    for chain in [
        Chain::BallBall,
        Chain::PlaneBall,
        Chain::Cylinders,
        Chain::SphericalHinges,
    ] {
        let poses = &about_one[..chain.poses()];
        assert_eq!(fault(chain, poses), SpatialPoseFault::OneAxis, "{chain:?}");
    }
    // A point of the body stays, which need not be its origin.
    let still: Vec<Pose> = poses
        .iter()
        .map(|pose| Pose {
            position: [Complex64::default(); 3],
            ..*pose
        })
        .collect();
    let away = Pose::shift(0.3, -2.0, 1.0);
    let off: Vec<Pose> = still.iter().map(|pose| pose.then(&away)).collect();
    for poses in [&still, &off] {
        assert_eq!(fault(Chain::BallBall, poses), SpatialPoseFault::FixedPoint);
        let six = &poses[..6];
        assert_eq!(fault(Chain::PlaneBall, six), SpatialPoseFault::FixedPoint);
        // The lines of cylinder joints meet there, and a sphere about it has its hinges.
        assert!(SpatialPoses::new(Chain::Cylinders, &poses[..5]).is_ok());
        assert!(SpatialPoses::new(Chain::SphericalHinges, &poses[..5]).is_ok());
    }
    let mut turned_alike = poses[..5].to_vec();
    turned_alike[3].rotation = turned_alike[1].rotation;
    let expected = SpatialPoseFault::SameRotation(1, 3);
    assert_eq!(fault(Chain::Cylinders, &turned_alike), expected);
    turned_alike.extend([poses[5], poses[6]]);
    assert!(SpatialPoses::new(Chain::BallBall, &turned_alike).is_ok());
}

/// A spherical four-bar: pivots and joints.
struct Simulated {
    pivots: [Vector; 2],
    joints: [Vector; 2],
}

impl Simulated {
    /// The joints where the driver has turned from its first position; `None` where the links do not meet.
    fn at(&self, turn: Complex64, side: bool) -> Option<[Vector; 2]> {
        let ([a, other], [b, far]) = (self.pivots, self.joints);
        let along = a.map(|c| c * dot(a, b));
        let across = minus(b, along);
        let third = cross(a, across);
        let near: Vector =
            std::array::from_fn(|k| along[k] + turn.re * across[k] + turn.im * third[k]);
        // The point with these cosines to two directions.
        let (to_near, to_other, between) = (dot(b, far), dot(other, far), dot(near, other));
        let determinant = 1.0 - between * between;
        let x = (to_near - between * to_other) / determinant;
        let y = (to_other - between * to_near) / determinant;
        let square = (1.0 - x * x - y * y - 2.0 * x * y * between) / determinant;
        let z = if side { square.sqrt() } else { -square.sqrt() };
        let normal = cross(near, other);
        let end = std::array::from_fn(|k| x * near[k] + y * other[k] + z * normal[k]);
        (!square.is_nan() && square > 0.0).then_some([near, end])
    }

    /// Whether the driver goes from one angle to another without an end between, one way or the other. In parts of a turn.
    fn joins(&self, from: f64, to: f64) -> bool {
        let is_free = |by: f64| {
            let at = |k: u32| from + by * f64::from(k) / 2000.0;
            (0..=2000).all(|k| self.at(turn(at(k)), true).is_some())
        };
        let forward = (to - from).rem_euclid(1.0);
        is_free(forward) || is_free(forward - 1.0)
    }
}

/// A direction by its part of a turn.
fn turn(part: f64) -> Complex64 {
    crate::plane::direction(part * 360.0)
}

/// The pose that takes two directions to two others.
fn pose_of([a, b]: [Vector; 2], [near, far]: [Vector; 2]) -> Pose {
    let frame = |x: Vector, y: Vector| {
        let normal = unit(cross(x, y)).expect("not parallel");
        [x, normal, cross(x, normal)]
    };
    let (from, to) = (frame(a, b), frame(near, far));
    let entry = |i: usize, j: usize| (0..3).map(|k| to[k][i] * from[k][j]).sum();
    Pose::real(
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
        [0.0; 3],
    )
}

#[test]
fn grades_of_spherical_linkages_are_those_of_a_simulation() {
    let mut seen = std::collections::BTreeMap::new();
    for seed in 0..600 {
        let mut random = RandomStream::new(seed, Purpose::Test, 6);
        let simulated = Simulated {
            pivots: [0, 1].map(|_| direction(&mut random)),
            joints: [0, 1].map(|_| direction(&mut random)),
        };
        let side = |random: &mut RandomStream| match seed % 3 {
            0 => random.bits() & 1 == 1,
            _ => true,
        };
        // A third of the seeds turns one way.
        let mut parts: Vec<f64> = (0..200).map(|_| random.uniform()).collect();
        parts.retain(|part| simulated.at(turn(*part), true).is_some());
        parts.truncate(5);
        if parts.len() < 5 {
            continue;
        }
        if seed % 3 == 2 {
            parts.sort_by(f64::total_cmp);
        }
        let sides: Vec<bool> = parts.iter().map(|_| side(&mut random)).collect();
        let positions = parts.iter().zip(&sides);
        let positions: Vec<[Vector; 2]> = positions
            .filter_map(|(part, side)| simulated.at(turn(*part), *side))
            .collect();
        let poses: Vec<Pose> = positions
            .iter()
            .map(|joints| pose_of(positions[0], *joints))
            .collect();
        let poses = SpatialPoses::new(Chain::SphericalHinges, &poses).expect("poses");
        let [one, two] = [0, 1].map(|k| SpatialDyad {
            fixed: Part::Direction(simulated.pivots[k]),
            moving: Part::Direction(positions[0][k]),
            distance: None,
            angle: None,
            error: 0.0,
        });
        let made = linkage(&poses, [0, 1], [&one, &two]).expect("a linkage");
        let one_side = sides.iter().all(|side| *side == sides[0]);
        let joined = parts.iter().all(|part| simulated.joins(parts[0], *part));
        let turns_round = (0..2000).all(|k| {
            let part = f64::from(k) / 2000.0;
            simulated.at(turn(part), true).is_some()
        });
        let expected = match (joined, one_side) {
            (true, true) => [Grade::InOrder, Grade::OneBranch],
            (true, false) if !turns_round => [Grade::OneCircuit; 2],
            _ => [Grade::TwoCircuits; 2],
        };
        assert!(
            expected.contains(&made.grade),
            "seed {seed}: {made:?}, {expected:?}"
        );
        if seed % 3 == 2 && joined && turns_round {
            assert_eq!(made.grade, Grade::InOrder, "seed {seed}");
        }
        let is_crank = ["double-crank", "crank-rocker"].contains(&made.kind);
        assert_eq!(is_crank, turns_round, "seed {seed}: {made:?}");
        *seen.entry((made.grade, made.kind)).or_insert(0) += 1;
    }
    let grades: std::collections::BTreeSet<Grade> = seen.keys().map(|(grade, _)| *grade).collect();
    let kinds: std::collections::BTreeSet<&str> = seen.keys().map(|(_, kind)| *kind).collect();
    assert_eq!((grades.len(), kinds.len()), (4, 5), "{seen:?}");
}

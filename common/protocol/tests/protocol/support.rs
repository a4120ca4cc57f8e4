//! Random checked values, pure functions of a seed, for the tests of this folder.
#![allow(dead_code)]

use cognate_continuation::bend::{Bend, Number};
use cognate_continuation::certification::{Certificate, Certification, Uncertified};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::{ItemResult, PointResult};
use cognate_continuation::path_result::{
    AskedFit, BoundaryKey, Coordinates, Counts, LocalDimension, MovedSlice, PathIndex, PathResult,
};
use cognate_continuation::sharpening::{Sharpened, Sharpening, Unsharpened};
use cognate_continuation::start_points::{Digest, StartPoints, StoredPoints};
use cognate_continuation::start_systems::exchange::Exchange;
use cognate_continuation::start_systems::polyhedral::branches::{BranchCount, CountedCells};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::tracker::settings::{Preset, Settings};
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_protocol::submission::*;
use cognate_solutions::closing_options::ClosingOptions;
use cognate_systems::expression::{Dependence, Expressions, Function, Node, NodeId};
use cognate_systems::helper_unknown::{AngleUnit, AngleUnknowns, Branch, Helper, RootUnknown};
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, System, VariableGroup};
use num_complex::Complex64;

/// Draws values.
pub struct Draw(RandomStream);

impl Draw {
    /// From this seed.
    pub fn new(seed: u64) -> Self {
        Self(RandomStream::new(seed, Purpose::Test, 0))
    }

    /// Below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.below(n as u64) as usize
    }

    fn index(&mut self, n: usize) -> u32 {
        self.below(n) as u32
    }

    fn coin(&mut self) -> bool {
        self.below(2) == 0
    }

    fn many<T>(&mut self, most: usize, mut one: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..self.below(most + 1)).map(|_| one(self)).collect()
    }

    fn some<T>(&mut self, one: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.coin().then(|| one(self))
    }

    fn number(&mut self) -> f64 {
        // Signs, zeros, tiny and huge numbers.
        match self.below(6) {
            0 => 0.0,
            1 => -0.0,
            2 => f64::MIN_POSITIVE * self.0.uniform(),
            3 => f64::MAX * self.0.uniform(),
            _ => 2.0 * self.0.uniform() - 1.0,
        }
    }

    fn complex(&mut self) -> Complex64 {
        Complex64::new(self.number(), self.number())
    }

    pub fn digest(&mut self) -> Digest {
        Digest(std::array::from_fn(|_| self.0.bits() as u8))
    }

    fn rational(&mut self) -> Rational {
        let numerator = self.0.bits() as i64 >> self.below(63);
        let denominator = (self.0.bits() >> self.below(63)).max(1);
        Rational::from((numerator, denominator))
    }

    fn node(&mut self, e: &mut Expressions, variables: usize, parameters: usize) -> NodeId {
        let count = e.nodes().len();
        let any = |draw: &mut Self| NodeId(draw.index(count));
        let constants: Vec<NodeId> = (0..count as u32)
            .map(NodeId)
            .filter(|&id| e.dependence(id) == Dependence::Constant)
            .collect();
        let node = match self.below(13) {
            0 if parameters > 0 => Node::Parameter(self.index(parameters)),
            1 => Node::Variable(self.index(variables)),
            2 => Node::Add(any(self), any(self)),
            3 => Node::Subtract(any(self), any(self)),
            4 => Node::Multiply(any(self), any(self)),
            5 => {
                let below = any(self);
                if e.dependence(below) == Dependence::Variables
                    || e.as_constant(below).is_some_and(ComplexRational::is_zero)
                {
                    Node::Negate(below)
                } else {
                    Node::Divide(any(self), below)
                }
            }
            6 => Node::Negate(any(self)),
            7 => Node::Power(any(self), 2 + self.index(2)),
            8 if !constants.is_empty() => {
                let base = constants[self.below(constants.len())];
                Node::Root(base, Rational::from((1 + self.below(9), 2u32)))
            }
            9 if !constants.is_empty() => {
                let function = [
                    Function::SquareRoot,
                    Function::Exponential,
                    Function::Logarithm,
                    Function::Sine,
                    Function::Cosine,
                    Function::Tangent,
                ][self.below(6)];
                Node::Function(function, constants[self.below(constants.len())])
            }
            10 => {
                let zero = e.integer(0);
                Node::Function(Function::Pi, zero)
            }
            _ => Node::Constant(ComplexRational::new(self.rational(), self.rational())),
        };
        e.insert(node)
    }

    /// A system that passes its own check.
    pub fn system(&mut self) -> System {
        let (n, p) = (1 + self.below(4), self.below(3));
        let mut expressions = Expressions::new();
        let first = expressions.variable(0);
        for _ in 0..self.below(12) {
            self.node(&mut expressions, n, p);
        }
        let candidates: Vec<NodeId> = (0..expressions.nodes().len() as u32)
            .map(NodeId)
            .filter(|&id| expressions.dependence(id) == Dependence::Variables)
            .collect();
        let any = |draw: &mut Self| NodeId(draw.index(expressions.nodes().len()));
        let mut equations = self.many(3, |draw| candidates[draw.below(candidates.len())]);
        equations.push(first);
        let mut groups: Vec<VariableGroup> = (0..n)
            .map(|v| VariableGroup {
                variables: vec![v],
                homogeneous: false,
            })
            .collect();
        if self.coin() && n > 1 {
            let last = groups.pop().expect("there is one for each variable");
            groups[0].variables.extend(last.variables);
            groups[0].homogeneous = self.coin();
        }
        let degenerate = self.many(2, |draw| {
            let set = if draw.coin() {
                DegenerateSet::Nonzero(any(draw))
            } else {
                DegenerateSet::Equations(vec![any(draw), any(draw)])
            };
            (format!("set {}", draw.below(100)), set)
        });
        let symmetry = self.many(2, |draw| {
            if draw.coin() {
                let shift = draw.below(n);
                SymmetryGenerator::Permutation((0..n).map(|v| (v + shift) % n).collect())
            } else {
                SymmetryGenerator::Map((0..n).map(|_| any(draw)).collect())
            }
        });
        let system = System {
            variables: (0..n).map(|v| format!("x{v}")).collect(),
            parameters: (0..p).map(|v| format!("π{v}")).collect(),
            groups,
            equation_names: (0..equations.len()).map(|i| format!("f{i}")).collect(),
            equations,
            path_variable: (p > 0 && self.coin()).then(|| self.below(p)),
            conjugates: {
                let mut free = vec![true; n];
                let mut pairs = self.many(2, |draw| (draw.below(n), draw.below(n)));
                pairs.retain(|&(a, b)| {
                    let fits = a != b && free[a] && free[b];
                    free[a] &= !fits;
                    free[b] &= !fits;
                    fits
                });
                pairs
            },
            degenerate: degenerate.into_iter().collect(),
            symmetry,
            expressions,
            scaling: Default::default(),
            helpers: Vec::new(),
        };
        system.check().expect("the generator makes checked systems");
        system
    }

    /// A system with a root or an angle among its variables.
    pub fn system_with_helpers(&mut self) -> System {
        let mut system = self.system();
        let n = system.variables.len();
        let helper = match self.coin() && n > 1 {
            true => Helper::Angle(AngleUnknowns {
                name: "angle".into(),
                cosine: 0,
                sine: 1,
                unit: AngleUnit {
                    denominator: 1 + self.below(3) as u32,
                    pi_power: self.below(2) as i32,
                },
            }),
            false => Helper::Root(RootUnknown {
                variable: self.below(n),
                degree: 3,
                radicand: NodeId(self.index(system.expressions.nodes().len())),
                branch: match self.coin() {
                    true => Branch::Real,
                    false => Branch::Principal,
                },
            }),
        };
        system.helpers.push(helper);
        system.check().expect("the generator makes checked systems");
        system
    }

    /// Options that are in range.
    pub fn options(&mut self) -> Options {
        let length = self.below(3);
        let dimension = 1 + self.below(3);
        let count = self.below(4);
        Options {
            start: [
                StartKind::Auto,
                StartKind::TotalDegree,
                StartKind::Multihomogeneous,
                StartKind::Given,
                StartKind::Monodromy,
                StartKind::Polyhedral,
                StartKind::LinearProduct,
                StartKind::Regeneration,
            ][self.below(8)],
            groups: self.some(|draw| {
                vec![
                    vec!["x".to_owned()],
                    draw.many(3, |_| "long name".to_owned()),
                ]
            }),
            conjugates: self.many(2, |_| ("p".to_owned(), "P".to_owned())),
            seed: self.some(|draw| draw.0.bits()),
            settings: SettingsChoice {
                preset: self.some(|_| Preset::Fast),
                tolerance: self.some(|_| 1e-9),
                max_steps: self.some(|draw| 1 + draw.index(1000)),
                ..SettingsChoice::default()
            },
            precision: [
                PrecisionChoice::Adaptive,
                PrecisionChoice::Double,
                PrecisionChoice::Bits(53 + self.index(1000)),
            ][self.below(3)],
            start_parameters: (0..length).map(|_| self.complex()).collect(),
            target_parameters: self.many(3, |draw| (0..length).map(|_| draw.complex()).collect()),
            start_solutions: self.some(|draw| {
                if draw.coin() {
                    StartSolutions::Object(draw.digest())
                } else {
                    StartSolutions::Points(StoredPoints {
                        dimension,
                        coordinates: (0..dimension * count).map(|_| draw.complex()).collect(),
                    })
                }
            }),
            name: "a name".to_owned(),
            // Drawn from nothing, so that the other draws stay what they were.
            idle_loops: Some(count as u32).filter(|&n| n > 1),
            expected_solutions: Some(length as u64).filter(|&n| n > 0),
            closings: ClosingOptions {
                certify: length > 1,
                digits: (count > 1).then_some(50),
                deflate: length > 2,
                no_exact_count: length == 2,
                approximate: length == 3,
            },
            trace_test: length == 1,
            confidence: (count > 1).then_some(0.999),
            warnings: Vec::new(),
            sets: (count > 2).then(|| vec![vec![vec![0, 1], vec![1]], vec![vec![0]]]),
            decompose: None,
            question: None,
        }
    }

    /// Written out, so that a new default is no change of the wire.
    fn settings(&mut self) -> Settings {
        Settings {
            tolerance: 1e-10,
            predictor_tolerance: 1e-4,
            max_step: 0.1,
            reach: 0.0,
            min_step: 1e-13,
            max_steps: 20_000,
            endgame_boundary: 0.1,
            endgame_radius: 1e-3,
            endgame_min_radius: 1e-14,
            max_winding_number: 32,
            singular_condition: 1e8,
            endgame_tolerance: 1e-8,
            data_accuracy: 0.0,
            exact_data: false,
            max_endgame_bits: u32::MAX,
            precision_bits: [53, 106, 212][self.below(3)],
            max_precision_bits: [53, 1024][self.below(2)],
        }
    }

    /// A stage of a kind that came later; the golden files are drawn from those before.
    pub fn later_stage(&mut self) -> Stage {
        let parameters = vec![self.complex()];
        let (order, level) = (vec![1, 0], 1);
        Stage {
            homotopy: match self.below(3) {
                0 => HomotopyKind::MoveSlice {
                    parameters,
                    order,
                    level,
                    forms: 1 + self.index(3),
                },
                1 => HomotopyKind::Sections {
                    direction: vec![self.complex()],
                    parameters,
                    start: vec![self.complex(), self.complex()],
                    target: vec![self.complex(), self.complex()],
                },
                _ => HomotopyKind::ProductToEquation {
                    parameters,
                    order,
                    level,
                },
            },
            start_points: StartPoints::LinearProduct {
                sets: vec![vec![vec![0, 1], vec![1]], vec![Vec::new()]],
                count: 3,
            },
            ..self.stage()
        }
    }

    /// A stage that passes the checks.
    pub fn stage(&mut self) -> Stage {
        let base = match self.below(4) {
            3 => StartPoints::MixedCells {
                count: 1000,
                branches: None,
            },
            0 => StartPoints::TotalDegree {
                degrees: vec![2, 3, 1 + self.index(9)],
            },
            1 => StartPoints::Multihomogeneous {
                degrees: vec![vec![1, 0], vec![1, 2], vec![0, 3]],
                dimensions: vec![2, 1],
                exchange: Some(Exchange {
                    variables: vec![1, 0, 2],
                    equations: vec![0, 2, 1],
                    groups: vec![1, 0],
                }),
            },
            _ => StartPoints::Stored {
                object: self.digest(),
                count: 1000,
            },
        };
        let length = self.below(3);
        let values =
            |draw: &mut Self| -> Vec<Complex64> { (0..length).map(|_| draw.complex()).collect() };
        Stage {
            id: StageId(self.index(5)),
            system: None,
            work: Work::Track,
            homotopy: match self.below(5) {
                3 => HomotopyKind::Toric,
                4 => HomotopyKind::Generic {
                    parameters: values(self),
                },
                0 => HomotopyKind::StraightLine {
                    parameters: values(self),
                },
                1 => HomotopyKind::PathVariable {
                    parameters: values(self),
                },
                _ => HomotopyKind::Parameter {
                    start: values(self),
                    targets: vec![values(self), values(self)],
                },
            },
            start_points: if self.coin() {
                StartPoints::Selected {
                    base: Box::new(base),
                    indices: vec![0, 3, 4],
                }
            } else {
                base
            },
            settings: self.settings(),
            seed: self.0.bits(),
            attempt: self.below(4) as u16,
        }
    }

    fn certification(&mut self) -> Certification {
        if self.coin() {
            let reasons = [
                Uncertified::DamagedPoint,
                Uncertified::NoEnclosure,
                Uncertified::NewtonLeaves,
                Uncertified::Singular,
                Uncertified::NoContraction,
            ];
            return Certification::Uncertified(reasons[self.below(reasons.len())]);
        }
        let exact = |x: f64| Rational::from_f64(x).expect("a finite number");
        let centre = self.many(3, |draw| {
            ComplexRational::new(exact(draw.number()), exact(draw.number()))
        });
        Certification::Certified(Box::new(Certificate {
            radius: centre.iter().map(|_| 1e-9).collect(),
            error: centre.iter().map(|_| 1e-13).collect(),
            centre,
            contraction: 0.125,
            precision_bits: 128,
        }))
    }

    fn sharpening(&mut self) -> Sharpening {
        let exact = |x: f64| Rational::from_f64(x).expect("a finite number");
        if self.coin() {
            let reasons = [
                Unsharpened::DamagedPoint,
                Unsharpened::NotRegular,
                Unsharpened::NewtonLeaves,
            ];
            return Sharpening::Unsharpened(reasons[self.below(reasons.len())]);
        }
        Sharpening::Sharpened(Box::new(Sharpened {
            values: self.many(3, |draw| {
                let tail = exact(draw.number()) >> 200;
                ComplexRational::new(exact(draw.number()) + tail, exact(draw.number()))
            }),
            accuracy: 1e-30,
            deflations: self.index(4),
            precision_bits: 338,
        }))
    }

    fn local_dimension(&mut self) -> LocalDimension {
        LocalDimension {
            dual_dimensions: self.many(5, |draw| 1 + draw.index(9)),
            bound: self.0.bits(),
            margin: self.number().abs(),
            moved_slices: self.many(3, |draw| MovedSlice {
                distance: draw.number().abs(),
                residual: draw.number().abs(),
                reached: draw.number().abs(),
            }),
        }
    }

    fn branch_count(&mut self) -> BranchCount {
        match self.below(3) {
            0 => BranchCount::Tie,
            1 => BranchCount::TooLarge,
            _ => BranchCount::Counted(CountedCells {
                cells: self.0.bits(),
                volume: 7,
                time_exponent: 4,
            }),
        }
    }

    fn bend(&mut self) -> Box<Bend> {
        let third = |sign: f64| {
            let mut third = Number::from_f64((), sign, sign * 1e-3);
            third.mul(&Number::from_f64((), 1.0 / 3.0, 1e-20));
            third
        };
        Box::new(Bend {
            velocity: vec![third(1.0), third(-7.0)],
            acceleration: vec![third(self.number()), third(1e300)],
            error: 1e-30,
        })
    }

    /// Result about a point, with the fact or without it.
    fn point_result<Fact>(&mut self, fact: impl FnOnce(&mut Self) -> Fact) -> PointResult<Fact> {
        let mut point = self.many(3, Self::complex);
        point.push(self.complex());
        let fact = self.some(|_| ()).map(|()| fact(self));
        PointResult {
            residual: self.number().abs(),
            condition: if self.coin() { f64::INFINITY } else { 1e3 },
            accuracy: self.number().abs(),
            precision_bits: 106,
            ..PointResult::new(
                PathIndex(self.0.bits()),
                self.below(65_536) as u16,
                point,
                fact,
            )
        }
    }

    /// A result of each kind of work, and of each an item that ended its workers.
    pub fn item_results(&mut self) -> Vec<(Work, ItemResult)> {
        let sharpen = Work::Sharpen { digits: 50 };
        let mut results = vec![
            (Work::Track, ItemResult::Track(self.path_result())),
            (
                Work::Certify,
                ItemResult::Certify(self.point_result(Self::certification)),
            ),
            (
                Work::LocalDimension,
                ItemResult::LocalDimension(self.point_result(Self::local_dimension)),
            ),
            (
                sharpen,
                ItemResult::Sharpen(self.point_result(Self::sharpening)),
            ),
            (
                Work::CountMixedCells,
                ItemResult::CountMixedCells(self.point_result(Self::branch_count)),
            ),
            (Work::Bend, ItemResult::Bend(self.point_result(Self::bend))),
        ];
        let killed = |&(work, _): &(Work, ItemResult)| {
            (work, ItemResult::killed_its_worker(work, PathIndex(17), 2))
        };
        let killed: Vec<_> = results.iter().map(killed).collect();
        results.extend(killed);
        results
    }

    /// A result; what is known of a failed path may be NaN.
    pub fn path_result(&mut self) -> PathResult {
        let outcome = match self.below(3) {
            0 => PathOutcome::Regular,
            1 => PathOutcome::Singular,
            _ => PathOutcome::Failed(Failure::ALL[self.below(Failure::ALL.len())]),
        };
        let mut endpoint = self.many(3, Self::complex);
        endpoint.push(self.complex());
        PathResult {
            origin: PathIndex(self.0.bits()),
            attempt: self.below(65_536) as u16,
            outcome,
            endpoint: Coordinates::Double(endpoint),
            t: self.complex(),
            residual: self.number().abs(),
            condition: if self.coin() { f64::INFINITY } else { 1e3 },
            accuracy: self.number().abs(),
            winding_number: self.some(|draw| 1 + draw.index(9)),
            infinity_turns: self.many(3, |draw| draw.0.bits() as i32),
            precision_bits: 53,
            counts: Counts {
                steps: self.0.bits() as u32,
                rejections: self.index(9),
                evaluations: self.index(9),
                exchanges: self.index(9),
                turns: self.index(9),
            },
            asked: self.some(|draw| AskedFit {
                residual: draw.number().abs(),
                correction: draw.number().abs(),
            }),
            local_dimension: None,
            boundary: self.some(|draw| {
                Box::new(BoundaryKey {
                    numbers: std::array::from_fn(|_| draw.number()),
                    margin: draw.number().abs(),
                })
            }),
        }
    }
}

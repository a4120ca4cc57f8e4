//! Involution: complex conjugation with pairs of variables exchanged, and whether it leaves a system as it is.
//!
//! Only then does "real" mean something: the involution maps solutions to
//! solutions, and a real one is a fixed point. Decided on the exact system: the
//! image of each equation must be a combination of the equations, with
//! constant or (in small systems) linear coefficients, which values at random
//! points show (wrongly with a chance of about degree / 2^61, for each of two primes).

use crate::field::{Field, ManyBits, PRIMES, PrimeField, evaluate};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::Node;
use cognate_systems::system::System;
use num_complex::Complex64;
use rug::{Complex, Float};

/// Conjugation composed with an exchange of variables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Involution {
    /// Partner of each variable; a variable without one is its own partner.
    pub partner: Vec<usize>,
}

/// Reason why the solutions of a system cannot be called real or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotInvariant {
    /// A pair names a variable that does not exist, or that has another partner.
    Pairs {
        /// The variable.
        variable: String,
    },
    /// The exchange tears a homogeneous group apart, so that it does not act on points.
    TornGroup {
        /// A variable of the group.
        variable: String,
    },
    /// The image of an equation is no combination of the equations.
    Equation {
        /// Name of the equation.
        equation: String,
        /// True when pairs of conjugates were named.
        pairs: bool,
    },
    /// The equations have no values at random points.
    NoValues,
}

impl std::fmt::Display for NotInvariant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Pairs { variable } => {
                write!(f, "the conjugate pairs give `{variable}` no single partner")
            }
            Self::TornGroup { variable } => write!(
                f,
                "exchanging the conjugate pairs tears the homogeneous group of `{variable}` apart"
            ),
            Self::Equation {
                equation,
                pairs: true,
            } => write!(
                f,
                "the equations are not invariant under conjugation with the named pairs exchanged: \
                 the image of `{equation}` is no combination of them"
            ),
            Self::Equation {
                equation,
                pairs: false,
            } => write!(
                f,
                "the equations are not invariant under complex conjugation: the conjugate of \
                 `{equation}` is no combination of them (variables that are each other's \
                 conjugates at a real solution can be named)"
            ),
            Self::NoValues => write!(f, "the equations have no values at random points"),
        }
    }
}

/// Precision for systems whose constants are not all rational.
const BITS: u32 = 1024;

impl Involution {
    /// The involution that the system names, if the system is invariant under it
    /// with these values of its parameters.
    pub fn of(system: &System, parameters: &[Complex64]) -> Result<Self, NotInvariant> {
        let partner = partners(system)?;
        let involution = Self { partner };
        involution.check_groups(system)?;
        if involution.exchanges_nothing() && is_real(system, parameters) {
            return Ok(involution);
        }
        involution.check_equations(system, parameters)?;
        Ok(involution)
    }

    fn exchanges_nothing(&self) -> bool {
        self.partner.iter().enumerate().all(|(v, &p)| v == p)
    }

    /// The involution's image of a point given by the values of the variables.
    pub fn image(&self, values: &[Complex64]) -> Vec<Complex64> {
        self.partner.iter().map(|&p| values[p].conj()).collect()
    }

    fn check_groups(&self, system: &System) -> Result<(), NotInvariant> {
        let sorted = |variables: &mut dyn Iterator<Item = usize>| {
            let mut members: Vec<usize> = variables.collect();
            members.sort_unstable();
            members
        };
        let homogeneous: Vec<Vec<usize>> = system
            .groups
            .iter()
            .filter(|g| g.homogeneous)
            .map(|g| sorted(&mut g.variables.iter().copied()))
            .collect();
        for group in &homogeneous {
            let image = sorted(&mut group.iter().map(|&v| self.partner[v]));
            if !homogeneous.contains(&image) {
                return Err(NotInvariant::TornGroup {
                    variable: system.variables[group[0]].clone(),
                });
            }
        }
        Ok(())
    }

    fn check_equations(
        &self,
        system: &System,
        parameters: &[Complex64],
    ) -> Result<(), NotInvariant> {
        let exact: Vec<ComplexRational> = parameters
            .iter()
            .map(|p| {
                Some(ComplexRational::new(
                    Rational::from_f64(p.re)?,
                    Rational::from_f64(p.im)?,
                ))
            })
            .collect::<Option<_>>()
            .ok_or(NotInvariant::NoValues)?;
        let mut random = RandomStream::new(0, Purpose::Probe, 1);
        let mut torn = |multipliers| {
            PRIMES
                .iter()
                .map(|&prime| {
                    self.torn_equation_exactly(system, &exact, prime, multipliers, &mut random)
                })
                .collect::<Option<Vec<_>>>()
                .map(|torn| torn.into_iter().flatten().next())
                .or_else(|| {
                    self.torn_equation_with_many_bits(system, &exact, multipliers, &mut random)
                })
                .ok_or(NotInvariant::NoValues)
        };
        let mut first = torn(Multipliers::Constants)?;
        if first.is_some() && Multipliers::Linear.rows(system) <= MOST_ROWS {
            first = torn(Multipliers::Linear)?;
        }
        match first {
            None => Ok(()),
            Some(index) => Err(NotInvariant::Equation {
                equation: system
                    .equation_names
                    .get(index)
                    .cloned()
                    .unwrap_or_else(|| format!("equation {}", index + 1)),
                pairs: !system.conjugates.is_empty(),
            }),
        }
    }

    /// The first equation whose image is no combination, in the integers modulo
    /// a prime; outer `None` where values do not exist there.
    fn torn_equation_exactly(
        &self,
        system: &System,
        parameters: &[ComplexRational],
        prime: u64,
        multipliers: Multipliers,
        random: &mut RandomStream,
    ) -> Option<Option<usize>> {
        // Conjugating the coefficients is taking the other root of -1 for i. The
        // point itself is formal and stays.
        let field = PrimeField::new(prime);
        let conjugate = field.conjugate();
        let lift = |field: &PrimeField| {
            parameters
                .iter()
                .map(|p| field.constant(p))
                .collect::<Option<Vec<u64>>>()
        };
        let (given, mirrored) = (lift(&field)?, lift(&conjugate)?);
        let mut rows = Rows::default();
        for _ in 0..multipliers.samples(system) {
            let point: Vec<u64> = system
                .variables
                .iter()
                .map(|_| random.below(prime))
                .collect();
            let exchanged: Vec<u64> = self.partner.iter().map(|&p| point[p]).collect();
            let values = evaluate(
                &field,
                &system.expressions,
                &system.equations,
                &point,
                &given,
            )?;
            rows.add_point(
                multipliers.apply(&field, values, &point),
                evaluate(
                    &conjugate,
                    &system.expressions,
                    &system.equations,
                    &exchanged,
                    &mirrored,
                )?,
            );
        }
        Some(rows.first_outside(&field, |&value, _| value == 0))
    }

    /// Finds the first equation with an image outside the span where constants are not rational: a combination counts
    /// as 0 when half of very many bits agree.
    fn torn_equation_with_many_bits(
        &self,
        system: &System,
        parameters: &[ComplexRational],
        multipliers: Multipliers,
        random: &mut RandomStream,
    ) -> Option<Option<usize>> {
        let field = ManyBits(BITS);
        let given: Vec<Complex> = parameters
            .iter()
            .map(|p| field.constant(p))
            .collect::<Option<_>>()?;
        let mut rows = Rows::default();
        for _ in 0..multipliers.samples(system) {
            let point: Vec<Complex> = system
                .variables
                .iter()
                .map(|_| {
                    let z = random.unit();
                    Complex::with_val(BITS, (z.re, z.im))
                })
                .collect();
            let image: Vec<Complex> = self
                .partner
                .iter()
                .map(|&p| point[p].clone().conj())
                .collect();
            let at = |point: &[Complex]| {
                evaluate(
                    &field,
                    &system.expressions,
                    &system.equations,
                    point,
                    &given,
                )
            };
            rows.add_point(
                multipliers.apply(&field, at(&point)?, &point),
                at(&image)?.into_iter().map(Complex::conj).collect(),
            );
        }
        let small = Float::with_val(BITS, 1) >> (BITS / 2);
        Some(rows.first_outside(&field, |value, row: &[Complex]| {
            let size = |z: &Complex| Float::with_val(BITS, z.norm_ref());
            let largest = row
                .iter()
                .map(size)
                .fold(Float::new(BITS), |a, b| if a < b { b } else { a });
            size(value) <= largest * &small
        }))
    }
}

/// Whether all numbers are real and only joined by rational operations: then each equation is its own image, with
/// nothing to be found out. With many targets this is asked of each.
fn is_real(system: &System, parameters: &[Complex64]) -> bool {
    let real = |node: &Node| match node {
        Node::Constant(value) => value.is_real(),
        // The root of a negative number is not real, nor need the value of a function be.
        Node::Root(..) | Node::Function(..) => false,
        _ => true,
    };
    let numbers = parameters.iter().all(|p| p.re.is_finite() && p.im == 0.0);
    numbers && system.expressions.nodes().iter().all(real)
}

/// Past this many rows linear coefficients are not tried: elimination takes their cube.
const MOST_ROWS: usize = 100;

/// Multipliers of the equations in the combinations that are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Multipliers {
    /// The images are in the span of the equations.
    Constants,
    /// The images are in the ideal of the equations, by coefficients of degree 1: enough where one equation gives a
    /// variable its value, and its conjugate follows from another.
    Linear,
}

impl Multipliers {
    fn rows(self, system: &System) -> usize {
        match self {
            Self::Constants => system.equations.len(),
            Self::Linear => system.equations.len() * (system.variables.len() + 1),
        }
    }

    /// More points than there are rows: then a row of values that is a
    /// combination of others comes from a polynomial that is.
    fn samples(self, system: &System) -> usize {
        self.rows(system) + 4
    }

    /// The values at a point of all that may be combined.
    fn apply<F: Field>(
        self,
        field: &F,
        values: Vec<F::Value>,
        point: &[F::Value],
    ) -> Vec<F::Value> {
        match self {
            Self::Constants => values,
            Self::Linear => {
                let multiples: Vec<F::Value> = point
                    .iter()
                    .flat_map(|x| values.iter().map(|v| field.multiply(x, v)))
                    .collect();
                values.into_iter().chain(multiples).collect()
            }
        }
    }
}

fn partners(system: &System) -> Result<Vec<usize>, NotInvariant> {
    let count = system.variables.len();
    let mut partner: Vec<usize> = (0..count).collect();
    let mut seen = vec![false; count];
    for &(a, b) in &system.conjugates {
        for v in [a, b] {
            if v >= count || (seen[v] && a != b) {
                return Err(NotInvariant::Pairs {
                    variable: system
                        .variables
                        .get(v)
                        .cloned()
                        .unwrap_or_else(|| format!("variable {}", v + 1)),
                });
            }
        }
        (seen[a], seen[b]) = (true, true);
        (partner[a], partner[b]) = (b, a);
    }
    Ok(partner)
}

/// Values of the equations and of their images, one row for each, one column for each point.
struct Rows<V> {
    given: Vec<Vec<V>>,
    images: Vec<Vec<V>>,
}

impl<V> Default for Rows<V> {
    fn default() -> Self {
        Self {
            given: Vec::new(),
            images: Vec::new(),
        }
    }
}

impl<V: Clone> Rows<V> {
    fn add_point(&mut self, given: Vec<V>, images: Vec<V>) {
        self.given.resize(given.len(), Vec::new());
        self.images.resize(images.len(), Vec::new());
        for (row, value) in self.given.iter_mut().zip(given) {
            row.push(value);
        }
        for (row, value) in self.images.iter_mut().zip(images) {
            row.push(value);
        }
    }

    /// The first image that is no combination of the given rows. `vanishes` is
    /// asked of a value and of the row, as it was given, that it came from.
    fn first_outside<F>(&self, field: &F, vanishes: impl Fn(&V, &[V]) -> bool) -> Option<usize>
    where
        F: Field<Value = V>,
    {
        let mut basis: Vec<(usize, Vec<V>)> = Vec::new();
        let reduce = |row: &[V], basis: &[(usize, Vec<V>)]| {
            let mut rest = row.to_vec();
            for (pivot, vector) in basis {
                let factor = field.negate(&rest[*pivot]);
                for (a, b) in rest.iter_mut().zip(vector) {
                    *a = field.add(a, &field.multiply(&factor, b));
                }
            }
            rest
        };
        for row in &self.given {
            let rest = reduce(row, &basis);
            if let Some(pivot) = rest.iter().position(|v| !vanishes(v, row)) {
                let scaled = rest
                    .iter()
                    .map(|v| field.divide(v, &rest[pivot]))
                    .collect::<Option<Vec<V>>>()
                    .expect("a pivot is not 0");
                basis.push((pivot, scaled));
            }
        }
        self.images.iter().position(|row| {
            reduce(row, &basis)
                .iter()
                .any(|value| !vanishes(value, row))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::expression::NodeId;
    use cognate_systems::system::VariableGroup;

    /// A system in x, y (and a parameter p) of equations built by hand.
    fn system(build: impl Fn(&mut System) -> Vec<NodeId>) -> System {
        let mut system = System {
            variables: vec!["x".into(), "y".into()],
            parameters: vec!["p".into()],
            groups: vec![VariableGroup {
                variables: vec![0, 1],
                homogeneous: false,
            }],
            ..System::default()
        };
        system.equations = build(&mut system);
        system.equation_names = (1..=system.equations.len())
            .map(|k| format!("f{k}"))
            .collect();
        system
    }

    /// x^2 + c y (x - y) and its mirror image, up to a factor of its own.
    fn mirrored(factor: ComplexRational) -> System {
        system(move |s| {
            let e = &mut s.expressions;
            let (x, y) = (e.variable(0), e.variable(1));
            let c = e.constant(ComplexRational::new(2, 3));
            let d = e.constant(ComplexRational::new(2, -3));
            let mut quadric = |c, x, y| {
                let (square, difference) = (e.power(x, 2), e.subtract(x, y));
                let product = e.multiply(y, difference);
                let rest = e.multiply(c, product);
                e.add(square, rest)
            };
            let first = quadric(c, x, y);
            let second = quadric(d, y, x);
            let scale = e.constant(factor.clone());
            vec![first, e.multiply(scale, second)]
        })
    }

    #[test]
    fn a_real_system_is_invariant_and_a_complex_one_is_not() {
        let real = system(|s| {
            let e = &mut s.expressions;
            let (x, y, two) = (e.variable(0), e.variable(1), e.integer(2));
            let square = e.power(x, 2);
            vec![e.subtract(square, two), e.subtract(y, x)]
        });
        assert!(Involution::of(&real, &[Complex64::new(0.0, 0.0)]).is_ok());
        let complex = system(|s| {
            let e = &mut s.expressions;
            let (x, i) = (e.variable(0), e.constant(ComplexRational::i()));
            let square = e.power(x, 2);
            let y = e.variable(1);
            vec![e.subtract(square, i), e.subtract(y, x)]
        });
        let zero = [Complex64::new(0.0, 0.0)];
        let Err(NotInvariant::Equation { equation, pairs }) = Involution::of(&complex, &zero)
        else {
            panic!("x^2 = i is not real");
        };
        assert_eq!((equation.as_str(), pairs), ("f1", false));
    }

    #[test]
    fn pairs_make_a_mirrored_system_invariant() {
        let zero = [Complex64::new(0.0, 0.0)];
        let factor = ComplexRational::new((5, 7), -4);
        let mut s = mirrored(factor);
        assert!(Involution::of(&s, &zero).is_err());
        s.conjugates = vec![(0, 1)];
        let involution = Involution::of(&s, &zero).unwrap();
        assert_eq!(involution.partner, [1, 0]);
        s.equations.pop();
        assert!(
            Involution::of(&s, &zero).is_err(),
            "the mirror image is missing"
        );
        s.conjugates = vec![(0, 1), (1, 0)];
        assert!(matches!(
            Involution::of(&s, &zero),
            Err(NotInvariant::Pairs { .. })
        ));
    }

    #[test]
    fn a_value_whose_conjugate_follows_is_enough() {
        // x = c with |c| = 1 and x y = 1: then y is the conjugate of c, so the pair is invariant.
        let build = |re, im| {
            let mut s = system(move |s| {
                let e = &mut s.expressions;
                let (x, y, one) = (e.variable(0), e.variable(1), e.integer(1));
                let c = e.constant(ComplexRational::new(re, im));
                let product = e.multiply(x, y);
                vec![e.subtract(x, c), e.subtract(product, one)]
            });
            s.conjugates = vec![(0, 1)];
            s
        };
        let zero = [Complex64::new(0.0, 0.0)];
        assert!(Involution::of(&build((3, 5), (4, 5)), &zero).is_ok());
        assert!(Involution::of(&build((3, 5), (3, 5)), &zero).is_err());
    }

    #[test]
    fn values_of_parameters_decide() {
        let s = system(|s| {
            let e = &mut s.expressions;
            let (x, y, p) = (e.variable(0), e.variable(1), e.parameter(0));
            let square = e.power(x, 2);
            vec![e.subtract(square, p), e.subtract(y, x)]
        });
        assert!(Involution::of(&s, &[Complex64::new(0.3, 0.0)]).is_ok());
        assert!(Involution::of(&s, &[Complex64::new(0.3, 1e-17)]).is_err());
        assert!(Involution::of(&s, &[Complex64::new(f64::NAN, 0.0)]).is_err());
    }

    /// The test without evaluation and the test with random values agree.
    #[test]
    fn real_numbers_need_no_values() {
        let build = |im: i64| {
            system(move |s| {
                let e = &mut s.expressions;
                let (x, y, p) = (e.variable(0), e.variable(1), e.parameter(0));
                let c = e.constant(ComplexRational::new(3, im));
                let (square, product) = (e.power(x, 2), e.multiply(c, p));
                vec![e.subtract(square, product), e.subtract(y, x)]
            })
        };
        for (im, p, expected) in [
            (0, Complex64::new(0.3, 0.0), true),
            (0, Complex64::new(0.3, 0.1), false),
            (1, Complex64::new(0.3, 0.0), false),
        ] {
            let s = build(im);
            assert_eq!(is_real(&s, &[p]), expected);
            let involution = Involution {
                partner: vec![0, 1],
            };
            assert_eq!(involution.check_equations(&s, &[p]).is_ok(), expected);
        }
    }

    #[test]
    fn irrational_constants_are_told_apart() {
        // sqrt(3) is real and sqrt(-3) is not; as a factor of an equation neither matters.
        let zero = [Complex64::new(0.0, 0.0)];
        let with_root = |radicand: i64, as_factor: bool| {
            system(move |s| {
                let e = &mut s.expressions;
                let (x, y) = (e.variable(0), e.variable(1));
                let c = e.integer(radicand);
                let root = e.root(c, (1, 2).into());
                let square = e.power(x, 2);
                let first = if as_factor {
                    let f = e.subtract(square, y);
                    e.multiply(root, f)
                } else {
                    e.subtract(square, root)
                };
                vec![first, e.subtract(y, x)]
            })
        };
        assert!(Involution::of(&with_root(3, false), &zero).is_ok());
        assert!(Involution::of(&with_root(-3, false), &zero).is_err());
        assert!(Involution::of(&with_root(-3, true), &zero).is_ok());
    }

    #[test]
    fn homogeneous_groups_must_stay_whole() {
        let zero = [Complex64::new(0.0, 0.0)];
        let mut s = mirrored(ComplexRational::real(1));
        s.conjugates = vec![(0, 1)];
        s.groups[0].homogeneous = true;
        assert!(Involution::of(&s, &zero).is_ok());
        s.groups = vec![
            VariableGroup {
                variables: vec![0],
                homogeneous: true,
            },
            VariableGroup {
                variables: vec![1],
                homogeneous: false,
            },
        ];
        assert!(matches!(
            Involution::of(&s, &zero),
            Err(NotInvariant::TornGroup { .. })
        ));
    }
}

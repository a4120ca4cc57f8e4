//! Problem: what does not change during a decomposition: equations, combinations of them, slices.

use super::job::Tracking;
use super::options::DecompositionOptions;
use super::symmetry::{GeneratorError, LinearMap};
use crate::degrees_or_bounds::degrees_or_bounds;
use cognate_continuation::bend::{Number, SlicedEquations, exactly, rounded};
use cognate_continuation::start_systems::slices::form;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::ComplexRational;
use cognate_solutions::involution::Involution;
use cognate_solutions::witness::Method;
use cognate_systems::expression::NodeId;
use cognate_systems::polynomial::{Degrees, PolynomialError, check_homogeneous, degrees};
use cognate_systems::scaling::Scaling;
use cognate_systems::system::{System, SystemError};
use cognate_systems::transform::{
    FixError, affine_chart, combine, combine_all, combine_few, equilibrate, factors,
    fix_parameters, slice,
};
use cognate_systems::units::scaling_of;
use num_complex::Complex64;
use std::borrow::Cow;
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

/// Singular values below this part of the largest are 0 at a random point.
const RANK_AT_RANDOM: f64 = 1e-9;

/// Most start points of a dimension by itself, where that way is chosen for comparison.
const MOST_START_POINTS: f64 = 5e3;

/// Reason why a system cannot be decomposed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProblemError {
    /// A part of the system does not fit the others, as in a damaged state.
    #[error("{0}")]
    System(#[from] SystemError),
    /// The parameters cannot have the given values.
    #[error("{0}")]
    Parameters(#[from] FixError),
    /// A value of a parameter is no number.
    #[error("parameter {0} has a value that is not finite")]
    NotFinite(String),
    /// Nothing is cut out.
    #[error("every equation is identically 0: every point is a solution")]
    Everything,
    /// Doubles do not hold its values, as of a product of hundreds of factors.
    #[error(
        "equation `{0}` has values beyond the range of doubles at points of size 1; expected an equation that can be \
         divided by a number or written as several"
    )]
    Range(String),
    /// No set has a dimension in this range.
    #[error(
        "dimensions {lowest} to {highest} are asked; components have dimensions {least} to {most}"
    )]
    Dimensions {
        /// The lowest that is asked.
        lowest: u32,
        /// The highest that is asked.
        highest: u32,
        /// The lowest that a component can have, by the rank of the Jacobian at a random point.
        least: u32,
        /// The highest that a component can have.
        most: u32,
    },
    /// The system has no degrees.
    #[error(transparent)]
    Degrees(#[from] PolynomialError),
    /// Known components are none of the first equations.
    #[error("known components: {0}")]
    Known(String),
    /// A generator of the symmetry group that is of no use here.
    #[error(transparent)]
    Symmetry(#[from] GeneratorError),
}

/// The equations in one affine group, and all that is made of them once.
#[derive(Debug)]
pub(crate) struct Problem {
    /// The equations that are given, and patches; each scaled to about 1.
    pub given: Arc<System>,
    /// Place of each given equation in the system; `None`: a patch.
    sources: Vec<Option<usize>>,
    degrees: Degrees,
    /// The equations in the order in which they cut: of small degree first.
    pub order: Vec<usize>,
    /// Number of first equations, in this order, whose components are known.
    pub known: usize,
    /// Combinations of the equations, as many as there are variables: the first `levels` of them, and
    /// others that are never reached.
    pub staircase: Arc<System>,
    /// Degrees of the rows of the staircase.
    pub row_degrees: Vec<u32>,
    /// Rank of the Jacobian at a random point: no component has a smaller dimension than the variables
    /// that it leaves.
    pub levels: usize,
    /// Levels down to the lowest dimension that is asked.
    pub asked_levels: usize,
    /// Dimensions whose components are wanted.
    pub asked: RangeInclusive<u32>,
    pub tracking: Tracking,
    pub idle_loops: u32,
    pub confirm_junk: bool,
    /// The factors of the equations, to evaluate.
    factors: FactorValues,
    /// The units in which all of it is tracked.
    scaling: Scaling,
    /// Complex conjugation, where it maps solutions to solutions.
    pub involution: Option<Involution>,
    /// Generators of the symmetry group that is named.
    pub symmetry: Vec<LinearMap>,
    /// Whether sets are split into components.
    pub split: bool,
}

impl Problem {
    /// The problem with the tracking that the options ask for.
    pub fn of_options(
        system: &System,
        options: &DecompositionOptions,
    ) -> Result<Self, ProblemError> {
        Self::in_units(system, options, None)
    }

    /// Makes the problem in given units.
    pub fn in_units(
        system: &System,
        options: &DecompositionOptions,
        scaling: Option<Scaling>,
    ) -> Result<Self, ProblemError> {
        let tracking = Tracking {
            settings: options.settings.clone(),
            tolerances: options.tolerances.clone(),
            max_retries: options.max_retries,
            seed: options.seed,
        };
        Self::new(system, tracking, options, scaling)
    }

    /// The units in which all of it is tracked.
    pub fn scaling(&self) -> &Scaling {
        &self.scaling
    }

    fn new(
        system: &System,
        tracking: Tracking,
        options: &DecompositionOptions,
        units: Option<Scaling>,
    ) -> Result<Self, ProblemError> {
        let count = system.equation_count();
        let (system, kept) = without_vanishing(with_values(system, &options.parameters)?);
        if system.equations.is_empty() {
            return Err(ProblemError::Everything);
        }
        // In an affine chart an equation that is not homogeneous in its group would be another one.
        check_homogeneous(&system, &degrees(&system)?)?;
        let seed = tracking.seed;
        let system = System {
            scaling: match (units, options.own_units) {
                (Some(units), _) => units,
                (None, true) => scaling_of(&system, &[]),
                (None, false) => Scaling::default(),
            },
            ..system.into_owned()
        };
        let scaling = system.scaling.clone();
        let symmetry = LinearMap::all(&system)?;
        let given = equilibrate(&affine_chart(&system.in_unknowns(), seed), seed);
        let patches = given.equation_count() - kept.len();
        let sources = vec![None; patches].into_iter();
        let sources: Vec<Option<usize>> = sources.chain(kept.into_iter().map(Some)).collect();
        let of_given = degrees(&given)?;
        let variables = given.variable_count();
        let plain = SlicedEquations::new(&given, Vec::new());
        let factors = FactorValues::new(&given, seed)?;
        let levels = rank_at_random(&plain, &given, seed)?.min(given.equation_count());
        if levels == 0 {
            return Err(ProblemError::Everything);
        }
        let (least, most) = ((variables - levels) as u32, variables as u32 - 1);
        let asked = options.dimensions.clone().unwrap_or(least..=most);
        let (lowest, highest) = (*asked.start(), *asked.end());
        if lowest > highest || highest < least || highest > most {
            return Err(ProblemError::Dimensions {
                lowest,
                highest,
                least,
                most,
            });
        }
        let asked = lowest.max(least)..=highest;
        let asked_levels = variables - *asked.start() as usize;
        let mut staircase = combine(&given, &of_given, levels, seed);
        for v in levels..variables {
            let row = staircase.expressions.variable(v as u32);
            staircase.equations.push(row);
            staircase.equation_names.push(format!("place {}", v + 1));
        }
        staircase.symmetry.clear();
        staircase.conjugates.clear();
        staircase.degenerate.clear();
        let row_degrees = degrees(&staircase)?.total;
        let involution = Involution::of(&given, &[]).ok();
        let component_equations = known_equations(options, count)?;
        let other =
            |i: usize| sources[i].is_some_and(|source: usize| source >= component_equations);
        let mut order: Vec<usize> = (0..given.equation_count()).collect();
        order.sort_by_key(|&i| (other(i), of_given.total[i], i));
        let prefix_length = order.iter().filter(|&&i| !other(i)).count();
        Ok(Self {
            given: Arc::new(given),
            sources,
            order,
            known: if options.known.is_some() {
                prefix_length
            } else {
                0
            },
            degrees: of_given,
            staircase: Arc::new(staircase),
            row_degrees,
            levels,
            asked_levels,
            asked,
            tracking,
            idle_loops: options.idle_loops,
            confirm_junk: options.confirm_junk,
            factors,
            scaling,
            involution,
            symmetry,
            split: options.split,
        })
    }

    /// The problem of the first equations alone, in the order in which they cut. It has no staircase of its own.
    pub fn prefix(&self, count: usize) -> Result<Self, ProblemError> {
        let chosen = &self.order[..count];
        let given = with_equations(&self.given, chosen);
        let of_chosen = Degrees {
            by_group: chosen
                .iter()
                .map(|&i| self.degrees.by_group[i].clone())
                .collect(),
            total: chosen.iter().map(|&i| self.degrees.total[i]).collect(),
        };
        Ok(Self {
            factors: FactorValues::new(&given, self.seed())?,
            given: Arc::new(given),
            sources: chosen.iter().map(|&i| self.sources[i]).collect(),
            degrees: of_chosen,
            order: (0..count).collect(),
            known: 0,
            staircase: Arc::clone(&self.staircase),
            row_degrees: Vec::new(),
            levels: self.levels,
            asked_levels: self.asked_levels,
            asked: self.asked.clone(),
            tracking: self.tracking.clone(),
            idle_loops: self.idle_loops,
            // A component that is taken for junk on the way is lost without a trace.
            confirm_junk: self.confirm_junk,
            scaling: self.scaling.clone(),
            involution: None,
            symmetry: Vec::new(),
            split: true,
        })
    }

    /// The equations by their places in the system: those of which `chosen` is true, and all patches.
    fn places(&self, chosen: impl Fn(usize) -> bool) -> Vec<usize> {
        let places = 0..self.sources.len();
        let is = |&i: &usize| self.sources[i].is_none_or(&chosen);
        places.filter(is).collect()
    }

    /// The problem of some of the equations of the system, and of the patches, in the same units.
    pub fn part(&self, chosen: impl Fn(usize) -> bool) -> Result<Self, ProblemError> {
        let places = self.places(chosen);
        if places.is_empty() {
            return Err(ProblemError::Everything);
        }
        let given = with_equations(&self.given, &places);
        let degrees = degrees(&given)?;
        let plain = SlicedEquations::new(&given, Vec::new());
        let levels = rank_at_random(&plain, &given, self.seed())?.min(given.equation_count());
        Ok(Self {
            factors: FactorValues::new(&given, self.seed())?,
            order: (0..places.len()).collect(),
            known: 0,
            sources: places.iter().map(|&i| self.sources[i]).collect(),
            levels,
            asked_levels: levels,
            asked: (self.variables() - levels) as u32..=self.variables() as u32 - 1,
            involution: Involution::of(&given, &[]).ok(),
            given: Arc::new(given),
            degrees,
            staircase: Arc::clone(&self.staircase),
            row_degrees: Vec::new(),
            tracking: self.tracking.clone(),
            idle_loops: self.idle_loops,
            confirm_junk: self.confirm_junk,
            scaling: self.scaling.clone(),
            symmetry: Vec::new(),
            split: true,
        })
    }

    /// The problem in which sets of this dimension, regular on these equations, are cut by more of them: the last ones
    /// of `extended`, whose first are these. Its staircase has combinations of the first, as many as cut out the
    /// sets, then combinations of the others; `None` where one of the others is a constant, so that nothing is cut
    /// out.
    pub fn cut_by(&self, dimension: usize, extended: System) -> Result<Option<Self>, ProblemError> {
        let n = self.variables();
        let equation_count = self.given.equation_count();
        let extended_degrees = degrees(&extended)?;
        if extended_degrees.total[equation_count..].contains(&0) {
            return Ok(None);
        }
        let part = |places: Range<usize>| Degrees {
            by_group: extended_degrees.by_group[places.clone()].to_vec(),
            total: extended_degrees.total[places].to_vec(),
        };
        let chosen: Vec<usize> = (0..extended.equation_count()).collect();
        let first = with_equations(&extended, &chosen[..equation_count]);
        let mut staircase = combine(&first, &part(0..equation_count), n - dimension, self.seed());
        let others = System {
            expressions: staircase.expressions.clone(),
            ..with_equations(&extended, &chosen[equation_count..])
        };
        let degrees_of_others = part(equation_count..chosen.len());
        // Not the multiples with which the first are combined.
        let others = combine_all(&others, &degrees_of_others, dimension, !self.seed());
        staircase.expressions = others.expressions;
        staircase.equations.extend(others.equations);
        let levels = staircase.equations.len();
        for v in levels..n {
            let row = staircase.expressions.variable(v as u32);
            staircase.equations.push(row);
        }
        let names = 1..=staircase.equations.len();
        staircase.equation_names = names.map(|k| format!("combination {k}")).collect();
        staircase.symmetry.clear();
        staircase.conjugates.clear();
        staircase.degenerate.clear();
        let sources = self.sources.iter().copied();
        Ok(Some(Self {
            factors: FactorValues::new(&extended, self.seed())?,
            row_degrees: degrees(&staircase)?.total,
            staircase: Arc::new(staircase),
            order: chosen.clone(),
            known: 0,
            sources: sources
                .chain(vec![None; chosen.len() - equation_count])
                .collect(),
            levels,
            asked_levels: levels,
            asked: (n - levels) as u32..=n as u32 - 1,
            involution: self.involution.clone(),
            given: Arc::new(extended),
            degrees: extended_degrees,
            tracking: self.tracking.clone(),
            idle_loops: self.idle_loops,
            confirm_junk: self.confirm_junk,
            scaling: self.scaling.clone(),
            symmetry: Vec::new(),
            split: true,
        }))
    }

    /// As many combinations of the equations as cut out sets of this dimension, with this seed, in the expressions of
    /// `extended`, which go on from those of the equations.
    pub fn combinations(&self, extended: &System, dimension: usize, seed: u64) -> System {
        let equations = System {
            expressions: extended.expressions.clone(),
            ..(*self.given).clone()
        };
        let rows = self.variables() - dimension;
        combine(&equations, &self.degrees, rows, seed)
    }

    /// These equations, then the others of `whole`, of which they are a part.
    pub fn followed_by(&self, whole: &Self, others: impl Fn(usize) -> bool) -> System {
        let mut places = whole.places(|i| self.sources.contains(&Some(i)));
        let wanted = |i: &usize| whole.sources[*i].is_some_and(&others);
        places.extend((0..whole.sources.len()).filter(wanted));
        with_equations(&whole.given, &places)
    }

    /// A way to the answer that is compared with this one.
    pub fn second(&self, first: Method) -> Method {
        let degrees = self.row_degrees.iter().take(self.asked_levels);
        let paths = degrees.fold(1.0, |product, &degree| product * f64::from(degree));
        match first {
            Method::Equations | Method::Slices => Method::Cascade,
            Method::Cascade if paths <= MOST_START_POINTS => Method::Slices,
            Method::Cascade => Method::Equations,
        }
    }

    /// The factors of the last equation, as it is written: their degrees and exponents.
    pub fn last_factors(&self) -> Result<Vec<[u32; 2]>, ProblemError> {
        let last_factors = self.factors_of_last();
        let nodes = last_factors.iter().map(|(node, _)| *node).collect();
        let factor_degrees = degrees(&with_factors(&self.given, nodes))?.total;
        let pairs = factor_degrees.into_iter().zip(last_factors);
        Ok(pairs
            .map(|(degree, (_, exponent))| [degree, exponent])
            .collect())
    }

    fn factors_of_last(&self) -> Vec<(NodeId, u32)> {
        let last = self.given.equations.last();
        let factors = last.map(|&last| factors(&self.given.expressions, last));
        factors.unwrap_or_default()
    }

    /// A factor of the last equation alone.
    pub fn last_factor(&self, factor: usize) -> System {
        with_factors(&self.given, vec![self.factors_of_last()[factor].0])
    }

    /// As many combinations of all equations but the last as cut out a set of this dimension, a factor of the last,
    /// and others that are never reached.
    pub fn cut(&self, dimension: usize, factor: usize) -> Result<System, ProblemError> {
        let n = self.variables();
        let (_, before) = self.order.split_last().ok_or(ProblemError::Everything)?;
        let (last, _) = self.factors_of_last()[factor];
        let mut cut = with_equations(&self.given, before);
        if !before.is_empty() {
            let cut_degrees = degrees(&cut)?;
            cut = combine(&cut, &cut_degrees, n - dimension, self.seed());
        }
        cut.equations.push(last);
        cut.equation_names.push("cut".into());
        for v in cut.equations.len()..n {
            cut.equations.push(cut.expressions.variable(v as u32));
            cut.equation_names.push(format!("place {}", v + 1));
        }
        Ok(cut)
    }

    pub fn variables(&self) -> usize {
        self.given.variable_count()
    }

    pub fn seed(&self) -> u64 {
        self.tracking.seed
    }

    /// The slices of a set of this dimension, a row each: those of smaller dimensions are among them.
    pub fn slices(&self, dimension: usize) -> Vec<Vec<Complex64>> {
        let n = self.variables();
        let levels = n - dimension..n;
        levels
            .map(|level| form(self.seed(), level as u32, 0, n))
            .collect()
    }

    /// The slices in the variables of the system that is given.
    pub fn slices_of_variables(&self, dimension: usize) -> Vec<Vec<Complex64>> {
        let mut rows = self.slices(dimension);
        for row in &mut rows {
            let inverse = self.scaling.inverse();
            let coefficients = inverse.to_variables(&row[1..]);
            row[1..].copy_from_slice(&coefficients);
        }
        rows
    }

    /// Values of the variables of the system that is given.
    pub fn to_variables(&self, point: &[Complex64]) -> Vec<Complex64> {
        self.scaling.to_variables(point)
    }

    /// Slices that are given in the variables of the system, in those that are tracked.
    pub fn tracked_slices(&self, slices: &[Vec<Complex64>]) -> Vec<Vec<Complex64>> {
        let tracked = |row: &Vec<Complex64>| {
            let coefficients = self.scaling.to_variables(&row[1..]);
            row[..1].iter().copied().chain(coefficients).collect()
        };
        slices.iter().map(tracked).collect()
    }

    /// A point that is given in the variables of the system, in those that are tracked.
    pub fn to_unknowns(&self, point: &[Complex64]) -> Vec<Complex64> {
        self.scaling.to_unknowns(point)
    }

    /// As many combinations of the equations of a system as cut out a set of this dimension, and its slices.
    pub fn tracked(&self, equations: &System, dimension: usize) -> Result<System, ProblemError> {
        let rows = self.tracked_rows(equations, dimension)?;
        Ok(slice(&rows, dimension, self.variables()))
    }

    /// As many combinations of the equations of a system as cut out a set of this dimension, without slices.
    pub fn tracked_rows(
        &self,
        equations: &System,
        dimension: usize,
    ) -> Result<System, ProblemError> {
        let equation_degrees = degrees_or_bounds(equations)?;
        let rows = equations.variable_count() - dimension;
        Ok(combine_few(
            equations,
            &equation_degrees,
            rows,
            self.seed(),
            true,
        ))
    }

    /// As many combinations of the given equations; `keep`: whether linear ones stay as they are.
    pub fn combined(&self, dimension: usize, seed: u64, keep: bool) -> System {
        let rows = self.variables() - dimension;
        combine_few(&self.given, &self.degrees, rows, seed, keep)
    }

    /// As many combinations of the equations as cut out curves.
    pub fn curve_equations(&self) -> System {
        let mut rows = combine(
            &self.given,
            &self.degrees,
            self.variables() - 1,
            self.seed(),
        );
        rows.symmetry.clear();
        rows.conjugates.clear();
        rows.degenerate.clear();
        rows
    }

    /// The first rows of the staircase with the slices of that dimension.
    pub fn level_equations(&self, dimension: usize) -> SlicedEquations {
        let mut rows = (*self.staircase).clone();
        rows.equations.truncate(self.variables() - dimension);
        SlicedEquations::new(&rows, self.slices(dimension))
    }

    /// Whether a point that is known to 32 digits, or one that is known to a few, solves all given equations;
    /// `None` where that is not clear.
    pub fn solves(&self, point: &[Number], thresholds: &Known) -> Option<bool> {
        let sizes = point.iter().map(|z| rounded(z).norm_sqr());
        let largest = sizes.fold(1.0f64, f64::max).sqrt();
        let values = self.factors.equations.residuals(point);
        let is_zero = |factor: usize| {
            let ((value, distance), degree) = (values[factor], self.factors.degrees[factor]);
            let growth = (0..degree).fold(1.0, |power, _| power * largest);
            let relative = value / growth;
            // Where an equation has a multiple zero its derivative is rounding error, too.
            if relative <= thresholds.value || distance <= thresholds.distance {
                return Some(true);
            }
            let other = relative > thresholds.value * 100.0 && distance > thresholds.other_distance;
            other.then_some(false)
        };
        let mut answer = Some(true);
        for range in &self.factors.of_equation {
            // A product is 0 where one of its factors is.
            let mut product = Some(false);
            for factor in range.clone() {
                match is_zero(factor) {
                    Some(true) => product = Some(true),
                    Some(false) => {}
                    None if product == Some(false) => product = None,
                    None => {}
                }
            }
            match product {
                Some(true) => {}
                Some(false) => return Some(false),
                None => answer = None,
            }
        }
        answer
    }
}

/// The factors of equations, as they are written.
#[derive(Debug)]
struct FactorValues {
    /// Factors of all equations, equation by equation.
    equations: SlicedEquations,
    degrees: Vec<u32>,
    /// Range of the factors of each equation.
    of_equation: Vec<Range<usize>>,
}

impl FactorValues {
    fn new(system: &System, seed: u64) -> Result<Self, ProblemError> {
        let mut nodes = Vec::new();
        let mut of_equation = Vec::with_capacity(system.equation_count());
        for &equation in &system.equations {
            let first = nodes.len();
            let equation_factors = factors(&system.expressions, equation);
            nodes.extend(equation_factors.iter().map(|(node, _)| *node));
            of_equation.push(first..nodes.len());
        }
        let apart = equilibrate(&with_factors(system, nodes), seed);
        Ok(Self {
            degrees: degrees(&apart)?.total,
            equations: SlicedEquations::new(&apart, Vec::new()),
            of_equation,
        })
    }
}

/// Thresholds by which an equation holds at a point.
#[derive(Debug)]
pub(crate) struct Known {
    /// Value of the equation, relative to how its degree lets it grow; below this it is rounding error.
    value: f64,
    /// Distance from the zeros of the equation, relative to the point's size: a point nearer than `distance` is a zero,
    /// one farther than `other_distance` is none.
    distance: f64,
    other_distance: f64,
}

/// A point that was refined to 32 digits.
pub(crate) const REFINED: Known = Known {
    value: 1e-26,
    distance: 1e-16,
    other_distance: 1e-9,
};
impl Known {
    /// Thresholds for a point that is known to this accuracy, relative to its size: only a point that is clearly no
    /// solution is rejected.
    pub fn to_accuracy(accuracy: f64) -> Self {
        let accuracy = accuracy.max(f64::EPSILON);
        Self {
            value: 1e2 * accuracy,
            distance: 1e2 * accuracy,
            other_distance: (1e4 * accuracy).min(1e-4).max(1e2 * accuracy),
        }
    }
}

/// A singular end of a path, known to some 8 digits.
pub(crate) const SINGULAR: Known = Known {
    value: 1e-14,
    distance: 1e-5,
    other_distance: 1e-4,
};

/// The system with these of its equations, and nothing that is attached to all of them.
fn with_equations(system: &System, chosen: &[usize]) -> System {
    let mut result = system.clone();
    result.equations = chosen.iter().map(|&i| system.equations[i]).collect();
    let names = chosen.iter().filter_map(|&i| system.equation_names.get(i));
    result.equation_names = names.cloned().collect();
    result.symmetry.clear();
    result.conjugates.clear();
    result.degenerate.clear();
    result
}

/// The system with these factors of its equations in their place.
fn with_factors(system: &System, nodes: Vec<NodeId>) -> System {
    let mut result = with_equations(system, &[]);
    result.equation_names = (0..nodes.len()).map(|k| format!("factor {k}")).collect();
    result.equations = nodes;
    result
}

/// The system without the equations that hold everywhere, and which are left.
fn without_vanishing(system: Cow<'_, System>) -> (Cow<'_, System>, Vec<usize>) {
    let everywhere = |&equation: &usize| {
        let alone = with_equations(&system, &[equation]);
        matches!(degrees(&alone), Err(PolynomialError::Vanishes(_)))
    };
    let indices = 0..system.equation_count();
    let (vanishing, left): (Vec<usize>, Vec<usize>) = indices.partition(everywhere);
    if vanishing.is_empty() {
        return (system, left);
    }
    let mut whole = system.into_owned();
    whole.equation_names = left
        .iter()
        .filter_map(|&i| whole.equation_names.get(i).cloned())
        .collect();
    whole.equations = left.iter().map(|&i| whole.equations[i]).collect();
    (Cow::Owned(whole), left)
}

/// The system with these values of its parameters: the short numbers that they stand for, or the doubles themselves.
pub(crate) fn with_values<'a>(
    system: &'a System,
    values: &[Complex64],
) -> Result<Cow<'a, System>, ProblemError> {
    if system.parameters.is_empty() && values.is_empty() {
        return Ok(Cow::Borrowed(system));
    }
    let mut exact = Vec::with_capacity(values.len());
    for (place, value) in values.iter().enumerate() {
        let short_number = ComplexRational::from_short(*value);
        let number = short_number.or_else(|| ComplexRational::from_doubles(*value));
        let name = || system.parameters.get(place).cloned();
        exact.push(number.ok_or_else(|| ProblemError::NotFinite(name().unwrap_or_default()))?);
    }
    Ok(Cow::Owned(fix_parameters(system, &exact)?))
}

/// Number of first equations, of `count`, whose components are known; all equations if none are known.
fn known_equations(options: &DecompositionOptions, count: usize) -> Result<usize, ProblemError> {
    let equations = match &options.known {
        None => count,
        Some(known_components) => known_components.equations as usize,
    };
    match (1..=count).contains(&equations) {
        true => Ok(equations),
        false => {
            let said = format!("they are of {equations} equations; the system has {count}");
            Err(ProblemError::Known(said))
        }
    }
}

/// Rank of the Jacobian at a random point; an error where a row of it is not finite, or 0 for its size.
fn rank_at_random(
    equations: &SlicedEquations,
    given: &System,
    seed: u64,
) -> Result<usize, ProblemError> {
    let mut random = RandomStream::new(seed, Purpose::Probe, u64::MAX);
    let point: Vec<Number> = (0..given.variable_count())
        .map(|_| exactly(random.unit()))
        .collect();
    let (_, columns) = equations.linear_part(&point, 0);
    for (row, name) in given.equation_names.iter().enumerate() {
        let size: f64 = columns.iter().map(|c| c[row].norm_sqr()).sum();
        if !size.is_normal() {
            return Err(ProblemError::Range(name.clone()));
        }
    }
    let values = Svd::of(columns).values;
    let largest = values.first().copied().unwrap_or(0.0);
    let clear = values.iter().filter(|&&s| s > RANK_AT_RANDOM * largest);
    Ok(clear.count())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names are for messages: a system of another program may come without.
    #[test]
    fn equations_need_no_names() {
        let text = b"variable_group x, y; function f, g; f = x*y; g = x*(y - 1);";
        let mut system = cognate_systems::formats::read("test", text).unwrap().system;
        system.equation_names.clear();
        let problem = Problem::of_options(&system, &DecompositionOptions::default()).unwrap();
        assert_eq!(problem.prefix(1).unwrap().given.equation_count(), 1);
    }

    #[test]
    fn what_is_not_homogeneous_in_its_group_is_refused() {
        let outcome = |f: &str| {
            let text = format!(
                "CONFIG\nEND;\nINPUT\nhom_variable_group x, y; hom_variable_group u, v; function f; f = {f};\nEND;\n"
            );
            let system = cognate_systems::formats::read("test", text.as_bytes())
                .unwrap()
                .system;
            Problem::of_options(&system, &DecompositionOptions::default()).map(|_| ())
        };
        assert_eq!(outcome("x^2*u - y^2*v"), Ok(()));
        for f in ["x^2*u - y^2", "x*u - y*v + 1", "x^2*u + x*y*v + y*u"] {
            let refused = outcome(f);
            assert!(
                matches!(refused, Err(ProblemError::Degrees(_))),
                "{f}: {refused:?}"
            );
        }
    }

    #[test]
    fn products_beyond_the_range_of_doubles_are_refused_by_name() {
        let product = |count: usize| {
            let factors: Vec<String> = (1..=count)
                .map(|k| format!("(90000000{}*x - 3*y + 7)*(3*x - 90000000{k}*y)", 60 + k))
                .collect();
            let text = format!(
                "CONFIG\nEND;\nINPUT\nvariable_group x, y; function many; many = {};\nEND;\n",
                factors.join("*")
            );
            let system = cognate_systems::formats::read("test", text.as_bytes())
                .unwrap()
                .system;
            Problem::of_options(&system, &DecompositionOptions::default()).map(|_| ())
        };
        // The square of its values is beyond the range; the values are not.
        assert_eq!(product(8), Ok(()));
        assert_eq!(product(100), Err(ProblemError::Range("many".into())));
    }
}

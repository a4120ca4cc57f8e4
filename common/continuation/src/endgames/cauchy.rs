//! Cauchy endgame: turns around t = 0 until the path closes; the mean of the samples is the endpoint.
//!
//! Near t = 0 a path is a power series in t^(1/c), c its winding number. Its
//! value at 0 is the mean over a closed curve of c turns (Morgan, Sommese,
//! Wampler 1991; survey, section 6.5). Branch points inside the radius falsify
//! it: then c different endpoints are joined, and the mean is none of them. The
//! power sums of the c sheets are analytic in t, so their values at 0 are means
//! over the same samples; they vanish only if all sheets end at the mean. An
//! endpoint counts when they do, and when two radii agree on it and on c.

use super::circle::VERTICES;
use super::infinity::{Homogenizing, Infinity, Zero, at_exact_vertex, beside_vertex, vanishes};
use super::winding::Winding;
use crate::chart::norm;
use crate::tracker::settings::Settings;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Real;
use num_complex::Complex64;

/// Ratio of successive radii.
const SHRINKAGE: f64 = 0.125;
/// Next radius, as a part of the distance of the branch points that join the sheets inside the present radius.
const WITHIN: f64 = 0.1;
/// Least ratio of the next radius to the present one when [`WITHIN`] applies: a wrong power sum shows sooner at a
/// radius that is not much smaller.
const BOLDEST: f64 = 1e-3;
/// A power sum of a homogenising coordinate up to this many times the accuracy of the coefficients may be 0 for other
/// coefficients within their accuracy.
const WITHIN_DATA: f64 = 10.0;
/// More digits are used at the present radius, and not at the wanted one, if the wanted one is larger than this part of
/// the present one.
const NEARLY: f64 = 0.8;
/// Where replacing integrals by sums may have made a power sum that is not 0, it is computed again at this part of the
/// radius, where that error is 1e-8 times as large.
const LESS_ALIASED: f64 = 0.3;
/// A power sum that is computed again is not 0 if it differs from the first one by at most this part of it.
const SAME_POWER_SUM: f64 = 0.1;
/// Turns after which a path that has not closed is taken further in, unless it looks as if it diverged; this number
/// doubles every second time. Branch points inside the radius are more frequent than winding numbers above it.
const FIRST_TURNS: u32 = 4;
/// Number of radii at which the path does not close before the ratio of successive radii is squared, then cubed, and so
/// on: branch points this near to 0 may lie at any order of magnitude.
const UNHURRIED: u32 = 2;
/// A power sum counts as 0 below this part of the point's size: in doubles only a smaller radius tells sheets apart
/// that end closer together than about 1e-6.
const COALESCED: f64 = 1e-12;
/// A power sum with more digits than doubles counts as 0 below this part of the distance between the sheets.
const COALESCED_FINELY: f64 = 1e-15;
/// With more digits than doubles, several sheets are believed to end together when turns at this radius agree
/// too: two ends d apart join their sheets outside about d^2 (power sums show it from 1e-15 of that on).
const DEEP: f64 = 1e-10;
/// Smallest exponent with which a coordinate is believed to vanish.
const LEAST_POWER: f64 = 0.01;
/// A coordinate is a power of t where its valuations differ by less than this part.
const UNIFORM: f64 = 0.5;
/// A power of t is believed when its exponent changes by less than this part from radius to radius.
const STEADY: f64 = 0.02;
/// Turns are begun where a valuation has changed by less than this part.
const STEADY_ENOUGH: f64 = 0.1;
/// A power of t is believed, too, when its exponent has not fallen over this many radii: the exponent of a coordinate
/// with a limit falls to 0, while fractional powers of t that come closer and closer to a leading one may creep for
/// ever.
const UNFALLING: u32 = 4;
/// A path that has made this many turns without closing is believed to diverge if the valuations say so.
const BELIEVED: u32 = 32;
/// A path that has not closed after c turns goes on turning where all valuations are below this many times 1/c: where
/// many sheets meet, valuations are small.
const MANY_SHEETS: f64 = 2.0;
/// A path has closed where its distance to its beginning is at most this part of its farthest distance from it.
const RETURNED: f64 = 1e-3;
/// Means over all samples and over every other one must agree to this before a mean is looked at.
const RESOLVED: f64 = 1e-3;

/// Next action of the endgame.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Along the side of the polygon to this vertex of the circle with this radius.
    Vertex {
        /// Radius in t.
        radius: f64,
        /// Number of the vertex, counted from the real axis.
        vertex: u32,
    },
    /// The path goes from the first point of the turn (it is taken back to this point) to this smaller real t.
    Inward(f64),
    /// Two radii agree on an endpoint.
    Settled(Settled),
    /// The path goes to infinity; where it ends there is not settled.
    Diverging {
        /// Turns until the path closed; `None` where only the valuations say it.
        winding_number: Option<u32>,
        /// Turns of each homogenising coordinate, where the path closed.
        infinity_turns: Vec<i32>,
        /// A power sum of a homogenising coordinate that is not 0, but within the accuracy of the
        /// coefficients.
        power_sum: Option<f64>,
    },
    /// The samples of these turns with more digits ([`Cauchy::with_precise_samples`]): whether a homogenising
    /// coordinate vanishes lies below the noise of these.
    PreciseSamples,
    /// The turns are made again at this radius with more digits, which Newton's method at the samples does not give.
    Finer,
    /// Smaller radii would not help.
    Unsettled,
}

/// An endpoint on which the samples at two radii agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// The endpoint, in the chart.
    pub endpoint: Vec<Complex64>,
    /// Turns until the path closed.
    pub winding_number: u32,
    /// Estimated relative error.
    pub accuracy: f64,
    /// Turns of each homogenising coordinate.
    pub infinity_turns: Vec<i32>,
    /// Radius of the last turns.
    pub radius: f64,
}

/// A sample of a path with more digits than it was followed in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PreciseSample {
    /// Values of the homogenising coordinates at the vertex itself.
    pub homogenizing: Vec<Homogenizing>,
    /// Relative error of the point, at most.
    pub noise: f64,
}

/// The state of one path in the endgame.
#[derive(Clone, Debug, Default)]
pub struct Cauchy {
    radius: f64,
    start: Vec<Complex64>,
    sum: Vec<Complex64>,
    even_sum: Vec<Complex64>,
    /// A generic linear form of each sample less that of the first, for the power sums.
    samples: Vec<Complex64>,
    /// Whether the samples had more digits than doubles before they were rounded.
    fine: bool,
    vertex: u32,
    turns: u32,
    total_turns: u32,
    /// Number of radii at which the path did not close.
    unclosed: u32,
    /// Whether the turns can be made with more digits.
    may_be_finer: bool,
    noise: f64,
    /// t of the samples of the present turns in doubles, if these turns can be made with more digits; `points` are the
    /// points there, one after another.
    places: Vec<Complex64>,
    points: Vec<Complex64>,
    /// Whether the homogenising coordinates have more digits than the points; relative error of the points they are of.
    precise: Option<f64>,
    /// The power sum that was not 0 with more digits at the radius before.
    apart: Option<f64>,
    /// Valuations of the homogenising coordinates at all samples, sample after sample.
    valuations: Vec<Complex64>,
    /// The exponents that were found at the radius before, and at how many radii up to it none fell.
    powers: Vec<Option<(f64, u32)>>,
    infinity: Vec<Winding>,
    /// Values of the homogenising coordinates at all samples, sample after sample.
    homogenizing: Vec<Homogenizing>,
    previous: Option<(u32, Vec<Complex64>)>,
    /// Radius within which more digits are needed, as turns in fewer digits showed.
    within: Option<f64>,
}

/// Coefficients without pattern of a linear form: different points of a generic patch have
/// different values.
pub(crate) fn generic_form() -> impl Iterator<Item = Complex64> {
    let mut stream = RandomStream::new(0, Purpose::Probe, 1);
    std::iter::repeat_with(move || stream.unit())
}

/// The generic linear form of [`generic_form`] at the difference of two points.
pub(crate) fn form_of_difference(x: &[Complex64], y: &[Complex64]) -> Complex64 {
    let both = x.iter().zip(y).zip(generic_form());
    both.map(|((x, y), c)| (x - y) * c).sum()
}

/// The exponent, where all valuations are one positive number.
fn power<'a>(valuations: impl Iterator<Item = &'a Complex64> + Clone) -> Option<f64> {
    let count = valuations.clone().count() as f64;
    let mean = valuations.clone().sum::<Complex64>() / count;
    let off = valuations.fold(0.0f64, |m, v| m.max((v - mean).norm_sqr()));
    let uniform = off <= (UNIFORM * mean.re) * (UNIFORM * mean.re);
    let real = mean.im.abs() <= STEADY * mean.re;
    (mean.re >= LEAST_POWER && uniform && real).then_some(mean.re)
}

/// Whether a valuation is that of a coordinate that goes to 0 like a power of t, and the same as before.
pub(crate) fn is_steady(valuation: Complex64, before: Complex64) -> bool {
    let change = (valuation - before).norm_sqr();
    valuation.re >= LEAST_POWER
        && change <= (STEADY_ENOUGH * valuation.re) * (STEADY_ENOUGH * valuation.re)
}

/// Largest modulus of the difference.
pub(crate) fn distance(x: &[Complex64], y: &[Complex64]) -> f64 {
    x.iter()
        .zip(y)
        .fold(0.0f64, |m, (a, b)| m.max((a - b).norm_sqr()))
        .sqrt()
}

impl Cauchy {
    /// Forgets the path before.
    pub fn clear(&mut self) {
        self.forget();
        self.total_turns = 0;
    }

    /// Forgets the turns, not how many they were.
    pub fn forget(&mut self) {
        self.previous = None;
        self.within = None;
        self.unclosed = 0;
        self.apart = None;
        self.powers.clear();
    }

    /// All turns made for this path.
    pub fn total_turns(&self) -> u32 {
        self.total_turns
    }

    /// The mean at this radius, where the path closed after one turn.
    pub fn closed_after_one_turn(&self) -> Option<&[Complex64]> {
        match &self.previous {
            Some((1, mean)) => Some(mean),
            _ => None,
        }
    }

    /// Relative error of the samples of the present turns, at most.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Radius of the present turns.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Point where the present turns began, at t = radius.
    pub fn start(&self) -> &[Complex64] {
        &self.start
    }

    /// The mean over the samples of the present turns.
    pub(crate) fn mean(&self) -> Vec<Complex64> {
        let samples = f64::from(self.turns * VERTICES);
        self.sum.iter().map(|s| s / samples).collect()
    }

    /// The path stands at real t = radius: the turns begin here.
    ///
    /// `homogenizing` are the values of the homogenising coordinates at the point; `fine`: whether
    /// the forms at the vertices have more digits than doubles before they are rounded;
    /// `may_be_finer`: whether the turns can be made with more digits.
    pub fn begin(
        &mut self,
        radius: f64,
        point: &[Complex64],
        noise: f64,
        homogenizing: &[Homogenizing],
        [fine, may_be_finer]: [bool; 2],
    ) -> Next {
        (self.fine, self.may_be_finer) = (fine, may_be_finer);
        self.radius = radius;
        self.start.clear();
        self.start.extend_from_slice(point);
        self.sum.clear();
        self.sum.extend_from_slice(point);
        self.even_sum.clear();
        self.even_sum.extend_from_slice(point);
        self.samples.clear();
        self.samples.push(Complex64::default());
        self.vertex = 0;
        self.turns = 0;
        self.noise = noise;
        self.places.clear();
        self.points.clear();
        self.precise = None;
        self.keep(Complex64::new(radius, 0.0), point);
        self.valuations.clear();
        self.infinity.resize(homogenizing.len(), Winding::default());
        self.homogenizing.clear();
        self.homogenizing.extend_from_slice(homogenizing);
        for (winding, z) in self.infinity.iter_mut().zip(homogenizing) {
            winding.clear();
            winding.sample(z.lane(0));
        }
        match self.within.take() {
            Some(within) if within < NEARLY * radius => Next::Inward(within),
            _ => Next::Vertex { radius, vertex: 1 },
        }
    }

    /// The path stands at the vertex that was asked for, at `t`. `noise`: relative error of the point;
    /// `form`: the generic form of its difference from where the turns began; `valuations`: t x'/x
    /// of the homogenising coordinates x.
    pub fn at_vertex(
        &mut self,
        t: Complex64,
        point: &[Complex64],
        noise: f64,
        form: Complex64,
        homogenizing: &[Homogenizing],
        valuations: &[Complex64],
        settings: &Settings,
    ) -> Next {
        self.valuations.extend_from_slice(valuations);
        self.noise = self.noise.max(noise);
        for (winding, z) in self.infinity.iter_mut().zip(homogenizing) {
            winding.sample(z.lane(0));
        }
        self.vertex += 1;
        let (radius, vertex) = (self.radius, self.vertex);
        let both = homogenizing.iter().zip(valuations);
        let homogenizing: Vec<Homogenizing> = both
            .map(|(value, &valuation)| at_exact_vertex(value, valuation, t, radius, vertex))
            .collect();
        if self.vertex < VERTICES {
            self.add(t, point, form, &homogenizing);
            return Next::Vertex {
                radius: self.radius,
                vertex: self.vertex + 1,
            };
        }
        self.turns += 1;
        self.total_turns += 1;
        self.vertex = 0;
        let size = norm(point);
        let closed = (1e-9f64).max(100.0 * self.noise);
        if distance(point, &self.start) > closed * size || !self.returns(form, size) {
            return self.after_open_turn(t, point, form, &homogenizing, settings);
        }
        self.keep(t, point);
        self.after_closing(settings)
    }

    /// The path is back where its turns began.
    fn after_closing(&mut self, settings: &Settings) -> Next {
        let size = norm(&self.start);
        let infinity = self.at_infinity(size, settings);
        if let (Infinity::Apart { power_sum, .. }, Some(_)) = (infinity, self.precise)
            && !self.is_apart(power_sum)
        {
            self.previous = None;
            return self.inward(LESS_ALIASED, settings);
        }
        match infinity {
            Infinity::Shown => return self.diverging(None),
            Infinity::BelowNoise { within } if self.may_be_finer => {
                self.previous = None;
                return self.below_noise(within, settings);
            }
            Infinity::Apart { part, power_sum } if WITHIN * part < SHRINKAGE => {
                // One sheet ends at a regular point, however far out: it is followed.
                let within_data =
                    self.turns > 1 && power_sum <= WITHIN_DATA * settings.data_accuracy;
                if within_data && !settings.exact_data {
                    return self.diverging(Some(power_sum));
                }
                self.previous = None;
                return self.inward((WITHIN * part).max(BOLDEST), settings);
            }
            Infinity::BelowNoise { .. }
            | Infinity::Unresolved
            | Infinity::Apart { .. }
            | Infinity::No => {}
        }
        let samples = f64::from(self.turns * VERTICES);
        let mean = self.mean();
        let even: Vec<Complex64> = self.even_sum.iter().map(|s| s / (0.5 * samples)).collect();
        let size = norm(&mean);
        let unresolved = distance(&mean, &even) / size;
        if unresolved > RESOLVED {
            self.previous = None;
            return self.inward(SHRINKAGE, settings);
        }
        if let Some(separation) = self.separation(size, unresolved) {
            // The sheets end apart. Two sheets s apart at this radius r and d apart at 0 are
            // joined by a branch point at about r (d/s)^2: go inside it at once.
            let ratio = if self.turns == 2 {
                (0.25 * separation).clamp(1e-4, SHRINKAGE)
            } else {
                SHRINKAGE
            };
            self.previous = None;
            return self.inward(ratio, settings);
        }
        if let Some((turns, previous)) = &self.previous {
            let change = distance(&mean, previous) / size;
            let agree = *turns == self.turns && change <= settings.endgame_tolerance;
            if agree && self.fine && self.turns > 1 && self.radius > DEEP {
                return Next::Inward(DEEP.max(settings.endgame_min_radius));
            }
            let open = matches!(infinity, Infinity::Unresolved | Infinity::BelowNoise { .. });
            if agree && !open {
                // The aliasing error falls with the 16th power of the radius, so the newer mean
                // is better than the change by far; what remains is the noise of the samples.
                let accuracy = (0.01 * change)
                    .max(unresolved * unresolved)
                    .max(self.noise)
                    .max(f64::EPSILON);
                return Next::Settled(Settled {
                    endpoint: mean,
                    winding_number: self.turns,
                    accuracy,
                    infinity_turns: self.infinity.iter().map(Winding::turns).collect(),
                    radius: self.radius,
                });
            }
        }
        self.previous = Some((self.turns, mean));
        self.inward(SHRINKAGE, settings)
    }

    /// Whether a power sum that is not 0 is the same at two radii: errors of replacing integrals by sums, of which there
    /// is an estimate only, are not.
    fn is_apart(&mut self, power_sum: f64) -> bool {
        let before = self.apart.replace(power_sum);
        before.is_some_and(|before| (power_sum - before).abs() <= SAME_POWER_SUM * before)
    }

    /// Whether a homogenising coordinate vanishes lies below the noise of the samples.
    fn below_noise(&mut self, within: f64, settings: &Settings) -> Next {
        match self.precise {
            None if !self.fine => Next::PreciseSamples,
            Some(_) if within < NEARLY => self.inward(within, settings),
            _ => {
                self.within = Some(self.radius * within);
                Next::Finer
            }
        }
    }

    /// For each sample of the closed turns, t and the distance of its vertex from this t; and the points, one after
    /// another. The last sample is the first again.
    pub(crate) fn samples(&self) -> (Vec<[Complex64; 2]>, &[Complex64]) {
        let beside = |(&t, vertex)| [t, beside_vertex(t, self.radius, vertex)];
        (
            self.places.iter().zip(0..).map(beside).collect(),
            &self.points,
        )
    }

    /// [`Next::PreciseSamples`] are these; `None` where Newton's method finds none. At small radii all sheets of a cycle
    /// are near one another, so that a path may not have closed.
    pub(crate) fn with_precise_samples(
        &mut self,
        samples: Option<Vec<PreciseSample>>,
        settings: &Settings,
    ) -> Next {
        let Some(samples) = samples else {
            self.within = Some(self.radius);
            return Next::Finer;
        };
        let mut noise = 0.0f64;
        let mut exact = Vec::with_capacity(samples.len() * self.infinity.len());
        for sample in &samples {
            exact.extend_from_slice(&sample.homogenizing);
            noise = noise.max(sample.noise);
        }
        let closing_samples = exact.split_off(exact.len() - self.infinity.len());
        let groups = self.infinity.len();
        let closes = closing_samples
            .iter()
            .enumerate()
            .all(|(k, closing_sample)| {
                let from_first = |z: &Homogenizing| {
                    let mut difference = *z;
                    difference.sub(&exact[k]);
                    difference.lane(0).norm_sqr()
                };
                let away = exact.iter().skip(k).step_by(groups).map(from_first);
                let away = away.fold(0.0, f64::max).sqrt();
                let noise = 100.0 * noise * norm(&self.start);
                from_first(closing_sample).sqrt() <= (RETURNED * away).max(noise)
            });
        if !closes {
            self.within = Some(self.radius);
            return Next::Finer;
        }
        self.homogenizing = exact;
        self.precise = Some(noise);
        self.after_closing(settings)
    }

    /// A turn is made that has not brought the path back to where its turns began: another one here, or further in.
    fn after_open_turn(
        &mut self,
        t: Complex64,
        point: &[Complex64],
        form: Complex64,
        homogenizing: &[Homogenizing],
        settings: &Settings,
    ) -> Next {
        // A solution as near to infinity as t^(1/c) is here belongs to c sheets, which close: what
        // looks like divergence is believed where more sheets than are tried meet.
        let most = settings.max_winding_number;
        let believed = BELIEVED.min(most);
        let patience = (FIRST_TURNS << (self.unclosed / 2).min(16)).min(believed);
        let diverges = self.turns >= patience && self.powers_here();
        if self.turns >= patience && !diverges && !self.many_sheets() {
            self.powers.clear();
            return self.not_closed(settings);
        }
        if self.turns >= most || diverges && self.turns >= believed {
            return self.does_not_close(settings);
        }
        self.add(t, point, form, homogenizing);
        Next::Vertex {
            radius: self.radius,
            vertex: 1,
        }
    }

    /// The largest power sum at t = 0 as a part of the largest possible one (for two sheets: the square of the ratio of
    /// their distance at t = 0 to their distance here); `None` when all sheets end together.
    fn separation(&self, size: f64, unresolved: f64) -> Option<f64> {
        let count = self.samples.len() as f64;
        let mean = self.samples.iter().sum::<Complex64>() / count;
        let spread = self
            .samples
            .iter()
            .fold(0.0f64, |m, y| m.max((y - mean).norm_sqr()))
            .sqrt();
        let rounding = match self.fine {
            true => COALESCED_FINELY * spread,
            false => COALESCED * size,
        };
        let mut largest: Option<f64> = None;
        for k in 2..=self.turns {
            let power_sum: Complex64 = self.samples.iter().map(|y| (y - mean).powu(k)).sum();
            let mut mean_power = (power_sum / count).norm_sqr();
            Real::sqrt(&mut mean_power);
            // Rounding errors of the samples, and the error of replacing integrals by sums: that
            // of 16 samples is the square of that of 8.
            let aliasing = unresolved * size / spread;
            let error = f64::from(k) * (rounding + 10.0 * self.noise * size)
                + 100.0 * f64::from(k * k) * aliasing * aliasing * spread;
            let mut bound = error;
            let mut scale = 1.0;
            for _ in 1..k {
                bound *= spread;
                scale *= spread;
            }
            if mean_power > bound {
                let part = mean_power / (scale * spread);
                largest = Some(largest.map_or(part, |l| l.max(part)));
            }
        }
        largest.map(|part| part.min(1.0))
    }

    /// Whether some homogenising coordinate is a positive power of t here, and was the same at the
    /// radius before: its valuation t x'/x is one number all around, and that number stays, or
    /// has not fallen for long.
    ///
    /// A path to infinity need not close for that. (Valuations as evidence of
    /// divergence: Breiding, Timme, HomotopyContinuation.jl, 2018; Huber, Verschelde, Polyhedral
    /// end games, 1998.)
    fn diverges(&mut self) -> bool {
        let groups = self.infinity.len();
        self.powers.resize(groups, None);
        let mut diverges = false;
        for (k, before) in self.powers.iter_mut().enumerate() {
            let exponent = power(self.valuations.iter().skip(k).step_by(groups));
            *before = match (exponent, &before) {
                (None, _) => None,
                (Some(exponent), None) => Some((exponent, 1)),
                (Some(exponent), Some((previous_exponent, radii))) => {
                    diverges |= (exponent - previous_exponent).abs() <= STEADY * exponent;
                    let falls = exponent < (1.0 - STEADY) * previous_exponent;
                    Some((exponent, if falls { 1 } else { radii + 1 }))
                }
            };
            diverges |= before.is_some_and(|(_, radii)| radii >= UNFALLING);
        }
        diverges
    }

    /// Whether a path is back where its turns began: by less than a part of how far it went away, but for noise. At
    /// small radii all sheets of a cycle are near one another, which is seen with more digits than doubles.
    fn returns(&self, form: Complex64, size: f64) -> bool {
        let away = self
            .samples
            .iter()
            .map(Complex64::norm_sqr)
            .fold(0.0, f64::max)
            .sqrt();
        let noise = 100.0 * self.noise.max(f64::EPSILON * f64::EPSILON);
        !self.fine || form.norm_sqr().sqrt() <= (RETURNED * away).max(noise * size)
    }

    /// Keeps a sample whose digits may have to be more.
    fn keep(&mut self, t: Complex64, point: &[Complex64]) {
        if self.may_be_finer && !self.fine {
            self.places.push(t);
            self.points.extend_from_slice(point);
        }
    }

    fn add(
        &mut self,
        t: Complex64,
        point: &[Complex64],
        form: Complex64,
        homogenizing: &[Homogenizing],
    ) {
        self.keep(t, point);
        self.samples.push(form);
        self.homogenizing.extend_from_slice(homogenizing);
        let even = self.vertex.is_multiple_of(2);
        for (k, z) in point.iter().enumerate() {
            self.sum[k] += z;
            if even {
                self.even_sum[k] += z;
            }
        }
    }

    /// Whether some homogenising coordinate is a positive power of t all around.
    fn powers_here(&self) -> bool {
        let groups = self.infinity.len();
        (0..groups).any(|k| power(self.valuations.iter().skip(k).step_by(groups)).is_some())
    }

    /// Whether the homogenising coordinates change by less than [`MANY_SHEETS`] allows for the turns so far: those of c
    /// sheets that end at one finite point change like t^(1/c).
    fn many_sheets(&self) -> bool {
        let least = MANY_SHEETS / f64::from(self.turns);
        let still = |v: &Complex64| v.norm_sqr() <= least * least;
        self.valuations.iter().all(still)
    }

    /// Decides for a path that does not close within as many turns as are tried; the path may diverge.
    fn does_not_close(&mut self, settings: &Settings) -> Next {
        match self.diverges() {
            true => Next::Diverging {
                winding_number: None,
                infinity_turns: Vec::new(),
                power_sum: None,
            },
            false => self.not_closed(settings),
        }
    }

    /// Ends the endgame of a closed path that goes to infinity, or to a point as far out as infinity for these
    /// coefficients.
    fn diverging(&self, power_sum: Option<f64>) -> Next {
        Next::Diverging {
            winding_number: Some(self.turns),
            infinity_turns: self.infinity.iter().map(Winding::turns).collect(),
            power_sum,
        }
    }

    /// Continues at a smaller radius after two radii agreed on a point that is no solution. The point is then the
    /// constant term of a Laurent series: branch points or poles lie inside both radii.
    pub fn agreed_on_none(&mut self, settings: &Settings) -> Next {
        self.previous = None;
        self.inward(SHRINKAGE, settings)
    }

    /// The turns at this radius have not closed.
    fn not_closed(&mut self, settings: &Settings) -> Next {
        self.unclosed += 1;
        self.previous = None;
        self.further_inward(settings)
    }

    /// Whether some homogenising coordinate vanishes at t = 0 on all sheets that the path has
    /// joined; the path has closed.
    ///
    /// The power sums of its values on the sheets are analytic in t, so that their values at 0 are
    /// means over the samples, and they are all 0 only if every sheet's value is (Newton's identities).
    /// `size`: largest coordinate.
    fn at_infinity(&self, size: f64, settings: &Settings) -> Infinity {
        let groups = self.infinity.len();
        let mut verdict = Infinity::No;
        for (k, winding) in self.infinity.iter().enumerate() {
            let samples: Vec<&Homogenizing> =
                self.homogenizing.iter().skip(k).step_by(groups).collect();
            let turns = winding.turns() > 0;
            let zero = Zero::of(settings, self.may_be_finer);
            let noise = self.precise.unwrap_or(self.noise);
            let here = vanishes(&samples, self.turns, turns, noise, size, zero);
            match here {
                Infinity::Shown => return Infinity::Shown,
                Infinity::BelowNoise { .. } => verdict = here,
                Infinity::Apart { .. } if !matches!(verdict, Infinity::BelowNoise { .. }) => {
                    verdict = here;
                }
                Infinity::Unresolved if verdict == Infinity::No => verdict = here,
                Infinity::Apart { .. } | Infinity::Unresolved | Infinity::No => {}
            }
        }
        verdict
    }

    /// Where the path does not close: the smallest radius is not left out.
    fn further_inward(&self, settings: &Settings) -> Next {
        let mut ratio = SHRINKAGE;
        for _ in 0..self.unclosed.saturating_sub(1) / UNHURRIED {
            ratio *= SHRINKAGE;
        }
        match self.inward(SHRINKAGE, settings) {
            Next::Inward(_) => Next::Inward((self.radius * ratio).max(settings.endgame_min_radius)),
            next => next,
        }
    }

    fn inward(&self, ratio: f64, settings: &Settings) -> Next {
        let radius = self.radius * ratio;
        if radius < settings.endgame_min_radius {
            return Next::Unsettled;
        }
        Next::Inward(radius)
    }
}

#[cfg(test)]
mod tests;

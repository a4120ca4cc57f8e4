//! Estimate: how many solutions there are, from how many were met again.
//!
//! If edges match the N classes at one vertex with those at another at random, every matching as
//! likely as any other, then a path from a class without a partner, on an edge with c pairs, arrives at
//! one of the r known classes with probability (r - c) / (N - c), and at a new one with (N - r) / (N - c). The
//! product over all paths depends on N only through
//!
//! L(N) = prod over vertices of (N)_r / prod over edges of (N)_c / (N)_s,   (N)_k = N (N - 1) ... (N - k + 1),
//!
//! with r classes known at a vertex, c pairs on an edge, and s classes with which all began: nothing else
//! of the history matters. That is capture and recapture, as Hauenstein and Sherman (Using monodromy to
//! statistically estimate the number of solutions, 2020) use it for loops. With D the largest r and each
//! N >= D as likely as any other before anything was tracked, none is missing with probability L(D) / sum L(N).
//! Where the monodromy group is small, or some places are alike, matchings are not random, and it says too much.

use serde::{Deserialize, Serialize};

/// Assumption of an estimate, in words for the user.
pub const ASSUMPTION: &str = "loops permute the classes at random, every permutation as likely as \
     any other, and before any was made every number of classes was as likely as any other";

/// Estimate of the number of classes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The number that makes what was seen likeliest; `None` where no number does.
    pub likeliest: Option<u64>,
    /// The probability that no class is missing.
    pub confidence: f64,
    /// Assumption of both numbers.
    pub assumption: String,
}

impl Estimate {
    /// Estimate from the numbers of known classes at each vertex (not all 0), of known pairs on each edge, and of the
    /// classes with which the solve began.
    pub(crate) fn new(vertices: &[usize], edges: &[usize], started: usize) -> Self {
        let least_count = vertices.iter().copied().max().unwrap_or(0) as u64;
        // L(N) / L(N - 1).
        let grows = |n: u64| -> f64 {
            let n = n as f64;
            let part = |k: &usize| (n - *k as f64) / n;
            let vertex_factor: f64 = vertices.iter().map(part).product();
            let met: f64 = edges.iter().map(part).product();
            met * part(&started) / vertex_factor
        };
        // As N grows, L falls like a power of it with this exponent, from where it has its largest value on.
        let fall =
            (edges.iter().sum::<usize>() + started) as f64 - vertices.iter().sum::<usize>() as f64;
        let (mut n, mut term, mut sum) = (least_count, 1.0, 1.0);
        let (mut largest, mut likeliest) = (1.0, least_count);
        let last = least_count
            .saturating_mul(REACH)
            .saturating_add(LEAST_REACH);
        while n < last && term > NEGLIGIBLE * sum {
            n += 1;
            term *= grows(n);
            sum += term;
            if term > largest {
                (largest, likeliest) = (term, n);
            }
        }
        // Sum of the further terms, which fall like a power of n.
        let beyond = match fall > 1.0 {
            true => term * n as f64 / (fall - 1.0),
            false => f64::INFINITY,
        };
        let confidence = 1.0 / (sum + beyond);
        Self {
            likeliest: (likeliest < last && fall > 0.0).then_some(likeliest),
            confidence: if confidence.is_finite() {
                confidence
            } else {
                0.0
            },
            assumption: ASSUMPTION.to_string(),
        }
    }
}

impl Estimate {
    /// The estimate for loops that do not permute at random: it claims nothing.
    pub(crate) fn without_confidence(self) -> Self {
        Self {
            confidence: 0.0,
            ..self
        }
    }
}

/// A probability near 1 for people: as many nines as it has, and one digit more.
pub fn percent(probability: f64) -> String {
    let doubt = 1.0 - probability;
    let (mut digits, mut unit) = (1, 1e-3);
    while doubt < unit && digits < 10 {
        (digits, unit) = (digits + 1, unit / 10.0);
    }
    // Cut, not rounded: 100 % would be a promise.
    let power = (0..digits + 2).fold(1.0, |power, _| power * 10.0);
    let cut = (probability * power).floor() / power;
    format!("{:.*} %", digits, (cut * 100.0).min(100.0 - 1e-10))
}

/// Numbers of classes up to this many times the known number are added up one by one.
const REACH: u64 = 16;
/// Further numbers of classes that are added up one by one.
const LEAST_REACH: u64 = 1000;
/// The sum ends at terms below this part of it.
const NEGLIGIBLE: f64 = 1e-18;

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    /// Two vertices of a made-up family, their matchings, and what is known of them.
    struct Population {
        matchings: Vec<Vec<usize>>,
        known: [Vec<bool>; 2],
        pairs: Vec<Vec<bool>>,
        random: RandomStream,
    }

    impl Population {
        fn new(size: usize, seed: u64) -> Self {
            let mut population = Self {
                matchings: Vec::new(),
                known: [vec![false; size], vec![false; size]],
                pairs: Vec::new(),
                random: RandomStream::new(seed, Purpose::Test, 0),
            };
            population.known[0][0] = true;
            population
        }

        fn add_edge(&mut self) {
            let size = self.known[0].len();
            let mut order: Vec<usize> = (0..size).collect();
            for i in (1..size).rev() {
                order.swap(i, self.random.below(i as u64 + 1) as usize);
            }
            self.matchings.push(order);
            self.pairs.push(vec![false; size]);
        }

        /// Tracks one path somewhere; false where all pairs of what is known are.
        fn track(&mut self) -> bool {
            let mut open = Vec::new();
            for (edge, order) in self.matchings.iter().enumerate() {
                for (source, &target) in order.iter().enumerate() {
                    // From either end.
                    for is_known in [self.known[0][source], self.known[1][target]] {
                        if is_known && !self.pairs[edge][source] {
                            open.push((edge, source, target));
                        }
                    }
                }
            }
            if open.is_empty() {
                return false;
            }
            let (edge, source, target) = open[self.random.below(open.len() as u64) as usize];
            self.pairs[edge][source] = true;
            self.known[0][source] = true;
            self.known[1][target] = true;
            true
        }

        fn estimate(&self) -> Estimate {
            let count = |flags: &Vec<bool>| flags.iter().filter(|&&flag| flag).count();
            let vertices: Vec<usize> = self.known.iter().map(count).collect();
            let edges: Vec<usize> = self.pairs.iter().map(count).collect();
            Estimate::new(&vertices, &edges, 1)
        }

        fn whole(&self) -> bool {
            self.known.iter().flatten().all(|&is_known| is_known)
        }
    }

    /// Of 60, after 90 paths along three edges: the mean of 200 estimates is near, though many are not
    /// known yet.
    #[test]
    fn a_population_is_estimated_before_all_of_it_is_known() {
        let (mut sum, mut known_points, mut trials) = (0, 0, 0);
        for seed in 0..200 {
            let mut population = Population::new(60, seed);
            (0..3).for_each(|_| population.add_edge());
            let tracked = (0..90).filter(|_| population.track()).count();
            // A few begin on a small cycle.
            if tracked < 90 {
                continue;
            }
            let estimate = population.estimate();
            known_points += population.known[0]
                .iter()
                .filter(|&&is_known| is_known)
                .count() as u64;
            sum += estimate.likeliest.expect("pairs were met again");
            trials += 1;
        }
        let (mean, known_mean) = (
            sum as f64 / trials as f64,
            known_points as f64 / trials as f64,
        );
        assert!(trials > 180 && known_mean < 50.0, "{trials} {known_mean}");
        assert!((mean - 60.0).abs() < 4.0, "{mean}");
    }

    /// Loops that end at a confidence of 0.9 miss something in about a tenth of the cases, at 0.5 in more
    /// than that, and at 0.999 never in so few.
    #[test]
    fn what_is_promised_is_kept() {
        let missed = |confidence: f64| -> f64 {
            let mut wrong = 0;
            for seed in 0..400 {
                let mut population = Population::new(8, seed);
                (0..2).for_each(|_| population.add_edge());
                while population.estimate().confidence < confidence {
                    if !population.track() {
                        population.add_edge();
                    }
                }
                wrong += u32::from(!population.whole());
            }
            f64::from(wrong) / 400.0
        };
        let (half, most, nearly_all) = (missed(0.5), missed(0.9), missed(0.999));
        assert!(half > 0.12 && half < 0.6, "{half}");
        assert!(most > 0.0 && most < 0.12, "{most}");
        assert!(nearly_all < 0.004, "{nearly_all}");
    }

    /// With all pairs known, of L loops: the next number is as likely as D / (D + 1)^L.
    #[test]
    fn the_formula_is_the_product_over_paths() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-3 * b;
        // D = 100, two vertices, four edges: L = 3.
        let estimate = Estimate::new(&[100, 100], &[100, 100, 100, 100], 1);
        assert_eq!(estimate.likeliest, Some(100));
        let missing = 100.0 / 101f64.powi(3);
        assert!(close(1.0 - estimate.confidence, missing), "{estimate:?}");
        // One class: the sums of 1 / N^2 and of 1 / N^4 are pi^2 / 6 and pi^4 / 90.
        let [two, four] = [3, 5].map(|edges| Estimate::new(&[1, 1], &vec![1; edges], 1).confidence);
        assert!(close(two, 1.0 / 1.644_934_1), "{two}");
        assert!(close(four, 1.0 / 1.082_323_2), "{four}");
        // A path that may arrive anywhere says nothing.
        let nothing = Estimate::new(&[5, 5], &[5], 1);
        assert!(nothing.confidence < 1e-3, "{nothing:?}");
        assert_eq!(Estimate::new(&[1], &[], 1).confidence, 0.0);
    }
}

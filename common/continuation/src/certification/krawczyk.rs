//! Krawczyk's test: in balls of doubles, eight points at a time, for the easy ones, in MPFR with more and more bits
//! for the rest.
//!
//! For a box c + B with B_i = [-r_i, r_i] + i [-r_i, r_i] and any matrix C, the
//! operator is K = c - C F(c) + (1 - C F'(c + B)) B. If K lies in the interior
//! of the box, there is exactly one zero of F in the box, and it is in K
//! (Krawczyk 1969; Rump 1983; arXiv 2011.05000 section 3). All of it is evaluated
//! in numbers that enclose the exact system, so the proof is about the input.

use super::candidate::Candidate;
use super::certificate::{Certificate, Certification, Uncertified};
use super::chart::Chart;
use super::in_lanes::TestInLanes;
use super::multiple_precision;
use super::proved::Proved;
use cognate_numeric::lanes::called::WIDTH;
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// The test for points of one system.
#[derive(Debug)]
pub struct Krawczyk {
    program: Interpreter,
    /// The homogeneous groups, each with its variables.
    homogeneous: Vec<Vec<usize>>,
}

impl Krawczyk {
    /// For a square system: as many equations as variables, less one for each homogeneous group.
    ///
    /// # Panics
    /// When it is not square.
    pub fn new(system: &System) -> Self {
        assert_eq!(
            system.equation_count(),
            system.dimension(),
            "only a square system has isolated solutions that a box can show"
        );
        let groups = system.groups.iter().filter(|group| group.homogeneous);
        Self {
            program: Interpreter::compile(
                &system.expressions,
                &system.equations,
                system.variable_count(),
                system.parameters.len(),
            ),
            homogeneous: groups.map(|group| group.variables.clone()).collect(),
        }
    }

    /// The variables of each homogeneous group.
    pub fn homogeneous(&self) -> &[Vec<usize>] {
        &self.homogeneous
    }

    /// Tries to prove of each point that there is exactly one solution near it; in their order.
    ///
    /// Pure: the same system, parameters and point give the same bits, whatever stands beside them.
    ///
    /// # Panics
    /// When a candidate has not as many parameters as the system.
    pub fn certify_all(&self, candidates: &[Candidate<'_>]) -> Vec<Certification> {
        let shape = Evaluate::<f64>::shape(&self.program);
        assert!(
            candidates
                .iter()
                .all(|candidate| candidate.parameters.len() == shape.parameters),
            "every parameter has a value"
        );
        let charts: Vec<Option<Chart>> = candidates
            .iter()
            .map(|candidate| Chart::of(candidate.point, shape.variables, &self.homogeneous))
            .collect();
        let mut proved = self.in_doubles(candidates, &charts);
        let mut certify = |place: usize| -> Result<Certificate, Uncertified> {
            let chart = charts[place].as_ref().ok_or(Uncertified::DamagedPoint)?;
            let proof = match proved[place].take() {
                Some(proof) => proof,
                None => multiple_precision::prove(&self.program, &candidates[place], chart)?,
            };
            Ok(proof.certificate(&chart.free))
        };
        (0..candidates.len())
            .map(|place| match certify(place) {
                Ok(certificate) => Certification::Certified(Box::new(certificate)),
                Err(reason) => Certification::Uncertified(reason),
            })
            .collect()
    }

    /// [`Self::certify_all`] for one point.
    pub fn certify(&self, parameters: &[Complex64], point: &[Complex64]) -> Certification {
        let mut one = self.certify_all(&[Candidate { parameters, point }]);
        one.pop().expect("an outcome for each candidate")
    }

    /// Tries to certify all candidates in double precision; points with the same free variables share the lanes.
    fn in_doubles(
        &self,
        candidates: &[Candidate<'_>],
        charts: &[Option<Chart>],
    ) -> Vec<Option<Proved>> {
        let mut alike: BTreeMap<&[usize], Vec<usize>> = BTreeMap::new();
        for (place, chart) in charts.iter().enumerate() {
            if let Some(chart) = chart {
                alike.entry(&chart.free).or_default().push(place);
            }
        }
        let mut proved = vec![None; candidates.len()];
        let mut test: Option<TestInLanes<'_>> = None;
        for (free, places) in alike {
            for places in places.chunks(WIDTH) {
                let points: Vec<Candidate<'_>> = places
                    .iter()
                    .map(|&place| Candidate {
                        parameters: candidates[place].parameters,
                        point: charts[place].as_ref().map_or(&[], |chart| &chart.point),
                    })
                    .collect();
                let test = test.get_or_insert_with(|| TestInLanes::new(&self.program));
                for (&place, proof) in places.iter().zip(test.prove(free, &points)) {
                    proved[place] = proof;
                }
            }
        }
        proved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::rational::{ComplexRational, Rational};
    use cognate_numeric::scalar::MultiplePrecision;
    use cognate_systems::formats::read;
    use cognate_systems::named::{griewank_osborne, katsura};

    fn system(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        read("test", text.as_bytes()).unwrap().system
    }

    fn real(values: &[f64]) -> Vec<Complex64> {
        values.iter().map(|&re| Complex64::new(re, 0.0)).collect()
    }

    fn certified(krawczyk: &Krawczyk, point: &[Complex64]) -> Certificate {
        match krawczyk.certify(&[], point) {
            Certification::Certified(certificate) => {
                assert!(certificate.is_sound());
                *certificate
            }
            Certification::Uncertified(reason) => panic!("{}", reason.describe()),
        }
    }

    fn refused(krawczyk: &Krawczyk, point: &[Complex64]) -> Uncertified {
        match krawczyk.certify(&[], point) {
            Certification::Uncertified(reason) => reason,
            Certification::Certified(certificate) => {
                panic!("nothing can be proved here: {certificate:?}")
            }
        }
    }

    #[test]
    fn a_square_root_is_enclosed_from_exact_input() {
        // x^2 = 1/10, of which no double knows the right side.
        let system = system("variable_group x; function f; f = x^2 - 0.1;");
        let krawczyk = Krawczyk::new(&system);
        let certificate = certified(&krawczyk, &real(&[0.3162]));
        assert_eq!(certificate.precision_bits, 53);
        // The root lies between centre - error and centre + error: by exact squares.
        let error = Rational::from_f64(certificate.error[0]).unwrap();
        let square = |x: Rational| x.clone() * x;
        let centre = &certificate.centre[0].re;
        let tenth = Rational::from((1, 10));
        assert!(square(centre.clone() - &error) < tenth && tenth < square(centre.clone() + &error));
        assert!(certificate.radius[0] < 1e-12 && certificate.error[0] < certificate.radius[0]);
        assert!(certificate.contraction < 1e-10);
    }

    #[test]
    fn all_solutions_near_start_points_of_katsura_are_certified() {
        let system = katsura(3).system;
        let krawczyk = Krawczyk::new(&system);
        // u = (1, 0, 0, 0) solves katsura-n for every n.
        let certificate = certified(&krawczyk, &real(&[1.0, 0.0, 0.0, 0.0]));
        assert_eq!(certificate.precision_bits, 53);
        assert_eq!(
            refused(&krawczyk, &real(&[5.0, -3.0, 0.0, 8.0])),
            Uncertified::NewtonLeaves
        );
    }

    #[test]
    fn homogeneous_points_are_certified_in_the_chart_of_their_largest_coordinate() {
        let system =
            system("hom_variable_group x, y, z; function f, g; f = x^2 - 2*y^2; g = x*z - 3*y*y;");
        let krawczyk = Krawczyk::new(&system);
        let root = f64::sqrt(2.0);
        let scale = Complex64::new(0.3, -0.4);
        let point: Vec<_> = [root, 1.0, 3.0 / root].map(|v| scale * v).to_vec();
        let certificate = certified(&krawczyk, &point);
        assert_eq!(certificate.centre[2], ComplexRational::real(1));
        assert_eq!((certificate.radius[2], certificate.error[2]), (0.0, 0.0));
        assert!(certificate.radius[0] > 0.0);
    }

    #[test]
    fn what_doubles_cannot_decide_more_bits_do() {
        // Roots at a distance of 1e-12 from each other, expanded: doubles see a double root.
        let system =
            system("variable_group x; function f; f = x^2 - 2.000000000001*x + 1.000000000001;");
        let krawczyk = Krawczyk::new(&system);
        let certificate = certified(&krawczyk, &real(&[1.0 + 1.3e-12]));
        assert!(
            certificate.precision_bits >= 128,
            "{}",
            certificate.precision_bits
        );
        assert!(certificate.radius[0] < 1e-12);
        let root = Rational::from(1) + Rational::from((1, 1_000_000_000_000u64));
        let boxes = certificate.lies_in::<MultiplePrecision>(256);
        assert!(boxes[0].re.contains(&root));
    }

    #[test]
    fn singular_points_and_damaged_ones_are_refused() {
        let origin = griewank_osborne();
        let krawczyk = Krawczyk::new(&origin.system);
        let reason = refused(&krawczyk, &real(&[0.0, 0.0]));
        assert_eq!(reason, Uncertified::Singular);
        let reason = refused(&krawczyk, &real(&[1e-9, -1e-9]));
        assert!(
            matches!(reason, Uncertified::Singular | Uncertified::NoContraction),
            "{reason:?}"
        );
        let regular = system("variable_group x, y; function f, g; f = x + y^2; g = y - x^2;");
        let origin = Krawczyk::new(&regular).certify(&[], &real(&[1e-17, -3e-18]));
        assert!(origin.certificate().is_some());
        assert_eq!(
            refused(&krawczyk, &real(&[f64::NAN, 0.0])),
            Uncertified::DamagedPoint
        );
        assert_eq!(refused(&krawczyk, &real(&[0.0])), Uncertified::DamagedPoint);
        // A double root, from beside it.
        let double = system("variable_group x; function f; f = (x - 1/3)^2;");
        let krawczyk = Krawczyk::new(&double);
        refused(&krawczyk, &real(&[0.333_333_333_4]));
    }

    #[test]
    fn parameters_are_exact_doubles_and_constants_are_enclosed() {
        let system = system(
            "variable_group x; parameter p; constant c; function f; c = sqrt(3); f = x^2 - c*p;",
        );
        let start = f64::sqrt(f64::sqrt(3.0) * 0.1);
        let certification = Krawczyk::new(&system).certify(&real(&[0.1]), &real(&[start]));
        assert!(
            certification
                .certificate()
                .is_some_and(|certificate| certificate.error[0] < 1e-14)
        );
    }

    #[test]
    fn a_radius_too_small_beside_the_others_grows() {
        // y is 1e-9 and follows x, which is 1e9.
        let system = system(
            "variable_group x, y; function f, g; f = x - 1000000000 + y^2; g = x*y - 1 - y^2;",
        );
        let krawczyk = Krawczyk::new(&system);
        let certificate = certified(&krawczyk, &real(&[1e9, 1e-9]));
        assert!(certificate.radius[1] < 1e-20, "{:?}", certificate.radius);
    }

    #[test]
    fn a_certificate_does_not_depend_on_its_neighbours() {
        // Points in two charts, some proved at once, some in MPFR, some not at all, at two values of the parameter.
        let system = system(
            "hom_variable_group x, y, z; parameter p; function f, g; f = x^2 - p*y^2; g = x*z - 3*y*y;",
        );
        let krawczyk = Krawczyk::new(&system);
        let (two, near) = (real(&[2.0]), real(&[1e-18]));
        let root = f64::sqrt(2.0);
        let candidates: Vec<(&[Complex64], Vec<Complex64>)> = (0..21)
            .map(|k| match k % 5 {
                0 => (&two[..], real(&[root, 1.0, 3.0 / root])),
                1 => (&two[..], real(&[-root, 1.0, -3.0 / root])),
                2 => (&near[..], real(&[1e-9 / 3.0, 1.0 / 3.0, 1e9])),
                3 => (&two[..], real(&[f64::NAN, 1.0, 2.0])),
                _ => (&two[..], real(&[f64::from(k), 1.0, 2.0])),
            })
            .collect();
        let candidate_views: Vec<Candidate<'_>> = candidates
            .iter()
            .map(|(parameters, point)| Candidate { parameters, point })
            .collect();
        let together = krawczyk.certify_all(&candidate_views);
        for (candidate, certification) in candidate_views.iter().zip(&together) {
            let alone = krawczyk.certify(candidate.parameters, candidate.point);
            assert_eq!(&alone, certification);
        }
        let proved = together.iter().filter(|c| c.certificate().is_some());
        assert!(proved.count() >= 10);
    }
}

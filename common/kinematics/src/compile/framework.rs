//! A framework of bars in the plane: points in isotropic coordinates, an equation a bar, two groups.

use super::formulation::{Configuration, Family, Formulation, Lifted, Problem, Target, unbalanced};
use super::text::{self, Equations};
use crate::mechanism::pose::Pose;
use crate::mechanism::{Bar, Framework, Mechanism, MechanismError};
use crate::plane::modulus;
use num_complex::Complex64;

/// The formulation of a framework: all its realisations.
pub fn compile(
    mechanism: &Mechanism,
    framework: &Framework,
    problem: Problem,
) -> Result<Box<dyn Formulation>, MechanismError> {
    if problem == Problem::Inverse {
        return Err(mechanism.error("a framework has no output; ask forward for its realisations"));
    }
    let mut equations = Equations::default();
    let base = base_length(framework, problem);
    let name = |point: usize, letter: &str| -> String {
        match framework.fixed.iter().position(|f| *f == point) {
            Some(0) => "0".into(),
            Some(_) => base.clone(),
            None => format!("{letter}{}", point + 1),
        }
    };
    let free: Vec<usize> = (0..framework.points.len())
        .filter(|p| !framework.fixed.contains(p))
        .collect();
    equations.groups = vec![
        free.iter().map(|p| name(*p, "p")).collect(),
        free.iter().map(|p| name(*p, "P")).collect(),
    ];
    equations.conjugates = free
        .iter()
        .map(|p| (name(*p, "p"), name(*p, "P")))
        .collect();
    for bar in &framework.bars {
        let [a, b] = bar.between;
        if framework.fixed.contains(&a) && framework.fixed.contains(&b) {
            continue;
        }
        let side = |letter: &str| text::minus(&name(a, letter), &name(b, letter));
        equations.equations.push(format!(
            "{}*{}-{}",
            side("p"),
            side("P"),
            match problem {
                Problem::Motion => bar.length.square_expression(),
                _ => format!("{}^2", bar.length.expression()),
            }
        ));
    }
    if free.is_empty() {
        return Err(mechanism.error("all points of the framework are fixed"));
    }
    if problem != Problem::Motion {
        unbalanced(
            mechanism,
            &[],
            equations.unknowns(),
            equations.equations.len(),
        )?;
    }
    Ok(Box::new(Realisations {
        framework: framework.clone(),
        free,
        family: Family {
            name: format!(
                "framework of {} points and {} bars",
                framework.points.len(),
                framework.bars.len()
            ),
            expected: None,
            source: "not known",
            representation: "isotropic coordinates of the points, two groups",
        },
        equations,
    }))
}

fn base_length(framework: &Framework, problem: Problem) -> String {
    let [a, b] = framework.fixed;
    let fixed = framework
        .bars
        .iter()
        .find(|bar| bar.between == [a, b] || bar.between == [b, a]);
    let text = |bar: &Bar| match problem {
        Problem::Motion => bar.length.exact_expression(),
        _ => bar.length.expression(),
    };
    fixed.map_or_else(|| "1".into(), text)
}

struct Realisations {
    framework: Framework,
    free: Vec<usize>,
    family: Family,
    equations: Equations,
}

impl Formulation for Realisations {
    fn family(&self) -> &Family {
        &self.family
    }

    fn inputs(&self) -> &[String] {
        &[]
    }

    fn equations(&self) -> Option<&Equations> {
        Some(&self.equations)
    }

    fn parameters(&self, _: &Target) -> Result<Vec<Complex64>, String> {
        Ok(Vec::new())
    }

    fn generic(&self, _: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        None
    }

    fn lift(&self, _: Option<&Target>, _: &[Complex64], point: &[Complex64]) -> Lifted {
        let count = self.framework.points.len();
        let mut places = vec![[Complex64::default(); 2]; count];
        let [a, b] = self.framework.fixed;
        let fixed = self
            .framework
            .bars
            .iter()
            .find(|bar| bar.between == [a, b] || bar.between == [b, a]);
        let base = Complex64::from(fixed.map_or(1.0, |bar| bar.length.to_f64()));
        places[b] = [base, base];
        for (i, p) in self.free.iter().enumerate() {
            places[*p] = [point[i], point[self.free.len() + i]];
        }
        let mut most = 0.0f64;
        for bar in &self.framework.bars {
            let [p, q] = bar.between.map(|i| places[i]);
            let (z, bar_z) = (p[0] - q[0], p[1] - q[1]);
            let square = bar.length.to_f64() * bar.length.to_f64();
            most =
                most.max(modulus(z * bar_z - square) / (square + z.norm_sqr() + bar_z.norm_sqr()));
        }
        let half_i = Complex64::new(0.0, 0.5);
        let pose = |[z, bar]: [Complex64; 2]| Pose::shift((z + bar) * 0.5, (bar - z) * half_i, 0.0);
        let named = self
            .framework
            .points
            .iter()
            .map(|name| name.as_str().into())
            .zip(places.into_iter().map(pose));
        Lifted::Position(Box::new(Configuration {
            values: Vec::new(),
            output: None,
            bodies: named.collect(),
            residual: most,
        }))
    }
}

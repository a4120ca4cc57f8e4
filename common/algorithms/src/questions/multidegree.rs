//! Multidegree: how many points slices in single groups of variables cut out of each component.
//!
//! For each way to share the slices of a component out to the groups, its general slices move to slices in the
//! variables of one group each. The finite points that are left are counted, on two choices of these slices
//! (Hauenstein, Leykin, Rodriguez, Sottile: A numerical toolkit for multiprojective varieties, 2019).

use super::context::Context;
use super::procedure::{GivenSystem, Procedure};
use crate::decomposition::job::Job;
use crate::decomposition::operand::Operand;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use cognate_solutions::witness::Answer;
use cognate_solutions::witness::answer::{GroupDegree, Multidegree as Degrees};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Slices that must lead to the same number.
const SLICES: usize = 2;
/// More ways to share slices out than this are not tried.
const MOST_WAYS: usize = 1000;

/// Component by component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Multidegree {
    /// Variables of each group, and whether it is homogeneous.
    groups: Vec<(Vec<usize>, bool)>,
    found: Vec<Degrees>,
}

impl Procedure for Multidegree {
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job> {
        if let Some(job) = done {
            self.learn(context, &job);
        }
        while let Some(operand) = context.operands.get(self.found.len()) {
            let ways = self.ways(operand.dimension());
            let mut component_degrees = Degrees {
                id: operand.id,
                degrees: Vec::new(),
                doubts: Vec::new(),
            };
            let most = MOST_WAYS.min(operand.most_targets() / SLICES);
            if ways.len() > most {
                let doubt = format!("{} ways to share slices out; at most {most}", ways.len());
                component_degrees.doubts.push(doubt);
                self.found.push(component_degrees);
                continue;
            }
            if operand.dimension() == 0 {
                component_degrees.degrees.push(GroupDegree {
                    slices: vec![0; self.groups.len()],
                    degree: Some(1),
                });
                self.found.push(component_degrees);
                continue;
            }
            let each = ways.iter().flat_map(|way| {
                let slice = |number| self.special(context, operand, way, number);
                (0..SLICES).map(slice).collect::<Vec<_>>()
            });
            let targets = each.collect();
            self.found.push(component_degrees);
            return Some(operand.moved_to(&mut context.of_components(), targets));
        }
        None
    }

    fn answer(&mut self, given: &GivenSystem<'_>) -> Answer {
        let name = |&v: &usize| given.system.variables[v].clone();
        let groups = self.groups.iter();
        Answer::Multidegree {
            groups: groups
                .map(|(variables, _)| variables.iter().map(name).collect())
                .collect(),
            components: std::mem::take(&mut self.found),
        }
    }

    fn description(&self) -> &'static str {
        "moving slices into groups"
    }
}

impl Multidegree {
    pub fn new(system: &System) -> Self {
        let groups = system.groups.iter();
        Self {
            groups: groups
                .map(|g| (g.variables.clone(), g.homogeneous))
                .collect(),
            found: Vec::new(),
        }
    }

    /// All ways to share the slices of a component of this dimension out: no group takes more than it has dimensions.
    fn ways(&self, dimension: usize) -> Vec<Vec<u32>> {
        let mut ways = vec![(Vec::new(), dimension)];
        for (variables, homogeneous) in &self.groups {
            let room = variables.len() - usize::from(*homogeneous);
            let mut longer = Vec::new();
            for (way, left) in ways {
                for count in (0..=room.min(left)).rev() {
                    let mut way: Vec<u32> = way.clone();
                    way.push(count as u32);
                    longer.push((way, left - count));
                }
                if longer.len() > 100 * MOST_WAYS {
                    break;
                }
            }
            ways = longer;
        }
        let whole = ways.into_iter().filter(|(_, left)| *left == 0);
        whole.map(|(way, _)| way).collect()
    }

    fn special(
        &self,
        context: &Context<'_>,
        operand: &Operand,
        way: &[u32],
        number: usize,
    ) -> Vec<Vec<Complex64>> {
        let n = context.problem.variables();
        let seed = context.problem.seed();
        let mut random = RandomStream::new(seed, Purpose::Question, 1 << 40 | number as u64);
        let mut rows = Vec::with_capacity(operand.dimension());
        for ((variables, homogeneous), &count) in self.groups.iter().zip(way) {
            for _ in 0..count {
                let mut row = vec![Complex64::default(); n + 1];
                // A form of a homogeneous group has no constant.
                if !homogeneous {
                    row[0] = random.unit();
                }
                for &v in variables {
                    row[v + 1] = random.unit();
                }
                rows.push(row);
            }
        }
        rows
    }

    fn learn(&mut self, context: &Context<'_>, job: &Job) {
        let place = self.found.len() - 1;
        let operand = &context.operands[place];
        let ways = self.ways(operand.dimension());
        let ends = job.ends();
        let component_degrees = &mut self.found[place];
        for (way, ends) in ways.into_iter().zip(ends.chunks(SLICES * operand.degree())) {
            let count = |ends: &[(
                _,
                cognate_solutions::classification::Decision,
                Vec<Complex64>,
            )]| {
                let ends_with_verdict =
                    |wanted: Verdict| ends.iter().filter(|(_, d, _)| d.verdict == wanted).count();
                let (finite, infinite) = (
                    ends_with_verdict(Verdict::Finite),
                    ends_with_verdict(Verdict::AtInfinity),
                );
                (finite + infinite == ends.len()).then_some(finite as u64)
            };
            let counts: Vec<Option<u64>> = ends.chunks(operand.degree()).map(count).collect();
            let degree = counts[0].filter(|first| counts.iter().all(|c| *c == Some(*first)));
            if degree.is_none() {
                let doubt = format!(
                    "slices {way:?} in the groups: paths failed, ended at singular points, or two slices differ"
                );
                component_degrees.doubts.push(doubt);
            }
            component_degrees.degrees.push(GroupDegree {
                slices: way,
                degree,
            });
        }
        // A curve's degree in the chart of all groups is the sum of its degrees by groups.
        let sum: Option<u64> = component_degrees.degrees.iter().map(|d| d.degree).sum();
        let homogeneous = self.groups.iter().all(|(_, homogeneous)| *homogeneous);
        if let Some(sum) = sum
            && operand.dimension() == 1
            && homogeneous
            && sum != operand.degree() as u64
        {
            let doubt = format!(
                "degrees by groups add up to {sum}, its degree is {}",
                operand.degree()
            );
            component_degrees.doubts.push(doubt);
        }
    }
}

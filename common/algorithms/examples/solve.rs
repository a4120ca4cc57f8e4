//! Solves a system in its own process, without a service: `cargo run --release -p cognate-algorithms --example solve`.

use cognate_algorithms::{SolveOptions, plan, run_locally::run_locally};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::formats;
use std::error::Error;

/// Paths that are followed together, as vectors of numbers.
const LANES: usize = 8;

/// All isolated solutions of equations, one a line.
fn solve(equations: &str) -> Result<SolutionSet, Box<dyn Error>> {
    let system = formats::read("equations", equations.as_bytes())?.system;
    let mut plan = plan(&system, &SolveOptions::default())?;
    let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, LANES)?;
    Ok(sets.into_iter().next().ok_or("a solve has one answer")?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let set = solve("x^2 + y^2 = 5\nx*y = 2\n")?;
    assert!(set.settled(), "something is in doubt: {:?}", set.warnings);
    for solution in &set.solutions {
        let values = solution.variables.0.iter();
        let line: Vec<String> = values
            .map(|v| format!("{} = {}", v.name, v.value))
            .collect();
        println!("{}", line.join(", "));
    }
    Ok(())
}

#[test]
fn a_circle_and_a_hyperbola_meet_four_times() {
    let set = solve("x^2 + y^2 = 5\nx*y = 2\n").expect("it can be solved");
    assert_eq!((set.counts.distinct, set.counts.real), (4, Some(4)));
    main().expect("the example runs");
}

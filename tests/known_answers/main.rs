//! Whole solves against published answers, ten seeds each, in one thread.
//!
//! Every case goes through `check`: the counts of paths add up, nothing
//! failed, every crossing came apart, and the numbers are the published ones.

mod check;
mod classical_systems;
mod close_paths;
mod digits;
mod doubts;
mod every_start;
mod forty_systems;
mod fractions;
mod hard_paths;
mod ill_conditioned;
mod isolated_or_not;
mod loops;
mod mechanism_families;
mod mechanisms;
mod nine_point;
mod overdetermined;
mod parameter_homotopies;
mod paths_alone;
mod planted;
mod polyhedral;
mod scaled_units;
mod singular_endpoints;
mod start_costs;
mod straight_line_programs;
mod textbook_systems;
mod twenty_variables;

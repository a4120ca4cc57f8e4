//! From the results of all paths to one solution set: the meaning of the endpoints.
//!
//! In reading order: [`point_shape`] says which coordinate is whose;
//! [`classification`] gives each path a verdict by rules on its own facts;
//! [`unique_points`] finds the endpoints that are one point; [`path_crossing`]
//! names the paths that must be tracked again; [`completeness`] says whether there are no more; [`real`] decides whether a
//! solution can be called real; [`symmetry`] knows orbits; [`solution_set`] puts it together, with counts
//! that add up; [`streamed`] does the same without holding every end; [`sharpened`] gives solutions more
//! digits, [`denominators`] finds points that are no solutions of fractions, [`branches`] finds points on false
//! branches of roots, [`typed_unknowns`] writes solutions in the unknowns that were typed, [`certificates`] adds
//! proofs, [`weak_evidence`] counts verdicts that rest on too little; [`witness`] is for sets of solutions. Nothing
//! here tracks a path: everything can be decided again from stored results, with other tolerances.
#![forbid(unsafe_code)]

pub mod approximate;
pub mod branches;
pub mod certificates;
pub mod classification;
pub mod closing_options;
pub mod completeness;
pub mod critical;
pub mod degenerate;
pub mod denominators;
pub mod disjoint_sets;
pub mod failed_path;
pub mod field;
pub mod images;
pub mod involution;
pub mod path_crossing;
pub mod point_shape;
pub mod real;
pub mod selection;
pub mod sharpened;
pub mod solution;
pub mod solution_set;
pub mod streamed;
pub mod streamed_targets;
pub mod summary;
pub mod symmetry;
pub mod typed_unknowns;
pub mod unique_points;
pub mod weak_evidence;
pub mod witness;

#[cfg(test)]
mod test_results;

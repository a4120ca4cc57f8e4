//! `cognate mechanism`: what is typed, and from targets to positions by paths that are followed in this process.

pub mod arguments;
pub mod cache;
pub mod families;
pub mod follow;
mod parallel;
pub mod preparation;
mod prepare;
pub mod serve;
pub mod solver;
pub mod summary;
pub mod target_answer;

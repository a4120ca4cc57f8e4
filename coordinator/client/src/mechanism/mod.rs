//! `cognate mechanism`: what is typed, and from targets to positions by paths that are followed in this process.

pub mod answer;
pub mod arguments;
mod prepare;

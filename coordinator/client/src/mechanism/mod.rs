//! `cognate mechanism`: its arguments, its answers, and targets that come line by line.

pub mod arguments;
pub mod exceptional_answer;
pub mod locus_answer;
pub mod mobility_answer;
pub mod motion_answer;
pub mod serve;

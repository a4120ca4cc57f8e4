//! The command `cognate`: its input, its output and its files. One program, so that it is linked once.

mod any_files;
mod approximate;
mod beside_rows;
mod client_output;
mod declared_symmetry;
mod decompose;
mod exceptional;
mod help;
mod least_residual;
mod loci;
mod mechanism_listings;
mod mobility;
mod motion;
mod newcomer;
mod objective;
mod program;
mod selection;
mod serve;
mod singularities;
mod sweep;
mod typed_equations;
mod wrong_inputs;

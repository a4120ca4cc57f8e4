//! Mechanisms and their positions as tables, JSON, CSV and files.

pub mod approximate;
pub mod beside_rows;
pub mod csv;
pub mod drawing;
pub mod exceptional;
pub mod families;
pub mod folder;
pub mod info;
pub mod json;
pub mod listing;
pub mod loci;
pub mod motion;
pub mod near;
pub mod path;
pub mod posture_changes;
pub mod table;
mod view;
pub mod workspace;

pub use view::View;

//! Mechanisms and their positions as tables, JSON, CSV and files.

pub mod csv;
pub mod families;
pub mod folder;
pub mod info;
pub mod json;
pub mod path;
mod shown;
pub mod table;

pub use shown::{Shown, View};

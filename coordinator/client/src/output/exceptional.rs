//! Exceptional sets of a family, for people and for programs.

use super::beside_rows::Remarks;
use super::text::{Columns, Look, complex, count, counted};
use crate::error::Exit;
use num_complex::Complex64;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Parameters whose values the table shows.
const PARAMETERS_SHOWN: usize = 4;

/// The closure of a set of parameters over which the solutions have a higher dimension.
pub struct Set {
    /// Dimension of the set.
    pub dimension: u64,
    /// Degree of the set; `None` if it is not clear.
    pub degree: Option<u64>,
    /// Dimension of the solutions over its general points.
    pub fibre_dimension: u64,
    /// Components of the product that it is the image of.
    pub components: Vec<String>,
    /// A general point of it: values of the parameters.
    pub point: Vec<Complex64>,
}

/// A product that was decomposed.
pub struct Level {
    /// Copies of the variables.
    pub copies: u32,
    /// Variables of the product.
    pub variables: u64,
    /// Paths to its components and their images.
    pub paths: u64,
    /// Dimensions of the images of its components; -1 where one is not known.
    pub images: Vec<i64>,
    /// Highest dimension of an image that may be no exceptional set; -1 where all are.
    pub not_known: i64,
}

/// All exceptional sets of a family.
pub struct Exceptional {
    /// Name of the problem.
    pub name: String,
    /// The dimension of solutions that was asked.
    pub fibre_dimension: u32,
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// The sets.
    pub sets: Vec<Set>,
    /// The products that were decomposed, by their number of copies.
    pub levels: Vec<Level>,
    /// Doubts about the last of the products.
    pub doubts: Vec<String>,
}

impl Exceptional {
    /// From the dimension of a general fibre over each image to that of the solutions: each copy has lost the dimension
    /// that was asked.
    pub fn divide_fibres(&mut self, copies: u32) {
        for set in &mut self.sets {
            let copies = u64::from(copies);
            if set.fibre_dimension % copies > 0 {
                let ids = set.components.join(", ");
                let doubt = format!("the dimension of the solutions over the image of {ids}");
                self.doubts.push(doubt);
            }
            set.fibre_dimension = u64::from(self.fibre_dimension) + set.fibre_dimension / copies;
        }
    }

    /// The exit code that this answer has.
    pub fn exit(&self) -> Exit {
        Exit::of_settled(self.doubts.is_empty())
    }

    /// Lines for standard error beside rows.
    pub fn beside_rows(&self, look: Look) -> Remarks {
        let mut remarks = Remarks::new(look);
        for doubt in &self.doubts {
            remarks.not_settled(doubt);
        }
        remarks
    }

    /// One JSON object.
    pub fn json(&self) -> String {
        let set = |set: &Set| {
            let values = self.parameters.iter().zip(&set.point);
            let point: Map<String, Value> = values
                .map(|(name, z)| (name.clone(), json!([z.re, z.im])))
                .collect();
            json!({"dimension": set.dimension,
                   "codimension": (self.parameters.len() as u64).saturating_sub(set.dimension),
                   "degree": set.degree, "fibre_dimension": set.fibre_dimension,
                   "components": set.components, "point": point})
        };
        let level = |level: &Level| {
            json!({"copies": level.copies, "variables": level.variables, "paths": level.paths,
                   "components": level.images.len(), "not_known": (level.not_known >= 0).then_some(level.not_known)})
        };
        let sets: Vec<Value> = self.sets.iter().map(set).collect();
        let levels: Vec<Value> = self.levels.iter().map(level).collect();
        let whole = json!({"name": self.name, "settled": self.doubts.is_empty(), "unsettled": self.doubts,
                           "exceptional": {"fibre_dimension": self.fibre_dimension, "parameters": self.parameters,
                                           "sets": sets, "products": levels}});
        format!("{whole:#}\n")
    }

    /// The table.
    pub fn table(&self) -> String {
        let look = Look::of_standard_output();
        let headline = format!(
            "{} over which the solutions have dimension {} or more",
            counted(self.sets.len() as u64, "set"),
            self.fibre_dimension
        );
        let headline = match self.doubts.is_empty() {
            true => look.good(&headline),
            false => look.warn(&headline),
        };
        let mut text = format!("{}: {headline}\n", look.bold(&self.name));
        for doubt in &self.doubts {
            let _ = writeln!(text, "{}{doubt}", look.warn("not settled: "));
        }
        if !self.sets.is_empty() {
            let shown = self.parameters.len().min(PARAMETERS_SHOWN);
            let mut headings = vec![">dimension", ">degree", ">of solutions", "components"];
            headings.extend(self.parameters[..shown].iter().map(String::as_str));
            let mut columns = Columns::new(&headings).with_keys(4);
            for set in &self.sets {
                let mut row = vec![
                    set.dimension.to_string(),
                    set.degree.map_or_else(|| "?".into(), count),
                    set.fibre_dimension.to_string(),
                    set.components.join(", "),
                ];
                let size = set.point.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
                let is_zero = |z: &Complex64| z.norm_sqr() < 1e-24 * size;
                let cell = |z: &Complex64| match is_zero(z) {
                    true => "0".into(),
                    false => complex(*z, 6, 1e-12),
                };
                row.extend(set.point.iter().take(shown).map(cell));
                columns.row(row);
            }
            let _ = write!(text, "\n{}", columns.render(look));
        }
        let mut columns = Columns::new(&[">copies", ">variables", ">paths", ">components", ""]);
        for level in &self.levels {
            columns.row(vec![
                level.copies.to_string(),
                level.variables.to_string(),
                count(level.paths),
                count(level.images.len() as u64),
                match level.not_known {
                    -1 => String::new(),
                    most => format!("images of dimension up to {most} may be no exceptional sets"),
                },
            ]);
        }
        let _ = write!(text, "\n{}", columns.render(look));
        text
    }
}

//! A mistake that people really type.

/// A command line, words of its refusal that name the place, and words of the line to type that the refusal proposes.
pub type Mistake = (&'static str, &'static [&'static str], &'static str);

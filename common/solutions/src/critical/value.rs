//! Value of an objective at a real critical point, and whether the conditions let the point take it.

/// The value at a real point, and how far it may be from the exact one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    pub value: f64,
    pub error: f64,
    pub place: Place,
}

impl Value {
    /// Whether this may be the same value.
    pub fn is_near(&self, other: &Self) -> bool {
        (other.value - self.value).abs() <= other.error + self.error
    }

    /// Reason why it is not known, or not so, that the value is taken at a point that meets the conditions.
    pub fn why_not_taken(&self) -> Option<String> {
        let value = self.value;
        Some(match self.place {
            Place::Inside => return None,
            Place::Unknown => format!(
                "it is not known whether the point with the value {value} meets the conditions, or lies outside by \
                 less than its accuracy"
            ),
            Place::OnSet => format!(
                "a positive-dimensional set of critical points has the value {value}, and it is not known whether it \
                 has real points that meet the conditions"
            ),
            Place::Excluded => format!(
                "there is none: values come as near as one likes to {value}, at a point that the conditions exclude"
            ),
            Place::PerhapsExcluded => format!(
                "it is not known whether values come as near as one likes to {value}, at a point that the conditions \
                 exclude"
            ),
        })
    }
}

/// Place of a real critical point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// The point meets all conditions.
    Inside,
    /// The point meets one condition that excludes equality with equality, and all others; there are points that meet all
    /// conditions as near to it as one likes.
    Excluded,
    /// As `Excluded`, but it is not known whether points that meet all conditions are near.
    PerhapsExcluded,
    /// It is not known whether the point meets the conditions.
    Unknown,
    /// The value is taken on a set of positive dimension, of which the real points are not known.
    OnSet,
}

//! Evidence: what the claim rests on that a witness set is one component.

use super::method::Method;
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};
use std::fmt;

/// Second derivatives of all witness points along a moving slice, summed: 0 over a component.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// Length of the sum over the sum of lengths.
    pub deviation: f64,
    /// Rounding error of the deviation, in the same unit.
    pub noise: f64,
    /// Precision of the derivatives, in bits.
    pub precision_bits: u32,
}

/// Reason why a result is not settled.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(remote = "Self", rename_all = "snake_case")]
pub enum Doubt {
    /// The sum of second derivatives over all points of the dimension is not 0: points are missing.
    PointsMissing,
    /// Points that loops did not bring together, and that are no component in any union that was tried.
    Open {
        /// Classes of points that stayed.
        classes: u64,
    },
    /// Paths that failed may have ended here.
    FailedPaths {
        /// Number of these paths.
        paths: u64,
    },
    /// It is not clear whether points lie on a set of higher dimension.
    Junk {
        /// Number of these points.
        points: u64,
    },
    /// No deflation made these points regular.
    NotDeflated {
        /// Number of these points.
        points: u64,
    },
    /// The number of paths to solutions differs from the number of paths to components, each counted with the paths to
    /// its witness points, and to junk.
    Counts {
        /// Paths to solutions.
        superset: u64,
        /// Paths to components and junk.
        explained: u64,
    },
    /// A second method has another result in this dimension.
    Differs {
        /// The second method.
        method: Method,
        /// Description of the result of the second method.
        found: String,
    },
    /// Points that could not be sifted, or points of multiple sets that could not be followed, when a further equation
    /// was to cut them: the intersection of their sets with this equation is not known.
    NotCut {
        /// Number of these points.
        points: u64,
    },
    /// Points of which it is not clear whether they solve all equations.
    Asked {
        /// Number of these points.
        points: u64,
    },
    /// The dual space did not close, so that the multiplicity is not known.
    Multiplicity,
    /// The order in which loops bring points back is no permutation.
    BrokenLoops {
        /// Number of loops.
        loops: u64,
    },
    /// Generators of the symmetry group that was named take witness points to others than witness points, or those of a
    /// component to several: they are no symmetries, or points are missing.
    Symmetry {
        /// Number of these generators.
        generators: u64,
    },
    /// No box proves these witness points, where proofs were asked for.
    NotProved {
        /// Number of these points.
        points: u64,
    },
    /// The boxes of these witness points may meet others of the dimension.
    NotDistinct {
        /// Number of these points.
        points: u64,
    },
    /// A denominator of the given equations is near 0 at some of these witness points: it is not clear whether they are
    /// solutions.
    Denominator {
        /// Number of these points.
        points: u64,
    },
}

/// In formats for people an object with its kind and its fields; elsewhere as a variant by number, since a format
/// without names cannot look for the kind.
impl Serialize for Doubt {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return Self::serialize(self, serializer);
        }
        let value = Self::serialize(self, serde_json::value::Serializer);
        let (kind, mut fields) = match value.map_err(S::Error::custom)? {
            Value::Object(variant) => match variant.into_iter().next() {
                Some((kind, Value::Object(fields))) => (kind, fields),
                _ => return Err(S::Error::custom("a doubt has named fields")),
            },
            Value::String(kind) => (kind, Map::new()),
            _ => return Err(S::Error::custom("a doubt has a name")),
        };
        fields.insert("kind".into(), Value::String(kind));
        fields.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Doubt {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            return Self::deserialize(deserializer);
        }
        let mut fields = Map::deserialize(deserializer)?;
        let Some(Value::String(kind)) = fields.remove("kind") else {
            return Err(D::Error::missing_field("kind"));
        };
        let variant = match fields.is_empty() {
            true => Value::String(kind),
            false => Value::Object(Map::from_iter([(kind, Value::Object(fields))])),
        };
        Self::deserialize(variant).map_err(D::Error::custom)
    }
}

impl fmt::Display for Doubt {
    /// The doubt in words, as a part of a sentence.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted = |n: &u64, noun: &str| match n {
            1 => format!("1 {noun}"),
            n => format!("{n} {noun}s"),
        };
        match self {
            Self::PointsMissing => {
                write!(
                    f,
                    "second derivatives do not sum to 0: witness points are missing"
                )
            }
            Self::Open { classes: 1 } => write!(
                f,
                "whether it is one component is not clear: a wrong union of points has nearly as small a sum"
            ),
            Self::Open { classes } => write!(
                f,
                "{classes} classes of witness points that loops did not bring together"
            ),
            Self::FailedPaths { paths } => {
                write!(
                    f,
                    "{} failed that may have ended here",
                    counted(paths, "path")
                )
            }
            Self::Junk { points } => write!(
                f,
                "{} may lie on a set of higher dimension",
                counted(points, "end")
            ),
            Self::NotDeflated { points } => write!(
                f,
                "no deflation made {} regular",
                counted(points, "multiple point")
            ),
            Self::Counts {
                superset,
                explained,
            } => write!(
                f,
                "counts do not add up: {} to solutions, {explained} to components and junk",
                counted(superset, "path")
            ),
            Self::Differs {
                method,
                found: other_components,
            } => {
                write!(
                    f,
                    "{} finds something else: {other_components}",
                    method.name()
                )
            }
            Self::NotCut { points } => write!(
                f,
                "a further equation could not cut the sets of {}, which are not told from junk, or multiple",
                counted(points, "point")
            ),
            Self::Asked { points } => write!(
                f,
                "whether {} solve all equations is not clear",
                counted(points, "end")
            ),
            Self::Multiplicity => write!(
                f,
                "the multiplicity is not known: the dual space did not close"
            ),
            Self::BrokenLoops { loops } => {
                write!(
                    f,
                    "{} did not permute the witness points",
                    counted(loops, "loop")
                )
            }
            Self::Symmetry { generators } => write!(
                f,
                "{} of the symmetry group {} not take witness points to witness points, or components to components: \
                 no symmetries, or points are missing",
                counted(generators, "generator"),
                if *generators == 1 { "does" } else { "do" }
            ),
            Self::NotProved { points } => {
                write!(f, "{} without a proof", counted(points, "witness point"))
            }
            Self::NotDistinct { points } => write!(
                f,
                "{} that may be others of the dimension again",
                counted(points, "witness point")
            ),
            Self::Denominator { points } => write!(
                f,
                "whether a denominator is 0 at {} is not clear",
                counted(points, "witness point")
            ),
        }
    }
}

/// Proofs for a witness set, by boxes that hold its points and their derivatives along a moving slice.
///
/// Some facts are evidence only: that the points lie on components of this dimension where only combinations of the
/// equations are proved to hold, that none is missing, and that the slice is general.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Proof {
    /// Witness points that are each alone in a box: the only solution there of the slice and of as many combinations
    /// of the equations as are tracked.
    pub points: u64,
    /// Witness points whose boxes meet no other box of the dimension.
    pub distinct: u64,
    /// Whether the proofs are for the given equations themselves and not for combinations of them.
    pub all_equations: bool,
    /// Unions of witness points that are no components: intervals of their sums of second derivatives do not hold 0.
    pub unions: u64,
    /// If the points are those of whole components, none of these has a smaller degree than this.
    pub least_degree: u64,
    /// If the points are those of whole components, they belong to one component: no proper union is left.
    pub irreducible: bool,
}

impl Proof {
    /// Takes another witness set beside this one.
    pub fn add(&mut self, other: &Self) {
        self.points += other.points;
        self.distinct += other.distinct;
        self.all_equations &= other.all_equations;
        self.unions += other.unions;
        self.least_degree = self.least_degree.min(other.least_degree);
        self.irreducible &= other.irreducible;
    }
}

/// Evidence that a witness set is one component.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Trace of the witness points; `None` for a single point, which is not tested.
    pub trace: Option<Trace>,
    /// The least deviation of a union of classes of points that is no component; `None` where none was
    /// tried.
    pub smallest_wrong_union: Option<f64>,
    /// Loops that brought points together.
    pub loops: u32,
    /// Least gap between singular values that were taken as not 0 and as 0, at some witness points.
    #[serde(default)]
    pub rank_gap: Option<f64>,
    /// Largest condition number of the witness points.
    pub worst_condition: f64,
    /// Proofs for the witness set; `None` where no proof was asked for.
    #[serde(default)]
    pub proof: Option<Proof>,
    /// Doubts about the witness set.
    pub doubts: Vec<Doubt>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubts_come_back_from_json_and_from_objects() {
        let doubts = [
            Doubt::PointsMissing,
            Doubt::Open { classes: 3 },
            Doubt::Differs {
                method: Method::Slices,
                found: "nothing".into(),
            },
        ];
        for doubt in doubts {
            let json = serde_json::to_string(&doubt).unwrap();
            assert!(json.contains("\"kind\":"), "{json}");
            assert_eq!(serde_json::from_str::<Doubt>(&json).unwrap(), doubt);
            let bytes = postcard::to_stdvec(&doubt).unwrap();
            assert_eq!(postcard::from_bytes::<Doubt>(&bytes).unwrap(), doubt);
        }
        let text = r#"{"kind": "junk", "points": 2}"#;
        assert_eq!(
            serde_json::from_str::<Doubt>(text).unwrap(),
            Doubt::Junk { points: 2 }
        );
    }
}

//! Solution: an isolated finite point, the paths that reached it, and the evidence.
//!
//! Serialised it is a line of `solutions.jsonl`, field by field as the contract has it.

use crate::certificates::SolutionCertificate;
use crate::classification::Tolerances;
use crate::path_crossing::singular_radius;
use num_complex::Complex64;
use serde::de::{Error, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

/// Names and values of variables, in the system's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedValues(pub Vec<NamedValue>);

/// The value of one variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedValue {
    /// Name of the variable.
    pub name: String,
    /// Value of the variable, rounded to doubles.
    pub value: Complex64,
    /// Real and imaginary part with all digits, where there are more than a double holds.
    pub digits: Option<[String; 2]>,
}

impl NamedValues {
    /// The values without their names.
    pub fn values(&self) -> impl ExactSizeIterator<Item = Complex64> + '_ {
        self.0.iter().map(|variable| variable.value)
    }
}

impl FromIterator<(String, Complex64)> for NamedValues {
    fn from_iter<I: IntoIterator<Item = (String, Complex64)>>(pairs: I) -> Self {
        let named = |(name, value)| NamedValue {
            name,
            value,
            digits: None,
        };
        Self(pairs.into_iter().map(named).collect())
    }
}

/// One isolated finite solution.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// Values of the variables; a homogeneous group scaled so that its largest is 1.
    pub variables: NamedValues,
    /// Number of paths that end here: the multiplicity as a solution of the tracked system.
    pub multiplicity: u64,
    /// Winding numbers of the cycles that the paths form, ascending.
    pub cycles: Vec<u32>,
    /// Fixed by the system's involution; `None` where that is not asked.
    pub real: Option<bool>,
    /// The Jacobian is singular.
    pub singular: bool,
    /// Largest |F_i|, each equation and each group scaled to 1; with more digits a bound of it.
    #[serde(with = "finite")]
    pub residual: f64,
    /// Condition number of the Jacobian.
    #[serde(with = "finite")]
    pub condition: f64,
    /// Error relative to the largest coordinate: a bound at a nonsingular solution, an estimate at a singular one.
    #[serde(with = "finite")]
    pub accuracy: f64,
    /// Highest precision that a path to it used.
    pub precision_bits: u32,
    /// Symmetry class of the solution, where a symmetry group is known.
    pub class: Option<u64>,
    /// The paths that end here, ascending.
    pub paths: Vec<u64>,
    /// Certificate of the solution, where one was asked for.
    pub certificate: Option<SolutionCertificate>,
    /// Number of deflations of the equations until the solution was regular; `None` where it was not sharpened.
    #[serde(default)]
    pub deflations: Option<u32>,
    /// True for a point of which it is not known whether it is isolated: it is in no count of solutions.
    #[serde(default)]
    pub undecided: bool,
}

impl Solution {
    /// Relative error of the largest coordinate. At a singular solution, whose accuracy is an estimate, it is at least the
    /// radius in which endpoints count as one point.
    pub fn relative_error(&self) -> f64 {
        if self.singular && self.deflations.is_none() {
            singular_radius(self.accuracy, self.precision_bits, &Tolerances::default())
        } else {
            self.accuracy
        }
    }

    /// The first path that ended here, by which solutions are sorted; a solution without paths comes after all others.
    pub fn first_path(&self) -> u64 {
        self.paths.first().copied().unwrap_or(u64::MAX)
    }
}

// As JSON an object, in which a number with more digits than a double is a string.
impl Serialize for NamedValues {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return self.0.serialize(serializer);
        }
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for NamedValue {
            name,
            value,
            digits,
        } in &self.0
        {
            match digits {
                Some(digits) => map.serialize_entry(name, digits)?,
                None => map.serialize_entry(name, &[value.re, value.im])?,
            }
        }
        map.end()
    }
}

/// A number of a line: a double, or all its digits.
fn double(number: &Value) -> Option<f64> {
    let value = match number {
        Value::Number(number) => number.as_f64(),
        Value::String(digits) => digits.parse().ok(),
        _ => None,
    };
    value.filter(|value| value.is_finite())
}

impl<'de> Deserialize<'de> for NamedValues {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = NamedValues;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("names with real and imaginary parts")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<NamedValues, A::Error> {
                let mut values = Vec::new();
                while let Some((name, parts)) = map.next_entry::<String, [Value; 2]>()? {
                    let (Some(re), Some(im)) = (double(&parts[0]), double(&parts[1])) else {
                        return Err(A::Error::custom(format!(
                            "{name} has a part that is no number"
                        )));
                    };
                    let digits = match parts {
                        [Value::String(re), Value::String(im)] => Some([re, im]),
                        _ => None,
                    };
                    values.push(NamedValue {
                        name,
                        value: Complex64::new(re, im),
                        digits,
                    });
                }
                Ok(NamedValues(values))
            }
        }
        if deserializer.is_human_readable() {
            deserializer.deserialize_map(InOrder)
        } else {
            Ok(Self(Vec::deserialize(deserializer)?))
        }
    }
}

/// A double that may be infinite, as JSON cannot: null stands for it.
mod finite {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        Some(value).filter(|v| v.is_finite()).serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_as_the_contract_has_it() {
        let solution = Solution {
            variables: NamedValues(vec![
                NamedValue {
                    name: "y".into(),
                    value: Complex64::new(1.0, -0.5),
                    digits: None,
                },
                NamedValue {
                    name: "a".into(),
                    value: Complex64::new(0.25, 1e-30),
                    digits: Some(["0.25000000000000000000".into(), "1e-30".into()]),
                },
            ]),
            multiplicity: 2,
            cycles: vec![2],
            real: None,
            singular: true,
            residual: 1e-16,
            condition: f64::INFINITY,
            accuracy: 1e-9,
            precision_bits: 53,
            class: None,
            paths: vec![3, 17],
            certificate: None,
            deflations: Some(1),
            undecided: false,
        };
        let line = serde_json::to_string(&solution).unwrap();
        assert_eq!(
            line,
            "{\"variables\":{\"y\":[1.0,-0.5],\"a\":[\"0.25000000000000000000\",\"1e-30\"]},\"multiplicity\":2,\
             \"cycles\":[2],\"real\":null,\"singular\":true,\"residual\":1e-16,\
             \"condition\":null,\"accuracy\":1e-9,\"precision_bits\":53,\"class\":null,\
             \"paths\":[3,17],\"certificate\":null,\"deflations\":1,\"undecided\":false}"
        );
        let back: Solution = serde_json::from_str(&line).unwrap();
        assert_eq!(back, solution);
        let kept = postcard::to_stdvec(&solution).unwrap();
        assert_eq!(postcard::from_bytes::<Solution>(&kept).unwrap(), solution);
    }
}

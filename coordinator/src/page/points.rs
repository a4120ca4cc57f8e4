//! Points: the solutions of a job as a picture shows them, and no more of them than it can.

use cognate_protocol::client_json::number;
use cognate_protocol::v1;
use serde_json::{Value, json};

/// Coordinates in one answer, real and imaginary parts counted once: about 8 MB of text.
const COORDINATES: usize = 200_000;
/// Most points of a picture: more than its pixels tell apart.
const MOST: usize = 20_000;
/// Fewest, however many coordinates each has.
const LEAST: usize = 200;

/// Sample of every `stride`-th point of a stream, of bounded size.
#[derive(Debug)]
pub struct Sample {
    kept: Vec<v1::Solution>,
    /// Distance between two points that are kept; it doubles when there are too many.
    stride: usize,
    seen: usize,
}

impl Default for Sample {
    fn default() -> Self {
        Self {
            kept: Vec::new(),
            stride: 1,
            seen: 0,
        }
    }
}

impl Sample {
    /// Looks at the next point.
    pub fn take(&mut self, point: v1::Solution) {
        if self.seen.is_multiple_of(self.stride) {
            let most = (COORDINATES / point.variables.len().max(1)).clamp(LEAST, MOST);
            self.kept.push(point);
            if self.kept.len() > most {
                let mut number = 0;
                self.kept.retain(|_| {
                    number += 1;
                    number % 2 == 1
                });
                self.stride *= 2;
            }
        }
        self.seen += 1;
    }

    /// How many there were, how many are here, and where they are: `points` holds, for each, its number among the
    /// solutions, target, kind, condition, residual, and its coordinates as pairs in the order of `variables`.
    pub fn json(&self) -> Value {
        let variables = self.kept.first().map(|point| {
            let names = point.variables.iter().map(|v| v.name.as_str());
            names.collect::<Vec<_>>()
        });
        let point = |(index, point): (usize, &v1::Solution)| {
            let coordinates = point.variables.iter();
            let coordinates = coordinates.map(|v| json!([rounded(v.re), rounded(v.im)]));
            json!([
                index * self.stride,
                point.target,
                kind(point),
                rounded(point.condition),
                rounded(point.residual),
                coordinates.collect::<Vec<_>>(),
            ])
        };
        let points = self.kept.iter().enumerate().map(point);
        json!({
            "total": self.seen,
            "shown": self.kept.len(),
            "variables": variables.unwrap_or_default(),
            "points": points.collect::<Vec<_>>(),
        })
    }
}

/// Kind of a point, as the picture shows it, in one word.
fn kind(point: &v1::Solution) -> &'static str {
    match (point.undecided, point.singular, point.real) {
        (true, _, _) => "undecided",
        (_, true, _) => "singular",
        (_, _, Some(true)) => "real",
        (_, _, Some(false)) => "complex",
        (_, _, None) => "nonsingular",
    }
}

/// As exact as a picture is: seven digits.
fn rounded(x: f64) -> Value {
    let text = format!("{x:.6e}");
    text.parse().map_or(Value::Null, number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64) -> v1::Solution {
        v1::Solution {
            variables: vec![v1::VariableValue {
                name: "x".to_owned(),
                re: x,
                ..v1::VariableValue::default()
            }],
            real: Some(true),
            condition: f64::INFINITY,
            ..v1::Solution::default()
        }
    }

    #[test]
    fn few_points_are_all_there() {
        let mut sample = Sample::default();
        sample.take(point(1.0 / 3.0));
        sample.take(v1::Solution {
            undecided: true,
            ..point(2.0)
        });
        let expected = json!({"total": 2, "shown": 2, "variables": ["x"], "points": [
            [0, 0, "real", null, 0.0, [[0.3333333, 0.0]]],
            [1, 0, "undecided", null, 0.0, [[2.0, 0.0]]]]});
        assert_eq!(sample.json(), expected);
    }

    #[test]
    fn many_points_are_sampled_evenly_and_it_is_said() {
        let mut sample = Sample::default();
        for i in 0..100_000 {
            sample.take(point(f64::from(i)));
        }
        let json = sample.json();
        let points = json["points"].as_array().unwrap();
        assert_eq!(json["total"], 100_000);
        assert_eq!(json["shown"], points.len());
        assert!(points.len() <= MOST && points.len() >= MOST / 2 - 1);
        for point in points {
            assert_eq!(point[0].as_f64(), point[5][0][0].as_f64());
        }
    }
}

//! Images: the ends of paths that an exchange of groups gives without following them.
//!
//! Where a start by groups has one of each two start points (see
//! `start_systems::exchange`), path `i` of `n` has an image, number `n + i`, which
//! ends where the exchange takes its end. Counted with their images, the paths are
//! those of the whole start system.

use crate::point_shape::PointShape;
use cognate_continuation::path_result::{Coordinates, PathIndex, PathResult};
use cognate_continuation::start_systems::exchange::Exchange;
use std::borrow::Cow;

/// All results of `paths` paths and, after them, their images; of some of the paths just as many.
pub fn with_images<'a>(
    results: &'a [PathResult],
    paths: u64,
    exchange: Option<&Exchange>,
    shape: &PointShape,
) -> Cow<'a, [PathResult]> {
    let Some(exchange) = exchange else {
        return Cow::Borrowed(results);
    };
    let mut paths_and_images = results.to_vec();
    paths_and_images.extend(results.iter().map(|r| image(r, paths, exchange, shape)));
    Cow::Owned(paths_and_images)
}

/// End of the image of one path: the facts of the path, at the image of its end.
fn image(result: &PathResult, paths: u64, exchange: &Exchange, shape: &PointShape) -> PathResult {
    // Infinity is counted for affine groups only.
    let affine: Vec<usize> = (shape.spans().enumerate())
        .filter(|(_, span)| !span.group.homogeneous)
        .map(|(k, _)| k)
        .collect();
    let turns_of = |k: &usize| {
        let from = affine.binary_search(&exchange.groups[*k]).ok()?;
        result.infinity_turns.get(from).copied()
    };
    let point = result.endpoint.to_double();
    let endpoint = match shape.holds(point) {
        true => shape.exchanged(point, exchange),
        false => point.to_vec(),
    };
    PathResult {
        origin: PathIndex(result.origin.0 + paths),
        endpoint: Coordinates::Double(endpoint),
        infinity_turns: affine.iter().filter_map(turns_of).collect(),
        // A path and its image have one key.
        boundary: None,
        ..result.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::regular;
    use cognate_systems::system::{System, VariableGroup};

    #[test]
    fn an_image_is_where_the_exchange_takes_the_point() {
        let group = |variables: &[usize]| VariableGroup {
            variables: variables.to_vec(),
            homogeneous: false,
        };
        // The groups x, u and v, y; x goes to y and u to v.
        let system = System {
            variables: ["x", "u", "y", "v"].map(String::from).to_vec(),
            groups: vec![group(&[0, 1]), group(&[3, 2])],
            ..System::default()
        };
        let exchange = Exchange {
            variables: vec![2, 3, 0, 1],
            equations: vec![0],
            groups: vec![1, 0],
        };
        let shape = PointShape::of(&system);
        let point = [
            (0.5, 0.0),
            (1.0, 0.1),
            (0.3, 0.0),
            (0.25, 0.0),
            (1.0, 0.0),
            (0.0, 0.7),
        ];
        let mut result = regular(3, &point);
        result.infinity_turns = vec![1, 0];
        let results = [result];
        let paths_and_images = with_images(&results, 10, Some(&exchange), &shape);
        assert_eq!(paths_and_images[0], results[0]);
        assert_eq!(
            (
                paths_and_images[1].origin.0,
                &paths_and_images[1].infinity_turns
            ),
            (13, &vec![0, 1])
        );
        let (before, after) = (
            shape.to_variables(results[0].endpoint.to_double()),
            shape.to_variables(paths_and_images[1].endpoint.to_double()),
        );
        assert_eq!(after, [before[2], before[3], before[0], before[1]]);
        assert_eq!(with_images(&results, 10, None, &shape).len(), 1);
    }
}

//! Levels: the values of a real form at which sections of a real curve or surface change, each once.

/// Two values that are known to all digits of a double are one level within this part of the range of all values.
const SAME: f64 = 1e-11;
/// Two values that are known to all digits of a double are two levels beyond this part of the range: beside a level,
/// points that turn there come apart by the root of the distance.
const OTHER: f64 = 1e-8;
/// Two values are one level within this part of the range if one of them is of a singular point, of which fewer digits
/// are known.
const SAME_SINGULAR: f64 = 1e-7;
/// Two values are two levels beyond this part of the range if one of them is of a singular point.
const OTHER_SINGULAR: f64 = 1e-5;
/// Rounding error of a value, relative to the value: some digits of a double are lost.
const ROUNDING: f64 = 1e-14;

/// The value of a form at a point where sections change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    pub value: f64,
    /// Whether the value is known to all digits of a double.
    pub exact: bool,
}

/// The range of values; where they are all nearly one, a small part of their size.
pub(super) fn range_of(values: impl Iterator<Item = f64>) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values {
        (low, high) = (low.min(value), high.max(value));
    }
    match low <= high {
        true => (high - low).max(1e-3 * low.abs().max(1.0)),
        false => 1.0,
    }
}

/// Each value once, ascending; `None` where two are neither clearly one nor clearly two.
pub(super) fn levels(mut changes: Vec<Change>) -> Option<Vec<f64>> {
    changes.sort_by(|a, b| a.value.total_cmp(&b.value));
    let range = range_of(changes.iter().map(|change| change.value));
    let mut distinct_changes: Vec<Change> = Vec::new();
    for change in changes {
        let Some(last) = distinct_changes.last_mut() else {
            distinct_changes.push(change);
            continue;
        };
        let apart = change.value - last.value;
        let (same, other) = match change.exact && last.exact {
            true => (SAME, OTHER),
            false => (SAME_SINGULAR, OTHER_SINGULAR),
        };
        let rounding = ROUNDING * change.value.abs();
        if apart <= (same * range).max(rounding) {
            if change.exact && !last.exact {
                *last = change;
            }
        } else if apart <= (other * range).max(1e3 * rounding) {
            return None;
        } else {
            distinct_changes.push(change);
        }
    }
    Some(
        distinct_changes
            .into_iter()
            .map(|change| change.value)
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_values_are_one_or_two_or_not_clear() {
        let levels_of = |values: &[(f64, bool)]| {
            let change = |&(value, exact): &(f64, bool)| Change { value, exact };
            levels(values.iter().map(change).collect())
        };
        assert_eq!(levels_of(&[(3.0, true), (1.0, true)]), Some(vec![1.0, 3.0]));
        assert_eq!(
            levels_of(&[(1.0, true), (1.0 + 1e-6, true), (3.0, true)]),
            Some(vec![1.0, 1.0 + 1e-6, 3.0])
        );
        assert_eq!(
            levels_of(&[(1.0, true), (1.0 + 1e-9, true), (3.0, true)]),
            None
        );
        assert_eq!(
            levels_of(&[(1.0, false), (1.0 + 1e-6, true), (3.0, true)]),
            None
        );
        assert_eq!(
            levels_of(&[(1.0, false), (1.0 + 1e-8, true), (3.0, true)]),
            Some(vec![1.0 + 1e-8, 3.0])
        );
    }
}

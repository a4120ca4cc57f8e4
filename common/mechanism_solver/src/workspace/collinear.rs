//! Directions of links that lie on one line, each the same way as the first or against it.

/// All ways in which `count` links lie on a line, 1 along it and -1 against it.
pub fn signs(count: usize) -> impl Iterator<Item = Vec<f64>> {
    (0..1usize << count).map(move |bits| {
        let sign = |k: usize| if (bits >> k) & 1 == 0 { 1.0 } else { -1.0 };
        (0..count).map(sign).collect()
    })
}

/// All ways in which `count` links lie on a line, the first along it.
pub fn signs_from_first(count: usize) -> impl Iterator<Item = Vec<f64>> {
    signs(count.saturating_sub(1)).map(|others| std::iter::once(1.0).chain(others).collect())
}

/// The sum of lengths with signs.
pub fn extent(lengths: &[f64], signs: &[f64]) -> f64 {
    std::iter::zip(lengths, signs)
        .map(|(length, sign)| length * sign)
        .sum()
}

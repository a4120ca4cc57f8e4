//! Similar: the name that was meant where another one is written.

/// Insertions, deletions and replacements that make one word of another (Levenshtein).
pub(crate) fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut corner = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let replaced = corner + usize::from(x != y);
            corner = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(corner + 1);
        }
    }
    row[b.len()]
}

/// The name that was meant: the same in other letters, or one that a slip of the finger makes of it. Of short names every
/// one is a slip away from every other, so that these are told by their case only.
pub fn meant<'a>(written: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let slips = match written.chars().count() {
        0..3 => 0,
        3..6 => 1,
        _ => 2,
    };
    let lower = written.to_lowercase();
    let scored = names.into_iter().filter(|name| *name != written);
    let scored = scored.map(|name| (edits(&lower, &name.to_lowercase()), name));
    let (number, name) = scored.min_by_key(|(number, _)| *number)?;
    (number <= slips).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::meant;

    #[test]
    fn slips_are_told_from_other_names() {
        let names = ["x", "theta", "variables", "parameters"];
        assert_eq!(meant("X", names), Some("x"));
        assert_eq!(meant("y", names), None);
        assert_eq!(meant("thta", names), Some("theta"));
        assert_eq!(meant("varaibles", names), Some("variables"));
        assert_eq!(meant("equations", names), None);
    }
}

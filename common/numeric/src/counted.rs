//! Counted: a number with its noun, as messages for people write it.

/// `1 path`, `2 paths`, `0 classes`, `1 branch`, `2 families`; the noun is given in the singular.
pub fn counted<N>(number: N, noun: &str) -> String
where
    N: std::fmt::Display + PartialEq + From<u8>,
{
    if number == N::from(1) {
        return format!("1 {noun}");
    }
    let is_vowel = |c: char| "aeiou".contains(c);
    let stem = noun
        .strip_suffix('y')
        .filter(|stem| !stem.ends_with(is_vowel));
    if let Some(stem) = stem {
        return format!("{number} {stem}ies");
    }
    let hisses = ["s", "x", "ch", "sh"].iter().any(|end| noun.ends_with(end));
    format!("{number} {noun}{}", if hisses { "es" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_no_plural() {
        let written = [
            counted(1u64, "equation"),
            counted(0usize, "path"),
            counted(2u32, "class"),
            counted(3u64, "branch"),
            counted(2u64, "family"),
            counted(2u64, "array"),
        ];
        let expected = [
            "1 equation",
            "0 paths",
            "2 classes",
            "3 branches",
            "2 families",
            "2 arrays",
        ];
        assert_eq!(written, expected);
    }
}

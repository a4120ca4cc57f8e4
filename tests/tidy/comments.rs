//! Comments stand alone, and begin with their subject.

use super::{check, files, sources};

/// Words with which no line of a comment begins: the thing itself is named instead.
const NO_SUBJECTS: [&str; 11] = [
    "What", "Whose", "Who", "Whoever", "Such", "So many", "So much", "The same", "Its", "Their",
    "Those",
];

/// Whether a line of a comment begins with a word that stands for the thing that it is about.
fn begins_without_subject(comment: &str) -> bool {
    let is_word = |word: &&str| {
        let rest = comment.strip_prefix(*word);
        rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
    };
    comment.starts_with("...") || NO_SUBJECTS.iter().any(is_word)
}

#[test]
fn comments_begin_with_their_subject() {
    let mut offences = Vec::new();
    for file in sources().iter().chain(&files(".proto")) {
        for (number, line) in file.text.lines().enumerate() {
            let Some(comment) = line.trim_start().strip_prefix("//") else {
                continue;
            };
            let comment = comment.trim_start_matches(['/', '!']).trim();
            if begins_without_subject(comment) {
                offences.push(format!("{}:{}: `{comment}`", file.path, number + 1));
            }
        }
    }
    check(offences);
}

#[test]
fn subjects_are_told_from_other_words() {
    for comment in [
        "What is held.",
        "Those of a set.",
        "... or this,",
        "So many steps.",
        "Its end.",
    ] {
        assert!(begins_without_subject(comment), "{comment}");
    }
    for comment in [
        "Whatever comes.",
        "Itself.",
        "Steps of a path.",
        "Whole numbers.",
    ] {
        assert!(!begins_without_subject(comment), "{comment}");
    }
}

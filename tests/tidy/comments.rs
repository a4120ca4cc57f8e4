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

/// Whether a comment of one line names nothing: a question word alone, a pronoun and a noun, or a pronoun that stands for
/// what a reader who comes from a search has not read.
fn is_fragment(comment: &str) -> bool {
    const ALONE: [&str; 9] = [
        "Which", "Where", "What", "Who", "How", "Why", "When", "Same", "The same",
    ];
    let Some(said) = comment.strip_suffix('.') else {
        return false;
    };
    let mut words = said.split(' ');
    match (words.next(), words.count()) {
        (Some("Its" | "Their"), 1) | (Some("Those"), _) => true,
        _ => ALONE.contains(&said),
    }
}

#[test]
fn comments_stand_alone() {
    let mut offences = Vec::new();
    let protocols = files(".proto");
    for file in sources().iter().chain(&protocols) {
        let comments: Vec<Option<&str>> = file
            .text
            .lines()
            .map(|line| {
                let text = line.trim_start().strip_prefix("//")?;
                Some(text.trim_start_matches('/').trim())
            })
            .collect();
        for (number, comment) in comments.iter().enumerate() {
            // A comment that goes on from the line before, or in the next one, is more than a fragment.
            let is_comment = |at: usize| comments.get(at).copied().flatten().is_some();
            let alone = !(number > 0 && is_comment(number - 1) || is_comment(number + 1));
            if let Some(comment) = comment.filter(|said| alone && is_fragment(said)) {
                offences.push(format!("{}:{}: `{comment}`", file.path, number + 1));
            }
        }
    }
    check(offences);
}

#[test]
fn fragments_are_told_from_sentences() {
    let fragments = [
        "Which.",
        "Those of a checked system.",
        "Its name.",
        "The same.",
    ];
    assert!(fragments.into_iter().all(is_fragment));
    let sentences = [
        "Where it leads.",
        "Its name in the file.",
        "Why",
        "The points.",
    ];
    assert!(!sentences.into_iter().any(is_fragment));
}

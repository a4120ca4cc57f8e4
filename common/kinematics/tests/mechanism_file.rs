//! The page on the file of a mechanism: every example is read.

use cognate_kinematics::mechanism::{ReadOptions, read};

const PAGE: &str = include_str!("../mechanism_file.md");

/// The languages and texts of the blocks of code of a page in Markdown.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("```").skip(1).step_by(2);
    parts.filter_map(|part| part.split_once('\n')).collect()
}

#[test]
fn every_example_of_the_page_is_read() {
    let blocks = blocks(PAGE);
    assert_eq!(blocks.len(), 10);
    for (language, text) in blocks {
        let name = format!("example.{language}");
        let mechanism = read(&name, text.as_bytes(), &ReadOptions::default());
        let mechanism = mechanism.unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert!(
            !mechanism.values().is_empty() || text.contains("framework"),
            "{text}"
        );
        assert_eq!(mechanism.warnings, Vec::<String>::new(), "{text}");
    }
}

//! Real curves as a DXF drawing (release 12, which every program reads): each arc a polyline, each component on a layer of
//! its own.

use std::fmt::Write as _;

/// Pairs of a group code and a value, a line each.
fn pair(text: &mut String, code: u16, value: &str) {
    let _ = write!(text, "{code:>3}\r\n{value}\r\n");
}

/// The drawing of these arcs, each with the name of its component.
pub fn drawing(arcs: &[(String, Vec<(f64, f64)>)]) -> String {
    let mut text = String::new();
    pair(&mut text, 0, "SECTION");
    pair(&mut text, 2, "ENTITIES");
    for (component, points) in arcs {
        let layer = format!("COMPONENT-{component}");
        pair(&mut text, 0, "POLYLINE");
        pair(&mut text, 8, &layer);
        pair(&mut text, 66, "1");
        pair(&mut text, 70, "0");
        for (x, y) in points {
            pair(&mut text, 0, "VERTEX");
            pair(&mut text, 8, &layer);
            pair(&mut text, 10, &format!("{x}"));
            pair(&mut text, 20, &format!("{y}"));
            pair(&mut text, 30, "0");
        }
        pair(&mut text, 0, "SEQEND");
        pair(&mut text, 8, &layer);
    }
    pair(&mut text, 0, "ENDSEC");
    pair(&mut text, 0, "EOF");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_arc_is_a_polyline() {
        let arcs = vec![("1-1".to_owned(), vec![(0.0, 1.0), (0.5, -2.0)]); 3];
        let text = drawing(&arcs);
        let count = |word: &str| text.lines().filter(|line| *line == word).count();
        assert_eq!(
            (count("POLYLINE"), count("VERTEX"), count("SEQEND")),
            (3, 6, 3)
        );
        assert!(text.ends_with("  0\r\nEOF\r\n") && text.contains("\r\n-2\r\n"));
    }
}

//! Limits of an XML file that are looked at before the file is parsed.
//!
//! The parser compares each attribute of an element with all those before it, and hands namespaces down from element
//! to element; both take a time that is quadratic in their number. Files of robots have a handful.

/// Most attributes of one element. The longest element of URDF has five; extensions have more.
const MOST_ATTRIBUTES: usize = 64;
/// Most namespaces that a file declares.
const MOST_NAMESPACES: usize = 64;

/// The first place where a file is beyond a limit, in bytes from its beginning, with a message; the file need not be
/// well formed.
pub fn beyond_limits(text: &str) -> Option<(usize, String)> {
    let mut namespaces = 0;
    let mut rest = Scan { text, at: 0 };
    while let Some(start) = rest.to("<") {
        if rest.begins("!--") {
            rest.to("-->")?;
        } else if rest.begins("![CDATA[") {
            rest.to("]]>")?;
        } else if rest.begins("?") {
            rest.to("?>")?;
        } else {
            let mut attributes = 0;
            while let Some(byte) = rest.next() {
                match byte {
                    b'>' => break,
                    b'"' => _ = rest.to("\"")?,
                    b'\'' => _ = rest.to("'")?,
                    b'=' => attributes += 1,
                    b'x' if rest.begins("mlns") => namespaces += 1,
                    _ => {}
                }
                if attributes > MOST_ATTRIBUTES {
                    let message = format!("an element has more than {MOST_ATTRIBUTES} attributes");
                    return Some((start, message));
                }
                if namespaces > MOST_NAMESPACES {
                    let message = format!("more than {MOST_NAMESPACES} namespaces are declared");
                    return Some((start, message));
                }
            }
        }
    }
    None
}

/// A text that is read from left to right.
struct Scan<'t> {
    text: &'t str,
    at: usize,
}

impl Scan<'_> {
    /// Goes behind the next such word; where the word begins.
    fn to(&mut self, word: &str) -> Option<usize> {
        let place = self.at + self.text.get(self.at..)?.find(word)?;
        self.at = place + word.len();
        Some(place)
    }

    fn begins(&self, word: &str) -> bool {
        self.text.as_bytes()[self.at..].starts_with(word.as_bytes())
    }

    fn next(&mut self) -> Option<u8> {
        let byte = self.text.as_bytes().get(self.at).copied();
        // A byte within a character is none of those that are looked for.
        self.at += 1;
        while byte.is_some() && !self.text.is_char_boundary(self.at) {
            self.at += 1;
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_counted_where_they_are_some() {
        let many = |count: usize| -> String { (0..count).map(|k| format!(" a{k}='='")).collect() };
        let within = [
            format!("<robot{}><link/></robot>", many(MOST_ATTRIBUTES)),
            format!("<robot><!-- <a{}> --></robot>", many(1000)),
            format!("<robot><![CDATA[<a{}>]]></robot>", many(1000)),
            format!(
                "<?xml version=\"1.0\"?><robot name=\"{}\"/>",
                "= ".repeat(1000)
            ),
            "<é ü='ö'>= = =</é>".to_owned(),
            "<unfinished a='".to_owned(),
            String::new(),
        ];
        for text in &within {
            assert_eq!(beyond_limits(text), None, "{text}");
        }
        let beyond = format!("<robot>\n<link{}/></robot>", many(MOST_ATTRIBUTES + 1));
        assert_eq!(beyond_limits(&beyond).map(|(at, _)| at), Some(8));
        let namespaces: String = (0..=MOST_NAMESPACES)
            .map(|k| format!("<a xmlns:n{k}='u'>"))
            .collect();
        assert!(beyond_limits(&namespaces).is_some());
    }
}

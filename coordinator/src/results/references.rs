//! References: which objects the bytes of another object name.
//!
//! Whatever an object is, it names others by their digests: as 32 bytes (messages, states) or as 64 hexadecimal
//! digits (text). Looking for these finds every reference, also those of kinds that come later; bytes that are
//! equal by chance keep an object that could go, and take nothing away.

use crate::ledger::identity::parse_digest;
use cognate_continuation::start_points::Digest;
use std::collections::{BTreeSet, HashMap};

/// Digests that are looked for, by their first eight bytes.
#[derive(Debug)]
pub struct Wanted {
    by_head: HashMap<[u8; 8], Vec<Digest>>,
}

impl Wanted {
    /// Looks for these.
    pub fn new(digests: &BTreeSet<Digest>) -> Self {
        let mut by_head: HashMap<[u8; 8], Vec<Digest>> = HashMap::new();
        for digest in digests {
            by_head.entry(head(&digest.0)).or_default().push(*digest);
        }
        Self { by_head }
    }

    /// Objects that these bytes name by their digests.
    pub fn named_in(&self, bytes: &[u8]) -> BTreeSet<Digest> {
        let mut named = BTreeSet::new();
        for window in bytes.windows(32) {
            let candidates = self.by_head.get(&head(window)).into_iter().flatten();
            named.extend(candidates.filter(|digest| digest.0 == window));
        }
        let mut digits = 0;
        for (at, byte) in bytes.iter().enumerate() {
            digits = if byte.is_ascii_hexdigit() {
                digits + 1
            } else {
                0
            };
            if digits >= 64
                && let Ok(text) = std::str::from_utf8(&bytes[at - 63..=at])
                && let Ok(digest) = parse_digest(text)
                && self.by_head.contains_key(&head(&digest.0))
            {
                named.insert(digest);
            }
        }
        named
    }
}

fn head(bytes: &[u8]) -> [u8; 8] {
    *bytes.first_chunk().expect("a digest has 32 bytes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::identity::digest_of;

    #[test]
    fn digests_are_found_in_both_forms_and_nothing_else_is() {
        let digests: BTreeSet<Digest> = (0..9u8).map(|k| digest_of(&[k])).collect();
        let wanted = Wanted::new(&digests);
        let [first, second] = [digest_of(&[3]), digest_of(&[5])];
        let other = digest_of(b"other");
        let mut bytes = b"abc".to_vec();
        bytes.extend(first.0);
        bytes.extend(format!("0f{second}a").bytes());
        bytes.extend(other.0);
        bytes.extend(&digest_of(&[7]).0[..31]);
        assert_eq!(wanted.named_in(&bytes), BTreeSet::from([first, second]));
        assert!(wanted.named_in(&bytes[..20]).is_empty());
    }
}

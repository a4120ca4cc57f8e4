//! Place: where the results and all other objects are, as a person writes it: a folder, or a bucket of S3.

use object_store::path::Path as Prefix;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Where the results and all other objects are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ResultsPlace {
    /// A folder, which all coordinators of one ledger see.
    Folder(PathBuf),
    /// A bucket of S3, or of another service that speaks as S3 does.
    Bucket(BucketAddress),
}

/// A bucket of S3 and what all names in it begin with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BucketAddress {
    /// Name of the bucket.
    pub bucket: String,
    /// Prefix of the names of the objects, before a slash; empty: none.
    pub prefix: Prefix,
}

/// A text that names no place for results.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no place for results: {what}; expected a folder or s3://BUCKET/PREFIX")]
pub struct PlaceError {
    text: String,
    what: String,
}

/// Beginning of the address of a bucket.
const SCHEME: &str = "s3://";

impl ResultsPlace {
    /// The folder, where it is one.
    pub fn as_folder(&self) -> Option<&Path> {
        match self {
            Self::Folder(folder) => Some(folder),
            Self::Bucket(_) => None,
        }
    }
}

impl FromStr for ResultsPlace {
    type Err = PlaceError;

    fn from_str(text: &str) -> Result<Self, PlaceError> {
        let wrong = |what: String| PlaceError {
            text: text.to_owned(),
            what,
        };
        let folder = text.strip_prefix("file://").unwrap_or(text);
        if let Some(address) = text.strip_prefix(SCHEME) {
            let (bucket, prefix) = address.split_once('/').unwrap_or((address, ""));
            // Amazon S3 user guide, "General purpose bucket naming rules".
            let is_part = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit();
            let is_name = (3..=63).contains(&bucket.len())
                && bucket.bytes().all(|c| is_part(c) || c == b'-' || c == b'.')
                && bucket.bytes().next().is_some_and(is_part)
                && bucket.bytes().next_back().is_some_and(is_part);
            if !is_name {
                let what = "a bucket's name has 3 to 63 lower-case letters, digits, `-` and `.`";
                return Err(wrong(what.to_owned()));
            }
            let prefix = Prefix::parse(prefix).map_err(|error| wrong(error.to_string()))?;
            let bucket = bucket.to_owned();
            return Ok(Self::Bucket(BucketAddress { bucket, prefix }));
        }
        match folder {
            "" => Err(wrong("it is empty".to_owned())),
            _ if folder.contains("://") => Err(wrong("it is another scheme".to_owned())),
            _ => Ok(Self::Folder(folder.into())),
        }
    }
}

impl From<PathBuf> for ResultsPlace {
    fn from(folder: PathBuf) -> Self {
        Self::Folder(folder)
    }
}

impl fmt::Display for ResultsPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(folder) => folder.display().fmt(f),
            Self::Bucket(address) => address.fmt(f),
        }
    }
}

impl fmt::Display for BucketAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let slash = if self.prefix.is_root() { "" } else { "/" };
        write!(f, "{SCHEME}{}{slash}{}", self.bucket, self.prefix)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_or_refused() {
        let folder = |path: &str| Ok(ResultsPlace::Folder(path.into()));
        assert_eq!("a/b".parse(), folder("a/b"));
        assert_eq!("file:///a/b".parse(), folder("/a/b"));
        for text in ["s3://gears", "s3://gears/2026/nine-point"] {
            let place: ResultsPlace = text.parse().unwrap();
            assert_eq!(place.as_folder(), None);
            assert_eq!(place.to_string(), text);
        }
        let slash: ResultsPlace = "s3://gears/".parse().unwrap();
        assert_eq!(slash.to_string(), "s3://gears");
        for text in [
            "",
            "file://",
            "s3://",
            "s3://ab",
            "s3://Gears",
            "s3://-gears",
            "s3://user:word@gears/x",
            "s3://gears/a//b",
            "s3://gears/../b",
            "gs://gears/x",
        ] {
            assert!(text.parse::<ResultsPlace>().is_err(), "{text}");
        }
    }
}

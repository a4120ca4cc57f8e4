//! Cache: prepared mechanisms, and solved families of equations, on disk. An entry is found by a digest of all that its
//! points depend on, and is believed only where its text has its own digest.

use cognate_kinematics::compile::Formulation;
use cognate_numeric::NUMERICS_REVISION;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Raised when the text of an entry changes.
const VERSION: u32 = 1;
/// Largest number of bytes of an entry: a thousand points of a thousand coordinates.
const MOST_BYTES: u64 = 64 << 20;
/// The ending of an entry's file.
const ENDING: &str = "prepared.json";

/// Kind of the entries of a cache folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Mechanisms, each with its positions at a general target.
    Mechanisms,
    /// Families of equations, each with its solutions at general values of its parameters.
    Families,
}

impl Content {
    /// The folder's name below the user's cache folder.
    fn folder(self) -> &'static str {
        match self {
            Self::Mechanisms => "mechanisms",
            Self::Families => "families",
        }
    }

    /// Words for the work that is repeated when an entry cannot be used: the object, and the participle.
    fn work(self) -> [&'static str; 2] {
        match self {
            Self::Mechanisms => ["the mechanism", "prepared"],
            Self::Families => ["the family", "solved"],
        }
    }
}

/// A folder of entries of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cache {
    folder: PathBuf,
    content: Content,
}

/// Digest of all data that an entry depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key(String);

/// The stored part of a prepared mechanism or a solved family; the parameters are computed again.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Positions or solutions, point after point.
    pub points: Vec<Complex64>,
    /// Description of the paths that end elsewhere, in words.
    pub others: String,
}

/// Result of a look-up in the cache.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// The cache has no entry for the key.
    Absent,
    /// An entry whose text is as it was written.
    Found(Kept),
    /// An entry that cannot be used, with the reason.
    Unusable(String),
}

/// The text of an entry. Numbers are texts: so they come back with all bits.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    version: u32,
    key: String,
    points: Vec<[String; 2]>,
    others: String,
}

impl Key {
    /// Of the equations of a formulation, its general member, and the revision of the tracker.
    pub fn of(formulation: &dyn Formulation, member: &[Complex64], seed: u64) -> Self {
        let equations = formulation.equations();
        let equations = equations.map(|e| e.json()).unwrap_or_default();
        let name = &formulation.family().name;
        Self::of_parts(&[name.as_bytes(), equations.as_bytes()], member, seed)
    }

    /// Of these parts, values of parameters, and the revision of the tracker.
    pub fn of_parts(parts: &[&[u8]], values: &[Complex64], seed: u64) -> Self {
        let mut hasher = blake3::Hasher::new();
        let mut part = |bytes: &[u8]| {
            hasher.update(&(bytes.len() as u64).to_le_bytes());
            hasher.update(bytes);
        };
        part(&VERSION.to_le_bytes());
        part(&NUMERICS_REVISION.to_le_bytes());
        part(&seed.to_le_bytes());
        for bytes in parts {
            part(bytes);
        }
        for z in values {
            part(&z.re.to_bits().to_le_bytes());
            part(&z.im.to_bits().to_le_bytes());
        }
        Self(hasher.finalize().to_hex().to_string())
    }
}

impl Cache {
    /// The cache of mechanisms in a folder, which is made when something is kept.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            content: Content::Mechanisms,
        }
    }

    /// The cache of families of equations in the user's folder; `None` where the user has none.
    pub fn of_families() -> Option<Self> {
        Some(Self {
            folder: Self::usual_folder(Content::Families)?,
            content: Content::Families,
        })
    }

    /// The folder below the user's cache folder; `None` where the user has none.
    pub fn usual_folder(content: Content) -> Option<PathBuf> {
        let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        let configured_folder = variable("XDG_CACHE_HOME").map(PathBuf::from);
        let configured_folder = configured_folder.filter(|path| path.is_absolute());
        let home = || variable("HOME").map(|home| PathBuf::from(home).join(".cache"));
        let cache = configured_folder.or_else(home)?;
        Some(cache.join("cognate").join(content.folder()))
    }

    fn path(&self, key: &Key) -> PathBuf {
        self.folder.join(format!("{}.{ENDING}", key.0))
    }

    /// Message for the user about an entry that is not used.
    pub fn unusable(&self, key: &Key, reason: &str) -> String {
        let [what, done] = self.content.work();
        format!(
            "cache: {} is not used: {reason}; {what} was {done} again",
            self.path(key).display()
        )
    }

    /// The entry of a key.
    pub fn find(&self, key: &Key) -> Entry {
        let path = self.path(key);
        let content = match std::fs::metadata(&path) {
            Ok(metadata) if metadata.len() <= MOST_BYTES => std::fs::read(&path),
            Ok(_) => return Entry::Unusable(self.unusable(key, "it is too long")),
            Err(e) => Err(e),
        };
        match content {
            Ok(content) => match kept(&content, key) {
                Ok(kept) => Entry::Found(kept),
                Err(reason) => Entry::Unusable(self.unusable(key, reason)),
            },
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Entry::Absent,
            Err(e) => Entry::Unusable(self.unusable(key, &format!("it cannot be read ({e})"))),
        }
    }

    /// Keeps an entry, whole or not at all; says so where that is not possible.
    pub fn keep(&self, key: &Key, kept: &Kept) -> Option<String> {
        let number = |x: f64| format!("{x:?}");
        let pair = |z: &Complex64| [number(z.re), number(z.im)];
        let text = Text {
            version: VERSION,
            key: key.0.clone(),
            points: kept.points.iter().map(pair).collect(),
            others: kept.others.clone(),
        };
        self.write(key, &text).err().map(|e| {
            let [what, done] = self.content.work();
            format!(
                "cache: cannot write {}: {e}; {what} will be {done} again the next time",
                self.path(key).display()
            )
        })
    }

    fn write(&self, key: &Key, text: &Text) -> std::io::Result<()> {
        std::fs::create_dir_all(&self.folder)?;
        let body = serde_json::to_string(text)?;
        let digest = blake3::hash(body.as_bytes()).to_hex();
        let content = format!("{digest}\n{body}\n");
        if content.len() as u64 > MOST_BYTES {
            return Err(std::io::Error::other("it is too long"));
        }
        let mut file = tempfile::Builder::new()
            .prefix(".cognate-")
            .tempfile_in(&self.folder)?;
        file.write_all(content.as_bytes())?;
        file.persist(self.path(key)).map_err(|e| e.error)?;
        Ok(())
    }
}

/// Reads an entry: a line with the digest of the second line, which holds the rest.
fn kept(content: &[u8], key: &Key) -> Result<Kept, &'static str> {
    const DAMAGED: &str = "it is damaged";
    let text = std::str::from_utf8(content).map_err(|_| DAMAGED)?;
    let (digest, body) = text.split_once('\n').ok_or(DAMAGED)?;
    let body = body.strip_suffix('\n').ok_or(DAMAGED)?;
    if blake3::hash(body.as_bytes()).to_hex().as_str() != digest {
        return Err(DAMAGED);
    }
    let text: Text = serde_json::from_str(body).map_err(|_| "it is of another version")?;
    if text.version != VERSION || text.key != key.0 {
        return Err("it is of another mechanism, family or version");
    }
    let number = |text: &String| text.parse::<f64>().ok().filter(|x| x.is_finite());
    let points = text.points.iter();
    let points = points.map(|[re, im]| Some(Complex64::new(number(re)?, number(im)?)));
    Ok(Kept {
        points: points.collect::<Option<_>>().ok_or(DAMAGED)?,
        others: text.others,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept() -> Kept {
        Kept {
            points: [0.1, -1e-300, 1.0 / 3.0]
                .map(|x| Complex64::new(x, -2.0 * x))
                .to_vec(),
            others: "8 at infinity".into(),
        }
    }

    #[test]
    fn what_is_kept_comes_back_with_all_bits() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(&folder.path().join("not yet"));
        let key = Key("abc".into());
        assert_eq!(cache.find(&key), Entry::Absent);
        assert_eq!(cache.keep(&key, &kept()), None);
        assert_eq!(cache.find(&key), Entry::Found(kept()));
        assert_eq!(cache.find(&Key("abd".into())), Entry::Absent);
    }

    /// Every byte that is changed is noticed, and an entry under another's name too.
    #[test]
    fn damaged_and_foreign_entries_are_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(folder.path());
        let key = Key("abc".into());
        cache.keep(&key, &kept());
        let path = cache.path(&key);
        let content = std::fs::read(&path).unwrap();
        for place in (0..content.len()).step_by(7) {
            let mut damaged = content.clone();
            damaged[place] ^= 1;
            std::fs::write(&path, &damaged).unwrap();
            let entry = cache.find(&key);
            assert!(
                matches!(entry, Entry::Unusable(_)),
                "byte {place}: {entry:?}"
            );
        }
        std::fs::write(&path, &content[..content.len() / 2]).unwrap();
        assert!(matches!(cache.find(&key), Entry::Unusable(_)));
        let other = Key("abd".into());
        std::fs::write(cache.path(&other), &content).unwrap();
        let Entry::Unusable(reason) = cache.find(&other) else {
            panic!("it is another's");
        };
        assert!(reason.contains("another mechanism"), "{reason}");
        std::fs::create_dir(cache.path(&Key("folder".into()))).unwrap();
        let entry = cache.find(&Key("folder".into()));
        assert!(matches!(entry, Entry::Unusable(_)), "{entry:?}");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let said = Cache::new(&file).keep(&Key("abc".into()), &kept());
        assert!(said.is_some_and(|text| text.contains("cannot write")));
    }
}

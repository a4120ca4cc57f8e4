//! Tokens: what the lines of a token file say.
//!
//! Coordinator, workers, clients and viewers read the same file: `ROLE TOKEN [name=NAME] [tenant=NAME] [LIMIT=N ...]`.

use std::collections::BTreeSet;
use std::path::Path;

/// Role of a caller, which decides what it may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Submit jobs and read results.
    Client,
    /// Look at jobs and read results, and change nothing.
    Viewer,
    /// Track paths.
    Worker,
}

impl Role {
    /// Name of the role in a token file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Client => "client",
            Self::Viewer => "viewer",
            Self::Worker => "worker",
        }
    }

    /// Whether this role may do everything that `wanted` may: a client may look, too.
    pub fn covers(self, wanted: Self) -> bool {
        self == wanted || (self, wanted) == (Self::Client, Self::Viewer)
    }
}

/// Fewest characters of a token: what is shorter can be guessed.
pub const SHORTEST_TOKEN: usize = 16;
/// Most characters of a name in a token file.
const LONGEST_NAME: usize = 64;
/// Format of a line, as shown in the error for a malformed line.
const EXPECTED: &str = "expected `client TOKEN`, `viewer TOKEN`, `worker TOKEN` or a token, then name=, \
                        tenant=, jobs=, paths=, bytes=, calls=";

/// A file that holds no token, or not what it should.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {what}")]
pub struct CredentialError {
    /// Path of the file, or name of the option.
    pub file: String,
    /// Description of the fault in the file or option.
    pub what: String,
}

impl CredentialError {
    /// Something is wrong with this file.
    pub fn of(file: &Path, what: impl ToString) -> Self {
        Self {
            file: file.display().to_string(),
            what: what.to_string(),
        }
    }
}

/// Limits on what the holder of a client's token may have at once; `None`: no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Jobs that have not ended, of its tenant.
    pub jobs: Option<u64>,
    /// Paths of all jobs of its tenant that have not ended, as planned.
    pub paths: Option<u64>,
    /// Bytes of problems and uploads in an hour.
    pub bytes: Option<u64>,
    /// Calls that are not answered yet.
    pub calls: Option<u64>,
}

/// A line of a token file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TokenLine {
    /// Role that the token gives; `None`: all roles.
    pub role: Option<Role>,
    /// The token.
    pub token: String,
    /// Name of the token's holder in logs; it says nothing about the token.
    pub name: Option<String>,
    /// The tenant whose jobs it is for; `None`: those of all.
    pub tenant: Option<String>,
    /// Limits of the token's holder.
    pub limits: Limits,
}

/// The tokens of a file; the first line that is malformed is refused.
///
/// A line is `client TOKEN`, `viewer TOKEN`, `worker TOKEN`, or a token alone, which is good for all. After it may follow
/// `name=NAME`, and of clients and viewers `tenant=NAME` and limits (`jobs=N`, `paths=N`, `bytes=N`, `calls=N`). What
/// follows `#` is a comment.
pub fn read_tokens(file: &Path) -> Result<Vec<TokenLine>, CredentialError> {
    let text = std::fs::read_to_string(file).map_err(|error| CredentialError::of(file, error))?;
    let mut tokens = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        let read = token_line(&words);
        tokens.push(
            read.map_err(|what| CredentialError::of(file, format!("line {}: {what}", number + 1)))?,
        );
    }
    if tokens.is_empty() {
        return Err(CredentialError::of(file, "it holds no token"));
    }
    Ok(tokens)
}

fn token_line(words: &[&str]) -> Result<TokenLine, String> {
    let is_setting = |word: &&&str| word.contains('=') && setting_name(word).is_some();
    let settings = words.iter().rev().take_while(is_setting).count();
    let (head, settings) = words.split_at(words.len() - settings);
    let (role, token) = match *head {
        [token] => (None, token),
        ["client", token] => (Some(Role::Client), token),
        ["viewer", token] => (Some(Role::Viewer), token),
        ["worker", token] => (Some(Role::Worker), token),
        _ => return Err(EXPECTED.to_owned()),
    };
    if token.len() < SHORTEST_TOKEN || !token.bytes().all(|b| b.is_ascii_graphic()) {
        return Err(format!(
            "a token has at least {SHORTEST_TOKEN} visible ASCII characters"
        ));
    }
    let mut line = TokenLine {
        role,
        token: token.to_owned(),
        name: None,
        tenant: None,
        limits: Limits::default(),
    };
    let mut named = BTreeSet::new();
    for setting in settings {
        let Some((name, value)) = setting.split_once('=') else {
            return Err(EXPECTED.to_owned());
        };
        if !named.insert(name) {
            return Err(format!("{name} stands twice"));
        }
        if role == Some(Role::Worker) && name != "name" {
            return Err(format!("{name} says nothing about a worker"));
        }
        line.set(name, value)?;
    }
    Ok(line)
}

/// The name of a setting, where a word is one.
fn setting_name(word: &str) -> Option<&str> {
    let (name, _) = word.split_once('=')?;
    ["name", "tenant", "jobs", "paths", "bytes", "calls"]
        .contains(&name)
        .then_some(name)
}

impl TokenLine {
    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "name" => self.name = Some(checked_name(name, value)?),
            "tenant" => self.tenant = Some(checked_name(name, value)?),
            _ => {
                let limit = value.parse::<u64>().ok().filter(|&limit| limit > 0);
                let limit =
                    Some(limit.ok_or_else(|| {
                        format!("{name}={value}: expected a whole number above 0")
                    })?);
                match name {
                    "jobs" => self.limits.jobs = limit,
                    "paths" => self.limits.paths = limit,
                    "bytes" => self.limits.bytes = limit,
                    _ => self.limits.calls = limit,
                }
            }
        }
        Ok(())
    }
}

fn checked_name(what: &str, value: &str) -> Result<String, String> {
    let fits =
        (1..=LONGEST_NAME).contains(&value.len()) && value.bytes().all(|b| b.is_ascii_graphic());
    match fits {
        true => Ok(value.to_owned()),
        false => Err(format!(
            "{what}={value}: expected 1 to {LONGEST_NAME} visible ASCII characters"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<TokenLine>, CredentialError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tokens");
        std::fs::write(&path, text).unwrap();
        read_tokens(&path)
    }

    #[test]
    fn lines_say_who_may_do_how_much() {
        let tokens = read(
            "# of the laboratory\nclient 0123456789abcdef name=ada tenant=gears jobs=3 paths=100000 \
             bytes=1000 calls=2\nworker fedcba9876543210 name=rack-1 # new\n\n0123456789abcde=\n",
        );
        let tokens = tokens.unwrap();
        assert_eq!(tokens[0].role, Some(Role::Client));
        assert_eq!(tokens[0].token, "0123456789abcdef");
        assert_eq!(tokens[0].tenant.as_deref(), Some("gears"));
        let limits = Limits {
            jobs: Some(3),
            paths: Some(100_000),
            bytes: Some(1000),
            calls: Some(2),
        };
        assert_eq!(tokens[0].limits, limits);
        assert_eq!(tokens[1].name.as_deref(), Some("rack-1"));
        assert_eq!((tokens[1].role, tokens[2].role), (Some(Role::Worker), None));
        assert_eq!(tokens[2].token, "0123456789abcde=", "base64 ends so");
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let check = |text: &str, expected: &str| {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        };
        check(
            "\nmaster 0123456789abcdef",
            "line 2: expected `client TOKEN`",
        );
        check("client 0123456789abcdef jobs=0", "line 1: jobs=0: expected");
        check("client 0123456789abcdef jobs=many", "a whole number");
        check("client 0123456789abcdef jobs=1 jobs=2", "jobs stands twice");
        check(
            "client 0123456789abcdef tenant=",
            "tenant=: expected 1 to 64",
        );
        check("client 0123456789abcdef room=2", "line 1: expected");
        check(
            "worker 0123456789abcdef tenant=a",
            "says nothing about a worker",
        );
        check("client jobs=1", "at least 16");
    }
}

//! ProtocolError: what was wrong with a message, and in which field.

use cognate_systems::formats::limits::Limit;
use cognate_systems::system::SystemError;

/// Why a message was refused. Every variant names the field, as a path from the outermost message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProtocolError {
    /// A field that must be there is not.
    #[error("{field} is missing")]
    Missing {
        /// The field.
        field: String,
    },
    /// A field has a value that it must not have.
    #[error("{field} is {found}; expected {expected}")]
    Invalid {
        /// The field.
        field: String,
        /// Value of the field, shortened.
        found: String,
        /// Values that the field may hold.
        expected: String,
    },
    /// There is more of something than is accepted.
    #[error("{field}: {found} {what}, more than the limit {name} of {value}")]
    Limit {
        /// The field.
        field: String,
        /// Number or size that the message has.
        found: u64,
        /// Name of the counted things: variables, bytes.
        what: &'static str,
        /// Name of the limit.
        name: &'static str,
        /// Value of the limit.
        value: u64,
    },
    /// The message is well-formed, but what it describes is no system.
    #[error("{field}: {source}")]
    System {
        /// The field.
        field: String,
        /// Fault of the system.
        source: SystemError,
    },
}

impl ProtocolError {
    /// A missing field.
    pub fn missing(field: impl Into<String>) -> Self {
        Self::Missing {
            field: field.into(),
        }
    }

    /// A wrong value; long ones are cut.
    pub fn invalid(
        field: impl Into<String>,
        content: impl std::fmt::Display,
        expected: impl Into<String>,
    ) -> Self {
        let text = content.to_string();
        let short: String = text.chars().take(60).collect();
        Self::Invalid {
            field: field.into(),
            found: if short.len() < text.len() {
                format!("{short}...")
            } else {
                short
            },
            expected: expected.into(),
        }
    }

    /// The field, as a path from the outermost message.
    pub fn field(&self) -> &str {
        match self {
            Self::Missing { field }
            | Self::Invalid { field, .. }
            | Self::Limit { field, .. }
            | Self::System { field, .. } => field,
        }
    }

    /// Prefixes the field with the name of the message around it.
    #[must_use]
    pub fn within(mut self, outer: impl std::fmt::Display) -> Self {
        let (Self::Missing { field }
        | Self::Invalid { field, .. }
        | Self::Limit { field, .. }
        | Self::System { field, .. }) = &mut self;
        *field = if field.is_empty() {
            outer.to_string()
        } else {
            format!("{outer}.{field}")
        };
        self
    }
}

/// Refuses more than a limit allows.
pub fn within_limit(
    field: impl Into<String>,
    size: usize,
    limit: Limit,
) -> Result<(), ProtocolError> {
    let size = u64::try_from(size).unwrap_or(u64::MAX);
    if size <= limit.value {
        return Ok(());
    }
    Err(ProtocolError::Limit {
        field: field.into(),
        found: size,
        what: limit.what,
        name: limit.name,
        value: limit.value,
    })
}

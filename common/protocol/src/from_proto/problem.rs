//! Problem message to Submission.

pub use super::expression_graph::rational;
pub use super::options::{equation_sets, options, settings};
pub use super::system::system;

use super::required;
use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::submission::{Source, Submission};
use crate::v1;
use cognate_systems::formats::limits as sizes;

/// The submission of a client: a problem and its options.
pub fn submission(message: v1::Problem) -> Result<Submission, ProtocolError> {
    let source = match required("source", message.source)? {
        v1::problem::Source::System(m) => {
            let mut system = system(&m).map_err(|e| e.within("system"))?;
            // Methods that work with parts of a system take equations by their names.
            if system.equation_names.is_empty() {
                let names = (1..=system.equation_count()).map(|i| format!("equation {i}"));
                system.equation_names = names.collect();
            }
            Source::System(Box::new(system))
        }
        v1::problem::Source::Text(m) => {
            within_limit("text.name", m.name.len(), limits::NAME_BYTES)?;
            within_limit("text.content", m.content.len(), sizes::FILE_BYTES)?;
            Source::Text {
                name: if m.name.is_empty() {
                    "problem".to_owned()
                } else {
                    m.name
                },
                content: m.content.to_vec(),
            }
        }
    };
    let options = options(message.options.unwrap_or_default()).map_err(|e| e.within("options"))?;
    Ok(Submission { source, options })
}

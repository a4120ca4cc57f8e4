//! Answers for programs that hold this crate in their own process, such as those of other languages (`deploy/c`): texts in,
//! texts and numbers out. No other process is started, no signal is caught, nothing is printed.

mod arm;
mod solve;

pub use arm::{Arm, ArmAnswer};
pub use solve::solve;

use crate::error::{ClientError, Exit};
use serde_json::json;

/// The exit code of a refusal, and the refusal as JSON.
fn refused(error: &ClientError) -> (Exit, String) {
    (
        error.exit(),
        json!({"error": error.to_string()}).to_string(),
    )
}

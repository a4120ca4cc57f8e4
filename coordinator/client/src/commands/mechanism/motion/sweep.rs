//! Sweep: the motion of a mechanism with open numbers at many values of them.

use super::{Asked, answered};
use crate::commands::mechanism::free_numbers::FreeNumbers;
use crate::commands::mechanism::read::wrong;
use crate::commands::sequence::Sequence;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismMotion;
use crate::output::mechanisms::motion::{self as shown, SweptAnswer};
use crate::output::objects;
use crate::output::text::Look;
use crate::problem::read_file;
use cognate_kinematics::mechanism::Mechanism;
use cognate_kinematics::mechanism::exact::Number;
use serde_json::Value;
use std::path::Path;

/// The mechanism at one set of values.
pub(super) struct Member {
    mechanism: Mechanism,
    asked: Asked,
    /// The values, in the order of the file's open numbers.
    values: Vec<(String, f64)>,
}

/// The mechanism of the file at each set of values.
pub(super) fn members(a: &MechanismMotion, values: &Path) -> Result<Vec<Member>, ClientError> {
    let free = FreeNumbers::of(&a.mechanism.file)?;
    let (origin, content) = read_file(values)?;
    let expected = "expected a list of {\"NAME\": VALUE, ..}";
    let list: Value =
        serde_json::from_slice(&content).map_err(|e| wrong(&origin, format!("{expected}: {e}")))?;
    let list = list.as_array().ok_or_else(|| wrong(&origin, expected))?;
    let mut members = Vec::new();
    for (index, given) in list.iter().enumerate() {
        let fault = |message: String| wrong(&origin, format!("values {index}: {message}"));
        let given = given.as_object().ok_or_else(|| fault(expected.into()))?;
        if let Some(strange) = given.keys().find(|key| !free.names.contains(key)) {
            let message = format!(
                "no number {strange} is open; there are {}",
                free.names.join(", ")
            );
            return Err(fault(message));
        }
        let mut filled = Vec::new();
        for name in &free.names {
            let value = given
                .get(name)
                .ok_or_else(|| fault(format!("{name} is missing")))?;
            let text = match value {
                Value::String(text) => text.clone(),
                value => value.to_string(),
            };
            let number = Number::read(&text)
                .ok_or_else(|| fault(format!("{name}: expected a number, found {value}")))?;
            filled.push((name.clone(), number.to_f64()));
        }
        let mechanism = free.mechanism(given, &format!("values {index}"), &a.mechanism)?;
        members.push(Member {
            asked: Asked::of(&mechanism, None)?,
            mechanism,
            values: filled,
        });
    }
    Ok(members)
}

/// An answer for each member, in the order of the values.
pub(super) async fn answers(
    a: &MechanismMotion,
    jobs: Sequence,
    members: Vec<Member>,
) -> Result<Exit, ClientError> {
    let mut swept = Vec::new();
    for (index, member) in members.into_iter().enumerate() {
        let answer = answered(a, &jobs, &member.mechanism, &member.asked).await?;
        for doubt in &answer.doubts {
            eprintln!("warning: values {index}: {doubt}");
        }
        swept.push(SweptAnswer {
            mechanism: member.mechanism,
            values: member.values,
            answer,
        });
    }
    objects::print(
        a.format,
        &["/values"],
        || shown::swept_table(&swept, Look::of_standard_output()),
        || shown::swept_json(&swept),
    )?;
    Ok(Exit::of_settled(
        swept.iter().all(|each| each.answer.is_settled()),
    ))
}

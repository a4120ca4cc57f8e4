//! Cusps and changes of posture of an arm of three joints, as a table and as JSON.

use super::view::mechanism_json;
use crate::output::text::{Look, counted};
use cognate_kinematics::mechanism::Mechanism;
use cognate_mechanism_solver::point_arm::PostureChanges;
use serde_json::json;

/// The answer for programs, in the fields of all singular positions: those that a set of dimension 2 does not have are null.
pub fn json(mechanism: &Mechanism, content: &[u8], changes: &PostureChanges) -> String {
    let object = json!({
        "mechanism": mechanism_json(mechanism, content),
        "kind": "outputs",
        "inputs": null,
        "dimension": changes.dimension,
        "components": null,
        "isolated": {"complex": 0, "real": 0},
        "solutions": [],
        "curves": null,
        "cuspidal": changes.cuspidal,
        "cusps": changes.cusps,
        "cusp_places": changes.places,
        "cusp_coordinates": changes.coordinates,
        "reason": changes.reason.map(|reason| reason.describe()),
        "removed": {},
        "settled": changes.doubts.is_empty(),
        "unsettled": changes.doubts,
        "warnings": [],
    });
    format!("{object:#}\n")
}

/// The answer for people.
pub fn table(mechanism: &Mechanism, changes: &PostureChanges, look: Look) -> String {
    let name = look.bold(&mechanism.name);
    let singular = match changes.dimension {
        -1 => "nowhere singular for its output".to_owned(),
        3 => "singular for its output in all positions".to_owned(),
        dimension => format!("singular for its output in a set of dimension {dimension}"),
    };
    let cusps = changes.cusps.map_or_else(
        || "the number of cusps is not settled".into(),
        |cusps| counted(cusps, "cusp"),
    );
    let verdict = match changes.cuspidal {
        Some(true) => look.good("cuspidal"),
        Some(false) => look.good("not cuspidal"),
        None => look.warn("whether it is cuspidal is not settled"),
    };
    let mut text = format!("{name}: {singular}, {cusps}, {verdict}\n");
    if let Some(reason) = changes.reason {
        text.push_str(&format!("  {}\n", reason.describe()));
    }
    for [first, second] in &changes.places {
        let place = format!("  cusp at {first:.9}, {second:.9}");
        text.push_str(&format!("{place} ({})\n", changes.coordinates));
    }
    text
}

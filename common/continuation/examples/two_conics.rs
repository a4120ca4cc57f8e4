//! Two conics meet in four points: from equations to endpoints in thirty lines.
//!
//! `cargo run --release -p cognate-continuation --example two_conics`

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::stage::PreparedStage;
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_systems::{formats, polynomial};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = "CONFIG END; INPUT variable_group x, y; function circle, hyperbola;
                circle = x^2 + y^2 - 5; hyperbola = x*y - 2; END;";
    let system = formats::read("two conics", text.as_bytes())?.system;
    let stage = Stage {
        id: StageId(0),
        work: Work::Track,
        homotopy: HomotopyKind::StraightLine {
            parameters: Vec::new(),
        },
        start_points: StartPoints::TotalDegree {
            degrees: polynomial::degrees(&system)?.total,
        },
        settings: Settings::default(),
        seed: 1,
        attempt: 0,
    };
    let prepared = PreparedStage::new(&system, &stage, &|_| None)?;
    for result in prepared.track(0..prepared.items(), 8) {
        let [w, x, y] = result.endpoint.to_double() else {
            unreachable!("two affine variables have three homogeneous coordinates")
        };
        println!(
            "path {}: {:?} after {} steps: x = {:.6}, y = {:.6}",
            result.origin.0,
            result.outcome,
            result.counts.steps,
            x / w,
            y / w
        );
    }
    Ok(())
}

//! File settings: what the settings in a problem's file mean for a submission.

use crate::submission::SettingsChoice;
use cognate_continuation::tracker::settings::Settings;
use cognate_numeric::precision::rungs;
use cognate_systems::formats::{FileSettings, PrecisionHint};
use cognate_systems::polynomial::has_exact_constants;
use cognate_systems::system::System;

/// The most bits that may be asked for.
pub const MOST_BITS: u32 = 65_536;

/// Precision in bits of the first arithmetic with at least `bits` bits: doubles, double-doubles, or exactly `bits`.
pub fn arithmetic(bits: u32) -> u32 {
    let mut rungs = rungs(bits.min(MOST_BITS), 0);
    rungs.next().expect("there is a first rung")
}

/// Warning about a file that asks for more bits than the largest precision.
pub fn precision_warning(file: &FileSettings) -> Option<String> {
    match file.precision {
        Some(PrecisionHint::Bits(bits)) if bits > MOST_BITS => Some(format!(
            "the file asks for {bits} bits; paths are tracked with {MOST_BITS} at most"
        )),
        _ => None,
    }
}

/// Warning about settings of a file that are known but not followed, because the defaults are stricter.
pub fn stricter_warning(file: &FileSettings, base: &Settings) -> Option<String> {
    let tolerances = [
        ("TrackTolBeforeEG", file.tracking_tolerance, base.tolerance),
        (
            "TrackTolDuringEG",
            file.endgame_tolerance,
            base.endgame_tolerance,
        ),
        ("FinalTol", file.final_tolerance, base.endgame_tolerance),
    ];
    let looser = tolerances.into_iter().filter_map(|(name, asked, ours)| {
        let asked = asked.filter(|asked| *asked > ours)?;
        Some(format!("{name} {asked:e} (here {ours:e})"))
    });
    let doubles = (file.precision == Some(PrecisionHint::Double))
        .then(|| "MPType 0 (here paths that need more digits get them)".to_owned());
    let stricter: Vec<String> = looser.chain(doubles).collect();
    match stricter.is_empty() {
        true => None,
        false => Some(format!(
            "settings of the file that would be less strict than ours are not followed: {}",
            stricter.join(", ")
        )),
    }
}

/// Settings of a solve that follow from the settings of a file. The defaults are tighter than most files, and looser
/// tolerances would only lose paths: a tolerance of the file is taken only if it is smaller. Numbers are exact if the
/// file has no rounded decimal, no fraction that is a double, and no parameter.
pub fn of_file(file: &FileSettings, system: &System, base: &Settings) -> SettingsChoice {
    let smaller = |asked: Option<f64>, ours: f64| asked.filter(|&a| (1e-300..ours).contains(&a));
    let asked_bits = match file.precision {
        Some(PrecisionHint::Bits(bits)) => Some(arithmetic(bits)),
        _ => None,
    };
    SettingsChoice {
        tolerance: smaller(file.tracking_tolerance, base.tolerance),
        endgame_tolerance: smaller(
            file.final_tolerance.or(file.endgame_tolerance),
            base.endgame_tolerance,
        ),
        data_accuracy: Some(file.data_accuracy),
        exact_data: Some(
            file.data_accuracy == 0.0
                && system.parameters.is_empty()
                && has_exact_constants(&system.expressions),
        ),
        max_steps: file
            .maximum_steps
            .filter(|&steps| steps > 0)
            .map(|steps| u32::try_from(steps).unwrap_or(u32::MAX).min(1_000_000_000)),
        precision_bits: asked_bits,
        max_precision_bits: asked_bits.map(|bits| bits.max(base.max_precision_bits)),
        ..SettingsChoice::default()
    }
}

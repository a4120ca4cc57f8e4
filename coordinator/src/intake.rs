//! Intake: from what a client sent to a system and options that can be planned.
//!
//! The result is resolved: the file's settings are merged, every setting and
//! the seed are named, start solutions are an object.

use crate::api::visible::visible;
use crate::coordinator::NewProblem;
use crate::exact_values;
use cognate_continuation::start_points::StoredPoints;
use cognate_numeric::precision::DOUBLE;
use cognate_protocol::error::ProtocolError;
use cognate_protocol::file_settings::{
    MOST_BITS, arithmetic, of_file, precision_warning, stricter_warning,
};
use cognate_protocol::option_misfit::OptionMisfit;
use cognate_protocol::submission::{
    Options, PrecisionChoice, SettingsChoice, Source, StartSolutions, Submission,
};
use cognate_protocol::{digest, from_proto, to_proto};
use cognate_systems::formats::{self, DECOMPOSES, FileSettings, FormatError};
use cognate_systems::system::System;

/// Why a submission is not taken.
#[derive(Debug, thiserror::Error)]
pub enum IntakeError {
    /// The system is none that a message can carry.
    #[error(transparent)]
    Message(#[from] ProtocolError),
    /// A file that was sent is malformed.
    #[error(transparent)]
    File(#[from] FormatError),
    /// Options do not go with each other.
    #[error(transparent)]
    Options(#[from] OptionMisfit),
    /// The content of a field does not go with the rest of the problem.
    #[error("{field}: {what}")]
    Field {
        /// The field, as a path from the problem.
        field: &'static str,
        /// Description of the fault in the field.
        what: String,
    },
    /// The problem needs a later version.
    #[error("not in this version: {0}")]
    NotInThisVersion(String),
}

impl IntakeError {
    /// The field of the request that is at fault, as a path from the outermost message; `None` where it is not
    /// one field.
    pub fn field(&self) -> Option<String> {
        match self {
            Self::Message(error) => Some(error.field().to_owned()),
            Self::File(_) => Some("problem.text".to_owned()),
            Self::Options(misfit) => Some(format!("problem.options.{}", misfit.field())),
            Self::Field { field, .. } => Some(format!("problem.{field}")),
            Self::NotInThisVersion(_) => None,
        }
    }
}

/// Checks and resolves a submission.
pub fn take(submission: Submission) -> Result<NewProblem, IntakeError> {
    let Submission {
        source,
        mut options,
    } = submission;
    let mut warnings = std::mem::take(&mut options.warnings);
    let mut file = FileSettings::default();
    let mut system = match source {
        Source::System(system) => *system,
        Source::Text { name, content } => {
            let problem = formats::read(&name, &content)?;
            warnings.extend(problem.warnings.iter().map(ToString::to_string));
            file = problem.settings;
            check_run(&file, &options)?;
            if let Some(objective) = &problem.objective {
                let name = objective.goal.name();
                let message = format!("`{name}` in a submitted file; `cognate solve` answers it");
                return Err(IntakeError::NotInThisVersion(message));
            }
            if !problem.conditions.is_empty() {
                warnings.push(
                    "the conditions of the file are not followed: `cognate results JOB --where CONDITION` selects solutions \
                     of a job"
                        .to_owned(),
                );
            }
            if options.name.is_empty() {
                options.name = name;
            }
            problem.system
        }
    };
    options.name = visible(&options.name);
    if let Some(groups) = options.groups.take() {
        let groups: Vec<String> = groups.iter().map(|names| names.join(",")).collect();
        formats::options::groups(&groups.join(";"), &mut system)?;
    }
    if !options.conjugates.is_empty() {
        let pairs = std::mem::take(&mut options.conjugates);
        let pairs: Vec<String> = pairs.iter().map(|(p, q)| format!("{p}~{q}")).collect();
        formats::options::conjugates(&pairs.join(","), &mut system)?;
    }
    // A system that workers will get is checked by the rules of messages, so that a fault is reported here.
    let mut system = from_proto::problem::system(&to_proto::problem::system(&system))
        .map_err(|e| e.within("system"))?;
    check_options(&options)?;
    warnings.extend(precision_warning(&file));
    if options.start_parameters.is_empty()
        && options.target_parameters.is_empty()
        && let Some((values, warning)) = file.random_parameters(&system, options.seed)
    {
        options.target_parameters.push(values);
        warnings.push(warning);
    }
    exact_values::put_into(&mut system, &mut options);
    let fixed = match options.precision {
        PrecisionChoice::Adaptive => None,
        PrecisionChoice::Double => Some(DOUBLE),
        PrecisionChoice::Bits(bits) => Some(arithmetic(bits)),
    };
    if fixed.is_some() {
        options.settings.precision_bits = fixed;
        options.settings.max_precision_bits = fixed;
    }
    let base = options.settings.preset.unwrap_or_default().settings();
    warnings.extend(stricter_warning(&file, &base));
    options.settings = SettingsChoice::all(
        &options
            .settings
            .over(of_file(&file, &system, &base).over(base.clone())),
    );
    options.seed = options.seed.or(file.seed).or_else(|| {
        // 32 bits: people copy it, and every JSON reader keeps it whole.
        let head = digest::of_system(&system).0.first_chunk::<4>().copied();
        head.map(|head| u64::from(u32::from_le_bytes(head)))
    });
    let start_solutions = match options.start_solutions.take() {
        Some(StartSolutions::Points(points)) => {
            check_points(&points, &system)?;
            let bytes = points.to_bytes();
            options.start_solutions = Some(StartSolutions::Object(digest::of_bytes(&bytes)));
            Some(bytes.into())
        }
        other => {
            options.start_solutions = other;
            None
        }
    };
    Ok(NewProblem {
        system,
        options,
        start_solutions,
        warnings,
    })
}

/// Whether the file asks for what the submission asks for.
fn check_run(file: &FileSettings, options: &Options) -> Result<(), IntakeError> {
    match &file.other_run {
        Some(other) if options.decompose.is_none() || !DECOMPOSES.contains(&other.track_type) => {
            Err(other.refusal.clone().into())
        }
        _ => Ok(()),
    }
}

/// Checks that the options fit together; the planner checks the rest.
fn check_options(options: &Options) -> Result<(), IntakeError> {
    if let PrecisionChoice::Bits(bits) = options.precision
        && bits > MOST_BITS
    {
        return Err(IntakeError::NotInThisVersion(format!(
            "precision of {bits} bits; paths are tracked with {MOST_BITS} at most"
        )));
    }
    Ok(options.check()?)
}

/// Start solutions have a coordinate for each variable.
fn check_points(points: &StoredPoints, system: &System) -> Result<(), IntakeError> {
    let wrong = |what: String| IntakeError::Field {
        field: "options.start_solutions",
        what,
    };
    if points.is_empty() {
        return Err(wrong("there is no point".to_owned()));
    }
    if points.dimension != system.variables.len() {
        return Err(wrong(format!(
            "points of {} coordinates for {} variables",
            points.dimension,
            system.variables.len()
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::tracker::settings::{Preset, Settings};
    use cognate_protocol::submission::StartKind;

    fn text(content: &str, options: Options) -> Result<NewProblem, IntakeError> {
        take(Submission {
            source: Source::Text {
                name: "a.txt".to_owned(),
                content: content.as_bytes().to_vec(),
            },
            options,
        })
    }

    const CIRCLES: &str = "CONFIG MaxNumberSteps: 77; FinalTol: 1e-11; TrackTolBeforeEG: 1e-4; END;
        INPUT variable_group x, y; function f, g; f = x^2 + y^2 - 2; g = x*y - 1; END;";

    #[test]
    fn a_text_becomes_a_job_with_everything_resolved() {
        let intake = text(CIRCLES, Options::default()).unwrap();
        let settings = intake.options.settings.complete().unwrap();
        let expected = Settings {
            max_steps: 77,
            endgame_tolerance: 1e-11,
            exact_data: true,
            ..Settings::default()
        };
        assert_eq!(settings, expected);
        assert_eq!(intake.options.name, "a.txt");
        assert_eq!(text(CIRCLES, Options::default()).unwrap(), intake);
    }

    #[test]
    fn what_a_client_says_goes_before_what_the_file_says() {
        let options = Options {
            seed: Some(5),
            groups: Some(vec![vec!["x".to_owned()], vec!["y".to_owned()]]),
            conjugates: vec![("x".to_owned(), "y".to_owned())],
            settings: SettingsChoice {
                preset: Some(Preset::Fast),
                max_steps: Some(88),
                ..SettingsChoice::default()
            },
            ..Options::default()
        };
        let intake = text(CIRCLES, options).unwrap();
        let settings = intake.options.settings.complete().unwrap();
        assert_eq!(settings.max_steps, 88);
        assert_eq!(
            settings.predictor_tolerance,
            Preset::Fast.settings().predictor_tolerance
        );
        assert_eq!(intake.options.seed, Some(5));
        assert_eq!(intake.system.groups.len(), 2);
        assert_eq!(intake.system.conjugates, [(0, 1)]);
        let plain = text(CIRCLES, Options::default()).unwrap();
        assert_ne!(intake.options.seed, plain.options.seed);
    }

    #[test]
    fn a_family_to_be_solved_from_nothing_gets_random_parameters() {
        let family = "CONFIG ParameterHomotopy: 1; OdePredictor: 5; END; INPUT variable_group x;
            parameter p, q; function f; f = x^2 + p*x + q; END;";
        let intake = text(family, Options::default()).unwrap();
        let [values] = intake.options.target_parameters.as_slice() else {
            panic!("{:?}", intake.options.target_parameters);
        };
        assert!(values.iter().all(|z| (z.norm_sqr() - 1.0).abs() < 1e-14));
        assert_eq!(intake.warnings.len(), 2);
        assert!(intake.warnings[0].contains("OdePredictor"));
        let named = format!("q = [{:?}, {:?}]", values[1].re, values[1].im);
        assert!(
            intake.warnings[1].ends_with(&named),
            "{}",
            intake.warnings[1]
        );
        let given = Options {
            target_parameters: vec![vec![num_complex::Complex64::ONE; 2]],
            warnings: vec!["from the client".to_owned()],
            ..Options::default()
        };
        let intake = text(family, given).unwrap();
        // Short values become numbers of the equations.
        assert!(intake.system.parameters.is_empty());
        assert!(intake.options.target_parameters.is_empty());
        assert_eq!(intake.warnings[0], "from the client");
        assert!(intake.options.warnings.is_empty(), "they are the job's");
    }

    #[test]
    fn what_cannot_be_is_said_with_its_place() {
        let said = |content: &str, options: Options| {
            let error = text(content, options).expect_err("this is no job");
            let message = error.to_string();
            (error, message)
        };
        let (error, message) = said("variable_group x; function f; f = (x;", Options::default());
        assert_eq!(error.field().as_deref(), Some("problem.text"));
        assert!(message.starts_with("a.txt:"), "{message}");
        let (_, message) = said("", Options::default());
        assert!(message.starts_with("a.txt:"), "{message}");
        let options = Options {
            start: StartKind::Given,
            ..Options::default()
        };
        let (_, message) = said(CIRCLES, options);
        assert!(message.contains("needs start solutions"), "{message}");
        let options = Options {
            precision: PrecisionChoice::Bits(MOST_BITS + 1),
            ..Options::default()
        };
        let (error, message) = said(CIRCLES, options);
        assert!(
            matches!(error, IntakeError::NotInThisVersion(_)),
            "{error:?}"
        );
        assert!(message.starts_with("not in this version"), "{message}");
        let options = Options {
            groups: Some(vec![vec!["x".to_owned(), "z".to_owned()]]),
            ..Options::default()
        };
        let (_, message) = said(CIRCLES, options);
        assert!(message.contains('z'), "{message}");
        let points = StoredPoints {
            dimension: 3,
            coordinates: vec![num_complex::Complex64::ONE; 3],
        };
        let options = Options {
            start_solutions: Some(StartSolutions::Points(points)),
            ..Options::default()
        };
        let (_, message) = said(CIRCLES, options);
        assert!(
            message.contains("3 coordinates for 2 variables"),
            "{message}"
        );
    }
}

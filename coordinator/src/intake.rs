//! Intake: from what a client sent to the objects that a job is made of.
//!
//! A job's problem is the canonical encoding of its checked system, so that the
//! object's digest is the problem's digest. Its options are the message of
//! `problem.proto`, resolved: every setting and the seed are named, start
//! solutions are an object. `read_problem` and `read_options` are the way back.

use crate::api::error::ApiError;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_protocol::submission::{
    Options, PrecisionChoice, SettingsChoice, Source, StartKind, StartSolutions, Submission,
};
use cognate_protocol::{digest, from_proto, to_proto, v1};
use cognate_systems::formats::{self, FileSettings, PrecisionHint};
use cognate_systems::system::System;
use prost::Message;

/// A submission that can become a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Intake {
    /// The system, with the groups and conjugates of the options.
    pub system: System,
    /// Digest of `problem`.
    pub digest: Digest,
    /// The system as an object.
    pub problem: Vec<u8>,
    /// The options, resolved.
    pub options: Options,
    /// Start solutions that were sent along, as an object.
    pub start_solutions: Option<Vec<u8>>,
    /// What is not followed.
    pub warnings: Vec<String>,
}

/// Checks and resolves a submission.
pub fn take(submission: Submission) -> Result<Intake, ApiError> {
    let Submission {
        source,
        mut options,
    } = submission;
    let mut warnings = Vec::new();
    let mut file = FileSettings::default();
    let mut system = match source {
        Source::System(system) => *system,
        Source::Text { name, content } => {
            let problem = formats::read(&name, &content)?;
            warnings.extend(problem.warnings.iter().map(ToString::to_string));
            file = problem.settings;
            if options.name.is_empty() {
                options.name = name;
            }
            problem.system
        }
    };
    if let Some(groups) = options.groups.take() {
        let groups: Vec<String> = groups.iter().map(|names| names.join(",")).collect();
        formats::options::groups(&groups.join(";"), &mut system)?;
    }
    if !options.conjugates.is_empty() {
        let pairs = std::mem::take(&mut options.conjugates);
        let pairs: Vec<String> = pairs.iter().map(|(p, q)| format!("{p}~{q}")).collect();
        formats::options::conjugates(&pairs.join(","), &mut system)?;
    }
    // What goes to workers is checked by the rules of messages: here is the place to fail.
    let system = from_proto::problem::system(&to_proto::problem::system(&system))
        .map_err(|e| e.within("system"))?;
    let problem = digest::encode_system(&system);
    let digest = digest::of_bytes(&problem);
    check_options(&options, &system)?;
    if let Some(PrecisionHint::Bits(bits)) = file.precision {
        warnings.push(format!(
            "the file asks for {bits} bits; this version computes in double precision"
        ));
    }
    let base = options.settings.preset.unwrap_or_default().settings();
    options.settings = SettingsChoice::all(
        &options
            .settings
            .over(of_file(&file, &base).over(base.clone())),
    );
    options.seed = options.seed.or(file.seed).or_else(|| {
        let head = digest.0.first_chunk::<8>();
        head.copied().map(u64::from_le_bytes)
    });
    let start_solutions = match options.start_solutions.take() {
        Some(StartSolutions::Points(points)) => {
            check_points(&points, &system)?;
            let bytes = points.to_bytes();
            options.start_solutions = Some(StartSolutions::Object(digest::of_bytes(&bytes)));
            Some(bytes)
        }
        other => {
            options.start_solutions = other;
            None
        }
    };
    Ok(Intake {
        system,
        digest,
        problem,
        options,
        start_solutions,
        warnings,
    })
}

/// What a file's settings mean here. Ours are tighter than what most files say, and looser ones
/// would only lose paths: tolerances are taken where they are smaller.
fn of_file(
    file: &FileSettings,
    base: &cognate_continuation::tracker::settings::Settings,
) -> SettingsChoice {
    let smaller = |asked: Option<f64>, ours: f64| asked.filter(|&a| (1e-300..ours).contains(&a));
    SettingsChoice {
        tolerance: smaller(file.tracking_tolerance, base.tolerance),
        endgame_tolerance: smaller(
            file.final_tolerance.or(file.endgame_tolerance),
            base.endgame_tolerance,
        ),
        max_steps: file
            .maximum_steps
            .filter(|&steps| steps > 0)
            .map(|steps| u32::try_from(steps).unwrap_or(u32::MAX).min(1_000_000_000)),
        ..SettingsChoice::default()
    }
}

/// What fits together.
fn check_options(options: &Options, system: &System) -> Result<(), ApiError> {
    if let PrecisionChoice::Bits(bits) = options.precision
        && bits > 53
    {
        return Err(ApiError::NotInThisVersion(format!(
            "precision of {bits} bits; this version computes in double precision"
        )));
    }
    let parameters = system.parameters.len();
    let values = |field: &str, found: usize| {
        if found == parameters {
            return Ok(());
        }
        Err(ApiError::Problem(format!(
            "{field}: {found} values for the {parameters} parameters of the system"
        )))
    };
    if !options.start_parameters.is_empty() {
        values("options.start_parameters", options.start_parameters.len())?;
    }
    for target in options.target_parameters.iter().take(1) {
        values("options.target_parameters[0]", target.len())?;
    }
    match (options.start, &options.start_solutions) {
        (StartKind::Given, None) => Err(ApiError::Problem(
            "options.start_solutions: start kind \"given\" needs start solutions".to_owned(),
        )),
        (StartKind::TotalDegree | StartKind::Multihomogeneous, Some(_)) => Err(ApiError::Problem(
            "options.start_solutions: they go with start kind \"given\" or \"auto\" only"
                .to_owned(),
        )),
        _ => Ok(()),
    }
}

/// Start solutions have a coordinate for each variable.
pub fn check_points(points: &StoredPoints, system: &System) -> Result<(), ApiError> {
    if points.is_empty() {
        return Err(ApiError::Problem(
            "options.start_solutions: there is no point".to_owned(),
        ));
    }
    if points.dimension != system.variables.len() {
        return Err(ApiError::Problem(format!(
            "options.start_solutions: points of {} coordinates for {} variables",
            points.dimension,
            system.variables.len()
        )));
    }
    Ok(())
}

/// The system of a job, from its object.
pub fn read_problem(object: Digest, bytes: &[u8]) -> Result<System, ApiError> {
    digest::decode_system(bytes).map_err(|e| ApiError::Damaged {
        object,
        what: e.to_string(),
    })
}

/// Options as the ledger keeps them.
pub fn write_options(options: &Options) -> Vec<u8> {
    to_proto::problem::options(options).encode_to_vec()
}

/// Options as the ledger kept them.
pub fn read_options(bytes: &[u8]) -> Result<Options, ApiError> {
    let damaged = |what: String| ApiError::Damaged {
        object: digest::of_bytes(bytes),
        what,
    };
    let message = v1::Options::decode(bytes).map_err(|e| damaged(e.to_string()))?;
    from_proto::problem::options(message).map_err(|e| damaged(e.to_string()))
}

/// A stage as an object: the message of `path.proto`.
pub fn write_stage(stage: &cognate_continuation::work::Stage) -> Vec<u8> {
    to_proto::path::stage(stage).encode_to_vec()
}

/// A stage from its object.
pub fn read_stage(
    object: Digest,
    bytes: &[u8],
) -> Result<cognate_continuation::work::Stage, ApiError> {
    let damaged = |what: String| ApiError::Damaged { object, what };
    let message = v1::Stage::decode(bytes).map_err(|e| damaged(e.to_string()))?;
    from_proto::path::stage(&message).map_err(|e| damaged(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::tracker::settings::{Preset, Settings};

    fn text(content: &str, options: Options) -> Result<Intake, ApiError> {
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
            ..Settings::default()
        };
        assert_eq!(settings, expected);
        assert_eq!(intake.options.name, "a.txt");
        assert_eq!(text(CIRCLES, Options::default()).unwrap(), intake);
        let bytes = write_options(&intake.options);
        assert_eq!(read_options(&bytes).unwrap(), intake.options);
        let system = read_problem(intake.digest, &intake.problem).unwrap();
        assert_eq!(system, intake.system);
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
        assert_ne!(intake.digest, plain.digest);
    }

    #[test]
    fn what_cannot_be_is_said_with_its_place() {
        let said = |content: &str, options: Options| {
            let error = text(content, options).expect_err("this is no job");
            (error.code(), error.to_string())
        };
        let (code, message) = said("variable_group x; function f; f = (x;", Options::default());
        assert_eq!(code, tonic::Code::InvalidArgument);
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
            precision: PrecisionChoice::Bits(200),
            ..Options::default()
        };
        let (code, message) = said(CIRCLES, options);
        assert_eq!(code, tonic::Code::Unimplemented);
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

//! A result is pure: not a function of width, neighbours, chunk or instruction set, and the same bits on
//! every day. Every kind of work and every homotopy passes the suite of `subject.rs` by one line here,
//! and has a golden hash, which notices a change of compiler or of the order of operations.

use crate::subject::Subject;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::monodromy::LoopLimits;
use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::plan::{ClosingOptions, KnownSolutions, MonodromyOptions, TrackingOptions};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::Work;
use cognate_numeric::NUMERICS_REVISION;
use cognate_systems::formats;
use cognate_systems::system::System;
use cognate_tests::builders::{example, katsura};
use cognate_tests::systems::written;
use num_complex::Complex64;
use std::path::Path;

/// A line for each subject: its name, the kind that it is of, and the subject. The suite is run on each;
/// where a kind has no line, this does not compile.
macro_rules! conformance {
    ($of:ident, $kind_of:expr, $kinds:ty: $($name:ident, $kind:pat, $make:expr;)+) => {
        mod $of {
            use super::*;

            $(
                #[test]
                fn $name() {
                    let subject = $make;
                    let kind: $kinds = $kind_of(&subject);
                    assert!(matches!(kind, $kind), "it is of {kind:?}");
                    subject.check_purity();
                }
            )+

            #[allow(unreachable_patterns, reason = "a kind may have several lines")]
            const _EVERY_KIND_HAS_A_LINE: fn(&$kinds) = |kind| match kind {
                $($kind => {})+
            };

            pub fn subjects() -> Vec<(&'static str, Subject)> {
                vec![$((stringify!($name), $make)),+]
            }
        }
    };
}

macro_rules! work_conformance {
    ($($lines:tt)+) => {
        conformance! { work, |subject: &Subject| subject.stage.work, Work: $($lines)+ }
    };
}

macro_rules! homotopy_conformance {
    ($($lines:tt)+) => {
        conformance! {
            homotopies, |subject: &Subject| subject.stage.homotopy.clone(), HomotopyKind: $($lines)+
        }
    };
}

work_conformance! {
    // Paths: regular ends, several groups, ends at infinity, singular ends, generic systems.
    katsura_6, Work::Track, first(SolveMethod::Auto, &katsura(6));
    three_rpr, Work::Track, first(SolveMethod::Auto, &example("three_rpr.bertini"));
    stewart_gough, Work::Track,
        first(SolveMethod::Auto, &example("stewart_gough_dietmaier.bertini"));
    cyclic_5, Work::Track, first(SolveMethod::TotalDegree, &example("cyclic_5.bertini"));
    double_root, Work::Track, Subject::of(&double_root_system(), SolveOptions::default(), &|_| true);
    cyclic_5_polyhedral, Work::Track,
        first(SolveMethod::Polyhedral, &example("cyclic_5.bertini"));
    // As paths are tracked first: without endgames, then with those for which doubles suffice.
    no_endgames_cyclic_5, Work::Track,
        first(SolveMethod::TotalDegree, &example("cyclic_5.bertini")).with_endgame_bits(0);
    endgames_in_doubles_cyclic_5, Work::Track,
        first(SolveMethod::TotalDegree, &example("cyclic_5.bertini")).with_endgame_bits(53);
    // As every path is tracked again that met another: by Taylor series, then with more digits.
    robust_cyclic_5, Work::Track, robust(1, &example("cyclic_5.bertini"));
    robust_stewart_gough, Work::Track, robust(1, &example("stewart_gough_dietmaier.bertini"));
    robust_twice_cyclic_5, Work::Track, robust(2, &example("cyclic_5.bertini"));
    certify, Work::Certify, closing(
        &example("three_rpr.bertini"),
        SolveOptions { closings: ClosingOptions { certify: true, ..ClosingOptions::default() }, ..SolveOptions::default() },
    );
    certify_close_pairs, Work::Certify, closing(
        CLOSE_PAIRS,
        SolveOptions { closings: ClosingOptions { certify: true, ..ClosingOptions::default() }, ..SolveOptions::default() },
    );
    sharpen, Work::Sharpen { .. }, closing(
        &example("three_rpr.bertini"),
        SolveOptions { closings: ClosingOptions { digits: Some(60), ..ClosingOptions::default() }, ..SolveOptions::default() },
    );
    deflate, Work::Sharpen { .. }, closing(
        DEFLATED,
        SolveOptions { closings: ClosingOptions { digits: Some(40), deflate: true, ..ClosingOptions::default() }, ..SolveOptions::default() },
    );
    local_dimension, Work::LocalDimension, Subject::of(
        &written(CURVE_AND_POINTS),
        SolveOptions { method: SolveMethod::TotalDegree, ..SolveOptions::default() },
        &|stage| stage.work == Work::LocalDimension,
    );
    count_mixed_cells, Work::CountMixedCells, Subject::of(
        &read(&example("cyclic_5.bertini")),
        SolveOptions { method: SolveMethod::Polyhedral, counting_operations: 10, ..SolveOptions::default() },
        &|stage| stage.work == Work::CountMixedCells,
    );
    // A set that is regular, and one that is deflated.
    bend, Work::Bend, Subject::of_decomposition(
        &written("variable_group x, y, z; function f, g; f = y - x^2; g = z - x*y;"),
        &|stage| stage.work == Work::Bend,
    );
    bend_deflated, Work::Bend, Subject::of_decomposition(
        &written("variable_group x, y; function f; f = (x^2*y - x - y^2 + 2)^2;"),
        &|stage| stage.work == Work::Bend,
    );
}

homotopy_conformance! {
    straight_line, HomotopyKind::StraightLine { .. },
        of_kind(&katsura(5), SolveMethod::TotalDegree, |h| {
            matches!(h, HomotopyKind::StraightLine { .. })
        });
    parameter, HomotopyKind::Parameter { .. }, many_targets();
    path_variable, HomotopyKind::PathVariable { .. }, homotopy_of_the_users_own();
    toric, HomotopyKind::Toric,
        of_kind(&example("cyclic_5.bertini"), SolveMethod::Polyhedral, |h| {
            matches!(h, HomotopyKind::Toric)
        });
    generic, HomotopyKind::Generic { .. },
        of_kind(&example("cyclic_5.bertini"), SolveMethod::Polyhedral, |h| {
            matches!(h, HomotopyKind::Generic { .. })
        });
    slide, HomotopyKind::MoveSlice { .. },
        of_kind(&katsura(4), SolveMethod::Regeneration, |h| {
            matches!(h, HomotopyKind::MoveSlice { level, .. } if *level > 1)
        });
    intersect, HomotopyKind::ProductToEquation { .. },
        of_kind(&katsura(4), SolveMethod::Regeneration, |h| {
            matches!(h, HomotopyKind::ProductToEquation { level, .. } if *level > 1)
        });
    sections, HomotopyKind::Sections { .. }, sections_of_cubics();
}

/// One point of multiplicity 5.
fn double_root_system() -> System {
    written("variable_group x, y;\nfunction f, g;\nf = (x - 1)^2 + y^3;\ng = x*y - y;")
}

/// Pairs of solutions that lie 1e-6 from one another.
const CLOSE_PAIRS: &str = "CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;
    f = (x - 1)*(x - 1.000001);\ng = y^2 - 3*x*y + 1;\nEND;\n";

/// Three double points and simple ones.
const DEFLATED: &str = "CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;
    f = (x - 1)^2*(x + 2*y - 3);\ng = y^3 - x*y + x - 2;\nEND;\n";

/// Ends on the line x = 0 and isolated double points.
const CURVE_AND_POINTS: &str = "variable_group x, y;\nfunction f, g;
    f = x*(x - 1)^2*(y - 2);\ng = x*(y^2 + x - 3)*(x + y);";

/// Nine solutions for generic parameters, in which the system is linear.
const CUBICS: &str =
    "variable_group x, y;\nparameter a0, a1, a2, a3, a4, a5, b0, b1, b2, b3, b4, b5;
    function f, g;\nf = a0*x^3 + a1*x^2*y + a2*y^3 + a3*x*y + a4*y + a5;
    g = b0*x^3 + b1*x*y^2 + b2*y^3 + b3*x^2 + b4*x + b5;";

fn read(text: &str) -> System {
    let problem = formats::read("golden", text.as_bytes());
    problem.expect("a system").system
}

/// The first stage of a solve.
fn first(start: SolveMethod, text: &str) -> Subject {
    let options = SolveOptions {
        method: start,
        ..SolveOptions::default()
    };
    Subject::of(&read(text), options, &|_| true)
}

/// The first stage by total degree, with the settings of this attempt at paths that met.
fn robust(attempt: u16, text: &str) -> Subject {
    let options = SolveOptions {
        method: SolveMethod::TotalDegree,
        tracking: TrackingOptions {
            settings: Settings::default().tightened(attempt).robust(),
            ..TrackingOptions::default()
        },
        ..SolveOptions::default()
    };
    Subject::of(&read(text), options, &|_| true)
}

/// The stage of a solve that certifies or sharpens the solutions.
fn closing(text: &str, options: SolveOptions) -> Subject {
    Subject::of(&read(text), options, &|stage| {
        matches!(stage.work, Work::Certify | Work::Sharpen { .. })
    })
}

/// The first stage of a solve that tracks by such a homotopy.
fn of_kind(text: &str, start: SolveMethod, kind: fn(&HomotopyKind) -> bool) -> Subject {
    let options = SolveOptions {
        method: start,
        ..SolveOptions::default()
    };
    Subject::of(&read(text), options, &|stage| {
        stage.work == Work::Track && kind(&stage.homotopy)
    })
}

fn real(values: &[f64]) -> Vec<Complex64> {
    values.iter().map(|&v| Complex64::new(v, 0.0)).collect()
}

/// At p = 0 both paths end at one point.
fn many_targets() -> Subject {
    let system =
        written("variable_group x, y; parameter p; function f, g; f = x^2 - p; g = y*(x - 3) - 1;");
    let options = SolveOptions {
        method: SolveMethod::Given(KnownSolutions {
            points: None,
            parameters: Some(real(&[4.0])),
        }),
        target_parameters: [5.0, -1.0, 0.0, 1e6, 9.0]
            .iter()
            .map(|&p| real(&[p]))
            .collect(),
        ..SolveOptions::default()
    };
    Subject::from(&system, real(&[2.0, -1.0, -2.0, -0.2]), options, &|_| true)
}

fn homotopy_of_the_users_own() -> Subject {
    let system = written(
        "variable x; pathvariable t; function f; \
         f = (3/5 + 4*I/5)*t*(x^3 - 1) + (1 - t)*(x^3 - 8);",
    );
    let root = Complex64::new(-0.5, 0.75f64.sqrt());
    let start = vec![Complex64::new(1.0, 0.0), root, root.conj()];
    Subject::from(&system, start, SolveOptions::default(), &|_| true)
}

fn sections_of_cubics() -> Subject {
    let options = SolveOptions {
        method: SolveMethod::Monodromy(MonodromyOptions {
            limits: LoopLimits {
                trace_test: true,
                ..LoopLimits::default()
            },
            ..MonodromyOptions::default()
        }),
        ..SolveOptions::default()
    };
    Subject::of(&written(CUBICS), options, &|stage| {
        let sections = matches!(stage.homotopy, HomotopyKind::Sections { .. });
        sections && stage.items().is_some_and(|items| items > 1)
    })
}

#[test]
fn chunks_have_their_golden_hashes() {
    let mut hashes = format!(
        "# Hashes of the first results of a stage, seed 7; `UPDATE_GOLDEN=1 cargo test` rewrites them.\n\
         # A change here is a change of results: NUMERICS_REVISION in numeric/src/lib.rs must grow with it.\n\
         numerics revision {NUMERICS_REVISION}\n"
    );
    for (name, subject) in work::subjects().into_iter().chain(homotopies::subjects()) {
        let (end, hash) = subject.golden();
        hashes += &format!("{name} 0..{end} {hash}\n");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/chunk_hashes.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &hashes).expect("the golden file can be written");
    }
    let expected = std::fs::read_to_string(&path).expect("the golden file is there");
    assert!(hashes == expected, "expected\n{expected}\nfound\n{hashes}");
}

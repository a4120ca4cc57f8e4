//! Every test system is read in both notations, and both say the same.

use crate::support::{Random, system_names, systems, values};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::formats::{self, Format, Problem};
use rug::Integer;
use rug::ops::Pow;

/// A square root of 3 to 60 digits, for the files that have it as `3^(1/2)`.
fn root_of_three() -> String {
    let digits = (Integer::from(3) * Integer::from(10).pow(120))
        .sqrt()
        .to_string();
    format!("{}.{}", &digits[..1], &digits[1..])
}

fn read(system: &str, file: &str) -> Problem {
    let path = systems().join(system).join(file);
    let text = std::fs::read_to_string(&path).expect("a test system");
    let text = text.replace("(3^(1/2))", &root_of_three());
    match formats::read(&path.to_string_lossy(), text.as_bytes()) {
        Ok(problem) => problem,
        Err(e) => panic!("{e}"),
    }
}

fn size(value: &ComplexRational) -> Rational {
    value.re.clone().abs() + value.im.clone().abs()
}

#[test]
fn both_notations_of_every_system_agree() {
    // These have numbers in PHCpack's file that are cut after 40 digits.
    let cut = [
        "griffis_duffy_typei_full",
        "griffis_duffy_typei_slice",
        "six_revolute_manseur_doty_tm8",
        "six_revolute_puma560_tm8",
    ];
    let names = system_names();
    assert_eq!(names.len(), 26);
    let mut inexact = Vec::new();
    for name in &names {
        let bertini = read(name, "system.bertini");
        let phcpack = read(name, "system.phc");
        assert_eq!(
            (bertini.format, phcpack.format),
            (Format::Bertini, Format::Phcpack)
        );
        assert!(
            bertini.warnings.is_empty() && phcpack.warnings.is_empty(),
            "{name}"
        );
        assert_eq!(bertini.system.variables, phcpack.system.variables, "{name}");
        assert_eq!(
            bertini.system.equation_count(),
            phcpack.system.equation_count(),
            "{name}"
        );
        let mut random = Random(17);
        let mut exact = true;
        for _ in 0..3 {
            let point = random.point(bertini.system.variable_count());
            let pairs = values(&bertini.system, &point, &[]).into_iter().zip(values(
                &phcpack.system,
                &point,
                &[],
            ));
            for (i, (a, b)) in pairs.enumerate() {
                exact &= a == b;
                let allowed = (size(&a) + 1) / Rational::from(Integer::from(10).pow(26));
                assert!(
                    size(&a.subtract(&b)) <= allowed,
                    "{name}, equation {}",
                    i + 1
                );
            }
        }
        if !exact {
            inexact.push(name.as_str());
        }
    }
    assert_eq!(inexact, cut);
}

#[test]
fn the_homogeneous_platform_has_the_equations_of_the_affine_one() {
    let name = "stewart_gough_dietmaier";
    let homogeneous = read(name, "system_homogeneous.bertini").system;
    let affine = read(name, "system.bertini").system;
    assert!(homogeneous.groups[0].homogeneous && !affine.groups[0].homogeneous);
    assert_eq!(homogeneous.dimension(), 7);
    let point = Random(5).point(8);
    assert_eq!(
        values(&homogeneous, &point, &[]),
        values(&affine, &point, &[])[..7]
    );
}

//! Which plans are made, and what is refused.

use super::*;
use crate::PathAlgorithm;
use crate::start_costs::StartCosts;
use cognate_systems::polynomial::PolynomialError;

fn system(text: &str) -> System {
    match cognate_systems::formats::read("test", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

fn bertini(input: &str) -> System {
    system(&format!("CONFIG\nEND;\nINPUT\n{input}\nEND;\n"))
}

/// Two bilinear equations in two groups: 4 paths by total degree, 2 by the groups.
fn bilinear() -> System {
    bertini("variable_group x; variable_group y; function f, g; f = x*y - 1; g = x*y + x - y;")
}

fn with_parameter() -> System {
    bertini("variable_group x; parameter p; function f; f = x^3 - p;")
}

fn given(dimension: usize, parameters: Option<Vec<Complex64>>) -> SolveOptions {
    let points = Some(GivenStart {
        object: cognate_continuation::start_points::Digest([1; 32]),
        count: 3,
        dimension,
    });
    with_method(SolveMethod::Given(KnownSolutions { points, parameters }))
}

fn number(re: f64) -> Vec<Complex64> {
    vec![Complex64::new(re, 0.0)]
}

fn refusal(system: &System, options: &SolveOptions) -> PlanError {
    match plan(system, options) {
        Err(error) => error,
        Ok(plan) => panic!("there should be no plan: {plan:?}"),
    }
}

fn with_method(method: SolveMethod) -> SolveOptions {
    SolveOptions {
        method,
        ..SolveOptions::default()
    }
}

#[test]
fn the_start_with_fewest_paths_is_chosen() {
    let chosen = plan(&bilinear(), &SolveOptions::default()).unwrap();
    assert_eq!(
        (chosen.start, chosen.paths),
        (StartKind::Multihomogeneous, Some(2))
    );
    assert_eq!(chosen.system.groups.len(), 2);
    let total = plan(&bilinear(), &with_method(SolveMethod::TotalDegree)).unwrap();
    assert_eq!(
        (total.start, total.paths),
        (StartKind::TotalDegree, Some(4))
    );
    assert_eq!(total.system.groups.len(), 1, "groups are merged");
    assert_eq!(total.algorithm.progress().stages, []);
    let tie =
        bertini("variable_group x; variable_group y; function f, g; f = x - 5*y; g = y^2 - 3;");
    let chosen = plan(&tie, &SolveOptions::default()).unwrap();
    assert_eq!(
        (chosen.start, chosen.paths),
        (StartKind::Multihomogeneous, Some(2))
    );
    let one = bertini("variable_group x, y; function f, g; f = x*y - 1; g = x^3 + y;");
    let chosen = plan(&one, &SolveOptions::default()).unwrap();
    assert_eq!(
        (chosen.start, chosen.paths),
        (StartKind::Multihomogeneous, Some(4))
    );
    assert_eq!(chosen.system.groups.len(), 2, "groups were found");
    let dense = bertini("variable_group x, y; function f, g; f = x^2 + y^2 - 1; g = x^3 + y^3;");
    let chosen = plan(&dense, &SolveOptions::default()).unwrap();
    assert_eq!(
        (chosen.start, chosen.paths),
        (StartKind::TotalDegree, Some(6))
    );
}

#[test]
fn costs_are_as_the_contract_has_them() {
    let costs = StartCosts::of(&bilinear()).unwrap();
    assert_eq!(
        serde_json::to_string(&costs).unwrap(),
        "{\"variables\":2,\"equations\":2,\"degrees\":[2,2],\"total_degree\":4,\
         \"multihomogeneous\":{\"groups\":[[\"x\"],[\"y\"]],\"number\":2},\
         \"linear_product\":2,\"mixed_volume\":2,\"choice\":\"multihomogeneous\",\
         \"why\":\"2 paths by the variable groups, 4 by total degree\",\
         \"notes\":{\"linear_product\":\"the sets 2 times {x} {y}\"}}"
    );
    let more = bertini("variable_group x; function f, g; f = x - 1; g = x^2 - 1;");
    let costs = StartCosts::of(&more).unwrap();
    let cost = (costs.choice, costs.total_degree);
    assert_eq!(cost, (Some(StartKind::OneUnknown), Some(2)));
    assert!(costs.why.starts_with("one unknown"), "{}", costs.why);
    assert_eq!(costs.degrees, [1, 2], "as they are given");
    let fewer = bertini("variable_group x, y, z; function f; f = x*y - z;");
    let costs = StartCosts::of(&fewer).unwrap();
    assert_eq!((costs.choice, costs.total_degree), (None, None));
    assert!(costs.why.contains("Add 2 equations"), "{}", costs.why);
}

#[test]
fn homogeneous_groups_lose_one_unknown() {
    let conics = "function f, g; f = x^2 + y^2 - z^2; g = x*y - z^2;";
    let projective = bertini(&format!("hom_variable_group x, y, z; {conics}"));
    assert_eq!(
        plan(&projective, &SolveOptions::default()).unwrap().paths,
        Some(4)
    );
    let affine = bertini(&format!("variable_group x, y, z; {conics}"));
    assert!(matches!(
        refusal(&affine, &SolveOptions::default()),
        PlanError::FewerEquations {
            equations: 2,
            unknowns: 3
        }
    ));
    let skew = bertini("hom_variable_group x, y; function f; f = x^2 - y;");
    assert!(matches!(
        refusal(&skew, &SolveOptions::default()),
        PlanError::Polynomial(PolynomialError::NotHomogeneous { .. })
    ));
    let mixed = bertini(
        "hom_variable_group x, y; variable_group z; function f, g; f = x*z - y; g = x + y*z;",
    );
    assert_eq!(
        plan(&mixed, &SolveOptions::default()).unwrap().start,
        StartKind::Multihomogeneous
    );
    assert_eq!(
        refusal(&mixed, &with_method(SolveMethod::TotalDegree)),
        PlanError::TotalDegreeNeedsOneGroup
    );
}

#[test]
fn what_is_too_large_is_named() {
    let large = bertini("variable_group x, y; function f, g; f = x^9000 - 1; g = y^9000 - 1;");
    let error = refusal(&large, &SolveOptions::default());
    assert!(error.to_string().contains("81000000 paths"), "{error}");
    assert!(
        error.to_string().starts_with("not in this version"),
        "{error}"
    );
    // Pairs of bilinear equations: 4^13 by total degree, 2^13 by mixed cells.
    let names = |letter: &str| -> Vec<String> {
        let numbers = 0..13;
        numbers.map(|k| format!("{letter}{k}")).collect()
    };
    let mut pairs = format!(
        "variable_group {}, {};",
        names("x").join(", "),
        names("y").join(", ")
    );
    pairs += &format!(
        "function {}, {};",
        names("f").join(", "),
        names("g").join(", ")
    );
    for k in 0..13 {
        pairs += &format!("f{k} = x{k}*y{k} - 1; g{k} = x{k}*y{k} + x{k} - 3*y{k};");
    }
    let error = refusal(&bertini(&pairs), &with_method(SolveMethod::TotalDegree));
    assert!(error.to_string().contains("67108864 paths"), "{error}");
    assert!(
        error.to_string().contains("these starts would do: "),
        "{error}"
    );
    assert!(
        error.to_string().contains("polyhedral with 8192"),
        "{error}"
    );
    let names: Vec<String> = (0..70).map(|k| format!("x{k}")).collect();
    let functions: Vec<String> = (0..70).map(|k| format!("f{k}")).collect();
    let equations: Vec<String> = (0..70).map(|k| format!("f{k} = x{k}^2 - 1;")).collect();
    let huge = bertini(&format!(
        "variable_group {}; function {}; {}",
        names.join(", "),
        functions.join(", "),
        equations.join(" ")
    ));
    let error = refusal(&huge, &SolveOptions::default());
    assert!(error.to_string().contains("2^64 or more"), "{error}");
    let groups: Vec<String> = names
        .iter()
        .map(|n| format!("variable_group {n};"))
        .collect();
    let many = bertini(&format!(
        "{} function {}; {}",
        groups.join(" "),
        functions.join(", "),
        equations.join(" ")
    ));
    assert_eq!(
        refusal(&many, &with_method(SolveMethod::Multihomogeneous)),
        PlanError::TooManyGroups { groups: 70 }
    );
}

#[test]
fn given_sets_are_followed_or_refused() {
    // {x} {x, y} | {x, y}^2: 4 paths, where the groups that are found have 2.
    let system = bilinear();
    let sets = vec![vec![vec![0], vec![0, 1]], vec![vec![0, 1], vec![0, 1]]];
    let with_sets = |sets| with_method(SolveMethod::LinearProduct(Some(sets)));
    let chosen = plan(&system, &with_sets(sets)).unwrap();
    assert_eq!(
        (chosen.start, chosen.paths),
        (StartKind::LinearProduct, Some(4))
    );
    assert!(chosen.why.starts_with("the sets are given"));
    let sets = vec![vec![vec![0], vec![0]], vec![vec![0, 1], vec![1]]];
    let error = refusal(&system, &with_sets(sets.clone())).to_string();
    assert!(error.contains("monomial x*y"), "{error}");
    assert_eq!(
        StartCosts::with_sets(&system, Some(&sets))
            .unwrap_err()
            .to_string(),
        error
    );
}

#[test]
fn groups_that_admit_no_solution_are_refused() {
    // Both equations in x alone: 4 by total degree, 0 by the groups.
    let system =
        bertini("variable_group x; variable_group y; function f, g; f = x^2 - 1; g = x^2 - x;");
    assert_eq!(
        refusal(&system, &with_method(SolveMethod::Multihomogeneous)),
        PlanError::NoPaths
    );
    assert_eq!(
        StartCosts::of(&system).unwrap().multihomogeneous.number,
        Some(0)
    );
}

#[test]
fn parameters_need_values_or_a_solved_start() {
    let system = with_parameter();
    let error = refusal(&system, &SolveOptions::default());
    assert!(error.to_string().contains("(p)"), "{error}");
    let mut options = SolveOptions {
        target_parameters: vec![number(2.0)],
        ..SolveOptions::default()
    };
    assert_eq!(plan(&system, &options).unwrap().paths, Some(3));
    options.target_parameters.push(number(3.0));
    assert_eq!(refusal(&system, &options), PlanError::SeveralTargets(2));
    options.method = given(1, Some(number(1.0))).method;
    let chosen = plan(&system, &options).unwrap();
    assert_eq!((chosen.start, chosen.paths), (StartKind::Given, Some(6)));
    options.target_parameters[1].push(Complex64::new(0.0, 0.0));
    assert!(matches!(
        refusal(&system, &options),
        PlanError::ParameterCount {
            found: 2,
            expected: 1,
            ..
        }
    ));
    options.target_parameters[1] = number(f64::NAN);
    assert!(matches!(
        refusal(&system, &options),
        PlanError::NotFinite { .. }
    ));
}

#[test]
fn given_starts_must_fit() {
    let system = with_parameter();
    assert_eq!(
        refusal(&system, &given(1, None)),
        PlanError::NoStartParameters
    );
    assert_eq!(
        refusal(&system, &given(2, None)),
        PlanError::StartDimension {
            found: 2,
            expected: 1
        }
    );
    assert_eq!(
        refusal(
            &system,
            &with_method(SolveMethod::Given(KnownSolutions::default()))
        ),
        PlanError::NoStartPoints
    );
    assert_eq!(
        refusal(&bilinear(), &given(2, None)),
        PlanError::NothingToDeform
    );
    let alone = KnownSolutions {
        points: None,
        parameters: Some(number(1.0)),
    };
    let loops = MonodromyOptions {
        known: alone,
        ..MonodromyOptions::default()
    };
    assert_eq!(
        refusal(&system, &with_method(SolveMethod::Monodromy(loops))),
        PlanError::StartParametersAlone
    );
}

#[test]
fn a_homotopy_of_the_users_own_starts_where_it_says() {
    let system =
        bertini("variable x; pathvariable t; function f; f = t*(x^2 - 1) + (1 - t)*(x^2 - 4);");
    assert!(system.path_variable.is_some());
    assert_eq!(
        refusal(&system, &SolveOptions::default()),
        PlanError::HomotopyWithoutStart
    );
    let chosen = plan(&system, &given(1, None)).unwrap();
    assert_eq!((chosen.start, chosen.paths), (StartKind::Given, Some(3)));
}

#[test]
fn what_needs_every_endpoint_has_a_lower_limit() {
    // 2^23 paths: more than are held, fewer than are streamed.
    let names: Vec<String> = (0..23).map(|i| format!("x{i}")).collect();
    let squares: Vec<String> = (0..23)
        .map(|i| format!("f{i} = x{i}^2 - {};", i + 2))
        .collect();
    let functions: Vec<String> = (0..23).map(|i| format!("f{i}")).collect();
    let system = bertini(&format!(
        "variable_group {};\nfunction {};\n{}",
        names.join(", "),
        functions.join(", "),
        squares.join("\n")
    ));
    let alone = with_method(SolveMethod::TotalDegree);
    assert_eq!(plan(&system, &alone).unwrap().paths, Some(1 << 23));
    let none = ClosingOptions::default();
    let closings = [
        ClosingOptions {
            certify: true,
            ..none
        },
        ClosingOptions {
            digits: Some(50),
            ..none
        },
        ClosingOptions {
            deflate: true,
            ..none
        },
    ];
    for closings in closings {
        let options = SolveOptions {
            closings,
            ..alone.clone()
        };
        let refused = refusal(&system, &options);
        assert!(
            matches!(refused, PlanError::TooManyPaths { .. }),
            "{refused}"
        );
    }
}

/// Two equations of two and three terms, whose mixed volume is the number of paths by groups, too.
#[test]
fn few_terms_of_high_degree_begin_in_mixed_cells() {
    let text = "variable_group x, y; function f, g; f = 6*y^6 - 20; g = 92 - 33*x^48*y^112 - 63*x^59*y^133;";
    let chosen = plan(&bertini(text), &SolveOptions::default()).unwrap();
    assert_eq!(
        (chosen.start, chosen.paths),
        (StartKind::Polyhedral, Some(354))
    );
}

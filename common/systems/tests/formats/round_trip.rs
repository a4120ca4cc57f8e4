//! A system that is written is read again with the same values, exactly and in double precision.

use crate::support::{Random, rational, read, system_names, systems, values};
use cognate_numeric::rational::ComplexRational;
use cognate_systems::expression::{Dependence, Expressions, Node, NodeId};
use cognate_systems::formats::{self, FileSettings, Format, PrecisionHint, WriteError};
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, System, VariableGroup};
use num_complex::Complex64;

/// A random polynomial graph: later nodes use any earlier ones, so that much is shared.
fn random_system(random: &mut Random, parameters: bool) -> System {
    let mut e = Expressions::new();
    let mut nodes: Vec<NodeId> = (0..3).map(|v| e.variable(v)).collect();
    if parameters {
        nodes.extend((0..2).map(|p| e.parameter(p)));
    }
    // The first nodes contain no variable or are one; denominators come from here.
    let mut degree = vec![1u32; nodes.len()];
    for _ in 0..8 + random.below(40) {
        let (i, j) = (random.below(nodes.len()), random.below(nodes.len()));
        let (a, b) = (nodes[i], nodes[j]);
        let (node, d) = match random.below(10) {
            0 | 1 => (e.add(a, b), degree[i].max(degree[j])),
            2 | 3 => (e.subtract(a, b), degree[i].max(degree[j])),
            4 | 5 => (e.multiply(a, b), degree[i] + degree[j]),
            6 => (e.negate(a), degree[i]),
            7 => {
                let exponent = 2 + random.below(3) as u32;
                (e.power(a, exponent), degree[i] * exponent)
            }
            8 => {
                let constant = e.constant(match random.below(4) {
                    0 => random.complex(),
                    1 => ComplexRational::real(random.below(9) as i64 - 4),
                    2 => ComplexRational::new(0, random.below(5) as i64 - 2),
                    _ => ComplexRational::real(random.complex().re),
                });
                (constant, 0)
            }
            _ if parameters => {
                let denominator = nodes[3 + random.below(2)];
                (e.divide(a, denominator), degree[i])
            }
            _ => (e.add(a, b), degree[i].max(degree[j])),
        };
        // Small degrees keep the exact values small.
        if d <= 24 {
            nodes.push(node);
            degree.push(d);
        }
    }
    let x = nodes[0];
    let mut equations = vec![x];
    for _ in 0..3 {
        let product = e.multiply(nodes[random.below(nodes.len())], x);
        let sum = e.add(product, x);
        if e.dependence(sum) == Dependence::Variables {
            equations.push(sum);
        }
    }
    System {
        equation_names: (1..=equations.len()).map(|i| format!("f{i}")).collect(),
        expressions: e,
        variables: ["x", "x1", "E2"].map(String::from).into(),
        parameters: if parameters {
            vec!["p".into(), "s1".into()]
        } else {
            Vec::new()
        },
        groups: vec![
            VariableGroup {
                variables: vec![2],
                homogeneous: random.below(2) == 0,
            },
            VariableGroup {
                variables: vec![0, 1],
                homogeneous: false,
            },
        ],
        equations,
        ..System::default()
    }
}

/// Values in double precision, node by node.
fn doubles(system: &System, variables: &[Complex64], parameters: &[Complex64]) -> Vec<Complex64> {
    let mut value: Vec<Complex64> = Vec::new();
    for node in system.expressions.nodes() {
        let operand = |n: &NodeId| value[n.0 as usize];
        let result = match node {
            Node::Constant(c) => Complex64::new(c.re.to_f64(), c.im.to_f64()),
            Node::Variable(v) => variables[*v as usize],
            Node::Parameter(p) => parameters[*p as usize],
            Node::Add(a, b) => operand(a) + operand(b),
            Node::Subtract(a, b) => operand(a) - operand(b),
            Node::Multiply(a, b) => operand(a) * operand(b),
            Node::Divide(a, b) => operand(a) / operand(b),
            Node::Negate(a) => -operand(a),
            Node::Power(a, exponent) => {
                (1..*exponent).fold(operand(a), |power, _| power * operand(a))
            }
            Node::Root(..) | Node::Function(..) => Complex64::new(f64::NAN, 0.0),
        };
        value.push(result);
    }
    system
        .equations
        .iter()
        .map(|e| value[e.0 as usize])
        .collect()
}

/// Picks values by name: a file may reorder the names.
fn picked<T: Clone>(names: &[String], system_names: &[String], values: &[T]) -> Vec<T> {
    let place = |n: &String| {
        system_names
            .iter()
            .position(|a| a == n)
            .expect("the same names")
    };
    names.iter().map(|n| values[place(n)].clone()).collect()
}

fn check(system: &System, format: Format, random: &mut Random) {
    let text = formats::write(format, system, &FileSettings::default()).expect("can be written");
    let reread_problem = read(&text);
    assert_eq!(reread_problem.format, format);
    let reread_system = reread_problem.system;
    let point = random.point(system.variables.len());
    let at = random.point(system.parameters.len());
    // A parameter that is 0 would divide by 0.
    let at: Vec<_> = at
        .iter()
        .map(|p| p.add(&ComplexRational::real(1000)))
        .collect();
    let other_point = picked(&reread_system.variables, &system.variables, &point);
    let other_at = picked(&reread_system.parameters, &system.parameters, &at);
    assert_eq!(
        values(system, &point, &at),
        values(&reread_system, &other_point, &other_at),
        "{text}"
    );
    let double = |c: &ComplexRational| Complex64::new(c.re.to_f64(), c.im.to_f64());
    let rounded = |p: &[ComplexRational]| p.iter().map(double).collect::<Vec<_>>();
    assert_eq!(
        doubles(system, &rounded(&point), &rounded(&at)),
        doubles(&reread_system, &rounded(&other_point), &rounded(&other_at)),
        "{text}"
    );
    if format != Format::Phcpack {
        let shape = |s: &System| -> Vec<_> {
            let name = |&v: &usize| s.variables[v].clone();
            let names = |g: &VariableGroup| g.variables.iter().map(name).collect::<Vec<_>>();
            s.groups.iter().map(|g| (names(g), g.homogeneous)).collect()
        };
        assert_eq!(shape(system), shape(&reread_system));
    }
}

#[test]
fn random_systems_come_back_the_same() {
    let mut random = Random(1);
    for round in 0..600 {
        let system = random_system(&mut random, round % 2 == 0);
        check(&system, Format::Bertini, &mut random);
        check(&system, Format::Json, &mut random);
        if round % 2 == 1 {
            check(&system, Format::Phcpack, &mut random);
        }
    }
}

/// Notations that say less: what they take has the same values again, exactly.
#[test]
fn notations_of_algebra_give_the_same_values() {
    let mut random = Random(3);
    let mut written = [0; 4];
    for round in 0..200 {
        let system = random_system(&mut random, round % 2 == 0);
        let point = random.point(system.variables.len());
        let at = random.point(system.parameters.len());
        let at: Vec<_> = at
            .iter()
            .map(|p| p.add(&ComplexRational::real(1000)))
            .collect();
        let notations = [
            Format::Macaulay2,
            Format::Maple,
            Format::Singular,
            Format::Msolve,
        ];
        for (count, format) in written.iter_mut().zip(notations) {
            let Ok(text) = formats::write(format, &system, &FileSettings::default()) else {
                continue;
            };
            *count += 1;
            let reread_problem = read(&text);
            assert_eq!(reread_problem.format, format, "{text}");
            let reread_system = reread_problem.system;
            assert_eq!(reread_system.variables, system.variables);
            // A parameter that occurs nowhere need not come back.
            let other_at = picked(&reread_system.parameters, &system.parameters, &at);
            let there = values(&reread_system, &point, &other_at);
            assert_eq!(values(&system, &point, &at), there, "{text}");
        }
    }
    assert!(written.iter().all(|&count| count >= 20), "{written:?}");
}

#[test]
fn the_test_systems_come_back_the_same() {
    let mut random = Random(2);
    for name in system_names() {
        let path = systems().join(&name).join("system.bertini");
        let text = std::fs::read_to_string(path).expect("a test system");
        // Roots have no exact value; any number does in their place.
        let system = read(&text.replace("(3^(1/2))", "(97/56)")).system;
        for format in [Format::Bertini, Format::Json, Format::Phcpack] {
            check(&system, format, &mut random);
        }
    }
}

#[test]
fn a_graph_grows_into_definitions_not_into_a_tree() {
    // 2^200 terms as a tree, 200 nodes as a graph.
    let mut e = Expressions::new();
    let x = e.variable(0);
    let y = e.variable(1);
    let mut node = e.add(x, y);
    for i in 0..200 {
        let left = e.integer(i + 2);
        let left = e.multiply(left, node);
        let right = e.add(node, y);
        node = e.subtract(left, right);
    }
    // A chain of brackets that is deeper than the readers allow.
    let mut deep = x;
    for _ in 0..30_000 {
        let product = e.multiply(deep, y);
        deep = e.add(product, x);
    }
    let degree_one = System {
        expressions: e.clone(),
        variables: vec!["x".into(), "y".into()],
        groups: vec![VariableGroup {
            variables: vec![0, 1],
            homogeneous: false,
        }],
        equations: vec![node, deep],
        equation_names: vec!["f1".into(), "f2".into()],
        ..System::default()
    };
    for format in [Format::Bertini, Format::Json] {
        let text = formats::write(format, &degree_one, &FileSettings::default()).expect("written");
        assert!(text.len() < 2_000_000, "{}", text.len());
        let reread_system = read(&text).system;
        let point = [rational(1, 3), ComplexRational::i()];
        assert_eq!(
            values(&degree_one, &point, &[]),
            values(&reread_system, &point, &[])
        );
    }
    let refused = formats::write(Format::Phcpack, &degree_one, &FileSettings::default());
    assert_eq!(refused, Err(WriteError::TooLarge(Format::Phcpack)));
}

#[test]
fn everything_that_json_holds_comes_back() {
    let text = r#"{"variables": ["x", "y"], "parameters": ["t", "q"], "path_variable": "t",
        "groups": [["y"], ["x"]], "homogeneous": [true, false],
        "equations": ["x*y - t*sqrt(2)^3 + exp(Pi*I/4)", "x^2 - q/t"], "conjugates": [["x", "y"]],
        "degenerate": {"a \"b\"": {"nonzero": "x"}, "c": {"equations": ["x", "y - 1/2"]}},
        "symmetry": [{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "y/(x + 1)^2"}}]}"#;
    let system = read(text).system;
    let written = formats::write(Format::Json, &system, &FileSettings::default()).expect("written");
    let reread_system = read(&written).system;
    assert_eq!(reread_system.groups, system.groups);
    assert_eq!(reread_system.conjugates, system.conjugates);
    assert_eq!(reread_system.path_variable, system.path_variable);
    assert_eq!(
        formats::write(Format::Json, &reread_system, &FileSettings::default()).expect("written"),
        written
    );
    assert!(
        written.contains(r#""x*y - t*sqrt(2)^3 + exp(1/4*(I*Pi))""#),
        "{written}"
    );
    assert!(
        written.contains(r#"{"map": {"x": "y/(x + 1)^2", "y": "y"}}"#),
        "{written}"
    );
    assert!(matches!(
        reread_system.degenerate["a \"b\""],
        DegenerateSet::Nonzero(_)
    ));
    assert!(matches!(
        reread_system.symmetry[1],
        SymmetryGenerator::Map(_)
    ));
}

#[test]
fn settings_come_back_and_what_a_notation_lacks_is_said() {
    let settings = FileSettings {
        digits: Some(30),
        seed: Some(7),
        data_accuracy: 0.0,
        precision: Some(PrecisionHint::Bits(192)),
        final_tolerance: Some(1.5e-12),
        tracking_tolerance: Some(1e-6),
        endgame_tolerance: Some(1e-7),
        maximum_steps: Some(9000),
        user_homotopy: true,
        parameter_homotopy: None,
        other_run: None,
    };
    let text = "variable x; pathvariable t; function f; f = x - t*2^(1/2); END;";
    let system = read(text).system;
    let written = formats::write(Format::Bertini, &system, &settings).expect("written");
    assert_eq!(read(&written).settings, settings);
    assert_eq!(read(&written).system.path_variable, Some(0));
    let refused = |format, text: &str| {
        let result = formats::write(format, &read(text).system, &FileSettings::default());
        result.expect_err("cannot be written").to_string()
    };
    assert_eq!(
        refused(Format::Phcpack, text),
        "PHCpack notation has no parameters"
    );
    assert_eq!(
        refused(
            Format::Phcpack,
            "variable_group x; function f; f = x - 2^(1/2); END;"
        ),
        "PHCpack notation has no roots"
    );
    assert_eq!(
        refused(
            Format::Phcpack,
            "variable_group i; function f; f = i - 2; END;"
        ),
        "the name `i` cannot be written in PHCpack notation: it is the imaginary unit there"
    );
    assert_eq!(
        refused(Format::Bertini, "1\nfunction - 2;"),
        "the name `function` cannot be written in Bertini-classic notation: \
         it is a word of the notation there"
    );
}

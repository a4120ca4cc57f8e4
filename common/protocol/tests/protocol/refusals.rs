//! Every error names the field that is wrong, and nothing panics.

use crate::support::Draw;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::Work;
use cognate_protocol::{digest, from_proto, records, to_proto, v1};
use prost::Message;
use v1::node::Kind;

fn circle() -> v1::System {
    let node = |kind| v1::Node { kind: Some(kind) };
    let number = |re: &str| {
        node(Kind::Constant(v1::ExactComplex {
            re: re.to_owned(),
            im: String::new(),
        }))
    };
    v1::System {
        nodes: vec![
            node(Kind::Variable(0)),
            node(Kind::Power(v1::Power {
                base: 0,
                exponent: 2,
            })),
            number("2"),
            node(Kind::Subtract(v1::Binary { left: 1, right: 2 })),
        ],
        variables: vec!["x".to_owned()],
        equations: vec![v1::Equation {
            node: 3,
            name: "f".to_owned(),
        }],
        ..v1::System::default()
    }
}

/// Changes the circle, and checks what is said about it.
fn refused(change: impl FnOnce(&mut v1::System), said: &str) {
    let mut message = circle();
    change(&mut message);
    let error = from_proto::problem::system(&message).expect_err("this is no system");
    assert_eq!(error.to_string(), said);
}

#[test]
fn a_good_system_is_accepted_with_the_group_that_goes_without_saying() {
    let system = from_proto::problem::system(&circle()).unwrap();
    assert_eq!(system.groups.len(), 1);
    assert_eq!(system.groups[0].variables, [0]);
}

#[test]
fn a_symmetry_may_be_a_rational_map() {
    let mut message = circle();
    message.nodes.push(v1::Node {
        kind: Some(Kind::Divide(v1::Binary { left: 2, right: 0 })),
    });
    let map = v1::NodeList { nodes: vec![4] };
    message.symmetry = vec![v1::SymmetryGenerator {
        action: Some(v1::symmetry_generator::Action::Map(map)),
    }];
    assert_eq!(
        from_proto::problem::system(&message)
            .unwrap()
            .symmetry
            .len(),
        1
    );
}

#[test]
fn bad_nodes_are_refused_with_the_field() {
    refused(
        |m| {
            m.nodes[1] = v1::Node {
                kind: Some(Kind::Negate(1)),
            }
        },
        "nodes[1].negate is 1; expected an index below the number of the nodes before this one, 1",
    );
    refused(|m| m.nodes[2].kind = None, "nodes[2].kind is missing");
    refused(
        |m| {
            m.nodes[0] = v1::Node {
                kind: Some(Kind::Variable(7)),
            }
        },
        "nodes[0].variable is 7; expected an index below the number of variables, 1",
    );
    refused(
        |m| {
            m.nodes[1] = v1::Node {
                kind: Some(Kind::Power(v1::Power {
                    base: 0,
                    exponent: 1,
                })),
            }
        },
        "nodes[1].power.exponent is 1; expected at least 2",
    );
    refused(
        |m| {
            m.nodes[3] = v1::Node {
                kind: Some(Kind::Divide(v1::Binary { left: 1, right: 0 })),
            }
        },
        ": `f` divides by an expression with variables",
    );
    refused(
        |m| {
            m.nodes[2] = v1::Node {
                kind: Some(Kind::Constant(v1::ExactComplex::default())),
            };
            m.nodes[3] = v1::Node {
                kind: Some(Kind::Divide(v1::Binary { left: 1, right: 2 })),
            }
        },
        "nodes[3].divide.right is 0; expected a denominator that is not 0",
    );
    refused(
        |m| {
            m.nodes[3] = v1::Node {
                kind: Some(Kind::Function(v1::FunctionCall {
                    function: 1,
                    argument: 0,
                })),
            }
        },
        "nodes[3].function.argument is node 0, which is not constant; expected a constant",
    );
    for text in [
        "1/0", "1.5", "--1", "+1", "1/", "/2", "0x10", "1/-2", " 1", "1e3", "NaN",
    ] {
        refused(
            |m| {
                m.nodes[2] = v1::Node {
                    kind: Some(Kind::Constant(v1::ExactComplex {
                        re: text.to_owned(),
                        im: String::new(),
                    })),
                }
            },
            &format!(
                "nodes[2].constant.re is `{text}`; expected `p` or `p/q` with decimal integers and q not 0"
            ),
        );
    }
}

#[test]
fn bad_systems_are_refused_with_the_field() {
    refused(|m| m.equations.clear(), ": the system has no equations");
    refused(
        |m| m.equations[0].node = 9,
        "equations[0] is 9; expected an index below the number of nodes, 4",
    );
    refused(
        |m| m.equations[0].node = 2,
        ": equation `f` contains no variable",
    );
    refused(
        |m| m.parameters = vec!["x".to_owned()],
        ": the name `x` stands for two things",
    );
    refused(
        |m| m.variables[0] = "a b".to_owned(),
        "variables[0] is \"a b\"; expected a name without spaces",
    );
    refused(
        |m| m.variables = (0..1001).map(|i| format!("x{i}")).collect(),
        "variables: 1001 variables, more than the limit VARIABLES of 1000",
    );
    // x^2 is squared until its degree passes the limit: thirty nodes, degree 2^30.
    refused(
        |m| {
            for i in 3..33 {
                m.nodes.push(v1::Node {
                    kind: Some(Kind::Multiply(v1::Binary { left: i, right: i })),
                });
            }
            m.equations[0].node = 33;
        },
        "equations[0]: 2147483648 as degree of an equation, more than the limit DEGREE of 100000",
    );
}

#[test]
fn bad_stages_and_results_are_refused_with_the_field() {
    let stage = |change: &dyn Fn(&mut v1::Stage)| {
        let mut message = to_proto::path::stage(&Draw::new(1).stage());
        change(&mut message);
        from_proto::path::stage(&message).unwrap_err().to_string()
    };
    assert_eq!(stage(&|m| m.homotopy = None), "homotopy is missing");
    assert_eq!(
        stage(&|m| m.settings.as_mut().unwrap().max_step = None),
        "settings.max_step is missing"
    );
    assert_eq!(
        stage(&|m| m.settings.as_mut().unwrap().max_step = Some(f64::NAN)),
        "settings.max_step is NaN; expected a number from 1e-12 to 1.0"
    );
    assert_eq!(
        stage(&|m| m.start_points = Some(v1::StartPoints {
            kind: Some(v1::start_points::Kind::TotalDegree(v1::TotalDegree {
                degrees: vec![100_000; 20],
            })),
        })),
        "start_points: 18446744073709551615 paths, more than the limit PATHS of 1099511627776"
    );
    let result = |change: &dyn Fn(&mut v1::PathResult)| {
        let path = ItemResult::Track(Draw::new(1).path_result());
        let mut message = to_proto::path::item_result(&path);
        message.outcome = v1::PathOutcome::Regular.into();
        message.endpoint = vec![1.0, 2.0];
        change(&mut message);
        from_proto::path::item_result(&message, Work::Track)
            .map(|_| ())
            .map_err(|e| e.to_string())
    };
    assert_eq!(result(&|_| ()), Ok(()));
    assert_eq!(
        result(&|m| m.endpoint[1] = f64::NAN),
        Err("endpoint[0] is 1+NaNi; expected finite numbers".to_owned())
    );
    assert_eq!(
        result(&|m| m.endpoint.push(0.0)),
        Err(
            "endpoint is 3 doubles; expected real and imaginary part of every coordinate"
                .to_owned()
        )
    );
    assert_eq!(
        result(&|m| m.outcome = 99),
        Err("outcome is 99; expected an outcome that this version knows".to_owned())
    );
    assert_eq!(
        result(&|m| m.condition = f64::NAN),
        Err("condition is NaN; expected at least 0".to_owned())
    );
}

/// A few bytes changed, put in, taken out, or the end cut off.
fn mutate(draw: &mut Draw, bytes: &mut Vec<u8>) {
    for _ in 0..1 + draw.below(3) {
        if bytes.is_empty() {
            return;
        }
        let at = draw.below(bytes.len());
        match draw.below(5) {
            0 => bytes[at] ^= 1 << draw.below(8),
            1 => bytes[at] = [0, 0xff, 0x7f, 0x80][draw.below(4)],
            2 => bytes.insert(at, draw.below(256) as u8),
            3 => {
                bytes.remove(at);
            }
            _ => bytes.truncate(at),
        }
    }
}

#[test]
fn mutated_bytes_never_panic_and_what_passes_is_whole() {
    let mut passed = 0;
    for seed in 0..3000 {
        let mut draw = Draw::new(seed);
        let system = draw.system();
        let mut bytes = to_proto::problem::system(&system).encode_to_vec();
        mutate(&mut draw, &mut bytes);
        if let Ok(message) = v1::System::decode(bytes.as_slice())
            && let Ok(system) = from_proto::problem::system(&message)
        {
            system.check().expect("what passes the door is a system");
            passed += 1;
        }
        let mut bytes = digest::encode_system(&system);
        mutate(&mut draw, &mut bytes);
        if let Ok(other) = digest::decode_system(&bytes) {
            other.check().expect("what passes the door is a system");
        }
        let mut bytes = to_proto::problem::options(&draw.options()).encode_to_vec();
        mutate(&mut draw, &mut bytes);
        if let Ok(message) = v1::Options::decode(bytes.as_slice()) {
            let _ = from_proto::problem::options(message);
        }
        let mut bytes = to_proto::path::stage(&draw.stage()).encode_to_vec();
        mutate(&mut draw, &mut bytes);
        if let Ok(message) = v1::Stage::decode(bytes.as_slice())
            && let Ok(stage) = from_proto::path::stage(&message)
        {
            assert!(stage.items().is_some());
        }
        for (work, result) in draw.item_results() {
            let mut bytes = to_proto::path::item_result(&result).encode_to_vec();
            mutate(&mut draw, &mut bytes);
            if let Ok(message) = v1::PathResult::decode(bytes.as_slice()) {
                let _ = from_proto::path::item_result(&message, work);
            }
            let mut bytes = records::encode([&result]);
            mutate(&mut draw, &mut bytes);
            let _ = records::decode(&bytes, work);
        }
    }
    assert!(
        passed > 50,
        "mutations are mild enough that some pass: {passed}"
    );
}

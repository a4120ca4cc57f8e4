//! Our JSON: the fields of the contract, symmetry, degenerate sets, options.

use crate::support::{rational, read, refused, values};
use cognate_numeric::rational::ComplexRational;
use cognate_systems::expression::exact;
use cognate_systems::formats::{Format, degenerate, options, symmetry};
use cognate_systems::system::{DegenerateSet, SymmetryGenerator, VariableGroup};

const FULL: &str = r#"{
  "variables": ["x", "y", "X", "Y"],
  "groups": [["x", "y"], ["X", "Y"]],
  "homogeneous": [false, true],
  "parameters": ["p", "t"],
  "path_variable": "t",
  "definitions": {"b": "a^2", "a": "x + i*p", "c": 2.5},
  "equations": ["b*y - c*t", "x*X - y*Y", "1/2*x + I"],
  "conjugates": [["x", "X"], ["y", "Y"]],
  "degenerate": {"no pose": {"nonzero": "x + y"}, "line": {"equations": ["x", "a"]}},
  "symmetry": [{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "1/x", "Y": "X^-2*p"}}]
}"#;

#[test]
fn all_fields_are_read() {
    let problem = read(FULL);
    let s = &problem.system;
    assert_eq!(problem.format, Format::Json);
    assert!(problem.settings.user_homotopy);
    assert_eq!(
        (s.variables.len(), s.parameters.len(), s.path_variable),
        (4, 2, Some(1))
    );
    assert_eq!(
        s.groups[1],
        VariableGroup {
            variables: vec![2, 3],
            homogeneous: true
        }
    );
    assert_eq!(s.conjugates, [(0, 2), (1, 3)]);
    let point: Vec<_> = [2, 3, 5, 7].map(|n| rational(n, 1)).into();
    let parameters = [rational(1, 1), rational(4, 1)];
    // (2 + i)^2 * 3 - 10, 10 - 21, 1 + i
    assert_eq!(
        values(s, &point, &parameters),
        [
            ComplexRational::new(-1, 12),
            rational(-11, 1),
            ComplexRational::new(1, 1),
        ]
    );
    let at = |node| exact::value(&s.expressions, node, &point, &parameters).expect("rational");
    let DegenerateSet::Nonzero(nonzero) = &s.degenerate["no pose"] else {
        panic!("another kind")
    };
    assert_eq!(at(*nonzero), rational(5, 1));
    let DegenerateSet::Equations(line) = &s.degenerate["line"] else {
        panic!("another kind")
    };
    assert_eq!(at(line[1]), ComplexRational::new(2, 1));
    assert_eq!(
        s.symmetry[0],
        SymmetryGenerator::Permutation(vec![1, 0, 2, 3])
    );
    let SymmetryGenerator::Map(map) = &s.symmetry[1] else {
        panic!("another kind")
    };
    let images: Vec<_> = map.iter().map(|&node| at(node)).collect();
    assert_eq!(
        images,
        [
            rational(1, 2),
            rational(3, 1),
            rational(5, 1),
            rational(1, 25)
        ]
    );
}

#[test]
fn errors_name_the_field_and_both_columns() {
    let text = "{\"variables\": [\"x\"],\n \"equations\": [\"x^2 - 1\", \"x + \\u0079*2\"]}";
    assert_eq!(
        refused(text),
        "test:2:32: equations[1], column 5: expected a declared name, found the unknown name `y`\n   \
         |\n 2 |  \"equations\": [\"x^2 - 1\", \"x + \\u0079*2\"]}\n   \
         |                                ^^^^^^"
    );
}

#[test]
fn i_is_the_imaginary_unit_unless_it_is_declared() {
    let with = |variables: &str| {
        let text = format!("{{\"variables\": [{variables}], \"equations\": [\"x + i\"]}}");
        read(&text).system
    };
    let at = [rational(1, 1), rational(2, 1)];
    assert_eq!(
        values(&with("\"x\""), &at, &[]),
        [ComplexRational::new(1, 1)]
    );
    assert_eq!(values(&with("\"x\", \"i\""), &at, &[]), [rational(3, 1)]);
}

#[test]
fn files_and_options_add_to_a_system() {
    let mut s = read(
        "hom_variable_group x, y; variable_group z; parameter p; function f;
        f = x*y + p*z; END;",
    )
    .system;
    let file = br#"[{"permutation": {"x": "y", "y": "x"}}, {"map": {"z": "(x + y)/z"}}]"#;
    symmetry::read("sym", file, &mut s).expect("a symmetry file");
    assert_eq!(s.symmetry.len(), 2);
    let file = br#"{"no pose": {"nonzero": "x*y - p"}}"#;
    degenerate::read("deg", file, &mut s).expect("a file of degenerate sets");
    assert!(s.degenerate.contains_key("no pose"));
    options::groups("z; x; y", &mut s).expect("groups");
    let groups: Vec<_> = s
        .groups
        .iter()
        .map(|g| (g.variables[0], g.homogeneous))
        .collect();
    assert_eq!(groups, [(2, false), (0, true), (1, true)]);
    options::conjugates("x~y", &mut s).expect("conjugates");
    assert_eq!(s.conjugates, [(0, 1)]);
    s.check().expect("still a system");

    let first = |e: cognate_systems::formats::FormatError| {
        e.to_string().lines().next().unwrap_or_default().to_string()
    };
    let before = s.clone();
    let cases = [
        (
            options::groups("x,z;y", &mut s),
            "--groups:1:3: expected a group whose variables are \
          all homogeneous or all affine, found `z`, which is not like the one before",
        ),
        (
            options::groups("x;y", &mut s),
            "--groups:1:4: expected every variable in a group, found `z` in none",
        ),
        (
            options::groups("x;w", &mut s),
            "--groups:1:3: expected a declared name, found the unknown name `w`",
        ),
        (
            options::conjugates("x~x", &mut s),
            "--conjugates:1:3: expected a new name, found `x`, which is named here already",
        ),
        (
            options::conjugates("x,y", &mut s),
            "--conjugates:1:2: expected `~`, found `,`",
        ),
        (
            symmetry::read("sym", br#"[{"permutation": {"x": "y"}}]"#, &mut s),
            "sym:1:18: [0].permutation: expected a permutation of the variables, found `y` reached twice",
        ),
        (
            symmetry::read("sym", br#"[{"map": {"x": "y/0"}}]"#, &mut s),
            "sym:1:19: [0].map.x, column 3: expected a denominator that is not 0, found 0",
        ),
        (
            degenerate::read("deg", br#"{"a": {"zero": "x"}}"#, &mut s),
            "deg:1:7: a: expected {\"nonzero\": \"expression\"} or {\"equations\": [..]}, \
          found the field \"zero\"",
        ),
    ];
    for (result, message) in cases {
        assert_eq!(result.map_err(first), Err(message.into()));
    }
    assert_eq!(s, before, "what is refused changes nothing");
}

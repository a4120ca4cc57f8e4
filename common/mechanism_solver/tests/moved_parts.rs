//! Checks the parts that a number of a file moves: an assembly with the number as a coordinate has the residuals of the
//! changed file, wherever the joints stand.

use cognate_kinematics::mechanism::configuration::{GivenConfiguration, configurations};
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::mechanism::file_number::Moves;
use cognate_kinematics::mechanism::{Mechanism, ReadOptions, read};
use cognate_mechanism_solver::local::assembly::Assembly;
use cognate_mechanism_solver::local::nearby::{largest, linearized};
use num_complex::Complex64;
use serde_json::{Value, json};

/// A change of a number, short against the mechanism.
const CHANGE: f64 = 1e-3;

fn mechanism(tree: &Value) -> Mechanism {
    let content = tree.to_string().into_bytes();
    read("m", &content, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The number of a name in a file, as the name says the way to it.
fn number_in<'a>(tree: &'a mut Value, name: &str) -> &'a mut Value {
    let (first, rest) = name.split_once('.').expect("a name and a field");
    let is_named = |x: &Value| x["name"] == first;
    let body = ["joints", "loop", "platform"]
        .into_iter()
        .find(|body| !tree[body].is_null())
        .expect("a body");
    let mut place = match body {
        "joints" => &mut tree["joints"],
        "loop" => &mut tree["loop"]["joints"],
        _ if tree["platform"]["base"].get(first).is_some() => &mut tree["platform"]["base"],
        _ if tree["platform"]["moving"].get(first).is_some() => &mut tree["platform"]["moving"],
        _ => &mut tree["platform"]["legs"],
    };
    place = match place {
        Value::Array(list) => list.iter_mut().find(|x| is_named(x)).expect("a part"),
        object => &mut object[first],
    };
    for field in rest.split('.') {
        place = match field.parse::<usize>() {
            Ok(index) => &mut place[index],
            Err(_) => &mut place[field],
        };
    }
    place
}

/// The file with a number changed closes as the assembly does with the number's coordinate, wherever the others are.
fn check(tree: &Value, given: &GivenConfiguration) {
    let plain = mechanism(tree);
    let mut checked = 0;
    for number in plain.file_numbers() {
        if number.moves == Moves::Nothing {
            continue;
        }
        let mut tree = tree.clone();
        let place = number_in(&mut tree, &number.name);
        let before = number.value;
        *place = json!(before + CHANGE);
        let after = mechanism(&tree);
        let changed = Assembly::of(&after, given).expect("an assembly");
        let assembly = Assembly::with_number(&plain, given, &number.moves).expect("an assembly");
        assert_eq!(assembly.size, changed.size);
        let size = assembly.size.double;
        let candidates = match &number.moves {
            Moves::Leg(_) | Moves::Bar(_) => {
                vec![(2.0 * before * CHANGE + CHANGE * CHANGE) / (size * size)]
            }
            Moves::Direction {
                joint,
                side,
                is_second,
                axis,
            } => {
                let cognate_kinematics::mechanism::Body::Linkage(linkage) = &plain.body else {
                    unreachable!("directions are those of joints")
                };
                let place = &linkage.joints[*joint].sides[side.unwrap_or(0)];
                let direction = if *is_second {
                    place.second.clone().expect("a second axis")
                } else {
                    place.axis.clone()
                };
                let old = direction.each_ref().map(Number::to_f64);
                let mut new = old;
                new[*axis] += CHANGE;
                let dot =
                    |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
                let cosine = dot(&old, &new) / (dot(&old, &old) * dot(&new, &new)).sqrt();
                let half = ((1.0 - cosine).max(0.0) / (1.0 + cosine)).sqrt();
                vec![half, -half]
            }
            Moves::Chain { turns: true, .. } => {
                let half = CHANGE / 2.0;
                vec![half + half * half * half / 3.0]
            }
            _ => vec![CHANGE / size],
        };
        let gaps = candidates.iter().map(|value| {
            let count = changed.values.len();
            let at: Vec<Complex64> = (0..count)
                .map(|k| Complex64::new(0.1 * ((7 * k + 3) % 5) as f64 - 0.15, 0.0))
                .collect();
            let mut with_number = vec![Complex64::new(*value, 0.0)];
            with_number.extend(&at);
            let [a, b] = [
                linearized(&assembly, &with_number),
                linearized(&changed, &at),
            ];
            assert_eq!(a.gaps.len(), b.gaps.len());
            let differences: Vec<Complex64> =
                a.gaps.iter().zip(&b.gaps).map(|(x, y)| x - y).collect();
            largest(&differences)
        });
        let least = gaps.fold(f64::INFINITY, f64::min);
        assert!(least < 1e-9, "{}: {least:.1e}", number.name);
        checked += 1;
    }
    assert!(checked > 0);
}

#[test]
fn joints_of_all_kinds_move_as_the_changed_file_says() {
    let joint = |name: &str, kind: &str, links: [&str; 2], rest: Value| {
        let mut joint = json!({"name": name, "type": kind, "links": links});
        let object = joint.as_object_mut().expect("an object");
        object.extend(rest.as_object().expect("fields").clone());
        joint
    };
    let tree = json!({"space": "spatial", "links": ["g", "a", "b", "c", "d", "e", "rod"], "joints": [
        joint("r", "R", ["g", "a"], json!({"point": [0.1, 0.2, 0.3], "axis": [1.1, 0.3, 2]})),
        joint("u", "U", ["a", "b"], json!({"point": [1.1, 0.2, 0.3], "axes": [[1, 0.5, 0], [0, 0, 1]]})),
        joint("c", "C", ["b", "c"], json!({"point": [2.1, 0.2, 0.9], "axis": [0.2, 1, 0.1]})),
        joint("p", "P", ["d", "c"], json!({"axis": [0.2, 1, -0.7]})),
        joint("r2", "R", ["d", "g"], json!({"point": [2.1, 0.2, -0.9], "axis": [0, 0, 1]})),
        joint("s", "S", ["c", "e"], json!({"point": [3.1, 2.2, 0.9]})),
        joint("r3", "R", ["e", "g"], json!({"point": [3.1, 1.2, 0.9], "axis": [0.4, 0, 1]})),
        joint("s1", "S", ["a", "rod"], json!({"point": [1.5, 2.2, 0.9]})),
        joint("s2", "S", ["rod", "d"], json!({"point": [2.5, 2.7, 0.1]}))]});
    check(&tree, &GivenConfiguration::Home);
}

#[test]
fn rows_and_legs_move_as_the_changed_file_says() {
    let row = |k: u32, kind: &str| json!({"name": format!("q{k}"), "type": kind, "a": 0.3 * f64::from(k), "d": 0.2, "alpha": 0.4 * f64::from(k), "theta": 0.1});
    for convention in ["standard", "modified"] {
        let tree = json!({"angles": "rad", "loop": {"convention": convention, "joints": [row(1, "R"), row(2, "R"), row(3, "P"), row(4, "R")]}});
        check(&tree, &GivenConfiguration::Home);
    }
    let tree = json!({"platform": {"base": {"A": [0, 0, 0], "B": [1, 0.1, 0]}, "moving": {"P": [0.1, 0.2, 0.3], "Q": [1, 1, 0]}, "legs": [
        {"name": "L1", "type": "SS", "from": "A", "to": "P", "length": 1.5}, {"name": "L2", "type": "SS", "from": "A", "to": "Q", "length": 1.25},
        {"name": "L3", "type": "SPS", "at": 2.3, "from": "B", "to": "Q"}]}});
    let plain = mechanism(&tree);
    let at = json!({"pose": {"position": [0.1, 0.2, 1], "rpy": [10, 20, 30]}}).to_string();
    let given = configurations("at", at.as_bytes(), &plain, true).expect("a pose");
    check(&tree, &given[0]);
}

/// Points in links' coordinates: those of the one link only.
#[test]
fn points_of_one_link_move_as_the_changed_file_says() {
    let joint = |name: &str, kind: &str, links: [&str; 2], sides: [Value; 2]| {
        let [first, second] = sides;
        json!({"name": name, "type": kind, "links": links, "in": {links[0]: first, links[1]: second}})
    };
    let turn = |x: f64, y: f64| json!({"point": [x, y]});
    let shift = |x: f64, y: f64| json!({"point": [x, y], "direction": [1, 0.3]});
    let tree = json!({"space": "planar", "links": ["g", "a", "b"], "joints": [
        joint("A", "R", ["g", "a"], [turn(0.1, 0.2), turn(0.3, 0.4)]),
        joint("B", "R", ["b", "a"], [turn(1.1, 0.2), turn(0.7, 0.4)]),
        joint("C", "P", ["b", "g"], [shift(0.0, 0.7), shift(0.5, 0.4)])]});
    let plain = mechanism(&tree);
    let at = json!({"joints": {"A": 20, "B": 30, "C": 0.4}}).to_string();
    let given = configurations("at", at.as_bytes(), &plain, true).expect("values");
    check(&tree, &given[0]);
}

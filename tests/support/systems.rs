//! The systems of `tests/systems`, by name.

use cognate_systems::formats;
use cognate_systems::system::System;
use std::path::Path;

/// The system in `tests/systems/NAME/FILE`.
///
/// # Panics
/// When it is not there or cannot be read.
pub fn from_file(name: &str, file: &str) -> System {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("systems")
        .join(name);
    let path = folder.join(file);
    let content = match std::fs::read(&path) {
        Ok(content) => content,
        Err(error) => panic!("{}: {error}", path.display()),
    };
    match formats::read(file, &content) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

/// The system in `tests/systems/NAME/system.bertini`.
pub fn shared(name: &str) -> System {
    from_file(name, "system.bertini")
}

/// The system `system` with pairs of conjugate variables.
pub fn with_conjugates(mut system: System, pairs: &str) -> System {
    if let Err(error) = formats::options::conjugates(pairs, &mut system) {
        panic!("{error}");
    }
    system
}

/// A system written down in a test, in the notation of Bertini-classic.
pub fn written(input: &str) -> System {
    let text = format!("CONFIG\nEND;\nINPUT\n{input}\nEND;\n");
    match formats::read("written", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    }
}

/// A 6R arm in the notation of equations: each number by its place.
pub struct SerialArm<'a> {
    /// Direction of axis 1 to 6.
    pub axis: &'a dyn Fn(usize) -> [String; 3],
    /// Cosine of the twist between axis 1 to 5 and the next.
    pub cosine: &'a dyn Fn(usize) -> String,
    /// Length of the common normal from axis 1 to 5 to the next, over the sine of the twist.
    pub length: &'a dyn Fn(usize) -> String,
    /// Offset along the next axis.
    pub offset: &'a dyn Fn(usize) -> String,
    /// Coordinate 0 to 2 of the way from base to hand.
    pub place: &'a dyn Fn(usize) -> String,
}

/// Twelve equations of a serial arm: unit lengths of axes 2 to 5, twists, and the way from base to hand.
pub fn axis_equations(arm: &SerialArm<'_>) -> Vec<String> {
    let z = arm.axis;
    let dot = |a: &[String; 3], b: &[String; 3]| {
        format!("{}*{}+{}*{}+{}*{}", a[0], b[0], a[1], b[1], a[2], b[2])
    };
    let mut equations = Vec::new();
    for k in 2..=5 {
        equations.push(format!("{}-1", dot(&z(k), &z(k))));
    }
    for k in 1..=5 {
        equations.push(format!("{}-{}", dot(&z(k), &z(k + 1)), (arm.cosine)(k)));
    }
    for c in 0..3 {
        let (i, j) = ((c + 1) % 3, (c + 2) % 3);
        let mut sum = format!("-{}", (arm.place)(c));
        for k in 1..=5 {
            let (a, b, length) = (z(k), z(k + 1), (arm.length)(k));
            sum += &format!("+{length}*({}*{}-{}*{})", a[i], b[j], a[j], b[i]);
            sum += &format!("+{}*{}", (arm.offset)(k), b[c]);
        }
        equations.push(sum);
    }
    equations
}

/// The [`axis_equations`] of an arm in the directions of its axes 2 to 5.
pub fn by_axes(arm: &SerialArm<'_>) -> System {
    let equations = axis_equations(arm);
    let names: Vec<String> = (2..=5).flat_map(arm.axis).collect();
    let functions: Vec<String> = (1..=12).map(|i| format!("f{i}")).collect();
    let lines: Vec<String> = functions
        .iter()
        .zip(&equations)
        .map(|(f, e)| format!("{f} = {e};"))
        .collect();
    written(&format!(
        "variable_group {};\nfunction {};\n{}",
        names.join(", "),
        functions.join(", "),
        lines.join("\n")
    ))
}

/// Inverse kinematics of a general 6R arm by the directions z2..z5 of its inner
/// axes: lengths, twists, and one vector equation for the way from base to hand.
pub fn six_revolute_axis_vectors() -> System {
    let z = |k: usize| -> [String; 3] {
        match k {
            1 => ["0", "0", "1"].map(String::from),
            6 => ["3/13", "4/13", "12/13"].map(String::from),
            k => ["x", "y", "w"].map(|c| format!("{c}{k}")),
        }
    };
    by_axes(&SerialArm {
        axis: &z,
        cosine: &|k| format!("{k}/7"),
        length: &|k| format!("{}/5", k + 2),
        offset: &|k| format!("{}/3", 2 * k + 1),
        place: &|c| format!("{}/11", c + 5),
    })
}

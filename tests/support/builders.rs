//! Builders: problems in one line.

use std::path::Path;

/// Katsura's system of this size, from magnetism: `n` quadrics and a plane in n + 1 unknowns, with
/// 2^n regular solutions on as many paths (Katsura 1986; counts: Verschelde's collection).
pub fn katsura(n: usize) -> String {
    let name = |k: i64| format!("u{}", k.unsigned_abs());
    let names: Vec<String> = (0..=n as i64).map(name).collect();
    let functions: Vec<String> = (0..=n).map(|k| format!("f{k}")).collect();
    let mut text = format!(
        "CONFIG\nEND;\nINPUT\nvariable_group {};\nfunction {};\n",
        names.join(", "),
        functions.join(", ")
    );
    let n = n as i64;
    for m in 0..n {
        let products: Vec<String> = (-n..=n)
            .filter(|l| (m - l).abs() <= n)
            .map(|l| format!("{}*{}", name(l), name(m - l)))
            .collect();
        text += &format!("f{m} = {} - u{m};\n", products.join(" + "));
    }
    let sum: Vec<String> = (1..=n).map(|k| format!("2*u{k}")).collect();
    text + &format!("f{n} = u0 + {} - 1;\nEND;\n", sum.join(" + "))
}

/// x^2 = 2 and y = x: two solutions by two paths, which workers follow.
pub fn square_root_of_two() -> String {
    "CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;\nf = x^2 - 2;\ng = y - x;\nEND;\n"
        .to_owned()
}

/// An example that people are given to try.
///
/// # Panics
/// When there is none of this name.
pub fn example(name: &str) -> String {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = tests.join("../deploy/examples").join(name);
    match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => panic!("{}: {error}", path.display()),
    }
}

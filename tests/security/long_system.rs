//! A system whose paths take long, so that a solve is in the midst when something happens to it.

/// Quadrics in n unknowns, each with the next one: 2^n paths to as many solutions. For n = 16 they take some minutes.
pub fn long_system(n: usize) -> String {
    let names: Vec<String> = (0..n).map(|k| format!("x{k}")).collect();
    let variables = names.join(", ");
    let equations: String = (0..n)
        .map(|k| {
            let next = (k + 1) % n;
            format!("f{k} = x{k}^2 + {}*x{next} - {};\n", k + 2, k + 3)
        })
        .collect();
    let functions: Vec<String> = (0..n).map(|k| format!("f{k}")).collect();
    format!(
        "INPUT\nvariable_group {variables};\nfunction {};\n{equations}END;\n",
        functions.join(", ")
    )
}

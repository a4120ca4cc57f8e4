//! Arguments: the words after the name of a program that tests, as options that each take a value.

use std::fmt::Display;
use std::str::FromStr;

/// All arguments, as option and value.
///
/// # Errors
/// When an option has no value.
pub fn options() -> Result<Vec<(String, String)>, String> {
    let mut words = std::env::args().skip(1);
    let mut options = Vec::new();
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word}: a value is missing"))?;
        options.push((word, value));
    }
    Ok(options)
}

/// The settings of a program; if the arguments are wrong, the program prints the error and ends with 2.
pub fn or_exit<T>(wanted: Result<T, String>) -> T {
    wanted.unwrap_or_else(|message| {
        eprintln!("error: {message}");
        std::process::exit(2)
    })
}

/// The value of an option as a number.
///
/// # Errors
/// When it is none.
pub fn number<T: FromStr<Err: Display>>(option: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|e| format!("{option} {value}: {e}"))
}

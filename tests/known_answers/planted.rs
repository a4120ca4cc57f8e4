//! A sample of the planted systems; `tests/planted` solves as many as are asked for.

use cognate_tests::dice::Dice;
use cognate_tests::planted::kinds::{KINDS, planted};
use cognate_tests::planted::verdict::{Verdict, solve, start};
use std::time::Duration;

/// Systems of each kind in the sample.
const SAMPLE: u64 = 4;

/// No system of the sample is answered wrongly by an answer that is called settled.
#[test]
fn no_silent_error_among_planted_systems() {
    let mut wrong = Vec::new();
    for number in 0..SAMPLE * KINDS.len() as u64 {
        let system = planted(1, number);
        let mut dice = Dice(1 ^ number.rotate_left(20));
        let start = start(&mut dice);
        let seed = dice.below(1 << 32);
        let verdict = solve(&system, start.clone(), seed, Duration::from_secs(10));
        if let Verdict::Silent(what) = verdict {
            let answer = system.file("");
            wrong.push(format!(
                "{number}, {}, {}, {seed}:{what}\n{answer}",
                system.kind,
                start.name()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

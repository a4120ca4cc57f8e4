//! Whether a solution can have a coordinate 0, by the supports alone.

/// Most looks at terms; past them a coordinate 0 counts as possible.
const MOST_LOOKS: u64 = 5_000_000;
/// A term counts as one more look for each group of this many variables.
const WIDE: u64 = 128;

/// Whether some coordinates can be 0 at a solution and the others not: no equation may be left with exactly one term,
/// which would not vanish. If not, every solution in C^n lies in the torus for all values of the coefficients. If so, a
/// solution with these zeros may still not exist. A variable that `nonzero` marks is not 0.
pub fn zeros_are_possible(supports: &[Vec<Vec<u32>>], nonzero: &[bool]) -> bool {
    let n = supports.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let mut looks = MOST_LOOKS;
    let mut zero = Vec::with_capacity(n);
    search(supports, nonzero, n, &mut zero, &mut looks)
}

/// Decides the next variable; true where all are decided, one of them is 0 and
/// no equation speaks against it.
fn search(
    supports: &[Vec<Vec<u32>>],
    nonzero: &[bool],
    n: usize,
    zero: &mut Vec<bool>,
    looks: &mut u64,
) -> bool {
    for support in supports {
        let (mut alive, mut open) = (0, 0);
        for term in support {
            let Some(left) = looks.checked_sub(1 + n as u64 / WIDE) else {
                return true;
            };
            *looks = left;
            let vanishes = term
                .iter()
                .zip(zero.iter())
                .any(|(&e, &zero)| e > 0 && zero);
            if vanishes {
                continue;
            }
            match term.iter().skip(zero.len()).all(|&e| e == 0) {
                true => alive += 1,
                false => open += 1,
            }
        }
        if open == 0 && alive == 1 {
            return false;
        }
    }
    if zero.len() == n {
        return zero.contains(&true);
    }
    for value in [true, false] {
        if value && nonzero.get(zero.len()) == Some(&true) {
            continue;
        }
        zero.push(value);
        let admits_zero = search(supports, nonzero, n, zero, looks);
        zero.pop();
        if admits_zero {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_term_decides() {
        // x*y - 1, x + y: no coordinate can be 0.
        let torus = [vec![vec![0, 0], vec![1, 1]], vec![vec![1, 0], vec![0, 1]]];
        assert!(!zeros_are_possible(&torus, &[]));
        // x*y + x, x + y - 1: (0, 1) is a solution.
        let affine = [
            vec![vec![1, 1], vec![1, 0]],
            vec![vec![0, 0], vec![1, 0], vec![0, 1]],
        ];
        assert!(zeros_are_possible(&affine, &[]));
        // x + y, x^2: the second says x = 0, then the first y = 0.
        let origin = [vec![vec![1, 0], vec![0, 1]], vec![vec![2, 0]]];
        assert!(zeros_are_possible(&origin, &[]));
        assert!(!zeros_are_possible(&origin, &[true, false]));
    }
}

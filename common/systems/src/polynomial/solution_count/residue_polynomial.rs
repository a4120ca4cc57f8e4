//! Polynomials in one unknown over a prime field: residues, that of 1 first.

use super::prime_field::PrimeField;

/// The derivative.
pub(in crate::polynomial) fn derivative(field: PrimeField, polynomial: &[u64]) -> Vec<u64> {
    let each = polynomial.iter().zip(0..).skip(1);
    each.map(|(&c, k)| field.multiply(field.reduce(k), c))
        .collect()
}

/// The product.
pub(in crate::polynomial) fn product(field: PrimeField, a: &[u64], b: &[u64]) -> Vec<u64> {
    let mut product = vec![0; (a.len() + b.len()).saturating_sub(1)];
    for (k, &c) in a.iter().enumerate() {
        field.add_multiple(&mut product[k..k + b.len()], c, b);
    }
    product
}

/// Quotient and remainder; `None` where the divisor is 0.
pub(in crate::polynomial) fn divide(
    field: PrimeField,
    mut rest: Vec<u64>,
    divisor: &[u64],
) -> Option<(Vec<u64>, Vec<u64>)> {
    let divisor = trimmed(divisor.to_vec());
    let inverse = field.inverse(*divisor.last()?)?;
    rest = trimmed(rest);
    let mut quotient = vec![0; (rest.len() + 1).saturating_sub(divisor.len())];
    while rest.len() >= divisor.len() {
        let factor = field.multiply(*rest.last()?, inverse);
        let shift = rest.len() - divisor.len();
        quotient[shift] = factor;
        field.add_multiple(&mut rest[shift..], field.negative(factor), &divisor);
        rest = trimmed(rest);
    }
    Some((quotient, rest))
}

/// The greatest common divisor, up to a constant factor.
pub(in crate::polynomial) fn common_divisor(
    field: PrimeField,
    a: Vec<u64>,
    b: Vec<u64>,
) -> Option<Vec<u64>> {
    let (mut a, mut b) = (trimmed(a), trimmed(b));
    while !b.is_empty() {
        let (_, rest) = divide(field, a, &b)?;
        a = std::mem::replace(&mut b, rest);
    }
    Some(a)
}

/// The inverse modulo a polynomial; `None` where the two have a common factor.
pub(in crate::polynomial) fn inverse_modulo(
    field: PrimeField,
    a: &[u64],
    modulus: &[u64],
) -> Option<Vec<u64>> {
    let (mut a, mut b) = (divide(field, a.to_vec(), modulus)?.1, modulus.to_vec());
    // Factors of the first polynomial in a and b.
    let (mut of_a, mut of_b) = (vec![1], Vec::new());
    while a.len() > 1 {
        let (quotient, rest) = divide(field, b, &a)?;
        let mut factor = product(field, &quotient, &of_a);
        factor.iter_mut().for_each(|c| *c = field.negative(*c));
        factor.resize(factor.len().max(of_b.len()), 0);
        field.add_multiple(&mut factor, 1, &of_b);
        (a, b) = (rest, a);
        (of_a, of_b) = (trimmed(factor), of_a);
    }
    let inverse = field.inverse(*a.first()?)?;
    let scaled = of_a.iter().map(|&c| field.multiply(c, inverse)).collect();
    Some(divide(field, scaled, modulus)?.1)
}

/// The characteristic polynomial of the shortest linear recurrence of a sequence (J. L. Massey, Shift-register synthesis
/// and BCH decoding, 1969).
pub(in crate::polynomial) fn recurrence(field: PrimeField, sequence: &[u64]) -> Option<Vec<u64>> {
    let mut connection = vec![1u64];
    let mut before = vec![1u64];
    let (mut length, mut since, mut last) = (0usize, 1usize, 1u64);
    for n in 0..sequence.len() {
        let terms = connection.iter().zip(sequence[..=n].iter().rev());
        let discrepancy = terms.fold(0, |sum, (&c, &s)| field.reduce(sum + c * s));
        if discrepancy == 0 {
            since += 1;
            continue;
        }
        let times = field.negative(field.multiply(discrepancy, field.inverse(last)?));
        let mut next = connection.clone();
        next.resize(next.len().max(before.len() + since), 0);
        field.add_multiple(&mut next[since..since + before.len()], times, &before);
        if 2 * length <= n {
            (before, last) = (connection, discrepancy);
            (length, since) = (n + 1 - length, 1);
        } else {
            since += 1;
        }
        connection = next;
    }
    connection.resize(length + 1, 0);
    connection.reverse();
    Some(connection)
}

/// Without leading zeros.
fn trimmed(mut polynomial: Vec<u64>) -> Vec<u64> {
    while polynomial.last() == Some(&0) {
        polynomial.pop();
    }
    polynomial
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_divisors_and_inverses_fulfil_their_equations() {
        let field = PrimeField::new(2_147_483_629);
        let a = [3, 1, 4, 1, 5, 9, 2, 6];
        let b = [5, 3, 5, 8, 9];
        let (quotient, rest) = divide(field, a.to_vec(), &b).expect("not 0");
        let mut dividend = product(field, &quotient, &b);
        field.add_multiple(&mut dividend, 1, &rest);
        assert_eq!(dividend, a);
        let inverse = inverse_modulo(field, &b, &a).expect("no common factor");
        let (_, one) = divide(field, product(field, &inverse, &b), &a).expect("not 0");
        assert_eq!(one, [1]);
        let common = common_divisor(field, product(field, &a, &b), product(field, &b, &[7, 1]));
        assert_eq!(common.map(|common| common.len()), Some(b.len()));
        assert_eq!(
            inverse_modulo(field, &product(field, &b, &[7, 1]), &b),
            None
        );
        // Fibonacci's numbers.
        let minimal = recurrence(field, &[0, 1, 1, 2, 3, 5, 8, 13]).expect("a recurrence");
        assert_eq!(minimal, [field.negative(1), field.negative(1), 1]);
    }
}

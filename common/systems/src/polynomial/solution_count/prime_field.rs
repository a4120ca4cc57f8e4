//! PrimeField: residues modulo a prime below 2^31, whose products fit in 64 bits.

/// The integers modulo a prime.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::polynomial) struct PrimeField {
    prime: u64,
    /// 2^64 over the prime, rounded down.
    reciprocal: u64,
}

impl PrimeField {
    /// # Panics
    /// Where the number is 2^31 or larger.
    pub fn new(prime: u64) -> Self {
        assert!(prime >> 31 == 0, "products of residues have 62 bits");
        Self {
            prime,
            reciprocal: u64::MAX / prime,
        }
    }

    pub fn prime(self) -> u64 {
        self.prime
    }

    /// The residue of a number below 2^63: the quotient that the reciprocal gives is right or one too small (P. Barrett,
    /// 1986).
    pub fn reduce(self, number: u64) -> u64 {
        let product = u128::from(number) * u128::from(self.reciprocal);
        let rest = number - (product >> 64) as u64 * self.prime;
        match rest >= self.prime {
            true => rest - self.prime,
            false => rest,
        }
    }

    pub fn subtract(self, a: u64, b: u64) -> u64 {
        self.reduce(a + self.prime - b)
    }

    pub fn negative(self, a: u64) -> u64 {
        match a {
            0 => 0,
            a => self.prime - a,
        }
    }

    pub fn multiply(self, a: u64, b: u64) -> u64 {
        self.reduce(a * b)
    }

    /// The inverse; `None` of 0.
    pub fn inverse(self, a: u64) -> Option<u64> {
        if a <= 1 {
            return (a == 1).then_some(1);
        }
        Some(self.power(a, self.prime - 2))
    }

    fn power(self, mut base: u64, mut exponent: u64) -> u64 {
        let mut result = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.multiply(result, base);
            }
            base = self.multiply(base, base);
            exponent >>= 1;
        }
        result
    }

    /// A square root of -1; `None` where the prime is 3 modulo 4: the power (p - 1)/4 of a number that is no square.
    pub fn root_of_minus_one(self) -> Option<u64> {
        if self.prime % 4 != 1 {
            return None;
        }
        let mut roots = (2..self.prime).map(|n| self.power(n, (self.prime - 1) / 4));
        roots.find(|&root| self.multiply(root, root) == self.prime - 1)
    }

    /// sum + c * row, residues.
    pub fn add_multiple(self, sum: &mut [u64], c: u64, row: &[u64]) {
        if c != 0 {
            sum.iter_mut()
                .zip(row)
                .for_each(|(sum, &x)| *sum = self.reduce(*sum + c * x));
        }
    }

    /// The sum of products of residues.
    pub fn dot(self, a: &[u64], b: &[u64]) -> u64 {
        let products = a.iter().zip(b);
        products.fold(0, |sum, (&x, &y)| self.reduce(sum + x * y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residues_are_those_of_divisions() {
        for prime in [2_147_483_629, 2_147_483_647, 97] {
            let field = PrimeField::new(prime);
            let mut number = 1u64;
            for _ in 0..10_000 {
                number = number.wrapping_mul(6_364_136_223_846_793_005) ^ 0x9e37_79b9;
                assert_eq!(field.reduce(number >> 1), (number >> 1) % prime);
            }
            for (a, b) in [(prime - 1, prime - 1), (1, prime - 1), (0, 5)] {
                assert_eq!(field.multiply(a, b), a * b % prime);
                assert_eq!(field.subtract(a, b), (a + prime - b) % prime);
            }
            assert_eq!(field.inverse(0), None);
            let root = field.root_of_minus_one();
            assert_eq!(root.is_some(), prime % 4 == 1);
            assert!(root.is_none_or(|root| root * root % prime == prime - 1));
            let inverse = field.inverse(prime - 2).expect("not 0");
            assert_eq!(field.multiply(inverse, prime - 2), 1);
        }
    }
}

//! Linear equations in exact rationals: the one solution, or why there is none or more.

use cognate_numeric::rational::Rational;

/// Set of solutions of a system of linear equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Flat {
    /// No solution.
    Empty,
    /// One point.
    Point(Vec<Rational>),
    /// A line or more.
    Set,
}

/// The solutions of `rows[i][0] x_1 + ... + rows[i][n-1] x_n + rows[i][n] = 0`.
pub fn solve(rows: &[Vec<Rational>]) -> Flat {
    let mut rows = rows.to_vec();
    let n = rows[0].len() - 1;
    let mut rank = 0;
    let mut pivots = Vec::new();
    for column in 0..n {
        let Some(pivot) = (rank..rows.len()).find(|&i| rows[i][column] != 0) else {
            continue;
        };
        rows.swap(rank, pivot);
        let inverse = Rational::from(rows[rank][column].recip_ref());
        rows[rank].iter_mut().for_each(|entry| *entry *= &inverse);
        let row = rows[rank].clone();
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[column].clone();
            if i != rank && factor != 0 {
                for (entry, of_row) in other.iter_mut().zip(&row) {
                    *entry -= Rational::from(&factor * of_row);
                }
            }
        }
        pivots.push(column);
        rank += 1;
    }
    if rows[rank..].iter().any(|row| row[n] != 0) {
        return Flat::Empty;
    }
    match rank == n {
        true => Flat::Point(
            rows[..n]
                .iter()
                .map(|row| Rational::from(-&row[n]))
                .collect(),
        ),
        false => Flat::Set,
    }
}

//! Lattices of exponents: bases of what whole vectors span, in exact arithmetic.

/// A row of whole numbers.
pub(super) type Row = Vec<i128>;

/// `row - factor * other`; `None` where a number is past 128 bits.
fn less_multiple(row: &[i128], factor: i128, other: &[i128]) -> Option<Row> {
    let pairs = row.iter().zip(other);
    pairs
        .map(|(&a, &b)| a.checked_sub(factor.checked_mul(b)?))
        .collect()
}

/// Echelon form of some rows by whole operations that can be undone: entries below a pivot are 0, pivots are positive and
/// the entries above one are from 0 to less than it (Hermite's normal form; H. Cohen, A course in computational algebraic
/// number theory, 1993, algorithm 2.4.4). Rows of zeros come last. Only the first `columns` entries of a row are
/// eliminated; what stands behind them goes along. `None` where a number is past 128 bits.
pub(super) fn echelon_form(mut rows: Vec<Row>, columns: usize) -> Option<Vec<Row>> {
    let mut rank = 0;
    for column in 0..columns {
        // Euclid's algorithm among the rows that are left.
        loop {
            let nonzero = (rank..rows.len()).filter(|&i| rows[i][column] != 0);
            let Some(least) = nonzero.min_by_key(|&i| rows[i][column].unsigned_abs()) else {
                break;
            };
            rows.swap(rank, least);
            let pivot = rows[rank].clone();
            let mut is_done = true;
            for row in &mut rows[rank + 1..] {
                let quotient = row[column].checked_div_euclid(pivot[column])?;
                *row = less_multiple(row, quotient, &pivot)?;
                is_done &= row[column] == 0;
            }
            if is_done {
                break;
            }
        }
        if rank == rows.len() || rows[rank][column] == 0 {
            continue;
        }
        if rows[rank][column] < 0 {
            rows[rank].iter_mut().for_each(|entry| *entry = -*entry);
        }
        let pivot = rows[rank].clone();
        for row in &mut rows[..rank] {
            let quotient = row[column].checked_div_euclid(pivot[column])?;
            *row = less_multiple(row, quotient, &pivot)?;
        }
        rank += 1;
    }
    Some(rows)
}

/// The coordinates of a vector in a basis in echelon form that has as many rows as columns.
///
/// # Panics
/// Where the vector is not in the lattice of the basis.
pub(super) fn coordinates(basis: &[Row], vector: &[i128]) -> Option<Row> {
    let mut rest = vector.to_vec();
    let mut coordinates = Row::new();
    for (k, row) in basis.iter().enumerate() {
        assert_eq!(rest[k] % row[k], 0, "a vector of the lattice");
        let coordinate = rest[k] / row[k];
        rest = less_multiple(&rest, coordinate, row)?;
        coordinates.push(coordinate);
    }
    Some(coordinates)
}

/// The inverse of a square matrix of whole numbers whose determinant is 1 or -1.
fn inverse(matrix: &[Row]) -> Option<Vec<Row>> {
    let size = matrix.len();
    let form = echelon_form(with_unit_rows(matrix), size)?;
    Some(form.iter().map(|row| row[size..].to_vec()).collect())
}

/// Rows with those of the unit matrix behind them, to which operations on the rows are written down.
pub(super) fn with_unit_rows(rows: &[Row]) -> Vec<Row> {
    let size = rows.len();
    let longer = rows.iter().enumerate().map(|(k, row)| {
        let unit = (0..size).map(|j| i128::from(j == k));
        row.iter().copied().chain(unit).collect()
    });
    longer.collect()
}

fn product(a: &[Row], b: &[Row]) -> Option<Vec<Row>> {
    let columns = b.first().map_or(0, Vec::len);
    let entry = |row: &Row, column: usize| -> Option<i128> {
        let mut products = row
            .iter()
            .zip(b)
            .map(|(&x, row)| x.checked_mul(row[column]));
        products.try_fold(0i128, |sum, product| sum.checked_add(product?))
    };
    let rows = a
        .iter()
        .map(|row| (0..columns).map(|column| entry(row, column)).collect());
    rows.collect()
}

/// Vectors of a lattice by their coordinates in a basis of it, both by rows.
#[derive(Clone, Debug)]
pub(super) struct InBasis {
    pub coordinates: Vec<Row>,
    pub basis: Vec<Row>,
}

impl InBasis {
    /// Makes the coordinates of some vectors a triangle by another basis: of each of the first columns, as many as is the
    /// number that is returned, and 0 in all columns behind these.
    pub fn make_triangular(&mut self, chosen: &[Row]) -> Option<usize> {
        let size = self.basis.len();
        let transposed: Vec<Row> = (0..size)
            .map(|k| chosen.iter().map(|row| row[k]).collect())
            .collect();
        let form = echelon_form(with_unit_rows(&transposed), chosen.len())?;
        let is_zero = |row: &Row| row[..chosen.len()].iter().all(|&entry| entry == 0);
        let rank = form.iter().take_while(|row| !is_zero(row)).count();
        let operations: Vec<&[i128]> = form.iter().map(|row| &row[chosen.len()..]).collect();
        let change: Vec<Row> = (0..size)
            .map(|k| operations.iter().map(|row| row[k]).collect())
            .collect();
        self.coordinates = product(&self.coordinates, &change)?;
        self.basis = product(&inverse(&change)?, &self.basis)?;
        Some(rank)
    }

    /// Makes the coordinates small by another basis: each column of coordinates is reduced by each other one as long as
    /// that makes it shorter (Lagrange and Gauss, who have two columns); but none behind the first `kept` by one of these.
    /// `None` where a number is past 128 bits.
    pub fn make_small(&mut self, kept: usize) -> Option<()> {
        let size = self.basis.len();
        let mut is_changed = true;
        while is_changed {
            is_changed = false;
            for i in 0..size {
                let reducing = (0..size).filter(|&j| j != i && (i < kept || j >= kept));
                for j in reducing {
                    is_changed |= self.reduce(i, j)?;
                }
            }
        }
        Some(())
    }

    /// Takes the multiple of a column from another that makes this one shortest; whether it is shorter now.
    fn reduce(&mut self, i: usize, j: usize) -> Option<bool> {
        let product = |i: usize, j: usize| -> Option<i128> {
            let mut products = self
                .coordinates
                .iter()
                .map(|row| row[i].checked_mul(row[j]));
            products.try_fold(0i128, |sum, product| sum.checked_add(product?))
        };
        let (mixed, square) = (product(i, j)?, product(j, j)?);
        // The nearest whole number to the quotient; half a unit shortens nothing.
        let twice = mixed.checked_mul(2)?;
        if square == 0 || twice.unsigned_abs() <= square.unsigned_abs() {
            return Some(false);
        }
        let factor = twice
            .checked_add(square)?
            .div_euclid(square.checked_mul(2)?);
        for row in &mut self.coordinates {
            row[i] = row[i].checked_sub(factor.checked_mul(row[j])?)?;
        }
        self.basis[j] = less_multiple(&self.basis[j], factor.checked_neg()?, &self.basis[i])?;
        Some(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(entries: &[&[i128]]) -> Vec<Row> {
        entries.iter().map(|row| row.to_vec()).collect()
    }

    #[test]
    fn echelon_form_of_rows_that_depend_on_each_other() {
        let form = echelon_form(rows(&[&[4, 6], &[6, 9], &[2, 5]]), 2);
        assert_eq!(form, Some(rows(&[&[2, 1], &[0, 2], &[0, 0]])));
    }

    /// The last two entries of each row are the coefficients by which it combines the given rows.
    #[test]
    fn operations_are_written_down() {
        let given = rows(&[&[26, 92, 1, 0], &[33, 115, 0, 1]]);
        let form = echelon_form(given.clone(), 2).expect("small numbers");
        assert_eq!(form[0][0] * form[1][1], 46);
        for row in &form {
            for column in 0..2 {
                let combined = row[2] * given[0][column] + row[3] * given[1][column];
                assert_eq!(row[column], combined);
            }
        }
    }

    fn in_basis(vectors: &[Row]) -> InBasis {
        let mut basis = echelon_form(vectors.to_vec(), 2).expect("small numbers");
        basis.truncate(2);
        let coordinates = vectors.iter().map(|vector| coordinates(&basis, vector));
        let coordinates: Option<Vec<Row>> = coordinates.collect();
        InBasis {
            coordinates: coordinates.expect("small numbers"),
            basis,
        }
    }

    /// Exponents near one line, of degrees up to 129, in a lattice of index 2.
    #[test]
    fn coordinates_become_small() {
        let vectors = rows(&[&[62, 45], &[74, 55], &[18, 14], &[12, 11]]);
        let mut small = in_basis(&vectors);
        small.make_small(0).expect("small numbers");
        let largest = small
            .coordinates
            .iter()
            .flatten()
            .map(|entry| entry.abs())
            .max();
        assert!(largest <= Some(17), "{small:?}");
        assert_eq!(product(&small.coordinates, &small.basis), Some(vectors));
    }

    /// The last vector becomes one of the basis.
    #[test]
    fn coordinates_become_triangular() {
        let vectors = rows(&[&[62, 45], &[74, 55], &[18, 14], &[12, 11]]);
        let mut triangular = in_basis(&vectors);
        let chosen = vec![triangular.coordinates[3].clone()];
        assert_eq!(triangular.make_triangular(&chosen), Some(1));
        assert_eq!(triangular.coordinates[3], [1, 0]);
        triangular.make_small(1).expect("small numbers");
        assert_eq!(triangular.coordinates[3][1], 0);
        assert_eq!(
            product(&triangular.coordinates, &triangular.basis),
            Some(vectors)
        );
    }
}

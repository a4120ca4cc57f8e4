//! StartPoints: any start point by its index, so that a chunk is only a range.

use crate::start_systems::exchange::Exchange;
use crate::start_systems::linear_product::SetStructure;
use crate::start_systems::multihomogeneous::Choices;
use crate::start_systems::polyhedral::branches::CellBranches;
use cognate_systems::scaling::Scaling;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// BLAKE3 digest of a stored object, by which it is fetched and checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Digest(pub [u8; 32]);

impl std::fmt::Display for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Source of the start points of a stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum StartPoints {
    /// The solutions of x_i^(d_i) = 1: made from the index.
    TotalDegree {
        /// Degrees of the equations.
        degrees: Vec<u32>,
    },
    /// The solutions of a product of linear forms: made from the index.
    Multihomogeneous {
        /// Degree of each equation in each group: `degrees[equation][group]`.
        degrees: Vec<Vec<u32>>,
        /// Dimension of each group: how many equations take their factor from it.
        dimensions: Vec<u32>,
        /// Involution of the start points: of each two that it takes to each other, one is meant.
        exchange: Option<Exchange>,
    },
    /// Given points, stored as one object.
    Stored {
        /// Digest of the object's bytes (see [`StoredPoints::to_bytes`]).
        object: Digest,
        /// Number of points in the object.
        count: u64,
    },
    /// Some of the start points of another kind, by their indices there: paths tracked again.
    Selected {
        /// The start points that the indices refer to.
        base: Box<StartPoints>,
        /// The chosen indices, ascending.
        indices: Vec<u64>,
    },
    /// The regular solutions of products of linear forms in sets of variables: made from the index.
    LinearProduct {
        /// The variables of each factor of each equation, ascending.
        sets: SetStructure,
        /// Number of solutions of the start system.
        count: u64,
    },
    /// The solutions of the binomial systems of the mixed cells: made from the index.
    MixedCells {
        /// The mixed volume; 0 while it is counted.
        count: u64,
        /// The branches that the cells are enumerated in; `None` where it is done as a whole.
        branches: Option<CellBranches>,
    },
}

/// Points as an object: the variables of the system in order, one point after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredPoints {
    /// Coordinates per point.
    pub dimension: usize,
    /// All coordinates, point after point.
    pub coordinates: Vec<Complex64>,
}

/// An object that holds no points.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the object of start points is damaged: {0}")]
pub struct DamagedPoints(&'static str);

const MAGIC: &[u8; 8] = b"CGNPTS01";

impl StoredPoints {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.coordinates.len() / self.dimension.max(1)
    }

    /// True when there is no point.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// One point.
    pub fn point(&self, index: usize) -> &[Complex64] {
        &self.coordinates[index * self.dimension..(index + 1) * self.dimension]
    }

    /// Converts points from values of the variables to values of the unknowns that are tracked.
    pub fn in_unknowns(&self, scaling: &Scaling) -> Self {
        let points = self.coordinates.chunks(self.dimension.max(1));
        Self {
            dimension: self.dimension,
            coordinates: points
                .flat_map(|point| scaling.to_unknowns(point))
                .collect(),
        }
    }

    /// The points as they are named: by the digest of [`Self::to_bytes`].
    pub fn digest(&self) -> Digest {
        Digest(*blake3::hash(&self.to_bytes()).as_bytes())
    }

    /// All of these points as the start points of a stage.
    pub fn as_start(&self) -> StartPoints {
        StartPoints::Stored {
            object: self.digest(),
            count: self.len() as u64,
        }
    }

    /// The bytes of the object: magic, dimension, then coordinates, little endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(16 + 16 * self.coordinates.len());
        bytes.extend_from_slice(&Self::head(self.dimension));
        for &z in &self.coordinates {
            bytes.extend_from_slice(&Self::coordinate_bytes(z));
        }
        bytes
    }

    /// The first bytes of an object, for a writer that writes it piece by piece: magic and dimension.
    pub fn head(dimension: usize) -> [u8; 16] {
        let mut head = [0; 16];
        head[..8].copy_from_slice(MAGIC);
        head[8..].copy_from_slice(&(dimension as u64).to_le_bytes());
        head
    }

    /// The bytes of one coordinate: real part, imaginary part.
    pub fn coordinate_bytes(z: Complex64) -> [u8; 16] {
        let mut bytes = [0; 16];
        bytes[..8].copy_from_slice(&z.re.to_le_bytes());
        bytes[8..].copy_from_slice(&z.im.to_le_bytes());
        bytes
    }

    /// Reads what [`Self::to_bytes`] wrote.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DamagedPoints> {
        let word = |at: usize| -> Option<[u8; 8]> { bytes.get(at..at + 8)?.try_into().ok() };
        if word(0).as_ref() != Some(MAGIC) {
            return Err(DamagedPoints("it does not begin with the right magic"));
        }
        let dimension = word(8)
            .map(u64::from_le_bytes)
            .and_then(|d| usize::try_from(d).ok())
            .filter(|&d| d > 0)
            .ok_or(DamagedPoints("it has no dimension"))?;
        let body = &bytes[16..];
        let size = dimension
            .checked_mul(16)
            .ok_or(DamagedPoints("its dimension is absurd"))?;
        if !body.len().is_multiple_of(size) {
            return Err(DamagedPoints("its length is no multiple of its dimension"));
        }
        let coordinates = body
            .chunks_exact(16)
            .map(|c| {
                let part = |k: usize| {
                    f64::from_le_bytes(c[k..k + 8].try_into().expect("a chunk has 16 bytes"))
                };
                Complex64::new(part(0), part(8))
            })
            .collect::<Vec<_>>();
        if coordinates
            .iter()
            .any(|z| !z.re.is_finite() || !z.im.is_finite())
        {
            return Err(DamagedPoints("a coordinate is not finite"));
        }
        Ok(Self {
            dimension,
            coordinates,
        })
    }
}

impl StartPoints {
    /// Number of start points; `None` when they are more than fit in 64 bits.
    pub fn count(&self) -> Option<u64> {
        match self {
            Self::TotalDegree { degrees } => degrees
                .iter()
                .try_fold(1u64, |product, &d| product.checked_mul(u64::from(d))),
            Self::Multihomogeneous {
                degrees,
                dimensions,
                exchange,
            } => {
                let choices = Choices::of_half(degrees, dimensions, exchange.as_ref());
                choices.map(|choices| choices.count())
            }
            Self::Stored { count, .. }
            | Self::MixedCells { count, .. }
            | Self::LinearProduct { count, .. } => Some(*count),
            Self::Selected { indices, .. } => Some(indices.len() as u64),
        }
    }

    /// The exchange that takes one half of the start system's solutions to the other, where only
    /// one half is meant.
    pub fn exchange(&self) -> Option<&Exchange> {
        match self {
            Self::Multihomogeneous { exchange, .. } => exchange.as_ref(),
            Self::Selected { base, .. } => base.exchange(),
            Self::TotalDegree { .. }
            | Self::Stored { .. }
            | Self::MixedCells { .. }
            | Self::LinearProduct { .. } => None,
        }
    }

    /// The object that they are read from, if they are data.
    pub fn object(&self) -> Option<Digest> {
        match self {
            Self::Stored { object, .. } => Some(*object),
            Self::Selected { base, .. } => base.object(),
            Self::TotalDegree { .. }
            | Self::Multihomogeneous { .. }
            | Self::MixedCells { .. }
            | Self::LinearProduct { .. } => None,
        }
    }

    /// The index, in the stage that first started it, of item `index`.
    pub fn origin(&self, index: u64) -> u64 {
        match self {
            Self::Selected { base, indices } => base.origin(indices[index as usize]),
            _ => index,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_survives() {
        // 0 and -0 are equal numbers, but another bit is another path.
        let tiny = f64::from_bits(1);
        let points = |zero: f64| StoredPoints {
            dimension: 1,
            coordinates: vec![Complex64::new(zero, tiny), Complex64::new(0.1, f64::MAX)],
        };
        let bits = |p: &StoredPoints| -> Vec<u64> {
            let parts = p.coordinates.iter().flat_map(|z| [z.re, z.im]);
            parts.map(f64::to_bits).collect()
        };
        let read = StoredPoints::from_bytes(&points(-0.0).to_bytes()).unwrap();
        assert_eq!(bits(&read), bits(&points(-0.0)));
        assert_ne!(points(0.0).digest(), points(-0.0).digest());
        let expected = StartPoints::Stored {
            object: read.digest(),
            count: 2,
        };
        assert_eq!(read.as_start(), expected);
    }

    #[test]
    fn stored_points_come_back() {
        let points = StoredPoints {
            dimension: 2,
            coordinates: (0..6).map(|k| Complex64::new(f64::from(k), -0.5)).collect(),
        };
        let bytes = points.to_bytes();
        let read = StoredPoints::from_bytes(&bytes).unwrap();
        assert_eq!(read, points);
        assert_eq!(read.digest(), points.digest());
        assert!(StoredPoints::from_bytes(&bytes[..bytes.len() - 1]).is_err());
        assert!(StoredPoints::from_bytes(b"").is_err());
    }

    #[test]
    fn stored_points_are_found_under_a_selection() {
        let object = Digest([7; 32]);
        let stored = StartPoints::Stored { object, count: 3 };
        let selected = StartPoints::Selected {
            base: Box::new(stored),
            indices: vec![0, 2],
        };
        assert_eq!(selected.object(), Some(object));
        let degrees = vec![2, 2];
        assert_eq!(StartPoints::TotalDegree { degrees }.object(), None);
    }
}

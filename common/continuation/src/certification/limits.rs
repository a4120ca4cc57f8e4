//! Limits of Krawczyk's test, in any arithmetic.

/// ||1 - C J|| below this makes a certificate strong; less than 1/sqrt(2).
pub(super) const STRONG: f64 = 0.7;
/// Ratio of the first box to the first correction: room for the image of a solution under the involution, whose point
/// has an error of the same size.
pub(super) const INFLATION: f64 = 256.0;
/// Farthest that Newton's method may move a point, relative to its largest coordinate: the point is refined, and a
/// path's endpoint of double precision is good to much more.
pub(super) const FARTHEST: f64 = 1e-4;
/// Most of Newton's steps: each doubles the digits of a regular solution, and 1024 bits cannot start
/// from fewer than a handful, so that is more than enough.
pub(super) const MOST_STEPS: usize = 24;
/// Sizes of boxes that are tried.
pub(super) const TRIES: usize = 6;
/// Smallest radius of a box.
pub(super) const SMALLEST_RADIUS: f64 = 1e-280;

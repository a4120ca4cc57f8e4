//! How many paths a solve may have, which solves may have fewer, and what choosing a start may cost.

/// Most paths of one solve whose results are all held in memory, about 300 bytes a path. The limit holds for solves
/// - with certificates or more digits: one stage gets all endpoints as one object;
/// - with mixed cells, and equation by equation: all ends of one stage are the start points of the next;
/// - by loops: every new point is compared with all that are known;
/// - with an exchange of groups, symmetries or named sets: ends are compared with images of others.
pub const MAX_PATHS: u64 = 4_000_000;
/// Most paths of one solve whose results need not all be held (see `solutions::streamed`), about 24 bytes a path: by
/// degrees, and from given solutions to one target or several.
pub const MAX_STREAMED_PATHS: u64 = 40_000_000;

/// Most operations that choosing a start spends on a mixed volume: about a second.
pub(crate) const CHOOSING_OPERATIONS: u64 = 500_000_000;
/// Most operations that planning a polyhedral start spends on a mixed volume: a few seconds. Workers
/// count what takes longer.
pub const PLANNING_OPERATIONS: u64 = 2_000_000_000;
/// From this degree of an equation on a start with fewer paths to infinity is taken even where each path costs more.
/// Two equations of two terms and degree 165, 169 paths by groups: 32 s, and 158 of 159 solutions; 159 paths by mixed
/// cells: 0.1 s and all of them. A gas network of degree 14: 168 paths by total degree do not end in 60 s, 120 by mixed cells
/// take 0.1 s.
pub(crate) const HIGH_DEGREE: u32 = 14;

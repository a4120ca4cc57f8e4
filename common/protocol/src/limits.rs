//! Limits on messages, checked at the door. Those on a system's size are
//! `cognate_systems::formats::limits`, the same for files and for messages.

use cognate_systems::formats::limits;
pub use cognate_systems::formats::limits::{Limit, TARGETS};

/// Size of one message; gRPC's own default of 4 MiB would refuse chunks of large systems.
pub const MESSAGE_BYTES: Limit = Limit {
    name: "MESSAGE_BYTES",
    what: "bytes in a message",
    value: 64 << 20,
};
/// Size of one piece of an object on its way.
pub const PIECE_BYTES: Limit = Limit {
    name: "PIECE_BYTES",
    what: "bytes in a piece",
    value: 1 << 20,
};
/// Size of an uploaded object: about 10^6 points of 30 coordinates.
pub const OBJECT_BYTES: Limit = Limit {
    name: "OBJECT_BYTES",
    what: "bytes in an object",
    value: 512 << 20,
};
/// Bytes of a name chosen by a client or a worker.
pub const NAME_BYTES: Limit = Limit {
    name: "NAME_BYTES",
    what: "bytes in a name",
    value: 200,
};
/// Paths of one stage.
pub const PATHS: Limit = Limit {
    name: "PATHS",
    what: "paths",
    value: 1 << 40,
};
/// Paths of one chunk.
pub const CHUNK_PATHS: Limit = Limit {
    name: "CHUNK_PATHS",
    what: "paths in a chunk",
    value: 1 << 17,
};
/// Paths that a stage names one by one.
pub const SELECTED_PATHS: Limit = Limit {
    name: "SELECTED_PATHS",
    what: "paths named one by one",
    value: 10_000_000,
};
/// Orders of functionals at an endpoint.
pub const DUAL_DIMENSIONS: Limit = Limit {
    name: "DUAL_DIMENSIONS",
    what: "dimensions of dual spaces",
    value: 1000,
};
/// Slices that were moved away from an endpoint.
pub const MOVED_SLICES: Limit = Limit {
    name: "MOVED_SLICES",
    what: "slices beside an endpoint",
    value: 100,
};
/// Doubles of a derivative of a witness point: four for each unknown.
pub const BEND_DOUBLES: Limit = Limit {
    name: "BEND_DOUBLES",
    what: "doubles of a derivative",
    value: 4 * COORDINATES.value,
};
/// Coordinates of an endpoint: every variable may have a group of its own.
pub const COORDINATES: Limit = Limit {
    name: "COORDINATES",
    what: "coordinates of a point",
    value: 2 * limits::VARIABLES.value,
};
/// Chunks in one call of a worker.
pub const CHUNKS_PER_CALL: Limit = Limit {
    name: "CHUNKS_PER_CALL",
    what: "chunks in one call",
    value: 10_000,
};
/// Factors of one equation of a linear-product start.
pub const FACTORS: Limit = Limit {
    name: "FACTORS",
    what: "factors of an equation",
    value: 1 << 15,
};
/// Bits of precision.
pub const PRECISION_BITS: Limit = Limit {
    name: "PRECISION_BITS",
    what: "bits of precision",
    value: 1 << 20,
};
/// Remarks of a client about the files that it read.
pub const WARNINGS: Limit = Limit {
    name: "WARNINGS",
    what: "warnings",
    value: 200,
};
/// Bytes of one of them.
pub const WARNING_BYTES: Limit = Limit {
    name: "WARNING_BYTES",
    what: "bytes in a warning",
    value: 10_000,
};
/// Named sets of endpoints that are no answers.
pub const DEGENERATE_SETS: Limit = Limit {
    name: "DEGENERATE_SETS",
    what: "degenerate sets",
    value: 1_000,
};
/// Generators of a symmetry group.
pub const SYMMETRY_GENERATORS: Limit = Limit {
    name: "SYMMETRY_GENERATORS",
    what: "symmetry generators",
    value: 100,
};

/// All limits that clients are told of.
pub const ALL: &[Limit] = &[
    MESSAGE_BYTES,
    OBJECT_BYTES,
    PIECE_BYTES,
    NAME_BYTES,
    TARGETS,
    PATHS,
    SELECTED_PATHS,
    PRECISION_BITS,
    WARNINGS,
    WARNING_BYTES,
    DEGENERATE_SETS,
    SYMMETRY_GENERATORS,
    limits::FILE_BYTES,
    limits::VARIABLES,
    limits::EQUATIONS,
    limits::PARAMETERS,
    limits::NODES,
    limits::EXPONENT,
    limits::DEGREE,
    limits::NUMBER_DIGITS,
    limits::CONSTANT_BITS,
];

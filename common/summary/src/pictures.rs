//! Pictures: the scripts that draw surfaces, curves and mechanisms, on the page of a coordinator and on those that are
//! written to files.

/// A picture in space that is turned by hand, and the parts of surfaces and curves in it.
pub const SCENE: &str = include_str!("pictures/scene.js");
/// A mechanism in its positions and along its branches; draws by [`SCENE`].
pub const MECHANISM: &str = include_str!("pictures/mechanism.js");

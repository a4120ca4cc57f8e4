//! Workspace: where a mechanism's output can be, in how many postures, and what bounds that.
//!
//! [`workspace`] answers single points. A [`Boundary`] has the curves in the plane that can bound the reachable
//! points, the area between them and the largest number of postures: the curves are circles, which cut the plane
//! into regions, and each region is asked for at a point.

mod arms;
mod arrangement;
mod boundary;
mod circle;
mod collinear;
mod curves;
mod elbows;
mod most_postures;
mod planar_chain;
mod points;
mod reach;
mod reached_point;
mod regions;
mod two_links;

pub use boundary::{Boundary, BoundaryCurve, boundary};
pub use curves::{Cause, Curve};
pub use points::workspace;
pub use reached_point::ReachedPoint;

//! Answer: what was found about components that are known by their witness sets.

use super::decomposition::Decomposition;
use super::evidence::Trace;
use super::real_curve::RealCurve;
use super::real_surface::RealSurface;
use super::witness_set::ComponentId;
use cognate_numeric::counted::counted;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Whether what was read of one component is whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckedComponent {
    /// The component.
    pub id: ComponentId,
    /// Sum of second derivatives over its witness points; `None` for a point.
    pub trace: Option<Trace>,
    /// Whether the sum of second derivatives is 0.
    pub closed: bool,
    /// Dimension of the dual space at a witness point; `None` where it did not close.
    pub multiplicity: Option<u64>,
}

/// Numbers of witness points of one component that are proved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CertifiedComponent {
    /// The component.
    pub id: ComponentId,
    /// Number of witness points of the component.
    pub points: u64,
    /// Witness points that are each alone in a box, as solutions of combinations of the equations on the slice.
    pub certified: u64,
    /// Whether the certified points are proved to be different.
    pub distinct: bool,
}

/// A component of which it is not clear whether a point lies on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Near {
    /// The component.
    pub id: ComponentId,
    /// Distance of the nearest point that was found on it, relative to the point's size; `None` where a path
    /// failed and nothing is known.
    pub distance: Option<f64>,
}

/// On which components one point lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Membership {
    /// Index of the point among the points that were asked.
    pub index: u64,
    /// The components on which it lies.
    pub on: Vec<ComponentId>,
    /// Components for which it is not clear whether the point lies on them.
    pub unsettled: Vec<Near>,
    /// Whether the point solves the equations, within its accuracy; `None` where that is not clear.
    pub solves: Option<bool>,
}

/// Points of one component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// The component.
    pub id: ComponentId,
    /// Number of points that were wanted.
    pub wanted: u64,
    /// Values of the variables.
    pub points: Vec<Vec<Complex64>>,
    /// Paths that failed on the way.
    pub failed: u64,
}

/// The closure of one component's image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Projection {
    /// The component.
    pub id: ComponentId,
    /// Dimension of the image; `None` where ranks do not tell.
    pub dimension: Option<u32>,
    /// Degree of the image; `None` where it is not clear.
    pub degree: Option<u64>,
    /// Degree of a general fibre.
    pub fiber_degree: Option<u64>,
    /// Dimension of a general fibre.
    pub fiber_dimension: Option<u32>,
    /// The first of the components before it that has the same image.
    pub same_image: Option<ComponentId>,
    /// Least gap between singular values that were taken as not 0 and as 0.
    pub rank_gap: f64,
    /// Doubts about this result, as shown to the user.
    pub doubts: Vec<String>,
}

/// The number of points that slices in single groups cut out of a component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupDegree {
    /// Slices in each group.
    pub slices: Vec<u32>,
    /// The number of points; `None` where it is not clear.
    pub degree: Option<u64>,
}

/// The multidegree of one component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Multidegree {
    /// The component.
    pub id: ComponentId,
    /// An entry for each way to share the slices out.
    pub degrees: Vec<GroupDegree>,
    /// Doubts about this result, as shown to the user.
    pub doubts: Vec<String>,
}

/// Motions of one point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mobility {
    /// Index of the point among the points that were asked.
    pub index: u64,
    /// Dimension of the tangent space: motions to the first order.
    pub infinitesimal: Option<u32>,
    /// Dimensions of the dual space up to each order, from 0.
    pub dimensions_by_order: Vec<u32>,
    /// Largest dimension of a component through the point; `None` where it is not known.
    pub local_dimension: Option<u32>,
    /// Reason by which the local dimension is known.
    pub reason: String,
    /// The components through the point, where some are known.
    pub on: Vec<ComponentId>,
}

/// A real point of a component.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealPoint {
    /// Values of the variables; those of variables that conjugation exchanges are conjugates.
    pub point: Vec<Complex64>,
    /// Whether the distance to a random point has a regular critical point there; else it is singular, or of a linear
    /// set that is.
    pub regular: bool,
}

/// Real points of one component: at least one on every connected part, where nothing is in doubt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealPoints {
    /// The component.
    pub id: ComponentId,
    /// The points; none where it has no real points.
    pub points: Vec<RealPoint>,
    /// Doubts about this result and parts that it does not cover, as shown to the user.
    pub doubts: Vec<String>,
}

/// Answer to a question about components, by the kind of question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Whether what was read is whole.
    Check(Vec<CheckedComponent>),
    /// Witness points that are proved.
    Certify(Vec<CertifiedComponent>),
    /// On which components each point lies.
    Member(Vec<Membership>),
    /// Points of each component.
    Sample(Vec<Samples>),
    /// Images of components.
    Project(Vec<Projection>),
    /// Degrees by groups of variables.
    Multidegree {
        /// The groups, by names of variables.
        groups: Vec<Vec<String>>,
        /// The components.
        components: Vec<Multidegree>,
    },
    /// Motions of points.
    Mobility(Vec<Mobility>),
    /// Real curves.
    RealCurve(Vec<RealCurve>),
    /// Components of the set that was cut out.
    Components(Box<Decomposition>),
    /// Real points.
    RealPoints(Vec<RealPoints>),
    /// Real surfaces.
    RealSurface(Vec<RealSurface>),
}

impl Answer {
    /// The name of the question as people type it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Check(_) => "check",
            Self::Certify(_) => "certify",
            Self::Member(_) => "member",
            Self::Sample(_) => "sample",
            Self::Project(_) => "project",
            Self::Multidegree { .. } => "multidegree",
            Self::Mobility(_) => "mobility",
            Self::RealCurve(_) => "real-curve",
            Self::Components(_) => "components",
            Self::RealPoints(_) => "real-points",
            Self::RealSurface(_) => "real-surface",
        }
    }

    /// All doubts about the answer, as shown to the user; empty where everything is settled.
    pub fn doubts(&self) -> Vec<String> {
        match self {
            Self::Check(components) => components.iter().filter_map(check_doubt).collect(),
            Self::Certify(components) => components.iter().filter_map(certify_doubt).collect(),
            Self::Member(points) => points.iter().filter_map(member_doubt).collect(),
            Self::Sample(components) => components.iter().filter_map(sample_doubt).collect(),
            Self::Project(components) => {
                let each = components.iter();
                each.flat_map(|c| of_component(c.id, &c.doubts)).collect()
            }
            Self::Multidegree { components, .. } => {
                let each = components.iter();
                each.flat_map(|c| of_component(c.id, &c.doubts)).collect()
            }
            Self::Mobility(points) => points.iter().filter_map(mobility_doubt).collect(),
            Self::RealCurve(curves) => {
                let each = curves.iter();
                each.flat_map(|c| of_component(c.id, &c.doubts)).collect()
            }
            // A decomposition has doubts of its own.
            Self::Components(_) => Vec::new(),
            Self::RealPoints(components) => {
                let each = components.iter();
                each.flat_map(|c| of_component(c.id, &c.doubts)).collect()
            }
            Self::RealSurface(surfaces) => {
                let each = surfaces.iter();
                each.flat_map(|c| of_component(c.id, &c.doubts)).collect()
            }
        }
    }
}

fn of_component(id: ComponentId, doubts: &[String]) -> Vec<String> {
    let said = doubts.iter();
    said.map(|doubt| format!("component {id}: {doubt}"))
        .collect()
}

fn check_doubt(component: &CheckedComponent) -> Option<String> {
    (!component.closed).then(|| {
        format!(
            "component {}: second derivatives do not sum to 0: a witness point is missing or is of another component",
            component.id
        )
    })
}

fn certify_doubt(component: &CertifiedComponent) -> Option<String> {
    let (id, certified, points) = (component.id, component.certified, component.points);
    match (certified == points, component.distinct) {
        (true, true) => None,
        (true, false) => Some(format!(
            "component {id}: its witness points are not proved to be different"
        )),
        (false, _) => Some(format!(
            "component {id}: {certified} of {points} witness points are proved"
        )),
    }
}

fn member_doubt(membership: &Membership) -> Option<String> {
    let index = membership.index;
    let near = membership.unsettled.first()?;
    Some(match near.distance {
        Some(distance) => format!(
            "point {index}: {distance:.1e} from component {}, which is neither on it nor clearly off",
            near.id
        ),
        None => format!(
            "point {index}: whether it lies on component {} is not known: a path failed",
            near.id
        ),
    })
}

fn sample_doubt(samples: &Samples) -> Option<String> {
    let count = samples.points.len() as u64;
    let reason = match samples.failed {
        0 => String::new(),
        failed => format!("; {} failed", counted(failed, "path")),
    };
    (count < samples.wanted).then(|| {
        format!(
            "component {}: {count} of {} points were found{reason}",
            samples.id, samples.wanted
        )
    })
}

fn mobility_doubt(mobility: &Mobility) -> Option<String> {
    (mobility.local_dimension.is_none())
        .then(|| format!("point {}: {}", mobility.index, mobility.reason))
}

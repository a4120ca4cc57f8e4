//! Reduced loops: the modes of a loop in the unknowns of some of its joints, which determine those of the other joints.
//!
//! A loop has equations of small degree without the joints beside its cuts (M. Raghavan, B. Roth 1993). The image of a mode in
//! the unknowns of the other joints is a component of what these equations cut. Where equations that are linear in the
//! unknowns that are left out determine them, the image has the circuits of the mode.

use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::evaluation;
use cognate_systems::expression::differentiate::below;
use cognate_systems::expression::{Expressions, Imported, Node, NodeId};
use cognate_systems::system::{System, VariableGroup};
use num_complex::Complex64;

/// Most joints of a loop of which all sets are tried.
const MOST_JOINTS: usize = 12;
/// Number of the stream of random numbers that tests of linearity come from.
const LINEARITY: u64 = 1 << 33;
/// A second difference below this, relative to 1 and the values, is 0.
const LINEAR: f64 = 1e-9;
/// A pivot of an equation that is independent of others is above this part of its largest coefficient.
const INDEPENDENT: f64 = 1e-6;
/// Step of differences, in the unknowns: cosines and sines have size 1.
const DIFFERENCE: f64 = 1e-5;

/// Equations of a loop without the unknowns of some joints.
pub(super) struct Reduction {
    /// The equations, in the unknowns that are kept.
    pub system: System,
    /// Places of the kept unknowns among all.
    kept: Vec<usize>,
    /// The unknowns that are left out, and the equations that are linear in them.
    lift: Lift,
}

/// Linear equations for unknowns that are left out.
struct Lift {
    whole: System,
    left_out: Vec<usize>,
    linear: Vec<NodeId>,
}

impl Reduction {
    /// The reduction that leaves most unknowns out: at each of these points, one of every mode, the equations that are kept
    /// cut a curve, and the other unknowns are determined. `None` where there is none.
    pub fn of(whole: &System, points: &[&Vec<Complex64>], seed: u64) -> Option<Self> {
        let joints = joints_of(&whole.variables);
        if joints.len() > MOST_JOINTS || !whole.parameters.is_empty() {
            return None;
        }
        let occurring: Vec<Vec<usize>> = whole
            .equations
            .iter()
            .map(|equation| occurring(&whole.expressions, *equation))
            .collect();
        let mut sets: Vec<Vec<usize>> = (1usize..1 << joints.len())
            .map(|set| {
                let chosen = (0..joints.len()).filter(|joint| set >> joint & 1 == 1);
                chosen.flat_map(|joint| joints[joint].clone()).collect()
            })
            .collect();
        sets.sort_by_key(|left_out| std::cmp::Reverse(left_out.len()));
        let reduction = |left_out: Vec<usize>| {
            let kept: Vec<usize> = (0..whole.variables.len())
                .filter(|place| !left_out.contains(place))
                .collect();
            let among_kept = |places: &Vec<usize>| places.iter().all(|place| kept.contains(place));
            let equations: Vec<usize> = (0..whole.equations.len())
                .filter(|k| among_kept(&occurring[*k]))
                .collect();
            if equations.len() + 1 < kept.len() {
                return None;
            }
            let system = restricted(whole, &kept, &equations);
            let is_curve = |point: &&Vec<Complex64>| {
                let seen: Vec<Complex64> = kept.iter().map(|place| point[*place]).collect();
                rank(&derivatives(&system, &seen)) + 1 == kept.len()
            };
            if !points.iter().all(is_curve) {
                return None;
            }
            let reduction = Self {
                lift: Lift::of(whole, left_out, seed),
                system,
                kept,
            };
            let determines = |point: &&Vec<Complex64>| reduction.lift.determines(point);
            points.iter().all(determines).then_some(reduction)
        };
        sets.into_iter().find_map(reduction)
    }

    /// The kept unknowns of a point.
    pub fn image(&self, point: &[Complex64]) -> Vec<Complex64> {
        self.kept.iter().map(|place| point[*place]).collect()
    }

    /// Whether the kept unknowns determine the others.
    pub fn determines(&self, image: &[Complex64]) -> bool {
        let mut point = vec![Complex64::new(0.0, 0.0); self.lift.whole.variables.len()];
        for (place, value) in self.kept.iter().zip(image) {
            point[*place] = *value;
        }
        self.lift.determines(&point)
    }
}

impl Lift {
    fn of(whole: &System, left_out: Vec<usize>, seed: u64) -> Self {
        let mut random = RandomStream::new(seed, Purpose::Question, LINEARITY);
        let mut number =
            || Complex64::new(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
        let base: Vec<Complex64> = whole.variables.iter().map(|_| number()).collect();
        let [first, second] = [0, 1].map(|_| {
            let direction = left_out.iter().map(|_| number());
            direction.collect::<Vec<Complex64>>()
        });
        let at = |factors: [f64; 2]| {
            let mut point = base.clone();
            for ((place, x), y) in left_out.iter().zip(&first).zip(&second) {
                point[*place] = factors[0] * x + factors[1] * y;
            }
            evaluation::values(&whole.expressions, &whole.equations, &point, &[])
        };
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(at);
        let [none, x, y, both] = &corners;
        let is_linear = |k: &usize| {
            let size = corners.iter().map(|values| values[*k].norm_sqr());
            let size = size.fold(1.0, f64::max).sqrt();
            let difference = both[*k] - x[*k] - y[*k] + none[*k];
            difference.norm_sqr() <= (LINEAR * size).powi(2)
        };
        let linear = (0..whole.equations.len()).filter(is_linear);
        let linear = linear.map(|k| whole.equations[k]).collect();
        Self {
            whole: whole.clone(),
            left_out,
            linear,
        }
    }

    /// Whether the linear equations have full rank where the other unknowns are those of a point.
    fn determines(&self, point: &[Complex64]) -> bool {
        let values = |unit: Option<usize>| {
            let mut point = point.to_vec();
            for place in &self.left_out {
                point[*place] = Complex64::from(f64::from(unit == Some(*place)));
            }
            evaluation::values(&self.whole.expressions, &self.linear, &point, &[])
        };
        let none = values(None);
        let columns: Vec<Vec<Complex64>> = self
            .left_out
            .iter()
            .map(|place| {
                let pairs = values(Some(*place)).into_iter().zip(&none);
                pairs.map(|(a, b)| a - b).collect()
            })
            .collect();
        rank(&transposed(&columns)) == self.left_out.len()
    }
}

/// Places of the unknowns of each joint: cosine and sine of a turn have one number in their names, as shifts have.
fn joints_of(variables: &[String]) -> Vec<Vec<usize>> {
    let mut joints: Vec<(&str, Vec<usize>)> = Vec::new();
    for (place, name) in variables.iter().enumerate() {
        let number = name.get(1..).unwrap_or_default();
        match joints.iter_mut().find(|(other, _)| *other == number) {
            Some((_, places)) => places.push(place),
            None => joints.push((number, vec![place])),
        }
    }
    joints.into_iter().map(|(_, places)| places).collect()
}

/// Places of the variables of an equation.
fn occurring(expressions: &Expressions, equation: NodeId) -> Vec<usize> {
    let nodes = below(expressions, &[equation]).into_iter();
    let place = |id: NodeId| match expressions.node(id) {
        Node::Variable(v) => Some(*v as usize),
        _ => None,
    };
    nodes.filter_map(place).collect()
}

/// Some equations of a system, in the variables that they have.
fn restricted(whole: &System, kept: &[usize], equations: &[usize]) -> System {
    let mut system = System {
        variables: kept.iter().map(|k| whole.variables[*k].clone()).collect(),
        groups: vec![VariableGroup {
            variables: (0..kept.len()).collect(),
            homogeneous: false,
        }],
        ..System::default()
    };
    let mut memory = Imported::default();
    for k in equations {
        let mut leaf = |e: &mut Expressions, leaf: &Node| match leaf {
            Node::Variable(v) => {
                let place = kept.iter().position(|place| *place == *v as usize);
                let place = place.expect("the equation has kept variables only");
                e.variable(u32::try_from(place).expect("variables are counted in 32 bits"))
            }
            _ => unreachable!("a system without parameters has no other leaves"),
        };
        let equation = whole.equations[*k];
        let copy = system
            .expressions
            .import(&whole.expressions, equation, &mut memory, &mut leaf);
        system.equations.push(copy);
        system.equation_names.push(whole.equation_names[*k].clone());
    }
    system
}

/// Derivatives of all equations at a point, a row for each.
fn derivatives(system: &System, point: &[Complex64]) -> Vec<Vec<Complex64>> {
    let moved = |place: usize, by: f64| {
        let mut point = point.to_vec();
        point[place] += by;
        evaluation::values(&system.expressions, &system.equations, &point, &[])
    };
    let column = |place: usize| -> Vec<Complex64> {
        let pairs = moved(place, DIFFERENCE)
            .into_iter()
            .zip(moved(place, -DIFFERENCE));
        pairs.map(|(a, b)| (a - b) / (2.0 * DIFFERENCE)).collect()
    };
    let columns: Vec<Vec<Complex64>> = (0..point.len()).map(column).collect();
    transposed(&columns)
}

fn transposed(columns: &[Vec<Complex64>]) -> Vec<Vec<Complex64>> {
    let rows = columns.first().map_or(0, Vec::len);
    let row = |k: usize| columns.iter().map(|column| column[k]).collect();
    (0..rows).map(row).collect()
}

/// The number of independent rows, by elimination of the largest entries.
fn rank(rows: &[Vec<Complex64>]) -> usize {
    let mut left: Vec<Vec<Complex64>> = rows.to_vec();
    let largest = |rows: &[Vec<Complex64>]| {
        let places = rows.iter().enumerate().flat_map(|(i, row)| {
            let entries = row.iter().enumerate();
            entries.map(move |(j, entry)| (entry.norm_sqr(), i, j))
        });
        places.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let Some((first, ..)) = largest(&left) else {
        return 0;
    };
    let mut rank = 0;
    while let Some((size, i, j)) = largest(&left) {
        if size <= INDEPENDENT * INDEPENDENT * first {
            break;
        }
        let pivot = left.swap_remove(i);
        for row in &mut left {
            let factor = row[j] / pivot[j];
            for (entry, above) in row.iter_mut().zip(&pivot) {
                *entry -= factor * above;
            }
        }
        rank += 1;
    }
    rank
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_systems::formats;

    /// Two bars of length 5 and one of length 1 join (0, 0) to (8, 1), and the distance that the third one keeps.
    const CHAIN: &str = "unknowns: c1, s1, c2, s2, c3, s3\n\
        c1^2 + s1^2 = 1\nc2^2 + s2^2 = 1\nc3^2 + s3^2 = 1\n\
        5*c1 + 5*c2 + c3 = 8\n5*s1 + 5*s2 + s3 = 1\n\
        (8 - 5*c1 - 5*c2)^2 + (1 - 5*s1 - 5*s2)^2 = 1\n";

    fn chain() -> (System, Vec<Complex64>) {
        let system = formats::read("test", CHAIN.as_bytes()).expect("equations");
        let position = [0.6, 0.8, 0.8, -0.6, 1.0, 0.0].map(Complex64::from);
        (system.system, position.to_vec())
    }

    #[test]
    fn the_joint_that_others_determine_is_left_out() {
        let (whole, position) = chain();
        let reduction = Reduction::of(&whole, &[&position], 1).expect("a reduction");
        assert_eq!(reduction.system.variables, ["c1", "s1", "c2", "s2"]);
        assert_eq!(reduction.system.equations.len(), 3);
        let image = reduction.image(&position);
        let values = evaluation::values(
            &reduction.system.expressions,
            &reduction.system.equations,
            &image,
            &[],
        );
        assert!(values.iter().all(|z| z.norm_sqr() < 1e-24), "{values:?}");
        assert!(reduction.determines(&image));
    }

    /// Without the equation of the distance nothing cuts the other joints to a curve.
    #[test]
    fn a_loop_whose_joints_all_matter_is_not_reduced() {
        let (mut whole, position) = chain();
        whole.equations.pop();
        whole.equation_names.pop();
        assert!(Reduction::of(&whole, &[&position], 1).is_none());
    }

    /// Where the coefficient of an unknown is 0, the others leave it open.
    #[test]
    fn an_unknown_that_is_left_open_is_not_determined() {
        let text = "unknowns: c1, s1, d2\nc1^2 + s1^2 = 1\ns1*d2 = c1 - 1\n";
        let whole = formats::read("test", text.as_bytes())
            .expect("equations")
            .system;
        let position = [0.6, 0.8, -0.5].map(Complex64::from).to_vec();
        let reduction = Reduction::of(&whole, &[&position], 1).expect("a reduction");
        assert_eq!(reduction.system.variables, ["c1", "s1"]);
        let crossing = [1.0, 0.0].map(Complex64::from);
        assert!(!reduction.determines(&crossing));
    }
}

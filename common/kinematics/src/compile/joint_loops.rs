//! Loops of joints in space and about a point, in cosine and sine of every turn and the displacement of every shift: all
//! configurations, exactly.
//!
//! A loop is cut in its middle: the product of one half is the inverse of the product of the other, entry by entry, so that
//! equations have half the degree, and the scheme is that of the loop.

use super::configurations::{DegreeIn, Motion, Placed, ROUNDED, TracedPoint, no_path};
use super::formulation::PathText;
use super::linkage_pose::{Branch, spanning_tree};
use super::near_number::{near_text, near_turn};
use super::planar::over_length;
use super::text::{self, Equations, TextPose};
use crate::mechanism::chain::{Chain, ChainJoint, JointValue};
use crate::mechanism::exact::{Number, expression};
use crate::mechanism::graph::is_rod;
use crate::mechanism::pose::Pose;
use crate::mechanism::{
    Joint, JointKind, Linkage, Mechanism, MechanismError, Space, Vector, link_name,
};
use cognate_numeric::rational::Rational;
use num_complex::Complex64;

/// A chain whose joints are all 0 closes within this, in parts of its size.
const CLOSES: f64 = 1e-9;

/// A motion, or a constant pose, and its inverse.
#[derive(Clone)]
struct Element {
    forward: TextPose,
    backward: TextPose,
    /// Whether it is a joint's.
    moves: bool,
    /// A point and the direction of the axis, where it is a turn.
    axis: Option<[[String; 3]; 2]>,
}

impl Element {
    fn inverse(&self) -> Self {
        Self {
            forward: self.backward.clone(),
            backward: self.forward.clone(),
            moves: self.moves,
            axis: self.axis.clone(),
        }
    }
}

fn inverted(elements: &[Element]) -> Vec<Element> {
    elements.iter().rev().map(Element::inverse).collect()
}

/// A line by a point x and its direction h, with x.x and x.h, which are written in fewer products than they seem to have.
#[derive(Clone)]
struct Line {
    point: [String; 3],
    direction: [String; 3],
    square: String,
    product: String,
}

/// Where the value of a joint stands among the unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// The place of the cosine; the sine is behind it.
    Turn(usize),
    /// The place of the displacement.
    Shift(usize),
}

/// Loops of fewer joints have equations of degree 2 anyway.
const FEWEST_WITH_INVARIANTS: usize = 5;

/// Equations in the making.
#[derive(Default)]
struct Loops {
    equations: Equations,
    variables: Vec<String>,
    circles: Vec<String>,
    values: Vec<(String, Place)>,
    /// Names of products that were taken.
    products: usize,
}

impl Loops {
    /// The cosine and sine of a turn.
    fn turn(&mut self, number: &str) -> [String; 2] {
        let names = [format!("c{number}"), format!("s{number}")];
        self.circles
            .push(format!("{}^2+{}^2-1", names[0], names[1]));
        self.variables.extend(names.iter().cloned());
        names
    }

    /// The displacement of a shift.
    fn shift(&mut self, number: &str) -> String {
        let name = format!("d{number}");
        self.variables.push(name.clone());
        name
    }

    fn product(&mut self, elements: &[Element]) -> TextPose {
        let mut pose = TextPose::constant(&Pose::IDENTITY);
        for element in elements {
            self.products += 1;
            let name = format!("m{}", self.products);
            pose = pose.then(&element.forward, &name, &mut self.equations);
        }
        pose
    }

    /// The product of these elements is the identity.
    fn close(&mut self, elements: &[Element], space: Space) {
        let joints = elements.iter().filter(|element| element.moves).count();
        let mut before = 0;
        let middle = elements.iter().position(|element| {
            before += usize::from(element.moves);
            before > joints.div_ceil(2)
        });
        let (first, second) = elements.split_at(middle.unwrap_or(elements.len()));
        let first = self.product(first);
        let second = self.product(&inverted(second));
        let rows = first.rotation.iter().zip(&second.rotation);
        let mut pairs: Vec<(String, String)> = rows
            .flat_map(|(a, b)| a.iter().cloned().zip(b.iter().cloned()))
            .collect();
        if space != Space::Spherical {
            pairs.extend(first.position.into_iter().zip(second.position));
        }
        for (a, b) in pairs.iter().filter(|(a, b)| a != b) {
            self.equations.equations.push(text::minus(a, b));
        }
        if space == Space::Spatial && joints >= FEWEST_WITH_INVARIANTS {
            self.add_invariants(elements);
        }
    }

    /// Equations of small degree that follow from the equations of a loop: seen from the third joint, the axis of the
    /// last one is where the first two joints put it, turned about the axis of the third (M. Raghavan, B. Roth 1993).
    /// The part that the turn leaves unchanged has degree 2. These equations keep the sets that equations cut small
    /// from the beginning.
    fn add_invariants(&mut self, elements: &[Element]) {
        let joints: Vec<usize> = (0..elements.len()).filter(|k| elements[*k].moves).collect();
        let (third, last) = (joints[2], joints[joints.len() - 1]);
        let (Some([origin, axis]), Some([point, direction])) =
            (&elements[third].axis, &elements[last].axis)
        else {
            return;
        };
        let line = Line {
            square: text::dot(point, point),
            product: text::dot(point, direction),
            point: point.clone(),
            direction: direction.clone(),
        };
        let mut near = line.clone();
        for element in elements[last + 1..].iter().chain(&elements[..third]) {
            near = self.moved(&near, &element.inverse());
        }
        let mut far = line;
        for element in elements[third + 1..last].iter().rev() {
            far = self.moved(&far, element);
        }
        let twice = |x: String| text::times("2", &x);
        let invariants = |line: &Line| {
            [
                text::dot(axis, &line.direction),
                text::dot(axis, &line.point),
                text::minus(&line.square, &twice(text::dot(origin, &line.point))),
                text::minus(&line.product, &text::dot(origin, &line.direction)),
            ]
        };
        for (a, b) in invariants(&near).iter().zip(&invariants(&far)) {
            if a != b {
                self.equations.equations.push(text::minus(a, b));
            }
        }
    }

    /// A line after an elementary motion: linear in its cosine and sine.
    fn moved(&mut self, line: &Line, element: &Element) -> Line {
        let Some([center, _]) = element.axis.as_ref().filter(|_| element.moves) else {
            return self.displaced(line, &element.forward.rotation, &element.forward.position);
        };
        let identity = TextPose::constant(&Pose::IDENTITY).rotation;
        let none = || ["0", "0", "0"].map(String::from);
        let back = center.each_ref().map(|x| negative(x));
        let line = self.displaced(line, &identity, &back);
        let line = self.displaced(&line, &element.forward.rotation, &none());
        self.displaced(&line, &identity, center)
    }

    fn displaced(&mut self, line: &Line, rotation: &[[String; 3]; 3], shift: &[String; 3]) -> Line {
        if shift.iter().all(|x| x == "0")
            && *rotation == TextPose::constant(&Pose::IDENTITY).rotation
        {
            return line.clone();
        }
        self.products += 1;
        let number = self.products;
        let equations = &mut self.equations;
        let turned: [String; 3] = std::array::from_fn(|i| {
            let turned = text::dot(&rotation[i], &line.point);
            equations.define(format!("x{number}_{i}"), turned)
        });
        let direction: [String; 3] = std::array::from_fn(|i| {
            let turned = text::dot(&rotation[i], &line.direction);
            equations.define(format!("h{number}_{i}"), turned)
        });
        let point = std::array::from_fn(|i| {
            let moved = text::sum(&[turned[i].clone(), shift[i].clone()]);
            equations.define(format!("y{number}_{i}"), moved)
        });
        // |R x + t|^2 = |x|^2 + 2 t.(R x) + t.t, and (R x + t).(R h) = x.h + t.(R h).
        let square = text::sum(&[
            line.square.clone(),
            text::times("2", &text::dot(shift, &turned)),
            text::dot(shift, shift),
        ]);
        let product = text::sum(&[line.product.clone(), text::dot(shift, &direction)]);
        Line {
            point,
            direction,
            square: equations.define(format!("n{number}"), square),
            product: equations.define(format!("p{number}"), product),
        }
    }

    /// The point of a pose, whose path is asked for.
    fn path(&mut self, pose: &TextPose, point: &Vector) -> PathText {
        PathText {
            coordinates: pose.point(&text::exact_vector(point)).to_vec(),
            denominator: "1".into(),
            is_linear: false,
        }
    }

    fn finish(mut self, home: Option<Vec<f64>>, path: Option<PathText>, rounds: bool) -> Motion {
        self.circles.append(&mut self.equations.equations);
        self.equations.equations = self.circles;
        self.equations.groups = vec![self.variables];
        let values = self.values;
        Motion {
            equations: self.equations,
            degree_in: DegreeIn::Joints,
            home,
            path,
            warnings: match rounds {
                true => vec![ROUNDED.into()],
                false => Vec::new(),
            },
            placing: Box::new(move |solution: &[Complex64]| {
                let value = |(name, place): &(String, Place)| {
                    let value = match *place {
                        Place::Turn(k) => JointValue::Turn(solution[k], solution[k + 1]),
                        Place::Shift(k) => JointValue::Shift(solution[k]),
                    };
                    (name.clone(), value)
                };
                Some(Placed::Joints(values.iter().map(value).collect()))
            }),
        }
    }
}

/// The unknowns where nothing is turned or shifted.
fn at_zero(variables: &[String]) -> Vec<f64> {
    let value = |name: &String| f64::from(name.starts_with('c'));
    variables.iter().map(value).collect()
}

/// All configurations of a closed chain.
pub(super) fn of_chain(
    mechanism: &Mechanism,
    chain: &Chain,
    traced: Option<&TracedPoint>,
) -> Result<Motion, MechanismError> {
    let mut loops = Loops::default();
    let mut exact = true;
    let mut elements = vec![constant(&chain.base, &mut exact)];
    for (k, joint) in chain.joints.iter().enumerate() {
        let number = format!("{}", k + 1);
        let place = loops.variables.len();
        let [motion, back] = if joint.is_angle {
            loops.values.push((joint.name.clone(), Place::Turn(place)));
            let [c, s] = loops.turn(&number);
            [s.clone(), format!("(-{s})")].map(|sine| TextPose::about_z(&c, &sine))
        } else {
            loops.values.push((joint.name.clone(), Place::Shift(place)));
            let d = loops.shift(&number);
            let along = |d: String| TextPose::shift(["0".into(), "0".into(), d]);
            [along(d.clone()), along(format!("(-{d})"))]
        };
        elements.push(Element {
            forward: motion,
            backward: back,
            moves: true,
            axis: joint.is_angle.then(|| {
                let z_axis = [["0", "0", "0"], ["0", "0", "1"]];
                z_axis.map(|vector| vector.map(String::from))
            }),
        });
        elements.push(row(joint, &mut exact));
    }
    elements.push(constant(&chain.tool, &mut exact));
    elements.retain(|element| element.moves || !is_identity(&element.forward));
    let path = traced.map(|traced| {
        let link = (1..chain.joints.len()).position(|k| link_name(k) == traced.link);
        let link = link.ok_or_else(|| no_path(mechanism, traced))?;
        let moving = elements.iter().enumerate().filter(|(_, e)| e.moves);
        // The link after a joint ends before the next joint.
        let end = moving.map(|(place, _)| place).nth(link + 1);
        let pose = loops.product(&elements[..end.unwrap_or(elements.len())]);
        Ok(loops.path(&pose, &traced.point))
    });
    let path = path.transpose()?;
    loops.close(&elements, mechanism.space);
    let zero: Vec<JointValue> = chain
        .joints
        .iter()
        .map(|joint| JointValue::of_real(0.0, joint.is_angle))
        .collect();
    let gap = chain
        .tool_pose(&zero)
        .distance(&Pose::IDENTITY, chain.size());
    let home = (gap < CLOSES).then(|| at_zero(&loops.variables));
    Ok(loops.finish(home, path, !exact))
}

fn is_identity(pose: &TextPose) -> bool {
    *pose == TextPose::constant(&Pose::IDENTITY)
}

/// Element behind the motion of a row: Rz(theta) Tz(d) Tx(a) Rx(alpha).
fn row(joint: &ChainJoint, exact: &mut bool) -> Element {
    let mut number = |x: f64| {
        let (text, is_short) = near_text(x);
        *exact &= is_short;
        text
    };
    let (a, d) = (number(joint.a), number(joint.d));
    let ([ct, st], is_theta) = near_turn(&joint.theta);
    let ([ca, sa], is_alpha) = near_turn(&joint.alpha);
    *exact &= is_theta && is_alpha;
    let rotation = [
        [
            ct.clone(),
            negative(&text::times(&st, &ca)),
            text::times(&st, &sa),
        ],
        [
            st.clone(),
            text::times(&ct, &ca),
            negative(&text::times(&ct, &sa)),
        ],
        ["0".into(), sa, ca],
    ];
    fixed(TextPose {
        rotation,
        position: [text::times(&a, &ct), text::times(&a, &st), d],
    })
}

fn negative(text: &str) -> String {
    match text {
        "0" => "0".into(),
        text => text::minus("0", text),
    }
}

/// A constant pose with its inverse.
fn fixed(pose: TextPose) -> Element {
    let rotation: [[String; 3]; 3] = std::array::from_fn(|i| pose.column(i));
    let position = std::array::from_fn(|i| negative(&text::dot(&rotation[i], &pose.position)));
    Element {
        backward: TextPose { rotation, position },
        forward: pose,
        moves: false,
        axis: None,
    }
}

/// A constant pose of which doubles are kept.
fn constant(pose: &Pose, exact: &mut bool) -> Element {
    let mut number = |x: f64| {
        let (text, is_short) = near_text(x);
        *exact &= is_short;
        text
    };
    fixed(TextPose {
        rotation: pose.rotation.map(|row| row.map(|c| number(c.re))),
        position: pose.position.map(|c| number(c.re)),
    })
}

/// All configurations of links and joints.
pub(super) fn of_linkage(
    mechanism: &Mechanism,
    linkage: &Linkage,
    traced: Option<&TracedPoint>,
) -> Result<Motion, MechanismError> {
    if !linkage.at_home {
        return Err(mechanism.error(
            "not in this version: motion of joints in the coordinates of their links; write them in a home position, or as \"loop\"",
        ));
    }
    let rods: Vec<usize> = (0..linkage.links.len())
        .filter(|link| mechanism.space == Space::Spatial && is_rod(linkage, *link))
        .collect();
    let tree = spanning_tree(linkage, &[], &rods);
    let reached = |link: usize| link == linkage.ground || tree.iter().any(|b| b.links[1] == link);
    if let Some(link) = (0..linkage.links.len()).find(|l| !reached(*l) && !rods.contains(l)) {
        return Err(mechanism.error(format!(
            "not in this version: link {} hangs on balls or rods alone; say a platform on legs as \"platform\"",
            linkage.links[link]
        )));
    }
    let mut loops = Loops::default();
    let mut motions = Vec::new();
    for (j, joint) in linkage.joints.iter().enumerate() {
        motions.push(joint_elements(mechanism, linkage, j, joint, &mut loops)?);
    }
    let mut links: Vec<Vec<Element>> = vec![Vec::new(); linkage.links.len()];
    let mut ways: Vec<Vec<usize>> = vec![Vec::new(); linkage.links.len()];
    for branch in &tree {
        let Branch {
            joint,
            links: [near, far],
            is_reversed,
        } = *branch;
        let motion = match is_reversed {
            true => inverted(&motions[joint]),
            false => motions[joint].clone(),
        };
        links[far] = links[near].iter().cloned().chain(motion).collect();
        ways[far] = ways[near].iter().copied().chain([joint]).collect();
    }
    let path = traced.map(|traced| {
        let link = linkage.links.iter().position(|name| *name == traced.link);
        let link = link.filter(|link| !rods.contains(link));
        let link = link.ok_or_else(|| no_path(mechanism, traced))?;
        let pose = loops.product(&links[link]);
        Ok(loops.path(&pose, &traced.point))
    });
    let path = path.transpose()?;
    for (j, joint) in linkage.joints.iter().enumerate() {
        let is_cut = !tree.iter().any(|branch| branch.joint == j);
        if !is_cut || joint.links.iter().any(|link| rods.contains(link)) {
            continue;
        }
        let [a, b] = joint.links;
        let same = ways[a].iter().zip(&ways[b]).take_while(|(x, y)| x == y);
        let shared: usize = same.map(|(x, _)| motions[*x].len()).sum();
        if joint.kind == JointKind::S {
            let places = [a, b].map(|link| {
                let pose = loops.product(&links[link][shared..]);
                pose.point(&text::exact_vector(&joint.sides[0].point))
            });
            let [p, q] = places;
            for (x, y) in p.iter().zip(&q).filter(|(x, y)| x != y) {
                loops.equations.equations.push(text::minus(x, y));
            }
            continue;
        }
        let mut elements = links[a][shared..].to_vec();
        elements.extend(motions[j].iter().cloned());
        elements.extend(inverted(&links[b][shared..]));
        loops.close(&elements, mechanism.space);
    }
    for rod in rods {
        rod_equation(linkage, rod, &links, &mut loops);
    }
    let home = at_zero(&loops.variables);
    Ok(loops.finish(Some(home), path, false))
}

/// Two balls of a rod keep their distance at home.
fn rod_equation(linkage: &Linkage, rod: usize, links: &[Vec<Element>], loops: &mut Loops) {
    let joints = linkage.joints_of(rod);
    let points = [0, 1].map(|k| text::exact_vector(&linkage.joints[joints[k]].sides[0].point));
    let ends = [0, 1].map(|k| {
        let joint = &linkage.joints[joints[k]];
        let link = joint.links[usize::from(joint.links[0] == rod)];
        loops.product(&links[link]).point(&points[k])
    });
    let square = |p: &[String; 3], q: &[String; 3]| {
        let away: [String; 3] = std::array::from_fn(|i| text::minus(&p[i], &q[i]));
        text::dot(&away, &away)
    };
    let [near, far] = &ends;
    let equation = text::minus(&square(near, far), &square(&points[0], &points[1]));
    loops.equations.equations.push(equation);
}

/// The motion of a joint from its first link to its second, in the home position.
fn joint_elements(
    mechanism: &Mechanism,
    linkage: &Linkage,
    j: usize,
    joint: &Joint,
    loops: &mut Loops,
) -> Result<Vec<Element>, MechanismError> {
    let side = &joint.sides[0];
    let number = j + 1;
    let place = loops.variables.len();
    let parts: Vec<(&Vector, bool)> = match (joint.kind, &side.second) {
        (JointKind::S, _) => return Ok(Vec::new()),
        (JointKind::R, _) => vec![(&side.axis, true)],
        (JointKind::P, _) => vec![(&side.axis, false)],
        (JointKind::C, _) => vec![(&side.axis, true), (&side.axis, false)],
        (JointKind::U, Some(second)) => vec![(&side.axis, true), (second, true)],
        (kind, _) => {
            return Err(mechanism.error(format!(
                "not in this version: motion with joint {} of type {}; write it as R and P joints",
                joint.name,
                kind.letter()
            )));
        }
    };
    let mut elements = Vec::new();
    for (e, (axis, turns)) in parts.iter().enumerate() {
        let name = match parts.len() {
            1 => format!("{number}"),
            _ => format!("{number}_{}", e + 1),
        };
        let unit = UnitAxis::of(axis);
        let [forward, backward] = if *turns {
            let [c, s] = loops.turn(&name);
            [s.clone(), format!("(-{s})")].map(|sine| unit.turn(&side.point, &c, &sine))
        } else {
            let d = loops.shift(&name);
            [d.clone(), format!("(-{d})")].map(|d| unit.shift(&d))
        };
        elements.push(Element {
            forward,
            backward,
            moves: true,
            axis: turns.then(|| [text::exact_vector(&side.point), unit.along.clone()]),
        });
    }
    match joint.kind {
        JointKind::R => loops.values.push((joint.name.clone(), Place::Turn(place))),
        JointKind::P => loops.values.push((joint.name.clone(), Place::Shift(place))),
        _ => {}
    }
    // At the ground a value is that of the other link.
    Ok(match joint.links[1] == linkage.ground {
        true => inverted(&elements),
        false => elements,
    })
}

/// The unit vector of an axis, as text.
struct UnitAxis {
    /// Coordinates of the unit vector.
    along: [String; 3],
    /// Products of two coordinates, and those products taken from the identity.
    products: [[[String; 2]; 3]; 3],
}

impl UnitAxis {
    fn of(axis: &Vector) -> Self {
        let texts = text::exact_vector(axis);
        let over = over_length(&axis.iter().collect::<Vec<_>>());
        let over = over.unwrap_or_else(|| format!("(1/sqrt({}))", text::dot(&texts, &texts)));
        let along = texts.map(|x| text::times(&x, &over));
        let rational = |number: &Number| {
            let surd = number.surd.as_deref().filter(|surd| surd.radicand == 1);
            surd.map(|surd| surd.coefficient.clone())
        };
        let numbers: Option<Vec<Rational>> = axis.iter().map(rational).collect();
        let square = numbers.as_ref().map(|numbers| {
            let squares = numbers.iter().map(|x| Rational::from(x * x));
            squares.fold(Rational::new(), |sum, x| sum + x)
        });
        let products = std::array::from_fn(|i| {
            std::array::from_fn(|j| match (&numbers, &square) {
                (Some(numbers), Some(square)) => {
                    let product = Rational::from(&numbers[i] * &numbers[j]) / square;
                    let rest = Rational::from(u32::from(i == j)) - &product;
                    [expression(&product), expression(&rest)]
                }
                _ => {
                    let product = text::times(&along[i], &along[j]);
                    let rest = text::minus(if i == j { "1" } else { "0" }, &product);
                    [product, rest]
                }
            })
        });
        Self { along, products }
    }

    /// I + s K + (1 - c) K^2 about a point, where K x is the product of the unit vector and x.
    fn turn(&self, point: &Vector, c: &str, s: &str) -> TextPose {
        let entry = |i: usize, j: usize| {
            let [product, rest] = &self.products[i][j];
            let odd = match (3 + j - i) % 3 {
                0 => "0".to_owned(),
                1 => negative(&text::times(&self.along[3 - i - j], s)),
                _ => text::times(&self.along[3 - i - j], s),
            };
            text::sum(&[product.clone(), text::times(rest, c), odd])
        };
        let rotation: [[String; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let point = text::exact_vector(point);
        let position = std::array::from_fn(|i| {
            let turned = text::dot(&rotation[i], &point);
            match turned == point[i] {
                true => "0".into(),
                false => text::minus(&point[i], &turned),
            }
        });
        TextPose { rotation, position }
    }

    fn shift(&self, d: &str) -> TextPose {
        TextPose::shift(self.along.each_ref().map(|x| text::times(x, d)))
    }
}

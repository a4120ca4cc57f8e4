//! Links and joints as a graph: adjacency, independent loops, Gruebler's number, idle freedoms.

use super::chain::Chain;
use super::pose::cross;
use super::{
    Body, Framework, Joint, JointKind, LegKind, Linkage, Mechanism, PLATFORM, Platform, link_name,
};

/// A joint of the graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The joint's name.
    pub name: String,
    /// Type of the joint.
    pub kind: JointKind,
    /// The two links, by number.
    pub links: [usize; 2],
}

/// Links, and the joints between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Graph {
    /// Names of the links; the first is the ground.
    pub links: Vec<String>,
    /// The joints.
    pub joints: Vec<Edge>,
    /// Links whose spin leaves all others where they are.
    pub idle: i64,
}

impl Graph {
    /// Freedoms by counting: lambda (n - 1) - sum (lambda - f).
    pub fn gruebler(&self, freedoms: i64) -> i64 {
        let lost: i64 = self
            .joints
            .iter()
            .map(|j| freedoms - j.kind.freedoms())
            .sum();
        freedoms * (self.links.len() as i64 - 1) - lost
    }

    /// Independent loops.
    pub fn loops(&self) -> i64 {
        self.joints.len() as i64 - self.links.len() as i64 + 1
    }

    /// Letters of the joints between every two links; `-` where there is none.
    pub fn adjacency(&self) -> Vec<Vec<String>> {
        let n = self.links.len();
        let mut rows = vec![vec![String::new(); n]; n];
        for joint in &self.joints {
            let [a, b] = joint.links;
            rows[a][b].push_str(joint.kind.letter());
            rows[b][a].push_str(joint.kind.letter());
        }
        for row in &mut rows {
            for cell in row.iter_mut().filter(|cell| cell.is_empty()) {
                cell.push('-');
            }
        }
        rows
    }

    fn link(&mut self, name: String) -> usize {
        self.links.push(name);
        self.links.len() - 1
    }

    fn join(&mut self, name: String, kind: JointKind, a: usize, b: usize) {
        self.joints.push(Edge {
            name,
            kind,
            links: [a, b],
        });
    }
}

impl Mechanism {
    /// The graph of links and joints.
    pub fn graph(&self) -> Graph {
        match &self.body {
            Body::Linkage(linkage) => of_linkage(linkage),
            Body::Chain(chain) => of_chain(chain),
            Body::Platform(platform) => of_platform(platform, self.space == super::Space::Planar),
            Body::Framework(framework) => of_framework(framework),
        }
    }

    /// Freedoms by counting, with idle ones; `None` where parallelograms keep an orientation, of which
    /// counting knows nothing.
    pub fn gruebler(&self) -> Option<i64> {
        match &self.body {
            Body::Platform(platform) if platform.fixed_orientation => None,
            _ => Some(self.graph().gruebler(self.space.freedoms())),
        }
    }

    /// Freedoms by counting, without idle ones.
    pub fn expected_mobility(&self) -> Option<i64> {
        match &self.body {
            // A point on legs: a leg's rod takes one freedom of three, its drive gives it back.
            Body::Platform(platform) if platform.fixed_orientation => {
                let fixed = platform.legs.iter().filter(|leg| !leg.is_driven()).count();
                Some(3 - fixed as i64)
            }
            _ => self.gruebler().map(|m| m - self.graph().idle),
        }
    }
}

impl Linkage {
    /// A link that no way of joints leads to from the ground.
    pub fn unreached(&self) -> Option<usize> {
        let mut reached = vec![false; self.links.len()];
        let mut open = vec![self.ground];
        reached[self.ground] = true;
        while let Some(link) = open.pop() {
            for joint in &self.joints {
                for (from, to) in [(0, 1), (1, 0)] {
                    let next = joint.links[to];
                    if joint.links[from] == link && !reached[next] {
                        reached[next] = true;
                        open.push(next);
                    }
                }
            }
        }
        reached.iter().position(|r| !r)
    }

    /// The joints of a link.
    pub fn joints_of(&self, link: usize) -> Vec<usize> {
        let at = |j: &usize| self.joints[*j].links.contains(&link);
        (0..self.joints.len()).filter(at).collect()
    }
}

/// Whether a moving link has two balls and nothing else.
pub fn is_rod(linkage: &Linkage, link: usize) -> bool {
    let joints = linkage.joints_of(link);
    link != linkage.ground
        && joints.len() == 2
        && joints
            .iter()
            .all(|j| linkage.joints[*j].kind == JointKind::S)
}

fn side_of(joint: &Joint, link: usize) -> usize {
    usize::from(joint.links[1] == link)
}

/// Whether two moving links form a strut S-P-S, S-R-S or S-C-S of which the axis passes both balls.
fn is_strut(linkage: &Linkage, joint: &Joint) -> bool {
    let is_kind = matches!(joint.kind, JointKind::P | JointKind::R | JointKind::C);
    if !is_kind || joint.links.contains(&linkage.ground) {
        return false;
    }
    let number = |v: &super::Vector| [v[0].to_f64(), v[1].to_f64(), v[2].to_f64()];
    joint.links.iter().all(|&link| {
        let others: Vec<usize> = linkage.joints_of(link);
        let ball = others
            .iter()
            .map(|j| &linkage.joints[*j])
            .find(|j| j.name != joint.name);
        let Some(ball) = ball.filter(|b| others.len() == 2 && b.kind == JointKind::S) else {
            return false;
        };
        let here = &joint.sides[side_of(joint, link)];
        let there = &ball.sides[side_of(ball, link)];
        let (axis, from, to) = (
            number(&here.axis),
            number(&here.point),
            number(&there.point),
        );
        if joint.kind == JointKind::P && linkage.at_home {
            // Of a shift only the direction counts: it is along the line between the balls, see below.
            return true;
        }
        let off = cross(axis, std::array::from_fn(|k| to[k] - from[k]));
        off.iter().all(|c| c.abs() < 1e-12)
    }) && strut_is_straight(linkage, joint)
}

/// Of a shift in the home position: its direction is that between the two balls.
fn strut_is_straight(linkage: &Linkage, joint: &Joint) -> bool {
    if joint.kind != JointKind::P || !linkage.at_home {
        return true;
    }
    let ends: Vec<[f64; 3]> = joint
        .links
        .iter()
        .filter_map(|&link| {
            let others = linkage.joints_of(link);
            let ball = others
                .iter()
                .map(|j| &linkage.joints[*j])
                .find(|j| j.name != joint.name)?;
            let p = &ball.sides[0].point;
            Some([p[0].to_f64(), p[1].to_f64(), p[2].to_f64()])
        })
        .collect();
    let [a, b] = &ends[..] else { return false };
    let axis = &joint.sides[0].axis;
    let axis = [axis[0].to_f64(), axis[1].to_f64(), axis[2].to_f64()];
    let off = cross(axis, std::array::from_fn(|k| b[k] - a[k]));
    off.iter().all(|c| c.abs() < 1e-9)
}

fn of_linkage(linkage: &Linkage) -> Graph {
    // The ground first.
    let mut order: Vec<usize> = (0..linkage.links.len()).collect();
    order.retain(|l| *l != linkage.ground);
    order.insert(0, linkage.ground);
    let place = |link: usize| order.iter().position(|l| *l == link).unwrap_or(0);
    let mut graph = Graph {
        links: order.iter().map(|l| linkage.links[*l].clone()).collect(),
        ..Graph::default()
    };
    for joint in &linkage.joints {
        let [a, b] = joint.links.map(place);
        graph.join(joint.name.clone(), joint.kind, a, b);
    }
    let rods = (0..linkage.links.len())
        .filter(|l| is_rod(linkage, *l))
        .count();
    let struts = linkage
        .joints
        .iter()
        .filter(|j| is_strut(linkage, j))
        .count();
    graph.idle = (rods + struts) as i64;
    graph
}

fn of_chain(chain: &Chain) -> Graph {
    let n = chain.joints.len();
    let moving = if chain.closed { n - 1 } else { n };
    let mut graph = Graph::default();
    graph.link("ground".into());
    for i in 1..=moving {
        graph.link(link_name(i));
    }
    for (i, joint) in chain.joints.iter().enumerate() {
        let kind = if joint.is_angle {
            JointKind::R
        } else {
            JointKind::P
        };
        let next = if chain.closed && i + 1 == n { 0 } else { i + 1 };
        graph.join(joint.name.clone(), kind, i, next);
    }
    graph
}

fn of_platform(platform: &Platform, planar: bool) -> Graph {
    let mut graph = Graph::default();
    let base = graph.link("base".into());
    let body = graph.link(PLATFORM.into());
    let ball = if planar { JointKind::R } else { JointKind::S };
    for leg in &platform.legs {
        let name = |part: &str| format!("{} {part}", leg.name);
        let (foot, driven) = match &leg.kind {
            LegKind::Strut {
                length: Some(_), ..
            } => {
                let bar = graph.link(name("bar"));
                graph.join(name("foot"), ball, base, bar);
                graph.join(name("head"), ball, bar, body);
                graph.idle += i64::from(!planar);
                continue;
            }
            LegKind::Strut { held, .. } => {
                let foot = match (planar, held) {
                    (true, _) => JointKind::R,
                    (false, true) => JointKind::U,
                    (false, false) => JointKind::S,
                };
                graph.idle += i64::from(!planar && !held);
                let lower = graph.link(name("lower"));
                let upper = graph.link(name("upper"));
                graph.join(name("foot"), foot, base, lower);
                graph.join(leg.name.clone(), JointKind::P, lower, upper);
                graph.join(name("head"), ball, upper, body);
                continue;
            }
            LegKind::Crank { .. } => ("crank", JointKind::R),
            LegKind::Slider { .. } => ("slider", JointKind::P),
        };
        let first = graph.link(name(foot));
        let rod = graph.link(name("rod"));
        graph.join(leg.name.clone(), driven, base, first);
        graph.join(name("knee"), ball, first, rod);
        graph.join(name("head"), ball, rod, body);
        graph.idle += i64::from(!planar);
    }
    graph
}

/// Bars are links; where k bars meet are k - 1 joints. The fixed bar is the ground.
fn of_framework(framework: &Framework) -> Graph {
    let mut bars: Vec<&super::Bar> = framework.bars.iter().collect();
    let [a, b] = framework.fixed;
    let is_fixed = |bar: &&super::Bar| bar.between == [a, b] || bar.between == [b, a];
    if let Some(place) = bars.iter().position(is_fixed) {
        bars.swap(0, place);
    }
    let mut graph = Graph::default();
    for bar in &bars {
        let [a, b] = bar.between;
        graph.link(format!("{}-{}", framework.points[a], framework.points[b]));
    }
    for (point, name) in framework.points.iter().enumerate() {
        let meeting: Vec<usize> = (0..bars.len())
            .filter(|i| bars[*i].between.contains(&point))
            .collect();
        for (k, link) in meeting.iter().enumerate().skip(1) {
            let joint = if meeting.len() == 2 {
                name.clone()
            } else {
                format!("{name}.{k}")
            };
            graph.join(joint, JointKind::R, meeting[0], *link);
        }
    }
    graph
}

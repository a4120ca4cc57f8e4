//! Decompositions against known components: dimensions, degrees, multiplicities and counts, several seeds each.
//!
//! `SEEDS=30 cargo test -p cognate-tests --test decomposition` takes more seeds than the three of every run.

mod carried;
mod symmetry;

use cognate_algorithms::Root;
use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, run_locally};
use cognate_algorithms::run_locally::drive;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::Work;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_protocol::digest;
use cognate_solutions::witness::{Decomposition, Method};
use cognate_systems::system::System;
use cognate_tests::systems::{shared, written};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

/// Dimension, degree, multiplicity and how many there are of them.
type Expected = (u32, u64, u64, u64);

/// The system in `tests/decomposition/systems/NAME`, or among those that other tests solve.
fn instance(name: &str) -> System {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("decomposition/systems");
    match std::fs::read(folder.join(name).join("system.bertini")) {
        Ok(content) => match cognate_systems::formats::read(name, &content) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        },
        Err(_) => shared(name),
    }
}

fn decompose(system: &System, seed: u64) -> Decomposition {
    decompose_by(system, seed, None)
}

/// By one way; `None`: by the one that is chosen.
fn decompose_by(system: &System, seed: u64, method: Option<Method>) -> Decomposition {
    let options = DecompositionOptions {
        seed,
        method,
        ..DecompositionOptions::default()
    };
    let solve = match DecompositionSolve::new(system, &options) {
        Ok(solve) => solve,
        Err(error) => panic!("{error}"),
    };
    match run_locally(solve, 8) {
        Ok(decomposition) => decomposition,
        Err(error) => panic!("{error}"),
    }
}

/// The components by dimension, degree and multiplicity.
fn counted(decomposition: &Decomposition) -> Vec<Expected> {
    let mut counts: BTreeMap<(u32, u64, u64), u64> = BTreeMap::new();
    for set in &decomposition.components {
        let scheme = set.multiplicity.scheme.unwrap_or(0);
        *counts
            .entry((set.dimension(), set.degree, scheme))
            .or_default() += 1;
    }
    let counts = counts.into_iter().rev();
    counts.map(|((a, b, c), count)| (a, b, c, count)).collect()
}

/// Doubts of a decomposition, in words.
fn doubts(decomposition: &Decomposition) -> String {
    let mut text = String::new();
    for dimension in &decomposition.dimensions {
        if !dimension.doubts.is_empty() {
            let _ = write!(
                text,
                " dimension {}: {:?};",
                dimension.number, dimension.doubts
            );
        }
    }
    for set in &decomposition.components {
        if !set.evidence.doubts.is_empty() {
            let _ = write!(
                text,
                " {} of degree {}: {:?};",
                set.id, set.degree, set.evidence.doubts
            );
        }
    }
    text
}

/// Checks three seeds, or as many as the variable says; none may be wrong, and none unsettled.
fn check(name: &str, system: &System, expected: &[Expected]) {
    let seeds = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    let mut expected = expected.to_vec();
    expected.sort_by(|a, b| b.cmp(a));
    let mut report = String::new();
    for seed in 1..=seeds.unwrap_or(3u64) {
        let began = Instant::now();
        let decomposition = decompose(system, seed);
        let (counts, settled) = (counted(&decomposition), decomposition.settled());
        let (paths, loops) = (
            decomposition.paths.total,
            decomposition.paths_of_loops.total,
        );
        eprintln!(
            "{name}, seed {seed}: {counts:?}, settled {settled}, {paths} + {loops} paths, {:.2} s{}",
            began.elapsed().as_secs_f64(),
            doubts(&decomposition)
        );
        if settled && counts != expected {
            let _ = write!(report, "\n{name}, seed {seed}: wrong: {counts:?}");
        } else if !settled {
            let _ = write!(
                report,
                "\n{name}, seed {seed}: unsettled: {counts:?}{}",
                doubts(&decomposition)
            );
        }
        if !decomposition.adds_up() {
            let _ = write!(
                report,
                "\n{name}, seed {seed}: counts do not add up: {:?}",
                decomposition.dimensions
            );
        }
    }
    assert!(report.is_empty(), "{report}");
}

macro_rules! instances {
    ($($name:ident: $expected:expr;)*) => {$(
        #[test]
        fn $name() {
            check(stringify!($name), &instance(stringify!($name)), &$expected);
        }
    )*};
}

instances! {
    twisted_cubic: [(1, 3, 1, 1)];
    nid_illustrative: [(2, 2, 1, 1), (1, 3, 1, 1), (1, 1, 1, 3), (0, 1, 1, 1)];
    sphere_and_curves: [(2, 2, 1, 1), (1, 3, 1, 1), (1, 1, 1, 4)];
    sphere_line_point: [(2, 2, 1, 1), (1, 1, 1, 1), (0, 1, 1, 1)];
    quadric_rulings: [(1, 2, 1, 2)];
    viviani: [(1, 4, 1, 1)];
    commuting_2x2: [(6, 3, 1, 1)];
    adjacent_minors_2x4: [(5, 4, 1, 1), (5, 2, 1, 2)];
    adjacent_minors_2x5: [(6, 5, 1, 1), (6, 4, 1, 1), (6, 3, 1, 2), (6, 1, 1, 1)];
    adjacent_minors_2x9: [
        (10, 16, 1, 1), (10, 15, 1, 2), (10, 12, 1, 5), (10, 9, 1, 4), (10, 8, 1, 6),
        (10, 7, 1, 2), (10, 5, 1, 3), (10, 4, 1, 6), (10, 3, 1, 4), (10, 1, 1, 1)
    ];
    cyclic_4: [(1, 2, 1, 2)];
    conic_p1p2: [(1, 3, 1, 1)];
    double_line: [(1, 1, 2, 1)];
    double_conic_and_line: [(2, 1, 1, 1), (1, 2, 2, 2)];
    embedded_line: [(2, 1, 1, 2)];
    fat_parabola: [(1, 2, 3, 1)];
    jets_a3: [(4, 4, 2, 1), (4, 4, 1, 2)];
    permanents_2x4: [(4, 1, 1, 2), (3, 2, 1, 6)];
    grid_of_300_lines: [(1, 1, 1, 300)];
    kinematotropic: [(2, 4, 1, 1), (1, 2, 1, 2)];
    bennett_b: [(1, 4, 1, 1)];
    four_bar_loop_grashof: [(1, 6, 1, 1)];
    four_bar_parallelogram: [(1, 4, 1, 1), (1, 2, 1, 1)];
    four_bar_sextic: [(1, 6, 1, 1)];
    quadrifolium: [(1, 6, 1, 1)];
    real_acnode: [(1, 3, 1, 1)];
    real_cubic: [(1, 3, 1, 1)];
    seven_bar_roberts: [(1, 6, 1, 1), (0, 1, 1, 6)];
}

/// The matrices of rank 1 are a cone. Whether its apex is a point of it is not settled with every seed; it
/// is then a doubt about dimension 0, and nothing else.
#[test]
fn rank_one_3x3() {
    for seed in 1..=3 {
        let decomposition = decompose(&instance("rank_one_3x3"), seed);
        assert_eq!(counted(&decomposition), [(5, 6, 1, 1)], "seed {seed}");
        let component = &decomposition.components[0];
        assert!(
            component.settled(),
            "seed {seed}: {}",
            doubts(&decomposition)
        );
        let in_doubt = decomposition
            .dimensions
            .iter()
            .filter(|d| !d.doubts.is_empty());
        let in_doubt: Vec<u32> = in_doubt.map(|d| d.number).collect();
        assert_eq!(decomposition.settled(), in_doubt.is_empty(), "seed {seed}");
        assert!(in_doubt.iter().all(|&number| number == 0), "seed {seed}");
    }
}

/// A path ends on the sphere, 400 from the origin and 1e-10 of that beside it, where the equations are regular; on it
/// they are not, and it is no point of a curve.
#[test]
fn an_end_beside_a_surface_is_no_witness_point() {
    let system = instance("sphere_and_curves");
    let decomposition = decompose_by(&system, 14, Some(Method::Equations));
    assert!(
        decomposition.settled() && decomposition.adds_up(),
        "{}",
        doubts(&decomposition)
    );
    assert_eq!(
        counted(&decomposition),
        [(2, 2, 1, 1), (1, 3, 1, 1), (1, 1, 1, 4)]
    );
}

/// The union of a quadric surface, `lines` lines and `points` points with random small coefficients, by the
/// products of one equation of each.
fn planted_union(lines: usize, points: usize, number: u64) -> System {
    let mut random = RandomStream::new(number, Purpose::Test, 20);
    let mut plane = || {
        let mut c = || random.below(19) as i64 - 9;
        let constant = 2 * c() + 1;
        format!(
            "(({})*x + ({})*y + ({})*z + ({constant}))",
            c(),
            c(),
            2 * c() + 1
        )
    };
    let mut products = vec![format!("({}*{} + {})", plane(), plane(), plane())];
    let sets = std::iter::repeat_n(2, lines).chain(std::iter::repeat_n(3, points));
    for codimension in sets {
        let factors: Vec<String> = (0..codimension).map(|_| plane()).collect();
        let pairs = products.iter();
        let pairs = pairs.flat_map(|p| factors.iter().map(move |f| format!("{p}*{f}")));
        products = pairs.collect();
    }
    let names: Vec<String> = (1..=products.len()).map(|k| format!("f{k}")).collect();
    let lines = names.iter().zip(&products);
    let lines: Vec<String> = lines.map(|(f, p)| format!("{f} = {p};")).collect();
    written(&format!(
        "variable_group x, y, z; function {}; {}",
        names.join(", "),
        lines.join(" ")
    ))
}

#[test]
fn unions_of_a_quadric_lines_and_points() {
    for number in 1..=6 {
        let (lines, points) = (number % 3, number % 2);
        let mut expected = vec![(2, 2, 1, 1)];
        expected.extend((lines > 0).then_some((1, 1, 1, lines)));
        expected.extend((points > 0).then_some((0, 1, 1, points)));
        let system = planted_union(lines as usize, points as usize, number);
        check(&format!("union {number}"), &system, &expected);
    }
}

#[test]
fn without_solutions_there_are_no_components() {
    check(
        "nothing",
        &written("variable_group x, y; function f, g; f = x*y - 1; g = x*y - 2;"),
        &[],
    );
}

#[test]
fn isolated_points_are_components() {
    let system = written("variable_group x, y; function f, g; f = x^2 + y^2 - 5; g = x*y - 2;");
    check("two conics", &system, &[(0, 1, 1, 4)]);
    let double = written("variable_group x, y; function f, g; f = (x - y)^2; g = x^2 + y^2 - 2;");
    check("two double points", &double, &[(0, 1, 2, 2)]);
}

/// Whatever a stage is of can be sent to a worker, node by node as it is.
#[test]
fn systems_of_stages_survive_the_wire() {
    for name in ["twisted_cubic", "conic_p1p2", "double_line", "jets_a3"] {
        let system = instance(name);
        let solve = DecompositionSolve::new(&system, &DecompositionOptions::default());
        let mut root = Root::new(solve.expect("it can be decomposed"));
        let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
        let mut systems = BTreeSet::new();
        let driven = drive::<PrepareError, _>(&mut root, &mut |opening| {
            let made = opening.objects.iter();
            objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
            let system = opening.system.as_deref();
            let system = system.expect("every stage brings its system");
            let bytes = digest::encode_system(system);
            let sent = digest::decode_system(&bytes).expect("a worker can read it");
            assert!(sent == *system, "{name}: {:?}", opening.stage);
            systems.insert(digest::of_bytes(&bytes));
            let find = |digest: Digest| objects.get(&digest).cloned();
            let prepared = PreparedWork::new(&sent, &opening.stage, &find)?;
            Ok(prepared.run(0..prepared.items(), 8))
        });
        assert_eq!(driven, Ok(()));
        assert!(systems.len() > 1, "{name}");
    }
}

/// Equations that hold on a set of curves, points and surfaces whose ideals are known: products of one generator of
/// each ideal. Dimension, degree and count of the sets beside them.
struct Product {
    generators: Vec<String>,
    components: Vec<(u32, u64)>,
}

impl Product {
    fn new() -> Self {
        Self {
            generators: vec!["1".into()],
            components: Vec::new(),
        }
    }

    /// The union with a set of this dimension and degree.
    fn with(mut self, dimension: u32, degree: u64, ideal: &[String]) -> Self {
        let pairs = self.generators.iter();
        let pairs = pairs.flat_map(|g| ideal.iter().map(move |f| format!("{g}*({f})")));
        self.generators = pairs.collect();
        self.components.push((dimension, degree));
        self
    }

    fn system(&self) -> System {
        let names: Vec<String> = (1..=self.generators.len())
            .map(|k| format!("f{k}"))
            .collect();
        let lines = names.iter().zip(&self.generators);
        let lines: Vec<String> = lines.map(|(f, g)| format!("{f} = {g};")).collect();
        let names = names.join(", ");
        written(&format!(
            "variable_group x, y, z; function {names}; {}",
            lines.join(" ")
        ))
    }

    fn expected(&self) -> Vec<Expected> {
        let mut counts: BTreeMap<(u32, u64), u64> = BTreeMap::new();
        for &key in &self.components {
            *counts.entry(key).or_default() += 1;
        }
        let counts = counts.into_iter().rev();
        counts
            .map(|((dimension, degree), count)| (dimension, degree, 1, count))
            .collect()
    }
}

/// Random products of the ideals of lines, quadrics and rational curves have the components that they are made of,
/// by each way. `SEEDS` asks for more of them.
#[test]
fn products_of_ideals_have_the_components_that_they_are_made_of() {
    let seeds = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    for number in 1..=seeds.unwrap_or(6) {
        let mut random = RandomStream::new(number, Purpose::Test, 21);
        let mut c = || random.below(9) as i64 - 4;
        let mut product = Product::new();
        let shift = [c(), c(), c()].map(|n| 2 * n + 1);
        let [x, y, z] = ["x", "y", "z"];
        if number % 2 == 0 {
            let quadric = format!(
                "{x}^2 + 2*{y}^2 - {z}^2 + ({})*{x} - {}",
                shift[0],
                30 + number
            );
            product = product.with(2, 2, &[quadric]);
        }
        // The curve (t, t^2, t^3), moved.
        let (u, v) = (
            format!("({x} - ({}))", shift[0]),
            format!("({y} - ({}))", shift[1]),
        );
        let cubic = [
            format!("{v} - {u}^2"),
            format!("({z} - ({})) - {u}*{v}", shift[2]),
        ];
        product = product.with(1, 3, &cubic);
        if number % 3 == 0 {
            let plane = format!("{z} - 2*{x} + ({})*{y} + ({})", c(), 5 * c() + 1);
            let quadric = format!("{x}^2 + 3*{y}^2 + {x}*{y} + ({})*{x} - {}", c(), 7 + number);
            product = product.with(1, 2, &[plane, quadric]);
        }
        let lines = if number % 3 == 0 { 1 } else { 1 + number % 2 };
        for _ in 0..lines {
            let line = [0, 1].map(|_| {
                format!(
                    "({})*{x} + ({})*{y} + {z} + ({})",
                    c(),
                    2 * c() + 1,
                    3 * c() + 1
                )
            });
            product = product.with(1, 1, &line);
        }
        let system = product.system();
        for method in std::iter::once(None).chain(Method::ALL.map(Some)) {
            let decomposition = decompose_by(&system, number, method);
            let (counts, doubts) = (counted(&decomposition), doubts(&decomposition));
            assert!(
                decomposition.settled() && decomposition.adds_up(),
                "{number}, {method:?}: {counts:?}{doubts}"
            );
            assert_eq!(counts, product.expected(), "{number}, {method:?}");
        }
    }
}

/// The three ways find equal components where they apply.
#[test]
fn three_ways_find_the_same() {
    let instances = [
        "twisted_cubic",
        "nid_illustrative",
        "sphere_line_point",
        "permanents_2x4",
        "double_line",
        "cyclic_4",
    ];
    for name in instances {
        let system = instance(name);
        let expected = counted(&decompose(&system, 1));
        for method in Method::ALL {
            let decomposition = decompose_by(&system, 2, Some(method));
            assert!(
                decomposition.settled(),
                "{name}, {method:?}:{}",
                doubts(&decomposition)
            );
            assert_eq!(counted(&decomposition), expected, "{name}, {method:?}");
        }
    }
}

/// Dimensions by themselves begin in mixed cells where these have fewer paths: in dimension 0 alone 156 instead of 720.
#[test]
fn sparse_systems_have_few_paths_on_slices() {
    let system = cognate_systems::named::cyclic(6).system;
    for seed in 1..=3 {
        let decomposition = decompose_by(&system, seed, Some(Method::Slices));
        assert!(
            decomposition.settled(),
            "seed {seed}:{}",
            doubts(&decomposition)
        );
        assert_eq!(counted(&decomposition), [(0, 1, 1, 156)]);
        assert!(decomposition.paths.total < 720, "{:?}", decomposition.paths);
    }
}

/// Systems whose components are known by construction, for whichever a way would not be taken by itself: no way may find
/// anything else.
#[test]
fn sets_that_are_made_to_be_hard() {
    let minors =
        "x0*x2 - x1^2, x0*x3 - x1*x2, x0*x4 - x1*x3, x1*x3 - x2^2, x1*x4 - x2*x3, x2*x4 - x3^2";
    let cases: [(&str, &str, &[Expected]); 9] = [
        // Vertex covers of a circle of five: coordinate spaces of one dimension.
        (
            "variable_group x0, x1, x2, x3, x4",
            "x0*x1, x1*x2, x2*x3, x3*x4, x4*x0",
            &[(2, 1, 1, 5)],
        ),
        // Vertex covers of a star: a hyperplane, and the axis of its centre.
        (
            "variable_group x0, x1, x2, x3",
            "x0*x1, x0*x2, x0*x3",
            &[(3, 1, 1, 1), (1, 1, 1, 1)],
        ),
        ("variable_group x, y, z", "x^2, x*y, y^3", &[(1, 1, 4, 1)]),
        (
            "variable_group x, y",
            "x^2*y^3*(x + y - 1)^4*(x^2 - y)",
            &[(1, 2, 1, 1), (1, 1, 4, 1), (1, 1, 3, 1), (1, 1, 2, 1)],
        ),
        // Two spheres that touch: two lines through the point, neither real.
        (
            "variable_group x, y, z",
            "x^2 + y^2 + z^2 - 1, (x - 2)^2 + y^2 + z^2 - 1",
            &[(1, 1, 1, 2)],
        ),
        (
            "variable_group x, y, z",
            "x^2*y - 1, y^2*z - 1",
            &[(1, 6, 1, 1)],
        ),
        // No solutions, by the third and the fourth equation together.
        (
            "variable_group x, y, z",
            "x*y - 1, y*z - 1, x*z + 1, x - z + 1",
            &[],
        ),
        // The rational normal curve of degree 4, by six minors.
        (
            "hom_variable_group x0, x1, x2, x3, x4",
            minors,
            &[(1, 4, 1, 1)],
        ),
        // A graph over a line, by two forms in two groups.
        (
            "hom_variable_group a, b; hom_variable_group x, y, z",
            "a*x + b*y, a*y + b*z",
            &[(1, 3, 1, 1)],
        ),
    ];
    for (number, (groups, equations, expected)) in cases.into_iter().enumerate() {
        let equations: Vec<&str> = equations.split(", ").collect();
        let names: Vec<String> = (1..=equations.len()).map(|k| format!("f{k}")).collect();
        let lines = names.iter().zip(&equations);
        let lines: Vec<String> = lines.map(|(name, f)| format!("{name} = {f};")).collect();
        let text = format!(
            "{groups}; function {}; {}",
            names.join(", "),
            lines.join(" ")
        );
        let system = written(&text);
        for method in [None, Some(Method::Cascade), Some(Method::Slices)] {
            let decomposition = decompose_by(&system, 1 + number as u64, method);
            let (counts, doubts) = (counted(&decomposition), doubts(&decomposition));
            assert!(decomposition.settled(), "{text}, {method:?}:{doubts}");
            assert_eq!(counts, expected, "{text}, {method:?}");
        }
    }
}

/// A double surface that a further equation cuts is followed through its deflated equations.
#[test]
fn a_multiple_surface_is_cut_by_the_next_equation() {
    let system = written(
        "variable_group x, y, z; function f, g; f = x^2 + y^4 - 2*x*y^2; g = z^5 - x*y - 1;",
    );
    for seed in 1..=3 {
        for method in [Method::Equations, Method::Cascade] {
            let decomposition = decompose_by(&system, seed, Some(method));
            let doubts = doubts(&decomposition);
            assert!(decomposition.settled(), "{method:?}, {seed}: {doubts}");
            assert_eq!(
                counted(&decomposition),
                [(1, 10, 2, 1)],
                "{method:?}, {seed}"
            );
        }
    }
}

#[test]
fn equations_that_hold_everywhere_are_left_out() {
    let system = written(
        "variable_group x, y; function f, g; f = (x + y)^2 - x^2 - 2*x*y - y^2; g = x*y - 1;",
    );
    check("with 0 = 0", &system, &[(1, 2, 1, 1)]);
}

/// Of two conjugate lines neither is its own conjugate; of real ones each is.
#[test]
fn conjugate_components_are_told() {
    let system = written(
        "variable_group x, y, z; function f, g; f = (x^2 + y^2)*(x - 1); g = (z - 2)*(z + x);",
    );
    let decomposition = decompose(&system, 1);
    assert!(decomposition.settled(), "{}", doubts(&decomposition));
    let self_conjugate_sets = decomposition
        .components
        .iter()
        .filter(|set| set.self_conjugate == Some(true));
    assert_eq!(
        (decomposition.components.len(), self_conjugate_sets.count()),
        (6, 2)
    );
    assert!(
        decomposition
            .components
            .iter()
            .all(|set| set.self_conjugate.is_some())
    );
    let cubic = decompose(&instance("twisted_cubic"), 1);
    assert_eq!(cubic.components[0].self_conjugate, Some(true));
}

/// Sets in homogeneous groups have projective dimensions; in several groups the Segre degree of a chart.
#[test]
fn projective_sets_are_decomposed() {
    let system = written(
        "hom_variable_group x, y, z, w; function f, g; f = x*w - y*z; g = (x - w)*(y + z);",
    );
    check("two sections of a quadric", &system, &[(1, 2, 1, 2)]);
}

/// A system whose components are known by theory, and by a primary decomposition over the rationals; `components` are
/// dimension, degree, multiplicity and count.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Known {
    name: String,
    groups: Vec<Vec<String>>,
    homogeneous: bool,
    equations: Vec<String>,
    components: Vec<Expected>,
    /// Where the components are from.
    source: String,
    /// A doubt that may stay, because settling it takes long.
    #[serde(default)]
    doubt: Option<String>,
}

impl Known {
    fn system(&self) -> System {
        let word = match self.homogeneous {
            true => "hom_variable_group",
            false => "variable_group",
        };
        let groups = self.groups.iter();
        let groups: Vec<String> = groups
            .map(|g| format!("{word} {};", g.join(", ")))
            .collect();
        let names: Vec<String> = (1..=self.equations.len())
            .map(|k| format!("f{k}"))
            .collect();
        let lines = names.iter().zip(&self.equations);
        let lines: Vec<String> = lines.map(|(f, e)| format!("{f} = {e};")).collect();
        let functions = names.join(", ");
        written(&format!(
            "{} function {functions}; {}",
            groups.join(" "),
            lines.join(" ")
        ))
    }
}

fn known_by_theory() -> Vec<Known> {
    let text = include_str!("known_by_theory.json");
    serde_json::from_str(text).expect("the list is as it was written")
}

/// Six ends of the last level lie on the curve, each the end of several paths: with seed 1 their dual spaces as points of
/// the combinations took minutes, and then seconds, though nothing was decided by them.
#[test]
fn the_cascade_asks_once_about_ends_on_higher_sets() {
    let textbook_sets = known_by_theory();
    let named = |textbook_set: &&Known| textbook_set.name == "points_and_curve_overdetermined";
    let system = textbook_sets
        .iter()
        .find(named)
        .expect("it is in the list")
        .system();
    let options = DecompositionOptions {
        seed: 1,
        method: Some(Method::Cascade),
        ..DecompositionOptions::default()
    };
    let mut root = Root::new(DecompositionSolve::new(&system, &options).expect("a problem"));
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    let driven = drive::<PrepareError, _>(&mut root, &mut |opening| {
        let made = opening.objects.iter();
        objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let stage = &opening.stage;
        let at_combinations = matches!(stage.homotopy, HomotopyKind::ProductToEquation { .. });
        assert!(!at_combinations || stage.work == Work::Track, "{stage:?}");
        let find = |digest: Digest| objects.get(&digest).cloned();
        let system = opening
            .system
            .as_deref()
            .expect("every stage brings its system");
        let prepared = PreparedWork::new(system, stage, &find)?;
        Ok(prepared.run(0..prepared.items(), 8))
    });
    assert_eq!(driven, Ok(()));
    let decomposition = root.solve.decomposition().expect("it is done");
    assert!(decomposition.settled(), "{}", doubts(decomposition));
    assert_eq!(counted(decomposition), [(1, 3, 1, 1), (0, 1, 1, 1)]);
}

/// Determinantal and toric varieties, sets of matrices, ideals of graphs, multiple and embedded sets, empty ones. One way
/// for each system in turn; `SEEDS` asks for all ways and more seeds.
#[test]
fn components_that_theory_knows() {
    let textbook_sets = known_by_theory();
    assert!(
        textbook_sets
            .iter()
            .all(|textbook_set| !textbook_set.source.is_empty())
    );
    let seeds: Option<u64> = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    let mut report = String::new();
    for (k, textbook_set) in textbook_sets.iter().enumerate() {
        if textbook_set.doubt.is_some() && seeds.is_none() {
            continue;
        }
        let system = textbook_set.system();
        let methods: Vec<Option<Method>> = match seeds {
            None => vec![(k % 4).checked_sub(1).map(|place| Method::ALL[place])],
            Some(_) => std::iter::once(None).chain(Method::ALL.map(Some)).collect(),
        };
        let mut expected = textbook_set.components.clone();
        expected.sort_by(|a, b| b.cmp(a));
        for method in methods {
            for seed in 1..=seeds.unwrap_or(1) {
                let decomposition = decompose_by(&system, seed, method);
                let counts = counted(&decomposition);
                let right =
                    counts == expected && decomposition.settled() && decomposition.adds_up();
                let allowed = textbook_set.doubt.is_some() && !decomposition.settled();
                if !right && !allowed {
                    let (name, doubts) = (&textbook_set.name, doubts(&decomposition));
                    let _ = write!(
                        report,
                        "\n{name}, {method:?}, seed {seed}: {counts:?}{doubts}"
                    );
                }
            }
        }
    }
    assert!(report.is_empty(), "{report}");
}

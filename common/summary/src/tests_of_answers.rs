//! Answers of each kind as JSON, which is that of the contract byte for byte, and read back.

use super::about::{About, TimeBlock};
use super::question_answer::QuestionAnswer;
use super::{AnySummary, QuestionSummary};
use cognate_algorithms::Answer as JobAnswer;
use cognate_algorithms::answer::AnsweredQuestion;
use cognate_solutions::witness::answer::{
    CertifiedComponent, CheckedComponent, GroupDegree, Membership, Mobility, Multidegree, Near,
    Projection, RealPoint, RealPoints, Samples,
};
use cognate_solutions::witness::real_curve::{
    CurveEdge, CurveVertex, ProvedFibre, RealCurve, VertexKind,
};
use cognate_solutions::witness::real_surface::{Mesh, RealSurface};
use cognate_solutions::witness::{Answer, ComponentId, TrackedPaths};
use num_complex::Complex64;

const ID: ComponentId = ComponentId {
    dimension: 1,
    number: 3,
};

fn summary(answer: Answer) -> AnySummary {
    let about = About {
        job: "j".into(),
        name: "n".into(),
        digest: "d".into(),
        variables: 2,
        equations: 1,
        start: String::new(),
        why: String::new(),
        seed: 7,
        warnings: Vec::new(),
        time: TimeBlock::new(1500, 250_000, 3),
        workers: Vec::new(),
    };
    let asked = AnsweredQuestion {
        unknowns: vec!["x".into(), "y".into()],
        doubts: answer.doubts(),
        answer,
        paths: TrackedPaths::default(),
    };
    AnySummary::new(&JobAnswer::Question(asked), &about)
}

/// Checks the blocks of an answer as JSON, without the braces around them, and that its summary is read back.
fn check(answer: Answer, blocks: &str) {
    let written = summary(answer);
    let text = serde_json::to_string(&written).expect("JSON");
    let before = r#""unknowns":["x","y"],"equations":1,"seed":7},"#;
    let expected = format!("{before}{blocks},\"unsettled\":[");
    assert!(text.contains(&expected), "{text}\n{expected}");
    assert_eq!(AnySummary::read(&text).expect("a summary"), written);
}

fn point() -> Vec<Complex64> {
    vec![Complex64::new(0.5, -0.0), Complex64::new(1e-17, 1e300)]
}

#[test]
fn answers_about_points() {
    let membership = Membership {
        index: 0,
        on: vec![ID],
        unsettled: vec![
            Near {
                id: ID,
                distance: Some(0.25),
            },
            Near {
                id: ID,
                distance: None,
            },
        ],
        solves: Some(true),
    };
    check(
        Answer::Member(vec![membership]),
        r#""points":[{"dimensions":[1],"index":0,"on":["1.3"],"solves":true,"unsettled":[{"component":"1.3","distance":0.25},{"component":"1.3","distance":null}]}]"#,
    );
    let mobility = Mobility {
        index: 2,
        infinitesimal: Some(1),
        dimensions_by_order: vec![1, 2],
        local_dimension: None,
        reason: "r".into(),
        on: vec![ID],
    };
    check(
        Answer::Mobility(vec![mobility]),
        r#""points":[{"dimensions_by_order":[1,2],"index":2,"infinitesimal":1,"local_dimension":null,"on":["1.3"],"reason":"r"}]"#,
    );
    check(Answer::Member(Vec::new()), r#""points":[]"#);
}

#[test]
fn answers_about_components() {
    let checked = CheckedComponent {
        id: ID,
        trace: None,
        closed: true,
        multiplicity: None,
    };
    check(
        Answer::Check(vec![checked]),
        r#""components":[{"closed":true,"id":"1.3","multiplicity":null}]"#,
    );
    let certified = CertifiedComponent {
        id: ID,
        points: 4,
        certified: 3,
        distinct: true,
    };
    check(
        Answer::Certify(vec![certified]),
        r#""components":[{"certified":3,"distinct":true,"id":"1.3","points":4}]"#,
    );
    let projection = Projection {
        id: ID,
        dimension: Some(1),
        degree: None,
        fiber_degree: Some(2),
        fiber_dimension: Some(0),
        same_image: Some(ID),
        rank_gap: f64::MAX,
        doubts: vec!["one".into()],
    };
    check(
        Answer::Project(vec![projection]),
        r#""components":[{"degree":null,"dimension":1,"doubts":["one"],"fiber_degree":2,"fiber_dimension":0,"id":"1.3","rank_gap":1.7976931348623157e+308,"same_image":"1.3"}]"#,
    );
    let multidegree = Multidegree {
        id: ID,
        degrees: vec![GroupDegree {
            slices: vec![1, 0],
            degree: Some(2),
        }],
        doubts: Vec::new(),
    };
    check(
        Answer::Multidegree {
            groups: vec![vec!["x".into()], vec!["y".into()]],
            components: vec![multidegree],
        },
        r#""components":[{"doubts":[],"id":"1.3","multidegree":[{"degree":2,"slices":[1,0]}]}],"groups":[["x"],["y"]]"#,
    );
}

#[test]
fn points_of_components() {
    let samples = Samples {
        id: ID,
        wanted: 2,
        points: vec![point()],
        failed: 1,
    };
    check(
        Answer::Sample(vec![samples]),
        r#""points":[[[0.5,-0.0],[1e-17,1e+300]]],"components":[{"count":1,"failed":1,"id":"1.3","wanted":2}]"#,
    );
    let real = |points: Vec<RealPoint>, doubts: Vec<String>| {
        Answer::RealPoints(vec![RealPoints {
            id: ID,
            points,
            doubts,
        }])
    };
    let real_point = RealPoint {
        point: point(),
        regular: true,
    };
    check(
        real(vec![real_point], vec!["one".into()]),
        r#""points":[{"component":"1.3","point":[[0.5,-0.0],[1e-17,1e+300]],"regular":true}],"components":[{"doubts":["one"],"has_real_points":true,"id":"1.3","points":1,"settled":false}]"#,
    );
    check(
        real(Vec::new(), Vec::new()),
        r#""points":[],"components":[{"doubts":[],"has_real_points":false,"id":"1.3","points":0,"settled":true}]"#,
    );
}

#[test]
fn a_real_curve_has_counts_vertices_and_arcs() {
    let vertex = |kind: VertexKind| CurveVertex {
        kind,
        point: point(),
        value: -0.5,
    };
    let curve = RealCurve {
        id: ID,
        degree: 2,
        form: vec![[1, 0], [-2, 3]],
        vertices: vec![vertex(VertexKind::Critical), vertex(VertexKind::Acnode)],
        edges: vec![CurveEdge {
            ends: [Some(0), None],
            samples: vec![point()],
        }],
        proofs: vec![ProvedFibre {
            value: 0.25,
            different: 2,
            real: 1,
            not_real: 1,
        }],
        doubts: Vec::new(),
    };
    check(
        Answer::RealCurve(vec![curve]),
        r#""components":[{"arcs_across_box":0,"closed_loops":0,"connected_components":2,"degree":2,"edges":1,"id":"1.3","isolated_points":1,"proved_slabs":1,"settled":true,"singular_points":1,"slabs":1,"topology":{"connected_parts":2,"euler_characteristic":2,"betti":[2,0]},"topology_reason":null,"unbounded_arcs":0,"vertices":2}],"curves":[{"edges":[{"ends":[0,null],"samples":[[[0.5,-0.0],[1e-17,1e+300]]]}],"form":[[1,0],[-2,3]],"id":"1.3","slabs":[{"different":2,"not_real":1,"proved":true,"real":1,"value":0.25}],"vertices":[{"edges":[0],"kind":"critical","point":[[0.5,-0.0],[1e-17,1e+300]],"value":-0.5},{"edges":[],"kind":"acnode","point":[[0.5,-0.0],[1e-17,1e+300]],"value":-0.5}]}],"union":{"topology":{"connected_parts":2,"euler_characteristic":2,"betti":[2,0]},"topology_reason":null}"#,
    );
}

#[test]
fn counts_of_a_real_surface_in_doubt_are_not_known() {
    let surface = |doubts: Vec<String>| {
        Answer::RealSurface(vec![RealSurface {
            id: ID,
            degree: 2,
            compact: false,
            euler: -1,
            levels: vec![0.5],
            mesh: Mesh {
                vertices: vec![[0.0, 1.0, 0.5]; 3],
                triangles: vec![[0, 1, 2]],
                segments: vec![[0, 1]],
            },
            doubts,
        }])
    };
    let drawn = r#""surfaces":[{"compact":false,"id":"1.3","segments":[[0,1]],"triangles":[[0,1,2]],"vertices":[[0.0,1.0,0.5],[0.0,1.0,0.5],[0.0,1.0,0.5]]}]"#;
    let union = |topology: &str| format!(r#","union":{{{topology}}}"#);
    let unknown = |reason: &str| format!(r#""topology":null,"topology_reason":"{reason}""#);
    let differs = unknown("the mesh has another Euler characteristic than the cells");
    let in_doubt = unknown("something is in doubt");
    let blocks = r#""components":[{"compact":false,"crossing_edges":0,"curve_parts":0,"degree":2,"euler":-1,"id":"1.3","levels":1,"parts":1,"point_parts":0,"settled":true,TOPOLOGY,"triangles":1,"vertices":3}],"#;
    let blocks = blocks.replace("TOPOLOGY", &differs);
    check(
        surface(Vec::new()),
        &format!("{blocks}{drawn}{}", union(&differs)),
    );
    let blocks = r#""components":[{"compact":null,"crossing_edges":null,"curve_parts":null,"degree":2,"euler":null,"id":"1.3","levels":1,"parts":null,"point_parts":null,"settled":false,TOPOLOGY,"triangles":1,"vertices":3}],"#;
    let blocks = blocks.replace("TOPOLOGY", &in_doubt);
    check(
        surface(vec!["one".into()]),
        &format!("{blocks}{drawn}{}", union(&in_doubt)),
    );
}

/// Summaries of older programs lack fields that were added since, and newer programs may know further questions.
#[test]
fn summaries_of_other_versions_are_read() {
    let read = |question: &str, blocks: &str| -> Box<QuestionSummary> {
        let text = format!(
            r#"{{"job":"j","question":"{question}","problem":{{"name":"n","digest":"d","variables":2,"equations":1,"seed":7}},{blocks}"unsettled":[],"settled":true,"paths":{{"total":1,"failed":0,"retracked":0,"crossings_found":0,"crossings_resolved":0}},"time":{{"wall_seconds":1.5,"cpu_seconds":0.25,"tracking_cpu_seconds":0.25,"paths_per_second":2.0}},"workers":[],"warnings":[]}}"#
        );
        match AnySummary::read(&text).expect("a summary") {
            AnySummary::Question(summary) => summary,
            other => panic!("{other:?}"),
        }
    };
    let curve = read(
        "real-curve",
        r#""components":[{"closed_loops":1,"connected_components":1,"degree":2,"edges":2,"id":"1.1","isolated_points":0,"settled":true,"singular_points":0,"unbounded_arcs":0,"vertices":2}],"curves":[{"edges":[{"ends":[0,1],"samples":[[[0.0,0],[1.5e-7,0.0]]]}],"form":[[1,0]],"id":"1.1","vertices":[]}],"#,
    );
    let QuestionAnswer::RealCurve(answer) = &curve.answer else {
        panic!("{curve:?}");
    };
    assert_eq!(answer.components[0].arcs_across_box, 0);
    assert_eq!(answer.components[0].slabs, None);
    assert_eq!(answer.curves[0].edges[0].samples[0][1].re, 1.5e-7);
    let image = read(
        "project",
        r#""components":[{"degree":2,"dimension":1,"doubts":[],"fiber_degree":1,"fiber_dimension":0,"id":"1.1","rank_gap":1e9}],"#,
    );
    assert!(
        matches!(&image.answer, QuestionAnswer::Project(a) if a.components[0].same_image.is_none())
    );
    let surface = read(
        "real-surface",
        r#""components":[{"compact":true,"crossing_edges":0,"degree":2,"euler":2,"id":"2.1","levels":2,"parts":1,"settled":true,"triangles":0,"vertices":0}],"surfaces":[{"id":"2.1","segments":[],"triangles":[],"vertices":[]}],"#,
    );
    assert!(
        matches!(&surface.answer, QuestionAnswer::RealSurface(a) if a.surfaces[0].compact.is_none())
    );
    let unknown = read("colour", r#""components":[{"id":"1.1","colour":0.5}],"#);
    assert_eq!(unknown.answer, QuestionAnswer::Other);
}

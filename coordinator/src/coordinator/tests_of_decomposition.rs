//! Decompositions in whole clusters: any process may die at any moment, and the components are the same, bit for bit.

use super::simulation::*;
use super::*;
use crate::ledger::rows::JobRow;
use cognate_protocol::submission::{Asked, Decompose};
use cognate_solutions::witness::Question;
use cognate_solutions::witness::question::CurveWish;
use cognate_summary::AnySummary;
use cognate_summary::question_answer::QuestionAnswer;

/// A double line, a parabola, and a circle.
pub(super) fn problem() -> NewProblem {
    let text = "variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2)*(x^2 + y^2 - 3);";
    let mut problem = problem_of(text, None);
    problem.options.decompose = Some(Decompose::default());
    problem
}

/// One coordinator, one worker, nothing happens.
async fn quiet() -> JobRow {
    let (cluster, row) = undisturbed(&problem()).await;
    let coordinator = cluster.coordinator(0);
    let decomposition = coordinator.decomposition(cluster.job).await.unwrap();
    let shape = |set: &cognate_solutions::witness::WitnessSet| {
        (set.dimension(), set.degree, set.multiplicity.scheme)
    };
    let components: Vec<_> = decomposition.components.iter().map(shape).collect();
    assert_eq!(
        components,
        [(1, 2, Some(1)), (1, 2, Some(1)), (1, 1, Some(2))]
    );
    let (summary, _) = coordinator.summary(cluster.job).await.unwrap();
    assert!(summary.solve().is_none());
    let refused = coordinator.solutions(cluster.job).await;
    assert!(
        matches!(refused, Err(CoordinatorError::OtherAnswer { is, .. }) if is.contains("witness points"))
    );
    row
}

#[tokio::test]
async fn any_cluster_finds_the_same_components() {
    let reference = quiet().await;
    check_any_cluster(&problem(), &reference, &[1, 2, 3], 24).await;
}

/// The real curve of the parabola and the circle, by the witness sets that a decomposition found.
async fn question() -> NewProblem {
    let (cluster, _) = undisturbed(&problem()).await;
    let decomposition = cluster.coordinator(0).decomposition(cluster.job).await;
    let mut components = decomposition.unwrap().components;
    components.retain(|set| set.deflation.is_empty());
    let mut asked = problem();
    asked.options.decompose = None;
    asked.options.question = Some(Asked {
        components,
        question: Question::RealCurve(CurveWish {
            samples: 1,
            ..CurveWish::default()
        }),
    });
    asked
}

#[tokio::test]
async fn any_cluster_gives_the_same_answer() {
    let question = question().await;
    let (cluster, reference) = undisturbed(&question).await;
    let coordinator = cluster.coordinator(0);
    let (summary, _) = coordinator.summary(cluster.job).await.unwrap();
    let AnySummary::Question(summary) = summary else {
        panic!("{summary:?}");
    };
    assert!(summary.settled, "{:?}", summary.unsettled);
    let QuestionAnswer::RealCurve(answer) = summary.answer else {
        panic!("{:?}", summary.answer);
    };
    let curves = answer.components.iter();
    let counts = curves.map(|c| (c.closed_loops, c.unbounded_arcs));
    let sum = counts.fold((0, 0), |sum, curve| (sum.0 + curve.0, sum.1 + curve.1));
    assert_eq!(sum, (1, 1));
    let refused = coordinator.solutions(cluster.job).await;
    assert!(
        matches!(refused, Err(CoordinatorError::OtherAnswer { is, .. }) if is.contains("summary"))
    );
    check_any_cluster(&question, &reference, &[1, 2], 24).await;
}

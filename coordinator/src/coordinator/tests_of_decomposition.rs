//! Decompositions in whole clusters: whoever dies wherever, the same components, bit for bit.

use super::simulation::*;
use super::*;
use crate::ledger::rows::JobRow;
use cognate_protocol::submission::Decompose;

/// A double line, a parabola, and a circle.
fn problem() -> NewProblem {
    let text = "variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2)*(x^2 + y^2 - 3);";
    let mut problem = problem_of(text, None);
    problem.options.decompose = Some(Decompose::default());
    problem
}

/// One coordinator, one worker, nothing happens.
async fn quiet() -> JobRow {
    let (cluster, row) = undisturbed(&problem()).await;
    let coordinator = cluster.coordinator(0);
    let found = coordinator.decomposition(cluster.job).await.unwrap();
    let of = |set: &cognate_solutions::witness::WitnessSet| {
        (set.dimension(), set.degree, set.multiplicity.scheme)
    };
    let components: Vec<_> = found.components.iter().map(of).collect();
    assert_eq!(
        components,
        [(1, 2, Some(1)), (1, 2, Some(1)), (1, 1, Some(2))]
    );
    let (summary, _) = coordinator.summary(cluster.job).await.unwrap();
    assert!(summary.solve().is_none());
    let refused = coordinator.solutions(cluster.job).await;
    assert!(matches!(refused, Err(CoordinatorError::Decomposed(_))));
    row
}

#[tokio::test]
async fn any_cluster_finds_the_same_components() {
    let reference = quiet().await;
    check_any_cluster(&problem(), &reference, &[1, 2, 3], 24).await;
}

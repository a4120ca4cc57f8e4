//! Decompositions in whole clusters: whoever dies wherever, the same components, bit for bit.

use super::simulation::*;
use super::*;
use crate::chunks::sizing::Sizing;
use crate::ledger::clock::ManualClock;
use crate::ledger::memory::MemoryLedger;
use crate::ledger::rows::JobRow;
use cognate_protocol::submission::Decompose;

/// A double line, a parabola, and a circle.
fn problem() -> NewProblem {
    let text = "variable_group x, y; function f; f = (x - y)^2*(y - x^2 + 2)*(x^2 + y^2 - 3);";
    let mut problem = problem_of(text, None);
    problem.options.decompose = Some(Decompose::default());
    problem
}

fn cluster(most_items: u64, seed: u64) -> Cluster {
    let clock = Arc::new(ManualClock::default());
    let ledger = Arc::new(MemoryLedger::new(clock.clone()));
    let policy = Policy {
        lease_ms: 3000,
        steward_ms: 2000,
        // Here workers die by chance, and no path is at fault.
        suspicion_limit: 1000,
        sizing: Sizing {
            first_items: most_items,
            most_items,
            ..Sizing::default()
        },
        ..Policy::default()
    };
    Cluster::new(ledger, Store::in_memory(), clock, policy, seed)
}

/// One coordinator, one worker, nothing happens.
async fn quiet() -> JobRow {
    let mut cluster = cluster(1000, 1);
    cluster.start_coordinator();
    cluster.start_worker();
    cluster.submit(&problem()).await;
    for _ in 0..200 {
        cluster.drive(0).await;
        cluster.pull(0, 0).await;
        cluster.report(0, 0).await;
    }
    let row = cluster.row().await;
    assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
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
    for seed in 0..24 {
        let mut cluster = cluster([1, 2, 3][seed as usize % 3], seed);
        for _ in 0..=seed % 2 {
            cluster.start_coordinator();
        }
        for _ in 0..=seed % 3 {
            cluster.start_worker();
        }
        cluster.submit(&problem()).await;
        let row = cluster.run().await;
        assert_eq!(row.state, JobState::Solved, "{:?}", row.reason);
        assert_eq!(row.solutions, reference.solutions, "seed {seed}");
    }
}

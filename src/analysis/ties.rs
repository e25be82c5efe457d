//! Final costs that cannot be told apart.

use super::Run;
use crate::experiment::Plan;

/// Costs of motions that differ by less than this share are the same: that is how far searches go.
pub(super) const SAME_MOTION: f64 = 1e-6;
/// Costs of other problems that differ by less are the same: COCO's final precision,
/// doi 10.1080/10556788.2020.1808977.
pub(super) const SAME: f64 = 1e-8;

/// The certified costs of the runs, in their order; on each instance a cost that exceeds a lower one by no
/// more than rounding and the ends of searches is taken for that one. Without that, ranks would tell
/// noise apart.
pub(super) fn settled(plan: &Plan, runs: &[Run]) -> Vec<f64> {
    let mut settled: Vec<f64> = runs.iter().map(|run| run.cost).collect();
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&runs[a], &runs[b]);
        a.instance.cmp(&b.instance).then(a.cost.total_cmp(&b.cost))
    });
    for instance in order.chunk_by(|&a, &b| runs[a].instance == runs[b].instance) {
        let is_task = plan.instances[runs[instance[0]].instance].is_task();
        let mut lowest = runs[instance[0]].cost;
        for &place in instance {
            let cost = runs[place].cost;
            let room = if is_task { SAME_MOTION * lowest.abs() } else { SAME };
            if cost - lowest <= room {
                settled[place] = lowest;
            } else {
                lowest = cost;
            }
        }
    }
    settled
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;
    use std::sync::Arc;

    use super::*;
    use crate::experiment::Instance;
    use crate::functions::{Analytic, TestFunction};
    use crate::optimiser::Settings;

    #[test]
    fn noise_is_taken_for_the_lowest_of_its_instance() {
        let sphere = Arc::new(Analytic::new(TestFunction::Sphere, 2, 1));
        let instance = Instance::other("", "sphere", sphere);
        let field = [Settings::by_name("random").unwrap()];
        let plan = Plan::over("x", vec![instance], &field, NonZeroU64::MIN, NonZeroU64::MIN);
        let costs = [3e-9, 1.0, 1e-15, f64::INFINITY, 1.0 + 2e-8, 1.0 + 1e-9, f64::INFINITY];
        let runs: Vec<Run> = costs.iter().map(|&cost| Run { cost, ..Run::default() }).collect();
        let infinite = f64::INFINITY;
        let expected = [1e-15, 1.0, 1e-15, infinite, 1.0 + 2e-8, 1.0, infinite];
        assert_eq!(settled(&plan, &runs), expected);
    }
}

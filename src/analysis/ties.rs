//! Final costs that cannot be told apart.

use crate::experiment::{Plan, Run};

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
        let subject = &plan.instances[runs[instance[0]].instance].subject;
        let mut lowest = runs[instance[0]].cost;
        for &place in instance {
            let cost = runs[place].cost;
            if cost - lowest <= subject.resolution(lowest) {
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
    use super::*;
    use crate::experiment::{Experiment, Identity, Instance};
    use crate::functions::{Analytic, TestFunction};
    use crate::optimiser::Settings;

    #[test]
    fn noise_is_taken_for_the_lowest_of_its_instance() {
        let sphere = Analytic::new(TestFunction::Sphere, 2, 1);
        let plan = Experiment::new("x")
            .unwrap()
            .with_instance(Instance::of_problem(
                "sphere",
                Identity::new().with("version", 1),
                sphere,
            ))
            .with_optimiser(Settings::by_name("random").unwrap())
            .plan()
            .unwrap();
        let costs = [3e-9, 1.0, 1e-15, f64::INFINITY, 1.0 + 2e-8, 1.0 + 1e-9, f64::INFINITY];
        let runs: Vec<Run> = costs.iter().map(|&cost| Run { cost, ..Run::default() }).collect();
        let infinite = f64::INFINITY;
        let expected = [1e-15, 1.0, 1e-15, infinite, 1.0 + 2e-8, 1.0, infinite];
        assert_eq!(settled(&plan, &runs), expected);
    }
}

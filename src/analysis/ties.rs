//! Final costs that cannot be told apart.

use super::statistics::quantile;
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
        let began = began(instance.iter().map(|&place| &runs[place]));
        for &place in instance {
            let cost = runs[place].cost;
            if cost - lowest <= subject.resolution(lowest, began - lowest) {
                settled[place] = lowest;
            } else {
                lowest = cost;
            }
        }
    }
    settled
}

/// The cost that searches typically begin with: the median of the first that each found; infinite where none found any.
fn began<'a>(runs: impl Iterator<Item = &'a Run>) -> f64 {
    let first = runs.map(|run| run.trace.first().map_or(run.cost, |step| step.cost));
    let mut first: Vec<f64> = first.filter(|cost| cost.is_finite()).collect();
    first.sort_by(f64::total_cmp);
    if first.is_empty() { f64::INFINITY } else { quantile(&first, 0.5) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Experiment, Identity, Improvement, Instance};
    use crate::functions::{Analytic, TestFunction};
    use crate::optimiser::Settings;

    /// What runs that begin with these costs and end with those are taken for.
    fn settled_of(began: f64, costs: &[f64]) -> Vec<f64> {
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
        let run = |&cost: &f64| {
            let trace = vec![Improvement { evaluation: 1, cost: began }];
            Run { cost, trace, ..Run::default() }
        };
        settled(&plan, &costs.iter().map(run).collect::<Vec<Run>>())
    }

    #[test]
    fn noise_is_taken_for_the_lowest_of_its_instance() {
        let infinite = f64::INFINITY;
        let costs = [3e-9, 1.0, 1e-15, infinite, 1.0 + 2e-8, 1.0 + 1e-9, infinite];
        let expected = [1e-15, 1.0, 1e-15, infinite, 1.0 + 2e-8, 1.0, infinite];
        assert_eq!(settled_of(30.0, &costs), expected);
    }

    /// In smaller units the verdict stays the same. In larger ones no descent counts for more than one.
    #[test]
    fn smaller_units_do_not_matter() {
        for unit in [1e-12, 1e-3] {
            let scaled = |costs: &[f64]| costs.iter().map(|cost| unit * cost).collect::<Vec<f64>>();
            let costs = [3e-9, 0.1, 1e-15, 0.3, 0.1 + 2e-8, 0.1 + 1e-9];
            let expected = [1e-15, 0.1, 1e-15, 0.3, 0.1 + 2e-8, 0.1];
            assert_eq!(settled_of(unit * 1.5, &scaled(&costs)), scaled(&expected), "{unit}");
        }
    }

    /// Costs about 10⁶ that come down by 3 end within 3·10⁻⁸ of each other; penalties do not make all the same.
    #[test]
    fn neither_the_level_nor_a_penalty_makes_costs_the_same() {
        let costs = [1e6, 1e6 + 1e-8, 1e6 + 1e-6];
        assert_eq!(settled_of(1e6 + 3.0, &costs), [1e6, 1e6, 1e6 + 1e-6]);
        assert_eq!(settled_of(1e30, &[1e-3, 2e-3]), [1e-3, 2e-3]);
    }
}

//! One fitness evaluation of the paper's task and its parts, with every number of lanes.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use driftless::attitude::net_rotation;
use driftless::lanes::Width;
use driftless::momentum::base_twist;
use driftless::reorientation::{Formulated, Formulation, TaskFile};
use driftless::search::Rng;
use driftless::search::{Composite, Multipliers, Problem};

fn evaluation(c: &mut Criterion) {
    let document = TaskFile::paper();
    let (problem, boxes) =
        TaskFile::read(&document).and_then(|file| file.build(&document)).expect("the default task");
    let formulated = |formulation, width| {
        Formulated::new(formulation, Arc::new(problem.with_width(width)), &boxes)
            .expect("sound boxes")
    };
    let within = |problem: &Formulated, share: f64| -> Vec<f64> {
        let mut rng = Rng::new(1);
        let bounds = problem.bounds().iter();
        bounds.map(|[l, u]| f64::midpoint(l, u) + share * rng.uniform(l - u, u - l) / 2.0).collect()
    };

    let mut group = c.benchmark_group("fitness");
    for formulation in Formulation::ALL {
        for width in Width::available() {
            let problem = formulated(formulation, width);
            let x = within(&problem, 1.0);
            let id = BenchmarkId::new(formulation.name(), width.name());
            group.bench_function(id, |b| b.iter(|| problem.evaluate(black_box(&x))));
        }
    }
    group.finish();

    let mut group = c.benchmark_group("derivatives");
    for width in Width::available() {
        let problem = formulated(Formulation::TimeFree, width);
        let x = within(&problem, 0.5);
        let parts = problem.linearise(&x).expect("the task never fails");
        let weigh = |term: usize, count: usize, by: f64| {
            parts.terms[term].pieces.iter().take(count).map(|piece| (piece.id, by)).collect()
        };
        let multipliers = Multipliers { terms: vec![weigh(0, 3, 1.0), weigh(1, 8, 0.1)] };
        group.bench_function(BenchmarkId::new("first", width.name()), |b| {
            b.iter(|| problem.linearise(black_box(&x)));
        });
        group.bench_function(BenchmarkId::new("second", width.name()), |b| {
            b.iter(|| problem.curvature(black_box(&x), &multipliers));
        });
        group.bench_function(BenchmarkId::new("rollout alone", width.name()), |b| {
            b.iter(|| problem.task().net_rotation(black_box(&x)));
        });
    }
    group.finish();

    let robot = &problem.task().robot;
    let x = within(&formulated(Formulation::TimeFree, Width::Scalar), 0.5);
    let path = problem.family().path(&x);
    let (mut angles, mut rates) = (vec![0.0; robot.joint_count()], vec![0.0; robot.joint_count()]);
    path.angles_and_rates(0.4, &mut angles, &mut rates);
    let mut group = c.benchmark_group("plain");
    group.bench_function("outward sweep", |b| {
        b.iter(|| base_twist(robot, black_box(&angles), black_box(&rates)));
    });
    group.bench_function("24 steps of three nodes", |b| {
        b.iter(|| net_rotation(robot, black_box(&path), 24));
    });
    group.finish();
}

criterion_group!(benches, evaluation);
criterion_main!(benches);

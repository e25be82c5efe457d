//! One fitness evaluation of the paper's task in each formulation, and its parts.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use driftless::attitude::net_rotation;
use driftless::momentum::base_twist;
use driftless::oracle::Rng;
use driftless::problem::{Composite, Formulated, Formulation, Multipliers, Problem, TaskFile};
use driftless::trajectory::Peaks;
use nalgebra::DVector;

fn evaluation(c: &mut Criterion) {
    let document = TaskFile::paper();
    let (problem, boxes) =
        TaskFile::read(&document).and_then(|file| file.build(&document)).expect("the default task");
    let problem = Arc::new(problem);
    let accuracy = problem.accuracy();
    let robot = problem.task().robot.clone();

    let mut group = c.benchmark_group("fitness");
    for formulation in Formulation::ALL {
        let formulated = Formulated::new(formulation, problem.clone(), &boxes);
        let mut rng = Rng::new(1);
        let bounds = formulated.bounds().iter();
        let x: Vec<f64> = bounds.map(|[l, u]| rng.uniform(l, u)).collect();
        group.bench_function(formulation.name(), |b| b.iter(|| formulated.evaluate(black_box(&x))));
    }
    group.finish();

    let mut rng = Rng::new(1);
    let coefficients: Vec<f64> =
        (0..problem.family().dimension()).map(|_| rng.uniform(-0.5, 0.5)).collect();
    let path = problem.family().path(&coefficients);
    let (mut angles, mut rates) = (vec![0.0; robot.joint_count()], vec![0.0; robot.joint_count()]);
    path.angles_and_rates(0.4, &mut angles, &mut rates);
    let mut group = c.benchmark_group("parts");
    group.bench_function("path", |b| b.iter(|| problem.family().path(black_box(&coefficients))));
    group.bench_function("angles and rates", |b| {
        b.iter(|| path.angles_and_rates(black_box(0.4), &mut angles, &mut rates));
    });
    group.bench_function("momentum sweep", |b| {
        b.iter(|| base_twist(&robot, black_box(&angles), black_box(&rates)));
    });
    group.bench_function("attitude", |b| {
        b.iter(|| net_rotation(&robot, black_box(&path), accuracy.attitude_steps));
    });
    let time_free = Formulated::new(Formulation::TimeFree, problem.clone(), &boxes);
    let parts = time_free.linearise(&coefficients);
    let multipliers = Multipliers {
        residual: DVector::from_element(3, 1.0),
        pieces: parts.pieces.iter().take(8).map(|piece| (piece.place, 0.1)).collect(),
    };
    group.bench_function("linearisation", |b| {
        b.iter(|| time_free.linearise(black_box(&coefficients)));
    });
    group.bench_function("curvature", |b| {
        b.iter(|| time_free.curvature(black_box(&coefficients), &multipliers));
    });
    group.bench_function("peaks", |b| {
        b.iter(|| Peaks::of(black_box(&path), accuracy.peak_intervals));
    });
    group.finish();
}

criterion_group!(benches, evaluation);
criterion_main!(benches);

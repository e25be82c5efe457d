//! Quantiles, intervals, running times and profiles.

use driftless::analysis::statistics::{
    Bootstrap, ProfileStep, Trial, convergence_target, data_profiles, expected_running_time,
    performance_profiles, quantile, simulated_restarts,
};
use driftless::search::Rng;

use super::{Case, cases, reals};

/// Running times of runs, those of failed ones negative.
fn trials(signed: &[f64]) -> Vec<Trial> {
    signed.iter().map(|t| Trial { evaluations: t.abs(), solved: *t > 0.0 }).collect()
}

#[test]
fn quantiles_are_those_of_numpy() {
    for case in cases("quantiles") {
        let sorted = case.reals("sorted");
        let found: Vec<f64> = case.reals("at").iter().map(|&q| quantile(&sorted, q)).collect();
        case.assert_all_close(&found, &case.reals("values"));
    }
}

#[test]
fn quantiles_beside_an_infinite_value_are_infinite() {
    let infinite = f64::INFINITY;
    assert_eq!(quantile(&[1.0, infinite], 0.5), infinite);
    assert_eq!(quantile(&[1.0, infinite], 0.0), 1.0);
    assert_eq!(quantile(&[3.0, infinite, infinite], 0.9), infinite);
    assert_eq!(quantile(&[-infinite, 3.0], 0.5), -infinite);
    assert!(quantile(&[], 0.5).is_nan());
}

/// SciPy's percentile bootstrap of the same resamples.
#[test]
fn intervals_are_those_of_scipy() {
    let mean = |sample: &[f64]| sample.iter().sum::<f64>() / sample.len() as f64;
    let median = |sample: &[f64]| {
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        quantile(&sorted, 0.5)
    };
    let mut infinite = 0;
    for case in cases("bootstrap") {
        let bootstrap = Bootstrap { level: case.real("level"), resamples: case.count("resamples") };
        let sample = case.reals("sample");
        let mut indices = case.counts("indices").into_iter();
        let index = |_| indices.next().unwrap();
        let found = match case.get("statistic").as_str().unwrap() {
            "mean" => bootstrap.interval(&sample, mean, index),
            "median" => bootstrap.interval(&sample, median, index),
            _ => bootstrap.interval(&trials(&sample), expected_running_time, index),
        };
        assert!(indices.next().is_none(), "more indices than were drawn");
        case.assert_all_close(&found, &case.reals("interval"));
        infinite += found.iter().filter(|end| end.is_infinite()).count();
    }
    assert!(infinite > 0, "no interval has an infinite end");
}

#[test]
fn expected_running_times_are_those_of_cocopp() {
    for case in cases("expected_running_time") {
        let trials = trials(&case.reals("trials"));
        case.assert_close(expected_running_time(&trials), case.real("expected"));
    }
}

/// cocopp's simulated run lengths with the same draws.
#[test]
fn simulated_restarts_are_those_of_cocopp() {
    for case in cases("simulated_restarts") {
        let expected = case.reals("times");
        let mut indices = case.counts("indices").into_iter();
        let index = |_| indices.next().unwrap();
        let found = simulated_restarts(&trials(&case.reals("trials")), expected.len(), index);
        assert!(indices.next().is_none(), "more indices than were drawn");
        case.assert_all_close(&found, &expected);
    }
}

/// One of four runs succeeds, after 3 evaluations; failures take 10. So a restarted run takes `3 + 10 k`
/// with probability `¼ (¾)^k`, 33 in the mean with a standard deviation of `10 √12`, which is the expected
/// running time. Four standard deviations of room.
#[test]
fn simulated_restarts_are_geometric() {
    let trials = trials(&[-10.0, 3.0, -10.0, -10.0]);
    let (mut rng, count) = (Rng::new(4), 100_000);
    let found = simulated_restarts(&trials, count, |n| rng.index(n));
    let near = |found: f64, expected: f64, deviation: f64| {
        let room = 4.0 * deviation / (count as f64).sqrt();
        assert!((found - expected).abs() < room, "{found} is not {expected}");
    };
    let mean = found.iter().sum::<f64>() / count as f64;
    near(mean, expected_running_time(&trials), 10.0 * 12_f64.sqrt());
    for k in 0..5 {
        let p = 0.25 * 0.75_f64.powi(k);
        let share = found.iter().filter(|time| **time == 3.0 + 10.0 * f64::from(k)).count() as f64;
        near(share / count as f64, p, (p * (1.0 - p)).sqrt());
    }
}

#[test]
fn nothing_solved_takes_for_ever() {
    let failed = trials(&[-5.0, -7.0]);
    assert_eq!(simulated_restarts(&failed, 2, |_| 0), [f64::INFINITY; 2]);
    let mut rng = Rng::new(1);
    let bootstrap = Bootstrap { level: 0.95, resamples: 100 };
    let interval = bootstrap.interval(&failed, expected_running_time, |n| rng.index(n));
    assert_eq!(interval, [f64::INFINITY; 2]);
}

/// A profile's shares at given times.
fn shares(profile: &[ProfileStep], at: &[f64]) -> Vec<f64> {
    let share = |&time: &f64| {
        let steps = profile.partition_point(|step| step.time <= time);
        steps.checked_sub(1).map_or(0.0, |last| profile[last].share)
    };
    at.iter().map(share).collect()
}

/// Every share that optimagic draws, at the steps and between them.
#[test]
fn profiles_are_those_of_optimagic() {
    for case in cases("profiles") {
        let times = case.rows("times");
        let performance = performance_profiles(&times);
        let data = data_profiles(&times, &case.counts("dimensions"));
        for (profiles, drawn) in [(performance, "performance"), (data, "data")] {
            let drawn = Case(case.get(drawn).clone());
            for (profile, expected) in profiles.iter().zip(drawn.rows("shares")) {
                case.assert_all_close(&shares(profile, &drawn.reals("at")), &expected);
            }
            assert_eq!(profiles.len(), reals(&case.get("times")[0]).len());
        }
    }
}

#[test]
fn problems_that_nobody_solves_count() {
    let times = [vec![30.0, f64::INFINITY], vec![f64::INFINITY; 2], vec![8.0, 4.0]];
    let expected = [
        vec![
            ProfileStep { time: 1.0, share: 1.0 / 3.0 },
            ProfileStep { time: 2.0, share: 2.0 / 3.0 },
        ],
        vec![ProfileStep { time: 1.0, share: 1.0 / 3.0 }],
    ];
    assert_eq!(performance_profiles(&times), expected);
    assert!(performance_profiles(&[]).is_empty());
}

/// Moré and Wild (2009): the reduction is then `1 − τ` of the largest possible one.
#[test]
fn a_target_leaves_a_share_of_the_reduction() {
    for (least, start, tau) in [(1.0, 11.0, 0.1), (-3.0, 5.0, 1e-3)] {
        let target = convergence_target(least, start, tau);
        let reduction: f64 = (start - target) / (start - least);
        assert!((reduction - (1.0 - tau)).abs() < 1e-15, "{reduction}");
    }
}

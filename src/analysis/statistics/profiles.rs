//! Shares of problems solved, over many problems.

/// Where a profile steps up. It keeps each share up to the next step, and is 0 before the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileStep {
    /// Time, in the profile's unit.
    pub time: f64,
    /// Share of all problems that are solved by then.
    pub share: f64,
}

/// Performance profiles, one for each solver: shares of the problems that it solves within multiples of
/// the time that the fastest solver takes for each.
///
/// `times[problem][solver]` is a positive time, infinite where the problem is not solved. Problems that no solver solves count among all. Profiles depend on the solvers compared:
/// name them. Dolan and Moré (2002), doi 10.1007/s101070100263.
pub fn performance_profiles(times: &[Vec<f64>]) -> Vec<Vec<ProfileStep>> {
    profiles(times, |_, times| times.iter().copied().fold(f64::INFINITY, f64::min))
}

/// Data profiles, one for each solver: shares of the problems that it solves within numbers of simplex
/// gradients, `n + 1` evaluations each for a problem of `n` variables.
///
/// `evaluations[problem][solver]` is infinite where the problem is not solved; `dimensions[problem]` is
/// `n`. Moré and Wild (2009), doi 10.1137/080724083.
pub fn data_profiles(evaluations: &[Vec<f64>], dimensions: &[usize]) -> Vec<Vec<ProfileStep>> {
    let dimension = |problem| dimensions.get(problem).copied().unwrap_or_default();
    profiles(evaluations, |problem, _| (dimension(problem) + 1) as f64)
}

/// Profiles of times in each problem's own unit.
fn profiles(times: &[Vec<f64>], unit: impl Fn(usize, &[f64]) -> f64) -> Vec<Vec<ProfileStep>> {
    let units: Vec<f64> = times.iter().enumerate().map(|(i, row)| unit(i, row)).collect();
    let solvers = times.first().map_or(0, Vec::len);
    let profile = |solver: usize| {
        let scaled = times.iter().zip(&units).filter_map(|(row, unit)| {
            row.get(solver).filter(|time| time.is_finite()).map(|time| time / unit)
        });
        steps(scaled.collect(), times.len())
    };
    (0..solvers).map(profile).collect()
}

fn steps(mut solved: Vec<f64>, problems: usize) -> Vec<ProfileStep> {
    solved.sort_by(f64::total_cmp);
    let mut count = 0;
    let together = solved.chunk_by(|a, b| a == b).map(|equal| {
        count += equal.len();
        ProfileStep { time: equal[0], share: count as f64 / problems as f64 }
    });
    together.collect()
}

/// The cost at which a problem counts as solved: `f_L + τ (f(x₀) − f_L)`, with `f_L` the least cost
/// known, or found by any solver within the budget, and `x₀` the start that all have in common.
///
/// Moré and Wild (2009), doi 10.1137/080724083.
pub fn convergence_target(least: f64, start: f64, tau: f64) -> f64 {
    least + tau * (start - least)
}

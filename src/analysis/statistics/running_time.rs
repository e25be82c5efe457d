//! How long an optimiser takes to reach a target.

/// What one run says about one target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Evaluations until the target was reached; all that were spent, where it was not.
    pub evaluations: f64,
    /// Whether the target was reached.
    pub solved: bool,
}

/// Expected running time \[evaluations\] of an optimiser that is restarted until it succeeds: all
/// evaluations spent until the target or until the end, those of failures too, for each success.
/// Infinite without a success.
///
/// Hansen et al. (2021), doi 10.1080/10556788.2020.1808977.
pub fn expected_running_time(trials: &[Trial]) -> f64 {
    let successes = trials.iter().filter(|trial| trial.solved).count();
    if successes == 0 {
        return f64::INFINITY;
    }
    trials.iter().map(|trial| trial.evaluations).sum::<f64>() / successes as f64
}

/// `count` running times \[evaluations\] of an optimiser that is restarted until it succeeds: trials
/// are drawn with replacement, up to the first success, and their evaluations summed. Infinite
/// without a success.
///
/// `index(n)` draws a whole number below `n`, each as likely. Hansen et al. (2021),
/// doi 10.1080/10556788.2020.1808977.
pub fn simulated_restarts(
    trials: &[Trial],
    count: usize,
    mut index: impl FnMut(usize) -> usize,
) -> Vec<f64> {
    if !trials.iter().any(|trial| trial.solved) {
        return vec![f64::INFINITY; count];
    }
    let mut restarted = || {
        let mut evaluations = 0.0;
        loop {
            let trial = trials[index(trials.len())];
            evaluations += trial.evaluations;
            if trial.solved {
                return evaluations;
            }
        }
    };
    (0..count).map(|_| restarted()).collect()
}

//! How runs are watched from outside.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Shared with whoever watches a run from outside.
#[derive(Debug, Default)]
pub struct Watch {
    interrupted: Arc<AtomicBool>,
    evaluations: AtomicU64,
}

impl Watch {
    /// Asks every run to stop at its next evaluation.
    pub fn interrupt(&self) {
        self.interrupted.store(true, Ordering::Relaxed);
    }

    /// What is true once somebody asked, to be set by a signal.
    pub fn flag(&self) -> Arc<AtomicBool> {
        self.interrupted.clone()
    }

    /// Whether somebody asked.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// Evaluations made so far by all runs.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// Takes note of evaluations, made or, for a run that ends early, not to be made.
    pub fn add_evaluations(&self, count: u64) {
        self.evaluations.fetch_add(count, Ordering::Relaxed);
    }
}

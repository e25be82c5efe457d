//! The statistics of a benchmark against SciPy, statsmodels, scikit-posthocs, optimagic and cocopp:
//! `expected.json`, made by `make_expected.py`, and closed forms. `run.sh` does both.
#![cfg(feature = "harness")]

mod rank_tests;
mod running_times;

use serde_json::Value;

/// A case of `expected.json`, with values infinite where that has null.
struct Case(Value);

/// All cases of a subject.
fn cases(subject: &str) -> Vec<Case> {
    let file: Value = serde_json::from_str(include_str!("expected.json")).unwrap();
    let cases = file[subject].as_array().unwrap();
    assert!(!cases.is_empty());
    cases.iter().cloned().map(Case).collect()
}

fn real(value: &Value) -> f64 {
    if value.is_null() { f64::INFINITY } else { value.as_f64().unwrap() }
}

fn reals(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(real).collect()
}

impl Case {
    fn get(&self, key: &str) -> &Value {
        self.0.get(key).unwrap()
    }

    fn real(&self, key: &str) -> f64 {
        real(self.get(key))
    }

    fn reals(&self, key: &str) -> Vec<f64> {
        reals(self.get(key))
    }

    fn rows(&self, key: &str) -> Vec<Vec<f64>> {
        self.get(key).as_array().unwrap().iter().map(reals).collect()
    }

    fn count(&self, key: &str) -> usize {
        self.get(key).as_u64().unwrap() as usize
    }

    fn counts(&self, key: &str) -> Vec<usize> {
        serde_json::from_value(self.get(key).clone()).unwrap()
    }

    /// Fails unless both are the same to ten digits, or to 1e-14 where they are small.
    #[track_caller]
    fn assert_close(&self, found: f64, expected: f64) {
        let same = found == expected || (found - expected).abs() <= 1e-10 * expected.abs() + 1e-14;
        assert!(same, "{found} is not {expected} in {}", self.0);
    }

    #[track_caller]
    fn assert_all_close(&self, found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len(), "{}", self.0);
        for (&found, &expected) in found.iter().zip(expected) {
            self.assert_close(found, expected);
        }
    }
}

//! Long work on a thread of its own, while Python's main thread looks for Ctrl-C and shows progress.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use driftless::search::Watch;
use pyo3::prelude::*;

use crate::errors;

/// What is done at the moment, to be ended when Python ends.
static WORK: Mutex<Vec<Arc<AtomicBool>>> = Mutex::new(Vec::new());

/// Keeps work in the list.
struct Entered(Arc<AtomicBool>);

impl Entered {
    fn new(watch: &Watch) -> Self {
        let flag = watch.flag();
        WORK.lock().unwrap_or_else(PoisonError::into_inner).push(flag.clone());
        Self(flag)
    }
}

impl Drop for Entered {
    fn drop(&mut self) {
        let mut work = WORK.lock().unwrap_or_else(PoisonError::into_inner);
        work.retain(|flag| !Arc::ptr_eq(flag, &self.0));
    }
}

/// Interrupts all work, as threads that Python does not wait for may do, and waits until it has ended, or for so many seconds.
#[pyfunction]
pub(crate) fn end(py: Python<'_>, seconds: f64) {
    py.detach(|| {
        let began = Instant::now();
        loop {
            let work = WORK.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if work.is_empty() || began.elapsed().as_secs_f64() > seconds {
                return;
            }
            for flag in &work {
                flag.store(true, Ordering::Relaxed);
            }
            thread::sleep(TICK / 10);
        }
    });
}

/// How often Python is entered meanwhile.
const TICK: Duration = Duration::from_millis(100);

/// Does `work`, which ends soon once `watch` is interrupted; `tick` is called ten times a second. An exception of either, such as
/// `KeyboardInterrupt`, interrupts the work and is raised when it has ended.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    watch: &Watch,
    work: impl FnOnce() -> T + Send,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let entered = Entered::new(watch);
    let mut raised = None;
    let outcome = thread::scope(|scope| {
        let worker = thread::Builder::new().spawn_scoped(scope, move || {
            // The receiver waits until it has this, unless Python has ended meanwhile.
            let _ = sender.send(work());
            drop(entered);
        });
        let worker =
            worker.map_err(|error| errors::search(format!("cannot start a thread: {error}")))?;
        loop {
            let heard;
            (heard, receiver) = py.detach(move || (receiver.recv_timeout(TICK), receiver));
            match heard {
                Ok(outcome) => return Ok(outcome),
                Err(RecvTimeoutError::Timeout) => {
                    if raised.is_none()
                        && let Err(error) = py.check_signals().and_then(|()| tick(py))
                    {
                        watch.interrupt();
                        raised = Some(error);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    // It panicked, which it has told standard error of.
                    let _ = worker.join();
                    return Err(errors::search("a thread of the search panicked"));
                }
            }
        }
    })?;
    match raised.or_else(|| tick(py).err()) {
        Some(error) => Err(error),
        None => Ok(outcome),
    }
}

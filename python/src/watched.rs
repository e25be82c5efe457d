//! Long work on a thread of its own, while Python's main thread looks for Ctrl-C and shows progress.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use driftless::search::Watch;
use pyo3::prelude::*;

use crate::errors;

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
    let mut raised = None;
    let outcome = thread::scope(|scope| {
        let worker = thread::Builder::new().spawn_scoped(scope, move || {
            // The receiver waits until it has this.
            let _ = sender.send(work());
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

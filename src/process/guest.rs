//! A client that connected by itself, on this program's standard streams or over a socket.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use super::lines::{Lines, read_lines, thread, wait_for, write_lines};
use super::socket::Socket;
use crate::search::Failure;

/// How long the last lines to it may take to be written.
const GRACE: Duration = Duration::from_secs(2);

/// A client.
#[derive(Debug)]
pub(super) struct Guest {
    pub(super) lines: Lines,
    writer: JoinHandle<()>,
    is_over: Arc<AtomicBool>,
}

impl Guest {
    /// Whoever is on the other side of standard input and output.
    pub(super) fn on_standard_streams() -> Result<Self, Failure> {
        let (lines, ends) = Lines::new();
        thread(move || read_lines(std::io::stdin(), &ends.incoming, &ends.said))?;
        let writer = thread(move || write_lines(std::io::stdout(), &ends.outgoing))?;
        Ok(Self { lines, writer, is_over: Arc::default() })
    }

    /// Whoever comes to a socket and shows its token.
    pub(super) fn on_socket(socket: Socket) -> Result<Self, Failure> {
        let (lines, ends) = Lines::new();
        let is_over = Arc::<AtomicBool>::default();
        let over = is_over.clone();
        let writer = thread(move || socket.serve(ends, &|| !over.load(Ordering::Relaxed)))?;
        Ok(Self { lines, writer, is_over })
    }

    /// Says nothing more; what was said is written.
    pub(super) fn end(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.lines.close();
        wait_for(&self.writer, GRACE);
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        self.end();
    }
}

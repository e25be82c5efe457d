//! The lines of a conversation, read and written by threads of their own.

use std::collections::VecDeque;
use std::io::{BufRead as _, BufReader, Read, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::search::Failure;

/// Longest line that is read \[byte\].
const LONGEST_LINE: u64 = 1 << 26;

/// Lines that wait to be looked at; whoever says more has to wait.
const WAITING_LINES: usize = 64;

/// How much may wait to be read by the other side before it is not heard any more \[byte\].
const MOST_UNREAD: usize = 1 << 24;

/// How much of a log is kept \[byte\].
const KEPT: usize = 2_000;

/// What the other side said.
#[derive(Debug)]
pub(super) enum Line {
    /// A line that begins with `{`.
    Message(String),
    /// One that is not UTF-8.
    NotText,
    /// One that is too long.
    TooLong,
    /// Nothing more.
    End,
}

/// This side of a conversation.
#[derive(Debug)]
pub(super) struct Lines {
    incoming: Receiver<Line>,
    outgoing: Option<Sender<String>>,
    /// What was said and is not written yet \[byte\].
    waiting: Arc<AtomicUsize>,
    said: Arc<Mutex<Tail>>,
}

/// Lines that are to be written, and how much they are.
pub(super) struct Outgoing {
    lines: Receiver<String>,
    waiting: Arc<AtomicUsize>,
}

/// The other side, for threads that read and write.
pub(super) struct Ends {
    pub(super) incoming: SyncSender<Line>,
    pub(super) outgoing: Outgoing,
    pub(super) said: Arc<Mutex<Tail>>,
}

impl Lines {
    /// Both sides of a conversation, before any reader or writer is attached.
    pub(super) fn new() -> (Self, Ends) {
        let (to_incoming, incoming) = sync_channel(WAITING_LINES);
        let (to_outgoing, outgoing) = channel();
        let said = Arc::<Mutex<Tail>>::default();
        let waiting = Arc::<AtomicUsize>::default();
        let outgoing = Outgoing { lines: outgoing, waiting: waiting.clone() };
        let ends = Ends { incoming: to_incoming, outgoing, said: said.clone() };
        (Self { incoming, outgoing: Some(to_outgoing), waiting, said }, ends)
    }

    /// Says a line, which is written while this side goes on. One that nobody reads any more is lost.
    pub(super) fn say(&self, line: String) {
        if let Some(outgoing) = &self.outgoing {
            self.waiting.fetch_add(line.len(), Ordering::Relaxed);
            let _ = outgoing.send(line);
        }
    }

    /// Whether so much waits to be read that nothing more should be asked.
    pub(super) fn is_behind(&self) -> bool {
        self.waiting.load(Ordering::Relaxed) > MOST_UNREAD
    }

    /// The next line, waited for until `deadline`.
    pub(super) fn next(&self, deadline: Instant) -> Option<Line> {
        match self.incoming.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(line) => Some(line),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Line::End),
        }
    }

    /// Says nothing more.
    pub(super) fn close(&mut self) {
        self.outgoing = None;
    }

    /// The end of the log, in one line.
    pub(super) fn last_words(&self) -> String {
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(said.0.as_slices().0).into_owned()
            + &String::from_utf8_lossy(said.0.as_slices().1);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// Starts a thread.
pub(super) fn thread(work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, Failure> {
    let thread = std::thread::Builder::new().spawn(work);
    thread.map_err(|error| Failure::new(format!("cannot start a thread: {error}")))
}

/// Waits until a thread has ended, but not for ever.
pub(super) fn wait_for(thread: &JoinHandle<()>, patience: Duration) {
    let deadline = Instant::now() + patience;
    while !thread.is_finished() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The end of a log.
#[derive(Debug, Default)]
pub(super) struct Tail(VecDeque<u8>);

impl Tail {
    fn push(said: &Mutex<Self>, bytes: &[u8]) {
        let mut tail = said.lock().unwrap_or_else(PoisonError::into_inner);
        tail.0.extend(&bytes[bytes.len().saturating_sub(KEPT)..]);
        let surplus = tail.0.len().saturating_sub(KEPT);
        tail.0.drain(..surplus);
    }
}

/// Hands on every line that begins with `{`; others are the process's own log.
pub(super) fn read_lines(output: impl Read, lines: &SyncSender<Line>, said: &Mutex<Tail>) {
    let mut output = BufReader::with_capacity(1 << 16, output);
    loop {
        let mut bytes = Vec::new();
        let count = (&mut output).take(LONGEST_LINE + 1).read_until(b'\n', &mut bytes);
        let line = match count {
            Ok(0) | Err(_) => Line::End,
            Ok(_) if bytes.len() as u64 > LONGEST_LINE => Line::TooLong,
            Ok(_) if bytes.trim_ascii_start().first() != Some(&b'{') => {
                Tail::push(said, &bytes);
                continue;
            }
            Ok(_) => String::from_utf8(bytes).map_or(Line::NotText, Line::Message),
        };
        let is_last = !matches!(line, Line::Message(_));
        if lines.send(line).is_err() || is_last {
            break;
        }
    }
    // Whoever writes on finds a reader.
    let _ = std::io::copy(&mut output, &mut std::io::sink());
}

/// Keeps the end of a log.
pub(super) fn read_log(mut log: impl Read, said: &Mutex<Tail>) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = log.read(&mut bytes) {
        Tail::push(said, &bytes[..count]);
    }
}

/// Writes lines until there are no more or nobody reads them.
pub(super) fn write_lines(mut input: impl Write, outgoing: &Outgoing) {
    while let Ok(line) = outgoing.lines.recv() {
        if input.write_all(line.as_bytes()).and_then(|()| input.flush()).is_err() {
            break;
        }
        outgoing.waiting.fetch_sub(line.len(), Ordering::Relaxed);
    }
    outgoing.waiting.store(0, Ordering::Relaxed);
}

//! A process in a group of its own: its lines, its last words, and its end.

use std::collections::VecDeque;
use std::io::{BufRead as _, BufReader, Read, Write as _};
use std::process::{ChildStdin, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::command::Command;
use crate::search::Failure;

/// Longest line that is read \[byte\].
const LONGEST_LINE: u64 = 1 << 26;

/// Lines that wait to be looked at; a process that says more has to wait.
const WAITING_LINES: usize = 64;

/// How much of what a process says to nobody is kept \[byte\].
const KEPT: usize = 2_000;

/// How long a process may take to end after it was asked to: by the end of its input, then by a signal.
const GRACE: Duration = Duration::from_secs(2);

/// How long the last words of a process that has ended are waited for; whoever it has started may go on.
const LAST_WORDS: Duration = Duration::from_millis(200);

/// What a process said.
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

/// A running process.
#[derive(Debug)]
pub(super) struct Child {
    process: std::process::Child,
    group: group::Group,
    lines: Receiver<Line>,
    input: Option<Sender<String>>,
    said: Arc<Mutex<Tail>>,
    /// Reads what it says to nobody.
    errors: Option<JoinHandle<()>>,
    is_over: bool,
}

impl Child {
    /// Starts a command.
    pub(super) fn start(command: &Command) -> Result<Self, Failure> {
        let mut start = command.to_std();
        start.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // Python would keep its lines to itself until there are many.
        start.env("PYTHONUNBUFFERED", "1");
        group::lead(&mut start);
        let mut process = start
            .spawn()
            .map_err(|error| Failure::new(format!("cannot start `{command}`: {error}")))?;
        let group = group::Group::of(&process).inspect_err(|_| {
            let _ = process.kill().and_then(|()| process.wait());
        })?;
        let pipes = (process.stdin.take(), process.stdout.take(), process.stderr.take());
        let (to_lines, lines) = sync_channel(WAITING_LINES);
        let (input, to_input) = channel();
        let said = Arc::<Mutex<Tail>>::default();
        let mut child =
            Self { process, group, lines, input: Some(input), said, errors: None, is_over: false };
        let (Some(stdin), Some(output), Some(errors)) = pipes else {
            return Err(Failure::new(format!("found no pipes to `{command}`")));
        };
        let said = child.said.clone();
        thread(move || read_lines(output, &to_lines, &said))?;
        thread(move || write_lines(stdin, &to_input))?;
        let said = child.said.clone();
        child.errors = Some(thread(move || read_errors(errors, &said))?);
        Ok(child)
    }

    /// Says a line, which is written while this side goes on. One that nobody reads any more is lost.
    pub(super) fn say(&self, line: String) {
        if let Some(input) = &self.input {
            let _ = input.send(line);
        }
    }

    /// The next line, waited for until `deadline`.
    pub(super) fn next(&self, deadline: Instant) -> Option<Line> {
        match self.lines.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(line) => Some(line),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Line::End),
        }
    }

    /// Ends it, with all that it has started: it may end by itself once its input has, and is killed if it does not. How it
    /// ended, where it did so by itself. Ended once, it is left alone: others may have its number.
    pub(super) fn end(&mut self) -> Option<std::process::ExitStatus> {
        if self.is_over {
            return None;
        }
        // What it still says is read and forgotten, so that it does not wait for a reader.
        self.input = None;
        let deadline = Instant::now() + GRACE;
        while !matches!(self.next(deadline), None | Some(Line::End)) {}
        let by_itself = self.has_ended(deadline);
        if !by_itself {
            self.group.terminate();
            self.has_ended(Instant::now() + GRACE);
        }
        self.stop();
        let status = self.process.wait().ok();
        let deadline = Instant::now() + LAST_WORDS;
        while self.errors.as_ref().is_some_and(|thread| !thread.is_finished())
            && Instant::now() < deadline
        {
            std::thread::sleep(Duration::from_millis(1));
        }
        status.filter(|_| by_itself)
    }

    /// What it has said last to nobody, in one line; complete once it has ended.
    pub(super) fn last_words(&self) -> String {
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(said.0.as_slices().0).into_owned()
            + &String::from_utf8_lossy(said.0.as_slices().1);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Whether it ends until `deadline`. It stays known to the system, so that its group has its number.
    fn has_ended(&mut self, deadline: Instant) -> bool {
        let mut pause = Duration::from_micros(200);
        loop {
            if group::has_ended(&mut self.process) {
                return true;
            }
            if Instant::now() >= deadline {
                return false;
            }
            std::thread::sleep(pause);
            pause = (2 * pause).min(Duration::from_millis(20));
        }
    }

    /// Kills all that is left.
    fn stop(&mut self) {
        if !self.is_over {
            self.is_over = true;
            self.group.kill();
            let _ = self.process.kill();
        }
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.stop();
        let _ = self.process.wait();
    }
}

/// Starts a thread.
fn thread(work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, Failure> {
    let thread = std::thread::Builder::new().spawn(work);
    thread.map_err(|error| Failure::new(format!("cannot start a thread: {error}")))
}

/// The end of what was said.
#[derive(Debug, Default)]
struct Tail(VecDeque<u8>);

impl Tail {
    fn push(said: &Mutex<Self>, bytes: &[u8]) {
        let mut tail = said.lock().unwrap_or_else(PoisonError::into_inner);
        tail.0.extend(&bytes[bytes.len().saturating_sub(KEPT)..]);
        let surplus = tail.0.len().saturating_sub(KEPT);
        tail.0.drain(..surplus);
    }
}

/// Hands on every line that begins with `{`; others are the process's own log.
fn read_lines(output: impl Read, lines: &SyncSender<Line>, said: &Mutex<Tail>) {
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

fn read_errors(mut errors: impl Read, said: &Mutex<Tail>) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = errors.read(&mut bytes) {
        Tail::push(said, &bytes[..count]);
    }
}

fn write_lines(mut stdin: ChildStdin, lines: &Receiver<String>) {
    while let Ok(line) = lines.recv() {
        if stdin.write_all(line.as_bytes()).and_then(|()| stdin.flush()).is_err() {
            break;
        }
    }
}

#[cfg(unix)]
mod group {
    //! Process groups: what a process has started ends with it.

    use std::os::unix::process::CommandExt as _;
    use std::process::{Child, Command, Stdio};

    use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

    use crate::search::Failure;

    /// Kills the group that its argument names once this program, however it ends, is no more.
    const GUARD: &str = "read -r line; kill -s KILL -- \"-$1\"";

    /// A process's group, and who kills it where this program cannot any more.
    #[derive(Debug)]
    pub(super) struct Group {
        leader: Pid,
        guard: Child,
    }

    /// The process is to lead a group.
    pub(super) fn lead(command: &mut Command) {
        command.process_group(0);
    }

    /// Whether a process has ended. It is not reaped: until then no other has its number.
    pub(super) fn has_ended(process: &mut Child) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        !matches!(waitid(WaitId::Pid(Pid::from_child(process)), options), Ok(None))
    }

    impl Group {
        pub(super) fn of(process: &Child) -> Result<Self, Failure> {
            let leader = Pid::from_child(process);
            let mut guard = Command::new("/bin/sh");
            guard.args(["-c", GUARD, "guard", &leader.as_raw_pid().to_string()]);
            guard.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
            // Signals of the terminal are none of its business.
            guard.process_group(0);
            match guard.spawn() {
                Ok(guard) => Ok(Self { leader, guard }),
                Err(error) => {
                    let _ = kill_process_group(leader, Signal::KILL);
                    Err(Failure::new(format!("cannot start /bin/sh: {error}")))
                }
            }
        }

        pub(super) fn terminate(&self) {
            let _ = kill_process_group(self.leader, Signal::TERM);
        }

        pub(super) fn kill(&mut self) {
            let _ = kill_process_group(self.leader, Signal::KILL);
            let _ = self.guard.kill();
            let _ = self.guard.wait();
        }
    }
}

#[cfg(not(unix))]
mod group {
    //! Without process groups: what a process has started may outlive it.

    use std::process::{Child, Command};

    use crate::search::Failure;

    #[derive(Debug)]
    pub(super) struct Group;

    pub(super) fn lead(_: &mut Command) {}

    pub(super) fn has_ended(process: &mut Child) -> bool {
        !matches!(process.try_wait(), Ok(None))
    }

    impl Group {
        pub(super) fn of(_: &Child) -> Result<Self, Failure> {
            Ok(Self)
        }

        pub(super) fn terminate(&self) {}

        pub(super) fn kill(&mut self) {}
    }
}

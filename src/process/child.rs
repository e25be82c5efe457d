//! A process in a group of its own: its lines, its last words, and its end.

use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::command::Command;
use super::lines::{Line, Lines, read_lines, read_log, thread, wait_for, write_lines};
use super::socket::Socket;
use crate::search::Failure;

/// How long a process may take to end after it was asked to: by the end of its input, then by a signal.
const GRACE: Duration = Duration::from_secs(2);

/// How long the last words of a process that has ended are waited for; whoever it has started may go on.
const LAST_WORDS: Duration = Duration::from_millis(200);

/// A running process.
#[derive(Debug)]
pub(super) struct Child {
    process: std::process::Child,
    group: group::Group,
    /// What is said; its log is complete once it has ended.
    pub(super) lines: Lines,
    /// Reads its standard error.
    errors: Option<JoinHandle<()>>,
    /// Whether it has closed its standard output, or was ended.
    is_silent: Arc<AtomicBool>,
    is_over: bool,
}

impl Child {
    /// Starts a command.
    pub(super) fn start(command: &Command) -> Result<Self, Failure> {
        let socket = command.has_socket().then(Socket::open).transpose()?;
        let mut start = command.to_std();
        start.stdout(Stdio::piped()).stderr(Stdio::piped());
        start.stdin(if socket.is_some() { Stdio::null() } else { Stdio::piped() });
        if let Some(socket) = &socket {
            start.envs(socket.variables());
        }
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
        let (lines, ends) = Lines::new();
        let is_silent = Arc::<AtomicBool>::default();
        let said = ends.said.clone();
        let silence = is_silent.clone();
        let mut child = Self { process, group, lines, errors: None, is_silent, is_over: false };
        match (pipes, socket) {
            ((Some(input), Some(output), Some(errors)), None) => {
                let own = said.clone();
                thread(move || read_lines(output, &ends.incoming, &own))?;
                thread(move || write_lines(input, &ends.outgoing))?;
                child.errors = Some(thread(move || read_log(errors, &said))?);
            }
            ((_, Some(output), Some(errors)), Some(socket)) => {
                let own = said.clone();
                let closed = silence.clone();
                thread(move || {
                    read_log(output, &own);
                    closed.store(true, Ordering::Relaxed);
                })?;
                thread(move || socket.serve(ends, &|| !silence.load(Ordering::Relaxed)))?;
                child.errors = Some(thread(move || read_log(errors, &said))?);
            }
            _ => return Err(Failure::new(format!("found no pipes to `{command}`"))),
        }
        Ok(child)
    }

    /// Ends it, with all that it has started: it may end by itself once its input has, and is killed if it does not. How it
    /// ended, where it did so by itself. Ended once, it is left alone: others may have its number.
    pub(super) fn end(&mut self) -> Option<std::process::ExitStatus> {
        if self.is_over {
            return None;
        }
        // What it still says is read and forgotten, so that it does not wait for a reader.
        self.lines.close();
        let deadline = Instant::now() + GRACE;
        while !matches!(self.lines.next(deadline), None | Some(Line::End)) {}
        let by_itself = self.has_ended(deadline);
        if !by_itself {
            self.group.terminate();
            self.has_ended(Instant::now() + GRACE);
        }
        self.stop();
        let status = self.process.wait().ok();
        if let Some(errors) = &self.errors {
            wait_for(errors, LAST_WORDS);
        }
        status.filter(|_| by_itself)
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
            self.is_silent.store(true, Ordering::Relaxed);
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

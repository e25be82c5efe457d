//! A loopback socket, for programs that cannot be spoken with over their standard streams, such as MATLAB's.

use std::collections::VecDeque;
use std::io::{Cursor, ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use serde::Deserialize;

use super::lines::{Ends, read_lines, thread, write_lines};
use crate::search::Failure;

/// The variable in which a program finds the port.
const PORT: &str = "DRIFTLESS_PORT";

/// The variable in which a program finds the token that it has to show.
pub const TOKEN: &str = "DRIFTLESS_TOKEN";

/// How often clients are looked for.
const LOOK: Duration = Duration::from_millis(5);

/// How long a token may take to arrive.
const PATIENCE: Duration = Duration::from_secs(2);

/// Longest first line \[byte\].
const LONGEST: usize = 4096;

/// Clients that may take their time at once.
const MOST_WAITING: usize = 64;

/// A socket that one client may come to, if it knows the token: other users of the machine can reach it, too.
#[derive(Debug)]
pub struct Socket {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
}

fn new_token() -> Result<String, Failure> {
    let mut bytes = [0; 16];
    let filled = getrandom::fill(&mut bytes);
    filled
        .map_err(|error| Failure::new(format!("found no random numbers for a token: {error}")))?;
    Ok(format!("{:032x}", u128::from_le_bytes(bytes)))
}

/// The first line of a client.
#[derive(Deserialize)]
struct Pass {
    token: String,
}

impl Socket {
    /// At a port that the system chooses, with a token that nobody knows.
    pub(super) fn open() -> Result<Self, Failure> {
        Self::at(0, new_token()?)
    }

    /// At a port of 127.0.0.1, 0 for one that the system chooses, with this token or, without one, one that nobody knows.
    pub fn bind(port: u16, token: Option<String>) -> Result<Self, Failure> {
        Self::at(port, token.map_or_else(new_token, Ok)?)
    }

    fn at(port: u16, token: String) -> Result<Self, Failure> {
        let refused = |error| Failure::new(format!("cannot listen on 127.0.0.1:{port}: {error}"));
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        Ok(Self { listener, address, token })
    }

    /// Where it is.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What a client has to show.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// What a program is told by its environment.
    pub(super) fn variables(&self) -> [(&'static str, String); 2] {
        [(PORT, self.address.port().to_string()), (TOKEN, self.token.clone())]
    }

    /// Waits for a client while it `is_wanted`, and speaks with it until nothing more is said.
    pub(super) fn serve(self, ends: Ends, is_wanted: &dyn Fn() -> bool) {
        let Some(Admitted { mut stream, more }) = self.client(is_wanted) else { return };
        let Ends { incoming, outgoing, said } = ends;
        let Ok(own) = stream.try_clone() else { return };
        let output = Cursor::new(more).chain(own);
        if thread(move || read_lines(output, &incoming, &said)).is_ok() {
            write_lines(&mut stream, &outgoing);
            let _ = stream.shutdown(Shutdown::Write);
        }
    }

    /// The first client that shows the token. None has to wait for another that takes its time.
    fn client(&self, is_wanted: &dyn Fn() -> bool) -> Option<Admitted> {
        let mut waiting = VecDeque::new();
        loop {
            // A client that came before nobody was wanted any more is still let in.
            let is_last = !is_wanted();
            while let Ok((stream, _)) = self.listener.accept() {
                if stream.set_nonblocking(true).is_ok() {
                    waiting.push_back(Visitor::new(stream));
                }
                if waiting.len() > MOST_WAITING {
                    waiting.pop_front();
                }
            }
            for mut visitor in std::mem::take(&mut waiting) {
                match visitor.has_shown(&self.token) {
                    Some(true) => return visitor.admitted(),
                    Some(false) => visitor.refuse(),
                    None => waiting.push_back(visitor),
                }
            }
            if is_last {
                return None;
            }
            std::thread::sleep(LOOK);
        }
    }
}

/// A client that has shown the token, and what it said after it.
struct Admitted {
    stream: TcpStream,
    more: Vec<u8>,
}

/// A client that has not shown a token yet.
struct Visitor {
    stream: TcpStream,
    said: Vec<u8>,
    deadline: Instant,
}

impl Visitor {
    fn new(stream: TcpStream) -> Self {
        Self { stream, said: Vec::new(), deadline: Instant::now() + PATIENCE }
    }

    /// Whether its first line has the token; none while the line is not complete.
    fn has_shown(&mut self, token: &str) -> Option<bool> {
        let mut bytes = [0; 4096];
        let is_over = match self.stream.read(&mut bytes) {
            Ok(count) => {
                self.said.extend(&bytes[..count]);
                count == 0
            }
            Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        };
        if let Some(end) = self.said.iter().position(|byte| *byte == b'\n') {
            let pass = serde_json::from_slice::<Pass>(&self.said[..end]);
            return Some(pass.is_ok_and(|pass| pass.token == token));
        }
        let is_late = Instant::now() >= self.deadline;
        (is_over || is_late || self.said.len() > LONGEST).then_some(false)
    }

    fn admitted(mut self) -> Option<Admitted> {
        let end = self.said.iter().position(|byte| *byte == b'\n')? + 1;
        self.stream.set_nonblocking(false).ok()?;
        self.stream.set_nodelay(true).ok()?;
        Some(Admitted { more: self.said.split_off(end), stream: self.stream })
    }

    fn refuse(mut self) {
        let refusal = serde_json::json!({
            "stop": "failed",
            "error": format!("expected a line {{\"token\": \"…\"}} with the token of {TOKEN}"),
        });
        let _ = writeln!(self.stream, "{refusal}");
    }
}

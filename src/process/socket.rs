//! A loopback socket, for programs that cannot be spoken with over their standard streams, such as MATLAB's.

use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

use serde::Deserialize;

use super::lines::{Ends, read_lines, thread, write_lines};
use crate::search::Failure;

/// Where a program finds the port, and the token that it has to show.
const PORT: &str = "DRIFTLESS_PORT";
const TOKEN: &str = "DRIFTLESS_TOKEN";

/// How often somebody is looked for.
const LOOK: Duration = Duration::from_millis(5);

/// How long a token may take to arrive.
const PATIENCE: Duration = Duration::from_secs(2);

/// Longest first line \[byte\].
const LONGEST: u64 = 4096;

/// A socket that one client may come to, if it knows the token: other users of the machine can reach it, too.
#[derive(Debug)]
pub struct Socket {
    listener: TcpListener,
    address: SocketAddr,
    token: String,
}

/// The first line of a client.
#[derive(Deserialize)]
struct Pass {
    token: String,
}

impl Socket {
    /// At a port that the system chooses, with a token nobody knows.
    pub(super) fn open() -> Result<Self, Failure> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| {
            Failure::new(format!("found no random numbers for a token: {error}"))
        })?;
        Self::at(0, format!("{:032x}", u128::from_le_bytes(bytes)))
    }

    /// At a port of 127.0.0.1, 0 for one that the system chooses, with the token that the environment tells in
    /// `DRIFTLESS_TOKEN` or, where it tells none, one nobody knows.
    pub fn bind(port: u16) -> Result<Self, Failure> {
        match std::env::var(TOKEN) {
            Ok(token) if !token.is_empty() => Self::at(port, token),
            _ if port == 0 => Self::open(),
            _ => Self::at(port, Self::open()?.token),
        }
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
        let Some(client) = self.client(is_wanted) else { return };
        let Ends { incoming, outgoing, said } = ends;
        let Ok(mut stream) = client.get_ref().try_clone() else { return };
        if thread(move || read_lines(client, &incoming, &said)).is_ok() {
            write_lines(&mut stream, &outgoing);
            let _ = stream.shutdown(Shutdown::Write);
        }
    }

    /// The first client that shows the token.
    fn client(&self, is_wanted: &dyn Fn() -> bool) -> Option<BufReader<TcpStream>> {
        loop {
            // Who came before nobody was wanted any more is still let in.
            let is_last = !is_wanted();
            match self.listener.accept() {
                Ok((stream, _)) => {
                    if let Some(client) = self.admit(stream) {
                        return Some(client);
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock && !is_last => {
                    std::thread::sleep(LOOK);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) if is_last => return None,
                Err(_) => std::thread::sleep(LOOK),
            }
        }
    }

    /// A client, if its first line has the token.
    fn admit(&self, stream: TcpStream) -> Option<BufReader<TcpStream>> {
        stream.set_nonblocking(false).ok()?;
        stream.set_nodelay(true).ok()?;
        stream.set_read_timeout(Some(PATIENCE)).ok()?;
        let mut client = BufReader::with_capacity(1 << 16, stream);
        let mut line = Vec::new();
        let read = (&mut client).take(LONGEST).read_until(b'\n', &mut line);
        let pass = read.ok().and_then(|_| serde_json::from_slice::<Pass>(&line).ok());
        if pass.is_none_or(|pass| pass.token != self.token) {
            let refusal = serde_json::json!({
                "stop": "failed",
                "error": format!("expected a line {{\"token\": \"…\"}} with the token of {TOKEN}"),
            });
            let _ = writeln!(client.get_mut(), "{refusal}");
            return None;
        }
        client.get_ref().set_read_timeout(None).ok()?;
        Some(client)
    }
}

//! A small file server for this machine alone: it serves the built page as a good static host would.

mod reply;

use std::collections::HashMap;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, Ipv6Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::{Context as _, bail};
use reply::{Reply, Request};

/// The longest head of a request that is read.
const MAX_HEAD_BYTES: usize = 16 * 1024;
const MAX_HEADERS: usize = 64;
/// How long a connection may stay silent. Browsers open some that they never use.
const SILENCE: Duration = Duration::from_secs(30);

/// Serves a folder until it is dropped; then the port is closed, and so is every connection.
pub struct Server {
    url: String,
    addresses: Vec<SocketAddr>,
    shared: Arc<Shared>,
    acceptors: Vec<JoinHandle<()>>,
}

struct Shared {
    folder: PathBuf,
    stopping: AtomicBool,
    next_connection: AtomicU64,
    connections: Mutex<HashMap<u64, TcpStream>>,
}

impl Server {
    /// Starts to serve `folder` on this port of the local machine; port 0 is any free one.
    pub fn start(folder: &Path, port: u16) -> anyhow::Result<Server> {
        let listeners = listen(port)?;
        let addresses: Vec<_> = listeners.iter().map(TcpListener::local_addr).collect::<Result<_, _>>()?;
        // "localhost" may mean either address; it is ours only if both are.
        let host = if addresses.len() == 2 { "localhost" } else { "127.0.0.1" };
        let shared = Arc::new(Shared {
            folder: folder.to_path_buf(),
            stopping: AtomicBool::new(false),
            next_connection: AtomicU64::new(0),
            connections: Mutex::new(HashMap::new()),
        });
        let start_acceptor = |listener| {
            let shared = Arc::clone(&shared);
            std::thread::spawn(move || accept(&listener, &shared))
        };
        let acceptors = listeners.into_iter().map(start_acceptor).collect();
        Ok(Server { url: format!("http://{host}:{}/", addresses[0].port()), addresses, shared, acceptors })
    }

    /// The address of the folder, with a slash at its end.
    pub fn url(&self) -> &str {
        &self.url
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.stopping.store(true, Ordering::SeqCst);
        for address in &self.addresses {
            // An acceptor looks at `stopping` once it has accepted something. If nothing can connect, it has ended.
            TcpStream::connect(address).ok();
        }
        for acceptor in self.acceptors.drain(..) {
            acceptor.join().ok();
        }
        for connection in self.shared.connections().values() {
            connection.shutdown(Shutdown::Both).ok();
        }
    }
}

impl Shared {
    fn connections(&self) -> MutexGuard<'_, HashMap<u64, TcpStream>> {
        self.connections.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Listens on 127.0.0.1 and, where the machine has it, on ::1.
fn listen(port: u16) -> anyhow::Result<Vec<TcpListener>> {
    let taken = || format!("Port {port} is in use by another program. Choose another one with --port");
    let first = match TcpListener::bind((Ipv4Addr::LOCALHOST, port)) {
        Err(error) if error.kind() == ErrorKind::AddrInUse => bail!(taken()),
        other => other.with_context(|| format!("Could not listen on port {port}"))?,
    };
    match TcpListener::bind((Ipv6Addr::LOCALHOST, first.local_addr()?.port())) {
        Ok(second) => Ok(vec![first, second]),
        Err(error) if error.kind() == ErrorKind::AddrInUse && port != 0 => bail!(taken()),
        Err(_) => Ok(vec![first]),
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for connection in listener.incoming() {
        if shared.stopping.load(Ordering::SeqCst) {
            return;
        }
        // A connection that was gone before it was accepted concerns nobody.
        let Ok(connection) = connection else { continue };
        // Noted before its thread runs, so that a server that is dropped now knows of it.
        let id = shared.next_connection.fetch_add(1, Ordering::Relaxed);
        let Ok(handle) = connection.try_clone() else { continue };
        shared.connections().insert(id, handle);
        let shared = Arc::clone(shared);
        std::thread::spawn(move || {
            // An error here means that the browser went away.
            serve_one(connection, &shared.folder).ok();
            shared.connections().remove(&id);
        });
    }
}

/// Answers one request and closes: connections that are kept would outlive a stopped server.
fn serve_one(mut connection: TcpStream, folder: &Path) -> std::io::Result<()> {
    connection.set_read_timeout(Some(SILENCE))?;
    connection.set_write_timeout(Some(SILENCE))?;
    let Some(head) = read_head(&mut connection)? else { return Ok(()) };
    let reply = match parse_head(&head) {
        Some(request) => reply::answer(folder, &request),
        None => Reply::text(400, "This is no HTTP request"),
    };
    connection.write_all(reply.head().as_bytes())?;
    connection.write_all(&reply.body)?;
    connection.shutdown(Shutdown::Write)
}

/// Reads up to the empty line; nothing if the connection ends, falls silent or goes on for too long before that.
fn read_head(connection: &mut TcpStream) -> std::io::Result<Option<Vec<u8>>> {
    let mut head = Vec::new();
    let mut piece = [0; 2048];
    while !head.windows(4).any(|window| window == b"\r\n\r\n") {
        let count = connection.read(&mut piece)?;
        if count == 0 || head.len() > MAX_HEAD_BYTES {
            return Ok(None);
        }
        head.extend_from_slice(&piece[..count]);
    }
    Ok(Some(head))
}

fn parse_head(head: &[u8]) -> Option<Request> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    parsed.parse(head).ok()?.is_complete().then_some(())?;
    let header = |name: &str| {
        let found = parsed.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name))?;
        std::str::from_utf8(found.value).ok().map(str::to_owned)
    };
    Some(Request {
        method: parsed.method?.to_owned(),
        target: parsed.path?.to_owned(),
        accept_encoding: header("accept-encoding").unwrap_or_default(),
        if_none_match: header("if-none-match"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_serves_until_it_is_dropped() {
        let folder = std::env::temp_dir().join(format!("pinpose-server-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("index.html"), "hello").expect("a file");
        let server = Server::start(&folder, 0).expect("starts");
        let address = server.addresses[0];
        assert!(server.url().ends_with(&format!(":{}/", address.port())));

        let mut connection = TcpStream::connect(address).expect("connects");
        connection.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").expect("asks");
        let mut answer = String::new();
        connection.read_to_string(&mut answer).expect("is answered, and the connection ends");
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n") && answer.ends_with("\r\n\r\nhello"), "{answer}");

        let mut idle = TcpStream::connect(address).expect("connects");
        let taken = Server::start(&folder, address.port()).err().expect("one server per port").to_string();
        assert!(taken.contains("--port"), "{taken}");
        drop(server);
        assert_eq!(idle.read(&mut [0; 1]).unwrap_or(0), 0, "an open connection ends with the server");
        assert!(TcpStream::connect(address).is_err(), "the port is closed");
        std::fs::remove_dir_all(&folder).ok();
    }
}

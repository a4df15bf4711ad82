//! A researcher's web host: it hands out a study's folder, and takes results by PUT and POST, or fails to.

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// What was sent to it, whether it was taken or not.
#[derive(Debug, Clone)]
pub struct Sent {
    pub method: String,
    pub path: String,
    pub body: Vec<u8>,
    pub was_taken: bool,
}

/// Serves until it is dropped.
pub struct Host {
    url: String,
    shared: Arc<Shared>,
}

struct Shared {
    folder: PathBuf,
    /// Other origins may read (CORS).
    is_open: AtomicBool,
    /// So many results are refused before one is taken.
    failures: AtomicU32,
    sent: Mutex<Vec<Sent>>,
    is_over: AtomicBool,
}

impl Host {
    pub fn start(folder: &Path) -> anyhow::Result<Host> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let url = format!("http://127.0.0.1:{}", listener.local_addr()?.port());
        let shared = Arc::new(Shared {
            folder: folder.to_path_buf(),
            is_open: AtomicBool::new(true),
            failures: AtomicU32::new(0),
            sent: Mutex::default(),
            is_over: AtomicBool::new(false),
        });
        let served = shared.clone();
        std::thread::spawn(move || {
            for connection in listener.incoming().flatten() {
                if served.is_over.load(Ordering::SeqCst) {
                    return;
                }
                let served = served.clone();
                // An error here means that the browser went away.
                std::thread::spawn(move || served.answer(connection).ok());
            }
        });
        Ok(Host { url, shared })
    }

    /// Without a slash at its end.
    pub fn url(&self) -> &str {
        &self.url
    }

    pub fn fail_next(&self, count: u32) {
        self.shared.failures.store(count, Ordering::SeqCst);
    }

    pub fn set_open(&self, is_open: bool) {
        self.shared.is_open.store(is_open, Ordering::SeqCst);
    }

    pub fn sent(&self) -> Vec<Sent> {
        self.shared.sent.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::SeqCst);
        TcpStream::connect(self.url.trim_start_matches("http://")).ok();
    }
}

impl Shared {
    fn answer(&self, mut connection: TcpStream) -> std::io::Result<()> {
        connection.set_read_timeout(Some(Duration::from_secs(10)))?;
        let mut request = Vec::new();
        let mut piece = [0; 65536];
        let head_end = loop {
            if let Some(at) = request.windows(4).position(|window| window == b"\r\n\r\n") {
                break at + 4;
            }
            match connection.read(&mut piece)? {
                0 => return Ok(()),
                count => request.extend_from_slice(&piece[..count]),
            }
        };
        let head = String::from_utf8_lossy(&request[..head_end]).into_owned();
        let length = head.lines().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            name.eq_ignore_ascii_case("content-length").then(|| value.trim().parse::<usize>().ok())?
        });
        while request.len() < head_end + length.unwrap_or(0) {
            match connection.read(&mut piece)? {
                0 => return Ok(()),
                count => request.extend_from_slice(&piece[..count]),
            }
        }
        let mut words = head.split_whitespace();
        let (method, path) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        let (status, body) = self.reply(method, path, request.split_off(head_end));
        let open = match self.is_open.load(Ordering::SeqCst) {
            true => {
                "Access-Control-Allow-Origin: *\r\nAccess-Control-Allow-Methods: *\r\nAccess-Control-Allow-Headers: *\r\n"
            }
            false => "",
        };
        let answer = format!(
            "HTTP/1.1 {status} -\r\n{open}Content-Length: {}\r\nConnection: close\r\n\r\n",
            body.len()
        );
        connection.write_all(answer.as_bytes())?;
        connection.write_all(&body)
    }

    fn reply(&self, method: &str, path: &str, body: Vec<u8>) -> (u32, Vec<u8>) {
        match method {
            "GET" => {
                let path = path.split('?').next().unwrap_or(path).trim_start_matches('/');
                let is_within = !path.split('/').any(|part| part == "..");
                let read = std::fs::read(self.folder.join(path)).ok().filter(|_| is_within);
                read.map_or((404, b"nothing here".to_vec()), |bytes| (200, bytes))
            }
            "PUT" | "POST" => {
                let failing = |left: u32| left.checked_sub(1);
                let was_taken =
                    self.failures.fetch_update(Ordering::SeqCst, Ordering::SeqCst, failing).is_err();
                let (method, path) = (method.to_owned(), path.to_owned());
                let sent = Sent { method, path, body, was_taken };
                self.sent.lock().unwrap_or_else(PoisonError::into_inner).push(sent);
                (if was_taken { 200 } else { 503 }, Vec::new())
            }
            _ => (204, Vec::new()),
        }
    }
}

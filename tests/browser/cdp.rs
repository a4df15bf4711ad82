//! One headless Chromium and the DevTools protocol spoken with it, synchronously: every call waits, none for ever.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};
use serde_json::{Value, json};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// How long any call may take. The slowest are screenshots while a software renderer is busy.
pub const CALL_TIMEOUT: Duration = Duration::from_secs(60);
const LAUNCH_TIMEOUT: Duration = Duration::from_secs(30);

/// What the page draws with; the browser is started accordingly, always without a graphics card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    WebGpu,
    WebGl,
}

impl Backend {
    /// As in `?renderer=` and in `perf().backend`.
    pub fn name(self) -> &'static str {
        match self {
            Backend::WebGpu => "webgpu",
            Backend::WebGl => "webgl",
        }
    }

    fn flags(self) -> &'static [&'static str] {
        match self {
            Backend::WebGl => &["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
            // Without the last two the canvas is blank in screenshots.
            Backend::WebGpu => &[
                "--enable-unsafe-webgpu",
                "--use-webgpu-adapter=swiftshader",
                "--enable-features=Vulkan",
                "--use-vulkan=swiftshader",
                "--use-angle=swiftshader",
            ],
        }
    }
}

const FLAGS: [&str; 9] = [
    "--headless",
    "--remote-debugging-port=0",
    // The browser only ever opens our own page, and as root it does not start with its sandbox.
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    // Containers often have a tiny shared-memory folder.
    "--disable-dev-shm-usage",
];

/// Something that the browser says unasked.
pub struct Event {
    pub method: String,
    pub session: Option<String>,
    pub params: Value,
}

/// A running browser; it ends when this is dropped.
pub struct Browser {
    process: Child,
    socket: WebSocket<TcpStream>,
    last_id: u64,
    events: VecDeque<Event>,
}

impl Browser {
    /// Starts a browser that keeps its storage in `profile`.
    pub fn launch(backend: Backend, profile: &Path) -> anyhow::Result<Browser> {
        let program = pinpose_web::chromium::find().context("Chromium is not installed")?;
        let port_file = profile.join("DevToolsActivePort");
        // A profile that was used before still says where its last browser listened.
        std::fs::remove_file(&port_file).ok();
        let mut process = Command::new(&program)
            .args(FLAGS)
            .args(backend.flags())
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| format!("Could not start {}", program.display()))?;
        match connect(&port_file, &mut process) {
            Ok(socket) => Ok(Browser { process, socket, last_id: 0, events: VecDeque::new() }),
            Err(error) => {
                process.kill().ok();
                process.wait().ok();
                Err(error)
            }
        }
    }

    /// Ends it as a crash or a power cut would: nothing more is written.
    pub fn kill(&mut self) -> anyhow::Result<()> {
        // On Unix this is SIGKILL.
        self.process.kill()?;
        self.process.wait()?;
        Ok(())
    }

    /// Calls a method of the browser, or of the page that `session` is attached to, and waits for its result.
    pub fn call(&mut self, session: Option<&str>, method: &str, params: Value) -> anyhow::Result<Value> {
        let id = self.send(session, method, params)?;
        let deadline = Instant::now() + CALL_TIMEOUT;
        loop {
            let answer = self.receive(deadline).with_context(|| format!("{method} was not answered"))?;
            let Some(mut answer) = answer else { bail!("{method} was not answered in {CALL_TIMEOUT:?}") };
            if answer["id"] != id {
                self.keep_event(answer);
                continue;
            }
            ensure!(answer.get("error").is_none(), "{method} failed: {}", answer["error"]["message"]);
            return Ok(answer["result"].take());
        }
    }

    /// Sends without waiting for the answer, and returns the call's id.
    pub fn send(&mut self, session: Option<&str>, method: &str, params: Value) -> anyhow::Result<u64> {
        self.last_id += 1;
        let mut message = json!({ "id": self.last_id, "method": method, "params": params });
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        self.socket
            .send(Message::text(message.to_string()))
            .with_context(|| format!("The browser did not take {method}"))?;
        Ok(self.last_id)
    }

    /// The next event, or nothing if none comes until the deadline.
    pub fn next_event(&mut self, deadline: Instant) -> anyhow::Result<Option<Event>> {
        while self.events.is_empty() {
            let Some(message) = self.receive(deadline)? else { return Ok(None) };
            self.keep_event(message);
        }
        Ok(self.events.pop_front())
    }

    /// Answers to `send` are dropped here: nobody waits for them.
    fn keep_event(&mut self, mut message: Value) {
        if let Some(method) = message["method"].as_str().map(str::to_owned) {
            let session = message["sessionId"].as_str().map(str::to_owned);
            self.events.push_back(Event { method, session, params: message["params"].take() });
        }
    }

    fn receive(&mut self, deadline: Instant) -> anyhow::Result<Option<Value>> {
        loop {
            // A time-out of zero would mean none at all.
            let remaining = deadline.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
            self.socket.get_ref().set_read_timeout(Some(remaining))?;
            match self.socket.read() {
                Ok(Message::Text(text)) => return Ok(Some(serde_json::from_str(&text)?)),
                Ok(Message::Close(_)) => bail!("The browser closed the connection"),
                Ok(_) => {}
                Err(tungstenite::Error::Io(error))
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    return Ok(None);
                }
                Err(error) => return Err(error).context("The connection to the browser broke"),
            }
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Asked politely it ends its helper processes and writes its profile; otherwise it is ended.
        self.send(None, "Browser.close", json!({})).ok();
        let deadline = Instant::now() + Duration::from_secs(5);
        while Instant::now() < deadline {
            if let Ok(Some(_)) = self.process.try_wait() {
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

/// Waits for the file in which the browser says where it listens: a port, and a path on the second line.
fn connect(port_file: &Path, process: &mut Child) -> anyhow::Result<WebSocket<TcpStream>> {
    let deadline = Instant::now() + LAUNCH_TIMEOUT;
    let (port, path) = loop {
        let said = std::fs::read_to_string(port_file).unwrap_or_default();
        if let Some((port, path)) = said.split_once('\n')
            && !path.trim().is_empty()
        {
            break (port.trim().parse::<u16>().context("The browser named no port")?, path.trim().to_owned());
        }
        if let Some(status) = process.try_wait()? {
            bail!("The browser ended at once, with {status}");
        }
        ensure!(Instant::now() < deadline, "The browser did not start in {LAUNCH_TIMEOUT:?}");
        std::thread::sleep(Duration::from_millis(20));
    };
    let stream = TcpStream::connect(("127.0.0.1", port)).context("Could not connect to the browser")?;
    stream.set_read_timeout(Some(LAUNCH_TIMEOUT))?;
    stream.set_nodelay(true)?;
    // Screenshots and exported files come in one piece.
    let config = WebSocketConfig::default().max_message_size(None).max_frame_size(None);
    let url = format!("ws://127.0.0.1:{port}{path}");
    match tungstenite::client::client_with_config(url, stream, Some(config)) {
        Ok((socket, _)) => Ok(socket),
        Err(error) => bail!("The browser refused the connection: {error}"),
    }
}

//! One page in a browser of its own: what a flow looks at, and what it checks.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};

use crate::api::files_expression;
use crate::cdp::{Backend, Browser, Event};
use crate::data::File;

/// The page's size in CSS pixels, and in real ones: a software renderer draws this 13 times a second.
pub const SIZE: (u32, u32) = (800, 600);

/// A tab, the errors it reported, and the files it saved.
pub struct Page {
    browser: Browser,
    session: String,
    errors: Vec<String>,
    download_folder: PathBuf,
    /// Names by the browser's ids for downloads that have begun.
    download_names: Vec<(String, String)>,
    finished_downloads: Vec<String>,
}

/// A tab that the page is not in at the moment.
pub struct Tab(String);

impl Page {
    /// Opens `url` in a new browser that keeps its storage in `folder`. The page may still be loading.
    pub fn open(backend: Backend, folder: &Path, url: &str) -> anyhow::Result<Page> {
        let profile = folder.join("profile");
        let download_folder = folder.join("downloads");
        std::fs::create_dir_all(&profile)?;
        std::fs::create_dir_all(&download_folder)?;
        let mut browser = Browser::launch(backend, &profile)?;
        let targets = browser.call(None, "Target.getTargets", json!({}))?;
        let mut targets = targets["targetInfos"].as_array().into_iter().flatten();
        let tab = targets.find(|target| target["type"] == "page").context("The browser has no tab")?;
        let attach = json!({ "targetId": tab["targetId"], "flatten": true });
        let attached = browser.call(None, "Target.attachToTarget", attach)?;
        let session = attached["sessionId"].as_str().context("No session")?.to_owned();
        let saving =
            json!({ "behavior": "allowAndName", "downloadPath": download_folder, "eventsEnabled": true });
        browser.call(None, "Browser.setDownloadBehavior", saving)?;

        let (errors, download_names, finished_downloads) = Default::default();
        let mut page = Page { browser, session, errors, download_folder, download_names, finished_downloads };
        page.prepare()?;
        page.navigate(url)?;
        Ok(page)
    }

    /// Opens a second tab in the same browser, and goes on there.
    pub fn open_tab(&mut self, url: &str) -> anyhow::Result<Tab> {
        // In a window of its own: a tab that is covered does not draw.
        let create = json!({ "url": "about:blank", "newWindow": true });
        let target = self.browser.call(None, "Target.createTarget", create)?;
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = self.browser.call(None, "Target.attachToTarget", attach)?;
        let session = attached["sessionId"].as_str().context("No session")?.to_owned();
        let first = Tab(std::mem::replace(&mut self.session, session));
        self.prepare()?;
        self.navigate(url)?;
        Ok(first)
    }

    /// Goes on in another tab; gives back the one that it was in.
    pub fn switch_to(&mut self, tab: Tab) -> anyhow::Result<Tab> {
        let before = Tab(std::mem::replace(&mut self.session, tab.0));
        self.call("Page.bringToFront", json!({}))?;
        Ok(before)
    }

    /// Ends the browser as a crash would.
    pub fn kill(&mut self) -> anyhow::Result<()> {
        self.browser.kill()
    }

    /// Has the tab report what it does, and gives it its size.
    fn prepare(&mut self) -> anyhow::Result<()> {
        let page = self;
        for domain in ["Page", "Runtime", "Log"] {
            page.call(&format!("{domain}.enable"), json!({}))?;
        }
        // Attaches to the page's workers too, so that their errors are seen.
        let attach = json!({ "autoAttach": true, "waitForDebuggerOnStart": false, "flatten": true });
        page.call("Target.setAutoAttach", attach)?;
        let (width, height) = SIZE;
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        page.call("Emulation.setDeviceMetricsOverride", metrics)?;
        Ok(())
    }

    /// Goes to another address in the same tab.
    pub fn navigate(&mut self, url: &str) -> anyhow::Result<()> {
        let result = self.call("Page.navigate", json!({ "url": url }))?;
        ensure!(result.get("errorText").is_none(), "{url} did not open: {}", result["errorText"]);
        Ok(())
    }

    /// Loads the page again, and returns when its document has been replaced.
    pub fn reload(&mut self) -> anyhow::Result<()> {
        self.eval("window.isBeforeReload = true")?;
        self.call("Page.reload", json!({}))?;
        self.wait_until("!window.isBeforeReload", Duration::from_secs(30))
    }

    /// Evaluates an expression in the page and returns its value as JSON. A promise is waited for; an exception is
    /// an error.
    pub fn eval(&mut self, expression: &str) -> anyhow::Result<Value> {
        let params = json!({
            "expression": expression,
            "awaitPromise": true,
            "returnByValue": true,
            "userGesture": true,
        });
        let mut result = self.call("Runtime.evaluate", params)?;
        if let Some(details) = result.get("exceptionDetails") {
            bail!("{} in: {}", exception_text(details), shortened(expression));
        }
        Ok(result["result"]["value"].take())
    }

    /// Waits until an expression is true. While a page is being replaced an expression may fail; that is not yet true.
    pub fn wait_until(&mut self, condition: &str, timeout: Duration) -> anyhow::Result<()> {
        let deadline = Instant::now() + timeout;
        loop {
            let result = self.eval(&format!("Promise.resolve({condition}).then(Boolean)"));
            if matches!(result, Ok(Value::Bool(true))) {
                return Ok(());
            }
            if Instant::now() >= deadline {
                let last = result.err().map(|error| format!(": {error:#}")).unwrap_or_default();
                bail!("This did not become true in {timeout:?}: {}{last}", shortened(condition));
            }
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits until PinPose has drawn its first frame.
    pub fn wait_until_ready(&mut self) -> anyhow::Result<()> {
        // Until the API is there, `window.pinpose` is the canvas: browsers name elements by their id.
        self.wait_until("Boolean(window.pinpose?.ready)", Duration::from_secs(60))?;
        self.eval("window.pinpose.ready.then(() => true)")?;
        Ok(())
    }

    /// The page as it looks now.
    pub fn screenshot(&mut self) -> anyhow::Result<image::RgbaImage> {
        let result = self.call("Page.captureScreenshot", json!({ "format": "png" }))?;
        let png = BASE64.decode(result["data"].as_str().context("No picture")?)?;
        Ok(image::load_from_memory(&png).context("The screenshot is no PNG")?.into_rgba8())
    }

    /// Drops files onto the canvas, as if they were dragged in from a folder.
    pub fn drop_files(&mut self, files: &[File]) -> anyhow::Result<()> {
        self.hand_over(files)?;
        self.drop_handed_over()
    }

    /// Gives the page files to be dropped later: a person's browser has them already, so their way here is no cost of it.
    pub fn hand_over(&mut self, files: &[File]) -> anyhow::Result<()> {
        self.eval("window.handedOver = new DataTransfer(); 1")?;
        for file in files {
            let file = files_expression(std::slice::from_ref(file));
            self.eval(&format!("{file}.forEach((file) => window.handedOver.items.add(file))"))?;
        }
        self.next_frame()
    }

    pub fn drop_handed_over(&mut self) -> anyhow::Result<()> {
        self.eval(
            "(() => {
                const dataTransfer = window.handedOver;
                const canvas = document.querySelector('canvas');
                for (const type of ['dragenter', 'dragover', 'drop']) {
                    canvas.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
                }
            })()",
        )?;
        self.next_frame()
    }

    /// The newest file that the page saved and that was not asked for yet; waits for one if there is none.
    pub fn download(&mut self, timeout: Duration) -> anyhow::Result<File> {
        let deadline = Instant::now() + timeout;
        self.take_events()?;
        while self.finished_downloads.is_empty() {
            match self.browser.next_event(deadline)? {
                Some(event) => self.note(event)?,
                None => bail!("The page saved no file in {timeout:?}"),
            }
        }
        let id = self.finished_downloads.pop().unwrap_or_default();
        self.finished_downloads.clear();
        let named = self.download_names.iter().find(|(begun, _)| *begun == id);
        let name = named.map(|(_, name)| name.clone()).context("A download without a name")?;
        let bytes =
            std::fs::read(self.download_folder.join(&id)).with_context(|| format!("{name} is not there"))?;
        Ok(File { name, bytes })
    }

    /// What the page reported so far: console errors, exceptions nobody caught, requests that failed.
    pub fn errors(&mut self) -> anyhow::Result<&[String]> {
        self.take_events()?;
        Ok(&self.errors)
    }

    /// For flows that cause errors on purpose.
    pub fn forget_errors(&mut self) -> anyhow::Result<()> {
        self.take_events()?;
        self.errors.clear();
        Ok(())
    }

    /// Waits until the page had its turn to draw, and so to act on the events it was sent.
    pub fn next_frame(&mut self) -> anyhow::Result<()> {
        self.eval("new Promise((resolve) => requestAnimationFrame(() => resolve()))")?;
        Ok(())
    }

    pub fn call(&mut self, method: &str, params: Value) -> anyhow::Result<Value> {
        self.browser.call(Some(&self.session), method, params)
    }

    fn take_events(&mut self) -> anyhow::Result<()> {
        while let Some(event) = self.browser.next_event(Instant::now())? {
            self.note(event)?;
        }
        Ok(())
    }

    fn note(&mut self, event: Event) -> anyhow::Result<()> {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let params = &event.params;
        match event.method.as_str() {
            "Runtime.exceptionThrown" => self.errors.push(exception_text(&params["exceptionDetails"])),
            "Runtime.consoleAPICalled" if params["type"] == "error" || params["type"] == "assert" => {
                self.errors.push(console_text(&params["args"]));
            }
            "Log.entryAdded" if params["entry"]["level"] == "error" => {
                let entry = &params["entry"];
                self.errors
                    .push(format!("{} {}", text(&entry["text"]), text(&entry["url"])).trim().to_owned());
            }
            "Target.attachedToTarget" if event.session.is_some() => {
                self.browser.send(params["sessionId"].as_str(), "Runtime.enable", json!({}))?;
            }
            "Browser.downloadWillBegin" => {
                self.download_names.push((text(&params["guid"]), text(&params["suggestedFilename"])));
            }
            "Browser.downloadProgress" if params["state"] == "completed" => {
                self.finished_downloads.push(text(&params["guid"]));
            }
            _ => {}
        }
        Ok(())
    }
}

/// The exception's own message with its stack, or what the browser says about it.
fn exception_text(details: &Value) -> String {
    let description = details["exception"]["description"].as_str();
    let value = || details["exception"].get("value").map(Value::to_string);
    let text = || details["text"].as_str().unwrap_or("An exception").to_owned();
    description.map(str::to_owned).or_else(value).unwrap_or_else(text)
}

fn console_text(arguments: &Value) -> String {
    let part = |argument: &Value| match &argument["value"] {
        Value::String(text) => text.clone(),
        Value::Null => argument["description"].as_str().unwrap_or("null").to_owned(),
        other => other.to_string(),
    };
    arguments.as_array().into_iter().flatten().map(part).collect::<Vec<_>>().join(" ")
}

fn shortened(expression: &str) -> String {
    let start: String = expression.chars().take(200).collect();
    if start.len() < expression.len() { start + "…" } else { start }
}

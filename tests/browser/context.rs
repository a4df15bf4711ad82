//! What a flow is given: a served page, a folder for its browser, and the tab it opens.

use std::path::PathBuf;

use anyhow::Context as _;
use pinpose_web::server::Server;

use crate::cdp::Backend;
use crate::page::Page;

/// One run of one flow on one backend.
pub struct Context {
    pub backend: Backend,
    server: Option<Server>,
    url: String,
    folder: PathBuf,
    page: Option<Page>,
}

impl Context {
    /// Serves the built page. `name` tells this run's folder from the others'.
    pub fn new(name: &str, backend: Backend) -> anyhow::Result<Context> {
        let server = Server::start(&dist_folder(), 0)?;
        let url = server.url().to_owned();
        let folder =
            std::env::temp_dir().join(format!("pinpose-{}-{name}-{}", std::process::id(), backend.name()));
        Ok(Context { backend, server: Some(server), url, folder, page: None })
    }

    /// Opens the page with this query (`""` or `"example&bare"`) on the run's backend, and waits until it is ready.
    pub fn start(&mut self, query: &str) -> anyhow::Result<&mut Page> {
        let page = self.open(query)?;
        page.wait_until_ready()?;
        Ok(page)
    }

    /// The same without waiting. A page that was open is closed first; its storage stays, as it would for a user.
    pub fn open(&mut self, query: &str) -> anyhow::Result<&mut Page> {
        self.page = None;
        let page = Page::open(self.backend, &self.folder, &self.address(query))?;
        Ok(self.page.insert(page))
    }

    /// The address of the page with this query, on the run's backend.
    pub fn address(&self, query: &str) -> String {
        format!("{}?renderer={}&{query}", self.url, self.backend.name()).trim_end_matches('&').to_owned()
    }

    /// The page that was opened last.
    pub fn page(&mut self) -> anyhow::Result<&mut Page> {
        self.page.as_mut().context("No page was opened")
    }

    /// From now on the page is offline.
    pub fn stop_server(&mut self) {
        self.server = None;
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // The browser writes into the folder until it ends.
        self.page = None;
        std::fs::remove_dir_all(&self.folder).ok();
    }
}

/// The folder of the built page: what `cargo web test` has built, or the last `cargo web build`.
pub fn dist_folder() -> PathBuf {
    std::env::var_os("PINPOSE_DIST").map_or_else(pinpose_web::build::default_folder, PathBuf::from)
}

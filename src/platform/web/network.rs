//! Fetching and sending, the page's visibility, and the way to another page.

use js_sys::Uint8Array;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::{describe, now_ms};
use crate::platform::{BrowserFacts, FetchError, FetchFuture, NetworkFuture, Request};

#[wasm_bindgen(module = "/web/page/network.js")]
extern "C" {
    #[wasm_bindgen(js_name = fetchAtMost, catch)]
    async fn page_fetch_at_most(url: &str, most: f64) -> Result<JsValue, JsValue>;
}

/// Fetches a file of so many bytes at the most, relative to the page or from any host that allows it.
pub fn fetch(url: &str, most_bytes: u64) -> FetchFuture {
    let url = url.to_owned();
    Box::pin(async move {
        let answer = page_fetch_at_most(&url, most_bytes as f64).await;
        let answer = answer.map_err(|error| FetchError::Unreachable(describe(&error)))?;
        match (answer.dyn_ref::<Uint8Array>(), answer.as_f64()) {
            (Some(bytes), _) => Ok(bytes.to_vec()),
            (None, Some(status)) if status > 0.0 => Err(FetchError::Status(status as u16)),
            _ => Err(FetchError::TooLarge(most_bytes)),
        }
    })
}

/// Sends a request; done when the server has said that it has it.
pub fn send_request(request: Request) -> NetworkFuture<()> {
    Box::pin(async move {
        let failed = |error: JsValue| format!("the server cannot be reached: {}", describe(&error));
        let window = web_sys::window().ok_or("the page is gone")?;
        let init = web_sys::RequestInit::new();
        init.set_method(request.method);
        init.set_body(&request.body.into());
        let headers = js_sys::Object::new();
        js_sys::Reflect::set(&headers, &"Content-Type".into(), &"application/json".into()).map_err(failed)?;
        init.set_headers(&headers);
        let sent = JsFuture::from(window.fetch_with_str_and_init(&request.url, &init)).await;
        let response: web_sys::Response = sent.map_err(failed)?.dyn_into().map_err(failed)?;
        match response.ok() {
            true => Ok(()),
            false => Err(format!("the server answered {}", response.status())),
        }
    })
}

/// Calls `changed` whenever the tab is hidden or looked at again: whether it is hidden, and when that began (milliseconds since
/// 1970). A hidden page draws no frames, so this is told apart from them.
pub fn watch_hidden(changed: impl Fn(bool, f64) + 'static) {
    let Some(document) = web_sys::window().and_then(|window| window.document()) else { return };
    let of_page = document.clone();
    let listener = Closure::<dyn Fn()>::new(move || changed(of_page.hidden(), now_ms()));
    document.add_event_listener_with_callback("visibilitychange", listener.as_ref().unchecked_ref()).ok();
    // It listens as long as the page lives.
    listener.forget();
}

/// Leaves for another page.
pub fn go_to(url: &str) {
    if let Some(window) = web_sys::window() {
        window.location().set_href(url).unwrap_or_else(|error| log::warn!("{url}: {}", describe(&error)));
    }
}

pub fn browser_facts() -> BrowserFacts {
    let Some(window) = web_sys::window() else { return BrowserFacts::default() };
    let pixels = |side: Result<JsValue, JsValue>| {
        side.ok().and_then(|side| side.as_f64()).map_or(0, |side| side.max(0.0) as u32)
    };
    let screen = window.screen().ok();
    let screen_side = |side: Option<Result<i32, JsValue>>| {
        side.and_then(Result::ok).and_then(|side| u32::try_from(side).ok()).unwrap_or(0)
    };
    let navigator = window.navigator();
    BrowserFacts {
        browser: navigator.user_agent().unwrap_or_default(),
        language: navigator.language().unwrap_or_default(),
        screen: [
            screen_side(screen.as_ref().map(web_sys::Screen::width)),
            screen_side(screen.as_ref().map(web_sys::Screen::height)),
        ],
        window: [pixels(window.inner_width()), pixels(window.inner_height())],
        pixel_ratio: window.device_pixel_ratio(),
    }
}

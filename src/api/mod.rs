//! `window.pinpose`: the page's JavaScript API. See `web/API.md` for what each method does.
//!
//! Each method is a promise: the call waits in line until the program looks, which it does in its next frame.

mod answers;
mod arguments;

use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::future_to_promise;

use crate::platform::{PageCall, PageCalls};

type CallResult = Result<PageCall, JsValue>;

/// Puts `window.pinpose` on the page.
pub fn install(calls: &PageCalls) -> Result<(), JsValue> {
    let api = js_sys::Object::new();
    let set = |name: &str, value: &JsValue| js_sys::Reflect::set(&api, &name.into(), value).map(|_| ());
    set("version", &crate::platform::page_version().into())?;
    set("ready", &promise(calls.clone(), Ok(PageCall::Ready)))?;
    let method =
        |name: &str, read: fn(&js_sys::Array) -> CallResult| set(name, &promising(calls.clone(), read));
    method("state", |_| Ok(PageCall::State))?;
    method("setPose", arguments::set_pose)?;
    method("command", arguments::command)?;
    method("pageFromImage", |args| {
        Ok(PageCall::PageFromImage {
            u: arguments::number(args, 0, "u")?,
            v: arguments::number(args, 1, "v")?,
        })
    })?;
    method("imageFromPage", |args| {
        Ok(PageCall::ImageFromPage {
            x: arguments::number(args, 0, "x")?,
            y: arguments::number(args, 1, "y")?,
        })
    })?;
    method("pick", |args| {
        Ok(PageCall::Pick { x: arguments::number(args, 0, "x")?, y: arguments::number(args, 1, "y")? })
    })?;
    method("widgets", |_| Ok(PageCall::Widgets))?;
    method("render", arguments::render)?;
    method("perf", |_| Ok(PageCall::Perf))?;
    set("load", &load_method(calls.clone()))?;
    let window = web_sys::window().ok_or("the page is gone")?;
    js_sys::Reflect::set(&window, &"pinpose".into(), &api).map(|_| ())
}

/// A JavaScript function of any number of arguments.
fn promising(calls: PageCalls, read: fn(&js_sys::Array) -> CallResult) -> JsValue {
    let closure = Closure::<dyn Fn(js_sys::Array) -> js_sys::Promise>::new(move |args: js_sys::Array| {
        promise(calls.clone(), read(&args)).unchecked_into()
    });
    variadic(&closure.into_js_value())
}

/// Files are read before the call can be made.
fn load_method(calls: PageCalls) -> JsValue {
    let closure = Closure::<dyn Fn(js_sys::Array) -> js_sys::Promise>::new(move |args: js_sys::Array| {
        let calls = calls.clone();
        future_to_promise(async move {
            let call = arguments::load(&args).await?;
            let answer = calls.call(call).await.map_err(|message| js_sys::Error::new(&message))?;
            answers::to_js(answer)
        })
    });
    variadic(&closure.into_js_value())
}

/// A closure has a fixed number of arguments; JavaScript gathers them into one array for it.
fn variadic(takes_array: &JsValue) -> JsValue {
    js_sys::Function::new_with_args("inner", "return (...args) => inner(args)")
        .call1(&JsValue::UNDEFINED, takes_array)
        .unwrap_or(JsValue::UNDEFINED)
}

fn promise(calls: PageCalls, call: CallResult) -> JsValue {
    future_to_promise(async move {
        let answer = calls.call(call?).await.map_err(|message| js_sys::Error::new(&message))?;
        answers::to_js(answer)
    })
    .into()
}

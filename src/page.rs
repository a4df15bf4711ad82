//! The page's entry: what the wasm exports. The counterpart of `main.rs`; it ties `app` and `api` together.

use std::rc::Rc;

use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use crate::app::{PinPose, Start, StartWith, StudyLink};
use crate::platform::{self, PageAnswer, PageCall, PageCalls, Perf};

/// Starts the program on a canvas; resolves when its first frame is drawn.
///
/// `options`: `renderer` "webgl", "webgpu" or "auto"; `bare` for an empty program, to measure what a page costs by itself.
#[wasm_bindgen]
pub async fn start(canvas: HtmlCanvasElement, options: JsValue) -> Result<(), JsValue> {
    let option = |name: &str| js_sys::Reflect::get(&options, &name.into()).unwrap_or(JsValue::UNDEFINED);
    let renderer = option("renderer").as_string().unwrap_or_default();
    let runner = eframe::WebRunner::new();
    platform::install_panic_hook();
    let web_options =
        eframe::WebOptions { wgpu_options: graphics(&renderer), ..eframe::WebOptions::default() };
    let (sender, receiver) = futures_channel::oneshot::channel();
    let bare = option("bare").is_truthy();
    let create: eframe::AppCreator<'static> = Box::new(move |creation| {
        let ctx = creation.egui_ctx.clone();
        let wake_ctx = ctx.clone();
        platform::watch_for_updates(move || ctx.request_repaint());
        let calls = PageCalls::new(Rc::new(move || wake_ctx.request_repaint()));
        crate::api::install(&calls).map_err(|error| format!("window.pinpose cannot be made: {error:?}"))?;
        // The other end waits below.
        sender.send(calls.clone()).ok();
        if bare {
            return Ok(Box::new(Bare { calls, start_ms: 0.0 }));
        }
        let has = |parameter| platform::page_parameter(parameter).is_some();
        let study = platform::page_parameter("study").filter(|study| !study.is_empty());
        let with = match (study, has("example"), has("empty")) {
            (Some(study), ..) => StartWith::Study(StudyLink { study }),
            (None, true, _) => StartWith::Example,
            (None, false, true) => StartWith::Nothing,
            (None, false, false) => StartWith::LastOpen,
        };
        let start = Start { calls, storage: platform::default_storage(), with };
        Ok(Box::new(PinPose::new(creation, start)))
    });
    runner.start(canvas, web_options, create).await?;
    // Calls are answered from the first frame on.
    let calls = receiver.await.map_err(|_| js_sys::Error::new("the program was not created"))?;
    calls.call(PageCall::Ready).await.map_err(|message| js_sys::Error::new(&message))?;
    Ok(())
}

/// One job of a worker that loaded the same wasm.
#[wasm_bindgen]
pub fn run_job(request: &[u8]) -> Vec<u8> {
    // `start` never runs there, so the worker's panics would have no words.
    static HOOK: std::sync::Once = std::sync::Once::new();
    HOOK.call_once(platform::install_panic_hook);
    crate::app::run_job(request)
}

fn graphics(renderer: &str) -> WgpuConfiguration {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends = match renderer {
        "webgl" => wgpu::Backends::GL,
        "webgpu" => wgpu::Backends::BROWSER_WEBGPU,
        _ => wgpu::Backends::BROWSER_WEBGPU | wgpu::Backends::GL,
    };
    setup.device_descriptor = std::sync::Arc::new(|adapter| {
        let limits = wgpu::Limits::downlevel_webgl2_defaults();
        // As large as the screen and the photo may need, and never more than there is.
        let side = adapter.limits().max_texture_dimension_2d.min(8192);
        wgpu::DeviceDescriptor {
            label: Some("PinPose"),
            required_limits: wgpu::Limits { max_texture_dimension_2d: side, ..limits },
            ..wgpu::DeviceDescriptor::default()
        }
    });
    WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..WgpuConfiguration::default() }
}

/// The same wasm with nothing in it.
struct Bare {
    calls: PageCalls,
    start_ms: f64,
}

impl eframe::App for Bare {
    fn ui(&mut self, _ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        if self.start_ms == 0.0 {
            self.start_ms = platform::navigation_ms();
        }
        while let Some((call, reply)) = self.calls.take() {
            let answer = match call {
                PageCall::Perf => PageAnswer::Perf(Perf {
                    backend: "bare".to_owned(),
                    frames: 0,
                    cpu_median_ms: 0.0,
                    cpu_p95_ms: 0.0,
                    uploaded_bytes: 0,
                    draw_calls: 0,
                    triangles: 0,
                    wasm_bytes: platform::wasm_bytes(),
                    memory_bytes: platform::memory_bytes(),
                    start_ms: self.start_ms,
                }),
                _ => PageAnswer::Nothing,
            };
            reply.send(Ok(answer)).ok();
        }
    }
}

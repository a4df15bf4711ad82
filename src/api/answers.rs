//! Answers as JavaScript values.

use serde_json::{Value, json};
use wasm_bindgen::prelude::*;

use crate::platform::{PageAnswer, PageState, Perf, Picked, Widget};

pub fn to_js(answer: PageAnswer) -> Result<JsValue, JsValue> {
    match answer {
        PageAnswer::Nothing => Ok(JsValue::UNDEFINED),
        PageAnswer::Bytes(bytes) => Ok(js_sys::Uint8Array::from(&bytes[..]).into()),
        PageAnswer::Point { x, y } => from_json(&json!({"x": x, "y": y})),
        PageAnswer::State(state) => from_json(&state_json(&state)?),
        PageAnswer::Picked(picked) => from_json(&picked.map_or(Value::Null, |picked| picked_json(&picked))),
        PageAnswer::Widgets(widgets) => from_json(&widgets.iter().map(widget_json).collect()),
        PageAnswer::Loaded(loaded) => from_json(&json!({"files": loaded.files, "problems": loaded.problems})),
        PageAnswer::Perf(perf) => from_json(&perf_json(&perf)),
    }
}

fn from_json(value: &Value) -> Result<JsValue, JsValue> {
    js_sys::JSON::parse(&value.to_string())
}

fn state_json(state: &PageState) -> Result<Value, JsValue> {
    let mut value: Value = serde_json::from_slice(state.document_json.as_bytes())
        .map_err(|error| js_sys::Error::new(&error.to_string()))?;
    value["selection"] = json!({"photo": state.photo, "object": state.selected, "tool": state.tool});
    value["viewport"] =
        json!({"zoom": state.zoom, "center": state.center, "rect": state.viewport, "panels": state.panels});
    value["arrangement"] = json!(state.arrangement);
    value["sceneViewport"] = json!({"rect": state.scene_viewport});
    value["busy"] = json!(state.busy);
    value["saved"] = json!(state.saved);
    value["question"] = json!(state.question);
    value["notices"] = json!(state.notices);
    value["study"] = json!(state.study);
    Ok(value)
}

fn picked_json(picked: &Picked) -> Value {
    json!({"object": picked.object, "face": picked.face, "point": picked.point_object_mm, "depth": picked.depth_mm})
}

fn widget_json(widget: &Widget) -> Value {
    json!({
        // Larger than a JavaScript number can hold exactly.
        "id": widget.id.to_string(),
        "label": widget.label,
        "role": widget.role,
        "value": widget.value,
        "enabled": widget.enabled,
        "visible": widget.visible,
        "rect": widget.rect,
    })
}

fn perf_json(perf: &Perf) -> Value {
    json!({
        "backend": perf.backend,
        "frames": perf.frames,
        "cpu_ms": {"median": perf.cpu_median_ms, "p95": perf.cpu_p95_ms},
        "uploaded_bytes": perf.uploaded_bytes,
        "draw_calls": perf.draw_calls,
        "triangles": perf.triangles,
        "wasm_bytes": perf.wasm_bytes,
        "memory_bytes": perf.memory_bytes,
        "start_ms": perf.start_ms,
    })
}

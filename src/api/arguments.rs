//! Arguments from JavaScript; what does not fit is an `Error` that says which and what was expected.

use js_sys::{Array, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::CallResult;
use crate::platform::{FileBytes, PageCall, PageValue};

pub fn number(args: &Array, index: u32, name: &str) -> Result<f64, JsValue> {
    let value = args.get(index);
    value.as_f64().ok_or_else(|| error(&format!("{name} is {value:?}, a number expected")))
}

/// The id of a photo or an object.
fn id(value: &JsValue, name: &str) -> Result<u32, JsValue> {
    let whole =
        value.as_f64().filter(|number| number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(number));
    whole.map(|number| number as u32).ok_or_else(|| error(&format!("{name} is {value:?}, an id expected")))
}

pub fn set_pose(args: &Array) -> CallResult {
    let rows = items(&args.get(2));
    let rows = rows.iter().map(|row| items(row).iter().filter_map(JsValue::as_f64).collect::<Vec<f64>>());
    let rows: Vec<[f64; 4]> = rows.filter_map(|row| row.try_into().ok()).collect();
    let camera_from_object: [[f64; 4]; 4] =
        rows.try_into().map_err(|_| error("the matrix is not four rows of four numbers"))?;
    Ok(PageCall::SetPose {
        photo: id(&args.get(0), "photo")?,
        object: id(&args.get(1), "object")?,
        camera_from_object,
    })
}

pub fn command(args: &Array) -> CallResult {
    let name = args.get(0).as_string().ok_or_else(|| error("the command's name is not a text"))?;
    let value = args.get(1);
    let number = value.as_f64().map(PageValue::Number);
    let boolean = value.as_bool().map(PageValue::Boolean);
    let value = number.or(boolean).or_else(|| value.as_string().map(PageValue::Text));
    Ok(PageCall::Command { name, value })
}

pub fn render(args: &Array) -> CallResult {
    let options = args.get(0);
    let optional_id = |name: &str| match field(&options, name) {
        value if value.is_undefined() || value.is_null() => Ok(None),
        value => id(&value, name).map(Some),
    };
    let kind = field(&options, "kind").as_string().ok_or_else(|| error("kind is missing"))?;
    Ok(PageCall::Render { photo: optional_id("photo")?, kind, object: optional_id("object")? })
}

/// `load(files, {posesAs})`: files are `File`s or `{name, bytes}`, one or several.
pub async fn load(args: &Array) -> CallResult {
    let given = args.get(0);
    let is_one = given.has_type::<web_sys::File>() || field(&given, "bytes").is_truthy();
    let list = if is_one { vec![given] } else { items(&given) };
    if list.is_empty() {
        return Err(error("a File or {name, bytes}, one or several, expected"));
    }
    let mut files = Vec::new();
    for item in &list {
        files.push(file(item).await?);
    }
    Ok(PageCall::Load { files, poses_as: field(&args.get(1), "posesAs").as_string() })
}

async fn file(item: &JsValue) -> Result<FileBytes, JsValue> {
    if let Some(file) = item.dyn_ref::<web_sys::File>() {
        let buffer = JsFuture::from(file.array_buffer()).await?;
        return Ok(FileBytes { name: file.name(), bytes: Uint8Array::new(&buffer).to_vec() });
    }
    let name = field(item, "name").as_string();
    let bytes = field(item, "bytes");
    match name {
        Some(name) if bytes.is_object() => Ok(FileBytes { name, bytes: Uint8Array::new(&bytes).to_vec() }),
        _ => Err(error("a File or {name, bytes} expected")),
    }
}

/// The items of an array, a `FileList` or anything else that can be gone through; nothing where it cannot.
fn items(value: &JsValue) -> Vec<JsValue> {
    let items = js_sys::try_iter(value).ok().flatten();
    items.map(|items| items.filter_map(Result::ok).collect()).unwrap_or_default()
}

/// A property, or `undefined`.
fn field(object: &JsValue, name: &str) -> JsValue {
    Reflect::get(object, &name.into()).unwrap_or(JsValue::UNDEFINED)
}

fn error(message: &str) -> JsValue {
    js_sys::Error::new(message).into()
}

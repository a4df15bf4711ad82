//! Between the stored JavaScript objects and plain data.

use std::sync::Arc;

use js_sys::{Array, JSON, Object, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;

use crate::platform::storage::{SavedAsset, SavedCompanion, SceneHeading, SceneId, SceneSummary};

pub fn scene(heading: &SceneHeading, bytes: u64, asset_keys: &[String]) -> JsValue {
    object(&[
        ("name", heading.name.as_str().into()),
        ("subject", heading.subject.as_str().into()),
        ("changedAtMs", heading.changed_at_ms.into()),
        ("photos", heading.photo_count.into()),
        ("objects", heading.object_count.into()),
        // Exact up to 9 PB.
        ("bytes", (bytes as f64).into()),
        ("assets", list(asset_keys)),
    ])
}

pub fn heading(scene: &JsValue) -> SceneHeading {
    SceneHeading {
        name: text_field(scene, "name").unwrap_or_default(),
        subject: text_field(scene, "subject").unwrap_or_default(),
        changed_at_ms: number_field(scene, "changedAtMs"),
        photo_count: number_field(scene, "photos") as u32,
        object_count: number_field(scene, "objects") as u32,
    }
}

pub fn summary((id, scene): (&JsValue, &JsValue)) -> Option<SceneSummary> {
    let bytes = number_field(scene, "bytes") as u64;
    Some(SceneSummary { id: SceneId::new(&id.as_string()?), heading: heading(scene), bytes })
}

/// False for what is no heading any more.
pub fn is_heading(scene: &JsValue) -> bool {
    field(scene, "changedAtMs").as_f64().is_some() && names_its_files(scene)
}

/// Of a scene or a document: does it say which files it needs?
pub fn names_its_files(value: &JsValue) -> bool {
    field(value, "assets").is_instance_of::<Array>()
}

/// A record that is not what it should be, for whoever can make something of it.
pub fn as_text(value: &JsValue) -> String {
    let json = JSON::stringify(value).ok().and_then(|text| text.as_string());
    json.unwrap_or_else(|| format!("{value:?}"))
}

pub fn set_name(scene: &JsValue, name: &str) {
    // Setting a property of a plain object cannot fail.
    Reflect::set(scene, &"name".into(), &name.into()).ok();
}

pub fn document(json: &str, asset_keys: &[String], companions: &[SavedCompanion]) -> JsValue {
    let companion = |one: &SavedCompanion| {
        let (key, name) = (one.file.key.as_str(), one.file.file_name.as_str());
        object(&[("of", one.of.as_str().into()), ("key", key.into()), ("name", name.into())])
    };
    let companions: Array = companions.iter().map(companion).collect();
    object(&[("json", json.into()), ("assets", list(asset_keys)), ("companions", companions.into())])
}

/// Of which asset, the key of its content, and its name.
pub fn companions(document: &JsValue) -> Vec<(String, String, String)> {
    let companions = field(document, "companions").dyn_into::<Array>().unwrap_or_default();
    let read =
        |one: JsValue| Some((text_field(&one, "of")?, text_field(&one, "key")?, text_field(&one, "name")?));
    companions.iter().filter_map(read).collect()
}

/// What a document of version 1 says of itself; what it does not say is left empty.
pub fn heading_of_document(json: &str, now_ms: f64) -> SceneHeading {
    let document = JSON::parse(json).unwrap_or(JsValue::UNDEFINED);
    let array = |name: &str| field(&document, name).dyn_into::<Array>().unwrap_or_default();
    let (photos, objects) = (array("photos"), array("objects"));
    let subject = text_field(&photos.get(0), "file").or_else(|| text_field(&objects.get(0), "name"));
    let subject = subject.unwrap_or_default();
    let stem = subject.rsplit_once('.').map_or(subject.as_str(), |(stem, _)| stem);
    SceneHeading {
        name: text_field(&document, "name").unwrap_or_default(),
        subject: stem.to_owned(),
        changed_at_ms: now_ms,
        photo_count: photos.length(),
        object_count: objects.length(),
    }
}

pub fn asset(asset: &SavedAsset) -> JsValue {
    let bytes = Uint8Array::from(&*asset.bytes);
    object(&[("name", asset.file_name.as_str().into()), ("bytes", bytes.into())])
}

pub fn read_asset(key: String, value: &JsValue) -> Option<SavedAsset> {
    let bytes: Uint8Array = field(value, "bytes").dyn_into().ok()?;
    Some(SavedAsset { key, file_name: text_field(value, "name")?, bytes: Arc::from(bytes.to_vec()) })
}

pub fn asset_bytes(value: &JsValue) -> u64 {
    field(value, "bytes").dyn_into::<Uint8Array>().map_or(0, |bytes| u64::from(bytes.length()))
}

/// Of a scene or a document, with the companions'.
pub fn file_keys(value: &JsValue) -> Vec<String> {
    let companions = companions(value).into_iter().map(|(_, key, _)| key);
    asset_keys(value).into_iter().chain(companions).collect()
}

pub fn asset_keys(value: &JsValue) -> Vec<String> {
    let keys = field(value, "assets").dyn_into::<Array>().unwrap_or_default();
    keys.iter().filter_map(|key| key.as_string()).collect()
}

pub fn text_field(value: &JsValue, name: &str) -> Option<String> {
    field(value, name).as_string()
}

fn number_field(value: &JsValue, name: &str) -> f64 {
    field(value, name).as_f64().unwrap_or_default()
}

fn field(value: &JsValue, name: &str) -> JsValue {
    Reflect::get(value, &name.into()).unwrap_or(JsValue::UNDEFINED)
}

fn list(keys: &[String]) -> JsValue {
    keys.iter().map(|key| JsValue::from_str(key)).collect::<Array>().into()
}

fn object(fields: &[(&str, JsValue)]) -> JsValue {
    let object = Object::new();
    for (name, value) in fields {
        // As above.
        Reflect::set(&object, &(*name).into(), value).ok();
    }
    object.into()
}

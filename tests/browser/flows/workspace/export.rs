//! Exports: a zip with poses in another convention and a BOP folder, chosen by mouse.

use std::io::{Cursor, Read as _};

use anyhow::{Context as _, ensure};
use serde_json::Value;
use zip::ZipArchive;

use super::{BALL_AT, start_with_shapes};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::input::Modifier;

pub fn export(context: &mut Context) -> anyhow::Result<()> {
    let (page, _) = start_with_shapes(context)?;
    page.key("e", &[Modifier::Control, Modifier::Alt])?;
    for label in ["BOP dataset", "OpenGL", "m", "Export"] {
        page.click_widget(label)?;
    }
    let file = page.download(PATIENCE)?;
    ensure!(file.name.ends_with("-export.zip"), "{} is no archive", file.name);
    let mut archive = ZipArchive::new(Cursor::new(&file.bytes[..]))?;
    let names: Vec<String> =
        archive.file_names().map(|name| Ok(name?.into_owned())).collect::<anyhow::Result<_>>()?;
    println!("   {} files, {} bytes", names.len(), file.bytes.len());
    for wanted in
        ["poses.json", "poses.csv", "project.py", "scene_gt.json", "scene_gt_info.json", "models_info.json"]
    {
        ensure!(names.iter().any(|name| name.ends_with(wanted)), "{wanted} is not among {names:?}");
    }
    let poses = names.iter().find(|name| name.ends_with("poses.json")).context("No poses")?;
    let mut text = String::new();
    archive.by_name(poses)?.read_to_string(&mut text)?;
    let poses: Value = serde_json::from_str(&text)?;
    let words = &poses["conventions"];
    ensure!(words["length_unit"].as_str().is_some_and(|unit| unit.starts_with('m')), "{words}");
    // The ball by its place: x stays, y and z turn round, all in metres.
    let [x, y, z] = BALL_AT.map(|mm| mm / 1000.0);
    let is_ball = |pose: &Value| {
        let t = [0, 1, 2].map(|row| pose["matrix"][row][3].as_f64().unwrap_or_default());
        // Both are divided by the same number.
        t == [x, -y, -z]
    };
    let found = poses["photos"][0]["poses"].as_array().is_some_and(|poses| poses.iter().any(is_ball));
    ensure!(found, "The ball is not where it was posed: {}", poses["photos"][0]["poses"]);
    Ok(())
}

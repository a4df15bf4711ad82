//! The flows: what a user does with the page, on which backends.

mod annotator;
mod bad_input;
mod datasets;
mod expert;
mod idle;
mod large;
mod masks;
mod open_meaning;
mod path;
mod pixels;
mod safety;
mod scenes;
mod startup;
mod storage;
mod study;
mod view;
mod workspace;

use anyhow::Context as _;

use crate::api::{PATIENCE, State};
use crate::cdp::Backend;
use crate::context::Context;
use crate::data::{Linemod, Sample};
use crate::page::Page;

pub struct Flow {
    pub name: &'static str,
    pub backends: &'static [Backend],
    /// Runs with `--full` alone.
    pub full_only: bool,
    pub run: fn(&mut Context) -> anyhow::Result<()>,
}

impl Flow {
    const fn on(backends: &'static [Backend], name: &'static str, run: FlowFn) -> Flow {
        Flow { name, backends, full_only: false, run }
    }

    const fn long(self) -> Flow {
        Flow { full_only: true, ..self }
    }
}

type FlowFn = fn(&mut Context) -> anyhow::Result<()>;

const BOTH: &[Backend] = &[Backend::WebGpu, Backend::WebGl];
const WEBGL: &[Backend] = &[Backend::WebGl];
const WEBGPU: &[Backend] = &[Backend::WebGpu];

pub const FLOWS: &[Flow] = &[
    Flow::on(BOTH, "starts", startup::starts),
    Flow::on(WEBGL, "startup", startup::startup),
    Flow::on(WEBGPU, "startup-webgpu", startup::startup).long(),
    Flow::on(WEBGL, "example", startup::example),
    Flow::on(WEBGL, "no-folders", startup::no_folders),
    Flow::on(BOTH, "path", path::path),
    Flow::on(WEBGL, "late-files", path::late_files),
    Flow::on(BOTH, "masks", masks::three_samples),
    Flow::on(BOTH, "masks-all", masks::all_samples).long(),
    Flow::on(BOTH, "pixels", pixels::pixels),
    Flow::on(WEBGL, "view", view::view),
    Flow::on(WEBGPU, "view-webgpu", view::view).long(),
    Flow::on(WEBGL, "reference", view::reference),
    Flow::on(WEBGL, "idle", idle::idle),
    Flow::on(WEBGPU, "idle-webgpu", idle::idle).long(),
    Flow::on(BOTH, "drag-cost", idle::drag_cost),
    Flow::on(WEBGL, "drag-ten", large::drag_ten).long(),
    Flow::on(WEBGL, "drag-million", large::drag_million).long(),
    Flow::on(WEBGL, "drop-million", large::drop_million).long(),
    Flow::on(WEBGL, "many-photos", large::many_photos).long(),
    Flow::on(WEBGL, "very-many-photos", large::very_many_photos).long(),
    Flow::on(WEBGL, "large-photo", large::large_photo_flow),
    Flow::on(WEBGPU, "expert", expert::three_samples),
    Flow::on(BOTH, "expert-all", expert::all_samples).long(),
    Flow::on(WEBGPU, "pins", annotator::pins),
    Flow::on(WEBGPU, "pins-and-snap", annotator::pins_and_snap).long(),
    Flow::on(WEBGL, "dataset-folder", datasets::folder),
    Flow::on(WEBGL, "dataset-zip", datasets::zip),
    Flow::on(WEBGL, "dataset-thousand", datasets::thousand_frames).long(),
    Flow::on(WEBGL, "bad-input", bad_input::bad_files),
    Flow::on(WEBGL, "bad-calls", bad_input::bad_calls),
    Flow::on(WEBGL, "mesh-units", open_meaning::mesh_units),
    Flow::on(WEBGL, "foreign-photos", open_meaning::foreign_photos),
    Flow::on(WEBGL, "offline", safety::offline),
    Flow::on(WEBGL, "crash", safety::crash),
    Flow::on(WEBGL, "scenes", scenes::scenes),
    Flow::on(WEBGL, "scenes-mid-drag", scenes::mid_drag),
    Flow::on(WEBGL, "scenes-version-1", scenes::version_1),
    Flow::on(WEBGL, "scenes-newer-version", scenes::newer_version),
    Flow::on(WEBGL, "storage-killed", storage::killed).long(),
    Flow::on(WEBGL, "storage-full", storage::full).long(),
    Flow::on(WEBGL, "storage-tabs", storage::two_tabs).long(),
    Flow::on(WEBGL, "storage-damaged", storage::damaged).long(),
    Flow::on(WEBGL, "study", study::short),
    Flow::on(WEBGL, "study-ten", study::long).long(),
    Flow::on(WEBGL, "study-hundred", study::of_a_hundred).long(),
    Flow::on(WEBGPU, "study-webgpu", study::short).long(),
    Flow::on(WEBGL, "study-startup", study::link_to_trial),
    Flow::on(WEBGL, "study-tabs", study::two_tabs),
    Flow::on(WEBGL, "study-links", study::bad_links),
    Flow::on(WEBGL, "looks", workspace::looks),
    Flow::on(WEBGL, "nudges", workspace::nudges),
    Flow::on(WEBGL, "handles", workspace::handles),
    Flow::on(WEBGL, "scene-view", workspace::scene_view),
    Flow::on(WEBGL, "panels", workspace::panels),
    Flow::on(WEBGL, "objects", workspace::objects),
    Flow::on(WEBGL, "output", workspace::output),
    Flow::on(WEBGL, "confirm", workspace::confirm),
    Flow::on(WEBGL, "export", workspace::export),
    Flow::on(WEBGL, "mask-import", workspace::mask_import),
    Flow::on(WEBGL, "keys", workspace::keys),
    Flow::on(WEBGL, "lost-graphics", workspace::lost_graphics),
    Flow::on(WEBGPU, "looks-webgpu", workspace::looks).long(),
    Flow::on(WEBGPU, "handles-webgpu", workspace::handles).long(),
    Flow::on(WEBGPU, "scene-view-webgpu", workspace::scene_view).long(),
    Flow::on(WEBGPU, "mask-import-webgpu", workspace::mask_import).long(),
];

/// The sample that most flows use.
const PHOTO: &str = "000019.png";

/// Opens the page with a sample in it, its true pose the selected object's.
fn start_with_sample<'a>(
    context: &'a mut Context,
    linemod: &Linemod,
) -> anyhow::Result<(&'a mut Page, State)> {
    let sample: &Sample = linemod.sample(PHOTO)?;
    let files = linemod.files_of(sample)?;
    let page = context.start("")?;
    page.load(&files)?;
    let state = page.wait_until_saved()?;
    state.selected_pose().context("The sample was not loaded")?;
    Ok((page, state))
}

/// Waits until no message lies over the page: they go by themselves.
fn without_messages(page: &mut Page) -> anyhow::Result<()> {
    page.wait_for_state("state.notices.length === 0", PATIENCE)?;
    page.next_frame()
}

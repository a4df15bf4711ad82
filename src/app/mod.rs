//! The program: an `eframe::App` that reads gestures, applies commands, carries out their effects and draws.
//!
//! `logic()` takes what came in (files, replies, keys, gestures, calls of the page) and changes the session; `ui()` draws
//! it and applies what the panels asked for.

mod answers;
mod autosave;
mod building;
mod datasets;
mod depth_maps;
mod effects;
mod events;
mod exporting;
mod ghosts;
mod input;
mod jobs;
mod kept;
mod loading;
mod mask_layer;
mod motion;
mod performance;
mod photo_cache;
mod pictures;
mod reporting;
mod scenes;
mod snapping;
mod start;
mod study;
mod symmetry;
mod thumbnails;
mod widgets;

use std::rc::Rc;
use std::sync::{Arc, Mutex};

use crate::interact::Hands;
use crate::platform::{self, PageCalls, SceneId, Storage};
use crate::render::{Gpu, Renderer};
use crate::session::{Command, Notice, Session};
use crate::ui::{self, SharedRenderer, UiState};

pub use jobs::run_job;
pub use start::StartWith;
pub use study::Link as StudyLink;

/// The whole program.
pub struct PinPose {
    session: Session,
    hands: Hands,
    ui_state: UiState,
    loading: loading::Loading,
    datasets: datasets::Datasets,
    photos: photo_cache::PhotoCache,
    autosave: autosave::Autosave,
    scenes: scenes::Scenes,
    renderer: Option<SharedRenderer>,
    backend: String,
    calls: PageCalls,
    answers: answers::Answers,
    pictures: pictures::Pictures,
    mask_layer: mask_layer::MaskLayer,
    depth_maps: depth_maps::DepthMaps,
    exporting: exporting::Exporting,
    snapping: snapping::Snapping,
    ghosts: ghosts::Ghosts,
    symmetries: symmetry::SymmetrySearch,
    motion: Option<motion::Motion>,
    building: building::Building,
    reporting: reporting::Reporting,
    kept: kept::Kept,
    ctx: egui::Context,
    performance: performance::Performance,
    /// While the key that hides the overlay is down: what was shown before.
    layers_before_hold: Option<crate::scene::Layers>,
    events: events::Events,
    /// Somebody takes part in a study: nothing else of the program is there then.
    study: Option<Box<study::Participating>>,
}

/// What the program starts with.
pub struct Start {
    pub calls: PageCalls,
    pub storage: Rc<dyn Storage>,
    pub with: StartWith,
}

impl PinPose {
    pub fn new(creation: &eframe::CreationContext<'_>, start: Start) -> Self {
        let ctx = &creation.egui_ctx;
        ui::apply_theme(ctx);
        ctx.add_plugin(widgets::WidgetWatcher::default());
        let gpu_state = creation.wgpu_render_state.as_ref();
        let renderer = gpu_state.map(|state| {
            let gpu = Gpu { device: state.device.clone(), queue: state.queue.clone() };
            Arc::new(Mutex::new(Renderer::new(gpu, state.target_format)))
        });
        if let Some(state) = gpu_state {
            watch_device(&state.device);
        }
        let backend = gpu_state.map(|state| backend_name(&state.adapter)).unwrap_or_default();
        let is_example = start.with == StartWith::Example;
        let first_id = if is_example { SceneId::example() } else { platform::new_scene_id() };
        let mut app = Self {
            session: Session::default(),
            hands: Hands::default(),
            ui_state: UiState::new(ui::Preferences::load()),
            loading: loading::Loading::new(ctx),
            datasets: datasets::Datasets::new(ctx),
            photos: photo_cache::PhotoCache::default(),
            autosave: autosave::Autosave::new(start.storage.clone(), ctx.clone(), first_id),
            scenes: scenes::Scenes::new(start.storage, ctx),
            renderer,
            backend,
            calls: start.calls,
            answers: answers::Answers::default(),
            pictures: pictures::Pictures::default(),
            mask_layer: mask_layer::MaskLayer::default(),
            depth_maps: depth_maps::DepthMaps::default(),
            exporting: exporting::Exporting::default(),
            snapping: snapping::Snapping::default(),
            ghosts: ghosts::Ghosts::default(),
            symmetries: symmetry::SymmetrySearch::default(),
            motion: None,
            building: building::Building::default(),
            reporting: reporting::Reporting::default(),
            kept: kept::Kept::default(),
            ctx: ctx.clone(),
            performance: performance::Performance::default(),
            layers_before_hold: None,
            events: events::Events::default(),
            study: None,
        };
        app.start_with(start.with);
        app
    }

    /// Applies a command and does what it asks for; an error becomes a message.
    fn apply(&mut self, command: Command) {
        if let Err(error) = self.try_apply(command) {
            self.notify(Notice::warning(error));
        }
    }

    fn try_apply(&mut self, command: Command) -> Result<(), String> {
        if self.is_in_study() {
            return self.apply_in_study(command, platform::now_ms());
        }
        if matches!(command, Command::CancelGesture | Command::Run(crate::session::CommandId::Cancel)) {
            self.hands.cancel();
            if self.stop_snap_first() {
                return Ok(());
            }
        }
        let effects = self.session.apply(command, platform::now_ms()).map_err(|error| error.to_string())?;
        effects.into_iter().for_each(|effect| self.carry_out(effect));
        Ok(())
    }

    fn notify(&mut self, notice: Notice) {
        platform::send_event("notice", &notice.text);
        self.ui_state.toasts.add(notice);
    }

    fn notify_with_offer(&mut self, notice: Notice, offer: ui::Offer) {
        platform::send_event("notice", &notice.text);
        self.ui_state.toasts.add_with_offer(notice, offer);
    }
}

impl eframe::App for PinPose {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        self.performance.begin_frame(frame.info().cpu_usage);
        if self.is_in_study() {
            return self.study_logic(ctx);
        }
        self.tick_scenes();
        self.take_loaded();
        self.take_dropped_results(ctx);
        self.take_dropped(ctx);
        self.tick_datasets();
        self.answer_calls(ctx);
        self.take_keys(ctx);
        self.take_gestures(ctx);
        self.want_pixels();
        self.update_mask_layer();
        self.want_thumbnails();
        self.make_pictures(ctx);
        self.tick_export();
        self.tick_snap();
        self.tick_ghosts();
        self.tick_symmetries();
        self.tick_motion();
        self.tick_building();
        self.tick_reporting();
        self.tick_kept();
        self.autosave.tick(ctx, &self.session, platform::now_ms());
        self.send_events();
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        if self.is_in_study() {
            return self.study_ui(ui);
        }
        let pixels = self.session.photo().and_then(|photo| self.photos.get(photo.asset.sha256));
        let depth = self.session.photo().map(|photo| photo.id).and_then(|photo| self.depth_of(photo));
        let open_scene = self.autosave.id();
        let opening = || ui::Busy { text: "Opening…".to_owned(), can_cancel: false };
        let busy = self.loading.busy(platform::now_ms()).or_else(|| self.datasets.busy());
        let busy = busy.or_else(|| self.exporting.busy()).or_else(|| self.snapping.busy());
        let busy = busy.or_else(|| self.symmetries.busy());
        let busy = busy.or_else(|| self.scenes.is_opening().then(opening));
        let around = ui::Surroundings {
            hands: &self.hands,
            renderer: self.renderer.as_ref(),
            pixels,
            masks: self.mask_layer.pixels(),
            depth,
            drawn_pose: self.drawn_pose(ui.ctx().input(|input| input.time)),
            symmetries: self.symmetries.view(),
            saving: self.autosave.state(&self.session),
            busy,
            scenes: self.scenes.list(),
            store: ui::StoreView {
                open_scene: Some(&open_scene),
                is_opening: self.scenes.is_opening(),
                usage: self.scenes.usage(),
                now_ms: platform::now_ms(),
            },
            builder: Some(self.building.view()),
            report: Some(self.reporting.view()),
            kept: Some(self.kept.view()),
            update_ready: platform::update_offer().is_some(),
            dataset: self.datasets.view(),
            files_hover: ui.ctx().input(|input| !input.raw.hovered_files.is_empty()),
        };
        if self.performance.start_ms == 0.0 {
            self.performance.start_ms = platform::navigation_ms();
        }
        let preferences = self.ui_state.preferences.clone();
        let asked = ui::draw(ui, &self.session, &around, &mut self.ui_state);
        if self.ui_state.preferences != preferences {
            self.ui_state.preferences.store();
        }
        if asked.cancel_loading {
            self.cancel_work();
        }
        if let Some(shown) = asked.show_motion {
            self.show_motion(shown);
        }
        if let Some(request) = asked.export {
            self.start_export(request);
        }
        if asked.study_pictures {
            self.pick_study_pictures();
        }
        if let Some(build) = asked.study_build {
            self.start_building(build);
        }
        if let Some(request) = asked.kept {
            self.take_kept_request(request);
        }
        if let Some(request) = asked.report {
            self.take_report_request(request);
        }
        self.place_views();
        if let Some(moved) = asked.scene_move {
            self.hands.move_scene(moved, &self.session);
            ui.ctx().request_repaint();
        }
        if asked.apply_update {
            platform::reload();
        }
        if !asked.dataset_requests.is_empty() {
            asked.dataset_requests.into_iter().for_each(|request| self.take_dataset_request(request));
            ui.ctx().request_repaint();
        }
        if !asked.scene_requests.is_empty() {
            asked.scene_requests.into_iter().for_each(|request| self.take_scene_request(request));
            ui.ctx().request_repaint();
        }
        if !asked.commands.is_empty() {
            asked.commands.into_iter().for_each(|command| self.apply(command));
            ui.ctx().request_repaint();
        }
    }

    fn on_exit(&mut self) {
        if !self.is_in_study() {
            self.autosave.save_now(&self.session, platform::now_ms());
        }
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        [0.0, 0.0, 0.0, 1.0]
    }
}

impl PinPose {
    /// Of what the user waits for, the part that was shown.
    fn cancel_work(&mut self) {
        if self.loading.is_busy() {
            self.loading.cancel();
            self.notify(Notice::info("Cancelled: what was not read yet is left out"));
        } else if self.datasets.cancel() {
            self.notify(Notice::info("Cancelled: nothing was opened"));
        } else if self.exporting.cancel() {
            self.notify(Notice::info("Cancelled: nothing more is exported"));
        } else if !self.cancel_snap() {
            self.symmetries.cancel();
        }
    }
}

/// A lost device cannot be drawn with: that is said, and the saved work comes back with a reload.
fn watch_device(device: &wgpu::Device) {
    device.set_device_lost_callback(|reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            platform::report_crash(&format!("The graphics device was lost: {message}"));
        }
    });
    device.on_uncaptured_error(std::sync::Arc::new(|error| {
        platform::report_crash(&format!("The graphics device reported an error: {error}"));
    }));
}

fn backend_name(adapter: &wgpu::Adapter) -> String {
    match adapter.get_info().backend {
        wgpu::Backend::BrowserWebGpu => "webgpu".to_owned(),
        wgpu::Backend::Gl => "webgl".to_owned(),
        other => format!("{other:?}").to_lowercase(),
    }
}

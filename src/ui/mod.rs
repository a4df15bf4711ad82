//! The interface: panels, viewport, dialogs. Reads a [`Session`] and returns commands; changes nothing itself.

mod busy_mark;
mod command_button;
mod dataset_dialog;
mod dialogs;
mod export_dialog;
mod icons;
mod kept_dialog;
mod keymap;
mod menus;
mod once;
mod palette;
mod panels;
mod paste_dialog;
mod preferences;
mod report_dialog;
mod scenes_dialog;
mod shortcuts;
mod shortcuts_sheet;
mod strip;
pub mod study;
mod study_builder;
mod theme;
mod thumbnails;
mod toasts;
mod top_bar;
mod viewport;
mod welcome;

use egui::{CentralPanel, Frame, Panel};

use crate::interact::{Hands, SceneMove};
use crate::math::Pose;
use crate::platform::{SceneId, SceneSummary, StorageUse};
use crate::scene::{MeshAsset, ObjectId, PhotoId, SymmetryAxis};
use crate::session::{Command, CommandId, Effect, Session};
use crate::solve::Weakest;
use crate::solve::symmetry::FoundSymmetries;

pub use dataset_dialog::{DatasetRequest, DatasetView};
pub use export_dialog::ExportRequest;
pub use kept_dialog::{KeptRequest, KeptView};
pub use keymap::{Binding, Keymap, Refusal};
pub use preferences::{DragModifier, ModifierKey, ModifierMap, Preferences, ThemeChoice};
pub use report_dialog::{ReportRequest, ReportStage, ReportView};
pub use scenes_dialog::SceneRequest;
pub use shortcuts::{Pressed, is_released, pressed_commands, shortcut_text};
pub use study_builder::{BuilderView, StudyBuild};
pub use theme::apply_theme;
pub use thumbnails::{MOST_SIDE_PX as THUMBNAIL_SIDE_PX, Thumbnails};
pub use toasts::{Offer, Toasts};
pub use viewport::{SharedRenderer, ViewportPlace};

/// What the interface keeps for itself between frames.
#[derive(Debug, Default)]
pub struct UiState {
    pub panels_hidden: bool,
    /// The window that is open over everything.
    pub open: Option<Dialog>,
    pub toasts: Toasts,
    pub scenes_dialog: scenes_dialog::State,
    panels: panels::PanelState,
    pub preferences: Preferences,
    pub thumbnails: Thumbnails,
    top_bar: top_bar::State,
    palette: palette::State,
    shortcuts_sheet: shortcuts_sheet::State,
    paste_dialog: paste_dialog::State,
    export_dialog: export_dialog::State,
    fit_count: dialogs::FitCount,
    strip: strip::State,
    /// Where the photo view and the scene view were in the last frame; `None` where they were not on screen.
    pub viewport: Option<ViewportPlace>,
    pub scene_viewport: Option<ViewportPlace>,
    split: viewport::SplitState,
    pub study_builder: study_builder::State,
    pub report_dialog: report_dialog::State,
    pub kept_dialog: kept_dialog::State,
    /// Of the study that somebody takes part in.
    pub study: study::State,
}

/// Windows that come up over the rest, one at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialog {
    Shortcuts,
    Palette,
    PastePose,
    Export,
}

impl UiState {
    pub fn new(preferences: Preferences) -> Self {
        Self { preferences, ..Self::default() }
    }

    /// Opens the selected object's name for editing, in the list.
    pub fn rename_selected(&mut self, session: &Session) {
        self.panels_hidden = false;
        self.panels.rename_selected(session);
    }

    pub fn toggle(&mut self, dialog: Dialog) {
        self.open = if self.open == Some(dialog) { None } else { Some(dialog) };
    }

    /// Carries out what the interface can do by itself; gives back the rest.
    pub fn take_effect(&mut self, effect: Effect, ctx: &egui::Context) -> Option<Effect> {
        match effect {
            Effect::AskForExport => self.open = Some(Dialog::Export),
            Effect::BuildStudy => self.study_builder.show(),
            Effect::AskForPose => self.open = Some(Dialog::PastePose),
            Effect::TogglePalette => self.toggle(Dialog::Palette),
            Effect::ToggleShortcuts => self.toggle(Dialog::Shortcuts),
            Effect::TogglePanels => self.panels_hidden = !self.panels_hidden,
            Effect::ToggleTheme => self.preferences.toggle_theme(ctx.theme()),
            Effect::Notify(notice) => self.toasts.add(notice),
            other => return Some(other),
        }
        None
    }
}

/// What the interface shows besides the session.
pub struct Surroundings<'a> {
    pub hands: &'a Hands,
    pub renderer: Option<&'a SharedRenderer>,
    /// The pixels of the photo that is shown, once they are decoded.
    pub pixels: Option<std::sync::Arc<crate::photo::Pixels>>,
    /// Its masks, tinted.
    pub masks: Option<std::sync::Arc<crate::photo::Pixels>>,
    /// Its depth map, once it is decoded.
    pub depth: Option<std::sync::Arc<crate::photo::DepthPixels>>,
    /// An object that is on its way to its new pose: where it is drawn.
    pub drawn_pose: Option<(PhotoId, ObjectId, Pose)>,
    /// What the last search for symmetries found.
    pub symmetries: SymmetryView<'a>,
    pub saving: Saving,
    /// What is being loaded.
    pub busy: Option<Busy>,
    pub update_ready: bool,
    /// Files are being dragged over the window.
    pub files_hover: bool,
    /// A data set that waits for the user, or is being opened.
    pub dataset: Option<DatasetView<'a>>,
    /// The scenes that are stored, the one that was changed last first.
    pub scenes: &'a [SceneSummary],
    pub store: StoreView<'a>,
    /// What is known of the study that is being built.
    pub builder: Option<BuilderView<'a>>,
    /// And of the report of one.
    pub report: Option<ReportView<'a>>,
    /// Results of studies that are kept in this browser.
    pub kept: Option<KeptView<'a>>,
}

impl Surroundings<'_> {
    fn drawn_pose_in(&self, shown: PhotoId) -> Option<(ObjectId, Pose)> {
        self.drawn_pose.filter(|(photo, ..)| *photo == shown).map(|(_, object, pose)| (object, pose))
    }
}

/// A motion of the selected object that is seen on the screen only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShownMotion {
    /// About an axis of symmetry.
    Turn(SymmetryAxis),
    /// To either side, as far as the pose is unsure.
    Sway(Weakest),
}

/// What was found of a mesh's symmetries, and of which.
#[derive(Debug, Clone, Copy, Default)]
pub struct SymmetryView<'a> {
    pub found: Option<(&'a std::sync::Arc<MeshAsset>, &'a FoundSymmetries)>,
}

/// What is known of the store besides its scenes.
#[derive(Debug, Clone, Copy, Default)]
pub struct StoreView<'a> {
    pub open_scene: Option<&'a SceneId>,
    /// A scene is on its way in.
    pub is_opening: bool,
    pub usage: Option<StorageUse>,
    /// Milliseconds since 1970, UTC.
    pub now_ms: f64,
}

/// What the user waits for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Busy {
    pub text: String,
    pub can_cancel: bool,
}

/// Is the scene in the browser's storage?
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Saving {
    #[default]
    Saved,
    Pending,
    Failed(String),
}

/// What the user asked for in this frame.
#[derive(Debug, Default)]
pub struct Asked {
    pub commands: Vec<Command>,
    pub scene_requests: Vec<SceneRequest>,
    pub dataset_requests: Vec<DatasetRequest>,
    pub scene_move: Option<SceneMove>,
    pub apply_update: bool,
    pub cancel_loading: bool,
    pub export: Option<ExportRequest>,
    pub show_motion: Option<ShownMotion>,
    pub study_build: Option<StudyBuild>,
    /// Pictures for a study's texts are to be picked.
    pub study_pictures: bool,
    pub report: Option<ReportRequest>,
    pub kept: Option<KeptRequest>,
}

/// Draws a whole frame.
pub fn draw(ui: &mut egui::Ui, session: &Session, around: &Surroundings<'_>, state: &mut UiState) -> Asked {
    let mut asked = Asked::default();
    ui.ctx().set_theme(state.preferences.theme.preference());
    state.preferences.keymap.put_on(ui.ctx());
    let visuals = ui.ctx().global_style().visuals.clone();
    Panel::top("top bar").frame(theme::bar_frame(&visuals)).show(ui, |ui| {
        top_bar::draw(ui, session, around, &mut state.preferences, &mut state.top_bar, &mut asked);
    });
    // An empty scene has nothing to list.
    if !state.panels_hidden && !session.scene().is_empty() {
        Panel::left("side panel")
            .frame(theme::panel_frame(&visuals))
            .default_size(theme::PANEL_WIDTH)
            .size_range(panels::WIDTHS)
            .resizable(true)
            .show(ui, |ui| {
                let UiState { preferences, panels, .. } = state;
                panels::draw(ui, session, around, preferences, panels, &mut asked.commands);
            });
        asked.show_motion = state.panels.take_asked_motion();
    }
    if !state.panels_hidden && strip::is_shown(session) {
        Panel::bottom("photo strip").frame(theme::bar_frame(&visuals)).show(ui, |ui| {
            let UiState { preferences, strip, thumbnails, .. } = state;
            strip::draw(ui, session, preferences, strip, thumbnails, &mut asked.commands);
        });
    }
    let is_empty = session.scene().is_empty();
    // Where there is no photo to judge, the ground is the theme's.
    let ground = if is_empty { visuals.panel_fill } else { theme::VIEWPORT_BACKGROUND };
    CentralPanel::default().frame(Frame::NONE.fill(ground)).show(ui, |ui| {
        if is_empty {
            (state.viewport, state.scene_viewport) = (None, None);
            welcome::draw(ui, around, &mut asked);
        } else {
            theme::use_dark(ui);
            viewport::draw(ui, session, around, state, &mut asked);
        }
    });
    dialogs::draw(ui.ctx(), session, state, &mut asked);
    if let Some(dataset) = &around.dataset {
        dataset_dialog::draw(ui.ctx(), dataset, &mut asked.dataset_requests);
    }
    study_builder::draw(ui.ctx(), session, around.builder.as_ref(), &mut state.study_builder, &mut asked);
    report_dialog::draw(ui.ctx(), around.report.as_ref(), &mut state.report_dialog, &mut asked.report);
    kept_dialog::draw(ui.ctx(), around.kept.as_ref(), &mut state.kept_dialog, &mut asked.kept);
    scenes_dialog::draw(ui.ctx(), around, &mut state.scenes_dialog, &mut asked.scene_requests);
    match state.toasts.draw(ui.ctx()) {
        Some(Offer::Workspace) => asked.commands.push(Command::Run(CommandId::ExportWorkspace)),
        Some(Offer::Stored(id)) => asked.scene_requests.push(SceneRequest::DownloadStored(id)),
        None => {}
    }
    asked
}

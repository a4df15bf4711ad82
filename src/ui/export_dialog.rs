//! What to export, of which photos, and in which convention.

use std::collections::BTreeSet;

use egui::{Align, Button, Layout, RichText, ScrollArea, Ui, Vec2};

use super::dialogs::BUTTON_SIZE;
use super::{once, theme};
use crate::formats::Keep;
use crate::formats::export::{CameraAxes, ExportOptions, ExportPart, LengthUnit, PhotoChoice, PoseDirection};
use crate::platform::ExportFolder;
use crate::scene::{AnnotationState, Photo, PhotoId};
use crate::session::Session;

const WIDTH: f32 = 660.0;
const COLUMN_GAP: f32 = 28.0;
const LIST_HEIGHT: f32 = 132.0;

/// What was chosen last; it stays for the next export.
#[derive(Debug, Default)]
pub struct State {
    options: ExportOptions,
    which: Which,
    /// Photos that were ticked; some may have gone since.
    ticked: BTreeSet<PhotoId>,
}

/// Photos to export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Which {
    #[default]
    All,
    Shown,
    Ticked,
}

/// What the user wants to be exported.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportRequest {
    pub options: ExportOptions,
    /// Into a folder that the user picks, not as one file.
    pub into_folder: bool,
}

/// Draws the dialog; true if it is to be closed.
pub fn draw(
    ctx: &egui::Context,
    session: &Session,
    state: &mut State,
    request: &mut Option<ExportRequest>,
) -> bool {
    let frame = theme::dialog_frame(ctx);
    let modal = once::modal(ctx, "export", frame, |ui| {
        ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 64.0));
        ui.heading("Export files");
        ui.add_space(8.0);
        let column_width = (ui.available_width() - COLUMN_GAP) / 2.0;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = COLUMN_GAP;
            column(ui, column_width, |ui| parts(ui, &mut state.options.parts));
            column(ui, column_width, |ui| choices(ui, session, state));
        });
        ui.add_space(10.0);
        buttons(ui, session, state, request)
    });
    modal.inner || modal.should_close()
}

fn column(ui: &mut Ui, width: f32, body: impl FnOnce(&mut Ui)) {
    ui.allocate_ui_with_layout(Vec2::new(width, 0.0), Layout::top_down(Align::Min), |ui| {
        ui.set_width(width);
        ui.spacing_mut().item_spacing = Vec2::new(8.0, 5.0);
        body(ui);
    });
}

fn parts(ui: &mut Ui, chosen: &mut BTreeSet<ExportPart>) {
    ui.label(RichText::new("Files").strong());
    for (part, _, title, meaning) in ExportPart::ALL {
        let mut is_chosen = chosen.contains(&part);
        if ui.checkbox(&mut is_chosen, title).on_hover_text(meaning).changed() {
            if is_chosen {
                chosen.insert(part);
            } else {
                chosen.remove(&part);
            }
        }
    }
}

fn choices(ui: &mut Ui, session: &Session, state: &mut State) {
    let count = session.scene().photos.len();
    ui.label(RichText::new("Photos").strong());
    ui.horizontal(|ui| {
        let all = if count == 1 { "All".to_owned() } else { format!("All {count}") };
        ui.radio_value(&mut state.which, Which::All, all);
        ui.add_enabled_ui(session.photo().is_some(), |ui| {
            ui.radio_value(&mut state.which, Which::Shown, "The one shown");
        });
        ui.add_enabled_ui(count > 1, |ui| ui.radio_value(&mut state.which, Which::Ticked, "Some"));
    });
    if state.which == Which::Ticked {
        photo_list(ui, session, &mut state.ticked);
        ui.add_space(4.0);
    }
    let mut with_others = state.options.keep == Keep::Everything;
    let tooltip = "Else only what somebody posed or confirmed is exported";
    if ui.checkbox(&mut with_others, "Untouched and carried poses too").on_hover_text(tooltip).changed() {
        state.options.keep = if with_others { Keep::Everything } else { Keep::Annotated };
    }
    ui.add_space(8.0);
    ui.label(RichText::new("Convention").strong());
    let matters = state.options.parts.iter().any(|part| part.has_convention());
    let convention = &mut state.options.convention;
    ui.add_enabled_ui(matters, |ui| {
        choice(
            ui,
            "Camera axes",
            &mut convention.axes,
            [
                (CameraAxes::OpenCv, "OpenCV", "x right, y down, z forward"),
                (CameraAxes::OpenGl, "OpenGL", "x right, y up, z towards the viewer; Blender's too"),
            ],
        );
        choice(
            ui,
            "Length",
            &mut convention.unit,
            [(LengthUnit::Millimetre, "mm", "Millimetres"), (LengthUnit::Metre, "m", "Metres")],
        );
        choice(
            ui,
            "Direction",
            &mut convention.direction,
            [
                (
                    PoseDirection::CameraFromObject,
                    "Object's pose",
                    "camera_from_object: X_camera = R X_object + t",
                ),
                (PoseDirection::ObjectFromCamera, "Camera's pose", "object_from_camera, the inverse"),
            ],
        );
    });
    let words = if matters {
        "For poses as JSON, .npy and CSV. PinPose JSON and BOP have theirs fixed; every file says what it holds."
    } else {
        "PinPose JSON and BOP have theirs fixed: OpenCV axes, millimetres, the object's pose."
    };
    ui.add(egui::Label::new(RichText::new(words).small().weak()).wrap());
}

/// The photos with a tick each; a thousand cost what a dozen do.
fn photo_list(ui: &mut Ui, session: &Session, ticked: &mut BTreeSet<PhotoId>) {
    let scene = session.scene();
    let is_done = |photo: &Photo| {
        matches!(scene.photo_state(photo.id), Some(AnnotationState::Posed | AnnotationState::Confirmed))
    };
    ui.horizontal(|ui| {
        if ui.small_button("None").clicked() {
            ticked.clear();
        }
        if ui.small_button("Finished").on_hover_text("All whose objects are all posed").clicked() {
            *ticked = scene.photos.iter().filter(|photo| is_done(photo)).map(|photo| photo.id).collect();
        }
        let count = scene.photos.iter().filter(|photo| ticked.contains(&photo.id)).count();
        ui.weak(format!("{count} of {}", scene.photos.len()));
    });
    let row_height = ui.spacing().interact_size.y;
    ScrollArea::vertical()
        .min_scrolled_height(LIST_HEIGHT)
        .max_height(LIST_HEIGHT)
        .auto_shrink([false, true])
        .show_rows(ui, row_height, scene.photos.len(), |ui, rows| {
            for photo in scene.photos.get(rows).unwrap_or_default() {
                let mut is_ticked = ticked.contains(&photo.id);
                if ui.checkbox(&mut is_ticked, &photo.name).changed() {
                    if is_ticked {
                        ticked.insert(photo.id);
                    } else {
                        ticked.remove(&photo.id);
                    }
                }
            }
        });
}

fn choice<T: PartialEq + Copy>(ui: &mut Ui, label: &str, value: &mut T, options: [(T, &str, &str); 2]) {
    ui.horizontal(|ui| {
        ui.allocate_ui_with_layout(Vec2::new(84.0, 20.0), Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(84.0);
            ui.label(label);
        });
        for (option, text, meaning) in options {
            ui.selectable_value(value, option, text).on_hover_text(meaning);
        }
    });
}

/// Export, into a folder, and Cancel; true if the dialog is done.
fn buttons(ui: &mut Ui, session: &Session, state: &State, request: &mut Option<ExportRequest>) -> bool {
    let photos = chosen_photos(session, state);
    let has_photos = !matches!(&photos, PhotoChoice::These(photos) if photos.is_empty());
    let is_something = has_photos && !state.options.parts.is_empty();
    let (mut into_file, mut into_folder, mut is_cancelled) = (false, false, false);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let button = theme::primary_button("Export").min_size(BUTTON_SIZE);
        into_file = ui.add_enabled(is_something, button).on_hover_text("As one zip").clicked();
        if ExportFolder::can_be_picked() {
            let button = Button::new("Into a folder…").min_size(BUTTON_SIZE);
            into_folder = ui.add_enabled(is_something, button).clicked();
        }
        is_cancelled = ui.add(Button::new("Cancel").min_size(BUTTON_SIZE)).clicked();
    });
    if into_file || into_folder {
        *request =
            Some(ExportRequest { options: ExportOptions { photos, ..state.options.clone() }, into_folder });
    }
    into_file || into_folder || is_cancelled
}

/// A photo that has gone is not exported.
fn chosen_photos(session: &Session, state: &State) -> PhotoChoice {
    match state.which {
        Which::All => PhotoChoice::All,
        Which::Shown => {
            session.photo().map_or(PhotoChoice::All, |photo| PhotoChoice::These(BTreeSet::from([photo.id])))
        }
        Which::Ticked => {
            let photos = session.scene().photos.iter().map(|photo| photo.id);
            PhotoChoice::These(photos.filter(|photo| state.ticked.contains(photo)).collect())
        }
    }
}

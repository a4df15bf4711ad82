//! The list of photos.

use egui::{Color32, Sense, Ui, Vec2};

use super::PanelState;
use super::list::{self, List, NameLook, Rename, RowKey};
use super::section::section;
use crate::scene::{AnnotationState, Photo, Scene};
use crate::session::{Command, CommandId, PhotoChange, Session};
use crate::ui::command_button::command_icon;
use crate::ui::icons::Icon;
use crate::ui::theme;

pub fn draw(ui: &mut Ui, session: &Session, state: &mut PanelState, commands: &mut Vec<Command>) {
    let photos = &session.scene().photos;
    let shown = session.photo().map(|photo| photo.id);
    let is_new = std::mem::replace(&mut state.shown_photo, shown) != shown;
    let reveal = photos.iter().position(|photo| is_new && Some(photo.id) == shown);
    let mut asked = Vec::new();
    let import = |ui: &mut Ui| {
        if command_icon(ui, Icon::Plus, CommandId::ImportPhotos, session).clicked() {
            asked.push(Command::Run(CommandId::ImportPhotos));
        }
    };
    section(ui, "Photos", true, import, |ui| {
        if photos.is_empty() {
            super::number_field::note(ui, "Drop a photo (PNG, JPEG, …)", true);
        }
        list::rows(ui, List::Photos, photos.len(), reveal, |ui, index| {
            photo_row(ui, session, index, &photos[index], state, commands);
        });
    });
    commands.append(&mut asked);
}

fn photo_row(
    ui: &mut Ui,
    session: &Session,
    index: usize,
    photo: &Photo,
    state: &mut PanelState,
    commands: &mut Vec<Command>,
) {
    let key = RowKey { list: List::Photos, id: photo.id.0 };
    let mut asked = Vec::new();
    let dropped = list::row(ui, key, index, |ui| {
        photo_state(ui, session.scene(), photo);
        let look = NameLook {
            name: &photo.name,
            selected: session.photo().map(|photo| photo.id) == Some(photo.id),
            weak: !photo.visible,
            room: 78.0,
            tooltip: &format!("{}, {} × {} px", photo.asset.file_name, photo.asset.width, photo.asset.height),
        };
        let name = list::name(ui, key, look, &mut state.rename);
        if let Some(new) = name.renamed {
            asked.push(Command::EditPhoto(photo.id, PhotoChange::Name(new)));
        }
        if name.response.as_ref().is_some_and(egui::Response::clicked) {
            asked.push(Command::ShowPhoto(photo.id));
        }
        if list::lock(ui, &photo.name, photo.locked) {
            asked.push(Command::EditPhoto(photo.id, PhotoChange::Locked(!photo.locked)));
        }
        if list::eye(ui, &photo.name, photo.visible) {
            asked.push(Command::EditPhoto(photo.id, PhotoChange::Visible(!photo.visible)));
        }
        list::row_menu(ui, &photo.name, name.response.as_ref(), |ui| {
            photo_menu(ui, session, index, photo, &mut state.rename, &mut asked);
        });
    });
    commands.append(&mut asked);
    commands.extend(dropped.map(|(id, to)| Command::MovePhoto(crate::scene::PhotoId(id), to)));
}

fn photo_menu(
    ui: &mut Ui,
    session: &Session,
    index: usize,
    photo: &Photo,
    rename: &mut Option<Rename>,
    commands: &mut Vec<Command>,
) {
    if list::item(ui, "Rename", None) {
        *rename = Some(Rename::new(RowKey { list: List::Photos, id: photo.id.0 }, &photo.name));
    }
    if list::item(ui, "Copy poses from here", why_not_copied(session, photo)) {
        commands.push(Command::CopyPosesFrom(photo.id));
    }
    let name = format!("Opacity of {}", photo.name);
    if let Some(opacity) = list::opacity(ui, &name, "opacity", photo.opacity) {
        commands.push(Command::EditPhoto(photo.id, PhotoChange::Opacity(opacity)));
    }
    if let Some(to) = list::move_items(ui, index, session.scene().photos.len()) {
        commands.push(Command::MovePhoto(photo.id, to));
    }
    ui.separator();
    if list::item(ui, &format!("Remove {}", photo.name), None) {
        commands.push(Command::RemovePhoto(photo.id));
    }
}

fn why_not_copied(session: &Session, photo: &Photo) -> Option<&'static str> {
    if session.photo().map(|shown| shown.id) == Some(photo.id) {
        return Some("this is the photo that is shown: use it in another photo's menu");
    }
    let known = |object| session.scene().annotation(photo.id, object).is_some();
    (!session.selection().into_iter().any(known)).then_some("no selected object is in that photo")
}

/// What has been done in a photo: an empty, a half or a full dot, and words.
fn photo_state(ui: &mut Ui, scene: &Scene, photo: &Photo) {
    let (filled, color, meaning) = match scene.photo_state(photo.id) {
        None => (0.0, ui.visuals().weak_text_color(), "No object in this photo yet"),
        Some(AnnotationState::Posed | AnnotationState::Confirmed) => {
            (5.0, theme::GOOD, "Every object in this photo is posed")
        }
        Some(AnnotationState::Untouched | AnnotationState::Carried) => {
            (2.2, ui.visuals().warn_fg_color, "An object in this photo waits for its pose")
        }
    };
    let (rect, response) = ui.allocate_exact_size(Vec2::new(14.0, list::ROW_HEIGHT), Sense::hover());
    ui.painter().circle(rect.center(), 4.5, Color32::TRANSPARENT, egui::Stroke::new(1.3, color));
    ui.painter().circle_filled(rect.center(), filled, color);
    response.on_hover_text(meaning);
}

//! The strip of photos: thumbnails with names and what has been done in each, and how far the work is.

use egui::{
    Align, Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, TextStyle, TextWrapMode, Ui, Vec2, WidgetText,
    pos2, vec2,
};

use super::icons::{Icon, icon_button};
use super::thumbnails::Thumbnails;
use super::{Preferences, theme};
use crate::scene::{AnnotationState, Photo, PhotoId, Scene};
use crate::session::{Command, Session};

const CELL: Vec2 = vec2(112.0, 92.0);
const PICTURE: Vec2 = vec2(104.0, 64.0);
const GAP: f32 = 4.0;

#[derive(Debug, Default)]
pub struct State {
    /// The photo that was last scrolled to.
    followed: Option<PhotoId>,
}

/// What has been done in a photo, for the strip: one without objects is as untouched as one whose objects are.
fn progress_of(scene: &Scene, photo: PhotoId) -> AnnotationState {
    scene.photo_state(photo).unwrap_or(AnnotationState::Untouched)
}

fn words(progress: AnnotationState) -> &'static str {
    match progress {
        AnnotationState::Untouched => "not posed yet",
        AnnotationState::Carried => "carried over, to be checked",
        AnnotationState::Posed => "posed",
        AnnotationState::Confirmed => "confirmed",
    }
}

pub fn is_shown(session: &Session) -> bool {
    session.scene().photos.len() > 1
}

pub fn draw(
    ui: &mut Ui,
    session: &Session,
    preferences: &mut Preferences,
    state: &mut State,
    thumbnails: &mut Thumbnails,
    commands: &mut Vec<Command>,
) {
    thumbnails.begin_frame();
    head(ui, session, &mut preferences.strip_folded);
    if preferences.strip_folded {
        return;
    }
    ui.add_space(2.0);
    cells(ui, session, state, thumbnails, commands);
}

/// How many photos are done, in words and as a thin bar.
fn head(ui: &mut Ui, session: &Session, folded: &mut bool) {
    let scene = session.scene();
    let is_confirmed = |photo: &&Photo| progress_of(scene, photo.id) == AnnotationState::Confirmed;
    let confirmed = scene.photos.iter().filter(is_confirmed).count();
    let count = scene.photos.len();
    ui.horizontal(|ui| {
        let (icon, label) = if *folded { (Icon::Unfold, "Show photos") } else { (Icon::Fold, "Fold photos") };
        if icon_button(ui, icon, label, label, true).clicked() {
            *folded = !*folded;
        }
        ui.label(format!("{confirmed} of {count} confirmed"));
        let (rect, _) = ui.allocate_exact_size(vec2(120.0, 4.0), Sense::hover());
        ui.painter().rect_filled(rect, 2.0, ui.visuals().widgets.inactive.bg_fill);
        let share = confirmed as f32 / count.max(1) as f32;
        let done = Rect::from_min_size(rect.min, vec2(rect.width() * share, rect.height()));
        ui.painter().rect_filled(done, 2.0, theme::GOOD);
        let shown = scene.photos.iter().position(|photo| Some(photo.id) == session.photo().map(|p| p.id));
        if let Some(shown) = shown {
            ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
                ui.weak(format!("Photo {} of {count}", shown + 1));
            });
        }
    });
}

/// Lays out the photos that are in sight alone.
fn cells(
    ui: &mut Ui,
    session: &Session,
    state: &mut State,
    thumbnails: &mut Thumbnails,
    commands: &mut Vec<Command>,
) {
    let scene = session.scene();
    let shown = session.photo().map(|photo| photo.id);
    let step = CELL.x + GAP;
    // The wheel goes along the strip: there is no other way to go.
    ui.style_mut().always_scroll_the_only_direction = true;
    egui::ScrollArea::horizontal().auto_shrink([false, true]).show_viewport(ui, |ui, viewport| {
        let count = scene.photos.len();
        ui.set_min_size(vec2(step * count as f32 - GAP, CELL.y));
        let origin = ui.max_rect().min;
        let cell = |index: usize| Rect::from_min_size(origin + vec2(step * index as f32, 0.0), CELL);
        if state.followed != shown {
            let position = scene.photos.iter().position(|photo| Some(photo.id) == shown);
            if let Some(position) = position {
                ui.scroll_to_rect(cell(position), Some(Align::Center));
            }
            state.followed = shown;
        }
        let first = (viewport.left() / step).floor().max(0.0) as usize;
        let last = ((viewport.right() / step).ceil().max(0.0) as usize).min(count);
        for (index, photo) in scene.photos.iter().enumerate().take(last).skip(first) {
            if draw_cell(ui, cell(index), scene, photo, Some(photo.id) == shown, thumbnails) {
                commands.push(Command::ShowPhoto(photo.id));
                // It is in sight: nothing has to jump under the hand.
                state.followed = Some(photo.id);
            }
        }
    });
}

fn draw_cell(
    ui: &mut Ui,
    rect: Rect,
    scene: &Scene,
    photo: &Photo,
    is_shown: bool,
    thumbnails: &mut Thumbnails,
) -> bool {
    let progress = progress_of(scene, photo.id);
    let response = ui.interact(rect, ui.scope_id().with(("photo", photo.id.0)), Sense::click());
    response.widget_info(|| {
        let label = format!("Photo {}, {}", photo.name, words(progress));
        egui::WidgetInfo::selected(egui::Role::Button, true, is_shown, label)
    });
    let visuals = ui.visuals().clone();
    if is_shown {
        ui.painter().rect_filled(rect, 6.0, visuals.selection.bg_fill);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 6.0, visuals.widgets.hovered.weak_bg_fill);
    }
    let frame = Rect::from_min_size(rect.min + vec2((CELL.x - PICTURE.x) / 2.0, GAP), PICTURE);
    picture(ui, frame, photo, thumbnails);
    let text = if is_shown { visuals.selection.stroke.color } else { visuals.text_color() };
    let foot = Rect::from_min_max(pos2(frame.left(), frame.bottom() + 2.0), rect.max - vec2(4.0, 2.0));
    mark(ui.painter(), pos2(foot.left() + 6.0, foot.center().y), progress, &visuals, is_shown);
    name(ui, foot, &photo.name, text);
    response.on_hover_text(format!("{}: {}", photo.name, words(progress))).clicked()
}

/// The thumbnail, as large as it fits; an empty frame until it has come.
fn picture(ui: &Ui, frame: Rect, photo: &Photo, thumbnails: &mut Thumbnails) {
    ui.painter().rect_filled(frame, 3.0, theme::VIEWPORT_BACKGROUND);
    let Some(texture) = thumbnails.get(photo.asset.sha256) else { return };
    let size = texture.size_vec2();
    let scale = (frame.width() / size.x).min(frame.height() / size.y);
    let rect = Rect::from_center_size(frame.center(), size * scale);
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
}

fn name(ui: &mut Ui, foot: Rect, name: &str, color: Color32) {
    let room = foot.with_min_x(foot.left() + 16.0);
    let galley =
        WidgetText::from(name).into_galley(ui, Some(TextWrapMode::Truncate), room.width(), TextStyle::Small);
    let at = pos2(room.left(), room.center().y - galley.size().y / 2.0);
    ui.painter().galley_with_override_text_color(at, galley, color);
}

/// The state by shape first: a ring, a half disc, a disc, a tick; and by colour.
fn mark(
    painter: &Painter,
    center: Pos2,
    progress: AnnotationState,
    visuals: &egui::Visuals,
    is_selected: bool,
) {
    let on_selection = |color| if is_selected { visuals.selection.stroke.color } else { color };
    let (radius, width) = (4.0, 1.4);
    match progress {
        AnnotationState::Untouched => {
            painter.circle_stroke(
                center,
                radius,
                Stroke::new(width, on_selection(visuals.weak_text_color())),
            );
        }
        AnnotationState::Carried => {
            let color = on_selection(theme::warning(visuals));
            painter.circle_stroke(center, radius, Stroke::new(width, color));
            let half = (0..=12).map(|step| {
                let angle = (90.0 + 15.0 * step as f32).to_radians();
                center + radius * Vec2::angled(angle)
            });
            painter.add(Shape::convex_polygon(half.collect(), color, Stroke::NONE));
        }
        AnnotationState::Posed => {
            painter.circle_filled(center, radius + 0.5, on_selection(theme::accent(visuals)));
        }
        AnnotationState::Confirmed => {
            let tick = [vec2(-4.0, 0.0), vec2(-1.0, 3.2), vec2(4.5, -3.8)].map(|offset| center + offset);
            painter.line(tick.to_vec(), Stroke::new(2.0, on_selection(theme::good(visuals))));
        }
    }
}

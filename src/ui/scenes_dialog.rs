//! The saved scenes: a list to open, rename, copy and delete them, and the question under which name to save a copy.

mod row;
pub mod words;

use egui::{Align, Button, Context, Id, Key, Layout, RichText, TextEdit, Ui, Vec2};

use super::{Surroundings, once, theme};
use crate::platform::{SceneId, SceneSummary};

/// What the user wants to be done with scenes.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneRequest {
    /// Show the list.
    Show,
    New,
    Open(SceneId),
    Rename(SceneId, String),
    Duplicate(SceneId),
    /// For good: the dialog has asked.
    Delete(SceneId),
    /// Go on in a copy under this name.
    SaveAs(String),
    /// What is stored of it, as a file, in whatever state it is.
    DownloadStored(SceneId),
}

/// From so many scenes on there is a field to search in.
const SEARCHED_FROM: usize = 9;

const WIDTH: f32 = 620.0;

#[derive(Debug, Default)]
pub struct State {
    page: Page,
    /// The scene that the buttons and keys are for.
    selected: Option<SceneId>,
    search: String,
    /// The name as it is being typed.
    renaming: Option<String>,
    is_deleting: bool,
    /// A field that was just opened takes the keyboard.
    takes_focus: bool,
}

#[derive(Debug, Default, PartialEq)]
enum Page {
    #[default]
    Closed,
    List,
    /// The name of the copy, as it is being typed.
    Name(String),
}

impl State {
    pub fn is_open(&self) -> bool {
        self.page != Page::Closed
    }

    /// Shows the list.
    pub fn show(&mut self) {
        *self = Self { page: Page::List, ..Self::default() };
    }

    /// Asks for the name of a copy, beginning with this one.
    pub fn ask_name(&mut self, name: &str) {
        *self = Self { page: Page::Name(name.to_owned()), takes_focus: true, ..Self::default() };
    }

    fn close(&mut self) {
        *self = Self::default();
    }
}

/// Draws what is open, and says what the user wants.
pub fn draw(ctx: &Context, around: &Surroundings<'_>, state: &mut State, requests: &mut Vec<SceneRequest>) {
    if !state.is_open() {
        return;
    }
    // Esc goes back one step.
    let has_step_back = state.renaming.is_some() || state.is_deleting;
    let modal = once::modal(ctx, "scenes", theme::dialog_frame(ctx), |ui| match &state.page {
        Page::Name(_) => name_form(ui, state, requests),
        Page::List => list(ui, around, state, requests),
        Page::Closed => {}
    });
    if !modal.should_close() {
        return;
    }
    if has_step_back {
        state.renaming = None;
        state.is_deleting = false;
    } else {
        state.close();
    }
}

fn name_form(ui: &mut Ui, state: &mut State, requests: &mut Vec<SceneRequest>) {
    let Page::Name(name) = &mut state.page else { return };
    ui.set_width(380.0);
    ui.heading("Save as");
    ui.add_space(6.0);
    ui.label(RichText::new("You go on in the copy; the scene as it was stays in the list.").weak());
    ui.add_space(8.0);
    let label = ui.label("Name");
    let field = ui.add(TextEdit::singleline(name).desired_width(f32::INFINITY)).labelled_by(label.id);
    if std::mem::take(&mut state.takes_focus) {
        focus_all(ui, &field, name);
    }
    let is_named = !name.trim().is_empty();
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    ui.add_space(10.0);
    let (mut is_saved, mut is_cancelled) = (is_entered && is_named, false);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let save = theme::primary_button("Save").min_size(Vec2::new(84.0, 28.0));
        is_saved |= ui.add_enabled(is_named, save).clicked();
        is_cancelled = ui.add(Button::new("Cancel").min_size(Vec2::new(84.0, 28.0))).clicked();
    });
    if is_saved {
        requests.push(SceneRequest::SaveAs(name.trim().to_owned()));
    }
    if is_saved || is_cancelled {
        state.close();
    }
}

fn list(ui: &mut Ui, around: &Surroundings<'_>, state: &mut State, requests: &mut Vec<SceneRequest>) {
    ui.set_width(WIDTH);
    let mut is_closed = false;
    ui.horizontal(|ui| {
        ui.heading("Scenes");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            is_closed = ui.button("Close").clicked();
            if ui.button("New scene").on_hover_text("Start with an empty one; all of these stay").clicked() {
                requests.push(SceneRequest::New);
                is_closed = true;
            }
        });
    });
    ui.add_space(6.0);
    search_field(ui, around.scenes.len(), state);
    let shown = matching(around.scenes, &state.search);
    keep_selection(&shown, around, state);
    if shown.is_empty() {
        empty(ui, &state.search);
    } else {
        egui::ScrollArea::vertical().max_height(ui.ctx().content_rect().height() - 260.0).show(ui, |ui| {
            for scene in &shown {
                is_closed |= draw_row(ui, scene, around, state, requests);
            }
        });
        is_closed |= keys(ui, &shown, state, requests);
    }
    ui.add_space(6.0);
    ui.separator();
    is_closed |= foot(ui, around, &shown, state, requests);
    if is_closed {
        state.close();
    }
}

fn search_field(ui: &mut Ui, scene_count: usize, state: &mut State) {
    if scene_count < SEARCHED_FROM {
        state.search.clear();
        return;
    }
    let field = TextEdit::singleline(&mut state.search)
        .id(search_id())
        .hint_text("Search")
        .desired_width(f32::INFINITY);
    let response = ui.add(field);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search scenes"));
    ui.add_space(4.0);
}

fn search_id() -> Id {
    Id::unique("search scenes")
}

fn matching<'a>(scenes: &'a [SceneSummary], search: &str) -> Vec<&'a SceneSummary> {
    let wanted = search.trim().to_lowercase();
    scenes.iter().filter(|scene| scene.heading.title().to_lowercase().contains(&wanted)).collect()
}

/// Something that is shown is selected: the open scene first of all.
fn keep_selection(shown: &[&SceneSummary], around: &Surroundings<'_>, state: &mut State) {
    let is_shown = |id: &SceneId| shown.iter().any(|scene| scene.id == *id);
    if state.selected.as_ref().is_some_and(is_shown) {
        return;
    }
    state.renaming = None;
    state.is_deleting = false;
    let open = around.store.open_scene.filter(|id| is_shown(id)).cloned();
    state.selected = open.or_else(|| shown.first().map(|scene| scene.id.clone()));
}

fn empty(ui: &mut Ui, search: &str) {
    ui.add_space(24.0);
    ui.vertical_centered(|ui| {
        if search.trim().is_empty() {
            ui.label("No scene is saved yet.");
            ui.label(RichText::new("What you open is saved here by itself, within a second.").weak());
        } else {
            ui.label(format!("No scene is called \"{}\".", search.trim()));
        }
    });
    ui.add_space(24.0);
}

/// Draws one scene; true if the dialog is done.
fn draw_row(
    ui: &mut Ui,
    scene: &SceneSummary,
    around: &Surroundings<'_>,
    state: &mut State,
    requests: &mut Vec<SceneRequest>,
) -> bool {
    let is_selected = state.selected.as_ref() == Some(&scene.id);
    if is_selected && let Some(name) = &mut state.renaming {
        let field = row::name_field(ui, name);
        if std::mem::take(&mut state.takes_focus) {
            focus_all(ui, &field, name);
        }
        if field.lost_focus() {
            // Taken, or it would open the scene too.
            let is_entered = ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Enter));
            let name = state.renaming.take().unwrap_or_default();
            if is_entered && !name.trim().is_empty() {
                requests.push(SceneRequest::Rename(scene.id.clone(), name.trim().to_owned()));
            }
        }
        return false;
    }
    let is_open = around.store.open_scene == Some(&scene.id);
    let response = row::draw(ui, scene, around.store.now_ms, is_selected, is_open);
    if response.clicked() {
        state.selected = Some(scene.id.clone());
        state.renaming = None;
        state.is_deleting = false;
    }
    if response.double_clicked() {
        requests.push(SceneRequest::Open(scene.id.clone()));
    }
    response.double_clicked()
}

/// Arrows choose, Enter opens, F2 renames, Delete asks; true if the dialog is done.
fn keys(ui: &Ui, shown: &[&SceneSummary], state: &mut State, requests: &mut Vec<SceneRequest>) -> bool {
    // A focused button or field has the keys for itself; while one searches, one can choose.
    let focused = ui.memory(egui::Memory::focused);
    let is_searching = focused == Some(search_id());
    if state.renaming.is_some() || (focused.is_some() && !is_searching) {
        return false;
    }
    let none = egui::Modifiers::NONE;
    let pressed = |key| ui.input_mut(|input| input.consume_key(none, key));
    let position = shown.iter().position(|scene| state.selected.as_ref() == Some(&scene.id)).unwrap_or(0);
    let step = isize::from(pressed(Key::ArrowDown)) - isize::from(pressed(Key::ArrowUp));
    if step != 0 {
        let next = position.saturating_add_signed(step).min(shown.len().saturating_sub(1));
        state.selected = shown.get(next).map(|scene| scene.id.clone());
        state.is_deleting = false;
    }
    let Some(selected) = shown.iter().find(|scene| state.selected.as_ref() == Some(&scene.id)) else {
        return false;
    };
    if !is_searching && pressed(Key::F2) {
        begin_renaming(state, selected);
    }
    if !is_searching && pressed(Key::Delete) {
        state.is_deleting = true;
    }
    if pressed(Key::Enter) && !state.is_deleting {
        requests.push(SceneRequest::Open(selected.id.clone()));
        return true;
    }
    false
}

fn begin_renaming(state: &mut State, scene: &SceneSummary) {
    state.renaming = Some(scene.heading.title().to_owned());
    state.takes_focus = true;
    state.is_deleting = false;
}

/// The buttons for the selected scene, and how much is stored; true if the dialog is done.
fn foot(
    ui: &mut Ui,
    around: &Surroundings<'_>,
    shown: &[&SceneSummary],
    state: &mut State,
    requests: &mut Vec<SceneRequest>,
) -> bool {
    let selected = shown.iter().find(|scene| state.selected.as_ref() == Some(&scene.id));
    let mut is_done = false;
    if let (true, Some(scene)) = (state.is_deleting, selected) {
        delete_question(ui, scene, state, requests);
    } else {
        is_done = buttons(ui, selected.copied(), around, state, requests);
    }
    if let Some(usage) = around.store.usage {
        ui.add_space(4.0);
        ui.label(RichText::new(words::usage_text(usage)).small().weak());
    }
    is_done
}

fn buttons(
    ui: &mut Ui,
    selected: Option<&SceneSummary>,
    around: &Surroundings<'_>,
    state: &mut State,
    requests: &mut Vec<SceneRequest>,
) -> bool {
    let mut is_done = false;
    ui.horizontal(|ui| {
        let size = Vec2::new(92.0, 28.0);
        let is_open = selected.is_some_and(|scene| around.store.open_scene == Some(&scene.id));
        let open =
            ui.add_enabled(selected.is_some() && !is_open, theme::primary_button("Open").min_size(size));
        let open = open.on_disabled_hover_text("This scene is open");
        let mut button = |text: &str, tooltip: &str| {
            let button = Button::new(text).min_size(size);
            ui.add_enabled(selected.is_some(), button).on_hover_text(tooltip).clicked()
        };
        let is_renamed = button("Rename", "Give it another name (F2)");
        let is_duplicated = button("Duplicate", "Keep a copy of it as it is now");
        let is_deleted = button("Delete", "Delete it from this browser (Del)");
        let Some(scene) = selected else { return };
        if open.clicked() {
            requests.push(SceneRequest::Open(scene.id.clone()));
            is_done = true;
        }
        if is_renamed {
            begin_renaming(state, scene);
        }
        if is_duplicated {
            requests.push(SceneRequest::Duplicate(scene.id.clone()));
        }
        state.is_deleting |= is_deleted;
    });
    is_done
}

fn delete_question(ui: &mut Ui, scene: &SceneSummary, state: &mut State, requests: &mut Vec<SceneRequest>) {
    ui.horizontal(|ui| {
        let size = Vec2::new(92.0, 28.0);
        let delete = Button::new(RichText::new("Delete it").color(theme::ERROR)).min_size(size);
        if ui.add(delete).clicked() {
            requests.push(SceneRequest::Delete(scene.id.clone()));
            state.is_deleting = false;
        }
        if ui.add(Button::new("Keep it").min_size(size)).clicked() {
            state.is_deleting = false;
        }
        let question = format!("\"{}\" and its poses will be gone for good.", scene.heading.title());
        ui.add(egui::Label::new(question).truncate());
    });
}

/// The keyboard goes to a field whose text is replaced by what is typed.
fn focus_all(ui: &Ui, field: &egui::Response, text: &str) {
    field.request_focus();
    let mut edit = egui::text_edit::TextEditState::load(ui.ctx(), field.id).unwrap_or_default();
    let all = egui::text::CCursorRange::two(
        egui::text::CCursor::new(0),
        egui::text::CCursor::new(text.chars().count()),
    );
    edit.cursor.set_char_range(Some(all));
    edit.store(ui.ctx(), field.id);
}

//! Which object in which photo is a sample, and where its true pose is.

use egui::Grid;
use egui::{ComboBox, RichText, TextEdit, Ui};

use crate::session::Session;
use crate::study::pack::{Chosen, Draft, Role, TruthFrom};
use crate::ui::theme;

const ROLES: [(Role, &str); 3] =
    [(Role::None, "Not in the study"), (Role::Sample, "Sample"), (Role::Practice, "Practice")];

pub fn draw(ui: &mut Ui, session: &Session, draft: &mut Draft) {
    ui.horizontal(|ui| {
        ui.label("Title");
        let title = TextEdit::singleline(&mut draft.study.title).desired_width(280.0);
        let title = ui.add(title.hint_text("What participants see"));
        title.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Study title"));
        ui.label("Id");
        let id = ui.add(TextEdit::singleline(&mut draft.study.id).desired_width(120.0));
        id.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Study id"));
        id.on_hover_text("A part of file names: letters, digits, - and _");
    });
    ui.horizontal(|ui| {
        ui.label("Contact");
        let contact = TextEdit::singleline(&mut draft.study.contact).desired_width(280.0);
        ui.add(contact.hint_text("Shown to participants who need help"));
    });
    truth(ui, session, draft);
    ui.horizontal(|ui| {
        ui.label("All:");
        for (role, title) in ROLES {
            if ui.small_button(title).clicked() {
                draft.chosen.iter_mut().for_each(|chosen| chosen.role = role);
            }
        }
    });
    let truths: Vec<bool> =
        draft.chosen.iter().map(|chosen| draft.truth_of(session.scene(), chosen).is_some()).collect();
    Grid::new("samples").num_columns(5).striped(true).spacing([16.0, 6.0]).show(ui, |ui| {
        for title in ["Photo", "Object", "Use as", "Sample set", "True pose"] {
            ui.label(RichText::new(title).small().strong());
        }
        ui.end_row();
        for (index, (chosen, has_truth)) in draft.chosen.iter_mut().zip(truths).enumerate() {
            row(ui, session, index, chosen, has_truth);
        }
    });
}

fn truth(ui: &mut Ui, session: &Session, draft: &mut Draft) {
    let references = &session.scene().references;
    ui.horizontal(|ui| {
        ui.label("True poses");
        let annotations = "What is posed or confirmed here";
        let shown = match &draft.truth_from {
            TruthFrom::Annotations => annotations,
            TruthFrom::Reference(name) => name.as_str(),
        };
        let combo = ComboBox::from_id_salt("truth from")
            .selected_text(shown.to_owned())
            .width(220.0)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut draft.truth_from, TruthFrom::Annotations, annotations);
                for reference in references {
                    let from = TruthFrom::Reference(reference.name.clone());
                    ui.selectable_value(&mut draft.truth_from, from, format!("Reference {}", reference.name));
                }
            });
        combo
            .response
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "True poses from"));
        ui.label(RichText::new("They go into a file of their own that no participant gets.").weak());
    });
}

fn row(ui: &mut Ui, session: &Session, index: usize, chosen: &mut Chosen, has_truth: bool) {
    let scene = session.scene();
    let photo = scene.photo(chosen.photo).map_or("", |photo| photo.name.as_str());
    let object = scene.object(chosen.object).map_or("", |object| object.name.as_str());
    ui.add_sized([170.0, 20.0], egui::Label::new(photo).truncate().halign(egui::Align::Min));
    ui.label(object);
    let shown = ROLES.iter().find(|(role, _)| *role == chosen.role).map_or("", |(_, title)| *title);
    let combo = ComboBox::from_id_salt(("role", index)).selected_text(shown).width(130.0).show_ui(ui, |ui| {
        for (role, title) in ROLES {
            ui.selectable_value(&mut chosen.role, role, title);
        }
    });
    let label = format!("Use {object} in {photo} as");
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
    let mut set = chosen.set.clone().unwrap_or_default();
    if ui.add(TextEdit::singleline(&mut set).desired_width(70.0).hint_text("none")).changed() {
        chosen.set = Some(set.trim().to_owned()).filter(|set| !set.is_empty());
    }
    match has_truth {
        true => ui.label(RichText::new("known").color(theme::good(ui.visuals()))),
        false => ui.label(RichText::new("not known").weak()),
    };
    ui.end_row();
}

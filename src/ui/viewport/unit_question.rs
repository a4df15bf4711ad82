//! A card that asks for the unit of a mesh whose file does not say it. It waits; nothing waits for it.

use egui::{Align2, Area, Id, Order, Rect, RichText, Ui, Vec2};

use crate::mesh::{MeshUnit, length_text};
use crate::scene::MeshFrame;
use crate::session::{Command, Session, UnitQuestion};
use crate::ui::theme;

const WIDTH: f32 = 330.0;
const BUTTON: Vec2 = Vec2::new(108.0, 26.0);
/// Above the line of numbers in the corner.
const OFFSET: Vec2 = Vec2::new(10.0, -44.0);

pub fn draw(ui: &Ui, whole: Rect, session: &Session, commands: &mut Vec<Command>) {
    let Some(question) = session.unit_question().filter(|_| session.question().is_none()) else { return };
    let Some((name, side)) = longest_side(session, &question) else { return };
    Area::new(Id::unique("unit question"))
        .order(Order::Middle)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(whole.left_bottom() + OFFSET)
        .show(ui.ctx(), |ui| {
            theme::overlay_frame().show(ui, |ui| {
                ui.set_width(WIDTH.min(whole.width() - 4.0 * OFFSET.x));
                ui.label(RichText::new(title(&name, question.objects.len())).strong());
                let taken = format!("Taken as {} for now; you can go on.", question.likely);
                ui.add(egui::Label::new(RichText::new(taken).weak()).wrap());
                ui.add_space(2.0);
                let others = MeshUnit::ALL.into_iter().filter(|unit| *unit != question.likely);
                for unit in std::iter::once(question.likely).chain(others) {
                    if answer(ui, unit, unit == question.likely, side) {
                        commands.push(Command::AnswerUnit(unit));
                    }
                }
            });
        });
}

/// The first mesh's name, and how long it is in its file's numbers.
fn longest_side(session: &Session, question: &UnitQuestion) -> Option<(String, f64)> {
    let object = session.scene().object(*question.objects.first()?)?;
    let spacing = MeshFrame(object.mesh_from_file).spacing().x;
    Some((object.name.clone(), object.mesh.mesh.bounds().size().max_element() / spacing))
}

fn title(name: &str, count: usize) -> String {
    match count {
        1 => format!("In which unit is {name}?"),
        _ => format!("In which unit are {name} and {} more?", count - 1),
    }
}

fn answer(ui: &mut Ui, unit: MeshUnit, is_likely: bool, side: f64) -> bool {
    let name = capitalized(&unit.to_string());
    ui.horizontal(|ui| {
        let button = if is_likely { theme::primary_button(&name) } else { egui::Button::new(&name) };
        let is_chosen = ui.add_sized(BUTTON, button).clicked();
        let meaning = format!("The longest side would be {}.", length_text(side * unit.in_mm()));
        ui.label(RichText::new(meaning).small().weak());
        is_chosen
    })
    .inner
}

pub fn capitalized(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

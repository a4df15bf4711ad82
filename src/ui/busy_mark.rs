//! The mark beside words about work that goes on.

use egui::{Response, Sense, Ui, Vec2};

const DOTS: u8 = 8;
/// A turn takes a second. It does not move in every frame: whatever goes on needs the processor more, and on a machine
/// whose GPU is in software every frame takes much of it.
const STEPS_A_SECOND: f64 = DOTS as f64;

/// A ring of dots, of which the brightest goes round.
pub fn busy_mark(ui: &mut Ui) -> Response {
    let size = ui.style().spacing.interact_size.y;
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(size), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::new(egui::Role::ProgressIndicator));
    let steps = ui.input(|input| input.time) * STEPS_A_SECOND;
    let brightest = steps.rem_euclid(f64::from(DOTS)) as u8;
    let color = ui.visuals().strong_text_color();
    for dot in 0..DOTS {
        let turn = std::f32::consts::TAU * f32::from(dot) / f32::from(DOTS);
        let behind = f32::from((brightest + DOTS - dot) % DOTS) / f32::from(DOTS);
        let place = rect.center() + 0.32 * size * Vec2::angled(turn);
        ui.painter().circle_filled(place, 0.075 * size, color.gamma_multiply(1.0 - 0.85 * behind));
    }
    let until_next = (1.0 - steps.fract()) / STEPS_A_SECOND;
    ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(until_next));
    response
}

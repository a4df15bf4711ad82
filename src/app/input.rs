//! The interface's events to keys, gestures and the view's place.

use egui::{Event, MouseWheelUnit, PointerButton};
use glam::DVec2;

use super::PinPose;
use crate::interact::{Button, Modifiers, Pane, PointerAction, PointerEvent};
use crate::scene::Look;
use crate::session::{Command, CommandId};
use crate::ui::{DragModifier, ModifierMap, Pressed, ViewportPlace, is_released, pressed_commands};

/// Points of scrolling that browsers report for one notch of a wheel.
const POINTS_PER_NOTCH: f32 = 100.0;

/// From this on a scroll is taken for a notch of a wheel, below for a touchpad's slide.
const LEAST_POINTS_OF_A_NOTCH: f32 = 40.0;

impl PinPose {
    /// Keys act while no text is being edited and nothing is open that has keys of its own.
    pub(super) fn take_keys(&mut self, ctx: &egui::Context) {
        self.show_overlay_after_hold(ctx);
        let state = &self.ui_state;
        let dialog_is_open =
            self.session.question().is_some() || state.open.is_some() || state.scenes_dialog.is_open();
        let dialog_is_open = dialog_is_open || state.study_builder.is_open() || state.report_dialog.is_open();
        let dialog_is_open = dialog_is_open || state.kept_dialog.is_open();
        let dialog_is_open = dialog_is_open || self.datasets.is_dialog_open();
        if dialog_is_open || ctx.text_edit_focused() || egui::Popup::is_any_open(ctx) {
            return;
        }
        let keymap = &self.ui_state.preferences.keymap;
        for Pressed { id, factor } in ctx.input_mut(|input| pressed_commands(input, keymap)) {
            match id.nudge() {
                Some(nudge) => self.apply(Command::Nudge(nudge, factor)),
                None if id == CommandId::ToggleOverlay => self.hide_overlay_by_hold(),
                None => self.apply(Command::Run(id)),
            }
        }
        for text in ctx.input_mut(pasted_texts) {
            self.apply(Command::SetPoseFromText(text));
        }
    }

    /// The overlay's key works as long as it is down; what is hidden already it shows.
    pub(super) fn hide_overlay_by_hold(&mut self) {
        if self.layers_before_hold.is_none() {
            self.layers_before_hold = Some(self.session.look().layers);
            self.apply(Command::Run(CommandId::ToggleOverlay));
        }
    }

    pub(super) fn show_overlay_after_hold(&mut self, ctx: &egui::Context) {
        let released = ctx
            .input(|input| is_released(input, CommandId::ToggleOverlay, &self.ui_state.preferences.keymap));
        if let Some(layers) = self.layers_before_hold.take_if(|_| released) {
            self.apply(Command::SetLook(Look { layers, ..self.session.look() }));
        }
    }

    /// Reads the pointer against the views' places in the last frame, so that the picture of this one is not late.
    pub(super) fn take_gestures(&mut self, ctx: &egui::Context) {
        self.hands.pointer = None;
        self.place_views();
        if self.hands.scene_view.advance(ctx.input(|input| input.time)) {
            ctx.request_repaint();
        }
        let places = self.places();
        let two_fingers = self.take_two_fingers(ctx, &places);
        let map = self.ui_state.preferences.modifiers;
        for event in pointer_events(ctx, &places) {
            if two_fingers && !matches!(event.action, PointerAction::Release(_)) {
                continue;
            }
            let pane = if event.is_new { event.over } else { self.hands.held_in().or(event.over) };
            let Some((pane, place)) = pane.and_then(|pane| Some((pane, place_of(&places, pane)?))) else {
                continue;
            };
            let commands = self.hands.handle(pane, &event.against(place, map), &self.session);
            commands.into_iter().for_each(|command| self.apply(command));
        }
        let position = ctx.input(|input| input.pointer.latest_pos());
        let over = position.and_then(|position| Some((pane_at(ctx, &places, position)?, position)));
        self.hands.pointer =
            over.and_then(|(pane, position)| Some((pane, to_viewport(place_of(&places, pane)?, position))));
    }

    /// Two fingers pan and zoom; the gesture that the first one began is put back.
    fn take_two_fingers(&mut self, ctx: &egui::Context, places: &Places) -> bool {
        let Some(touch) = ctx.multi_touch() else { return false };
        if self.hands.is_dragging_object() {
            self.apply(Command::CancelGesture);
        }
        self.hands.cancel();
        let Some(pane) = pane_at(ctx, places, touch.start_pos) else { return true };
        let Some(place) = place_of(places, pane) else { return true };
        let scale = f64::from(place.pixels_per_point);
        let way_px = DVec2::new(f64::from(touch.translation_delta.x), f64::from(touch.translation_delta.y));
        let middle = to_viewport(place, touch.center_pos);
        let factor = f64::from(touch.zoom_delta);
        self.hands.two_fingers(pane, middle, way_px * scale, factor, &self.session);
        true
    }

    /// Tells the views how large they are and what they show.
    pub(super) fn place_views(&mut self) {
        let size_of = |place: ViewportPlace| DVec2::from_array(place.size_px().map(f64::from));
        if let (Some(place), Some(photo)) = (self.ui_state.viewport, self.session.photo()) {
            let photo_size = DVec2::new(f64::from(photo.asset.width), f64::from(photo.asset.height));
            self.hands.photo_view.set_sizes(size_of(place), photo_size);
            self.hands.set_pixels_per_point(f64::from(place.pixels_per_point));
        }
        if let Some(place) = self.ui_state.scene_viewport {
            self.hands.scene_view.set_scene(size_of(place), &self.session);
            self.hands.set_pixels_per_point(f64::from(place.pixels_per_point));
        }
    }

    fn places(&self) -> Places {
        let photo = self.ui_state.viewport.map(|place| (Pane::Photo, place));
        let scene = self.ui_state.scene_viewport.map(|place| (Pane::Scene, place));
        photo.into_iter().chain(scene).collect()
    }
}

/// The views that are on screen.
type Places = Vec<(Pane, ViewportPlace)>;

fn place_of(places: &Places, pane: Pane) -> Option<&ViewportPlace> {
    places.iter().find(|(candidate, _)| *candidate == pane).map(|(_, place)| place)
}

fn pane_at(ctx: &egui::Context, places: &Places, position: egui::Pos2) -> Option<Pane> {
    places.iter().find(|(_, place)| is_over(ctx, place, position)).map(|(pane, _)| *pane)
}

/// What was pasted while no text field had the focus.
pub(super) fn pasted_texts(input: &mut egui::InputState) -> Vec<String> {
    let mut texts = Vec::new();
    input.events.retain(|event| match event {
        Event::Paste(text) => {
            texts.push(text.clone());
            false
        }
        _ => true,
    });
    texts
}

/// Something that the pointer did somewhere on the page.
struct PageEvent {
    position: egui::Pos2,
    action: PointerAction,
    modifiers: egui::Modifiers,
    /// The view that the pointer is over, with nothing before it.
    over: Option<Pane>,
    /// Belongs where the pointer is, not where a button was pressed.
    is_new: bool,
}

impl PageEvent {
    fn against(&self, place: &ViewportPlace, map: ModifierMap) -> PointerEvent {
        let modifiers = meant(self.modifiers, map);
        PointerEvent { position: to_viewport(place, self.position), action: self.action, modifiers }
    }
}

/// What the pointer did in this frame, in order.
fn pointer_events(ctx: &egui::Context, places: &Places) -> Vec<PageEvent> {
    let (events, latest, frame_modifiers, double_clicked) = ctx.input(|input| {
        let double_clicked = input.pointer.button_double_clicked(PointerButton::Primary);
        (input.events.clone(), input.pointer.latest_pos(), input.modifiers, double_clicked)
    });
    let mut pointer = latest;
    let mut read = Vec::new();
    let mut add = |position: Option<egui::Pos2>, action: Option<PointerAction>, modifiers| {
        let (Some(position), Some(action)) = (position, action) else { return };
        let over = pane_at(ctx, places, position);
        let is_new = matches!(action, PointerAction::Press(_) | PointerAction::DoubleClick);
        read.push(PageEvent { position, action, modifiers, over, is_new });
    };
    for event in events {
        match event {
            Event::PointerMoved(position) => {
                pointer = Some(position);
                add(pointer, Some(PointerAction::Move), frame_modifiers);
            }
            Event::PointerButton { pos, button, pressed, modifiers } => {
                pointer = Some(pos);
                let action = pointer_button(button).map(|button| match pressed {
                    true => PointerAction::Press(button),
                    false => PointerAction::Release(button),
                });
                add(pointer, action, modifiers);
            }
            Event::MouseWheel { unit, delta, modifiers, .. } => {
                // Over a panel the wheel is the panel's, also while something is held.
                let over = pointer.filter(|position| pane_at(ctx, places, *position).is_some());
                add(over, Some(PointerAction::Wheel(notches(unit, delta))), modifiers);
            }
            Event::Zoom(factor) => {
                let over = pointer.filter(|position| pane_at(ctx, places, *position).is_some());
                add(over, Some(PointerAction::Pinch(f64::from(factor))), frame_modifiers);
            }
            _ => {}
        }
    }
    if double_clicked {
        add(pointer, Some(PointerAction::DoubleClick), frame_modifiers);
    }
    read
}

/// Gestures know Shift as depth, Ctrl as roll and Alt as fine; the user may hold other keys for these.
fn meant(held: egui::Modifiers, map: ModifierMap) -> Modifiers {
    let is_held = |what| map.get(what).is_held(held);
    Modifiers {
        shift: is_held(DragModifier::Depth),
        ctrl: is_held(DragModifier::Roll),
        alt: is_held(DragModifier::Fine),
    }
}

fn to_viewport(place: &ViewportPlace, position: egui::Pos2) -> DVec2 {
    let offset = (position - place.rect.min) * place.pixels_per_point;
    DVec2::new(f64::from(offset.x), f64::from(offset.y))
}

/// Is the viewport what the pointer is over, with no window, menu or panel before it?
fn is_over(ctx: &egui::Context, place: &ViewportPlace, position: egui::Pos2) -> bool {
    place.rect.contains(position)
        && ctx.layer_id_at(position).is_none_or(|layer| layer == place.layer)
        && !egui::Popup::is_any_open(ctx)
}

fn pointer_button(button: PointerButton) -> Option<Button> {
    match button {
        PointerButton::Primary => Some(Button::Left),
        PointerButton::Middle => Some(Button::Middle),
        PointerButton::Secondary => Some(Button::Right),
        PointerButton::Extra1 | PointerButton::Extra2 => None,
    }
}

/// Up is positive. Shift makes some browsers report the other axis; the two never come together from a wheel.
fn notches(unit: MouseWheelUnit, delta: egui::Vec2) -> f64 {
    let scroll = delta.x + delta.y;
    let notches = match unit {
        MouseWheelUnit::Line => scroll.signum() * (scroll.abs() / 3.0).max(1.0).round(),
        MouseWheelUnit::Page => scroll.signum(),
        MouseWheelUnit::Point if scroll.abs() >= LEAST_POINTS_OF_A_NOTCH => {
            scroll.signum() * (scroll.abs() / POINTS_PER_NOTCH).round().max(1.0)
        }
        MouseWheelUnit::Point => scroll / POINTS_PER_NOTCH,
    };
    if scroll == 0.0 { 0.0 } else { f64::from(notches) }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn a_notch_is_one_whatever_the_browser_calls_it() {
        assert_eq!(notches(MouseWheelUnit::Point, vec2(0.0, 100.0)), 1.0);
        assert_eq!(notches(MouseWheelUnit::Point, vec2(0.0, -120.0)), -1.0);
        assert_eq!(notches(MouseWheelUnit::Point, vec2(-53.0, 0.0)), -1.0);
        assert_eq!(notches(MouseWheelUnit::Line, vec2(0.0, 3.0)), 1.0);
        assert_eq!(notches(MouseWheelUnit::Line, vec2(0.0, -1.0)), -1.0);
        assert_eq!(notches(MouseWheelUnit::Point, vec2(0.0, 10.0)), f64::from(0.1_f32));
        assert_eq!(notches(MouseWheelUnit::Point, vec2(0.0, 0.0)), 0.0);
    }
}

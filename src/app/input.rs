//! The interface's events to keys, gestures and the view's place.

use egui::{Event, MouseWheelUnit, PointerButton};
use glam::DVec2;

use super::PinPose;
use crate::interact::{Button, Hit, Modifiers, PointerAction, PointerEvent, pick_all};
use crate::scene::Look;
use crate::session::{Command, CommandId};
use crate::ui::{Pressed, ViewportPlace, is_released, pressed_commands};

/// Points of scrolling that browsers report for one notch of a wheel.
const POINTS_PER_NOTCH: f32 = 100.0;

/// From this on a scroll is taken for a notch of a wheel, below for a touchpad's slide.
const LEAST_POINTS_OF_A_NOTCH: f32 = 40.0;

impl PinPose {
    /// Keys act while no text is being edited and nothing is open that has keys of its own.
    pub(super) fn take_keys(&mut self, ctx: &egui::Context) {
        self.show_overlay_after_hold(ctx);
        let dialog_is_open = self.session.question().is_some() || self.ui_state.open.is_some();
        if dialog_is_open || ctx.text_edit_focused() || egui::Popup::is_any_open(ctx) {
            return;
        }
        for Pressed { id, factor } in ctx.input_mut(pressed_commands) {
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
    fn hide_overlay_by_hold(&mut self) {
        if self.layers_before_hold.is_none() {
            self.layers_before_hold = Some(self.session.look().layers);
            self.apply(Command::Run(CommandId::ToggleOverlay));
        }
    }

    fn show_overlay_after_hold(&mut self, ctx: &egui::Context) {
        let released = ctx.input(|input| is_released(input, CommandId::ToggleOverlay));
        if let Some(layers) = self.layers_before_hold.take_if(|_| released) {
            self.apply(Command::SetLook(Look { layers, ..self.session.look() }));
        }
    }

    /// Reads the pointer against the viewport's place in the last frame, so that the picture of this one is not late.
    pub(super) fn take_gestures(&mut self, ctx: &egui::Context) {
        self.pointer = None;
        let Some(place) = self.ui_state.viewport else { return };
        self.place_view();
        for event in pointer_events(ctx, &place) {
            let commands = self.gestures.handle(&event, &self.session, &mut self.view);
            commands.into_iter().for_each(|command| self.apply(command));
        }
        let position = ctx.input(|input| input.pointer.latest_pos());
        self.pointer = position
            .filter(|position| is_over(ctx, &place, *position))
            .map(|position| to_viewport(&place, position));
    }

    /// Tells the view how large viewport and photo are.
    pub(super) fn place_view(&mut self) {
        if let (Some(place), Some(photo)) = (self.ui_state.viewport, self.session.photo()) {
            let size = place.size_px().map(f64::from);
            let photo_size = DVec2::new(f64::from(photo.asset.width), f64::from(photo.asset.height));
            self.view.set_sizes(DVec2::from_array(size), photo_size);
        }
    }

    pub(super) fn hit_under_cursor(&self, pixel: Option<DVec2>) -> Option<Hit> {
        pick_all(self.session.scene(), self.session.photo()?.id, pixel?).first().copied()
    }
}

/// What was pasted while no text field had the focus.
fn pasted_texts(input: &mut egui::InputState) -> Vec<String> {
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

/// What the pointer did in this frame, in order.
fn pointer_events(ctx: &egui::Context, place: &ViewportPlace) -> Vec<PointerEvent> {
    let (events, latest, frame_modifiers, double_clicked) = ctx.input(|input| {
        let double_clicked = input.pointer.button_double_clicked(PointerButton::Primary);
        (input.events.clone(), input.pointer.latest_pos(), input.modifiers, double_clicked)
    });
    let mut pointer = latest;
    let mut read = Vec::new();
    for event in events {
        let (position, action, modifiers) = match event {
            Event::PointerMoved(position) => (Some(position), Some(PointerAction::Move), frame_modifiers),
            Event::PointerButton { pos, button, pressed, modifiers } => {
                let free = !pressed || is_over(ctx, place, pos);
                let action = pointer_button(button).filter(|_| free).map(|button| match pressed {
                    true => PointerAction::Press(button),
                    false => PointerAction::Release(button),
                });
                (Some(pos), action, modifiers)
            }
            Event::MouseWheel { unit, delta, modifiers, .. } => {
                (pointer, Some(PointerAction::Wheel(notches(unit, delta))), modifiers)
            }
            Event::Zoom(factor) => (pointer, Some(PointerAction::Pinch(f64::from(factor))), frame_modifiers),
            _ => continue,
        };
        pointer = position.or(pointer);
        let (Some(position), Some(action)) = (position, action) else { continue };
        let needs_hover = matches!(action, PointerAction::Wheel(_) | PointerAction::Pinch(_));
        if !needs_hover || is_over(ctx, place, position) {
            read.push(pointer_event(place, position, action, modifiers));
        }
    }
    if let Some(position) = pointer.filter(|position| double_clicked && is_over(ctx, place, *position)) {
        read.push(pointer_event(place, position, PointerAction::DoubleClick, frame_modifiers));
    }
    read
}

fn pointer_event(
    place: &ViewportPlace,
    position: egui::Pos2,
    action: PointerAction,
    modifiers: egui::Modifiers,
) -> PointerEvent {
    let modifiers = Modifiers { shift: modifiers.shift, ctrl: modifiers.command, alt: modifiers.alt };
    PointerEvent { position: to_viewport(place, position), action, modifiers }
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

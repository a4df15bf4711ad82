//! egui's larger containers, compiled once for all that is shown in them: each would be 20 kB of the page for every content.

use egui::{Context, Frame, Id, Modal, Ui};

/// What was shown in a dialog, and whether the user wants it to go.
pub struct Shown<R> {
    pub inner: R,
    should_close: bool,
}

impl<R> Shown<R> {
    pub fn should_close(&self) -> bool {
        self.should_close
    }
}

/// A dialog before everything else.
pub fn modal<R: Default>(
    ctx: &Context,
    name: &str,
    frame: Frame,
    content: impl FnOnce(&mut Ui) -> R,
) -> Shown<R> {
    let (mut inner, mut content) = (R::default(), Some(content));
    let should_close = modal_of_any(ctx, name, frame, &mut |ui| {
        if let Some(content) = content.take() {
            inner = content(ui);
        }
    });
    Shown { inner, should_close }
}

fn modal_of_any(ctx: &Context, name: &str, frame: Frame, content: &mut dyn FnMut(&mut Ui)) -> bool {
    Modal::new(Id::unique(name)).frame(frame).show(ctx, content).should_close()
}

/// A menu within a menu or a bar.
pub fn menu(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    let mut content = Some(content);
    menu_of_any(ui, title, &mut |ui| {
        if let Some(content) = content.take() {
            content(ui);
        }
    });
}

fn menu_of_any(ui: &mut Ui, title: &str, content: &mut dyn FnMut(&mut Ui)) {
    ui.menu_button(title, content);
}

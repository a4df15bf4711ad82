//! A frame of a study: what is left of the program's own.

use super::State;
use crate::app::PinPose;
use crate::platform;
use crate::session::Command;
use crate::ui;

impl PinPose {
    /// As `logic()`, with nothing that brings files in or scenes up.
    pub(in crate::app) fn study_logic(&mut self, ctx: &egui::Context) {
        let now_ms = platform::now_ms();
        // What is dropped is nobody's, and what the page asks for has to be answered.
        self.take_decoded();
        self.tick_scenes();
        self.note_input(ctx, now_ms);
        self.tick_study();
        self.answer_calls(ctx);
        if self.is_trial_on_screen() {
            self.take_study_keys(ctx);
            self.take_gestures(ctx);
        }
        self.want_pixels();
        self.make_pictures(ctx);
        self.tick_snap();
    }

    pub(in crate::app) fn study_ui(&mut self, ui: &mut egui::Ui) {
        let pixels = self.session.photo().and_then(|photo| self.photos.get(photo.asset.sha256));
        let busy = self.snapping.busy();
        let around = ui::Surroundings {
            hands: &self.hands,
            renderer: self.renderer.as_ref(),
            pixels,
            masks: None,
            depth: None,
            symmetries: ui::SymmetryView::default(),
            drawn_pose: self.drawn_pose(ui.ctx().input(|input| input.time)),
            saving: ui::Saving::Saved,
            busy: None,
            scenes: &[],
            store: ui::StoreView::default(),
            builder: None,
            report: None,
            kept: None,
            update_ready: false,
            dataset: None,
            files_hover: false,
        };
        if self.performance.start_ms == 0.0 {
            self.performance.start_ms = platform::navigation_ms();
        }
        let Some(study) = self.study.take() else { return };
        let mut requests = Vec::new();
        let view = study.view(busy.as_ref().map(|busy| busy.text.as_str()));
        let asked = ui::study::draw(ui, &self.session, &view, &around, &mut self.ui_state, &mut requests);
        self.study = Some(study);
        self.note_drawn();
        self.place_views();
        if let Some(moved) = asked.scene_move {
            self.hands.move_scene(moved, &self.session);
        }
        let is_something = !requests.is_empty() || !asked.commands.is_empty() || asked.scene_move.is_some();
        asked.commands.into_iter().for_each(|command| self.apply(command));
        requests.into_iter().for_each(|request| self.take_study_request(request));
        if is_something {
            ui.ctx().request_repaint();
        }
    }

    fn is_trial_on_screen(&self) -> bool {
        let Some(study) = &self.study else { return false };
        let State::Running(running) = &study.state else { return false };
        let is_paused = running.participation.trial().is_some_and(crate::study::RunningTrial::is_paused);
        running.is_in_trial() && !is_paused
    }

    /// Keys that are not part of the study do nothing, and nothing is said: a hand slips.
    fn take_study_keys(&mut self, ctx: &egui::Context) {
        self.show_overlay_after_hold(ctx);
        if self.ui_state.study.help_is_open() || ctx.text_edit_focused() || egui::Popup::is_any_open(ctx) {
            return;
        }
        let tools = self.study_tools();
        let keymap = &self.ui_state.preferences.keymap;
        let pressed = ctx.input_mut(|input| ui::pressed_commands(input, keymap));
        for ui::Pressed { id, factor } in pressed {
            let command = id.nudge().map_or(Command::Run(id), |nudge| Command::Nudge(nudge, factor));
            let verdict = super::allowed::verdict(&command, &tools, &self.session, false);
            let is_confirm = id == crate::session::CommandId::ConfirmAndNext;
            if verdict != super::allowed::Verdict::Allowed && !is_confirm {
                continue;
            }
            match id {
                crate::session::CommandId::ToggleOverlay => self.hide_overlay_by_hold(),
                _ => self.apply(command),
            }
        }
        for text in ctx.input_mut(crate::app::input::pasted_texts) {
            if tools.contains(&crate::study::Tool::Numbers) {
                self.apply(Command::SetPoseFromText(text));
            }
        }
    }
}

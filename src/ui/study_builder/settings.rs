//! Texts, tools, protocol, saving.

use egui::{DragValue, RichText, TextEdit, Ui};

use crate::study::{
    Assignment, Condition, Limits, ResumePolicy, SampleSets, Saving, StartPose, Study, Tool, TrialOrder,
};

/// What a tool is called, and what it lets people do.
const TOOLS: [(Tool, &str, &str); 10] = [
    (Tool::Move, "Move", "Drag the object; Shift and wheel for depth"),
    (Tool::Rotate, "Rotate", "Turn it with the right button"),
    (Tool::Handles, "Handles", "Coloured handles on the object"),
    (Tool::Nudge, "Nudge", "Small steps by keys"),
    (Tool::Pins, "Pins", "Points of the object that are dragged to their pixels"),
    (Tool::Snap, "Snap", "Refining the pose to the photo"),
    (Tool::Numbers, "Numbers", "Pasting a pose"),
    (Tool::SceneView, "Scene view", "Looking from anywhere"),
    (Tool::Looks, "Looks", "Hiding the object, outline, wipe and other ways to draw it"),
    (Tool::Undo, "Undo", "Undo, redo and starting over"),
];

pub fn tools(ui: &mut Ui, study: &mut Study) {
    let mut removed = None;
    let is_only = study.conditions.len() == 1;
    for (index, condition) in study.conditions.iter_mut().enumerate() {
        ui.push_id(index, |ui| {
            ui.horizontal(|ui| {
                ui.label(RichText::new(format!("Condition {}", index + 1)).strong());
                ui.add(TextEdit::singleline(&mut condition.title).desired_width(200.0));
                ui.label("Id");
                ui.add(TextEdit::singleline(&mut condition.id).desired_width(90.0));
                if !is_only && ui.button("Remove").clicked() {
                    removed = Some(index);
                }
            });
            ui.horizontal_wrapped(|ui| tool_boxes(ui, condition));
            if !is_only {
                let words = TextEdit::multiline(&mut condition.instructions).desired_rows(2);
                ui.add(words.desired_width(f32::INFINITY).hint_text("Shown before this condition"));
            }
        });
        ui.separator();
    }
    if let Some(index) = removed {
        study.conditions.remove(index);
    }
    if ui.button("Add a condition").clicked() {
        let id = format!("c{}", study.conditions.len() + 1);
        let title = format!("Condition {}", study.conditions.len() + 1);
        study.conditions.push(Condition { id, title, ..Condition::with_every_tool() });
    }
    if !is_only {
        ui.label(RichText::new("Participants").strong());
        ui.radio_value(&mut study.assignment, Assignment::Between, "work under one condition each");
        let within = "work under all conditions, in a balanced order";
        ui.radio_value(&mut study.assignment, Assignment::Within, within);
    }
}

fn tool_boxes(ui: &mut Ui, condition: &mut Condition) {
    for (tool, title, meaning) in TOOLS {
        let mut is_allowed = condition.tools.contains(&tool);
        if ui.checkbox(&mut is_allowed, title).on_hover_text(meaning).changed() {
            condition.tools.retain(|other| *other != tool);
            if is_allowed {
                condition.tools.push(tool);
            }
            condition.tools.sort_unstable();
        }
    }
}

pub fn protocol(ui: &mut Ui, study: &mut Study) {
    ui.horizontal(|ui| {
        ui.label("Every sample comes");
        ui.add(DragValue::new(&mut study.schedule.repeats).range(1..=20).suffix(" times"));
    });
    ui.label(RichText::new("Order").strong());
    for (order, title) in [
        (TrialOrder::ShuffledEachRepeat, "Shuffled anew for each repeat, no sample twice in a row"),
        (TrialOrder::ShuffledOnce, "Shuffled once"),
        (TrialOrder::AsListed, "As listed"),
    ] {
        ui.radio_value(&mut study.schedule.order, order, title);
    }
    optional(ui, "The same order for everybody, from the seed", &mut study.schedule.seed, 1, |ui, seed| {
        ui.add(DragValue::new(seed).range(0..=999_999_999));
    });
    start_pose(ui, study);
    ui.label(RichText::new("Sample sets").strong());
    for (sets, title) in [
        (SampleSets::All, "Everybody works on all samples"),
        (SampleSets::Between, "One set for each participant"),
        (SampleSets::PerCondition, "Another set under each condition"),
    ] {
        ui.radio_value(&mut study.sample_sets, sets, title);
    }
    limits(ui, &mut study.limits);
    ui.label(RichText::new("After a reload or a crash").strong());
    for (policy, title) in [
        (ResumePolicy::Resume, "Go on in the same trial"),
        (ResumePolicy::Restart, "Begin anew"),
        (ResumePolicy::Block, "End the participation"),
    ] {
        ui.radio_value(&mut study.resume, policy, title);
    }
}

fn start_pose(ui: &mut Ui, study: &mut Study) {
    ui.label(RichText::new("Start pose").strong());
    let random = StartPose::Random { least_depth_mm: 500.0, most_depth_mm: 1500.0 };
    for (pose, title) in [
        (StartPose::default(), "R = I, t = (0, 0, 1000) mm, as in the paper"),
        (StartPose::Centered, "In the middle, a third of the photo's height"),
        (random, "Random, another one in each trial"),
        (StartPose::Given, "As posed in the scene, with the truth from a reference"),
    ] {
        let is_same = std::mem::discriminant(&study.start_pose) == std::mem::discriminant(&pose);
        if ui.radio(is_same, title).clicked() && !is_same {
            study.start_pose = pose;
        }
    }
    if let StartPose::Random { least_depth_mm, most_depth_mm } = &mut study.start_pose {
        ui.horizontal(|ui| {
            ui.add_space(24.0);
            ui.label("Depth from");
            ui.add(DragValue::new(least_depth_mm).range(1.0..=1e6).suffix(" mm"));
            ui.label("to");
            ui.add(DragValue::new(most_depth_mm).range(1.0..=1e6).suffix(" mm"));
        });
    }
}

fn limits(ui: &mut Ui, limits: &mut Limits) {
    ui.label(RichText::new("Time").strong());
    ui.checkbox(&mut limits.may_pause, "Participants may pause");
    optional(ui, "A trial ends by itself after", &mut limits.trial_seconds, 300.0, |ui, seconds| {
        ui.add(DragValue::new(seconds).range(5.0..=3600.0).suffix(" s"));
    });
    optional(ui, "A break is offered after", &mut limits.break_after_trials, 10, |ui, trials| {
        ui.add(DragValue::new(trials).range(1..=1000).suffix(" trials"));
    });
    optional(ui, "A pause is suggested after", &mut limits.remind_after_minutes, 20.0, |ui, minutes| {
        ui.add(DragValue::new(minutes).range(1.0..=240.0).suffix(" min"));
    });
}

/// A setting that may be off.
fn optional<T: Copy>(
    ui: &mut Ui,
    title: &str,
    value: &mut Option<T>,
    first: T,
    field: impl FnOnce(&mut Ui, &mut T),
) {
    ui.horizontal(|ui| {
        let mut is_on = value.is_some();
        if ui.checkbox(&mut is_on, title).changed() {
            *value = is_on.then_some(first);
        }
        if let Some(value) = value {
            field(ui, value);
        }
    });
}

pub fn finish(ui: &mut Ui, study: &mut Study) {
    ui.label(RichText::new("Where results go").strong());
    ui.label(RichText::new("Whatever is chosen, participants can also download their file.").weak());
    let empty = String::new;
    for (saving, title) in [
        (Saving::Download, "Participants send the file that they download"),
        (Saving::DataPipe { experiment_id: empty(), url: None }, "To OSF by DataPipe"),
        (Saving::Put { url: empty() }, "To a server, by PUT"),
        (Saving::Post { url: empty() }, "To a server, by POST"),
    ] {
        let is_same = std::mem::discriminant(&study.saving) == std::mem::discriminant(&saving);
        if ui.radio(is_same, title).clicked() && !is_same {
            study.saving = saving;
        }
    }
    match &mut study.saving {
        Saving::Download => {}
        Saving::DataPipe { experiment_id, .. } => {
            line(ui, "Experiment id", experiment_id, "from pipe.jspsych.org");
        }
        Saving::Put { url } | Saving::Post { url } => {
            line(ui, "Address", url, "https://…/{file}");
        }
    }
    ui.add_space(8.0);
    ui.label(RichText::new("At the end").strong());
    let completion = &mut study.completion;
    let mut code = completion.code.clone().unwrap_or_default();
    line(ui, "Completion code", &mut code, "none");
    completion.code = Some(code).filter(|code| !code.is_empty());
    let mut redirect = completion.redirect.clone().unwrap_or_default();
    line(ui, "Go on to", &mut redirect, "https://…?id={participant}");
    completion.redirect = Some(redirect).filter(|redirect| !redirect.is_empty());
    if completion.redirect.is_some() {
        ui.horizontal(|ui| {
            ui.label("after");
            ui.add(DragValue::new(&mut completion.redirect_after_seconds).range(0.0..=600.0).suffix(" s"));
        });
    }
}

fn line(ui: &mut Ui, title: &str, text: &mut String, hint: &str) {
    ui.horizontal(|ui| {
        ui.add_sized([130.0, 20.0], egui::Label::new(title).halign(egui::Align::Min));
        let field = ui.add(TextEdit::singleline(text).desired_width(380.0).hint_text(hint));
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, title));
    });
}

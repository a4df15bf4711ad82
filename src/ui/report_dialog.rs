//! A study's results on their way to a report: what was read, what is missing, and then the report itself.

mod tables;

use egui::{Align, Button, Context, DragValue, Grid, Layout, ProgressBar, RichText, ScrollArea, Ui, Vec2};

use super::busy_mark::busy_mark;
use super::icons::{Icon, draw as draw_icon};
use super::{once, theme};
use crate::study::report::{Overview, Part, Report, ReportOptions};

const SIZE: Vec2 = Vec2::new(760.0, 560.0);
const BUTTON: Vec2 = Vec2::new(150.0, 32.0);

/// What the researcher wants to be done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReportRequest {
    AddFiles,
    /// Without the files that were given.
    StartOver,
    Make(ReportOptions),
    Cancel,
    /// In a tab of its own.
    Open,
    DownloadPage,
    /// The page, every table and every figure.
    DownloadAll,
    /// To the files, with more to come.
    Back,
}

/// What is known of the report.
#[derive(Debug, Clone, Copy)]
pub struct ReportView<'a> {
    pub overview: &'a Overview,
    pub stage: ReportStage<'a>,
}

#[derive(Debug, Clone, Copy)]
pub enum ReportStage<'a> {
    /// Files are being looked at.
    Reading,
    Collecting {
        problem: Option<&'a str>,
    },
    /// So much is done, 0 to 1.
    Making(f64),
    Done(&'a Report),
    /// So many files of the download are made, of so many.
    Packing(usize, usize),
}

#[derive(Debug, Default)]
pub struct State {
    is_open: bool,
    options: ReportOptions,
}

impl State {
    pub fn show(&mut self) {
        self.is_open = true;
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }
}

pub fn draw(
    ctx: &Context,
    view: Option<&ReportView<'_>>,
    state: &mut State,
    asked: &mut Option<ReportRequest>,
) {
    let (true, Some(view)) = (state.is_open, view) else { return };
    let modal = once::modal(ctx, "study report", theme::dialog_frame(ctx), |ui| {
        let size = SIZE.min(ui.ctx().content_rect().size() - Vec2::splat(64.0));
        ui.set_min_size(size);
        ui.set_max_size(size);
        let title = match &view.stage {
            ReportStage::Done(report) => report.analysis.title.clone(),
            _ => "Report of a study".to_owned(),
        };
        ui.heading(title);
        ui.add_space(4.0);
        let room = ui.available_height() - 52.0;
        ui.allocate_ui(Vec2::new(ui.available_width(), room), |ui| {
            ui.set_min_height(room);
            ui.spacing_mut().item_spacing.y = 7.0;
            body(ui, view, &mut state.options);
        });
        ui.separator();
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| buttons(ui, view, &state.options, asked))
            .inner
    });
    if modal.inner || modal.should_close() {
        state.is_open = false;
    }
}

fn body(ui: &mut Ui, view: &ReportView<'_>, options: &mut ReportOptions) {
    match view.stage {
        ReportStage::Reading => working(ui, "Reading the files…", None),
        ReportStage::Collecting { problem } => collecting(ui, view.overview, problem, options),
        ReportStage::Making(part) => working(ui, "Comparing every trial with the truth…", Some(part)),
        ReportStage::Done(report) => tables::draw(ui, report),
        ReportStage::Packing(done, all) => {
            working(ui, "Writing tables and figures…", Some(done as f64 / all.max(1) as f64));
        }
    }
}

fn working(ui: &mut Ui, text: &str, part: Option<f64>) {
    ui.add_space(ui.available_height() * 0.4);
    ui.vertical_centered(|ui| {
        ui.set_max_width(360.0);
        ui.label(text);
        match part {
            Some(part) => ui.add(ProgressBar::new(part as f32).desired_height(8.0)),
            None => busy_mark(ui),
        };
    });
}

fn collecting(ui: &mut Ui, overview: &Overview, problem: Option<&str>, options: &mut ReportOptions) {
    let hint = "Drop the files here, all at once or one after the other. They stay on this computer.";
    ui.label(RichText::new(hint).weak());
    ui.add_space(4.0);
    Grid::new("report parts").num_columns(3).min_col_width(16.0).spacing([12.0, 8.0]).show(ui, |ui| {
        part(ui, "Results", &overview.results);
        part(ui, "True poses", &overview.truth);
        part(ui, "Study", &overview.study);
    });
    if let Some(problem) = problem {
        let text = format!("There can be no report yet: {problem}.");
        ui.label(RichText::new(text).color(theme::error(ui.visuals())));
    }
    ui.add_space(2.0);
    ScrollArea::vertical().auto_shrink([false, true]).max_height(ui.available_height() - 40.0).show(
        ui,
        |ui| {
            for remark in &overview.remarks {
                ui.horizontal_wrapped(|ui| {
                    ui.label(RichText::new("Note:").strong().color(theme::warning(ui.visuals())));
                    ui.label(remark);
                });
            }
            people(ui, overview);
        },
    );
    ui.with_layout(Layout::bottom_up(Align::Min), |ui| margins(ui, options));
}

/// A sign that says whether it is there, what it is, and how much of it.
fn part(ui: &mut Ui, title: &str, part: &Part) {
    let (place, _) = ui.allocate_exact_size(Vec2::splat(16.0), egui::Sense::hover());
    let (icon, color) = match part.is_there {
        true => (Icon::Check, theme::good(ui.visuals())),
        false => (Icon::Plus, ui.visuals().weak_text_color()),
    };
    draw_icon(ui.painter(), icon, place, egui::Stroke::new(1.6, color));
    ui.label(RichText::new(title).strong());
    let text = RichText::new(&part.text);
    ui.label(if part.is_there { text } else { text.weak() });
    ui.end_row();
}

fn people(ui: &mut Ui, overview: &Overview) {
    if overview.people.is_empty() {
        return;
    }
    ui.add_space(4.0);
    Grid::new("report people").num_columns(4).striped(true).spacing([20.0, 5.0]).show(ui, |ui| {
        for title in ["Participant", "Trials", "", "File"] {
            ui.label(RichText::new(title).small().strong());
        }
        ui.end_row();
        for person in &overview.people {
            ui.label(&person.id);
            ui.label(person.trials.to_string());
            let state = match (person.is_simulated, person.is_finished) {
                (true, _) => "simulated",
                (false, true) => "finished",
                (false, false) => "not finished",
            };
            ui.label(RichText::new(state).weak());
            ui.add(egui::Label::new(RichText::new(&person.file).weak()).truncate());
            ui.end_row();
        }
    });
}

/// What the equivalence tests take for no difference.
fn margins(ui: &mut Ui, options: &mut ReportOptions) {
    ui.horizontal(|ui| {
        let tooltip =
            "For the tests whether poses are as good as the truth: a mean error within this counts as none";
        ui.label(RichText::new("No difference is within").weak()).on_hover_text(tooltip);
        let percent = DragValue::new(&mut options.margin_percent).range(0.1..=100.0).speed(0.1).suffix(" %");
        ui.add(percent).on_hover_text("Of the object's diameter");
        ui.label(RichText::new("and").weak());
        ui.add(DragValue::new(&mut options.margin_deg).range(0.1..=180.0).speed(0.1).suffix("°"));
    });
}

/// True if the dialog is to be closed.
fn buttons(
    ui: &mut Ui,
    view: &ReportView<'_>,
    options: &ReportOptions,
    asked: &mut Option<ReportRequest>,
) -> bool {
    let mut ask = |ui: &mut Ui, button: Button<'_>, is_enabled: bool, request: ReportRequest| {
        if ui.add_enabled(is_enabled, button.min_size(BUTTON)).clicked() {
            *asked = Some(request);
        }
    };
    match &view.stage {
        ReportStage::Reading | ReportStage::Making(_) | ReportStage::Packing(..) => {
            ask(ui, Button::new("Cancel"), true, ReportRequest::Cancel);
            false
        }
        ReportStage::Collecting { .. } => {
            let is_enough = view.overview.is_enough();
            ask(ui, theme::primary_button("Make the report"), is_enough, ReportRequest::Make(*options));
            ask(ui, Button::new("Add files…"), true, ReportRequest::AddFiles);
            let has_files = view.overview.results.is_there || view.overview.truth.is_there;
            let has_files = has_files || view.overview.study.is_there || !view.overview.remarks.is_empty();
            if has_files {
                ask(ui, Button::new("Start over"), true, ReportRequest::StartOver);
            }
            ui.add(Button::new("Close").min_size(Vec2::new(84.0, 32.0))).clicked()
        }
        ReportStage::Done(_) => {
            ask(ui, theme::primary_button("Open the report"), true, ReportRequest::Open);
            let all = "One zip: the page, every table as CSV and LaTeX, every figure as SVG and PNG";
            let button = Button::new("Download all").min_size(BUTTON);
            if ui.add(button).on_hover_text(all).clicked() {
                *asked = Some(ReportRequest::DownloadAll);
            }
            let button = Button::new("Page only").min_size(Vec2::new(96.0, 32.0));
            if ui.add(button).on_hover_text("One HTML file that needs nothing else").clicked() {
                *asked = Some(ReportRequest::DownloadPage);
            }
            if ui.add(Button::new("Back to the files").min_size(Vec2::new(120.0, 32.0))).clicked() {
                *asked = Some(ReportRequest::Back);
            }
            ui.add(Button::new("Close").min_size(Vec2::new(84.0, 32.0))).clicked()
        }
    }
}

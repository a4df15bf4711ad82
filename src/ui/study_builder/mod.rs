//! Building a study from the open scene: samples, texts, tools, questions, saving, and a check before it is handed out.

mod questions;
mod samples;
mod settings;
mod texts;

use std::sync::Arc;

use egui::{Button, Context, RichText, ScrollArea, Ui, Vec2};

use super::{Asked, once, theme};
use crate::platform::{self, ExportFolder};
use crate::session::Session;
use crate::study::check::Finding;
use crate::study::pack::Draft;
use crate::study::{Item, ItemKind, Study};

/// The settings of the last draft are kept under this name; samples belong to a scene and are not.
const DRAFT_KEY: &str = "study-draft";

const SIZE: Vec2 = Vec2::new(760.0, 560.0);

/// What the researcher wants of a draft.
#[derive(Debug, Clone, PartialEq)]
pub enum StudyBuild {
    Check(Box<Draft>),
    Preview(Box<Draft>),
    Export(Box<Draft>),
    /// Into a folder that the researcher picks.
    IntoFolder(Box<Draft>),
}

impl StudyBuild {
    pub fn draft(&self) -> &Draft {
        match self {
            Self::Check(draft) | Self::Preview(draft) | Self::Export(draft) | Self::IntoFolder(draft) => {
                draft
            }
        }
    }
}

/// What is known of the draft from outside.
#[derive(Debug, Clone, Copy)]
pub struct BuilderView<'a> {
    /// Of the last check.
    pub findings: &'a [Finding],
    pub download_bytes: Option<u64>,
    /// So much is packed, of so much.
    pub packing: Option<(usize, usize)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Page {
    #[default]
    Samples,
    Texts,
    Tools,
    Protocol,
    Questions,
    Finish,
    Check,
}

const PAGES: [(Page, &str); 7] = [
    (Page::Samples, "Samples"),
    (Page::Texts, "Texts"),
    (Page::Tools, "Tools"),
    (Page::Protocol, "Protocol"),
    (Page::Questions, "Questions"),
    (Page::Finish, "Results"),
    (Page::Check, "Check and export"),
];

/// The draft, for as long as the program runs.
#[derive(Debug, Default)]
pub struct State {
    is_open: bool,
    page: Page,
    draft: Option<Draft>,
}

impl State {
    pub fn show(&mut self) {
        self.is_open = true;
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens with a study that was exported before. Its scene has to be the open one.
    pub fn show_draft(&mut self, draft: Draft) {
        *self = Self { is_open: true, page: Page::default(), draft: Some(draft) };
    }

    /// Adds a picture for the texts; one of the same name is replaced.
    pub fn add_picture(&mut self, name: &str, bytes: Arc<[u8]>) {
        let Some(draft) = &mut self.draft else { return };
        draft.pictures.retain(|(other, _)| other != name);
        draft.pictures.push((name.to_owned(), bytes));
    }
}

/// A draft with every object of every photo in it, and its settings as they were last.
fn draft_of(session: &Session, earlier: Option<Draft>) -> Draft {
    let study = match &earlier {
        Some(draft) => draft.study.clone(),
        None => platform::read_preference(DRAFT_KEY)
            .and_then(|json| Study::from_json(json.as_bytes()).ok())
            .unwrap_or_else(first_study),
    };
    let mut draft = Draft::of_scene(session.scene(), study);
    let Some(earlier) = earlier else { return draft };
    for chosen in &mut draft.chosen {
        let same =
            |old: &&crate::study::pack::Chosen| (old.photo, old.object) == (chosen.photo, chosen.object);
        if let Some(old) = earlier.chosen.iter().find(same).cloned() {
            *chosen = old;
        }
    }
    draft.truth_from = earlier.truth_from;
    draft.pictures = earlier.pictures;
    draft
}

/// What most studies begin with.
fn first_study() -> Study {
    let mut study = Study::new("my-study", "");
    study.items_before = vec![Item {
        id: "expertise".to_owned(),
        text: "How often have you worked with 3D programs?".to_owned(),
        optional: false,
        answer: ItemKind::Choice {
            options: ["Never", "A few times", "Often"].map(str::to_owned).to_vec(),
            several: false,
        },
    }];
    study
}

pub fn draw(
    ctx: &Context,
    session: &Session,
    view: Option<&BuilderView<'_>>,
    state: &mut State,
    asked: &mut Asked,
) {
    if !state.is_open {
        return;
    }
    let mut draft = draft_of(session, state.draft.take());
    let before = draft.study.clone();
    let modal = once::modal(ctx, "study builder", theme::dialog_frame(ctx), |ui| {
        let room = ui.ctx().content_rect().size() - Vec2::splat(64.0);
        ui.set_min_size(SIZE.min(room));
        ui.set_max_size(SIZE.min(room));
        ui.heading("Build a study");
        ui.add_space(4.0);
        ui.horizontal_wrapped(|ui| {
            for (page, title) in PAGES {
                let response = ui.selectable_label(state.page == page, title);
                if response.clicked() {
                    state.page = page;
                    if page == Page::Check {
                        asked.study_build = Some(StudyBuild::Check(Box::new(draft.clone())));
                    }
                }
            }
        });
        ui.separator();
        let height = ui.available_height() - 44.0;
        ScrollArea::vertical()
            .id_salt(("builder", state.page as u8))
            .max_height(height)
            .auto_shrink(false)
            .show(ui, |ui| page(ui, session, view, state.page, &mut draft, asked));
        ui.separator();
        ui.horizontal(|ui| {
            let is_done = ui.add(Button::new("Close").min_size(Vec2::new(96.0, 28.0))).clicked();
            let hint =
                "The samples stay chosen as long as the page is open; all else is kept in this browser";
            ui.label(RichText::new(hint).small().weak());
            is_done
        })
        .inner
    });
    if draft.study != before {
        platform::write_preference(DRAFT_KEY, &draft.study.to_json());
    }
    state.draft = Some(draft);
    let is_preview = matches!(asked.study_build, Some(StudyBuild::Preview(_)));
    if modal.inner || modal.should_close() || is_preview {
        state.is_open = false;
    }
}

fn page(
    ui: &mut Ui,
    session: &Session,
    view: Option<&BuilderView<'_>>,
    page: Page,
    draft: &mut Draft,
    asked: &mut Asked,
) {
    ui.spacing_mut().item_spacing.y = 8.0;
    match page {
        Page::Samples => samples::draw(ui, session, draft),
        Page::Texts => texts::draw(ui, draft, asked),
        Page::Tools => settings::tools(ui, &mut draft.study),
        Page::Protocol => settings::protocol(ui, &mut draft.study),
        Page::Questions => questions::draw(ui, &mut draft.study),
        Page::Finish => settings::finish(ui, &mut draft.study),
        Page::Check => check(ui, view, draft, asked),
    }
}

fn check(ui: &mut Ui, view: Option<&BuilderView<'_>>, draft: &Draft, asked: &mut Asked) {
    let Some(view) = view else { return };
    if let Some((done, all)) = view.packing {
        ui.add(egui::ProgressBar::new(done as f32 / all.max(1) as f32).text("Packing the study…"));
        return;
    }
    for finding in view.findings {
        let (mark, color) = match finding.is_error {
            true => ("Needed:", theme::error(ui.visuals())),
            false => ("Note:", theme::warning(ui.visuals())),
        };
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(mark).strong().color(color));
            ui.label(&finding.text);
        });
    }
    if view.findings.is_empty() {
        ui.label(RichText::new("Nothing is missing").color(theme::good(ui.visuals())));
    }
    if let Some(bytes) = view.download_bytes {
        ui.label(format!("Participants load {:.1} MB.", bytes as f64 / 1e6));
    }
    ui.add_space(8.0);
    let is_usable = view.download_bytes.is_some() && view.findings.iter().all(|finding| !finding.is_error);
    ui.horizontal(|ui| {
        let size = Vec2::new(150.0, 32.0);
        let boxed = || Box::new(draft.clone());
        if ui.add_enabled(is_usable, theme::primary_button("Export study").min_size(size)).clicked() {
            asked.study_build = Some(StudyBuild::Export(boxed()));
        }
        if ExportFolder::can_be_picked()
            && ui.add_enabled(is_usable, Button::new("Into a folder…").min_size(size)).clicked()
        {
            asked.study_build = Some(StudyBuild::IntoFolder(boxed()));
        }
        if ui.add_enabled(is_usable, Button::new("Preview").min_size(size)).clicked() {
            asked.study_build = Some(StudyBuild::Preview(boxed()));
        }
        if ui.add(Button::new("Check again").min_size(size)).clicked() {
            asked.study_build = Some(StudyBuild::Check(boxed()));
        }
    });
    ui.add_space(8.0);
    ui.label("Two files come: a zip for participants, and the true poses, which only you keep.");
    ui.label("Put the zip on any web server (or unpack it there) and hand out the address of this page with");
    let link = "?study=https://your.server/study.zip&participant=ID";
    ui.horizontal(|ui| {
        ui.monospace(link);
        if ui.small_button("Copy").clicked() {
            ui.ctx().copy_text(link.to_owned());
        }
    });
    let more = "Another server than this page's has to allow it (CORS). Recruiters' links work too: PROLIFIC_PID is a \
        participant's id. Add &cond= and &set= to choose condition and sample set yourself.";
    ui.label(RichText::new(more).weak());
}

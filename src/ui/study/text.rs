//! A study's texts: Markdown's blocks with egui's labels, and the pictures among them.

use std::collections::BTreeMap;

use egui::text::{LayoutJob, TextFormat};
use egui::{FontId, RichText, Stroke, TextureHandle, TextureOptions, Ui};

use crate::photo::Pixels;
use crate::study::markdown::{Block, Span, blocks};
use crate::ui::theme;

/// The pictures of a study's texts, by name.
#[derive(Default)]
pub struct Pictures(BTreeMap<String, TextureHandle>);

impl std::fmt::Debug for Pictures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_set().entries(self.0.keys()).finish()
    }
}

impl Pictures {
    pub fn insert(&mut self, ctx: &egui::Context, name: &str, pixels: &Pixels) {
        let size = [pixels.width as usize, pixels.height as usize];
        let image = egui::ColorImage::from_rgba_unmultiplied(size, &pixels.rgba);
        self.0.insert(name.to_owned(), ctx.load_texture(name, image, TextureOptions::LINEAR));
    }
}

impl Pictures {
    pub fn forget(&mut self, names: &[&str]) {
        names.iter().for_each(|name| {
            self.0.remove(*name);
        });
    }

    pub fn get(&self, name: &str) -> Option<&TextureHandle> {
        self.0.get(name)
    }
}

pub fn draw(ui: &mut Ui, markdown: &str, pictures: &Pictures) {
    for block in blocks(markdown) {
        match block {
            Block::Heading(level, spans) => {
                let size = match level {
                    1 => 22.0,
                    2 => 18.0,
                    _ => 15.5,
                };
                ui.add_space(if level == 1 { 4.0 } else { 8.0 });
                line(ui, &spans, size, true);
            }
            Block::Paragraph(spans) => line(ui, &spans, BODY, false),
            Block::Item(mark, spans) => {
                ui.horizontal_top(|ui| {
                    ui.add_space(8.0);
                    let mark = Span { text: mark, ..Span::default() };
                    // Laid out as the text beside it, so that both stand on one line.
                    ui.allocate_ui(egui::vec2(MARK_WIDTH, 0.0), |ui| line(ui, &[mark], BODY, false));
                    ui.vertical(|ui| line(ui, &spans, BODY, false));
                });
            }
            Block::Picture { alt, name } => picture(ui, &alt, pictures.0.get(&name)),
            Block::Rule => {
                ui.separator();
            }
        }
    }
}

/// Room for the bullet or number of an entry.
const MARK_WIDTH: f32 = 16.0;

/// A little larger than in panels: this is read, not looked up.
const BODY: f32 = 15.0;

fn picture(ui: &mut Ui, alt: &str, texture: Option<&TextureHandle>) {
    let Some(texture) = texture else {
        ui.label(RichText::new(alt).italics().weak());
        return;
    };
    let size = texture.size_vec2() / ui.ctx().pixels_per_point();
    let part = (ui.available_width() / size.x.max(1.0)).min(1.0);
    let response = ui.image((texture.id(), size * part));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, alt));
}

/// Runs of one look are one label, so that lines wrap as a text does; links are labels of their own.
fn line(ui: &mut Ui, spans: &[Span], size: f32, strong: bool) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let mut job = LayoutJob::default();
        for span in spans {
            if let Some(target) = &span.link {
                label(ui, &mut job);
                ui.hyperlink_to(RichText::new(&span.text).size(size), target);
            } else {
                job.append(&span.text, 0.0, format(ui, span, size, strong));
            }
        }
        label(ui, &mut job);
    });
}

fn label(ui: &mut Ui, job: &mut LayoutJob) {
    if !job.is_empty() {
        ui.label(std::mem::take(job));
    }
}

fn format(ui: &Ui, span: &Span, size: f32, strong: bool) -> TextFormat {
    let visuals = ui.visuals();
    let is_strong = strong || span.bold;
    let font_id = if span.code { FontId::monospace(size - 1.0) } else { FontId::proportional(size) };
    TextFormat {
        font_id,
        // The font has one weight: what is bold stands out by its colour.
        color: if is_strong { visuals.strong_text_color() } else { visuals.text_color() },
        underline: if span.bold && !strong { Stroke::new(1.0, theme::accent(visuals)) } else { Stroke::NONE },
        italics: span.italic,
        background: if span.code { visuals.faint_bg_color } else { egui::Color32::TRANSPARENT },
        ..TextFormat::default()
    }
}

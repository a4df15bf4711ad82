//! The report's download: page, tables and figures in one zip, a file at a time.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use super::named;
use crate::formats::NamedFile;
use crate::formats::export::ZipStream;
use crate::platform::{self, GrowingDownload};
use crate::study::report::{PNG_SCALE, Report};

/// What the browser made of a drawing.
type Drawn = Rc<RefCell<Option<Result<Vec<u8>, String>>>>;

pub struct Packing {
    zip: ZipStream,
    download: GrowingDownload,
    texts: VecDeque<(String, String)>,
    /// Figures that are still to be drawn as PNG: path and SVG.
    drawings: VecDeque<(String, String)>,
    /// The one that is being drawn.
    drawing: Option<(String, Drawn)>,
    all: usize,
}

impl Packing {
    pub fn new(report: &Report, generator: &str) -> Self {
        let texts: VecDeque<(String, String)> = report.files(generator).into();
        let is_figure = |(path, _): &&(String, String)| path.ends_with(".svg");
        let drawings: VecDeque<(String, String)> = texts.iter().filter(is_figure).cloned().collect();
        let all = texts.len() + drawings.len();
        Self {
            zip: ZipStream::new(),
            download: GrowingDownload::default(),
            texts,
            drawings,
            drawing: None,
            all,
        }
    }

    /// Files that are done, of all.
    pub fn progress(&self) -> (usize, usize) {
        let waiting = self.texts.len() + self.drawings.len() + usize::from(self.drawing.is_some());
        (self.all - waiting, self.all)
    }

    /// Writes files while there is time; true once there is no more.
    pub fn step(&mut self, ctx: &egui::Context, has_time: &mut dyn FnMut() -> bool) -> Result<bool, String> {
        while let Some((path, text)) = self.texts.pop_front() {
            self.add(&named(path, text))?;
            if !has_time() {
                ctx.request_repaint();
                return Ok(false);
            }
        }
        if let Some((path, drawn)) = self.drawing.take() {
            let png = drawn.borrow_mut().take();
            match png {
                Some(Ok(bytes)) => self.add(&NamedFile { name: path, bytes: Arc::from(bytes) })?,
                Some(Err(problem)) => return Err(format!("{path}: {problem}")),
                None => {
                    self.drawing = Some((path, drawn));
                    return Ok(false);
                }
            }
        }
        let Some((path, svg)) = self.drawings.pop_front() else { return Ok(true) };
        let path = format!("{}png", path.trim_end_matches("svg"));
        let drawn = Drawn::default();
        self.drawing = Some((path, drawn.clone()));
        let woken = ctx.clone();
        platform::spawn(async move {
            let png = platform::png_of_svg(svg, PNG_SCALE).await;
            *drawn.borrow_mut() = Some(png);
            woken.request_repaint();
        });
        ctx.request_repaint();
        Ok(false)
    }

    fn add(&mut self, file: &NamedFile) -> Result<(), String> {
        let bytes = self.zip.add(file).map_err(|error| error.to_string())?;
        self.download.append(&bytes)
    }

    /// Hands the zip over.
    pub fn finish(self, name: &str) -> Result<(), String> {
        let Self { zip, mut download, .. } = self;
        let end = zip.finish().map_err(|error| error.to_string())?;
        download.append(&end)?;
        download.finish(name)
    }
}

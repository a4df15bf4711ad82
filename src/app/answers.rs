//! Answers to the calls of the page's script.

use std::sync::PoisonError;

use glam::DVec2;

use super::PinPose;
use super::loading::Arrival;
use super::pictures::PictureFor;
use super::widgets::WidgetWatcher;
use crate::formats::{Keep, PosesAs, write_document};
use crate::interact::{Viewpoint as _, pick_all, pick_along};
use crate::math::Pose;
use crate::platform::{self, FileBytes, PageAnswer, PageCall, PageReply, PageState, PageValue, Perf, Picked};
use crate::render::ExportKind;
use crate::scene::{Look, ObjectId, OverlayMode, PhotoId, PoseSource};
use crate::session::{Arrangement, COMMANDS, Command, Panes, Question};
use crate::ui::{self, Saving};

type Answer = Result<PageAnswer, String>;

/// Calls whose answers take more than this frame.
#[derive(Default)]
pub struct Answers {
    widgets: Vec<PageReply>,
}

impl PinPose {
    pub(super) fn answer_calls(&mut self, ctx: &egui::Context) {
        self.answer_widgets(ctx);
        while let Some((call, reply)) = self.calls.take() {
            match call {
                PageCall::Load { files, poses_as } => self.call_load(files, poses_as, reply),
                PageCall::Render { photo, kind, object } => self.call_render(photo, &kind, object, reply),
                PageCall::Widgets => {
                    if self.answers.widgets.is_empty() {
                        // The frame that the last answer was given in has left a tree, of how things were then.
                        ctx.plugin::<WidgetWatcher>().lock().take();
                        ctx.enable_accesskit();
                    }
                    self.answers.widgets.push(reply);
                    ctx.request_repaint();
                }
                call => {
                    // Who asked may be gone.
                    reply.send(self.answer_now(call, ctx)).ok();
                    // What was changed or looked up is on screen before anything else happens.
                    ctx.request_repaint();
                }
            }
        }
    }

    fn answer_now(&mut self, call: PageCall, ctx: &egui::Context) -> Answer {
        match call {
            PageCall::Ready => Ok(PageAnswer::Nothing),
            PageCall::State => Ok(PageAnswer::State(self.page_state())),
            PageCall::SetPose { photo, object, camera_from_object } => {
                self.call_set_pose(photo, object, &camera_from_object)
            }
            PageCall::Command { name, value } => self.call_command(&name, value),
            PageCall::PageFromImage { u, v } => self.page_from_image(DVec2::new(u, v)),
            PageCall::ImageFromPage { x, y } => {
                let pixel = self.image_from_page(x, y)?;
                Ok(PageAnswer::Point { x: pixel.x, y: pixel.y })
            }
            PageCall::Pick { x, y } => self.call_pick(x, y),
            PageCall::Perf => Ok(PageAnswer::Perf(self.perf())),
            PageCall::Load { .. } | PageCall::Render { .. } | PageCall::Widgets => {
                debug_assert!(false, "answered elsewhere");
                ctx.request_repaint();
                Ok(PageAnswer::Nothing)
            }
        }
    }

    fn call_load(&mut self, files: Vec<FileBytes>, poses_as: Option<String>, reply: PageReply) {
        if self.is_in_study() {
            reply.send(Err("files cannot be loaded in a study".to_owned())).ok();
            return;
        }
        let poses_as = match poses_as.as_deref() {
            None => None,
            Some("annotations") => Some(PosesAs::Annotations),
            Some("reference") => Some(PosesAs::Reference),
            Some(other) => {
                let message = format!("posesAs is \"{other}\", \"annotations\" or \"reference\" expected");
                reply.send(Err(message)).ok();
                return;
            }
        };
        let files = files.into_iter().map(Ok).collect();
        self.loading.arrive(Arrival { poses_as, reply: Some(reply), ..Arrival::of_files(files) });
    }

    fn call_set_pose(&mut self, photo: u32, object: u32, rows: &[[f64; 4]; 4]) -> Answer {
        if self.is_in_study() {
            return Err("setPose is not part of a study".to_owned());
        }
        let (camera_from_object, _) = Pose::from_rows(rows).map_err(|error| error.to_string())?;
        let (photo, object) = (PhotoId(photo), ObjectId(object));
        self.try_apply(Command::SetPose { photo, object, camera_from_object, source: PoseSource::Manual })?;
        Ok(PageAnswer::Nothing)
    }

    fn call_command(&mut self, name: &str, value: Option<PageValue>) -> Answer {
        let command = match (name, value) {
            ("show_photo", Some(PageValue::Number(id))) => Command::ShowPhoto(PhotoId(whole(id)?)),
            ("select", Some(PageValue::Number(id))) => Command::Select(Some(ObjectId(whole(id)?))),
            ("select", None) => Command::Select(None),
            ("set_overlay_opacity", Some(PageValue::Number(opacity))) => {
                Command::SetLook(Look { overlay_opacity: opacity as f32, ..self.session.look() })
            }
            ("set_overlay_mode", Some(PageValue::Text(mode))) => {
                let mode = OverlayMode::from_name(&mode)
                    .ok_or_else(|| not_one_of(&mode, &OverlayMode::ALL.map(|(_, name, _)| name)))?;
                Command::SetLook(Look { mode, ..self.session.look() })
            }
            ("set_arrangement", Some(PageValue::Text(name))) => {
                let arrangement = Arrangement::from_name(&name)
                    .ok_or_else(|| not_one_of(&name, &Arrangement::ALL.map(|(_, name)| name)))?;
                Command::SetPanes(Panes { arrangement, ..self.session.panes() })
            }
            _ => {
                let info = COMMANDS.iter().find(|info| info.name == name);
                Command::Run(
                    info.ok_or_else(|| format!("there is no command \"{name}\" with this argument"))?.id,
                )
            }
        };
        self.try_apply(command)?;
        Ok(PageAnswer::Nothing)
    }

    /// A viewport pixel's place on the page, in CSS pixels. The zoom factor of the interface itself is part of both.
    fn page_from_image(&self, pixel: DVec2) -> Answer {
        let place = self.ui_state.viewport.ok_or("no photo is shown")?;
        let position = self.hands.photo_view.viewport_from_image(pixel) / f64::from(place.pixels_per_point);
        Ok(PageAnswer::Point {
            x: position.x + f64::from(place.rect.left()),
            y: position.y + f64::from(place.rect.top()),
        })
    }

    fn image_from_page(&self, x: f64, y: f64) -> Result<DVec2, String> {
        let place = self.ui_state.viewport.ok_or("no photo is shown")?;
        Ok(self.hands.photo_view.image_from_viewport(offset_px(&place, x, y)))
    }

    /// In whichever view the place is.
    fn call_pick(&self, x: f64, y: f64) -> Answer {
        let photo = self.session.photo().ok_or("no photo is shown")?;
        let scene = self.session.scene();
        let position = egui::pos2(x as f32, y as f32);
        let hits = match self.ui_state.scene_viewport.filter(|place| place.rect.contains(position)) {
            Some(place) => {
                let eye = self.hands.scene_view.eye(&self.session);
                let offset = offset_px(&place, x, y);
                eye.map(|eye| pick_along(scene, photo.id, &eye.ray(offset))).unwrap_or_default()
            }
            None => pick_all(scene, photo.id, self.image_from_page(x, y)?),
        };
        let hit = hits.first().copied();
        Ok(PageAnswer::Picked(hit.map(|hit| Picked {
            object: hit.object.0,
            face: hit.face,
            point_object_mm: hit.point_object_mm.to_array(),
            depth_mm: hit.point_camera_mm.z,
        })))
    }

    fn page_state(&self) -> PageState {
        let rect_of = |place: Option<ui::ViewportPlace>| {
            place.map_or([0.0; 4], |ui::ViewportPlace { rect, .. }| {
                [rect.left(), rect.top(), rect.width(), rect.height()].map(f64::from)
            })
        };
        let question = self.session.question().map(|question| match question {
            Question::PosesAs(_) => "poses_as",
            Question::CameraSize { .. } => "camera_size",
        });
        PageState {
            document_json: write_document(&self.session.document(Keep::Everything)),
            photo: self.session.photo().map(|photo| photo.id.0),
            selected: self.session.selected().map(|id| id.0),
            tool: self.session.tool().name(),
            zoom: self.hands.photo_view.zoom,
            center: self.hands.photo_view.center.to_array(),
            viewport: rect_of(self.ui_state.viewport),
            scene_viewport: rect_of(self.ui_state.scene_viewport),
            arrangement: self.session.panes().arrangement.name(),
            panels: !self.ui_state.panels_hidden,
            busy: self.loading.is_busy()
                || self.loading.is_finishing_mesh()
                || self.datasets.is_busy()
                || self.scenes.is_switching()
                || self.snapping.is_busy()
                || self.reporting.is_busy(),
            saved: self.autosave.state(&self.session) == Saving::Saved,
            question: question.or_else(|| self.datasets.asks().then_some("data_set")),
            notices: self.ui_state.toasts.texts().map(str::to_owned).collect(),
            study: self.study.as_ref().map(|study| study.screen_name()),
        }
    }

    fn perf(&mut self) -> Perf {
        let usage = self.renderer.as_ref().map_or((0, 0, 0), |renderer| {
            let renderer = renderer.lock().unwrap_or_else(PoisonError::into_inner);
            let usage = &renderer.usage;
            let counts = (usage.uploaded_bytes.get(), usage.draw_calls.get(), usage.triangles.get());
            usage.reset();
            counts
        });
        let [cpu_median_ms, cpu_p95_ms] = self.performance.take_cpu_ms([0.5, 0.95]);
        Perf {
            backend: self.backend.clone(),
            frames: self.performance.frames,
            cpu_median_ms,
            cpu_p95_ms,
            uploaded_bytes: usage.0,
            draw_calls: usage.1,
            triangles: usage.2,
            wasm_bytes: platform::wasm_bytes(),
            memory_bytes: platform::memory_bytes(),
            start_ms: self.performance.start_ms,
        }
    }

    fn call_render(&mut self, photo: Option<u32>, kind: &str, object: Option<u32>, reply: PageReply) {
        match self.check_render(photo, kind, object) {
            Ok((photo, kind, object)) => self.pictures.ask(photo, kind, object, PictureFor::Page(reply)),
            Err(message) => {
                reply.send(Err(message)).ok();
            }
        }
    }

    fn check_render(
        &self,
        photo: Option<u32>,
        kind_name: &str,
        object: Option<u32>,
    ) -> Result<(PhotoId, ExportKind, Option<ObjectId>), String> {
        let kind = ExportKind::from_name(kind_name).ok_or_else(|| {
            let names = ExportKind::ALL.map(|(_, name)| name).join(", ");
            format!("kind is \"{kind_name}\", one of {names} expected")
        })?;
        let photo =
            photo.map(PhotoId).or(self.session.photo().map(|photo| photo.id)).ok_or("no photo is open")?;
        self.session
            .scene()
            .photo(photo)
            .ok_or_else(|| format!("there is no photo with the id {}", photo.0))?;
        let object = object.map(ObjectId).or(self.session.selected().filter(|_| kind.is_of_one_object()));
        if kind.is_of_one_object() {
            let object = object.ok_or("an object is needed")?;
            self.session.scene().annotation(photo, object).ok_or("that object is not in that photo")?;
        }
        Ok((photo, kind, object))
    }

    fn answer_widgets(&mut self, ctx: &egui::Context) {
        if self.answers.widgets.is_empty() {
            return;
        }
        let taken = ctx.plugin::<WidgetWatcher>().lock().take();
        match taken {
            Some(widgets) => {
                for reply in self.answers.widgets.drain(..) {
                    reply.send(Ok(PageAnswer::Widgets(widgets.clone()))).ok();
                }
                ctx.disable_accesskit();
            }
            None => ctx.request_repaint(),
        }
    }
}

/// An id that came as a number.
fn whole(number: f64) -> Result<u32, String> {
    let is_id = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    if is_id { Ok(number as u32) } else { Err(format!("{number} is no id")) }
}

fn not_one_of(given: &str, names: &[&str]) -> String {
    format!("the value is \"{given}\", one of {} expected", names.join(", "))
}

/// From a view's corner to a place of the page, in physical pixels.
fn offset_px(place: &ui::ViewportPlace, x: f64, y: f64) -> DVec2 {
    let offset = DVec2::new(x - f64::from(place.rect.left()), y - f64::from(place.rect.top()));
    offset * f64::from(place.pixels_per_point)
}

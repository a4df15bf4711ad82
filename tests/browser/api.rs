//! What the flows find and check through `window.pinpose`, with types. Acting goes through the mouse and the keyboard.

use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use image::GrayImage;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::json;

use crate::data::File;
use crate::input::{Button, Point};
use crate::page::Page;

/// `camera_from_object`, row by row, millimetres.
pub type Matrix = [[f64; 4]; 4];

/// Longer than anything that the page does in a flow takes, on a software renderer and two busy cores.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// The scene and what is around it, as far as flows look at it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct State {
    pub photos: Vec<Photo>,
    pub objects: Vec<Object>,
    pub selection: Selection,
    pub viewport: Viewport,
    pub saved: bool,
    pub notices: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Photo {
    pub id: u32,
    pub file: String,
    pub sha256: String,
    #[serde(rename = "K")]
    pub k: [[f64; 3]; 3],
    pub poses: Vec<Pose>,
}

/// One object's pose in one photo; equal only bit for bit, with its state, source and time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Pose {
    pub object: u32,
    pub camera_from_object: Matrix,
    pub state: String,
    pub source: String,
    pub changed_at_ms: f64,
    #[serde(default)]
    pub pins: Vec<Pin>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Pin {
    pub pixel: Point,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Object {
    pub id: u32,
    pub name: String,
    pub mesh_file: String,
    pub mesh_sha256: String,
    pub color: String,
    pub opacity: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Selection {
    pub photo: Option<u32>,
    pub object: Option<u32>,
    pub tool: String,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Viewport {
    /// Physical pixels per photo pixel.
    pub zoom: f64,
    /// x, y, width, height in CSS pixels.
    pub rect: [f64; 4],
    pub panels: bool,
}

/// The surface point under a place of the page.
#[derive(Debug, Clone, Deserialize)]
pub struct Picked {
    pub object: u32,
    /// In the object's frame, millimetres.
    pub point: [f64; 3],
    /// Along the camera's z axis, millimetres.
    pub depth: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub struct Widget {
    pub label: String,
    pub visible: bool,
    /// x, y, width, height in CSS pixels.
    pub rect: [f64; 4],
}

#[derive(Debug, Clone, Deserialize)]
pub struct Perf {
    pub backend: String,
    pub frames: u64,
    pub cpu_ms: CpuMs,
    /// These three since the call before, like the times.
    pub uploaded_bytes: u64,
    pub draw_calls: u64,
    pub triangles: u64,
    /// Of the page's wasm: the most that it ever was.
    pub memory_bytes: f64,
    pub start_ms: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub struct CpuMs {
    pub median: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub struct Loaded {
    pub files: u32,
    pub problems: Vec<String>,
}

#[derive(Deserialize)]
struct PagePoint {
    x: f64,
    y: f64,
}

impl State {
    /// What autosave and undo keep: photos with cameras and poses, and objects.
    pub fn scene(&self) -> (&[Photo], &[Object]) {
        (&self.photos, &self.objects)
    }

    pub fn shown_photo(&self) -> anyhow::Result<&Photo> {
        let shown = self.photos.iter().find(|photo| Some(photo.id) == self.selection.photo);
        shown.context("No photo is shown")
    }

    /// The selected object's pose in the photo that is shown.
    pub fn selected_pose(&self) -> anyhow::Result<&Pose> {
        let mut poses = self.shown_photo()?.poses.iter();
        poses.find(|pose| Some(pose.object) == self.selection.object).context("No posed object is selected")
    }
}

impl Widget {
    pub fn center(&self) -> Point {
        let [x, y, width, height] = self.rect;
        (x + width / 2.0, y + height / 2.0)
    }
}

impl Page {
    pub fn state(&mut self) -> anyhow::Result<State> {
        self.ask("state()")
    }

    pub fn selected_pose(&mut self) -> anyhow::Result<Pose> {
        Ok(self.state()?.selected_pose()?.clone())
    }

    /// Waits until the page's state fulfils a condition: an expression about `state`, in JavaScript.
    pub fn wait_for_state(&mut self, condition: &str, timeout: Duration) -> anyhow::Result<State> {
        let deadline = Instant::now() + timeout;
        loop {
            let fulfilled: Option<State> =
                self.ask(&format!("state().then((state) => ({condition}) ? state : null)"))?;
            if let Some(state) = fulfilled {
                return Ok(state);
            }
            ensure!(Instant::now() < deadline, "This did not become true in {timeout:?}: {condition}");
        }
    }

    /// Waits until all that is under way is done and stored.
    pub fn wait_until_saved(&mut self) -> anyhow::Result<State> {
        self.wait_for_state("!state.busy && state.saved", PATIENCE)
    }

    /// Where a point of the `image` frame is on the page.
    pub fn page_from_image(&mut self, (u, v): Point) -> anyhow::Result<Point> {
        let point: PagePoint = self.ask(&format!("pageFromImage({u}, {v})"))?;
        Ok((point.x, point.y))
    }

    pub fn image_from_page(&mut self, (x, y): Point) -> anyhow::Result<Point> {
        let point: PagePoint = self.ask(&format!("imageFromPage({x}, {y})"))?;
        Ok((point.x, point.y))
    }

    /// The whole pixel of the page nearest to a point of the `image` frame: browsers report the mouse in whole pixels.
    pub fn mouse_place(&mut self, image: Point) -> anyhow::Result<Point> {
        let (x, y) = self.page_from_image(image)?;
        Ok((x.round(), y.round()))
    }

    pub fn pick(&mut self, (x, y): Point) -> anyhow::Result<Option<Picked>> {
        self.ask(&format!("pick({x}, {y})"))
    }

    pub fn perf(&mut self) -> anyhow::Result<Perf> {
        self.ask("perf()")
    }

    pub fn command(&mut self, name: &str) -> anyhow::Result<()> {
        self.ask(&format!("command({})", json!(name)))
    }

    pub fn set_overlay_opacity(&mut self, opacity: f64) -> anyhow::Result<()> {
        self.ask(&format!("command('set_overlay_opacity', {opacity})"))
    }

    pub fn set_pose(&mut self, photo: u32, object: u32, camera_from_object: Matrix) -> anyhow::Result<()> {
        self.ask(&format!("setPose({photo}, {object}, {})", json!(camera_from_object)))
    }

    /// Loads through the API, with poses as annotations; loading by hand is what `drop_files` is for.
    pub fn load(&mut self, files: &[File]) -> anyhow::Result<Loaded> {
        self.ask(&format!("load({}, {{ posesAs: 'annotations' }})", files_expression(files)))
    }

    /// A picture at photo resolution, as PNG.
    pub fn render_png(&mut self, kind: &str) -> anyhow::Result<Vec<u8>> {
        let data_url: String = self.ask(&format!(
            "render({{ kind: '{kind}' }}).then((bytes) => new Promise((resolve) => {{
                const reader = new FileReader();
                reader.onload = () => resolve(reader.result);
                reader.readAsDataURL(new Blob([bytes], {{ type: 'image/png' }}));
            }}))"
        ))?;
        let (_, base64) = data_url.split_once(',').context("No data URL")?;
        Ok(BASE64.decode(base64)?)
    }

    /// A mask at photo resolution.
    pub fn render_mask(&mut self, kind: &str) -> anyhow::Result<GrayImage> {
        Ok(image::load_from_memory(&self.render_png(kind)?)?.into_luma8())
    }

    pub fn widgets(&mut self) -> anyhow::Result<Vec<Widget>> {
        let widgets: Vec<Widget> = self.ask("widgets()")?;
        Ok(widgets.into_iter().filter(|widget| widget.visible).collect())
    }

    /// Waits for a widget with this label, and clicks its middle with the mouse.
    pub fn click_widget(&mut self, label: &str) -> anyhow::Result<()> {
        let mut place = None;
        // What opens is laid out anew once its size is known: it is clicked where it was seen twice.
        loop {
            let widgets = self.wait_for_widgets(&[label])?;
            let seen = widgets.iter().find(|widget| widget.label == label).map(Widget::center);
            match (place, seen) {
                (Some(before), Some(now)) if before == now => return self.click(now, Button::Left, &[]),
                _ => place = seen,
            }
        }
    }

    /// Waits until widgets with these labels can be seen. What opens takes a frame or two.
    pub fn wait_for_widgets(&mut self, labels: &[&str]) -> anyhow::Result<Vec<Widget>> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let widgets = self.widgets()?;
            let missing = labels.iter().find(|label| !widgets.iter().any(|widget| widget.label == **label));
            let Some(missing) = missing else { return Ok(widgets) };
            ensure!(Instant::now() < deadline, "\"{missing}\" is not on the page");
        }
    }

    fn ask<T: DeserializeOwned>(&mut self, call: &str) -> anyhow::Result<T> {
        let answer = self.eval(&format!("window.pinpose.{call}"))?;
        let method = call.split('(').next().unwrap_or(call);
        serde_json::from_value(answer).with_context(|| format!("What {method} answered was not expected"))
    }
}

/// An array of `File`s, in JavaScript.
pub fn files_expression(files: &[File]) -> String {
    let list: Vec<_> =
        files.iter().map(|file| json!({ "name": file.name, "base64": BASE64.encode(&file.bytes) })).collect();
    format!(
        "{}.map((file) => new File(
            [Uint8Array.from(atob(file.base64), (letter) => letter.charCodeAt(0))], file.name))",
        json!(list)
    )
}

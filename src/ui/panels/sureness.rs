//! How sure the selected pose is, seen and in words, and what would help most.

use egui::{RichText, Ui};
use glam::DVec3;

use super::number_field::{NumberField, column_width, note};
use super::section::section;
use crate::scene::PoseSource;
use crate::session::{HelpfulPin, Session, Sureness};
use crate::solve::{Tolerances, Uncertainty, Weakest, Weakness};

/// In per cent: what is typed beyond is no tolerance.
const MOST_PERCENT: f64 = 20.0;
/// Of the object's radius: a way shorter than this has no name.
const NAMED_WAY: f64 = 0.35;

/// Of a standard deviation: half of the variance.
const MOSTLY: f64 = 0.7;

/// What the section keeps between frames.
#[derive(Debug, Default)]
pub struct SurenessForm {
    /// The revision and the tolerances that it is of.
    known: Option<(u64, Tolerances, Option<Sureness>)>,
    asked_sway: Option<Weakest>,
}

impl SurenessForm {
    /// The motion that the user wants to see.
    pub fn take_asked_sway(&mut self) -> Option<Weakest> {
        self.asked_sway.take()
    }

    fn sureness(&mut self, session: &Session, tolerances: &Tolerances) -> Option<Sureness> {
        let key = (session.revision(), *tolerances);
        match &self.known {
            Some((revision, known, sureness)) if (*revision, *known) == key => *sureness,
            _ => {
                let sureness = session.sureness(tolerances);
                self.known = Some((key.0, key.1, sureness));
                sureness
            }
        }
    }
}

pub fn draw(ui: &mut Ui, session: &Session, tolerances: &mut Tolerances, form: &mut SurenessForm) {
    let Some(sureness) = form.sureness(session, tolerances) else { return };
    let body = |ui: &mut Ui| {
        numbers(ui, &sureness);
        tolerance_fields(ui, tolerances);
        if let Some(sigma) = sureness.guessed_focal.filter(|sigma| *sigma > tolerances.focal) {
            let percent = 100.0 * sigma;
            note(ui, &format!("The focal length is an estimate: ± {percent:.1} % of it are counted."), false);
        }
        if let Some(weakest) = sureness.weakest {
            let button = ui.button(format!("Show how far the {} may be off", name_of(weakest.kind)));
            let tooltip = "The direction in which the pose is least sure: it sways by two standard deviations, on the screen only";
            if button.on_hover_text(tooltip).clicked() {
                form.asked_sway = Some(weakest);
            }
        }
        advice(ui, &sureness, tolerances);
    };
    section(ui, "Uncertainty", true, |_| {}, body);
}

/// What would help most.
fn advice(ui: &mut Ui, sureness: &Sureness, tolerances: &Tolerances) {
    let is_by_tolerances = sureness.by_tolerances_mm > MOSTLY * sureness.uncertainty.depth_mm;
    let weakest = sureness.weakest.map(|weakest| weakest.kind);
    // A depth that is off by as much as the focal length is so in every photo.
    if let Some(kind) = weakest.filter(|kind| !(is_by_tolerances && *kind == Weakness::Depth)) {
        note(ui, view_that_helps(kind), false);
    }
    let is_guess =
        sureness.guessed_focal.is_some_and(|sigma| sigma > tolerances.focal.max(tolerances.mesh_scale));
    match sureness.helpful_pin {
        _ if is_by_tolerances && is_guess => {
            note(
                ui,
                "Most of the depth's comes from the estimated focal length: a calibrated camera helps most.",
                false,
            );
        }
        _ if is_by_tolerances => {
            note(
                ui,
                "Most of the depth's comes from these tolerances: a calibrated camera and a measured mesh help.",
                false,
            );
        }
        Some(pin) => note(ui, &pin_that_helps(&pin, &sureness.uncertainty), false),
        None => {}
    }
}

/// Two lines: where it is, how it is turned; one standard deviation.
fn numbers(ui: &mut Ui, sureness: &Sureness) {
    let Uncertainty { depth_mm, lateral_mm, tilt_rad, roll_rad } = sureness.uncertainty;
    let text = format!(
        "± {depth_mm:.1} mm depth, ± {lateral_mm:.1} mm sideways\n± {:.1}° tilt, ± {:.1}° roll",
        tilt_rad.to_degrees(),
        roll_rad.to_degrees()
    );
    let from = match sureness.source {
        PoseSource::Snap => "how well the photo fits the snap",
        _ => "how well the pins agree, with a click's 1.5 px",
    };
    let turns = if sureness.leaves_out_turns {
        ". Turns about the axis of symmetry look the same and are no error"
    } else {
        ""
    };
    let tooltip = format!(
        "One standard deviation, from {from}. 1 % of the focal length or of the mesh's size is 1 % of depth{turns}"
    );
    ui.label(RichText::new(text).small()).on_hover_text(tooltip);
}

fn tolerance_fields(ui: &mut Ui, tolerances: &mut Tolerances) {
    let width = column_width(ui, 2);
    let Tolerances { focal, mesh_scale } = tolerances;
    ui.horizontal(|ui| {
        for (label, name, tooltip, part) in [
            ("f ±", "focal tolerance", "How far the focal length may be off: one standard deviation", focal),
            (
                "mesh ±",
                "mesh tolerance",
                "How far the mesh's size may be off: one standard deviation",
                mesh_scale,
            ),
        ] {
            let mut percent = *part * 100.0;
            let field =
                NumberField { label, name, tooltip, unit: " %", speed: 0.01, decimals: 2, live: true };
            if field.show(ui, width, 50.0, &mut percent).changed() && percent.is_finite() {
                *part = percent.clamp(0.0, MOST_PERCENT) / 100.0;
            }
        }
    });
}

fn name_of(kind: Weakness) -> &'static str {
    match kind {
        Weakness::Depth => "depth",
        Weakness::Lateral => "place",
        Weakness::Tilt => "tilt",
        Weakness::Roll => "roll",
    }
}

fn view_that_helps(kind: Weakness) -> &'static str {
    match kind {
        Weakness::Depth => {
            "Depth is least sure. A photo from the side would tell it, or one in which the object is larger."
        }
        Weakness::Tilt => "Tilt is least sure. A photo from another side would tell it, or one from nearer.",
        Weakness::Lateral => {
            "Its place across the view is least sure. A photo in which it is larger would tell it."
        }
        Weakness::Roll => "Roll is least sure. A photo along another direction would tell it.",
    }
}

fn pin_that_helps(pin: &HelpfulPin, now: &Uncertainty) -> String {
    format!(
        "The next pin helps most at {}: ± {:.1} mm depth would become ± {:.1} mm.",
        place_of(pin.way),
        now.depth_mm,
        pin.depth_mm
    )
}

/// Where on the object, as the camera sees it: x to the right, y down, z away.
fn place_of(way: DVec3) -> String {
    let named = |part: f64, [negative, positive]: [&'static str; 2]| {
        (part.abs() > NAMED_WAY).then_some(if part < 0.0 { negative } else { positive })
    };
    let parts =
        [named(way.y, ["upper", "lower"]), named(way.x, ["left", "right"]), named(way.z, ["near", "far"])];
    let words: Vec<&str> = parts.into_iter().flatten().collect();
    if words.is_empty() { "its middle".to_owned() } else { format!("its {} end", words.join(" ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_names() {
        assert_eq!(place_of(DVec3::new(0.1, -0.2, 0.3)), "its middle");
        assert_eq!(place_of(DVec3::new(-0.8, 0.6, 0.1)), "its lower left end");
        assert_eq!(place_of(DVec3::new(0.0, 0.0, -0.9)), "its near end");
    }
}

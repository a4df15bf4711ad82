//! Small icons, drawn: the same on every system, sharp at every scale.

use egui::{Painter, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, pos2};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Icon {
    Eye,
    EyeClosed,
    Lock,
    LockOpen,
    Trash,
    Undo,
    Redo,
    Close,
    /// More that can be done with this row.
    Dots,
    Plus,
    Copy,
    Reset,
    ChevronRight,
    ChevronDown,
    /// Linked with others.
    Chain,
    Check,
    /// One way of the screen: (x right, y down).
    Arrow(i8, i8),
    Nearer,
    Farther,
    /// About the screen's horizontal axis, the top away from the viewer or towards him.
    Pitch {
        forward: bool,
    },
    Yaw {
        left: bool,
    },
    Roll {
        left: bool,
    },
    Fold,
    Unfold,
}

/// A button of one icon; `label` is its name for those who do not see it.
pub fn icon_button(ui: &mut Ui, icon: Icon, label: &str, tooltip: &str, enabled: bool) -> Response {
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(22.0), sense);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, label));
    let visuals = ui.style().interact(&response);
    if enabled && (response.hovered() || response.has_focus()) {
        ui.painter().rect_filled(rect, 5.0, visuals.weak_bg_fill);
    }
    let color =
        if enabled { visuals.fg_stroke.color } else { ui.visuals().weak_text_color().gamma_multiply(0.5) };
    draw(ui.painter(), icon, rect.shrink(4.0), Stroke::new(1.4, color));
    response.on_hover_text(tooltip)
}

/// Draws within a square; positions below are in 14ths of it.
pub fn draw(painter: &Painter, icon: Icon, rect: Rect, stroke: Stroke) {
    let at = |x: f32, y: f32| rect.min + Vec2::new(x, y) * (rect.width() / 14.0);
    let line = |points: &[(f32, f32)]| {
        painter.line(points.iter().map(|&(x, y)| at(x, y)).collect(), stroke);
    };
    let unit = rect.width() / 14.0;
    match icon {
        Icon::Eye => {
            line(&arc((7.0, 11.5), 8.0, -145.0, -35.0));
            line(&arc((7.0, 2.5), 8.0, 35.0, 145.0));
            painter.circle_filled(at(7.0, 7.0), 2.2 * unit, stroke.color);
        }
        Icon::EyeClosed => {
            line(&arc((7.0, 2.5), 8.0, 35.0, 145.0));
            line(&[(2.5, 9.5), (1.3, 11.3)]);
            line(&[(7.0, 10.6), (7.0, 12.8)]);
            line(&[(11.5, 9.5), (12.7, 11.3)]);
        }
        Icon::Lock | Icon::LockOpen => {
            painter.rect_filled(Rect::from_min_max(at(2.5, 6.5), at(11.5, 13.0)), 1.5, stroke.color);
            let lifted = if icon == Icon::LockOpen { 2.0 } else { 0.0 };
            line(&arc((7.0, 4.8 - lifted), 3.0, 180.0, 360.0));
            line(&[(4.0, 4.8 - lifted), (4.0, 6.8)]);
            if icon == Icon::Lock {
                line(&[(10.0, 4.8), (10.0, 6.8)]);
            }
        }
        Icon::Trash => {
            line(&[(1.5, 3.5), (12.5, 3.5)]);
            line(&[(5.0, 3.3), (5.0, 1.5), (9.0, 1.5), (9.0, 3.3)]);
            line(&[(3.0, 3.7), (3.6, 13.0), (10.4, 13.0), (11.0, 3.7)]);
            line(&[(5.8, 6.2), (5.8, 10.6)]);
            line(&[(8.2, 6.2), (8.2, 10.6)]);
        }
        Icon::Undo | Icon::Redo => {
            let flip = |points: Vec<(f32, f32)>| -> Vec<(f32, f32)> {
                if icon == Icon::Redo {
                    points.into_iter().map(|(x, y)| (14.0 - x, y)).collect()
                } else {
                    points
                }
            };
            let mut hook = vec![(2.0, 5.0)];
            hook.extend(arc((8.5, 8.5), 3.5, -90.0, 90.0));
            hook.push((4.0, 12.0));
            line(&flip(hook));
            line(&flip(vec![(5.2, 1.8), (2.0, 5.0), (5.2, 8.2)]));
        }
        Icon::Close => {
            line(&[(3.0, 3.0), (11.0, 11.0)]);
            line(&[(11.0, 3.0), (3.0, 11.0)]);
        }
        Icon::Dots => [2.5, 7.0, 11.5].into_iter().for_each(|x| {
            painter.circle_filled(at(x, 7.0), 1.3 * unit, stroke.color);
        }),
        Icon::Plus => {
            line(&[(7.0, 2.0), (7.0, 12.0)]);
            line(&[(2.0, 7.0), (12.0, 7.0)]);
        }
        Icon::Copy => {
            line(&[(9.0, 4.5), (9.0, 1.5), (1.5, 1.5), (1.5, 9.0), (4.5, 9.0)]);
            line(&[(5.0, 5.0), (12.5, 5.0), (12.5, 12.5), (5.0, 12.5), (5.0, 4.4)]);
        }
        Icon::Reset => {
            line(&arc((7.0, 7.5), 4.8, -60.0, 210.0));
            line(&[(9.4, 0.6), (9.6, 3.4), (6.8, 4.0)]);
        }
        Icon::Chain => {
            line(&[(6.0, 4.5), (2.5, 4.5), (1.0, 7.0), (2.5, 9.5), (6.0, 9.5)]);
            line(&[(8.0, 4.5), (11.5, 4.5), (13.0, 7.0), (11.5, 9.5), (8.0, 9.5)]);
            line(&[(4.5, 7.0), (9.5, 7.0)]);
        }
        Icon::ChevronRight => line(&[(5.0, 3.0), (9.5, 7.0), (5.0, 11.0)]),
        Icon::Unfold => line(&[(3.0, 9.0), (7.0, 4.5), (11.0, 9.0)]),
        Icon::Fold | Icon::ChevronDown => line(&[(3.0, 5.0), (7.0, 9.5), (11.0, 5.0)]),
        Icon::Check => line(&[(2.0, 7.5), (5.5, 11.0), (12.0, 3.0)]),
        Icon::Arrow(..) | Icon::Nearer | Icon::Farther => draw_step(icon, &line),
        Icon::Pitch { .. } | Icon::Yaw { .. } | Icon::Roll { .. } => draw_turn(icon, &line),
    }
}

/// Draws a line through points given in 14ths.
type Line<'a> = dyn Fn(&[(f32, f32)]) + 'a;

fn draw_step(icon: Icon, line: &Line<'_>) {
    match icon {
        Icon::Arrow(x, y) => {
            let (x, y) = (f32::from(x), f32::from(y));
            let at = |along: f32, aside: f32| (7.0 + along * x - aside * y, 7.0 + along * y + aside * x);
            line(&[at(-5.0, 0.0), at(5.0, 0.0)]);
            line(&[at(1.0, -4.0), at(5.0, 0.0), at(1.0, 4.0)]);
        }
        // A plus and a minus in a ring: larger, smaller.
        Icon::Nearer | Icon::Farther => {
            line(&arc((7.0, 7.0), 5.8, 0.0, 360.0));
            line(&[(4.2, 7.0), (9.8, 7.0)]);
            if icon == Icon::Nearer {
                line(&[(7.0, 4.2), (7.0, 9.8)]);
            }
        }
        _ => {}
    }
}

/// An arc with a head at its end; a turn about an axis in the screen is a flat one.
fn draw_turn(icon: Icon, line: &Line<'_>) {
    let turned = |points: &[(f32, f32)], turn: &dyn Fn(f32, f32) -> (f32, f32)| {
        line(&points.iter().map(|&(x, y)| turn(x, y)).collect::<Vec<_>>());
    };
    let clockwise = arc((7.0, 8.0), 5.0, 170.0, 350.0);
    let head = [(12.8, 3.6), (12.0, 7.4), (8.4, 6.2)];
    let flat: Vec<(f32, f32)> =
        arc((7.0, 6.5), 5.5, 160.0, 20.0).into_iter().map(|(x, y)| (x, 4.5 + y * 0.5)).collect();
    let flat_head = [(9.4, 7.4), (12.6, 7.9), (11.4, 11.2)];
    match icon {
        Icon::Roll { left } => {
            let turn = |x: f32, y: f32| if left { (14.0 - x, y) } else { (x, y) };
            turned(&clockwise, &turn);
            turned(&head, &turn);
        }
        Icon::Yaw { left } => {
            let turn = |x: f32, y: f32| if left { (14.0 - x, y) } else { (x, y) };
            line(&[(7.0, 1.0), (7.0, 5.0)]);
            turned(&flat, &turn);
            turned(&flat_head, &turn);
        }
        Icon::Pitch { forward } => {
            let turn = |x: f32, y: f32| if forward { (y, 14.0 - x) } else { (y, x) };
            line(&[(1.0, 7.0), (4.0, 7.0)]);
            turned(&flat, &turn);
            turned(&flat_head, &turn);
        }
        _ => {}
    }
}

/// Points of a circle's arc, degrees clockwise from three o'clock.
fn arc(center: (f32, f32), radius: f32, from_degrees: f32, to_degrees: f32) -> Vec<(f32, f32)> {
    let steps = 16;
    (0..=steps)
        .map(|step| {
            let angle =
                (from_degrees + (to_degrees - from_degrees) * step as f32 / steps as f32).to_radians();
            let Pos2 { x, y } = pos2(center.0, center.1) + radius * Vec2::angled(angle);
            (x, y)
        })
        .collect()
}

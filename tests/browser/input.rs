//! The page's real mouse and keyboard. Positions are CSS pixels; the page gets a frame after every step.

use anyhow::{Context as _, ensure};
use serde_json::{Value, json};

use crate::page::Page;

/// A point in the page, in CSS pixels from its top left.
pub type Point = (f64, f64);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    Left,
    Middle,
    Right,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modifier {
    Alt,
    Control,
    Shift,
}

impl Button {
    fn name(self) -> &'static str {
        match self {
            Button::Left => "left",
            Button::Middle => "middle",
            Button::Right => "right",
        }
    }

    /// Its bit among the buttons that are held.
    fn bit(self) -> u32 {
        match self {
            Button::Left => 1,
            Button::Right => 2,
            Button::Middle => 4,
        }
    }
}

impl Modifier {
    fn key(self) -> &'static str {
        match self {
            Modifier::Alt => "Alt",
            Modifier::Control => "Control",
            Modifier::Shift => "Shift",
        }
    }

    fn bit(self) -> u32 {
        match self {
            Modifier::Alt => 1,
            Modifier::Control => 2,
            Modifier::Shift => 8,
        }
    }
}

impl Page {
    pub fn mouse_move(&mut self, to: Point) -> anyhow::Result<()> {
        self.mouse("mouseMoved", to, json!({ "button": "none" }))
    }

    /// A step of a drag that is put together by hand.
    pub fn mouse_move_holding(&mut self, to: Point, button: Button) -> anyhow::Result<()> {
        self.move_holding(to, button, &[])
    }

    pub fn mouse_down(&mut self, at: Point, button: Button) -> anyhow::Result<()> {
        self.press(at, button, &[])
    }

    pub fn mouse_up(&mut self, at: Point, button: Button) -> anyhow::Result<()> {
        self.release(at, button, &[])
    }

    /// Without a frame between press and release: on a slow renderer egui would take it for a long press.
    pub fn click(&mut self, at: Point, button: Button, modifiers: &[Modifier]) -> anyhow::Result<()> {
        self.hold(modifiers, |page| page.clicks(at, button, 1, modifiers))
    }

    pub fn double_click(&mut self, at: Point, button: Button) -> anyhow::Result<()> {
        self.clicks(at, button, 2, &[])
    }

    /// Presses, moves in equal steps, releases.
    pub fn drag(
        &mut self,
        from: Point,
        to: Point,
        button: Button,
        steps: u32,
        modifiers: &[Modifier],
    ) -> anyhow::Result<()> {
        ensure!(steps > 0, "A drag without steps");
        self.hold(modifiers, |page| {
            page.mouse_move(from)?;
            page.press(from, button, modifiers)?;
            for step in 1..=steps {
                let share = f64::from(step) / f64::from(steps);
                let at = (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
                page.move_holding(at, button, modifiers)?;
            }
            page.release(to, button, modifiers)
        })
    }

    /// Presses, moves from point to point, releases.
    pub fn drag_along(
        &mut self,
        from: Point,
        path: &[Point],
        button: Button,
        modifiers: &[Modifier],
    ) -> anyhow::Result<()> {
        let last = *path.last().context("A drag without steps")?;
        self.hold(modifiers, |page| {
            page.mouse_move(from)?;
            page.press(from, button, modifiers)?;
            for at in path {
                page.move_holding(*at, button, modifiers)?;
            }
            page.release(last, button, modifiers)
        })
    }

    /// Turns the wheel over a point by so many notches, quickly; positive is up, away from the user.
    pub fn wheel(&mut self, at: Point, notches: i32, modifiers: &[Modifier]) -> anyhow::Result<()> {
        // Pixels a notch, down, as Chromium reports a wheel; one that is spun fast tells several notches at once.
        const NOTCH_PX: i32 = -100;
        const MOST_AT_ONCE: i32 = 10;
        let bits = bits(modifiers);
        self.hold(modifiers, |page| {
            page.mouse_move(at)?;
            let mut left = notches;
            while left != 0 {
                let now = left.clamp(-MOST_AT_ONCE, MOST_AT_ONCE);
                let delta = now * NOTCH_PX;
                page.send_mouse(
                    "mouseWheel",
                    at,
                    json!({ "deltaX": 0, "deltaY": delta, "modifiers": bits }),
                )?;
                left -= now;
            }
            page.next_frame()
        })
    }

    /// Presses and releases a key, named as in `KeyboardEvent.key`: `"a"`, `"5"`, `"Enter"`, `"ArrowLeft"`, `"F1"`.
    pub fn key(&mut self, key: &str, modifiers: &[Modifier]) -> anyhow::Result<()> {
        let bits = bits(modifiers);
        let types_text = modifiers.iter().all(|modifier| *modifier == Modifier::Shift);
        let shift = modifiers.contains(&Modifier::Shift);
        self.hold(modifiers, |page| {
            let mut fields = key_fields(key, shift)?;
            fields["modifiers"] = bits.into();
            if types_text && let Some(text) = text_of(&fields) {
                fields["text"] = text.into();
            }
            page.keyboard("keyDown", &fields)?;
            page.keyboard("keyUp", &fields)
        })
    }

    /// Presses a key and holds it, until `key_up`.
    pub fn key_down(&mut self, key: &str) -> anyhow::Result<()> {
        self.keyboard("rawKeyDown", &key_fields(key, false)?)
    }

    pub fn key_up(&mut self, key: &str) -> anyhow::Result<()> {
        self.keyboard("keyUp", &key_fields(key, false)?)
    }

    /// Types a text, a key after the other, quickly.
    pub fn type_text(&mut self, text: &str) -> anyhow::Result<()> {
        for letter in text.chars() {
            let shift = letter.is_ascii_uppercase();
            let mut fields = key_fields(&letter.to_string(), shift)?;
            fields["text"] = letter.to_string().into();
            fields["modifiers"] = if shift { Modifier::Shift.bit() } else { 0 }.into();
            for kind in ["keyDown", "keyUp"] {
                fields["type"] = kind.into();
                self.call("Input.dispatchKeyEvent", fields.clone())?;
            }
        }
        self.next_frame()
    }

    /// Presses a key so many times, quickly: the page may have had fewer frames meanwhile.
    pub fn keys(&mut self, key: &str, times: u32, modifiers: &[Modifier]) -> anyhow::Result<()> {
        if times == 0 {
            return Ok(());
        }
        let bits = bits(modifiers);
        self.hold(modifiers, |page| {
            let mut fields = key_fields(key, false)?;
            fields["modifiers"] = bits.into();
            for _ in 0..times {
                for kind in ["rawKeyDown", "keyUp"] {
                    fields["type"] = kind.into();
                    page.call("Input.dispatchKeyEvent", fields.clone())?;
                }
            }
            page.next_frame()
        })
    }

    fn clicks(
        &mut self,
        at: Point,
        button: Button,
        count: u32,
        modifiers: &[Modifier],
    ) -> anyhow::Result<()> {
        self.mouse_move(at)?;
        for number in 1..=count {
            self.send_mouse("mousePressed", at, button_fields(button, true, number, modifiers))?;
            self.send_mouse("mouseReleased", at, button_fields(button, false, number, modifiers))?;
        }
        self.next_frame()
    }

    fn move_holding(&mut self, to: Point, button: Button, modifiers: &[Modifier]) -> anyhow::Result<()> {
        let held = json!({ "button": button.name(), "buttons": button.bit(), "modifiers": bits(modifiers) });
        self.mouse("mouseMoved", to, held)
    }

    fn press(&mut self, at: Point, button: Button, modifiers: &[Modifier]) -> anyhow::Result<()> {
        self.mouse("mousePressed", at, button_fields(button, true, 1, modifiers))
    }

    fn release(&mut self, at: Point, button: Button, modifiers: &[Modifier]) -> anyhow::Result<()> {
        self.mouse("mouseReleased", at, button_fields(button, false, 1, modifiers))
    }

    fn mouse(&mut self, kind: &str, at: Point, fields: Value) -> anyhow::Result<()> {
        self.send_mouse(kind, at, fields)?;
        self.next_frame()
    }

    /// Sends an event to the page, which may not have had a frame to act on it when this returns.
    fn send_mouse(&mut self, kind: &str, (x, y): Point, mut fields: Value) -> anyhow::Result<()> {
        fields["type"] = kind.into();
        fields["x"] = x.into();
        fields["y"] = y.into();
        self.call("Input.dispatchMouseEvent", fields)?;
        Ok(())
    }

    fn keyboard(&mut self, kind: &str, fields: &Value) -> anyhow::Result<()> {
        let mut fields = fields.clone();
        fields["type"] = kind.into();
        self.call("Input.dispatchKeyEvent", fields)?;
        self.next_frame()
    }

    /// Holds the modifier keys down around an action, even if it fails.
    fn hold(
        &mut self,
        modifiers: &[Modifier],
        action: impl FnOnce(&mut Page) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        for (index, modifier) in modifiers.iter().enumerate() {
            let mut fields = key_fields(modifier.key(), false)?;
            fields["modifiers"] = bits(&modifiers[..=index]).into();
            self.keyboard("rawKeyDown", &fields)?;
        }
        let result = action(self);
        for (index, modifier) in modifiers.iter().enumerate().rev() {
            let mut fields = key_fields(modifier.key(), false)?;
            fields["modifiers"] = bits(&modifiers[..index]).into();
            self.keyboard("keyUp", &fields)?;
        }
        result
    }
}

/// What Chromium wants to know of a press (`down`) or a release; `count` is 2 for the second of a double click.
fn button_fields(button: Button, down: bool, count: u32, modifiers: &[Modifier]) -> Value {
    let held = if down { button.bit() } else { 0 };
    json!({ "button": button.name(), "buttons": held, "clickCount": count, "modifiers": bits(modifiers) })
}

fn bits(modifiers: &[Modifier]) -> u32 {
    modifiers.iter().fold(0, |sum, modifier| sum | modifier.bit())
}

/// What a key types: itself if it is one character, and a line break for Enter.
fn text_of(fields: &Value) -> Option<String> {
    let key = fields["key"].as_str()?;
    if key == "Enter" {
        return Some("\r".to_owned());
    }
    (key.chars().count() == 1).then(|| key.to_owned())
}

/// `key`, `code` and the Windows virtual key code that the browser's own events carry (US layout).
fn key_fields(name: &str, shift: bool) -> anyhow::Result<Value> {
    let (key, code, virtual_key) = match name.as_bytes() {
        [letter] if letter.is_ascii_alphabetic() => {
            let upper = letter.to_ascii_uppercase();
            let key = if shift { upper } else { letter.to_ascii_lowercase() };
            (char::from(key).to_string(), format!("Key{}", char::from(upper)), u32::from(upper))
        }
        [digit] if digit.is_ascii_digit() => (name.to_owned(), format!("Digit{name}"), u32::from(*digit)),
        [b'F', number @ ..] if !number.is_empty() => {
            let number: u32 = name[1..].parse().with_context(|| format!("There is no key {name}"))?;
            (name.to_owned(), name.to_owned(), 111 + number)
        }
        _ => {
            let (code, virtual_key) = named_key(name).with_context(|| format!("There is no key {name}"))?;
            (name.to_owned(), code.to_owned(), virtual_key)
        }
    };
    Ok(json!({ "key": key, "code": code, "windowsVirtualKeyCode": virtual_key }))
}

fn named_key(name: &str) -> Option<(&'static str, u32)> {
    Some(match name {
        "Backspace" => ("Backspace", 8),
        "Tab" => ("Tab", 9),
        "Enter" => ("Enter", 13),
        "Shift" => ("ShiftLeft", 16),
        "Control" => ("ControlLeft", 17),
        "Alt" => ("AltLeft", 18),
        "Escape" => ("Escape", 27),
        " " => ("Space", 32),
        "PageUp" => ("PageUp", 33),
        "PageDown" => ("PageDown", 34),
        "End" => ("End", 35),
        "Home" => ("Home", 36),
        "ArrowLeft" => ("ArrowLeft", 37),
        "ArrowUp" => ("ArrowUp", 38),
        "ArrowRight" => ("ArrowRight", 39),
        "ArrowDown" => ("ArrowDown", 40),
        "Delete" => ("Delete", 46),
        "=" | "+" => ("Equal", 187),
        "," => ("Comma", 188),
        "-" | "_" => ("Minus", 189),
        "." => ("Period", 190),
        "/" | "?" => ("Slash", 191),
        "[" => ("BracketLeft", 219),
        "]" => ("BracketRight", 221),
        _ => return None,
    })
}

//! The part of YAML that cameras and data sets are written in: nested mappings and lists by indentation, `[…]` and `{…}` over
//! several lines, plain and quoted scalars, comments, OpenCV's `%YAML:1.0` and tags. Anchors and block texts are refused.

use serde_json::{Map, Value};

use super::FormatError;

/// Files nest three deep.
const MAX_DEPTH: usize = 32;

/// The poses of Linemod's largest sequence take a quarter of it. A value takes up to sixteen times its text in memory.
const MAX_BYTES: usize = 16 << 20;

/// Reads a document as the JSON it could have been.
pub fn read_yaml(text: &str) -> Result<Value, FormatError> {
    if text.len() > MAX_BYTES {
        return Err(FormatError::TooMuchText { megabytes: MAX_BYTES >> 20 });
    }
    super::json::check_values(text.as_bytes(), b",[\n")?;
    let mut parser = Parser { lines: lines_of(text), next: 0 };
    let Some(first) = parser.peek() else { return Ok(Value::Null) };
    let indent = first.indent;
    let value = parser.block(indent, 0)?;
    match parser.peek() {
        None => Ok(value),
        Some(line) => Err(at(line.number, "an indentation that fits none above")),
    }
}

#[derive(Debug, Clone, Copy)]
struct Line<'a> {
    /// From 1.
    number: usize,
    indent: usize,
    text: &'a str,
}

fn at(line: usize, reason: impl ToString) -> FormatError {
    FormatError::at(format!("line {line}"), reason)
}

fn lines_of(text: &str) -> Vec<Line<'_>> {
    let lines = text.lines().enumerate().map(|(index, line)| {
        let text = without_comment(line).trim_end();
        let trimmed = text.trim_start();
        Line { number: index + 1, indent: text.len() - trimmed.len(), text: trimmed }
    });
    let says_something = |line: &Line<'_>| {
        !(line.text.is_empty() || line.text.starts_with('%') || matches!(line.text, "---" | "..."))
    };
    lines.filter(says_something).collect()
}

/// A `#` begins a comment at the start or after a space, outside quotes.
fn without_comment(line: &str) -> &str {
    if !line.contains('#') {
        return line;
    }
    let mut quote = None;
    let mut before = ' ';
    for (position, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') if before.is_whitespace() => return line.get(..position).unwrap_or(line),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), _) if open == c => quote = None,
            _ => {}
        }
        before = c;
    }
    line
}

struct Parser<'a> {
    lines: Vec<Line<'a>>,
    next: usize,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<Line<'a>> {
        self.lines.get(self.next).copied()
    }

    /// A mapping or a list whose lines begin at this column.
    fn block(&mut self, indent: usize, depth: usize) -> Result<Value, FormatError> {
        let Some(first) = self.peek() else { return Ok(Value::Null) };
        if depth > MAX_DEPTH {
            return Err(at(first.number, "nested too deeply"));
        }
        if is_item(first.text) {
            return self.list(indent, depth);
        }
        if key_and_value(first.text).is_some() {
            return self.mapping(indent, depth);
        }
        self.next += 1;
        self.inline(first.number, first.text)
    }

    fn list(&mut self, indent: usize, depth: usize) -> Result<Value, FormatError> {
        let mut items = Vec::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent && is_item(line.text)) {
            let rest = line.text.get(1..).unwrap_or_default();
            let item = rest.trim_start();
            if item.is_empty() {
                self.next += 1;
                items.push(self.nested(indent, depth)?);
                continue;
            }
            // What follows the dash is a block of its own, as far to the right as it begins.
            let column = indent + 1 + rest.len() - item.len();
            if let Some(line) = self.lines.get_mut(self.next) {
                (line.indent, line.text) = (column, item);
            }
            items.push(self.block(column, depth + 1)?);
        }
        Ok(Value::Array(items))
    }

    fn mapping(&mut self, indent: usize, depth: usize) -> Result<Value, FormatError> {
        let mut entries = Map::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent && !is_item(line.text)) {
            let (key, value) =
                key_and_value(line.text).ok_or_else(|| at(line.number, "\"key: value\" expected"))?;
            self.next += 1;
            let value = without_tag(value);
            let value = if value.is_empty() {
                self.value_below(indent, depth)?
            } else {
                self.inline(line.number, value)?
            };
            entries.insert(unquoted(key).to_owned(), value);
        }
        Ok(Value::Object(entries))
    }

    /// The value of a key that stands alone on its line. A list may begin in the key's own column.
    fn value_below(&mut self, indent: usize, depth: usize) -> Result<Value, FormatError> {
        match self.peek() {
            Some(line) if line.indent == indent && is_item(line.text) => self.list(indent, depth + 1),
            _ => self.nested(indent, depth),
        }
    }

    fn nested(&mut self, indent: usize, depth: usize) -> Result<Value, FormatError> {
        match self.peek() {
            Some(line) if line.indent > indent => self.block(line.indent, depth + 1),
            _ => Ok(Value::Null),
        }
    }

    /// A scalar, or a `[…]` or `{…}` that may go on in the lines below.
    fn inline(&mut self, number: usize, text: &'a str) -> Result<Value, FormatError> {
        let text = without_tag(text);
        match text.as_bytes().first() {
            Some(b'[' | b'{') => {}
            Some(b'&' | b'*' | b'|' | b'>') => {
                return Err(at(number, "anchors, references and block texts are not read"));
            }
            _ => return Ok(scalar(text)),
        }
        let mut whole = text.to_owned();
        let mut open = open_brackets(text);
        while open > 0 {
            let line = self.peek().ok_or_else(|| at(number, "a bracket that is never closed"))?;
            self.next += 1;
            open += open_brackets(line.text);
            whole.push(' ');
            whole.push_str(line.text);
        }
        let mut flow = Flow { rest: &whole, line: number };
        let value = flow.value(0)?;
        match flow.rest.trim() {
            "" => Ok(value),
            rest => Err(at(number, format!("nothing more expected, found \"{}\"", short(rest)))),
        }
    }
}

fn short(text: &str) -> String {
    text.chars().take(20).collect()
}

fn is_item(text: &str) -> bool {
    text == "-" || text.starts_with("- ")
}

/// A key ends at the first colon with a space or nothing after it.
fn key_and_value(text: &str) -> Option<(&str, &str)> {
    if text.starts_with(['[', '{']) {
        return None;
    }
    let quoted = text.chars().next().filter(|c| matches!(c, '"' | '\''));
    let from = match quoted {
        Some(quote) => text.get(1..)?.find(quote)? + 2,
        None => 0,
    };
    let colon =
        text.get(from..)?.match_indices(':').map(|(position, _)| from + position).find(|position| {
            text.get(position + 1..)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with(char::is_whitespace))
        })?;
    Some((text.get(..colon)?.trim_end(), text.get(colon + 1..)?.trim()))
}

/// `!!opencv-matrix` says nothing that the content does not.
fn without_tag(text: &str) -> &str {
    if !text.starts_with('!') {
        return text;
    }
    text.split_once(char::is_whitespace).map_or("", |(_, rest)| rest.trim_start())
}

/// How many more brackets a text opens than it closes, outside quotes.
fn open_brackets(text: &str) -> i64 {
    let mut quote = None;
    let mut open = 0;
    for c in text.chars() {
        match (quote, c) {
            (Some(mark), _) => quote = Some(mark).filter(|mark| *mark != c),
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => open += 1,
            (None, ']' | '}') => open -= 1,
            (None, _) => {}
        }
    }
    open
}

fn unquoted(text: &str) -> &str {
    let text = text.trim();
    for quote in ['"', '\''] {
        if let Some(inside) = text.strip_prefix(quote).and_then(|text| text.strip_suffix(quote)) {
            return inside;
        }
    }
    text
}

fn scalar(text: &str) -> Value {
    let text = text.trim();
    match text {
        "" | "~" | "null" => return Value::Null,
        "true" | "True" => return Value::Bool(true),
        "false" | "False" => return Value::Bool(false),
        _ => {}
    }
    if let Ok(whole) = text.parse::<i64>() {
        return Value::from(whole);
    }
    // Infinities and NaN stay words: no number of ours is one.
    match text.parse::<f64>().ok().and_then(serde_json::Number::from_f64) {
        Some(number) => Value::Number(number),
        None => Value::String(unquoted(text).to_owned()),
    }
}

/// What is left of a `[…]` or `{…}`.
struct Flow<'a> {
    rest: &'a str,
    line: usize,
}

impl Flow<'_> {
    fn value(&mut self, depth: usize) -> Result<Value, FormatError> {
        if depth > MAX_DEPTH {
            return Err(at(self.line, "nested too deeply"));
        }
        if self.takes('[') {
            let mut items = Vec::new();
            while !self.takes(']') {
                items.push(self.value(depth + 1)?);
                self.separator(']')?;
            }
            return Ok(Value::Array(items));
        }
        if self.takes('{') {
            let mut entries = Map::new();
            while !self.takes('}') {
                let key = unquoted(self.word(&[':'])).to_owned();
                if !self.takes(':') {
                    return Err(at(self.line, "\"key: value\" expected within {…}"));
                }
                entries.insert(key, self.value(depth + 1)?);
                self.separator('}')?;
            }
            return Ok(Value::Object(entries));
        }
        Ok(scalar(self.word(&[',', ']', '}'])))
    }

    fn takes(&mut self, wanted: char) -> bool {
        self.rest = self.rest.trim_start();
        let rest = self.rest.strip_prefix(wanted);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    /// A comma, unless the end is next.
    fn separator(&mut self, end: char) -> Result<(), FormatError> {
        if self.takes(',') || self.rest.starts_with(end) {
            return Ok(());
        }
        Err(at(self.line, format!("\",\" or \"{end}\" expected, found \"{}\"", short(self.rest))))
    }

    /// The text up to one of these, which a quoted one may hold.
    fn word(&mut self, ends: &[char]) -> &str {
        let text = self.rest.trim_start();
        let quoted = text.chars().next().filter(|c| matches!(c, '"' | '\''));
        let closing = quoted.and_then(|quote| text.get(1..)?.find(quote)).map(|position| position + 2);
        let end = closing.or_else(|| text.find(ends)).unwrap_or(text.len());
        let (word, rest) = text.split_at_checked(end).unwrap_or((text, ""));
        self.rest = rest;
        word.trim()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_data_sets_write_is_read() {
        let gt = "0:\n- cam_R_m2c: [0.1, -1.5e-2, 3.]\n  obj_id: 1\n- cam_R_m2c: [1, 2,\n    3]\n  obj_id: 2\n\n1:\n  - {obj_id: 3, name: 'a, b'}\n2: []\n";
        assert_eq!(
            read_yaml(gt).unwrap(),
            json!({
                "0": [{"cam_R_m2c": [0.1, -0.015, 3.0], "obj_id": 1}, {"cam_R_m2c": [1, 2, 3], "obj_id": 2}],
                "1": [{"obj_id": 3, "name": "a, b"}],
                "2": [],
            })
        );
        let opencv = "%YAML:1.0\n---\nname: \"a # b: c\" # a comment\nK: !!opencv-matrix\n   rows: 1\n   data: [ 1., 2.,\n       .5 ]\nempty:\n";
        assert_eq!(
            read_yaml(opencv).unwrap(),
            json!({"name": "a # b: c", "K": {"rows": 1, "data": [1.0, 2.0, 0.5]}, "empty": null})
        );
        assert_eq!(read_yaml("- - 1\n  - 2\n-\n  a: yes\n").unwrap(), json!([[1, 2], {"a": "yes"}]));
        assert_eq!(read_yaml("").unwrap(), Value::Null);
    }

    #[test]
    fn errors_say_the_line() {
        let message = |text: &str| read_yaml(text).unwrap_err().to_string();
        assert!(message("a: 1\nb: [1, 2\n").contains("line 2"));
        assert!(message("a: 1\n  b: 2\n").contains("line 2"));
        assert!(message("a: 1\nwhat\n").contains("line 2"));
        assert!(message("a: [1 2: 3]]").contains("nothing more"));
        assert!(message("a: &anchor\n  b: 1").contains("anchors"));
        assert!(message(&"- ".repeat(1000)).contains("deep"));
        assert!(message(&"[".repeat(1000)).contains("line 1"));
        let deep = format!("{}{}", "[".repeat(1000), "]".repeat(1000));
        assert!(message(&deep).contains("deep"));
    }
}

//! The part of Markdown that a study's texts may use, as plain blocks: headings, paragraphs, lists, pictures, and in them bold,
//! italic, code and links.

/// A block of text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Block {
    /// Level 1 to 3.
    Heading(u8, Vec<Span>),
    Paragraph(Vec<Span>),
    /// An entry of a list, with its bullet or number.
    Item(String, Vec<Span>),
    /// A picture on a line of its own: what it shows in words, and its name.
    Picture {
        alt: String,
        name: String,
    },
    Rule,
}

/// A piece of a line in one look.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Span {
    pub text: String,
    pub bold: bool,
    pub italic: bool,
    pub code: bool,
    /// Where it leads; only to the web.
    pub link: Option<String>,
}

pub fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut paragraph = String::new();
    for line in text.lines().map(str::trim) {
        match line_block(line) {
            Some(block) => {
                end_paragraph(&mut paragraph, &mut blocks);
                blocks.extend(block);
            }
            None => {
                if !paragraph.is_empty() {
                    paragraph.push(' ');
                }
                paragraph.push_str(line);
            }
        }
    }
    end_paragraph(&mut paragraph, &mut blocks);
    blocks
}

fn end_paragraph(paragraph: &mut String, blocks: &mut Vec<Block>) {
    if !paragraph.is_empty() {
        blocks.push(Block::Paragraph(spans(paragraph)));
        paragraph.clear();
    }
}

/// What a line is by itself; `Some(None)` for an empty one, `None` for one of a paragraph.
fn line_block(line: &str) -> Option<Option<Block>> {
    if line.is_empty() {
        return Some(None);
    }
    if line.len() >= 3 && line.chars().all(|c| c == '-') {
        return Some(Some(Block::Rule));
    }
    let hashes = line.chars().take_while(|c| *c == '#').count();
    if (1..=3).contains(&hashes)
        && let Some(heading) = line.get(hashes..).and_then(|rest| rest.strip_prefix(' '))
    {
        return Some(Some(Block::Heading(hashes as u8, spans(heading.trim()))));
    }
    if let Some(item) = line.strip_prefix("- ").or_else(|| line.strip_prefix("* ")) {
        return Some(Some(Block::Item("•".to_owned(), spans(item.trim()))));
    }
    if let Some((number, item)) = line.split_once(". ")
        && !number.is_empty()
        && number.len() <= 3
        && number.chars().all(|c| c.is_ascii_digit())
    {
        return Some(Some(Block::Item(format!("{number}."), spans(item.trim()))));
    }
    let inner = line.strip_prefix("![").and_then(|rest| rest.strip_suffix(')'));
    let picture = inner.and_then(|inner| inner.split_once("]("));
    picture.map(|(alt, name)| Some(Block::Picture { alt: alt.to_owned(), name: name.trim().to_owned() }))
}

fn spans(text: &str) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    let mut look = Span::default();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        if let Some((code, after)) = rest.strip_prefix('`').and_then(|rest| rest.split_once('`')) {
            flush(&mut look, &mut spans);
            spans.push(Span { text: code.to_owned(), code: true, ..look.clone() });
            rest = after;
        } else if let Some((words, target, after)) = link(rest) {
            flush(&mut look, &mut spans);
            spans.push(Span { text: words.to_owned(), link: Some(target.to_owned()), ..look.clone() });
            rest = after;
        } else if let Some(after) = mark(rest, "**", look.bold) {
            flush(&mut look, &mut spans);
            look.bold = !look.bold;
            rest = after;
        } else if let Some(after) = mark(rest, "*", look.italic) {
            flush(&mut look, &mut spans);
            look.italic = !look.italic;
            rest = after;
        } else {
            look.text.push(first);
            rest = rest.get(first.len_utf8()..).unwrap_or_default();
        }
    }
    flush(&mut look, &mut spans);
    spans
}

/// What follows a mark that begins something which ends, or ends what has begun; a lone star is a star.
fn mark<'a>(rest: &'a str, mark: &str, is_open: bool) -> Option<&'a str> {
    let after = rest.strip_prefix(mark)?;
    (is_open || (after.contains(mark) && !after.starts_with(' '))).then_some(after)
}

/// `[words](https://…)`: the words, the address, and what follows.
fn link(rest: &str) -> Option<(&str, &str, &str)> {
    let (words, after) = rest.strip_prefix('[')?.split_once("](")?;
    let (target, after) = after.split_once(')')?;
    let is_web = target.starts_with("https://") || target.starts_with("http://");
    (is_web && !words.contains('\n')).then_some((words, target, after))
}

fn flush(look: &mut Span, spans: &mut Vec<Span>) {
    if !look.text.is_empty() {
        spans.push(look.clone());
        look.text.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> Vec<Span> {
        vec![Span { text: text.to_owned(), ..Span::default() }]
    }

    #[test]
    fn blocks_are_told_by_their_first_signs() {
        let text = "# Title\none\ntwo\n\n- a\n2. b\n![a cup](cup.png)\n---\n#no heading\n3.5 mm";
        let expected = vec![
            Block::Heading(1, plain("Title")),
            Block::Paragraph(plain("one two")),
            Block::Item("•".to_owned(), plain("a")),
            Block::Item("2.".to_owned(), plain("b")),
            Block::Picture { alt: "a cup".to_owned(), name: "cup.png".to_owned() },
            Block::Rule,
            Block::Paragraph(plain("#no heading 3.5 mm")),
        ];
        assert_eq!(blocks(text), expected);
    }

    #[test]
    fn looks_begin_and_end_and_lone_signs_stay() {
        let [Block::Paragraph(spans)] = &blocks("a **b *c*** `d*` [e](https://f.org) 2 * 3 ü")[..] else {
            panic!()
        };
        let looks: Vec<(&str, bool, bool, bool, bool)> = spans
            .iter()
            .map(|span| (span.text.as_str(), span.bold, span.italic, span.code, span.link.is_some()))
            .collect();
        let expected = [
            ("a ", false, false, false, false),
            ("b ", true, false, false, false),
            ("c", true, true, false, false),
            (" ", false, false, false, false),
            ("d*", false, false, true, false),
            (" ", false, false, false, false),
            ("e", false, false, false, true),
            (" 2 * 3 ü", false, false, false, false),
        ];
        assert_eq!(looks, expected);
        assert_eq!(blocks("[x](javascript:alert(1))"), [Block::Paragraph(plain("[x](javascript:alert(1))"))]);
    }
}

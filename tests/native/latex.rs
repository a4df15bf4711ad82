//! Is a LaTeX table well-formed? There is no TeX here: environments, braces, escapes and columns are counted.

/// Panics with the line that TeX would stop at.
pub fn check_latex(name: &str, text: &str) {
    let mut open: Vec<String> = Vec::new();
    let mut columns = None;
    for line in text.lines().map(strip_comment) {
        assert!(is_balanced(line), "{name}: braces of {line}");
        for (at, _) in line.match_indices("\\begin{") {
            let environment = line[at + 7..].split('}').next().unwrap();
            open.push(environment.to_owned());
            if environment == "tabular" {
                let alignment = line.rsplit_once('{').unwrap().1.trim_end_matches('}');
                assert!(alignment.chars().all(|c| "lcr".contains(c)), "{name}: {alignment}");
                columns = Some(alignment.len());
            }
        }
        for (at, _) in line.match_indices("\\end{") {
            let environment = line[at + 5..].split('}').next().unwrap();
            assert_eq!(open.pop().as_deref(), Some(environment), "{name}: {line}");
        }
        assert!(unescaped(line, '$').count().is_multiple_of(2), "{name}: formulas of {line}");
        for sign in ['#', '%'] {
            assert_eq!(unescaped(line, sign).count(), 0, "{name}: {sign} in {line}");
        }
        for at in unescaped(line, '_').chain(unescaped(line, '^')) {
            // Only within a formula, or in the name of a label.
            let is_formula = unescaped(&line[..at], '$').count() % 2 == 1;
            assert!(is_formula || line.contains("\\label{"), "{name}: {line}");
        }
        if let Some(row) = line.trim_end().strip_suffix("\\\\") {
            let cells = unescaped(row, '&').count() + 1;
            assert_eq!(Some(cells), columns, "{name}: {row}");
        } else {
            assert_eq!(unescaped(line, '&').count(), 0, "{name}: {line}");
        }
    }
    assert!(open.is_empty() && columns.is_some(), "{name}: {open:?} is open");
}

fn strip_comment(line: &str) -> &str {
    if line.trim_start().starts_with('%') { "" } else { line }
}

/// Where a sign stands with no backslash before it.
fn unescaped(text: &str, sign: char) -> impl Iterator<Item = usize> + '_ {
    let found = text.match_indices(sign);
    found
        .map(|(at, _)| at)
        .filter(|at| text[..*at].chars().rev().take_while(|c| *c == '\\').count().is_multiple_of(2))
}

fn is_balanced(line: &str) -> bool {
    let mut depth = 0;
    for (at, c) in line.char_indices() {
        let is_escaped = text_before_is_backslash(line, at);
        match c {
            '{' if !is_escaped => depth += 1,
            '}' if !is_escaped => depth -= 1,
            _ => {}
        }
        if depth < 0 {
            return false;
        }
    }
    depth == 0
}

fn text_before_is_backslash(line: &str, at: usize) -> bool {
    line[..at].chars().rev().take_while(|c| *c == '\\').count() % 2 == 1
}

#[test]
fn what_tex_would_stop_at_is_found() {
    let table = |row: &str| {
        format!("\\begin{{table}}\n\\begin{{tabular}}{{lr}}\n{row}\n\\end{{tabular}}\n\\end{{table}}\n")
    };
    check_latex("good", &table("a \\& b \\% \\_ & $1 \\pm 2$ \\\\"));
    for bad in
        ["a & b & c \\\\", "a_b & c \\\\", "a # & c \\\\", "{a & b \\\\", "$a & b \\\\", "50 % & b \\\\"]
    {
        let text = table(bad);
        assert!(std::panic::catch_unwind(|| check_latex("bad", &text)).is_err(), "{bad}");
    }
}

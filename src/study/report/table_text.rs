//! Tables as CSV, LaTeX and HTML.

use super::table::{Cell, Table};

/// RFC 4180, with every digit of every number; units are in the names of the columns.
pub fn csv(table: &Table) -> String {
    let kinds: Vec<Kind> = (0..table.columns.len()).map(|at| kind_of(table, at)).collect();
    let heads = table.columns.iter().zip(&kinds).map(|(column, kind)| {
        let name = column_name(&column.heading());
        match kind {
            Kind::Single => name,
            Kind::Deviation => format!("{name},{name}_sd"),
            Kind::Interval => format!("{name}_low,{name}_high"),
        }
    });
    let mut text = heads.collect::<Vec<_>>().join(",") + "\n";
    for row in &table.rows {
        let cells = row.iter().zip(&kinds).map(|(cell, kind)| csv_cell(cell, *kind != Kind::Single));
        text += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// How many columns of a CSV one column of a table takes, and for what.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Single,
    Deviation,
    Interval,
}

fn kind_of(table: &Table, at: usize) -> Kind {
    let of_cell = |cell: &Cell| match cell {
        Cell::MeanAndDeviation(..) => Some(Kind::Deviation),
        Cell::Between(..) => Some(Kind::Interval),
        _ => None,
    };
    table.rows.iter().filter_map(|row| row.get(at)).find_map(of_cell).unwrap_or(Kind::Single)
}

fn csv_cell(cell: &Cell, is_double: bool) -> String {
    match cell {
        Cell::Missing if is_double => ",".to_owned(),
        Cell::Number(number) if is_double => format!("{number},"),
        Cell::Missing => String::new(),
        Cell::Text(text) => quoted(text),
        Cell::Count(count) => count.to_string(),
        Cell::Number(number) | Cell::Chance(number) => number.to_string(),
        Cell::MeanAndDeviation(a, b) | Cell::Between(a, b) => format!("{a},{b}"),
    }
}

/// "ADD of diameter (%)" as "add_of_diameter_percent".
fn column_name(heading: &str) -> String {
    let spelled = heading.replace('°', "deg").replace('%', "percent").to_lowercase();
    let words = spelled.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

fn quoted(text: &str) -> String {
    // A spreadsheet takes what begins like a formula for one.
    let text = if text.starts_with(['=', '+', '-', '@']) { format!("'{text}") } else { text.to_owned() };
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

/// A `table` environment for the package booktabs.
pub fn latex(table: &Table) -> String {
    let is_text = |at: usize| table.rows.iter().any(|row| matches!(row.get(at), Some(Cell::Text(_))));
    let alignment: String = (0..table.columns.len()).map(|at| if is_text(at) { 'l' } else { 'r' }).collect();
    let line = |cells: Vec<String>| format!("    {} \\\\\n", cells.join(" & "));
    let mut text = format!(
        "% Needs \\usepackage{{booktabs}}.\n\\begin{{table}}\n  \\centering\n  \\caption{{{}. {}}}\n  \
         \\label{{tab:{}}}\n  \\begin{{tabular}}{{{alignment}}}\n    \\toprule\n",
        latex_text(&table.title),
        latex_text(&table.note),
        table.name
    );
    text += &line(table.columns.iter().map(|column| latex_text(&column.heading())).collect());
    text += "    \\midrule\n";
    for row in &table.rows {
        let cells = row.iter().zip(&table.columns).map(|(cell, column)| match cell {
            Cell::Text(text) => latex_text(text),
            cell => {
                let number = cell.printed(column.decimals, " \\pm ", "--");
                let is_formula =
                    matches!(cell, Cell::MeanAndDeviation(..) | Cell::Between(..) | Cell::Chance(..))
                        || number.starts_with('-') && *cell != Cell::Missing;
                if is_formula { format!("${number}$") } else { number }
            }
        });
        text += &line(cells.collect());
    }
    text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n"
}

fn latex_text(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', c]),
            '\\' => out += "\\textbackslash{}",
            '~' => out += "\\textasciitilde{}",
            '^' => out += "\\textasciicircum{}",
            '<' => out += "\\textless{}",
            '>' => out += "\\textgreater{}",
            '°' => out += "$^\\circ$",
            '±' => out += "$\\pm$",
            '×' => out += "$\\times$",
            '−' => out += "$-$",
            '–' => out += "--",
            '≤' => out += "$\\le$",
            'Σ' => out += "$\\Sigma$",
            '½' => out += "$\\frac{1}{2}$",
            'Δ' => out += "$\\Delta$",
            '√' => out += "$\\surd$",
            // An empty line would end the paragraph that the table is in.
            c if c.is_control() => out.push(' '),
            other => out.push(other),
        }
    }
    out
}

/// A `figure` with the table and its rules.
pub fn html(table: &Table, number: usize) -> String {
    let mut text = format!(
        "<figure class=\"table\" id=\"{}\">\n<figcaption><b>Table {number}.</b> {}.</figcaption>\n<div class=\"scroll\"><table>\n\
         <thead><tr>",
        table.name,
        html_text(&table.title)
    );
    let is_text = |at: usize| table.rows.iter().any(|row| matches!(row.get(at), Some(Cell::Text(_))));
    let class = |at: usize| if is_text(at) { " class=\"text\"" } else { "" };
    for (at, column) in table.columns.iter().enumerate() {
        text += &format!("<th{}>{}</th>", class(at), html_text(&column.heading()));
    }
    text += "</tr></thead>\n<tbody>\n";
    for row in &table.rows {
        text += "<tr>";
        for (at, (cell, column)) in row.iter().zip(&table.columns).enumerate() {
            let printed = cell.printed(column.decimals, " ± ", "–").replace('-', "−");
            // A minus sign is for numbers: texts keep their hyphens.
            let printed = if let Cell::Text(text) = cell { text.clone() } else { printed };
            text += &format!("<td{}>{}</td>", class(at), html_text(&printed));
        }
        text += "</tr>\n";
    }
    text + &format!("</tbody></table></div>\n<p class=\"note\">{}.</p>\n</figure>\n", html_text(&table.note))
}

/// Text between tags or in a quoted attribute.
pub fn html_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::report::table::Column;

    fn table() -> Table {
        Table {
            name: "inter".to_owned(),
            title: "Errors, 90 %".to_owned(),
            note: "a < b".to_owned(),
            columns: vec![
                Column::plain("who"),
                Column::number("rotation", "deg", 2),
                Column::number("ADD of diameter", "%", 1),
            ],
            rows: vec![
                vec![Cell::text("a, \"b\" & <i>"), Cell::Missing, Cell::Number(-1.25)],
                vec![Cell::text("=1+1"), Cell::MeanAndDeviation(1.0 / 3.0, 2.0), Cell::Number(0.5)],
            ],
            is_raw: false,
        }
    }

    #[test]
    fn csv_keeps_every_digit_and_every_column() {
        assert_eq!(
            csv(&table()),
            "who,rotation_deg,rotation_deg_sd,add_of_diameter_percent\n\"a, \"\"b\"\" & <i>\",,,-1.25\n\
             '=1+1,0.3333333333333333,2,0.5\n"
        );
    }

    #[test]
    fn names_cannot_break_out_of_the_page_or_the_paper() {
        let html = html(&table(), 1);
        assert!(html.contains("a, &quot;b&quot; &amp; &lt;i&gt;") && !html.contains("<i>"));
        assert!(html.contains("<td>0.33 ± 2.00</td>") && html.contains("−1.2"));
        let latex = latex(&table());
        assert!(latex.contains("a, \"b\" \\& \\textless{}i\\textgreater{} & -- & $-1.2$ \\\\"));
        assert!(latex.contains("$0.33 \\pm 2.00$") && latex.contains("rotation ($^\\circ$)"));
    }
}

//! A table of a report, before it is written as CSV, LaTeX or HTML.

/// Rows of cells under named columns, with the rules that made them.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The stem of its file: letters, digits and `-`.
    pub name: String,
    pub title: String,
    /// How the numbers were made; printed beneath.
    pub note: String,
    pub columns: Vec<Column>,
    pub rows: Vec<Vec<Cell>>,
    /// Every number of a study: a file of its own, not on the page.
    pub is_raw: bool,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    pub name: String,
    /// Empty for texts and counts.
    pub unit: &'static str,
    /// Digits after the point where it is printed. CSV has all.
    pub decimals: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// There is nothing to be said, as of no numbers.
    Missing,
    Text(String),
    Count(usize),
    Number(f64),
    /// A test's p.
    Chance(f64),
    /// Two columns of a CSV.
    MeanAndDeviation(f64, f64),
    /// Two columns of a CSV.
    Between(f64, f64),
}

/// What stands on everything that is made of a program's results.
pub(super) const SIMULATED: &str = "Simulated participants";

impl Table {
    /// A table leaves its page, so it says itself what it is made of.
    pub(super) fn mark_simulated(&mut self) {
        self.note = format!("{SIMULATED}. {}", self.note);
    }
}

impl Column {
    /// Of texts or counts.
    pub fn plain(name: &str) -> Self {
        Self { name: name.to_owned(), unit: "", decimals: 0 }
    }

    pub fn number(name: &str, unit: &'static str, decimals: usize) -> Self {
        Self { name: name.to_owned(), unit, decimals }
    }

    /// "ADD (mm)".
    pub fn heading(&self) -> String {
        match self.unit {
            "" => self.name.clone(),
            "deg" => format!("{} (°)", self.name),
            unit => format!("{} ({unit})", self.name),
        }
    }
}

/// Below it, a p value is not printed digit by digit.
const LEAST_CHANCE: f64 = 0.0001;

impl Cell {
    pub fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    pub fn number(number: Option<f64>) -> Self {
        number.filter(|number| number.is_finite()).map_or(Self::Missing, Self::Number)
    }

    /// As it is shown to a reader.
    pub fn shown(&self, decimals: usize) -> String {
        self.printed(decimals, " ± ", "–")
    }

    /// "12.34 ± 5.60"; the reader's `plus_minus` and `dash` differ.
    pub(super) fn printed(&self, decimals: usize, plus_minus: &str, dash: &str) -> String {
        match self {
            Self::Missing => dash.to_owned(),
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(number) => fixed(*number, decimals),
            Self::Chance(p) if *p < LEAST_CHANCE => format!("< {LEAST_CHANCE}"),
            Self::Chance(p) => fixed(*p, decimals),
            Self::MeanAndDeviation(mean, deviation) => {
                format!("{}{plus_minus}{}", fixed(*mean, decimals), fixed(*deviation, decimals))
            }
            Self::Between(low, high) => format!("[{}, {}]", fixed(*low, decimals), fixed(*high, decimals)),
        }
    }
}

/// Without a minus before a zero.
fn fixed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_printed_as_papers_do() {
        let print = |cell: &Cell| cell.printed(2, " ± ", "–");
        assert_eq!(print(&Cell::MeanAndDeviation(4.768, 2.8449)), "4.77 ± 2.84");
        assert_eq!(print(&Cell::Between(-0.001, 1.0)), "[0.00, 1.00]");
        assert_eq!(print(&Cell::number(Some(f64::NAN))), "–");
        assert_eq!(print(&Cell::Number(-1.5)), "-1.50");
        assert_eq!([print(&Cell::Chance(1e-9)), print(&Cell::Chance(0.25))], ["< 0.0001", "0.25"]);
        assert_eq!(Column::number("rotation", "deg", 2).heading(), "rotation (°)");
    }
}

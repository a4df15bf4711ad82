//! BOP's results: `scene_id,im_id,obj_id,score,R,t,time`, R and t with spaces between their numbers.

use crate::formats::gather::{Found, Gather};
use crate::formats::{FileKey, FormatError, Incoming};
use crate::math::sort_short;

/// BOP's targets are some ten thousand images, of each of which a method gives a few estimates.
const MAX_ROWS: usize = 500_000;

/// Does a text begin as results do: with their header, or with a row of them?
pub fn is_results_csv(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default().trim_start_matches('\u{feff}');
    is_header(first) || Row::read(first).is_ok()
}

fn is_header(line: &str) -> bool {
    line.replace([' ', '"'], "").starts_with("scene_id,im_id,obj_id")
}

/// One estimate.
#[derive(Debug, Clone)]
struct Row {
    scene: u32,
    image: u32,
    object: u32,
    score: f64,
    rotation: [f64; 9],
    translation_mm: [f64; 3],
}

impl Row {
    fn read(line: &str) -> Result<Self, String> {
        let mut columns = line.split(',').map(|column| column.trim().trim_matches('"'));
        let mut next = |name: &str| columns.next().ok_or_else(|| format!("{name} missing"));
        Ok(Self {
            scene: number(next("scene_id")?, "scene_id")?,
            image: number(next("im_id")?, "im_id")?,
            object: number(next("obj_id")?, "obj_id")?,
            score: number(next("score")?, "score")?,
            rotation: numbers(next("R")?, "R")?,
            translation_mm: numbers(next("t")?, "t")?,
        })
    }
}

fn number<T: std::str::FromStr>(text: &str, name: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{name} \"{}\" is not a number", short(text)))
}

fn numbers<const N: usize>(text: &str, name: &str) -> Result<[f64; N], String> {
    let mut values = [0.0; N];
    let mut words = text.split_ascii_whitespace();
    for value in &mut values {
        let word = words.next().ok_or_else(|| format!("{name} has fewer than {N} numbers"))?;
        *value = number(word, name)?;
    }
    if words.next().is_some() { Err(format!("{name} has more than {N} numbers")) } else { Ok(values) }
}

fn short(text: &str) -> String {
    text.chars().take(20).collect()
}

/// Reads estimates. Those of one object in one photo come best first, whatever their order in the file.
pub fn read_results(file_name: &str, text: &str) -> Result<Incoming, FormatError> {
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').trim();
        if line.is_empty() || (index == 0 && is_header(line)) {
            continue;
        }
        let place = format!("line {}", index + 1);
        let row = Row::read(line).map_err(|reason| {
            FormatError::at(&place, format!("{reason}; scene_id,im_id,obj_id,score,R,t,time expected"))
        })?;
        if rows.len() == MAX_ROWS {
            return Err(FormatError::at(place, format!("more than {MAX_ROWS} poses")));
        }
        rows.push((index + 1, row));
    }
    sort_short(&mut rows, |(_, a), (_, b)| {
        let place = |row: &Row| (row.scene, row.image, row.object);
        place(a).cmp(&place(b)).then(b.score.total_cmp(&a.score))
    });
    let mut gather = Gather::new(file_name);
    for (line, row) in &rows {
        let photo = gather.photo(FileKey::BopImage { scene: Some(row.scene), image: row.image });
        let found = Found {
            photo,
            object: FileKey::BopObject(row.object),
            rotation: &row.rotation,
            translation_mm: row.translation_mm,
            score: Some(row.score),
        };
        gather.pose(found, || format!("line {line}"));
    }
    gather.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = "scene_id,im_id,obj_id,score,R,t,time\n\
        2,764,5,0.25,1 0 0 0 1 0 0 0 1,1 2 600,-1\n\
        2,764,5,0.75,0 -1 0 1 0 0 0 0 1,3 4 700.5,0.1\n";

    #[test]
    fn the_best_comes_first_with_its_score() {
        let incoming = read_results("method_lmo-test.csv", TWO).unwrap();
        assert_eq!(incoming.photos[0].key, FileKey::BopImage { scene: Some(2), image: 764 });
        let scores: Vec<_> = incoming.photos[0].poses.iter().map(|pose| (pose.object, pose.score)).collect();
        assert_eq!(scores, [(0, Some(0.75)), (1, Some(0.25))]);
        assert_eq!(incoming.photos[0].poses[0].camera_from_object.translation_mm.z, 700.5);
        assert!(is_results_csv(TWO) && is_results_csv(TWO.lines().nth(1).unwrap()));
        assert!(!is_results_csv("name,x,y\n"));
    }

    #[test]
    fn broken_rows_say_their_line() {
        let message = |text: &str| read_results("r.csv", text).unwrap_err().to_string();
        assert!(message(&TWO.replace(",1 2 600", ",1 2")).contains("line 2: t has fewer than 3"));
        assert!(
            message(&TWO.replace("1 0 0 0 1 0 0 0 1", "1 0 0 0 1 0 0 0 1 5")).contains("R has more than 9")
        );
        assert!(message(&TWO.replace("2,764,5,0.25", "2,seven,5,0.25")).contains("im_id \"seven\""));
        assert!(message("scene_id,im_id,obj_id\n1,2\n").contains("obj_id missing"));
    }
}

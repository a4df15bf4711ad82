//! A scene's file: lines of a word and its value, an empty line, and the document.

use std::collections::BTreeMap;
use std::io;

use crate::platform::storage::SceneHeading;

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    pub heading: SceneHeading,
    pub assets: Vec<AssetLine>,
    /// Each with the key of the asset that it belongs to.
    pub companions: Vec<(String, AssetLine)>,
    pub json: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct AssetLine {
    pub key: String,
    pub bytes: u64,
    pub file_name: String,
}

impl Record {
    /// Stands in a list for one that cannot be read.
    pub fn of_damaged(id: &str) -> Self {
        let heading = SceneHeading { name: format!("Damaged scene ({id})"), ..SceneHeading::default() };
        Self { heading, ..Self::default() }
    }

    /// With its photos and meshes.
    pub fn bytes(&self) -> u64 {
        let bytes: BTreeMap<&String, u64> = self.files().map(|file| (&file.key, file.bytes)).collect();
        self.json.len() as u64 + bytes.values().sum::<u64>()
    }

    /// All files, some more than once.
    pub fn files(&self) -> impl Iterator<Item = &AssetLine> {
        self.assets.iter().chain(self.companions.iter().map(|(_, file)| file))
    }

    pub fn to_text(&self) -> String {
        let SceneHeading { name, subject, changed_at_ms, photo_count, object_count } = &self.heading;
        let (name, subject) = (one_line(name), one_line(subject));
        let mut text = format!(
            "name {name}\nsubject {subject}\nchanged_at_ms {changed_at_ms}\nphotos {photo_count}\nobjects {object_count}\n"
        );
        for asset in &self.assets {
            text += &format!("asset {}\n", asset.to_text());
        }
        for (of, file) in &self.companions {
            text += &format!("companion {of} {}\n", file.to_text());
        }
        text + "\n" + &self.json
    }

    pub fn from_text(text: &str) -> io::Result<Self> {
        let (lines, json) =
            text.split_once("\n\n").ok_or_else(|| damaged("its heading is not followed by an empty line"))?;
        let mut record = Self { json: json.to_owned(), ..Self::default() };
        for line in lines.lines() {
            let (word, value) = line.split_once(' ').unwrap_or((line, ""));
            record.take_line(word, value).ok_or_else(|| damaged(line))?;
        }
        Ok(record)
    }

    /// `None` where the value is not what the word stands for.
    fn take_line(&mut self, word: &str, value: &str) -> Option<()> {
        let heading = &mut self.heading;
        match word {
            "name" => value.clone_into(&mut heading.name),
            "subject" => value.clone_into(&mut heading.subject),
            "changed_at_ms" => heading.changed_at_ms = value.parse().ok()?,
            "photos" => heading.photo_count = value.parse().ok()?,
            "objects" => heading.object_count = value.parse().ok()?,
            "asset" => self.assets.push(AssetLine::from_text(value)?),
            "companion" => {
                let (of, file) = value.split_once(' ')?;
                self.companions.push((of.to_owned(), AssetLine::from_text(file)?));
            }
            // A later version may say more.
            _ => {}
        }
        Some(())
    }
}

impl AssetLine {
    fn to_text(&self) -> String {
        format!("{} {} {}", self.key, self.bytes, one_line(&self.file_name))
    }

    fn from_text(text: &str) -> Option<Self> {
        let (key, rest) = text.split_once(' ')?;
        let (bytes, file_name) = rest.split_once(' ')?;
        Some(Self { key: key.to_owned(), bytes: bytes.parse().ok()?, file_name: file_name.to_owned() })
    }
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

fn damaged(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("a scene's file is damaged: {what}"))
}

//! Photos of kinds that the browser reads and this program does not, kept as PNG: so they are read again wherever they are
//! opened later.

use super::{Arrival, Loading};
use crate::photo::{MAX_PIXELS, foreign_kind};
use crate::platform::{self, FileBytes};
use crate::scene::file_stem;

impl Loading {
    /// Starts a load once its pictures are of kinds that are read.
    pub(super) fn receive(&mut self, arrival: Arrival) {
        let is_foreign = |file: &FileBytes| foreign_kind(&file.bytes).is_some();
        if arrival.converted.is_some() || !arrival.files.iter().flatten().any(is_foreign) {
            return self.start(arrival);
        }
        let arrive = self.begin_reading();
        platform::spawn(async move { arrive(converted(arrival).await) });
    }
}

async fn converted(mut arrival: Arrival) -> Arrival {
    let mut notes = Vec::new();
    for entry in &mut arrival.files {
        let Ok(file) = entry else { continue };
        let Some(kind) = foreign_kind(&file.bytes) else { continue };
        match platform::png_of_foreign(kind, &file.bytes, MAX_PIXELS).await {
            Ok(Some(png)) => {
                let name = format!("{}.png", file_stem(&file.name));
                notes.push(format!("{}: read by the browser and kept as {name}", file.name));
                *file = FileBytes { name, bytes: png };
            }
            // Whoever decodes it says in words that it is not read.
            Ok(None) => {}
            Err(problem) => *entry = Err(format!("{}: {problem}", file.name)),
        }
    }
    arrival.converted = Some(notes);
    arrival
}

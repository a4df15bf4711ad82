//! `pinpose convert IN… OUT`: any files that can be read to any that can be written.

use std::path::PathBuf;

use super::{Failure, Outcome, open};
use crate::formats::{Keep, write_document, write_workspace};

pub fn run(mut parser: lexopt::Parser) -> Outcome {
    let mut paths: Vec<PathBuf> = Vec::new();
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Value(path) => paths.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    let Some(out) = paths.pop().filter(|_| !paths.is_empty()) else {
        return Err(Failure::Usage("convert needs at least one input and an output".to_owned()));
    };
    let extension = out.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if !matches!(extension, "json" | "zip") {
        return Err(Failure::Usage(format!(
            "{}: the output is .json (poses) or .zip (workspace)",
            out.display()
        )));
    }
    let session = open::open_session(&paths)?;
    let bytes = match extension {
        "json" => write_document(&session.document(Keep::Annotated)).into_bytes(),
        _ => write_workspace(&session.document(Keep::Everything), session.scene())
            .map_err(|error| Failure::Input(vec![error.to_string()]))?,
    };
    std::fs::write(&out, bytes).map_err(|error| Failure::Input(vec![format!("{}: {error}", out.display())]))
}

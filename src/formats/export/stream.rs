//! A zip that is written piece by piece: what is handed out need not be kept.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

use crate::formats::{FormatError, NamedFile};

/// Takes files and gives the archive's bytes, in order.
pub struct ZipStream {
    writer: ZipWriter<StreamWriter<Outbox>>,
    outbox: Outbox,
}

/// What was written and not yet fetched.
#[derive(Clone, Default)]
struct Outbox(Arc<Mutex<Vec<u8>>>);

impl ZipStream {
    pub fn new() -> Self {
        let outbox = Outbox::default();
        Self { writer: ZipWriter::new_stream(outbox.clone()), outbox }
    }

    /// Adds a file; returns the bytes of the archive that follow those before. Pictures are compressed already and are
    /// stored as they are.
    pub fn add(&mut self, file: &NamedFile) -> Result<Vec<u8>, FormatError> {
        let is_packed = [".png", ".jpg", ".jpeg"].iter().any(|extension| file.name.ends_with(extension));
        let method = if is_packed { CompressionMethod::Stored } else { CompressionMethod::Deflated };
        let options = SimpleFileOptions::default().compression_method(method);
        self.writer.start_file(file.name.as_str(), options).map_err(archive)?;
        self.writer.write_all(&file.bytes).map_err(|error| FormatError::Archive(error.to_string()))?;
        Ok(self.outbox.take())
    }

    /// The archive's directory; without it nothing can be opened.
    pub fn finish(self) -> Result<Vec<u8>, FormatError> {
        self.writer.finish().map_err(archive)?;
        Ok(self.outbox.take())
    }
}

impl Default for ZipStream {
    fn default() -> Self {
        Self::new()
    }
}

impl std::fmt::Debug for ZipStream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ZipStream").finish_non_exhaustive()
    }
}

fn archive(error: zip::result::ZipError) -> FormatError {
    FormatError::Archive(error.to_string())
}

impl Outbox {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Outbox {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Read};

    use super::*;

    #[test]
    fn the_pieces_together_are_an_archive() {
        let file = |name: &str, bytes: Vec<u8>| NamedFile { name: name.to_owned(), bytes: Arc::from(bytes) };
        let files = [
            file("a/poses.csv", vec![b'x'; 100_000]),
            file("b.png", (0..=255).collect()),
            file("empty", Vec::new()),
        ];
        let mut stream = ZipStream::new();
        let mut bytes = Vec::new();
        for file in &files {
            bytes.extend(stream.add(file).unwrap());
        }
        bytes.extend(stream.finish().unwrap());
        assert!(bytes.len() < 10_000, "text is compressed");
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        assert_eq!(archive.len(), 3);
        for file in &files {
            let mut content = Vec::new();
            archive.by_name(&file.name).unwrap().read_to_end(&mut content).unwrap();
            assert_eq!(content, *file.bytes, "{}", file.name);
        }
    }
}

//! A zip as a folder: its files by name, each unpacked when it is asked for, within bounds.

use std::io::{Cursor, Read};
use std::sync::Arc;

use zip::ZipArchive;

use super::FormatError;
use super::dataset::Listing;

/// One file of it may not unpack to more: photos have at most 50 megapixels, and meshes that are larger load from a folder.
const MAX_FILE_BYTES: u64 = 512 << 20;
/// All that is unpacked in the life of one archive.
const MAX_ALL_BYTES: u64 = 4 << 30;
/// A file that grows by more than this, and to more than a mask that is all black, is a trap.
const MAX_RATIO: u64 = 200;
const HARMLESS_BYTES: u64 = 64 << 20;
/// More files are no scene that somebody annotates.
const MAX_FILES: usize = 1_000_000;

/// An open zip.
pub struct Archive {
    zip: ZipArchive<Cursor<Arc<[u8]>>>,
    bytes_left: u64,
}

impl Archive {
    pub fn open(bytes: Arc<[u8]>) -> Result<Self, FormatError> {
        let packed_bytes = bytes.len() as u64;
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
        if zip.len() > MAX_FILES {
            return Err(FormatError::Archive(format!("it has more than {MAX_FILES} files")));
        }
        // Files are read again and again, but not a small archive into all of the memory.
        let most = packed_bytes.saturating_mul(MAX_RATIO).clamp(2 * HARMLESS_BYTES, MAX_ALL_BYTES);
        Ok(Self { zip, bytes_left: most })
    }

    /// Is it one that this program saved?
    pub fn is_workspace(&self) -> bool {
        self.zip.index_for_name("scene.json").is_some()
    }

    /// Its files by their declared sizes. A name that leads out of the archive is refused: whoever made it means harm.
    pub fn listing(&mut self, name: &str) -> Result<Listing, FormatError> {
        let mut files = Vec::with_capacity(self.zip.len());
        for index in 0..self.zip.len() {
            let entry = self.zip.by_index_raw(index).map_err(damaged)?;
            if entry.is_dir() {
                continue;
            }
            let path = entry.name().map_err(damaged)?.replace('\\', "/");
            if path.starts_with('/') || path.split('/').any(|part| part == "..") {
                return Err(FormatError::Archive(format!("\"{path}\" leads out of it")));
            }
            files.push((path, entry.size()));
        }
        Listing::new(name, files)
    }

    /// Unpacks one file by the path that the listing has for it.
    pub fn read(&mut self, path: &str) -> Result<Arc<[u8]>, FormatError> {
        let at = |reason: String| FormatError::Archive(format!("{path}: {reason}"));
        let index = self.index_of(path).ok_or_else(|| at("it is not there".to_owned()))?;
        let entry = self.zip.by_index(index).map_err(|error| at(error.to_string()))?;
        let (packed, declared) = (entry.compressed_size(), entry.size());
        let most = packed.saturating_mul(MAX_RATIO).clamp(HARMLESS_BYTES, MAX_FILE_BYTES);
        if declared > most {
            return Err(at(format!("{packed} bytes would unpack to {declared}, which is not done")));
        }
        let allowed = declared.min(self.bytes_left);
        let mut content = Vec::with_capacity(allowed.min(HARMLESS_BYTES) as usize);
        // The declared size may lie; what is read cannot.
        let read = entry.take(allowed + 1).read_to_end(&mut content);
        let length = read.map_err(|error| at(error.to_string()))? as u64;
        if length > allowed && allowed < declared {
            return Err(FormatError::Archive(
                "all that was read of it is too much for what it is".to_owned(),
            ));
        }
        if length != declared {
            return Err(at(format!("{declared} bytes announced, but not what is there")));
        }
        self.bytes_left -= length;
        Ok(content.into())
    }

    /// Some zips have `\` between names; a listing has `/`.
    fn index_of(&self, path: &str) -> Option<usize> {
        let as_listed = self.zip.index_for_name(path);
        as_listed.or_else(|| self.zip.index_for_name(&path.replace('/', "\\")))
    }
}

fn damaged(error: zip::result::ZipError) -> FormatError {
    FormatError::Archive(error.to_string())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    use super::*;

    fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let packed = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        for (name, content) in files {
            writer.start_file(*name, packed).unwrap();
            writer.write_all(content).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    fn open(bytes: Vec<u8>) -> Result<Archive, FormatError> {
        Archive::open(bytes.into())
    }

    #[test]
    fn files_are_listed_and_read_one_by_one() {
        let mut archive = open(zipped(&[("lm/a.txt", b"hello"), ("lm/b/c.png", b"png")])).unwrap();
        let listing = archive.listing("lm.zip").unwrap();
        assert_eq!(listing.paths().collect::<Vec<_>>(), ["lm/a.txt", "lm/b/c.png"]);
        assert_eq!(listing.size_of("lm/a.txt"), Some(5));
        assert_eq!(&*archive.read("lm/a.txt").unwrap(), b"hello");
        assert_eq!(&*archive.read("lm/a.txt").unwrap(), b"hello", "as often as wanted");
        assert!(archive.read("lm/none").unwrap_err().to_string().contains("lm/none: it is not there"));
        assert!(!archive.is_workspace());
    }

    #[test]
    fn bombs_and_ways_out_are_refused() {
        let zeros = vec![0; HARMLESS_BYTES as usize + 1];
        let mut bomb = open(zipped(&[("zeros", &zeros)])).unwrap();
        assert!(bomb.read("zeros").unwrap_err().to_string().contains("would unpack to"));
        let mut climber = open(zipped(&[("a/../../b", b"x")])).unwrap();
        assert!(climber.listing("z").unwrap_err().to_string().contains("leads out"));

        // A size that lies in the central directory and in the file's own header.
        let mut liar = zipped(&[("five", b"hello")]);
        let size = 5_u32.to_le_bytes();
        let lie = 4_u32.to_le_bytes();
        for position in 0..liar.len() - 4 {
            if liar[position..position + 4] == size {
                liar[position..position + 4].copy_from_slice(&lie);
            }
        }
        if let Ok(mut archive) = open(liar) {
            assert!(archive.read("five").is_err());
        }
    }

    #[test]
    fn every_truncation_is_an_error_or_bounded() {
        let whole = zipped(&[("a", &[7; 1000]), ("b/c", &[9; 3000])]);
        for length in 0..whole.len() {
            let Ok(mut archive) = open(whole[..length].to_vec()) else { continue };
            let Ok(listing) = archive.listing("z") else { continue };
            for path in listing.paths() {
                // What matters is that it returns.
                let _ = archive.read(path);
            }
        }
    }
}

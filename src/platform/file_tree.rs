//! A folder from outside: its files by name and size, each read when it is asked for.

use std::pin::Pin;
use std::rc::Rc;

/// What is read of one file; an error is a sentence without the file's name.
pub type FileFuture = Pin<Box<dyn Future<Output = Result<Vec<u8>, String>>>>;

/// A folder that was picked or dropped.
pub trait FileTree {
    fn name(&self) -> &str;

    /// Paths inside the folder, with `/` between their names, and sizes in bytes; 0 where a size is not known.
    fn files(&self) -> Vec<(String, u64)>;

    /// Reads the file at one of these paths.
    fn read(&self, path: &str) -> FileFuture;
}

/// How far a folder is on its way in.
#[derive(Clone)]
pub enum FolderEvent {
    /// So many files were found so far.
    Listing(usize),
    Listed(Rc<dyn FileTree>),
    /// A sentence.
    Failed(String),
}

/// Whether a listing goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GoOn {
    Yes,
    No,
}

//! What is kept between visits: one document, and the files that it speaks of.

use std::cell::RefCell;
use std::pin::Pin;
use std::sync::Arc;

/// A saved scene.
#[derive(Debug, Clone, Default)]
pub struct Saved {
    pub json: String,
    pub assets: Vec<SavedAsset>,
}

#[derive(Debug, Clone)]
pub struct SavedAsset {
    /// The SHA-256 of the content: the same content is stored once.
    pub key: String,
    pub file_name: String,
    pub bytes: Arc<[u8]>,
}

/// Errors are sentences for the user.
pub type StorageFuture<T> = Pin<Box<dyn Future<Output = Result<T, String>>>>;

/// Saving is all or nothing: whatever interrupts it, the next start finds the new scene or the one before.
pub trait Storage {
    fn load(&self) -> StorageFuture<Option<Saved>>;

    /// Replaces what is saved; files that are there already are not written again, files that are no longer needed go.
    fn save(&self, saved: Saved) -> StorageFuture<()>;
}

/// Storage for tests.
#[derive(Debug, Default)]
pub struct MemoryStorage {
    saved: RefCell<Option<Saved>>,
}

impl Storage for MemoryStorage {
    fn load(&self) -> StorageFuture<Option<Saved>> {
        let saved = self.saved.borrow().clone();
        Box::pin(async { Ok(saved) })
    }

    fn save(&self, saved: Saved) -> StorageFuture<()> {
        self.saved.replace(Some(saved));
        Box::pin(async { Ok(()) })
    }
}

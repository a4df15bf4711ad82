//! What is kept between visits: scenes by id, and the photos and meshes that they speak of, each stored once for all.

use std::collections::BTreeSet;
use std::fmt;
use std::pin::Pin;
use std::rc::Rc;
use std::sync::Arc;

/// Names one scene in a store; never shown.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SceneId(Rc<str>);

impl SceneId {
    pub fn new(id: &str) -> Self {
        Self(Rc::from(id))
    }

    /// Where `?example` keeps its scene: trying it never touches anybody's work.
    pub fn example() -> Self {
        Self::new("example")
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for SceneId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What a list of scenes says about one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneHeading {
    /// What the user called it; empty where the user did not.
    pub name: String,
    /// Its first photo or object: what it is called as long as it has no name.
    pub subject: String,
    /// Milliseconds since 1970, UTC. Tells one saved state of the scene from another, too.
    pub changed_at_ms: f64,
    pub photo_count: u32,
    pub object_count: u32,
}

impl SceneHeading {
    /// What the scene is called.
    pub fn title(&self) -> &str {
        match (self.name.as_str(), self.subject.as_str()) {
            ("", "") => "Unnamed scene",
            ("", subject) => subject,
            (name, _) => name,
        }
    }
}

/// One scene of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSummary {
    pub id: SceneId,
    pub heading: SceneHeading,
    /// With its photos and meshes, also where other scenes need them too.
    pub bytes: u64,
}

/// A scene as it is saved.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Saved {
    pub heading: SceneHeading,
    pub json: String,
    pub assets: Vec<SavedAsset>,
    pub companions: Vec<SavedCompanion>,
}

/// What is stored of a scene, in whatever state it is: for who cannot open it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Remains {
    pub json: Option<String>,
    pub assets: Vec<SavedAsset>,
    pub companions: Vec<SavedCompanion>,
    /// Records that are not what they should be, by a name for each, as text.
    pub unreadable: Vec<(String, String)>,
}

impl From<Saved> for Remains {
    fn from(saved: Saved) -> Self {
        let Saved { json, assets, companions, .. } = saved;
        Self { json: Some(json), assets, companions, unreadable: Vec::new() }
    }
}

/// A file that an asset asks for: a mesh's texture. Its content is stored as an asset's is.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedCompanion {
    /// The key of the asset that it belongs to.
    pub of: String,
    pub file: SavedAsset,
}

impl Saved {
    pub fn bytes(&self) -> u64 {
        self.json.len() as u64 + self.files().map(|file| file.bytes.len() as u64).sum::<u64>()
    }

    /// Assets and companions, each content once.
    pub fn files(&self) -> impl Iterator<Item = &SavedAsset> {
        let companions = self.companions.iter().map(|companion| &companion.file);
        let mut seen = BTreeSet::new();
        self.assets.iter().chain(companions).filter(move |file| seen.insert(&file.key))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct SavedAsset {
    /// The SHA-256 of the content: the same content is stored once.
    pub key: String,
    pub file_name: String,
    pub bytes: Arc<[u8]>,
}

/// The assets, each content once: a mesh may be in a scene several times.
pub fn distinct(assets: &[SavedAsset]) -> impl Iterator<Item = &SavedAsset> {
    assets
        .iter()
        .enumerate()
        .filter(|(index, asset)| assets[..*index].iter().all(|earlier| earlier.key != asset.key))
        .map(|(_, asset)| asset)
}

/// A document that was put aside in a hurry, when the page was about to go; its photos and meshes are in the store.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// As in [`SceneHeading::changed_at_ms`]: a journal that is older than the stored scene is of no use.
    pub changed_at_ms: f64,
    pub json: String,
}

impl Journal {
    /// More than this is not put aside: a browser gives this kind of storage 5 MB in all.
    pub const MAX_BYTES: usize = 4 << 20;

    pub(super) fn to_text(&self) -> String {
        format!("{}\n{}", self.changed_at_ms, self.json)
    }

    pub(super) fn from_text(text: &str) -> Option<Self> {
        let (time, json) = text.split_once('\n')?;
        Some(Self { changed_at_ms: time.parse().ok()?, json: json.to_owned() })
    }
}

/// On which terms a scene is saved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SaveTerms {
    /// The `changed_at_ms` of what this program last read or wrote there: work that another window has saved since is not
    /// written over. `None` writes in any case.
    pub last_seen_ms: Option<f64>,
    /// The next start opens this scene.
    pub opens_next: bool,
}

/// How a save ended, if it did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SaveOutcome {
    Saved,
    /// Nothing was written: the stored scene is another one than this program last saw.
    ChangedElsewhere,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StorageUse {
    pub used_bytes: u64,
    /// `None` where there is no limit but the disk's.
    pub quota_bytes: Option<u64>,
}

/// Errors are sentences for the user.
pub type StorageFuture<T> = Pin<Box<dyn Future<Output = Result<T, String>>>>;

/// Saving is all or nothing: whatever interrupts it, the next start finds the new scene or the one before.
pub trait Storage {
    /// All scenes, the one that was changed last first.
    fn list(&self) -> StorageFuture<Vec<SceneSummary>>;

    /// Files that are missing, or cannot be read, are left out.
    fn load(&self, id: &SceneId) -> StorageFuture<Option<Saved>>;

    /// All that is there of a scene, also where [`Self::load`] fails.
    fn remains(&self, id: &SceneId) -> StorageFuture<Remains> {
        let loading = self.load(id);
        Box::pin(async { Ok(loading.await?.map(Remains::from).unwrap_or_default()) })
    }

    /// Replaces what is saved; files that are there already are not written again, files that no scene needs go.
    fn save(&self, id: &SceneId, saved: Saved, terms: SaveTerms) -> StorageFuture<SaveOutcome>;

    /// Makes this program the one that writes a scene, until it claims another one or ends. False: another window has it.
    fn claim(&self, id: &SceneId) -> StorageFuture<bool>;

    fn rename(&self, id: &SceneId, name: &str) -> StorageFuture<()>;

    /// A second scene with the same content.
    fn duplicate(&self, id: &SceneId, copy: &SceneId, name: &str) -> StorageFuture<()>;

    fn delete(&self, id: &SceneId) -> StorageFuture<()>;

    /// The scene to start with.
    fn last_open(&self) -> StorageFuture<Option<SceneId>>;

    fn set_last_open(&self, id: &SceneId) -> StorageFuture<()>;

    fn usage(&self) -> StorageFuture<StorageUse>;

    /// Asks that what is stored be kept when room gets scarce; worth asking once there is something.
    fn ask_to_persist(&self) -> StorageFuture<()> {
        Box::pin(async { Ok(()) })
    }

    /// At once, while the page goes. Nobody is left who could be told of an error.
    fn write_journal(&self, id: &SceneId, journal: &Journal);

    fn read_journal(&self, id: &SceneId) -> Option<Journal>;

    fn remove_journal(&self, id: &SceneId);
}

/// The one changed last first; of two that changed together, by id, so that the order stays.
pub fn sort_scenes(scenes: &mut [SceneSummary]) {
    scenes.sort_by(|a, b| {
        b.heading.changed_at_ms.total_cmp(&a.heading.changed_at_ms).then_with(|| a.id.cmp(&b.id))
    });
}

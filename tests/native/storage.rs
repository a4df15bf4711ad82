//! Stores of scenes: in memory and in a folder, which have to do the same.

use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

use pinpose::platform::{
    FolderStorage, Journal, MemoryStorage, SaveOutcome, SaveTerms, Saved, SavedAsset, SavedCompanion,
    SceneHeading, SceneId, Storage, StorageFuture, keep_preferences_in_memory, read_preference,
    write_preference,
};

fn now<T>(future: StorageFuture<T>) -> T {
    pollster::block_on(future).unwrap()
}

fn id(text: &str) -> SceneId {
    SceneId::new(text)
}

fn asset(key: &str, bytes: &[u8]) -> SavedAsset {
    SavedAsset { key: key.to_owned(), file_name: format!("{key} of mine.png"), bytes: Arc::from(bytes) }
}

fn saved(name: &str, changed_at_ms: f64, assets: &[SavedAsset]) -> Saved {
    let heading = SceneHeading {
        name: name.to_owned(),
        subject: "photo".to_owned(),
        changed_at_ms,
        photo_count: 3,
        object_count: 2,
    };
    Saved {
        heading,
        json: format!("{{\n\n\"of\": \"{name}\"}}"),
        assets: assets.to_vec(),
        companions: Vec::new(),
    }
}

/// A folder that is gone when the test is over.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("pinpose-{}-{name}", std::process::id()));
        std::fs::remove_dir_all(&folder).ok();
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

fn titles(storage: &dyn Storage) -> Vec<String> {
    now(storage.list()).iter().map(|scene| scene.heading.title().to_owned()).collect()
}

/// Runs a test on both kinds of store.
fn on_both(name: &str, test: impl Fn(&dyn Storage)) {
    test(&MemoryStorage::default());
    let folder = Folder::new(name);
    test(&FolderStorage::new(folder.0.clone()));
}

#[test]
fn scenes_come_back_as_they_were_saved() {
    on_both("back", |storage| {
        assert_eq!(now(storage.list()), []);
        assert_eq!(now(storage.load(&id("a"))), None);
        assert_eq!(now(storage.last_open()), None);
        let bench = saved("Lab bench", 1000.5, &[asset("aa", b"photo"), asset("bb", b"mesh")]);
        let table = saved("", 2000.0, &[asset("aa", b"photo")]);
        assert_eq!(now(storage.save(&id("a"), bench.clone(), SaveTerms::default())), SaveOutcome::Saved);
        assert_eq!(now(storage.save(&id("b"), table.clone(), SaveTerms::default())), SaveOutcome::Saved);
        assert_eq!(now(storage.load(&id("a"))), Some(bench.clone()));
        assert_eq!(now(storage.load(&id("b"))), Some(table));
        // The newest first; a scene without a name is called by what is in it.
        assert_eq!(titles(storage), ["photo", "Lab bench"]);
        assert_eq!(now(storage.list())[1].bytes, bench.bytes());
        now(storage.set_last_open(&id("a")));
        assert_eq!(now(storage.last_open()), Some(id("a")));
    });
}

#[test]
fn scenes_are_renamed_copied_and_deleted() {
    on_both("rename", |storage| {
        let bench = saved("Lab bench", 1000.0, &[asset("aa", b"photo")]);
        now(storage.save(&id("a"), bench.clone(), SaveTerms::default()));
        now(storage.rename(&id("a"), "Lab\nbench 2"));
        now(storage.duplicate(&id("a"), &id("b"), "Copy"));
        assert_eq!(now(storage.load(&id("b"))).unwrap().assets, bench.assets);
        assert_eq!(now(storage.load(&id("b"))).unwrap().json, bench.json);
        now(storage.delete(&id("a")));
        assert_eq!(titles(storage), ["Copy"]);
        // The photo of the copy is still there.
        assert_eq!(now(storage.load(&id("b"))).unwrap().assets, bench.assets);
        // What is not there can be renamed, copied and deleted without harm.
        now(storage.rename(&id("gone"), "x"));
        now(storage.duplicate(&id("gone"), &id("c"), "x"));
        now(storage.delete(&id("gone")));
        assert_eq!(titles(storage), ["Copy"]);
    });
}

#[test]
fn assets_are_stored_once_and_go_with_the_last_scene_that_needs_them() {
    let folder = Folder::new("assets");
    let storage = FolderStorage::new(folder.0.clone());
    let count = || std::fs::read_dir(folder.0.join("assets")).unwrap().count();
    let memory = Rc::new(MemoryStorage::default());
    let expect = |expected: usize| assert_eq!((count(), memory.asset_count()), (expected, expected));
    let save = |text: &str, saved: Saved, expected: usize| {
        now(storage.save(&id(text), saved.clone(), SaveTerms::default()));
        now(memory.save(&id(text), saved, SaveTerms::default()));
        expect(expected);
    };
    let delete = |text: &str, expected: usize| {
        now(storage.delete(&id(text)));
        now(memory.delete(&id(text)));
        expect(expected);
    };
    let (photo, mesh) = (asset("aa", b"photo"), asset("bb", b"mesh"));
    // A mesh that is in the scene twice is stored once.
    save("a", saved("A", 1.0, &[photo.clone(), mesh.clone(), mesh]), 2);
    save("b", saved("B", 2.0, std::slice::from_ref(&photo)), 2);
    // Saved without its mesh, which nobody else has.
    save("a", saved("A", 3.0, &[photo]), 1);
    delete("a", 1);
    delete("b", 0);
    assert_eq!(now(storage.usage()).used_bytes, 0);
}

#[test]
fn textures_come_back_with_their_meshes() {
    on_both("textures", |storage| {
        let texture = |of: &str, bytes: &[u8]| SavedCompanion {
            of: of.to_owned(),
            file: SavedAsset {
                file_name: "wood.png".to_owned(),
                ..asset(&format!("texture{}", bytes.len()), bytes)
            },
        };
        // Two meshes with textures of one name, and a third that shares the first one's.
        let companions = vec![texture("aa", b"oak"), texture("bb", b"beech"), texture("cc", b"oak")];
        let assets = ["aa", "bb", "cc"].map(|key| asset(key, key.as_bytes()));
        let mut chairs = Saved { companions, ..saved("Chairs", 1.0, &assets) };
        now(storage.save(&id("a"), chairs.clone(), SaveTerms::default()));
        now(storage.duplicate(&id("a"), &id("b"), "Chairs"));
        assert_eq!(now(storage.load(&id("b"))), Some(chairs.clone()));
        assert_eq!(now(storage.list())[0].bytes, chairs.bytes());
        now(storage.delete(&id("a")));
        assert_eq!(now(storage.load(&id("b"))), Some(chairs.clone()));
        let all = now(storage.usage()).used_bytes;
        chairs.companions.clear();
        now(storage.save(&id("b"), chairs, SaveTerms::default()));
        assert!(now(storage.usage()).used_bytes <= all - 8, "the textures are still there");
    });
}

/// What this window saw last, before the other one saved.
const SEEN: SaveTerms = SaveTerms { last_seen_ms: Some(1000.0), opens_next: false };

#[test]
fn the_save_itself_says_what_opens_next() {
    on_both("next", |storage| {
        let terms = SaveTerms { opens_next: true, ..SaveTerms::default() };
        now(storage.save(&id("a"), saved("work", 1.0, &[]), terms));
        now(storage.save(&id("b"), saved("example", 2.0, &[]), SaveTerms::default()));
        assert_eq!(now(storage.last_open()), Some(id("a")));
    });
}

#[test]
fn what_another_window_has_saved_is_not_written_over() {
    on_both("other", |storage| {
        now(storage.save(&id("a"), saved("mine", 1000.0, &[]), SaveTerms::default()));
        now(storage.save(&id("a"), saved("theirs", 1500.0, &[]), SEEN));
        let outcome = now(storage.save(&id("a"), saved("mine", 2000.0, &[]), SEEN));
        assert_eq!(outcome, SaveOutcome::ChangedElsewhere);
        assert_eq!(titles(storage), ["theirs"]);
        // A scene that was deleted there is work here.
        now(storage.delete(&id("a")));
        let outcome = now(storage.save(&id("a"), saved("mine", 2000.0, &[]), SEEN));
        assert_eq!(outcome, SaveOutcome::Saved);
    });
}

#[test]
fn one_program_writes_a_scene() {
    let folder = std::env::temp_dir().join(format!("pinpose-claims-{}", std::process::id()));
    let [mine, theirs] = [(); 2].map(|()| FolderStorage::new(folder.clone()));
    assert!(now(mine.claim(&id("a"))) && now(mine.claim(&id("a"))), "asking twice changes nothing");
    assert!(!now(theirs.claim(&id("a"))));
    assert!(now(theirs.claim(&id("b"))), "another scene is free");
    assert!(now(mine.claim(&id("c"))));
    assert!(now(theirs.claim(&id("a"))), "whoever goes to another scene gives the first one back");
    drop(mine);
    assert!(now(theirs.claim(&id("c"))), "and so does whoever ends");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_journal_is_kept_by_scene_and_goes_with_it() {
    on_both("journal", |storage| {
        let journal = Journal { changed_at_ms: 1_700_000_000_000.125, json: "{\n}".to_owned() };
        now(storage.save(&id("a"), saved("A", 1.0, &[]), SaveTerms::default()));
        storage.write_journal(&id("a"), &journal);
        assert_eq!(storage.read_journal(&id("a")), Some(journal));
        assert_eq!(storage.read_journal(&id("b")), None);
        now(storage.delete(&id("a")));
        assert_eq!(storage.read_journal(&id("a")), None);
    });
}

#[test]
fn a_damaged_file_is_told_in_words_and_a_foreign_name_stays_in_the_folder() {
    let folder = Folder::new("damaged");
    let storage = FolderStorage::new(folder.0.join("store"));
    now(storage.save(&id("../escaped"), saved("A", 1.0, &[]), SaveTerms::default()));
    assert!(folder.0.join("store/scenes").read_dir().unwrap().count() == 1);
    assert!(!folder.0.join("escaped.scene").exists());
    std::fs::write(folder.0.join("store/scenes/b.scene"), "photos many\n\n{}").unwrap();
    let error = pollster::block_on(storage.load(&id("b"))).unwrap_err();
    assert!(
        error.starts_with("the saved scene cannot be read: ") && error.contains("photos many"),
        "{error}"
    );
}

#[test]
fn preferences_are_apart_from_scenes() {
    keep_preferences_in_memory();
    assert_eq!(read_preference("theme"), None);
    write_preference("theme", "light");
    assert_eq!(read_preference("theme").as_deref(), Some("light"));
}

#[test]
fn a_damaged_scene_is_no_trouble_for_the_others() {
    let folder = Folder::new("damaged");
    let storage = FolderStorage::new(folder.0.clone());
    let bench = saved("Lab bench", 1000.0, &[asset("aa", b"photo"), asset("bb", b"mesh")]);
    let table = saved("Table", 2000.0, &[asset("cc", b"photo 2")]);
    now(storage.save(&id("a"), bench.clone(), SaveTerms::default()));
    now(storage.save(&id("b"), table.clone(), SaveTerms::default()));
    std::fs::write(folder.0.join("scenes/b.scene"), "changed_at_ms yesterday").unwrap();
    assert_eq!(titles(&storage), ["Lab bench", "Damaged scene (b)"]);
    assert_eq!(now(storage.load(&id("a"))), Some(bench.clone()));
    let error = pollster::block_on(storage.load(&id("b"))).unwrap_err();
    assert!(error.contains("cannot be read"), "{error}");
    assert_eq!(now(storage.remains(&id("b"))).unreadable[0].1, "changed_at_ms yesterday");
    // What it may need is not removed.
    now(storage.save(&id("a"), saved("Lab bench", 1000.0, &[asset("aa", b"photo")]), SaveTerms::default()));
    assert!(folder.0.join("assets/cc").exists() && folder.0.join("assets/bb").exists());
    now(storage.delete(&id("b")));
    assert!(!folder.0.join("assets/cc").exists() && !folder.0.join("assets/bb").exists());

    // A file that is missing is left out, and one that was cut is written again.
    now(storage.save(&id("a"), bench.clone(), SaveTerms::default()));
    std::fs::write(folder.0.join("assets/aa"), b"ph").unwrap();
    std::fs::remove_file(folder.0.join("assets/bb")).unwrap();
    assert_eq!(now(storage.load(&id("a"))).unwrap().assets, [asset("aa", b"ph")]);
    now(storage.save(&id("a"), bench.clone(), SaveTerms::default()));
    assert_eq!(now(storage.load(&id("a"))), Some(bench));
}

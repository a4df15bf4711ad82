//! Small settings of this user, apart from scenes: theme, keys, units.

use std::cell::RefCell;
use std::collections::BTreeMap;

#[cfg(not(target_arch = "wasm32"))]
use super::native::{read_stored_preference, write_stored_preference};
#[cfg(target_arch = "wasm32")]
use super::web::{read_stored_preference, write_stored_preference};

thread_local! {
    static IN_MEMORY: RefCell<Option<BTreeMap<String, String>>> = const { RefCell::new(None) };
}

/// For tests: from now on, this thread's preferences are none of the user's.
pub fn keep_preferences_in_memory() {
    IN_MEMORY.with_borrow_mut(|memory| *memory = Some(BTreeMap::new()));
}

/// What was last written under this key.
pub fn read_preference(key: &str) -> Option<String> {
    let from_memory = IN_MEMORY.with_borrow(|memory| memory.as_ref().map(|memory| memory.get(key).cloned()));
    from_memory.unwrap_or_else(|| read_stored_preference(key))
}

/// Where a preference cannot be kept, that is for the log alone: it is no work that could be lost.
pub fn write_preference(key: &str, value: &str) {
    let in_memory = IN_MEMORY.with_borrow_mut(|memory| {
        memory.as_mut().map(|memory| memory.insert(key.to_owned(), value.to_owned())).is_some()
    });
    if !in_memory {
        write_stored_preference(key, value);
    }
}

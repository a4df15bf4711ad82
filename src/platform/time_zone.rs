//! How far the user's clock is from UTC.

/// Minutes to add to UTC for the time on the user's wall now.
#[cfg(target_arch = "wasm32")]
pub fn utc_offset_minutes() -> i32 {
    // The browser counts the other way.
    -(js_sys::Date::new_0().get_timezone_offset() as i32)
}

/// A native program has no simple way to know: it shows UTC.
#[cfg(not(target_arch = "wasm32"))]
pub fn utc_offset_minutes() -> i32 {
    0
}

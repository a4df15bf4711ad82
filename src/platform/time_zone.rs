//! How far the user's clock is from UTC.

/// Minutes to add to UTC for the time on the user's wall now. A native program has no simple way to know: 0 there.
pub fn utc_offset_minutes() -> i32 {
    #[cfg(target_arch = "wasm32")]
    {
        -js_sys::Date::new_0().get_timezone_offset() as i32
    }
    #[cfg(not(target_arch = "wasm32"))]
    0
}

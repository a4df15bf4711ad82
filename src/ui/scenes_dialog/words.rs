//! Counts, times and sizes as a person says them.

use crate::platform::StorageUse;

pub fn counts_text(photos: u32, objects: u32) -> String {
    format!("{}, {}", counted(photos, "photo"), counted(objects, "object"))
}

fn counted(count: u32, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

/// How long ago something was; both times in milliseconds since 1970.
pub fn when_text(then_ms: f64, now_ms: f64) -> String {
    let minutes = ((now_ms - then_ms) / 60_000.0).max(0.0) as u64;
    let ago = |count: u64, unit: &str| {
        let plural = if count == 1 { "" } else { "s" };
        format!("{count} {unit}{plural} ago")
    };
    match (minutes, minutes / 60, minutes / (60 * 24)) {
        (0, ..) => "just now".to_owned(),
        (minutes, 0, _) => ago(minutes, "minute"),
        (_, hours, 0) => ago(hours, "hour"),
        (_, _, 1) => "yesterday".to_owned(),
        (_, _, days @ 2..=59) => ago(days, "day"),
        (_, _, days @ 60..=729) => ago(days / 30, "month"),
        (_, _, days) => ago(days / 365, "year"),
    }
}

/// Decimal units, as browsers and file managers have them.
pub fn size_text(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        _ if bytes < 1e3 => format!("{bytes} B"),
        _ if bytes < 1e6 => format!("{:.0} kB", bytes / 1e3),
        _ if bytes < 1e8 => format!("{:.1} MB", bytes / 1e6),
        _ if bytes < 1e9 => format!("{:.0} MB", bytes / 1e6),
        _ => format!("{:.1} GB", bytes / 1e9),
    }
}

pub fn usage_text(usage: StorageUse) -> String {
    let used = size_text(usage.used_bytes);
    match usage.quota_bytes {
        Some(quota) => format!("{used} stored of the {} that this browser allows", size_text(quota)),
        None => format!("{used} stored"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_sizes_in_words() {
        let minute = 60_000.0;
        let cases = [
            (0.0, "just now"),
            (-5.0, "just now"),
            (1.0, "1 minute ago"),
            (59.0, "59 minutes ago"),
            (60.0, "1 hour ago"),
            (24.0 * 60.0, "yesterday"),
            (59.0 * 24.0 * 60.0, "59 days ago"),
            (60.0 * 24.0 * 60.0, "2 months ago"),
            (800.0 * 24.0 * 60.0, "2 years ago"),
        ];
        for (minutes, words) in cases {
            assert_eq!(when_text(0.0, minutes * minute), words);
        }
        assert_eq!(size_text(999), "999 B");
        assert_eq!(size_text(4_240_000), "4.2 MB");
        assert_eq!(counts_text(1, 2), "1 photo, 2 objects");
    }
}

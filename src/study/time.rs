//! Times as files have them.

/// Milliseconds since 1970 (UTC) as RFC 3339 with milliseconds: `2026-11-22T19:02:46.250Z`.
///
/// Source of the calendar: Hinnant, *chrono-Compatible Low-Level Date Algorithms*, `civil_from_days`.
pub fn rfc3339(ms: f64) -> String {
    // Before 1970 and after 9999 no computer's clock is right.
    let ms = ms.clamp(0.0, 253_402_300_799_999.0) as u64;
    let (days, in_day_ms) = (ms / 86_400_000, ms % 86_400_000);
    let (year, month, day) = civil(days);
    let seconds = in_day_ms / 1000;
    format!(
        "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}.{:03}Z",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60,
        in_day_ms % 1000
    )
}

/// The same as a part of a file's name: no colons, for Windows has none.
pub fn file_time(ms: f64) -> String {
    let text = rfc3339(ms);
    let (date, time) = text.split_once('T').unwrap_or((&text, ""));
    let digits = |text: &str| -> String { text.chars().filter(char::is_ascii_digit).collect() };
    let time: String = digits(time).chars().take(6).collect();
    format!("{}T{time}Z", digits(date))
}

/// Year, month and day of a day since 1970-01-01. Years begin in March there, so that the leap day is the last.
fn civil(days: u64) -> (u64, u64, u64) {
    let days = days + 719_468;
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (year_of_era + era * 400 + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_times() {
        assert_eq!(rfc3339(0.0), "1970-01-01T00:00:00.000Z");
        assert_eq!(rfc3339(951_782_400_000.0), "2000-02-29T00:00:00.000Z");
        assert_eq!(rfc3339(1_078_099_199_999.0), "2004-02-29T23:59:59.999Z");
        assert_eq!(rfc3339(1_795_374_166_250.0), "2026-11-22T19:02:46.250Z");
        assert_eq!(rfc3339(f64::NAN), "1970-01-01T00:00:00.000Z");
        assert_eq!(file_time(1_795_374_166_250.0), "20261122T190246Z");
    }
}

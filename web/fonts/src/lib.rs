//! The interface's fonts, under the names that egui looks for.

/// For words. A cut of Ubuntu Light; its licence is `fonts/UFL.txt`.
pub const UBUNTU_LIGHT: &[u8] = include_bytes!("../fonts/Ubuntu-Light.ttf");

/// For numbers in columns. A cut of Hack; its licence is `fonts/Hack-Regular.txt`.
pub const HACK_REGULAR: &[u8] = include_bytes!("../fonts/Hack-Regular.ttf");

/// egui's few logos, as they come with it.
pub const EGUI_ICONS: &[u8] = include_bytes!("../fonts/egui-icons.ttf");

pub mod special_emojis {
    pub const OS_LINUX: char = '🐧';
    pub const OS_WINDOWS: char = '\u{E61F}';
    pub const OS_ANDROID: char = '\u{E618}';
    pub const OS_APPLE: char = '\u{F8FF}';
    pub const GITHUB: char = '\u{E624}';
    pub const GIT: char = '\u{E625}';
}

//! What the app remembers between runs besides the setup.

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Light, dark or as the system has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThemeChoice {
    /// Light.
    Light,
    /// Dark.
    Dark,
    /// As the system.
    #[default]
    System,
}

impl ThemeChoice {
    /// Every choice, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Light, Self::Dark, Self::System];

    /// Its name in the menu.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Light => "Light",
            Self::Dark => "Dark",
            Self::System => "As the system",
        }
    }
}

/// What the wave on the plate is drawn from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum WavePicture {
    /// The 2-D sheet where it runs live, else the modal lines.
    #[default]
    Automatic,
    /// The modal lines.
    Lines,
    /// The 2-D sheet wherever it is possible at all.
    Sheet,
}

impl WavePicture {
    /// Every choice, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Automatic, Self::Lines, Self::Sheet];

    /// Its name in the menu.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Automatic => "Wave: automatic",
            Self::Lines => "Wave: modal lines",
            Self::Sheet => "Wave: 2-D sheet if possible",
        }
    }
}

/// Files the app remembers having opened.
const RECENT: usize = 8;

/// What the app remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light, dark or as the system.
    pub theme: ThemeChoice,
    /// What the wave is drawn from.
    pub wave: WavePicture,
    /// The port used last, as its name is written on the command line.
    pub port: Option<String>,
    /// Whether a lost device is looked for.
    pub auto_reconnect: bool,
    /// Whether a new table goes to a real device by itself, too.
    pub auto_upload: bool,
    /// Files opened or saved, newest first.
    pub recent: Vec<PathBuf>,
    /// Whether the boundary has been dragged once, so that the hint is no longer needed.
    pub has_dragged: bool,
    /// Whether the wave is drawn moving; not kept, so that a start always shows it.
    #[serde(skip, default = "moving")]
    pub animate: bool,
}

const fn moving() -> bool {
    true
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::System,
            wave: WavePicture::Automatic,
            port: None,
            auto_reconnect: true,
            auto_upload: false,
            recent: Vec::new(),
            has_dragged: false,
            animate: true,
        }
    }
}

impl Settings {
    /// Puts a file at the top of the recent ones.
    pub fn used(&mut self, path: &Path) {
        self.recent.retain(|other| other != path);
        self.recent.insert(0, path.to_owned());
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_files_are_few_newest_first_and_named_once() {
        let mut settings = Settings::default();
        for i in 0..20 {
            settings.used(Path::new(&format!("{i}.toml")));
        }
        settings.used(Path::new("15.toml"));
        assert_eq!(settings.recent.len(), RECENT);
        assert_eq!(settings.recent[0], Path::new("15.toml"));
        assert_eq!(settings.recent.iter().filter(|path| path.as_path() == Path::new("15.toml")).count(), 1);
    }
}

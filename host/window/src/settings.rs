//! What the app remembers between runs besides the setup.

use serde::{Deserialize, Serialize};
use slipline_model::field::sheet::SourceChoice;
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

/// Files the app remembers having opened.
const RECENT: usize = 8;

/// What the app remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light, dark or as the system.
    pub theme: ThemeChoice,
    /// What the wave is drawn from.
    pub wave: SourceChoice,
    /// Whether the plate is coloured by how far it moves at most, not by where it is now.
    pub show_amplitude: bool,
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
            wave: SourceChoice::Automatic,
            show_amplitude: false,
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
    /// The settings as text that [`Settings::read`] reads back.
    #[must_use]
    pub fn write(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// Settings from such text. What is missing, unknown or written by a version that knows more words costs no more
    /// than its own field: that one is as in [`Settings::default`].
    #[must_use]
    pub fn read(text: &str) -> Self {
        let fields: toml::Table = text.parse().unwrap_or_default();
        fields.into_iter().fold(Self::default(), |settings, (field, value)| {
            let mut with_field = toml::Table::try_from(&settings).unwrap_or_default();
            with_field.insert(field, value);
            with_field.try_into().unwrap_or(settings)
        })
    }

    /// Puts a file at the top of the recent ones.
    pub fn used(&mut self, path: &Path) {
        // A path that is no text could not be written, and nothing else with it.
        if path.to_str().is_none() {
            return;
        }
        self.recent.retain(|other| other != path);
        self.recent.insert(0, path.to_owned());
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uncommon() -> Settings {
        Settings {
            theme: ThemeChoice::Dark,
            wave: SourceChoice::Sheet,
            show_amplitude: true,
            port: Some("unix:/run/it.sock".to_owned()),
            auto_reconnect: false,
            auto_upload: true,
            recent: vec!["/a/b.toml".into(), "c.toml".into()],
            has_dragged: true,
            animate: true,
        }
    }

    #[test]
    fn settings_are_read_as_they_were_written() {
        for settings in [uncommon(), Settings::default()] {
            assert_eq!(Settings::read(&settings.write()), settings);
        }
        assert_eq!(Settings::read("no settings"), Settings::default());
    }

    #[test]
    fn a_field_that_is_not_understood_costs_no_other() {
        let text = uncommon().write();
        for (from, to, wanted) in [
            ("\"Dark\"", "\"Sepia\"", Settings { theme: ThemeChoice::System, ..uncommon() }),
            ("auto_reconnect = false", "auto_reconnect = 7", Settings { auto_reconnect: true, ..uncommon() }),
            ("auto_reconnect = false\n", "", Settings { auto_reconnect: true, ..uncommon() }),
            ("has_dragged", "zoom = 2\nhas_dragged", uncommon()),
        ] {
            assert!(text.contains(from), "{text}");
            assert_eq!(Settings::read(&text.replacen(from, to, 1)), wanted, "{to}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_no_text_keeps_nothing_from_being_written() {
        use std::os::unix::ffi::OsStrExt as _;
        let mut settings = uncommon();
        settings.used(Path::new(std::ffi::OsStr::from_bytes(b"/\xff.toml")));
        assert_eq!(Settings::read(&settings.write()), uncommon());
    }

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

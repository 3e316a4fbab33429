//! The settings that the app keeps between runs, besides the setup.

use serde::{Deserialize, Serialize};
use slipline_model::field::sheet::SourceChoice;
use std::path::{Path, PathBuf};

/// The theme: light, dark or the system's.
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

/// A part of the window beside the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// The panel at the right.
    #[default]
    Panel,
    /// The row of plots, meters and log.
    Plots,
}

/// The speeds of the wave, as multiples of its usual one.
pub const SPEEDS: std::ops::RangeInclusive<f64> = 0.05..=4.0;

/// Most files in the list of recent files.
const RECENT: usize = 8;
/// Most boards in the list of those that are armed without a brown-out level.
const UNGUARDED: usize = 64;

/// The settings that the app keeps between runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light, dark or as the system.
    pub theme: ThemeChoice,
    /// The source from which the wave is drawn.
    pub wave: SourceChoice,
    /// Whether the plate is coloured by its largest displacement, not by the present one.
    pub show_amplitude: bool,
    /// Whether the plate is shown in relief.
    pub show_relief: bool,
    /// The port that was used last, in the form of the command line.
    pub port: Option<String>,
    /// Whether the app reconnects to a lost device by itself.
    pub auto_reconnect: bool,
    /// Whether a new table is also sent to a real device automatically.
    pub auto_upload: bool,
    /// Files opened or saved, newest first.
    pub recent: Vec<PathBuf>,
    /// The unique ids of the boards that the user arms although their brown-out level is not set, newest first.
    pub unguarded_boards: Vec<String>,
    /// The unique ids of the boards that the user arms although they keep no profile of their actuator, newest first.
    pub boards_without_profile: Vec<String>,
    /// Whether the user has dragged the boundary once, so that the hint is no longer needed.
    pub has_dragged: bool,
    /// Whether the panel at the right is shown.
    pub show_panel: bool,
    /// Whether the row of plots at the bottom is shown.
    pub show_plots: bool,
    /// The part that is shown in a window with no room for both.
    pub in_front: Part,
    /// Whether the finger on the simulated plate is heard.
    pub hear_finger: bool,
    /// The volume of what is heard, 0..=1.
    pub volume: f32,
    /// The speed of the wave as a multiple of its usual one, in [`SPEEDS`].
    pub speed: f64,
    /// Whether the wave is animated; not kept between runs, so that every start shows it moving.
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
            show_relief: false,
            port: None,
            auto_reconnect: true,
            auto_upload: false,
            recent: Vec::new(),
            unguarded_boards: Vec::new(),
            boards_without_profile: Vec::new(),
            has_dragged: false,
            show_panel: true,
            show_plots: true,
            in_front: Part::Panel,
            hear_finger: true,
            volume: 0.5,
            speed: 1.0,
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

    /// Reads settings from such text. A field that is missing, unknown or written by a newer version gets its
    /// value from [`Settings::default`]; the other fields are kept.
    #[must_use]
    pub fn read(text: &str) -> Self {
        let fields: toml::Table = text.parse().unwrap_or_default();
        fields.into_iter().fold(Self::default(), |settings, (field, value)| {
            let mut with_field = toml::Table::try_from(&settings).unwrap_or_default();
            with_field.insert(field, value);
            with_field.try_into().unwrap_or(settings)
        })
    }

    /// Moves a file to the top of the recent files.
    pub fn used(&mut self, path: &Path) {
        // A path that is not UTF-8 cannot be written, and would prevent the other settings from being written.
        if path.to_str().is_none() {
            return;
        }
        self.recent.retain(|other| other != path);
        self.recent.insert(0, path.to_owned());
        self.recent.truncate(RECENT);
    }

    /// Remembers that the user has armed a board knowing that its brown-out level is not set.
    pub(crate) fn arms_unguarded(&mut self, unit: String) {
        remember(&mut self.unguarded_boards, unit);
    }

    /// Remembers that the user has armed a board knowing that it keeps no profile of its actuator.
    pub(crate) fn arms_without_profile(&mut self, unit: String) {
        remember(&mut self.boards_without_profile, unit);
    }
}

/// Puts a board on top of a list.
fn remember(boards: &mut Vec<String>, unit: String) {
    boards.retain(|other| *other != unit);
    boards.insert(0, unit);
    boards.truncate(UNGUARDED);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uncommon() -> Settings {
        Settings {
            theme: ThemeChoice::Dark,
            wave: SourceChoice::Sheet,
            show_panel: false,
            show_plots: false,
            in_front: Part::Plots,
            show_amplitude: true,
            show_relief: true,
            port: Some("unix:/run/it.sock".to_owned()),
            auto_reconnect: false,
            auto_upload: true,
            recent: vec!["/a/b.toml".into(), "c.toml".into()],
            unguarded_boards: vec!["00ff".to_owned()],
            boards_without_profile: vec!["0a".to_owned()],
            has_dragged: true,
            hear_finger: false,
            volume: 0.25,
            speed: 0.5,
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
    fn a_field_that_is_not_understood_leaves_the_other_fields() {
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

    #[test]
    fn boards_that_are_armed_unguarded_are_few_and_named_once() {
        let mut settings = Settings::default();
        for i in 0..200 {
            settings.arms_unguarded(format!("{:02x}", i % 100));
        }
        assert_eq!(settings.unguarded_boards.len(), UNGUARDED);
        assert_eq!(settings.unguarded_boards[0], "63");
        settings.arms_unguarded("62".to_owned());
        assert_eq!(settings.unguarded_boards[..2], ["62", "63"]);
        assert_eq!(settings.unguarded_boards.len(), UNGUARDED);
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_not_utf8_does_not_prevent_the_settings_from_being_written() {
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

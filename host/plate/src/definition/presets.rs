//! The plates that come with Slipline: the plate files in `presets/`.

use crate::definition::plate::Plate;

/// A plate that comes with Slipline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Name of the preset, unique.
    pub name: &'static str,
    /// The plate file, TOML text.
    pub toml: &'static str,
}

impl Preset {
    /// The plate; `None` if the preset's own file is invalid, which a test excludes.
    pub fn plate(&self) -> Option<Plate> {
        Plate::from_toml(self.toml).ok()
    }

    /// The one-line description in the preset's file.
    pub fn description(&self) -> String {
        self.plate().map(|plate| plate.spec().description.clone()).unwrap_or_default()
    }
}

const PRESETS: [Preset; 9] = [
    Preset { name: "latex-membrane", toml: include_str!("../../presets/latex-membrane.toml") },
    Preset { name: "membrane", toml: include_str!("../../presets/membrane.toml") },
    Preset { name: "al-bending", toml: include_str!("../../presets/al-bending.toml") },
    Preset {
        name: "al-bending-displacement",
        toml: include_str!("../../presets/al-bending-displacement.toml"),
    },
    Preset { name: "paper-rubber", toml: include_str!("../../presets/paper-rubber.toml") },
    Preset { name: "paper-as-printed", toml: include_str!("../../presets/paper-as-printed.toml") },
    Preset { name: "membrane-heavy", toml: include_str!("../../presets/membrane-heavy.toml") },
    Preset { name: "al-sh", toml: include_str!("../../presets/al-sh.toml") },
    Preset { name: "tungsten-membrane", toml: include_str!("../../presets/tungsten-membrane.toml") },
];

/// All presets; the first is the default.
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

/// The plate of the preset `name`; `None` if there is no such preset.
pub fn preset(name: &str) -> Option<Plate> {
    PRESETS.iter().find(|preset| preset.name == name).and_then(Preset::plate)
}

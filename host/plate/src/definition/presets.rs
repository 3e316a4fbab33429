//! The plates that come with Slipline, as the plate files under `presets/`.

use crate::definition::plate::Plate;

/// A plate that comes with Slipline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// The name that selects it.
    pub name: &'static str,
    /// The plate file, TOML text.
    pub toml: &'static str,
}

impl Preset {
    /// The plate. `None` only if the preset's own file is invalid; a test checks that none is.
    pub fn plate(&self) -> Option<Plate> {
        Plate::from_toml(self.toml).ok()
    }

    /// The one-line description in the preset's file.
    pub fn description(&self) -> String {
        self.plate().map(|plate| plate.spec().description.clone()).unwrap_or_default()
    }
}

const PRESETS: [Preset; 8] = [
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
];

/// All presets; the first one is the default.
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

/// The plate of the preset called `name`; `None` if there is no such preset.
pub fn preset(name: &str) -> Option<Plate> {
    PRESETS.iter().find(|preset| preset.name == name).and_then(Preset::plate)
}

//! Scenes to start from: setups that show one thing each.

use crate::setup::{BoundaryMode, Setup, ToneSetup};
use std::sync::Arc;

/// A setup to start from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in one line.
    pub description: &'static str,
    preset: &'static str,
    /// Turning point and level of each tone.
    tones: &'static [(f64, f64)],
}

/// All scenes; a first start shows the first one, whose felt edge is the crispest: what is felt falls by 38 dB over one edge
/// width across it, and every place before it is felt clearly.
pub const SCENES: [Scene; 5] = [
    Scene {
        name: "Slippery edge",
        description: "Ultrasound on aluminium: slippery up to the line, rough beyond it",
        preset: "al-bending",
        tones: &[(0.223, 0.8)],
    },
    Scene {
        name: "Vibrating edge",
        description: "A soft vibration on a membrane, still beyond the line",
        preset: "membrane",
        tones: &[(0.16, 0.03)],
    },
    Scene {
        name: "Two peaks",
        description: "Two tones, two peaks, each at its own place and its own pitch",
        preset: "membrane",
        tones: &[(0.21, 0.4), (0.11, 0.4)],
    },
    Scene {
        name: "A beat one can feel",
        description: "Two ultrasonic tones 180 Hz apart: felt as 180 Hz where both are",
        preset: "al-bending",
        tones: &[(0.223, 0.4), (0.2222, 0.4)],
    },
    Scene {
        name: "The paper's rubber",
        description: "The paper's sheet of rubber at 40 to 50 Hz, moved by a voice coil",
        preset: "paper-rubber",
        tones: &[(0.15, 0.5)],
    },
];

impl Scene {
    /// Its setup. `None` only if the preset's own file is invalid; a test checks that none is.
    #[must_use]
    pub fn setup(&self) -> Option<Setup> {
        let plate = Arc::new(slipline_plate::preset(self.preset)?);
        let tones = (0..).zip(self.tones).map(|(slot, &(position_m, level))| ToneSetup {
            slot,
            position_m,
            level,
            phase_turns: 0.0,
        });
        Some(Setup { tones: tones.collect(), boundary: BoundaryMode::FeltEdge, ..Setup::new(plate) })
    }
}

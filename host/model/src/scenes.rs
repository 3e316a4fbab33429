//! Scenes to start from: setups that demonstrate one effect each, and small pictures of them.

mod thumbnail;

pub use thumbnail::{Thumbnail, thumbnails};

use crate::setup::{BoundaryMode, Setup, ToneSetup};
use std::sync::Arc;

/// A setup to start from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// Its effect, in one line.
    pub description: &'static str,
    /// The preset of its plate.
    plate: &'static str,
    /// Turning point and level of each tone.
    tones: &'static [(f64, f64)],
}

/// All scenes; a first start shows the first one. In scenes with one tone the felt edge is as crisp as
/// possible without a warning: the sensation falls by 40 dB over one edge width, and everything before it is
/// clearly felt.
pub const SCENES: [Scene; 6] = [
    Scene {
        name: "Vibrating area",
        description: "Clearly felt up to the line, still beyond it",
        plate: "tungsten-membrane",
        tones: &[(0.17, 0.8)],
    },
    Scene {
        name: "Slippery area",
        description: "Ultrasound on aluminium: slippery up to the line",
        plate: "al-bending",
        tones: &[(0.223, 0.8)],
    },
    Scene {
        name: "Solid area",
        description: "Four tones on a membrane fill each other's nodes: one even area up to a wide edge",
        plate: "membrane",
        // `slipline texture --plate membrane --solid 247mm`, 1 dB quieter, so that the four fit the DAC.
        tones: &[(0.08, 0.29), (0.1322, 0.282), (0.162, 0.225), (0.1714, 0.142)],
    },
    Scene {
        name: "Two tones",
        description: "Two peaks, each with its own place and pitch",
        plate: "membrane-heavy",
        tones: &[(0.2, 0.05), (0.11, 0.05)],
    },
    Scene {
        name: "A beat that is felt",
        description: "Two ultrasonic tones 180 Hz apart: their beat is felt",
        plate: "al-bending",
        tones: &[(0.223, 0.4), (0.2221, 0.4)],
    },
    Scene {
        name: "Rubber sheet",
        description: "Latex in a narrow frame: a low vibration up to the line",
        plate: "latex-membrane",
        tones: &[(0.12, 0.5)],
    },
];

impl Scene {
    /// Its setup. `None` only if the preset does not exist; a test checks that it does.
    #[must_use]
    pub fn setup(&self) -> Option<Setup> {
        let plate = Arc::new(slipline_plate::preset(self.plate)?);
        let tones = (0..).zip(self.tones).map(|(slot, &(position_m, level))| ToneSetup {
            slot,
            position_m,
            level,
            phase_turns: 0.0,
        });
        Some(Setup { tones: tones.collect(), boundary: BoundaryMode::FeltEdge, ..Setup::new(plate) })
    }
}

#[cfg(test)]
mod tests;

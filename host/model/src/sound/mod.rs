//! Sound for a loudspeaker: the tones under a finger, or the drive itself.
//!
//! ```text
//! steady field + finger --> at_finger --+
//!                                       +--> Sound --> Synth --> samples
//! acknowledged drive -----> of_drive ---+
//! ```
//! This module does not play: a window passes the samples to the system's sound output.

mod drive;
mod finger;
mod pitch;
mod synth;

pub use drive::{HIGHEST_DRIVE_HZ, left_out_hz, of_drive};
pub use finger::at_finger;
pub use pitch::Pitch;
pub use synth::Synth;

/// The sound from now on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sound {
    /// The tones, at most one for each slot of the device.
    pub partials: Vec<Partial>,
    /// Amplitude of noise, as a share of full scale, for a sliding finger.
    pub noise: f64,
}

/// One tone of a sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partial {
    /// The device's slot of the tone, 0..16: a changing tone keeps its slot and thereby its phase.
    pub slot: u8,
    /// Its audible frequency, in Hz.
    pub frequency_hz: f64,
    /// Its amplitude as a share of full scale, 0..=1.
    pub amplitude: f64,
}

impl Sound {
    /// Whether it is silent.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.noise == 0.0 && self.partials.iter().all(|partial| partial.amplitude == 0.0)
    }
}

//! What is heard: the tones that a finger meets, or the drive itself, as sound for a loudspeaker.
//!
//! ```text
//! steady field + finger --> at_finger --+
//!                                       +--> Sound --> Synth --> samples
//! acknowledged drive -----> of_drive ---+
//! ```
//! Nothing here plays: a window passes the samples to the system's sound.

mod drive;
mod finger;
mod pitch;
mod synth;

pub use drive::{HIGHEST_DRIVE_HZ, left_out_hz, of_drive};
pub use finger::at_finger;
pub use pitch::Pitch;
pub use synth::Synth;

/// What sounds from now on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sound {
    /// The tones, at most one for each slot of the device.
    pub partials: Vec<Partial>,
    /// Amplitude of noise, as a share of full scale: a finger that slides.
    pub noise: f64,
}

/// One tone of a sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partial {
    /// The device's slot of the tone, 0..16: a tone that changes keeps its slot, and so its phase.
    pub slot: u8,
    /// Its frequency as it is heard, in Hz.
    pub frequency_hz: f64,
    /// Its amplitude as a share of full scale, 0..=1.
    pub amplitude: f64,
}

impl Sound {
    /// Whether nothing is heard.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.noise == 0.0 && self.partials.iter().all(|partial| partial.amplitude == 0.0)
    }
}

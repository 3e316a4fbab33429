//! Sound: the vibration that a finger meets, or the drive itself, through the system's sound card.
//!
//! ```text
//! App --play(sound, volume)--> Speaker   (tests: a recorder of what is played)
//!                               |
//!                               +-- SystemSpeaker: Mix <--samples-- the system's callback
//! ```
//! The app repeats the present sound while it lasts. Without repeats the speaker falls silent within 0.3 s, as when the
//! window hangs or is covered.

#[cfg(not(target_arch = "wasm32"))]
mod mix;
#[cfg(not(target_arch = "wasm32"))]
mod output;
#[cfg(not(target_arch = "wasm32"))]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "the system's clock and a thread"))]
mod system;

#[cfg(not(target_arch = "wasm32"))]
pub use system::SystemSpeaker;

use slipline_model::sound::Sound;

/// Whether there is any sound to choose: not in a browser.
pub(crate) const IS_THERE: bool = cfg!(not(target_arch = "wasm32"));

/// The played sound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SoundChoice {
    /// Nothing.
    #[default]
    Off,
    /// The vibration at the finger.
    Finger,
    /// The drive, for a voice coil at the sound card's output.
    Drive,
}

/// The state of the system's sound.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SpeakerState {
    /// Nothing has been played yet, or nothing for a while.
    #[default]
    Closed,
    /// It is being opened.
    Opening,
    /// It plays.
    Playing,
    /// It cannot play, for this reason.
    Failed(String),
}

/// What plays a sound: the system's sound card, or a test's stand-in.
pub trait Speaker {
    /// Plays this sound at this volume, 0..=1, until the next call, but only for a short time (0.3 s on the sound card). Never
    /// blocks.
    fn play(&self, sound: Sound, volume: f32);
    /// Its state.
    fn state(&self) -> SpeakerState;
    /// Tries again after a failure.
    fn retry(&self);
}

#[cfg(test)]
mod tests;

//! What the user hears: the vibration at the finger, or the drive itself.
//!
//! With the simulated device the finger is heard, from the user's first touch on, unless the user has switched it off. With
//! a real one nothing is heard until the user switches it on for each connection, because its plate makes a sound of its
//! own. The drive is played only on request.

use super::App;
use crate::sound::{SoundChoice, SpeakerState};
use slipline_model::sound::{Sound, at_finger, left_out_hz, of_drive};
use slipline_model::sounding;
use slipline_plate::quantity::show_frequency;

/// The choice for this connection, where it differs from the usual one.
#[derive(Default)]
pub(super) struct Hearing {
    pub(super) chosen: Option<SoundChoice>,
    /// Whether the user has moved a finger or put one on the plate: only then it is heard.
    pub(super) has_touched: bool,
}

impl App {
    /// The present sound.
    pub(super) fn sound_choice(&self) -> SoundChoice {
        self.hearing.chosen.unwrap_or_else(|| {
            let is_usual = self.instrument.drive.snapshot().is_simulated() && self.settings.hear_finger;
            if is_usual { SoundChoice::Finger } else { SoundChoice::Off }
        })
    }

    /// Chooses what is heard, until another device is connected; whether the finger is heard with the simulated device
    /// is kept between runs.
    pub(super) fn choose_sound(&mut self, choice: SoundChoice) {
        self.hearing.chosen = Some(choice);
        if self.instrument.drive.snapshot().is_simulated() && choice != SoundChoice::Drive {
            self.settings.hear_finger = choice == SoundChoice::Finger;
        }
        if matches!(self.services.speaker.state(), SpeakerState::Failed(_)) {
            self.services.speaker.retry();
        }
    }

    /// Passes the present sound to the speaker.
    pub(super) fn play_sound(&self) {
        let sound = match self.sound_choice() {
            SoundChoice::Off => None,
            SoundChoice::Finger => self.sound_of_finger(),
            SoundChoice::Drive => self.sound_of_drive(),
        };
        self.services.speaker.play(sound.unwrap_or_default(), self.settings.volume);
    }

    /// Why the drive, or a part of it, is not played.
    pub(super) fn unplayed(&self) -> Option<String> {
        if self.sound_choice() != SoundChoice::Drive {
            return None;
        }
        if self.instrument.drive.snapshot().is_holding() {
            return Some(
                "The drive is played at its own levels: what the level hold adds is not heard.".to_owned(),
            );
        }
        let highest = show_frequency(slipline_model::sound::HIGHEST_DRIVE_HZ);
        let left_out = show_frequency(left_out_hz(&sounding::sounding(self.instrument.drive.snapshot())?)?);
        Some(format!("A sound card plays the drive up to {highest}: the tone of {left_out} is left out."))
    }

    fn sound_of_finger(&self) -> Option<Sound> {
        if !self.settings.animate || !self.hearing.has_touched {
            return None;
        }
        let (finger, full_peak_m) = (self.instrument.screen.finger()?, self.instrument.drive.full_peak_m()?);
        let field = self.instrument.screen.sounding()?;
        let met = self.instrument.screen.trace().latest();
        Some(at_finger(&self.instrument.desk.setup().plate, field, &finger, full_peak_m, met))
    }

    fn sound_of_drive(&self) -> Option<Sound> {
        let status = self.instrument.drive.snapshot().drive.status?;
        Some(of_drive(&sounding::sounding(self.instrument.drive.snapshot())?, status.foldback_per_mille))
    }
}

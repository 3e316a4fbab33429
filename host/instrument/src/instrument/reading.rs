//! What a shell reads of an instrument, beside all that is [`Shown`](super::Shown).

use super::{Background, Instrument, Notice, Recorder};
use slipline_link::Snapshot;
use slipline_model::field::touch::Trace;
use slipline_model::jobs::table::TableState;
use slipline_model::setup::Setup;
use slipline_model::waveform::Waveform;
use std::sync::Arc;

impl Instrument {
    /// The setup.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The state of link and device.
    #[must_use]
    pub fn snapshot(&self) -> &Arc<Snapshot> {
        &self.snapshot
    }

    /// The slot of the tone that keys and fields change.
    #[must_use]
    pub fn selected(&self) -> u8 {
        self.selected
    }

    /// The table for the setup's plate.
    #[must_use]
    pub fn table(&self) -> &TableState {
        &self.table
    }

    /// The recorded drag.
    #[must_use]
    pub fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    /// What the finger has met in the last seconds.
    #[must_use]
    pub fn trace(&self) -> &Trace {
        &self.finger.trace
    }

    /// Where the finger is or was last, in metres from the driven end.
    #[must_use]
    pub fn finger_place_m(&self) -> f64 {
        self.finger.place_m
    }

    /// The lights, the designer and what the wave is drawn from.
    #[must_use]
    pub fn background(&self) -> &Background {
        &self.background.shown
    }

    /// Whether a drive sounds.
    #[must_use]
    pub fn is_sounding(&self) -> bool {
        self.playback.sounding.is_some()
    }

    /// The codes that the device sends.
    #[must_use]
    pub fn waveform(&self) -> &Waveform {
        &self.playback.waveform
    }

    /// Whether something is sent of which the codes are not known.
    #[must_use]
    pub fn is_waveform_unknown(&self) -> bool {
        self.playback.is_unknown()
    }

    /// Seconds of slow motion so far.
    #[must_use]
    pub fn wave_time_s(&self) -> f64 {
        self.playback.wave_time_s
    }

    /// The messages, the latest last.
    pub fn notices(&self) -> impl Iterator<Item = &Notice> {
        self.notices.iter()
    }
}

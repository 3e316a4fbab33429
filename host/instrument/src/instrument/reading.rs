//! Read access for shells, in addition to [`Shown`](super::Shown).

use super::{Background, DragRecorder, Instrument, Notice};
use slipline_link::Snapshot;
use slipline_model::field::touch::Trace;
use slipline_model::setup::Setup;
use std::sync::Arc;

impl Instrument {
    /// The slot of the selected tone.
    #[must_use]
    pub const fn selected(&self) -> u8 {
        self.selected
    }

    /// The recent amplitudes under the finger.
    #[must_use]
    pub const fn trace(&self) -> &Trace {
        &self.finger.trace
    }

    /// The latest results of the background work.
    #[must_use]
    pub const fn background(&self) -> &Background {
        &self.background.shown
    }

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

    /// The recorded drag.
    #[must_use]
    pub fn recorder(&self) -> &DragRecorder {
        &self.recorder
    }

    /// The finger's present or last place, in metres from the driven end.
    #[must_use]
    pub fn finger_place_m(&self) -> f64 {
        self.finger.place_m
    }

    /// Whether a drive sounds.
    #[must_use]
    pub fn is_sounding(&self) -> bool {
        self.playback.sounding.is_some()
    }

    /// Whether the device sends codes that are not known.
    #[must_use]
    pub fn is_waveform_unknown(&self) -> bool {
        let waveform = &self.playback.waveform;
        waveform.window().is_some() && !waveform.is_true()
    }

    /// The messages, the latest last.
    pub fn notices(&self) -> impl Iterator<Item = &Notice> {
        self.notices.iter()
    }
}

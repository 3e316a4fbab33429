//! Everything the views show, as the app hands it to them.

use crate::intent::{Dialog, Grab};
use crate::settings::Settings;
use slipline_link::{PortInfo, Snapshot};
use slipline_model::field::sheet::{Frame, Source};
use slipline_model::field::steady_field::SteadyField;
use slipline_model::field::time_domain::Measured;
use slipline_model::jobs::check::{CheckJob, Checked};
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::table::TableState;
use slipline_model::setup::Setup;
use slipline_model::waveform::Waveform;
use std::sync::Arc;

/// Everything the views show.
pub struct Scene<'a> {
    /// What the user has set up.
    pub setup: &'a Setup,
    /// The tone that the boundary panel and the arrow keys are about.
    pub selected: u8,
    /// The tone under the pointer's button.
    pub grab: Option<Grab>,
    /// Link and device.
    pub snapshot: &'a Snapshot,
    /// Whether the user wants the plate driven.
    pub drive_wanted: bool,
    /// The plate under the setup's tones; of unit height while `full_peak_m` is not known.
    pub predicted: &'a SteadyField,
    /// The plate under the tones that the device has acknowledged and sounds.
    pub sounding: Option<&'a SteadyField>,
    /// The peak at level 1 in metres; `None` until the table for the plate is made.
    pub full_peak_m: Option<f64>,
    /// The table for the setup's plate.
    pub table: &'a TableState,
    /// The mirror's samples.
    pub waveform: &'a Waveform,
    /// The simulated plate under the tones that sound, once it has settled.
    pub measured: Option<&'a Measured>,
    /// The lights, the designer and what the wave is drawn from.
    pub background: &'a Background,
    /// The sheet, if the wave is drawn from it.
    pub sheet: Option<&'a Frame>,
    /// Work that takes long.
    pub waiting: Option<Waiting>,
    /// What is remembered.
    pub settings: &'a Settings,
    /// Ports that exist.
    pub ports: &'a [PortInfo],
    /// Messages to the user.
    pub notices: Vec<&'a Notice>,
    /// The page in front.
    pub dialog: Option<&'a Dialog>,
    /// What undo and redo would do.
    pub undo: (Option<&'static str>, Option<&'static str>),
    /// Seconds of slow motion so far: stands while the wave is paused.
    pub wave_time_s: f64,
}

impl Scene<'_> {
    /// The CRC of the table for the plate on the screen.
    pub(crate) fn table_crc(&self) -> Option<u32> {
        self.table.made().map(|made| made.device_table.crc())
    }

    /// Whether the device holds another table than the one for the plate on the screen.
    pub(crate) fn is_table_dirty(&self) -> bool {
        let on_device = self.snapshot.table.active.map(|header| header.crc);
        self.snapshot.is_connected() && self.table_crc().is_some_and(|crc| on_device != Some(crc))
    }

    /// The worst case of the sum of all tones, of the DAC's full scale.
    pub(crate) fn headroom_sum(&self) -> f64 {
        self.table.headroom_sum(self.setup)
    }
}

/// What background work has come to.
#[derive(Default)]
pub struct Background {
    /// The lights, of the plate and boundary they name.
    pub checked: Option<Checked>,
    /// The plate and boundary whose lights were asked for last.
    pub asked: Option<CheckJob>,
    /// What is wanted of the designer.
    pub draft: Draft,
    /// What came of it.
    pub design: DesignState,
    /// What the wave is drawn from.
    pub source: Option<Source>,
}

impl Background {
    /// Whether the lights are those of the plate and boundary on the screen.
    #[must_use]
    pub fn is_checked(&self) -> bool {
        self.checked.as_ref().map(|checked| &checked.job) == self.asked.as_ref()
    }
}

/// Where the designer stands.
#[derive(Clone, Debug, Default)]
pub enum DesignState {
    /// Nobody has opened it.
    #[default]
    Closed,
    /// It is being designed.
    Making,
    /// A plate, or the reason why there is none.
    Ready(Arc<Designed>),
    /// It was given up.
    Cancelled,
}

/// Work that is waited for, as a bar shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waiting {
    /// What is being done.
    pub what: &'static str,
    /// How much of it is done, 0..=1.
    pub share: f32,
}

/// A message to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// What it says.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
    /// Rises with every message: the same words again are another message.
    pub number: u64,
    /// How long it stands, in seconds; `None`: as long as it holds.
    pub lasts_s: Option<f64>,
}

//! The turning-point table for the plate on the screen: made in the background, for the device's own rate.

use crate::model::Setup;
use crate::table::DeviceTable;
use slipline_plate::{DriveTable, Plate, sensitivity_per_percent};
use std::sync::Arc;

/// Knots of the tables this program makes: as many as a device takes, because a plate that resonates needs them.
pub const KNOTS: usize = slipline_protocol::limits::MAX_KNOTS;

/// A table to be made.
#[derive(Clone, Debug)]
pub struct TableJob {
    /// For this plate.
    pub plate: Arc<Plate>,
    /// At this rate in Hz.
    pub sample_rate_hz: f64,
    /// With so many knots at most.
    pub max_knots: usize,
}

/// A table that was made.
#[derive(Clone, Debug)]
pub struct TableMade {
    /// For this plate.
    pub plate: Arc<Plate>,
    /// In Hz and gains.
    pub drive_table: DriveTable,
    /// As the device takes it.
    pub device_table: Arc<DeviceTable>,
    /// How far the peak goes off when the plate's waves are 1 % faster than the table thinks, in dB.
    pub sensitivity_db: Option<f64>,
}

/// Where the table stands.
#[derive(Clone, Debug, Default)]
pub enum TableState {
    /// No device has told its sample rate yet.
    #[default]
    Waiting,
    /// It is being made.
    Making,
    /// It is there.
    Ready(Arc<TableMade>),
    /// It cannot be made; a sentence that says why.
    Failed(String),
}

impl TableState {
    /// The table, if it is there.
    #[must_use]
    pub fn made(&self) -> Option<&Arc<TableMade>> {
        if let Self::Ready(made) = self { Some(made) } else { None }
    }

    /// The worst case of the sum of a setup's tones, of the DAC's full scale; gains count as 1 until the table is
    /// made.
    #[must_use]
    pub fn headroom_sum(&self, setup: &Setup) -> f64 {
        let gain = |x_m| self.made().map_or(1.0, |made| made.drive_table.gain(x_m));
        setup.tones.iter().map(|tone| tone.level * setup.master() * gain(tone.position_m)).sum()
    }
}

/// Makes a table: some tenths of a second.
#[must_use]
pub fn make(job: TableJob) -> TableState {
    let knots = KNOTS.min(job.max_knots);
    let drive_table = match DriveTable::build(&job.plate, job.sample_rate_hz, knots) {
        Ok(table) => table,
        Err(error) => return TableState::Failed(error.to_string()),
    };
    let device_table = match DeviceTable::quantise(&drive_table) {
        Ok(table) => Arc::new(table),
        Err(error) => return TableState::Failed(error.to_string()),
    };
    let sensitivity_db = sensitivity_per_percent(&job.plate, job.sample_rate_hz)
        .ok()
        .map(|sensitivity| sensitivity.worst_db.abs());
    TableState::Ready(Arc::new(TableMade { plate: job.plate, drive_table, device_table, sensitivity_db }))
}

//! The turning-point table of a plate, computed in the background for the device's sample rate.

use crate::field::simulation::device_table;
use crate::jobs::Task;
use crate::setup::Setup;
use slipline_link::DeviceTable;
use slipline_plate::{DriveTable, Plate, Progress, TableError, sensitivity_per_percent};
use std::sync::Arc;

/// Number of knots of a table: the largest that a device accepts, because resonant plates need it.
pub const KNOTS: usize = slipline_link::protocol::limits::MAX_KNOTS;

/// A table to compute.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct TableJob {
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The device's sample rate in Hz.
    pub sample_rate_hz: f64,
    /// The largest number of knots that the device accepts.
    pub max_knots: usize,
}

/// A finished table.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct TableMade {
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The table in Hz and gains.
    pub drive_table: DriveTable,
    /// The table in the device's units.
    pub device_table: Arc<DeviceTable>,
    /// Change of the peak in dB if the plate's waves are 1 % faster than the table assumes.
    pub sensitivity_db: Option<f64>,
}

/// The state of the table.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub enum TableState {
    /// The sample rate of the device is not known yet.
    #[default]
    Waiting,
    /// It is being computed.
    Making,
    /// It is finished.
    Ready(Arc<TableMade>),
    /// It cannot be computed; the text says why.
    Failed(String),
    /// Its computation was cancelled, and there was no table before.
    Cancelled,
}

impl TableState {
    /// The table, if it is finished.
    #[must_use]
    pub fn made(&self) -> Option<&Arc<TableMade>> {
        if let Self::Ready(made) = self { Some(made) } else { None }
    }

    /// The largest possible sum of a setup's tones, as a share of the DAC's full scale. Without a finished
    /// table all gains count as 1.
    #[must_use]
    pub fn headroom_sum(&self, setup: &Setup) -> f64 {
        let gain = |x_m| self.made().map_or(1.0, |made| made.drive_table.gain(x_m));
        setup.tones.iter().map(|tone| tone.level * setup.master() * gain(tone.position_m)).sum()
    }
}

/// Computes a table. This is fast for a usual plate and takes many times as long for a plate of many
/// wavelengths. `None` if the task was cancelled.
#[must_use]
pub fn make(job: TableJob, task: &Task) -> Option<TableState> {
    match build(job, &mut Progress::new(&mut |share| task.report(share))) {
        Ok(made) => Some(TableState::Ready(Arc::new(made))),
        Err(Unmade::Stopped) => None,
        Err(Unmade::Because(reason)) => Some(TableState::Failed(reason)),
    }
}

enum Unmade {
    Stopped,
    Because(String),
}

impl From<TableError> for Unmade {
    fn from(error: TableError) -> Self {
        if let TableError::Stopped(_) = error { Self::Stopped } else { Self::Because(error.to_string()) }
    }
}

fn build(job: TableJob, progress: &mut Progress<'_>) -> Result<TableMade, Unmade> {
    let knots = KNOTS.min(job.max_knots);
    let drive_table =
        DriveTable::build_watched(&job.plate, job.sample_rate_hz, knots, &mut progress.part(0.0, 0.8))?;
    let device_table = device_table(&drive_table).map_err(|error| Unmade::Because(error.to_string()))?;
    let rest = &mut progress.part(0.8, 1.0);
    let sensitivity_db = match sensitivity_per_percent(&drive_table, &job.plate, rest) {
        Ok(sensitivity) => Some(sensitivity.worst_db.abs()),
        Err(TableError::Stopped(_)) => return Err(Unmade::Stopped),
        Err(_) => None,
    };
    Ok(TableMade { plate: job.plate, drive_table, device_table: Arc::new(device_table), sensitivity_db })
}

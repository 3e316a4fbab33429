//! The turning-point table for the plate on the screen: made in the background, for the device's own rate.

use crate::field::simulation::device_table;
use crate::jobs::Task;
use crate::setup::Setup;
use slipline_link::table::DeviceTable;
use slipline_plate::{DriveTable, Plate, Progress, TableError, sensitivity_per_percent_of};
use std::sync::Arc;

/// Knots of the tables this program makes: as many as a device takes, because a plate that resonates needs them.
pub const KNOTS: usize = slipline_link::protocol::limits::MAX_KNOTS;

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
    /// Its making was given up, and there was none before.
    Cancelled,
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

/// Makes a table: a moment for a usual plate, many times as long for one of many wavelengths. `None` when
/// the task was over before.
#[must_use]
pub fn make(job: TableJob, task: &Task) -> Option<TableState> {
    match build(job, &mut Progress::new(&mut |share| task.tell(share))) {
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
    let sensitivity_db = match sensitivity_per_percent_of(&drive_table, &job.plate, rest) {
        Ok(sensitivity) => Some(sensitivity.worst_db.abs()),
        Err(TableError::Stopped(_)) => return Err(Unmade::Stopped),
        Err(_) => None,
    };
    Ok(TableMade { plate: job.plate, drive_table, device_table: Arc::new(device_table), sensitivity_db })
}

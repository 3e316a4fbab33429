//! Work that takes longer than a frame.

use crate::jobs::calibrate::{CalibrateDone, CalibrateJob};
use crate::jobs::recorded::{Recorded, RecordedJob};
use crate::jobs::rig::{RigJob, RigPrepared};
use slipline_model::field::sheet::{self, SheetJob};
use slipline_model::field::time_domain::{Measured, TimeDomainJob};
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::check::{CheckJob, Checked};
use slipline_model::jobs::compare::{CompareJob, Compared};
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::plane::{PlaneChecked, PlaneJob};
use slipline_model::jobs::table::{TableJob, TableState};
use slipline_model::jobs::texture::{TextureJob, Textured};
use slipline_model::waveform::{Waveform, WaveformJob};

/// Work that takes longer than a frame. The shell decides where it runs: on threads, in workers, or at once.
pub struct Jobs {
    /// Computes turning-point tables.
    pub tables: JobQueue<TableJob, TableState>,
    /// Computes validity lights.
    pub checks: JobQueue<CheckJob, Checked>,
    /// Computes the plate in two dimensions.
    pub planes: JobQueue<PlaneJob, PlaneChecked>,
    /// Designs plates.
    pub designs: JobQueue<Draft, Designed>,
    /// Makes textures.
    pub textures: JobQueue<TextureJob, Textured>,
    /// Compares measurements with the plate's model.
    pub comparisons: JobQueue<CompareJob, Compared>,
    /// Recordings of the sweep, read.
    pub recordings: JobQueue<RecordedJob, Recorded>,
    /// Fits plates to measurements.
    pub calibrations: JobQueue<CalibrateJob, CalibrateDone>,
    /// Puts the rigs of the simulated device together.
    pub rigs: JobQueue<RigJob, RigPrepared>,
    /// Runs the 2-D sheet.
    pub sheets: JobQueue<SheetJob, sheet::Frame>,
    /// Replays the device's codes with the mirror.
    pub waveforms: JobQueue<WaveformJob, Waveform>,
    /// Runs the simulated plate in the time domain.
    pub time_domain: JobQueue<TimeDomainJob, Measured>,
}

impl Jobs {
    /// All work is done at once, in the call that asks for it.
    #[must_use]
    pub fn inline() -> Self {
        Self {
            tables: JobQueue::inline(slipline_model::jobs::table::make),
            checks: JobQueue::inline(slipline_model::jobs::check::work()),
            planes: JobQueue::inline(slipline_model::jobs::plane::work),
            designs: JobQueue::inline(slipline_model::jobs::design::work),
            textures: JobQueue::inline(slipline_model::jobs::texture::work),
            comparisons: JobQueue::inline(slipline_model::jobs::compare::work),
            recordings: JobQueue::inline(crate::jobs::recorded::work),
            calibrations: JobQueue::inline(crate::jobs::calibrate::work),
            rigs: JobQueue::inline(crate::jobs::rig::work),
            sheets: JobQueue::inline(sheet::work()),
            waveforms: JobQueue::inline(slipline_model::waveform::work()),
            time_domain: JobQueue::inline(|job, task: &_| {
                slipline_model::field::time_domain::run(&job, task)
            }),
        }
    }
}

//! Work that takes longer than a frame.

use crate::jobs::calibrate::{self, CalibrateDone, CalibrateJob};
use crate::jobs::recorded::{self, Recorded, RecordedJob};
use crate::jobs::rig::{self, RigJob, RigPrepared};
use slipline_model::field::sheet::{self, SheetJob};
use slipline_model::field::time_domain::{self, SimulatedField, TimeDomainJob};
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::check::{self, CheckJob, Checked};
use slipline_model::jobs::compare::{self, CompareJob, Compared};
use slipline_model::jobs::design::{self, Designed, Draft};
use slipline_model::jobs::measured_places::{self, MeasuredPlaces, MeasuredPlacesJob};
use slipline_model::jobs::plane::{self, PlaneChecked, PlaneJob};
use slipline_model::jobs::table::{self, TableJob, TableState};
use slipline_model::jobs::texture::{self, TextureJob, Textured};
use slipline_model::waveform::{self, Waveform, WaveformJob};
use std::io;

/// One line per kind of work: its meaning, its queue, the job and its result, the name of its thread, and the
/// work.
macro_rules! jobs {
    ($(#[doc = $meaning:literal] $queue:ident: $job:ty => $done:ty, $thread:literal, $work:expr;)*) => {
        /// Work that takes longer than a frame. The shell decides where it runs: on threads, in workers, or at once.
        pub struct Jobs {
            $(#[doc = $meaning] pub $queue: JobQueue<$job, $done>,)*
        }

        impl Jobs {
            /// All work is done at once, in the call that asks for it.
            #[must_use]
            pub fn inline() -> Self {
                Self { $($queue: JobQueue::inline($work),)* }
            }

            /// Each kind of work has a thread of its own, and calls `wake` after each job.
            ///
            /// # Errors
            /// The error of the system when it cannot start a thread.
            pub fn threaded(wake: impl Fn() + Clone + Send + 'static) -> io::Result<Self> {
                Ok(Self { $($queue: JobQueue::threaded(concat!("slipline-", $thread), $work, wake.clone())?,)* })
            }
        }
    };
}

jobs! {
    /// Computes turning-point tables.
    tables: TableJob => TableState, "table", table::make;
    /// Computes validity lights.
    checks: CheckJob => Checked, "check", check::work();
    /// Computes the plate in two dimensions.
    planes: PlaneJob => PlaneChecked, "plane", plane::work;
    /// Designs plates.
    designs: Draft => Designed, "design", design::work;
    /// Makes textures.
    textures: TextureJob => Textured, "texture", texture::work;
    /// Compares measurements with the plate's model.
    comparisons: CompareJob => Compared, "compare", compare::work;
    /// Compares a real plate with its model at the places of the sensor.
    measured_places: MeasuredPlacesJob => MeasuredPlaces, "places", measured_places::work;
    /// Reads recordings of the sweep.
    recordings: RecordedJob => Recorded, "recorded", recorded::work;
    /// Fits plates to measurements.
    calibrations: CalibrateJob => CalibrateDone, "calibrate", calibrate::work;
    /// Puts the rigs of the simulated device together.
    rigs: RigJob => RigPrepared, "rig", rig::work;
    /// Runs the 2-D sheet.
    sheets: SheetJob => sheet::Frame, "sheet", sheet::work();
    /// Replays the device's codes with the mirror.
    waveforms: WaveformJob => Waveform, "mirror", waveform::work();
    /// Runs the simulated plate in the time domain.
    time_domain: TimeDomainJob => SimulatedField, "plate", |job, task: &_| time_domain::run(&job, task);
}

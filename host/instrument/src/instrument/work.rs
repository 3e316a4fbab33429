//! Work that takes longer than a frame.

use crate::jobs::recorded::{self, Recorded, RecordedJob};
use slipline_model::jobs::JobQueue;
use std::io;

/// Passes the kinds of work on to the macro of this name, one line each: the meaning; the kind and its queue; the job
/// and its result; the name of its thread; the worker that does it on a page; and the work.
#[macro_export]
macro_rules! for_each_job {
    ($then:ident) => {
        $then! {
            /// Computes turning-point tables.
            Table tables: slipline_model::jobs::table::TableJob => slipline_model::jobs::table::TableState,
                "table", quick, slipline_model::jobs::table::make;
            /// Computes validity lights.
            Check checks: slipline_model::jobs::check::CheckJob => slipline_model::jobs::check::Checked,
                "check", quick, slipline_model::jobs::check::work();
            /// Computes the plate in two dimensions.
            Plane planes: slipline_model::jobs::plane::PlaneJob => slipline_model::jobs::plane::PlaneChecked,
                "plane", long, slipline_model::jobs::plane::work;
            /// Designs plates.
            Design designs: slipline_model::jobs::design::Draft => slipline_model::jobs::design::Designed,
                "design", long, slipline_model::jobs::design::work;
            /// Makes textures.
            Texture textures: slipline_model::jobs::texture::TextureJob => slipline_model::jobs::texture::Textured,
                "texture", long, slipline_model::jobs::texture::work;
            /// Compares measurements with the plate's model.
            Comparison comparisons:
                slipline_model::jobs::compare::CompareJob => slipline_model::jobs::compare::Compared,
                "compare", quick, slipline_model::jobs::compare::work;
            /// Compares a real plate with its model at the places of the sensor.
            Places measured_places: slipline_model::jobs::measured_places::MeasuredPlacesJob
                => Vec<slipline_model::jobs::measured_places::MeasuredPlace>,
                "places", quick, slipline_model::jobs::measured_places::work;
            /// Fits plates to measurements.
            Calibration calibrations: $crate::jobs::calibrate::CalibrateJob => $crate::jobs::calibrate::CalibrateDone,
                "calibrate", long, $crate::jobs::calibrate::work;
            /// Puts the rigs of the simulated device together.
            Rig rigs: $crate::jobs::rig::RigJob => $crate::jobs::rig::RigPrepared,
                "rig", long, $crate::jobs::rig::work;
            /// Runs the 2-D sheet.
            Sheet sheets: slipline_model::field::sheet::SheetJob => slipline_model::field::sheet::Frame,
                "sheet", long, slipline_model::field::sheet::work();
            /// Replays the device's codes with the mirror.
            Waveform waveforms: slipline_model::waveform::WaveformJob => slipline_model::waveform::Waveform,
                "mirror", quick, slipline_model::waveform::work();
            /// Runs the simulated plate in the time domain.
            TimeDomain time_domain:
                slipline_model::field::time_domain::TimeDomainJob => slipline_model::field::time_domain::SimulatedField,
                "plate", quick,
                |job, task: &slipline_model::jobs::Task| slipline_model::field::time_domain::run(&job, task);
        }
    };
}

macro_rules! jobs {
    ($(
        #[doc = $meaning:literal]
        $kind:ident $queue:ident: $job:ty => $done:ty, $thread:literal, $lane:ident, $work:expr;
    )*) => {
        /// Work that takes longer than a frame. The shell decides where it runs: on threads, in workers, or at once.
        pub struct Jobs {
            $(#[doc = $meaning] pub $queue: JobQueue<$job, $done>,)*
            /// Reads recordings of the sweep; on a page at once, because their sounds are not copied to a worker.
            pub recordings: JobQueue<RecordedJob, Recorded>,
        }

        impl Jobs {
            /// All work is done at once, in the call that asks for it.
            #[must_use]
            pub fn inline() -> Self {
                Self { $($queue: JobQueue::inline($work),)* recordings: JobQueue::inline(recorded::work) }
            }

            /// Each kind of work has a thread of its own, and calls `wake` after each job.
            ///
            /// # Errors
            /// The error of the system when it cannot start a thread.
            pub fn threaded(wake: impl Fn() + Clone + Send + 'static) -> io::Result<Self> {
                Ok(Self {
                    $($queue: JobQueue::threaded(concat!("slipline-", $thread), $work, wake.clone())?,)*
                    recordings: JobQueue::threaded("slipline-recorded", recorded::work, wake)?,
                })
            }
        }
    };
}

for_each_job!(jobs);

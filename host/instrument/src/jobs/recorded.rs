//! A recording of the sweep as a measurement, in the background.

use crate::measure::PlayedSweep;
use crate::measured_file::{ForeignError, RecordingMetadata, recorded};
use slipline_model::jobs::Task;
use slipline_model::wav::Wav;
use slipline_plate::Plate;
use slipline_plate::calibrate::Measurement;
use std::sync::Arc;

/// A recording and its metadata.
#[derive(Clone, Debug)]
pub struct RecordedJob {
    /// The plate that was recorded.
    pub plate: Arc<Plate>,
    /// The recording.
    pub wav: Arc<Wav>,
    /// The sweep that was played.
    pub sweep: Arc<PlayedSweep>,
    /// Place and kind of the sensor, and its channel.
    pub metadata: RecordingMetadata,
}

/// The measurement with its notes as sentences; or why the recording was refused.
pub type Recorded = Result<(Measurement, Vec<String>), ForeignError>;

/// The work of the thread: less than a second for the usual recording.
#[must_use]
pub fn work(job: RecordedJob, task: &Task) -> Option<Recorded> {
    let found = recorded(&job.plate, &job.wav, &job.sweep, &job.metadata);
    task.report(1.0).then_some(found)
}

//! A recording of the sweep as a measurement, in the background.

use crate::measure::PlayedSweep;
use crate::measured_file::{ForeignError, RecordingMetadata, recorded};
use slipline_model::jobs::Task;
use slipline_model::wav::Wav;
use slipline_plate::Plate;
use slipline_plate::calibrate::Measurement;
use std::sync::Arc;

/// A recording, and what was told of it.
#[derive(Clone, Debug)]
pub struct RecordedJob {
    /// The plate it is of.
    pub plate: Arc<Plate>,
    /// The recording.
    pub wav: Arc<Wav>,
    /// What was played.
    pub sweep: Arc<PlayedSweep>,
    /// Where the sensor stood, what it showed, and its channel.
    pub metadata: RecordingMetadata,
}

/// The measurement and what is to be told of it, in sentences; or why there is none.
pub type Recorded = Result<(Measurement, Vec<String>), ForeignError>;

/// The work of the thread: less than a second for the usual recording.
#[must_use]
pub fn work(job: RecordedJob, task: &Task) -> Option<Recorded> {
    let found = recorded(&job.plate, &job.wav, &job.sweep, &job.metadata);
    task.report(1.0).then_some(found)
}

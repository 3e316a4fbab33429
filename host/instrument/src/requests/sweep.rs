//! The answer of a sweep for a separate recorder.

use crate::measure::{PlayedSweep, QUIETER};
use serde::Serialize;
use slipline_plate::Plate;

/// The fields of `slipline sweep --json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweepAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// Sample rate.
    pub sample_rate_hz: f64,
    /// JSON: Frequency at the beginning of the sweep
    pub first_hz: f64,
    /// JSON: Frequency at the end of the sweep
    pub last_hz: f64,
    /// JSON, 1: Levels of the two sweeps, 0 to 1 of full scale
    pub levels: [f64; 2],
    /// JSON: Time of one sweep
    pub sweep_s: f64,
    /// JSON: From the beginning of the first sweep to that of the second
    pub apart_s: f64,
    /// JSON: Time of both sweeps with the silence between them
    pub played_s: f64,
}

impl<'a> SweepAnswer<'a> {
    /// The fields of a sweep on this plate.
    #[must_use]
    pub fn of(plate: &'a Plate, played: &PlayedSweep) -> Self {
        let chirp = played.chirp();
        let (first_hz, last_hz) = chirp.ends_hz;
        Self {
            plate: plate.name(),
            sample_rate_hz: chirp.rate_hz,
            first_hz,
            last_hz,
            levels: [played.level(), QUIETER * played.level()],
            sweep_s: chirp.samples as f64 / chirp.rate_hz,
            apart_s: played.apart_s(),
            played_s: played.seconds(),
        }
    }
}

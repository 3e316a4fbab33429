//! The answer of a sweep for a separate recorder.

use crate::measure::{PlayedSweep, QUIETER};
use serde::Serialize;
use slipline_plate::Plate;

/// The fields of `slipline sweep --json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "host/JSON.md has the meaning of each field")]
pub struct SweepAnswer<'a> {
    pub plate: &'a str,
    pub sample_rate_hz: f64,
    pub first_hz: f64,
    pub last_hz: f64,
    pub levels: [f64; 2],
    pub sweep_s: f64,
    pub apart_s: f64,
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

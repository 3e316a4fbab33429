//! The combs of a measurement of harmonics.

use crate::measure::error::MeasureError;
use crate::measure::mains::is_hum;
use crate::measure::plan::{Comb, HIGHEST, LEVEL, RISE, RISE_S, settle_s};
use slipline_link::BLOCK;
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::{Harmonics, Plate};

/// Number of fundamentals that may be requested.
pub const HARMONIC_POINTS: Range = Range::new(2.0, 64.0, "");
/// Length of a window, seconds: a harmonic of 0.1 % of 500 codes is then 100 times the noise of the usual input.
const WINDOW_S: f64 = 0.25;
/// How many multiples aside of the nearest one are tried.
const ASIDE: u8 = 12;

/// The combs of a measurement of harmonics, one for each fundamental.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicsPlan {
    /// The device's sample rate, Hz.
    pub rate_hz: f64,
    /// The level of the fundamentals, over the table's full scale.
    pub level: f64,
    /// The combs of f, 2f and 3f, in rising order.
    pub combs: Vec<Comb>,
}

impl HarmonicsPlan {
    /// The plan for `points` (2 to 64) fundamentals over the band of the plate's span, at a level of 0.001 to 1.
    ///
    /// # Errors
    /// [`MeasureError::OutOfRange`] for a number out of its range, and for a band whose harmonics the sample rate cannot carry.
    pub fn new(plate: &Plate, points: usize, level: f64, rate_hz: f64) -> Result<Self, MeasureError> {
        OutOfRange::check("points", points as f64, HARMONIC_POINTS)?;
        OutOfRange::check("level", level, LEVEL)?;
        let (low_hz, high_hz) = plate.band_hz();
        let most = f64::from(Harmonics::ORDERS[1]);
        let carried = Range::at_most(HIGHEST * rate_hz / most, "Hz");
        OutOfRange::check("highest frequency of the plate's span", high_hz, carried)?;
        let period_blocks = (WINDOW_S * rate_hz / BLOCK as f64).ceil() as u16;
        let base_hz = rate_hz / (BLOCK as f64 * f64::from(period_blocks));
        let wanted = (0..points).map(|i| low_hz * (high_hz / low_hz).powf(i as f64 / (points - 1) as f64));
        // The nearest one whose harmonics, too, are away from the hum of the mains.
        let is_clear = |multiple: &f64| {
            *multiple >= 1.0 && [1.0, 2.0, 3.0].iter().all(|order| !is_hum(order * multiple * base_hz))
        };
        let near = |hz: f64| {
            let nearest = (hz / base_hz).round();
            let aside = (1..=ASIDE).flat_map(|steps| [-f64::from(steps), f64::from(steps)]);
            let mut tried = std::iter::once(0.0).chain(aside).map(|step| nearest + step);
            tried.find(is_clear).unwrap_or(nearest) as u16
        };
        let mut multiples: Vec<u16> = wanted.map(near).collect();
        // In a narrow band two of them may be the same multiple.
        multiples.sort_unstable();
        multiples.dedup();
        let comb = |&multiple: &u16| {
            let frequency_hz = f64::from(multiple) * base_hz;
            let settle_s = settle_s(plate, frequency_hz);
            Comb {
                period_blocks,
                harmonics: std::iter::once(1)
                    .chain(Harmonics::ORDERS)
                    .map(|order| multiple * u16::from(order))
                    .collect(),
                settle_samples: (settle_s * rate_hz).ceil() as u64,
                rise_s: (RISE * settle_s).clamp(RISE_S.0, RISE_S.1),
            }
        };
        Ok(Self { rate_hz, level, combs: multiples.iter().map(comb).collect() })
    }
}

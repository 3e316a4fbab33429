//! Evaluation of the lock-ins' results: responses, their noise, the headroom of the input, and warnings.
//!
//! Full scale is 2048 codes to both sides. If the input measures `b sin(p + s)` codes for a tone of amplitude
//! a (1 = full scale), the response is H = b/(2048 a) e^(-js) e^(-j omega t0); a positive argument of H is a
//! lag. t0 is the device's own lag: half a sample by the DAC's hold, minus the time from the code's beginning
//! to the sampling of the input. The hold's droop stays in H, as stated at [`Measurement::sample_rate_hz`].
//!
//! The noise is measured in a window without tones, at the frequencies of the first comb: the RMS of the five
//! frequencies nearest to a point. It falls with the square root of the window's length. Rounding to codes
//! contributes at least 1/sqrt(12) code.
//!
//! Answers that are not clear are averaged over further windows ([`windows`]).

use super::error::MeasureError;
use super::loudness::Tone;
use slipline_link::protocol::listen::InputsReport;
use slipline_model::response::{LIGHT_DB, light};
use slipline_plate::Complex64;
use slipline_plate::calibrate::{MeasuredPoint, Measurement, SensorBody, SensorKind, windows};
use slipline_plate::check::Colour;
use slipline_plate::order;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{decibels, show_frequency};
use std::f64::consts::TAU;

/// Codes of an input from mid-scale to the end of its range.
pub(super) const CODES: f64 = 2048.0;
/// The last code of an input.
pub(super) const LAST_CODE: u16 = 4095;
/// A response below this multiple of its noise is weak.
const WEAK: f64 = 10.0;
/// Noise of an input below which weak tones do not change its codes, codes RMS.
const DITHER: f64 = 0.4;
/// Number of noise frequencies averaged at a point.
const NEIGHBOURS: usize = 5;

/// The measured sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Its place, metres from the driven end.
    pub place_m: f64,
    /// The quantity that it shows.
    pub kind: SensorKind,
    /// The device's input, from 0.
    pub input: u8,
    /// What it weighs; `None` for a sensor that does not touch the plate.
    pub body: Option<SensorBody>,
}

impl Sensor {
    /// The device's own lag from codes to samples of an input, seconds: the DAC holds each code for a sample,
    /// which is half a sample on average, and the inputs are sampled `delay_ns` after the code is at its pin.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if the device does not have this input.
    pub(super) fn lag_s(&self, inputs: &InputsReport, rate_hz: f64) -> Result<f64, MeasureError> {
        if self.input >= inputs.inputs {
            return Err(MeasureError::NoInputs);
        }
        Ok(0.5 / rate_hz - 1e-9 * inputs.delay_ns as f64)
    }
}

/// The lock-ins' results of one window.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    /// The tones that sounded.
    pub(super) tones: Vec<Tone>,
    /// Amplitude in codes and lead of each tone at the input, as `b exp(js)`.
    pub(super) answers: Vec<Complex64>,
    /// The window's length, samples.
    pub(super) samples: u64,
    /// The input's lowest and highest code.
    pub(super) span: (u16, u16),
}

impl Window {
    /// Whether the input was at an end of its range.
    pub(super) fn is_clipped(&self) -> bool {
        let (lowest, highest) = self.span;
        lowest == 0 || highest >= LAST_CODE
    }

    /// Headroom of the input, dB; 0 where it is clipped.
    fn headroom_db(&self) -> f64 {
        let (lowest, highest) = self.span;
        if self.is_clipped() {
            return 0.0;
        }
        let away = (CODES - f64::from(lowest)).max(f64::from(highest) - CODES).max(0.5);
        decibels(CODES / away)
    }

    /// Deviation of each part of an answer at this frequency, codes: it is a mean of that number of samples
    /// times a sine.
    pub(super) fn deviation(&self, quiet: &Self, frequency_hz: f64) -> f64 {
        noise_codes(quiet, frequency_hz).max(12_f64.sqrt().recip()) * (2.0 / self.samples as f64).sqrt()
    }

    /// Number of windows like this one that make its answers clear.
    pub(super) fn wanted(&self, quiet: &Self) -> u16 {
        let of =
            |(tone, answer): (&Tone, &Complex64)| answer.norm() / self.deviation(quiet, tone.frequency_hz);
        windows(self.tones.iter().zip(&self.answers).map(of))
    }

    /// Continues this window by another one of the same tones.
    pub(super) fn extend(&mut self, other: &Self) {
        let all = self.samples + other.samples;
        let [own, added] = [self.samples, other.samples].map(|samples| samples as f64 / all as f64);
        for (answer, other) in self.answers.iter_mut().zip(&other.answers) {
            *answer = *answer * own + other * added;
        }
        self.samples = all;
        self.span = (self.span.0.min(other.span.0), self.span.1.max(other.span.1));
    }
}

/// A warning about a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Warning {
    /// An input was at the end of its range.
    Clipped {
        /// Number of frequencies.
        count: usize,
    },
    /// Less than 6 dB of headroom.
    Loud {
        /// The smallest headroom, dB.
        headroom_db: f64,
    },
    /// More than 40 dB of headroom.
    Quiet {
        /// The smallest headroom, dB.
        headroom_db: f64,
    },
    /// Some responses are less than 20 dB above the noise.
    Weak {
        /// Their number.
        count: usize,
        /// The number of all points.
        of: usize,
    },
    /// The input's code never changed.
    Stuck,
    /// Images of the tones fold onto the current of a piezo, and nothing is known that bounds them.
    UnknownImages,
    /// Images of the tones may falsify the current by more than 5 %.
    Images {
        /// The bound, as a share of the current.
        share: f64,
        /// Where it holds, Hz.
        frequency_hz: f64,
    },
    /// The input has so little noise that weak tones do not change its codes.
    NoDither {
        /// Its noise, codes RMS.
        codes: f64,
    },
}

impl Warning {
    /// The warning and its remedy as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
        match *self {
            Self::Clipped { count } => {
                format!("The input is clipped at {count} frequencies: lower the level or the input's gain.")
            }
            Self::Loud { headroom_db } => {
                format!(
                    "Only {} of the input's range are free: lower the level or the input's gain.",
                    decibel(headroom_db)
                )
            }
            Self::Quiet { headroom_db } => {
                format!(
                    "{} of the input's range are free: raise the level or the input's gain.",
                    decibel(headroom_db)
                )
            }
            Self::Weak { count, of } => format!(
                "{count} of {of} answers are less than 20 dB above the noise: raise the level, or put the sensor where the plate moves. At a \
                 plan's farther place a few are expected: those of tones that turn before it."
            ),
            Self::UnknownImages => "Images of the tones above half of the sample rate fold onto the measured current of a piezo and may \
                                    falsify it by its own size: state the bandwidth of the amplifier."
                .to_owned(),
            Self::Images { share, frequency_hz } => format!(
                "Images of the tones above half of the sample rate may falsify the current by {} % at {}: put a filter of second \
                 order before its input, and state its bandwidth.",
                with_decimals(100.0 * share, 0),
                show_frequency(frequency_hz)
            ),
            Self::Stuck => "The input never changes: is the sensor plugged in?".to_owned(),
            Self::NoDither { codes } => format!(
                "The input has {} codes of noise; below 0.5 the answers of weak tones are rounded away.",
                with_decimals(codes, 2)
            ),
        }
    }
}

/// A measurement and its warnings.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The responses; 1 is the input's full scale over the DAC's.
    pub measurement: Measurement,
    /// The smallest headroom of the input, dB.
    pub headroom_db: f64,
    /// The noise of the input, codes RMS.
    pub noise_codes: f64,
    /// The warnings, the worst first.
    pub warnings: Vec<Warning>,
}

impl Measured {
    /// The light of the headroom: red below 6 dB, green to 40 dB, amber beyond.
    #[must_use]
    pub fn light(&self) -> Colour {
        light(self.headroom_db)
    }

    /// Evaluates the windows of all combs and the window without tones. `lag_s` is the device's own lag.
    pub(super) fn of(sensor: &Sensor, rate_hz: f64, lag_s: f64, quiet: &Window, windows: &[Window]) -> Self {
        let mut points = Vec::new();
        for window in windows {
            let headroom_db = window.headroom_db();
            for (tone, answer) in window.tones.iter().zip(&window.answers) {
                let noise = window.deviation(quiet, tone.frequency_hz);
                let scale = (CODES * tone.amplitude).recip();
                points.push(MeasuredPoint {
                    frequency_hz: tone.frequency_hz,
                    response: answer.conj() * Complex64::cis(-TAU * tone.frequency_hz * lag_s) * scale,
                    noise: noise * scale,
                    headroom_db: Some(headroom_db),
                });
            }
        }
        order::sort_by(&mut points, |a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        let all = quiet.answers.iter().map(Complex64::norm_sqr);
        let noise_codes =
            (all.sum::<f64>() / quiet.answers.len().max(1) as f64 * 0.25 * quiet.samples as f64).sqrt();
        let is_stuck = windows.iter().any(|window| window.span.0 == window.span.1);
        Self::judged(sensor, rate_hz, points, noise_codes, is_stuck)
    }

    /// Judges these points; the noise is that of an input's codes.
    pub(super) fn judged(
        sensor: &Sensor,
        rate_hz: f64,
        points: Vec<MeasuredPoint>,
        noise_codes: f64,
        is_stuck: bool,
    ) -> Self {
        let headroom_db = points.iter().filter_map(|point| point.headroom_db).fold(f64::INFINITY, f64::min);
        let clipped = points.iter().filter(|point| point.headroom_db == Some(0.0)).count();
        let weak = points.iter().filter(|point| point.response.norm() < WEAK * point.noise).count();
        let of = points.len();
        let warnings = [
            (clipped > 0).then_some(Warning::Clipped { count: clipped }),
            is_stuck.then_some(Warning::Stuck),
            (clipped == 0 && headroom_db < LIGHT_DB.0).then_some(Warning::Loud { headroom_db }),
            (weak > 0).then_some(Warning::Weak { count: weak, of }),
            (headroom_db > LIGHT_DB.1).then_some(Warning::Quiet { headroom_db }),
            (noise_codes < DITHER).then_some(Warning::NoDither { codes: noise_codes }),
        ];
        let measured = Measurement::at(sensor.place_m, sensor.kind, points).by(sensor.body);
        Self {
            measurement: Measurement { sample_rate_hz: Some(rate_hz), ..measured },
            headroom_db,
            noise_codes,
            warnings: warnings.into_iter().flatten().collect(),
        }
    }
}

/// Noise of an input near a frequency, codes RMS.
fn noise_codes(quiet: &Window, frequency_hz: f64) -> f64 {
    let away = |tone: &Tone| (tone.frequency_hz / frequency_hz).ln().abs();
    let mut heard: Vec<(f64, f64)> =
        quiet.tones.iter().map(away).zip(quiet.answers.iter().map(Complex64::norm_sqr)).collect();
    order::sort_by(&mut heard, |a, b| a.0.total_cmp(&b.0));
    heard.truncate(NEIGHBOURS);
    // |b|^2 has both parts, each with twice the codes' variance over the samples.
    let mean: f64 = heard.iter().map(|(_, square)| square).sum::<f64>() / heard.len().max(1) as f64;
    (mean * 0.25 * quiet.samples as f64).sqrt()
}

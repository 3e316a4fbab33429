//! Recordings of the sweep by recorders with known clock, delay, gain and noise: the results, and the
//! refusals.
//!
//! The recordings are generated independently of the evaluation: two resonators run on the codes in time at
//! the device's rate, and the recorder samples their sum at its own times by cubic interpolation.

use super::*;
use crate::measure::plan::Wanted;
use slipline_model::field::simulation::table_for;
use slipline_plate::truth::Random;
use slipline_plate::{Complex64, preset};
use std::sync::LazyLock;

/// The device's rate: low, for a short test.
const DEVICE_HZ: f64 = 20e3;
const RATE_HZ: f64 = 8e3;

static SWEEP: LazyLock<PlayedSweep> = LazyLock::new(|| {
    let plate = preset("membrane").unwrap();
    let (_, table) = table_for(&plate, DEVICE_HZ as u32).unwrap();
    PlayedSweep::new(&plate, &table, &Wanted { points: 40, ..Wanted::of(&plate) }, DEVICE_HZ, 1.0).unwrap()
});

/// A resonance at a frequency with a time constant of 50 ms: y(n) = a y(n-1) + b y(n-2) + SIZE x(n).
fn factors(hz: f64) -> (f64, f64) {
    let decay = (-20.0 / DEVICE_HZ).exp();
    (2.0 * decay * (TAU * hz / DEVICE_HZ).cos(), -decay * decay)
}

/// Scales the loudest response to about 1.
const SIZE: f64 = 1e-4;
const RESONANCES: [(f64, f64); 2] = [(150.0, 1.0), (211.0, -0.5)];

/// The resonators' response, with time as e^(-j omega t), over the DAC's full scale.
fn truth(hz: f64) -> Complex64 {
    let delay = Complex64::cis(TAU * hz / DEVICE_HZ);
    let of = |&(resonance, size): &(f64, f64)| {
        let (a, b) = factors(resonance);
        size * SIZE / (1.0 - delay * (a + b * delay))
    };
    RESONANCES.iter().map(of).sum()
}

/// The plate's response to the codes of both sweeps.
static ANSWER: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let codes: Vec<f64> =
        SWEEP.rendered().unwrap().iter().map(|&code| (f64::from(code) - 2048.0) / 2048.0).collect();
    let mut sum = vec![0.0; codes.len()];
    for (resonance, size) in RESONANCES {
        let (a, b) = factors(resonance);
        let mut last = [0.0; 2];
        for (into, code) in sum.iter_mut().zip(&codes) {
            last = [size * SIZE * code + a * last[0] + b * last[1], last[0]];
            *into += last[0];
        }
    }
    sum
});

/// Properties of a recorder.
#[derive(Clone, Copy)]
struct Recorder {
    /// Relative deviation of its clock, positive if fast.
    clock: f64,
    /// Time from its first value to the first tone, seconds.
    lead_s: f64,
    gain: f64,
    noise: f64,
    hum: f64,
    /// An echo: its relative amplitude and its delay in seconds.
    echo: (f64, f64),
    bits: i32,
    /// Changes a value at a time in seconds of the recording, before quantization.
    bend: fn(f64, f64) -> f64,
}

const HEALTHY: Recorder = Recorder {
    clock: 0.0,
    lead_s: 0.9,
    gain: 0.5,
    noise: 1e-4,
    hum: 0.0,
    echo: (0.0, 0.0),
    bits: 16,
    bend: |value, _| value,
};

/// The response at a time in samples of the device, by Lagrange's cubic: its error at 250 Hz is a millionth.
fn at(time: f64) -> f64 {
    let (place, t) = (time.floor(), time - time.floor());
    let weights = [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ];
    let first = place as i64 - 1;
    let value = |n: i64| usize::try_from(n).ok().and_then(|n| ANSWER.get(n)).copied().unwrap_or(0.0);
    (first..).zip(weights).map(|(n, weight)| weight * value(n)).sum()
}

impl Recorder {
    fn records(&self) -> Sound {
        let seconds = self.lead_s + SWEEP.seconds() + 0.5;
        let mut random = Random::new(11);
        let step = 0.5_f64.powi(self.bits - 1);
        let value = |n: usize| {
            // The recorder's n-th value in the device's time.
            let device_s = n as f64 / (RATE_HZ * (1.0 + self.clock)) - self.lead_s;
            let mut heard = at(device_s * DEVICE_HZ);
            if self.echo.0 > 0.0 {
                heard += self.echo.0 * at((device_s - self.echo.1) * DEVICE_HZ);
            }
            let hum = self.hum * (TAU * 150.0 * n as f64 / RATE_HZ).sin();
            let value = self.gain * heard + hum + self.noise * random.normal();
            ((self.bend)(value, n as f64 / RATE_HZ) / step).round().clamp(-1.0 / step, 1.0 / step - 1.0)
                * step
        };
        let values = (0..(seconds * RATE_HZ) as usize).map(value).collect();
        Sound { rate_hz: RATE_HZ, values, end: Some(1.0 - step), step }
    }

    fn heard(&self) -> Result<HeardSweep, HeardError> {
        HeardSweep::new(&self.records(), &SWEEP)
    }

    fn refused(&self) -> String {
        self.heard().unwrap_err().to_string()
    }
}

/// RMS difference of the responses from the truth times a gain, after removal of the best-fitting lag,
/// relative to each one's noise plus a thousandth of the loudest; and the lag in seconds.
fn departure(heard: &HeardSweep, response: impl Fn(f64) -> Complex64) -> (f64, f64) {
    let truth: Vec<Complex64> = heard.points.iter().map(|point| response(point.frequency_hz)).collect();
    let loudest = truth.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let of_lag = |lag_s: f64| {
        let each = heard.points.iter().zip(&truth).map(|(point, p)| {
            let turned = point.response * Complex64::cis(-TAU * point.frequency_hz * lag_s);
            (turned - p).norm_sqr() / (2.0 * point.noise.powi(2) + (1e-3 * loudest).powi(2))
        });
        (each.sum::<f64>() / truth.len() as f64).sqrt()
    };
    let lags = (-6_000..=6_000).map(|step| f64::from(step) * 1e-6);
    let coarse = lags.step_by(200).min_by(|a, b| of_lag(*a).total_cmp(&of_lag(*b))).unwrap();
    let fine = (-20..=20).map(|step| coarse + f64::from(step) * 1e-5);
    let best = fine.min_by(|a, b| of_lag(*a).total_cmp(&of_lag(*b))).unwrap();
    (of_lag(best), best)
}

#[test]
fn a_recorders_clock_start_and_gain_are_found_and_the_responses_match_the_plate() {
    for (clock, lead_s) in [(0.0, 0.9), (150e-6, 0.713_21), (-320e-6, 2.0), (47.3e-6, 0.03)] {
        let heard = Recorder { clock, lead_s, ..HEALTHY }.heard().unwrap();
        let error = (heard.clock - clock).abs();
        println!("{} ppm: {:e} off, message {:e}", 1e6 * clock, error, heard.clock_deviation);
        assert!(error < 4.0 * heard.clock_deviation + 1e-8 && heard.clock_deviation < 1e-6);
        let begin_s = lead_s + SWEEP.lead as f64 / DEVICE_HZ;
        assert!((heard.begin_s - begin_s).abs() < 0.1 * SWEEP.chirp.ring_s, "{}", heard.begin_s);
        let (noises, lag_s) = departure(&heard, |hz| 0.5 * truth(hz));
        println!("{noises} noises, lag {lag_s} s");
        assert!(noises < 1.3, "{noises}");
        assert_eq!((heard.clipped(), heard.left_out), (0, 0));
    }
}

#[test]
fn a_clock_that_is_taken_for_true_would_spoil_the_phase() {
    // The purpose of the estimate: the same recording evaluated at the recorder's nominal rate.
    let recorder = Recorder { clock: 320e-6, noise: 0.0, ..HEALTHY };
    let heard = recorder.heard().unwrap();
    let untrue = heard.clock * (SWEEP.chirp.samples as f64 / DEVICE_HZ) * TAU * 400.0;
    assert!(untrue > 0.5, "{untrue} radians over the sweep");
    assert!(departure(&heard, |hz| 0.5 * truth(hz)).0 < 1.3);
}

#[test]
fn noise_is_reported_truly_and_a_hum_does_not_move_the_clock() {
    let noisy = Recorder { noise: 5e-3, clock: 90e-6, ..HEALTHY }.heard().unwrap();
    let (noises, _) = departure(&noisy, |hz| 0.5 * truth(hz));
    assert!((0.6..1.4).contains(&noises), "{noises}");
    assert!((noisy.clock - 90e-6).abs() < 4.0 * noisy.clock_deviation, "{noisy:?}");
    let hum = Recorder { hum: 0.03, clock: 90e-6, ..HEALTHY }.heard().unwrap();
    assert!((hum.clock - 90e-6).abs() < 5e-6, "{} {}", hum.clock, hum.clock_deviation);
}

#[test]
fn an_echo_within_the_ring_is_part_of_the_response() {
    let echo = (0.3, 0.017);
    let heard = Recorder { echo, ..HEALTHY }.heard().unwrap();
    let response = |hz: f64| 0.5 * truth(hz) * (1.0 + echo.0 * Complex64::cis(TAU * hz * echo.1));
    let (noises, _) = departure(&heard, response);
    assert!(noises < 1.3, "{noises}");
}

#[test]
fn clipped_values_mark_their_frequencies() {
    let clean = HEALTHY.heard().unwrap();
    assert!(clean.points.iter().all(|point| point.headroom_db > Some(3.0)));
    // At the file's end of range, and at that of an amplifier before it.
    let loudest = HEALTHY.records().values.into_iter().fold(0.0, f64::max);
    println!("loudest {loudest}");
    let at_end = Recorder { gain: 0.5 * 1.02 / loudest, ..HEALTHY }.heard().unwrap();
    let before = Recorder { noise: 0.0, bend: |value, _| value.clamp(-0.6, 0.6), ..HEALTHY };
    let before = Recorder { gain: 0.5 * 0.66 / loudest, ..before }.heard().unwrap();
    for heard in [at_end, before] {
        assert!((1..20).contains(&heard.clipped()), "{}", heard.clipped());
        assert!(heard.notes().iter().any(|note| note.contains("clipped at")), "{:?}", heard.notes());
    }
}

#[test]
fn a_gain_that_follows_the_level_is_refused() {
    // A compressor of 2 : 1 above 0.02.
    let compressed = |value: f64, _: f64| {
        let size = value.abs();
        if size > 0.02 { value.signum() * (0.02 * size).sqrt() } else { value }
    };
    let message = Recorder { bend: compressed, ..HEALTHY }.refused();
    assert!(
        message.starts_with("the sweep at half the level is recorded") && message.contains("too loud"),
        "{message}"
    );
    // An automatic gain that has risen by the second sweep.
    let turned = |value: f64, seconds: f64| if seconds > 4.0 { 1.1 * value } else { value };
    let message = Recorder { bend: turned, ..HEALTHY }.refused();
    assert!(message.contains("0.8 dB too loud"), "{message}");
    // A drift of a tenth of a decibel is accepted.
    let drifted = |value: f64, seconds: f64| if seconds > 4.0 { 1.01 * value } else { value };
    assert!(Recorder { bend: drifted, ..HEALTHY }.heard().is_ok());
}

#[test]
fn a_recording_without_the_sweep_is_refused_with_a_reason() {
    let sound = HEALTHY.records();
    let refused = |change: &dyn Fn(&mut Vec<f64>)| {
        let mut sound = sound.clone();
        change(&mut sound.values);
        HeardSweep::new(&sound, &SWEEP).unwrap_err()
    };
    let count = sound.values.len();
    assert_eq!(refused(&|values| values.truncate(100)), HeardError::Silent);
    assert_eq!(refused(&|values| values.fill(0.0)), HeardError::Silent);
    let mut random = Random::new(2);
    let noise: Vec<f64> = (0..count).map(|_| 0.1 * random.normal()).collect();
    assert_eq!(refused(&|values| values.copy_from_slice(&noise)), HeardError::NotFound);
    let second = refused(&|values| {
        let quiet = noise.iter().map(|value| 1e-3 * value);
        values[count / 2..].iter_mut().zip(quiet).for_each(|(value, noise)| *value = noise);
    });
    assert!(matches!(second, HeardError::OnlyOne { begin_s } if (begin_s - 1.4).abs() < 0.2), "{second:?}");
    let short = refused(&|values| values.truncate(count - (1.2 * RATE_HZ) as usize));
    assert!(
        matches!(short, HeardError::TooShort { missing_s } if missing_s > 0.1 && missing_s < 1.0),
        "{short:?}"
    );
    let message = Recorder { clock: 1.2e-3, ..HEALTHY }.refused();
    println!("{message}");
    let sound = Sound { rate_hz: 100.0, ..sound };
    let message = HeardSweep::new(&sound, &SWEEP).unwrap_err().to_string();
    assert!(message.starts_with("0 of the frequencies are below 45.0 Hz"), "{message}");
}

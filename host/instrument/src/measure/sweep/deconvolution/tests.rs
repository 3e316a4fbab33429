//! The deconvolution against resonators whose response is a formula.

use super::*;
use slipline_plate::truth::Random;

/// Values per second of the played and the recorded signal.
const RATE_HZ: f64 = 2500.0;
const VALUES: usize = 8192;
/// The sweep's ends; below, its duration in values.
const ENDS_HZ: (f64, f64) = (40.0, 400.0);
const SWEEP: f64 = 6000.0;

/// A sweep of amplitude 1 that fades in and out.
fn sweep() -> Vec<f64> {
    let octaves = (ENDS_HZ.1 / ENDS_HZ.0).ln();
    let value = |n: usize| {
        let share = n as f64 / SWEEP;
        if share >= 1.0 {
            return 0.0;
        }
        let hz = ENDS_HZ.0 * (share * octaves).exp();
        let turns = ENDS_HZ.0 * SWEEP / RATE_HZ / octaves * ((share * octaves).exp() - 1.0);
        smooth(hz, (40.0, 45.0)) * (1.0 - smooth(hz, (390.0, 400.0))) * (TAU * turns.fract()).sin()
    };
    (0..VALUES).map(value).collect()
}

const GATE: Gate = Gate { rises_hz: (42.0, 48.0), falls_hz: (380.0, 396.0), ring_s: 0.6, fade_s: 0.15 };

fn frequencies() -> Vec<f64> {
    (0..40).map(|i| 60.0 * 6_f64.powf(f64::from(i) / 39.0)).collect()
}

/// Two resonances with time constants of 0.05 s: y(n) = 2 r cos(w) y(n-1) - r^2 y(n-2) + x(n).
struct Resonance {
    hz: f64,
}

impl Resonance {
    const DECAY: f64 = 0.992;

    fn factors(&self) -> (f64, f64) {
        (2.0 * Self::DECAY * (TAU * self.hz / RATE_HZ).cos(), -Self::DECAY * Self::DECAY)
    }

    fn run(&self, input: &[f64]) -> Vec<f64> {
        let (a, b) = self.factors();
        let mut last = [0.0; 2];
        let step = |x: &f64| {
            let y = x + a * last[0] + b * last[1];
            last = [y, last[0]];
            y
        };
        input.iter().map(step).collect()
    }

    /// The response, with time as e^(-j omega t).
    fn response(&self, hz: f64) -> Complex64 {
        let (a, b) = self.factors();
        let delay = Complex64::cis(TAU * hz / RATE_HZ);
        (1.0 - delay * (a + b * delay)).inv()
    }
}

fn heard(input: &[f64]) -> Vec<f64> {
    let parts = [150.0, 211.0].map(|hz| Resonance { hz }.run(input));
    parts[0].iter().zip(&parts[1]).map(|(one, other)| one - 0.5 * other).collect()
}

fn truth(hz: f64) -> Complex64 {
    Resonance { hz: 150.0 }.response(hz) - 0.5 * Resonance { hz: 211.0 }.response(hz)
}

fn found(heard: &[f64], noise: &[f64], gate: &Gate) -> Vec<Answer> {
    let played = sweep();
    let of = Recorded { played: &played, heard, noise, rounding: 1e-30, rate_hz: RATE_HZ };
    responses(&of, gate, &frequencies()).unwrap()
}

/// The largest relative error.
fn worst(found: &[Answer]) -> f64 {
    let error = |(hz, (response, _)): (f64, &Answer)| (response / truth(hz) - 1.0).norm();
    frequencies().into_iter().zip(found).map(error).fold(0.0, f64::max)
}

static SILENCE: [f64; 4096] = [0.0; 4096];

#[test]
fn a_resonators_response_is_found_to_a_ten_thousandth() {
    let found = found(&heard(&sweep()), &SILENCE, &GATE);
    assert!(worst(&found) < 1e-4, "{}", worst(&found));
}

#[test]
fn reported_noise_matches_the_measured_noise() {
    let mut random = Random::new(3);
    let mut draw = |count: usize| -> Vec<f64> {
        (0..count.div_ceil(2)).flat_map(|_| random.normals()).map(|noise| 0.2 * noise).collect()
    };
    let clean = heard(&sweep());
    let (mut square, mut count) = (0.0, 0.0);
    for _ in 0..8 {
        let (quiet, noise) = (draw(4096), draw(VALUES));
        let noisy: Vec<f64> = clean.iter().zip(&noise).map(|(y, n)| y + n).collect();
        for (hz, (response, message)) in frequencies().into_iter().zip(found(&noisy, &quiet, &GATE)) {
            square += (response - truth(hz)).norm_sqr() / (2.0 * message * message);
            count += 1.0;
        }
    }
    let ratio = f64::sqrt(square / count);
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
}

#[test]
fn the_gate_leaves_out_the_harmonics_of_a_bent_amplifier() {
    let bent: Vec<f64> = sweep().iter().map(|x| x + 0.1 * x * x + 0.05 * x * x * x).collect();
    let bent = heard(&bent);
    // The cube of a sine contains 3/4 of it at the tone itself.
    let tone = 1.0 + 0.75 * 0.05;
    let left = |gate: &Gate| {
        let scaled: Vec<Answer> =
            found(&bent, &SILENCE, gate).into_iter().map(|(it, noise)| (it / tone, noise)).collect();
        worst(&scaled)
    };
    let open = Gate { ring_s: 1.2, fade_s: 1.2, ..GATE };
    let (gated, open) = (left(&GATE), left(&open));
    assert!(gated < 5e-3 && open > 5.0 * gated, "{gated} {open}");
}

#[test]
fn a_band_in_which_nothing_was_played_has_no_response() {
    let played = vec![0.0; VALUES];
    let of = Recorded { played: &played, heard: &played, noise: &SILENCE, rounding: 1e-30, rate_hz: RATE_HZ };
    assert!(responses(&of, &GATE, &frequencies()).is_none());
}

//! The steady field of a plate under a set of tones, computed by the frequency-domain solver for the views.
//!
//! One solution costs tens of microseconds, so the field is solved again for every step of a drag.

use crate::setup::{Setup, ToneSetup};
use slipline_plate::{Complex64, DriveTable, Finger, Plate, Responder};
use std::cell::RefCell;

/// Number of points along the plate.
pub const POINTS: usize = 401;

/// A steady tone on the plate: its frequency and the height of its turning-point peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyTone {
    /// The device's slot of the tone.
    pub slot: u8,
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Displacement of its peak, in metres.
    pub peak_m: f64,
}

/// The wave of one tone.
#[derive(Clone, Debug)]
pub struct ToneWave {
    /// The tone.
    pub tone: SteadyTone,
    /// Turning point x0 in metres; beyond the plate's end if the wave reaches it.
    pub turning_point_m: f64,
    /// Distance from the peak to the place where the amplitude is a tenth of it, in metres.
    pub edge_width_m: f64,
    /// Place of the peak, in metres; `None` if loss, a near drive or a finger prevents a peak.
    pub peak_position_m: Option<f64>,
    /// Height of the peak, in metres: under a finger less than the tone's own peak.
    pub peak_height_m: Option<f64>,
    /// Displacement of the driven end's drive, in metres: the wave over that of a drive of 1.
    pub drive_m: f64,
    /// Displacement amplitude at each of [`POINTS`] places, in metres: u = Re(f e^(-j omega t)).
    pub wave: Vec<Complex64>,
}

impl ToneWave {
    /// The displacement amplitude at this share (0..=1) of the plate's length, in metres; 0 off the plate.
    #[must_use]
    pub(crate) fn at(&self, share: f64) -> Complex64 {
        between(&self.wave, share)
    }
}

/// The plate under all tones.
#[derive(Clone, Debug, Default)]
pub struct SteadyField {
    /// Length of the plate in metres; the places are uniform from 0 to it.
    pub length_m: f64,
    /// The tones that enter the plate.
    pub tones: Vec<ToneWave>,
    /// Largest displacement that the sum can reach at each place, in metres.
    pub bound_m: Vec<f64>,
    /// Root mean square of the displacement at each place, in metres.
    pub rms_m: Vec<f64>,
}

impl SteadyField {
    /// Solves for these tones. Tones that cannot enter the plate are left out.
    #[must_use]
    pub fn solve(plate: &Plate, tones: &[SteadyTone]) -> Self {
        Self::solve_touched(plate, tones, None)
    }

    /// Whether the envelope that is drawn is the mean of several tones: what they could reach together is only a bound.
    #[must_use]
    pub const fn is_mean(&self) -> bool {
        self.tones.len() > 1
    }

    /// The envelope that is drawn at the [`POINTS`] places, in metres: of one tone its amplitude, of several the mean, which
    /// is sqrt 2 times the root mean square and is measured, too.
    #[must_use]
    pub fn drawn_m(&self) -> Vec<f64> {
        if self.is_mean() {
            self.rms_m.iter().map(|rms| rms * std::f64::consts::SQRT_2).collect()
        } else {
            self.bound_m.clone()
        }
    }

    /// As [`Self::solve`], with a finger on the plate. The drive stays that of the untouched plate, because
    /// the finger affects neither table nor device. If the solver refuses the finger, no tone is solved.
    #[must_use]
    pub fn solve_touched(plate: &Plate, tones: &[SteadyTone], finger: Option<&Finger>) -> Self {
        let tones: Vec<ToneWave> = tones.iter().filter_map(|tone| solve_tone(plate, tone, finger)).collect();
        let mut bound_m = vec![0.0; POINTS];
        let mut square = vec![0.0; POINTS];
        for tone in &tones {
            for (i, amplitude) in tone.wave.iter().enumerate() {
                bound_m[i] += amplitude.norm();
                square[i] += 0.5 * amplitude.norm_sqr();
            }
        }
        let rms_m = square.into_iter().map(f64::sqrt).collect();
        Self { length_m: plate.length_m(), tones, bound_m, rms_m }
    }

    /// The wave in a slot.
    #[must_use]
    pub fn tone(&self, slot: u8) -> Option<&ToneWave> {
        self.tones.iter().find(|wave| wave.tone.slot == slot)
    }

    /// The largest displacement anywhere, in metres.
    #[must_use]
    pub fn highest_m(&self) -> f64 {
        self.bound_m.iter().copied().fold(0.0, f64::max)
    }

    /// Largest possible displacement at `x`, in metres; 0 off the plate. Between two places each wave is interpolated, not
    /// its amplitude, which has a kink at each node.
    #[must_use]
    pub fn bound_at(&self, x_m: f64) -> f64 {
        self.tones.iter().map(|tone| tone.at(x_m / self.length_m).norm()).sum()
    }

    /// The mean frequency at `x`, weighted by the power of each tone there, in Hz: the pitch felt by a
    /// finger.
    #[must_use]
    pub(crate) fn frequency_at(&self, x_m: f64) -> f64 {
        let (mut weighted, mut total) = (0.0, 0.0);
        for tone in &self.tones {
            let share = x_m / self.length_m * (POINTS - 1) as f64;
            let power = tone.wave.get(share.round() as usize).map_or(0.0, |amplitude| amplitude.norm_sqr());
            weighted += power * tone.tone.frequency_hz;
            total += power;
        }
        if total > 0.0 { weighted / total } else { 0.0 }
    }
}

/// The wave at `share` (0..=1) of the range of its uniform places, by the cubic through the four nearest; 0
/// off the plate.
fn between(wave: &[Complex64], share: f64) -> Complex64 {
    if wave.len() < 4 || !(0.0..=1.0).contains(&share) {
        return Complex64::ZERO;
    }
    let at = share * (wave.len() - 1) as f64;
    let first = (at.floor() as usize).saturating_sub(1).min(wave.len() - 4);
    let t = at - first as f64;
    // Lagrange's polynomials for the places 0, 1, 2 and 3.
    let weights = [
        (t - 1.0) * (t - 2.0) * (3.0 - t) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (3.0 - t) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    ];
    wave[first..].iter().zip(weights).map(|(wave, weight)| wave * weight).sum()
}

/// The value at `share` (0..=1) of the range of uniform samples.
#[must_use]
pub fn interpolate(samples: &[f64], share: f64) -> f64 {
    if samples.is_empty() || !(0.0..=1.0).contains(&share) {
        return 0.0;
    }
    let t = share * (samples.len() - 1) as f64;
    let i = t.floor() as usize;
    let next = samples[(i + 1).min(samples.len() - 1)];
    samples[i] + (next - samples[i]) * (t - t.floor())
}

thread_local! {
    /// The plate that was solved last, with its grids: a step of a drag solves one plate some ten times.
    static LATEST: RefCell<Option<Responder>> = const { RefCell::new(None) };
}

/// The wave of a tone at [`POINTS`] places of a plate.
fn solve_tone(plate: &Plate, tone: &SteadyTone, finger: Option<&Finger>) -> Option<ToneWave> {
    LATEST.with_borrow_mut(|latest| match latest {
        Some(responder) if responder.plate() == plate => solve_by(responder, tone, finger),
        other => solve_by(other.insert(Responder::new(plate, POINTS)), tone, finger),
    })
}

fn solve_by(responder: &mut Responder, tone: &SteadyTone, finger: Option<&Finger>) -> Option<ToneWave> {
    let response = responder.respond(None, tone.frequency_hz).ok()?;
    let reference = response.height();
    let scale = if reference > 0.0 { tone.peak_m / reference } else { 0.0 };
    let response = match finger {
        None => response,
        Some(_) => responder.respond(finger, tone.frequency_hz).ok()?,
    };
    Some(ToneWave {
        tone: *tone,
        turning_point_m: response.turning_point_m,
        edge_width_m: response.edge_width_m,
        peak_position_m: response.peak.as_ref().map(|peak| peak.position_m),
        peak_height_m: response.peak.as_ref().map(|peak| peak.amplitude * scale),
        drive_m: scale,
        wave: response.amplitude.into_iter().map(|amplitude| amplitude * scale).collect(),
    })
}

impl SteadyTone {
    /// A tone of a setup as the device plays it with this table, on the plate for which the table is made; a
    /// tone of a chord is louder by the chord's gain.
    #[must_use]
    pub fn of(setup: &Setup, tone: &ToneSetup, table: &DriveTable) -> Self {
        Self {
            slot: tone.slot,
            frequency_hz: table.frequency_hz(tone.position_m),
            peak_m: setup.played_level(tone) * table.peak_m(tone.position_m),
        }
    }
}

/// The tones of a setup as the device plays them with the table of its plate. Without a table they have the
/// shape for their places, and a tone of level 1 has unit height.
#[must_use]
pub fn steady_tones(setup: &Setup, table: Option<&DriveTable>) -> Vec<SteadyTone> {
    let unit = |tone: &ToneSetup| SteadyTone {
        slot: tone.slot,
        frequency_hz: setup.plate.frequency_for_boundary_hz(tone.position_m),
        peak_m: tone.level * setup.master(),
    };
    let steady = |tone| table.map_or_else(|| unit(tone), |table| SteadyTone::of(setup, tone, table));
    setup.tones.iter().map(steady).collect()
}

/// The unit for a displacement of this size, and that unit in metres.
#[must_use]
pub fn displacement_unit(metres: f64) -> (&'static str, f64) {
    match metres {
        m if m >= 2e-3 => ("mm", 1e-3),
        m if m >= 2e-6 => ("µm", 1e-6),
        _ => ("nm", 1e-9),
    }
}

/// The displacement of full colour, in metres; `full_peak_m` is the table's peak at level 1.
#[must_use]
pub fn full_colour_m(sounding: Option<&SteadyField>, full_peak_m: f64) -> f64 {
    full_peak_m.max(sounding.map_or(0.0, SteadyField::highest_m)).max(1e-12)
}

/// The top of an envelope's axis, in metres: at least the height of level 1, so that a lower level looks lower;
/// more if the sum is higher. `full_peak_m` is the table's peak at level 1.
#[must_use]
pub fn envelope_top_m(steady: &SteadyField, full_peak_m: f64) -> f64 {
    (full_peak_m * 1.08).max(steady.highest_m() * 1.05).max(1e-12)
}

/// The factor of 1, 2, 5, 10 and so on, up to 5000, by which a view whose largest value is this share of full scale can be
/// magnified.
#[must_use]
pub fn magnification(largest: f64) -> f64 {
    let factors = (0..4).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(power)));
    factors.take_while(|factor| largest * factor <= 1.0).last().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::{Equation, respond};

    #[test]
    fn a_curve_is_magnified_as_far_as_it_fits() {
        for (largest, factor) in
            [(2.0, 1.0), (1.0, 1.0), (0.6, 1.0), (0.5, 2.0), (0.11, 5.0), (0.1, 10.0), (0.0, 5000.0)]
        {
            assert_eq!(magnification(largest), factor, "{largest}");
        }
    }

    #[test]
    fn every_peak_stands_as_high_as_the_table_makes_it() {
        let plate = slipline_plate::preset("membrane").unwrap();
        for x in [0.12, 0.16, 0.2] {
            let tone = SteadyTone { slot: 0, frequency_hz: plate.frequency_for_boundary_hz(x), peak_m: 1e-4 };
            let steady = SteadyField::solve(&plate, &[tone]);
            let wave = steady.tone(0).unwrap();
            assert!((wave.turning_point_m - x).abs() < 1e-6);
            let at_peak = steady.bound_at(wave.peak_position_m.unwrap());
            assert!((at_peak / 1e-4 - 1.0).abs() < 1e-4, "{at_peak}");
        }
    }

    #[test]
    fn plates_in_turn_have_each_its_own_waves() {
        let plates = [1.0, 1.02]
            .map(|speed| slipline_plate::preset("membrane").unwrap().with_wave_speed(speed).unwrap());
        let tone = SteadyTone { slot: 0, frequency_hz: 150.0, peak_m: 1e-4 };
        for plate in plates.iter().chain(&plates) {
            let steady = SteadyField::solve(plate, &[tone]);
            let wave = steady.tone(0).unwrap();
            let response = respond(plate, 150.0, POINTS, Equation::Corrected).unwrap();
            assert_eq!(wave.turning_point_m, response.turning_point_m);
            let scale = wave.wave[100] / response.amplitude[100];
            assert!((wave.wave[200] / response.amplitude[200] / scale - 1.0).norm() < 1e-12);
        }
    }

    #[test]
    fn a_tone_that_cannot_enter_leaves_the_field_empty() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let tone = SteadyTone { slot: 0, frequency_hz: 1.0, peak_m: 1e-4 };
        let steady = SteadyField::solve(&plate, &[tone]);
        assert!(steady.tones.is_empty() && steady.highest_m() == 0.0 && steady.bound_at(f64::NAN) == 0.0);
    }
}

//! A finger on the plate in the app: which one, what it meets, and what it has met in the last seconds.
//!
//! All values are illustrative: fingers differ, and so does what they feel.

use crate::field::displacement_map::mode_shape;
use crate::field::steady_field::SteadyField;
use slipline_plate::sensation::{Sensation, felt};
use slipline_plate::{Finger, Plate};
use std::collections::VecDeque;

/// Columns and rows of points over the contact whose mean is taken.
const POINTS: (usize, usize) = (9, 5);
/// How long the trace is, in seconds.
pub const TRACE_S: f64 = 4.0;

/// How the plate is touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Touch {
    /// Not at all.
    #[default]
    None,
    /// By a finger that strokes.
    Light,
    /// By a finger that presses.
    Firm,
}

impl Touch {
    /// The finger at a place, in metres from the driven end.
    #[must_use]
    pub fn at(self, place_m: f64) -> Option<Finger> {
        match self {
            Self::None => None,
            Self::Light => Some(Finger::light(place_m)),
            Self::Firm => Some(Finger::firm(place_m)),
        }
    }
}

/// Why this plate cannot be touched, if it cannot: its file does not tell how heavy its wave is.
#[must_use]
pub fn refusal(plate: &Plate) -> Option<String> {
    let (low_hz, _) = plate.band_hz();
    Finger::light(0.0).load(plate, low_hz).err().map(|error| error.to_string())
}

/// What a finger meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// When, in seconds.
    pub time_s: f64,
    /// Largest displacement under the finger, the mean over its contact, in metres.
    pub amplitude_m: f64,
    /// Friction over that of the plate at rest, 0..=1; `None` below 20 kHz, where a vibration is felt. Illustrative.
    pub friction: Option<f64>,
}

impl Met {
    /// What this finger meets in this field at a time.
    #[must_use]
    pub fn of(field: &SteadyField, plate: &Plate, finger: &Finger, time_s: f64) -> Self {
        let amplitude_m = mean_m(field, plate, finger);
        let friction = match felt(field.frequency_at(finger.place_m), amplitude_m) {
            Sensation::Friction { ratio } => Some(ratio),
            Sensation::Vibration { .. } => None,
        };
        Self { time_s, amplitude_m, friction }
    }
}

/// Mean over the contact, as far as it lies on the plate, of the largest displacement.
fn mean_m(field: &SteadyField, plate: &Plate, finger: &Finger) -> f64 {
    let (columns, rows) = POINTS;
    let share = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
    let (mut sum, mut area) = (0.0, 0.0);
    for column in 0..columns {
        let x_m = finger.place_m + (share(column, columns) - 0.5) * finger.contact_m;
        if !(0.0..=plate.length_m()).contains(&x_m) {
            continue;
        }
        let half_width_m = plate.half_width_m(x_m);
        let half_m = (0.5 * finger.contact_m).min(half_width_m);
        for row in 0..rows {
            let beta = share(row, rows) * half_m / half_width_m;
            sum += half_m * field.bound_at(x_m) * mode_shape(&plate.spec().model, beta);
            area += half_m;
        }
    }
    if area > 0.0 { sum / area } else { 0.0 }
}

/// What a finger has met in the last [`TRACE_S`] seconds.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    met: VecDeque<Met>,
}

impl Trace {
    /// Adds what is met now, and forgets what is older than [`TRACE_S`].
    pub fn push(&mut self, met: Met) {
        self.met.push_back(met);
        while self.met.front().is_some_and(|oldest| met.time_s - oldest.time_s > TRACE_S) {
            self.met.pop_front();
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.met.clear();
    }

    /// What was met, the oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Met> {
        self.met.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::SteadyTone;

    fn sounding(name: &str, x_m: f64, finger: Option<&Finger>) -> (Plate, SteadyField) {
        let plate = slipline_plate::preset(name).unwrap();
        let tone = SteadyTone { slot: 0, frequency_hz: plate.frequency_for_boundary_hz(x_m), peak_m: 1e-4 };
        let field = SteadyField::solve_touched(&plate, &[tone], finger);
        (plate, field)
    }

    #[test]
    fn a_firm_finger_takes_the_peak_down_and_a_light_one_less() {
        let peak_m = sounding("membrane", 0.18, None).1.tones[0].peak_position_m.unwrap();
        let height_m = |touch: Touch| {
            let (_, field) = sounding("membrane", 0.18, touch.at(peak_m).as_ref());
            field.bound_at(peak_m)
        };
        let [none, light, firm] = [Touch::None, Touch::Light, Touch::Firm].map(height_m);
        assert!((none / 1e-4 - 1.0).abs() < 0.01 && firm < 0.2 * none && firm < light && light < none);
    }

    #[test]
    fn the_amplitude_is_the_mean_over_the_contact_and_nothing_is_met_beyond_the_boundary() {
        let finger = Finger::light(0.15);
        let (plate, field) = sounding("membrane", 0.18, None);
        let met = Met::of(&field, &plate, &finger, 1.0);
        let (centre_m, half_width_m) = (field.bound_at(0.15), plate.half_width_m(0.15));
        // The mean of cos(pi z/2W) over |z| <= 5 mm.
        let angle = std::f64::consts::FRAC_PI_2 * 5e-3 / half_width_m;
        assert!((met.amplitude_m / (centre_m * angle.sin() / angle) - 1.0).abs() < 0.02, "{met:?}");
        assert_eq!(met.friction, None, "below 20 kHz");
        assert!(Met::of(&field, &plate, &Finger::light(0.31), 1.0).amplitude_m < 0.02 * met.amplitude_m);
    }

    #[test]
    fn above_20_khz_the_friction_follows_the_amplitude() {
        let plate = slipline_plate::preset("al-bending").unwrap();
        let (start, end) = plate.span_m();
        let x_m = 0.5 * (start + end);
        let (_, mut field) = sounding("al-bending", x_m, None);
        for scale in [0.0, 1e-2] {
            field.bound_m.iter_mut().for_each(|bound| *bound *= scale);
            let finger = Finger::light(field.tones[0].peak_position_m.unwrap());
            let met = Met::of(&field, &plate, &finger, 0.0);
            let curve = slipline_plate::sensation::FrictionCurve::default();
            assert_eq!(met.friction, Some(curve.ratio(met.amplitude_m)));
        }
    }

    #[test]
    fn the_trace_holds_the_last_seconds() {
        let mut trace = Trace::default();
        for i in 0..100 {
            trace.push(Met { time_s: 0.1 * f64::from(i), amplitude_m: 1e-6, friction: None });
        }
        let times: Vec<f64> = trace.iter().map(|met| met.time_s).collect();
        assert!((times[0] - 5.9).abs() < 0.11 && (times.last().unwrap() - 9.9).abs() < 1e-9, "{times:?}");
    }

    #[test]
    fn a_plate_whose_file_does_not_tell_its_weight_is_refused_by_the_fields_name() {
        let plate = slipline_plate::preset("membrane").unwrap();
        assert_eq!(refusal(&plate), None);
        let text = plate.to_toml().replace("tension_n_per_m = 40.0\n", "");
        let untold = Plate::from_toml(&text).unwrap();
        assert!(refusal(&untold).unwrap().contains("tension_n_per_m"));
    }
}

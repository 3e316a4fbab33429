//! Amplitude, friction and strength at a finger on the plate, and their trace over the last seconds.

use crate::field::displacement_map::mode_shape;
use crate::field::felt::Felt;
use crate::field::steady_field::SteadyField;
use slipline_plate::check::sensation::SLIPPERY_FROM_HZ;
use slipline_plate::feeling::Feeling;
use slipline_plate::{Finger, Plate};
use std::collections::VecDeque;

/// Columns and rows of points over the contact for its mean.
const POINTS: (usize, usize) = (9, 5);
/// Duration of the trace, in seconds.
pub const TRACE_S: f64 = 4.0;
/// Averaging time of the speed, in seconds: a pointer's position has the resolution of a pixel, so the speed
/// between two neighbouring frames would be noise.
const SPEED_OVER_S: f64 = 0.1;
/// Pause after which the trace starts again, in seconds: the finger's motion in a longer pause is unknown.
const PAUSE_S: f64 = 0.5;

/// Amplitude, friction and strength under a finger at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// Time, in seconds.
    pub time_s: f64,
    /// Middle of the contact, in metres from the driven end.
    pub place_m: f64,
    /// Largest displacement under the finger, the mean over its contact, in metres.
    pub amplitude_m: f64,
    /// Friction over that of the plate at rest, 0..=1; `None` below 20 kHz, where a vibration is felt. Illustrative.
    pub friction: Option<f64>,
    /// Strength of the sensation, where 1 is the threshold; of the plate's motion at this place without the
    /// finger, so that it ends where the displayed strip ends. Illustrative.
    pub felt: f64,
    /// Speed of the finger along the plate, in metres per second, 0 or more.
    pub speed_m_per_s: f64,
}

/// Mean over a finger's contact, as far as it lies on the plate, of a displacement that is `at_m(x)` metres
/// on the centre line and decreases to the edges as the first width mode.
pub(crate) fn mean_over_contact(plate: &Plate, finger: &Finger, at_m: impl Fn(f64) -> f64) -> f64 {
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
            sum += half_m * at_m(x_m) * mode_shape(&plate.spec().model, beta);
            area += half_m;
        }
    }
    if area > 0.0 { sum / area } else { 0.0 }
}

/// The field under a finger.
#[derive(Clone, Copy, Debug)]
pub struct Under<'a> {
    /// The plate.
    pub plate: &'a Plate,
    /// Its field with the finger.
    pub field: &'a SteadyField,
    /// The sensation of its field without the finger.
    pub felt: &'a Felt,
    /// How the finger feels.
    pub feeling: &'a Feeling,
}

/// Values under a finger in the last [`TRACE_S`] seconds.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    met: VecDeque<Met>,
}

impl Trace {
    /// Adds the values under this finger at `time_s`, and drops values older than [`TRACE_S`]. A time that is
    /// not later than the previous one adds nothing.
    pub fn push(&mut self, here: &Under<'_>, finger: &Finger, time_s: f64) {
        match self.met.back() {
            Some(latest) if time_s <= latest.time_s => return,
            Some(latest) if time_s - latest.time_s > PAUSE_S => self.clear(),
            _ => {}
        }
        let Under { plate, field, felt, feeling } = *here;
        let amplitude_m = mean_over_contact(plate, finger, |x_m| field.bound_at(x_m));
        let is_slippery = field.frequency_at(finger.place_m) >= SLIPPERY_FROM_HZ;
        let friction = is_slippery.then(|| feeling.friction.ratio(amplitude_m));
        let place_m = finger.place_m;
        // The oldest frame in the average; at least one frame.
        let is_recent = |met: &&Met| time_s - met.time_s <= SPEED_OVER_S;
        let before = self.met.iter().find(is_recent).or(self.met.back());
        let speed_m_per_s =
            before.map_or(0.0, |before| (place_m - before.place_m).abs() / (time_s - before.time_s));
        self.met.push_back(Met {
            time_s,
            place_m,
            amplitude_m,
            friction,
            felt: felt.at(place_m),
            speed_m_per_s,
        });
        while self.met.front().is_some_and(|oldest| time_s - oldest.time_s > TRACE_S) {
            self.met.pop_front();
        }
    }

    /// Clears the trace.
    pub fn clear(&mut self) {
        self.met.clear();
    }

    /// The values, the oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Met> + Clone {
        self.met.iter()
    }

    /// The latest values.
    #[must_use]
    pub fn latest(&self) -> Option<&Met> {
        self.met.back()
    }

    /// The values `seconds` before the latest ones, to the nearest frame; `None` before the trace begins.
    #[must_use]
    pub fn before(&self, seconds: f64) -> Option<&Met> {
        let time_s = self.latest()?.time_s - seconds;
        let after = self.met.partition_point(|met| met.time_s < time_s);
        let begins = time_s >= self.met.front()?.time_s - PAUSE_S / 2.0;
        let beside = [after.checked_sub(1), Some(after)];
        let away = |met: &&Met| (met.time_s - time_s).abs();
        let nearest = beside.into_iter().flatten().filter_map(|at| self.met.get(at));
        nearest.min_by(|one, other| away(one).total_cmp(&away(other))).filter(|_| begins)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::SteadyTone;

    /// A plate that sounds, and its sensation.
    struct Sounding {
        plate: Plate,
        field: SteadyField,
        felt: Felt,
    }

    fn sounding(name: &str, x_m: f64) -> Sounding {
        let plate = slipline_plate::preset(name).unwrap();
        let tone = SteadyTone { slot: 0, frequency_hz: plate.frequency_for_boundary_hz(x_m), peak_m: 2.5e-6 };
        let field = SteadyField::solve(&plate, &[tone]);
        let felt = Felt::of(&plate, &Feeling::default(), &field);
        Sounding { plate, field, felt }
    }

    impl Sounding {
        fn push(&self, trace: &mut Trace, finger: Finger, time_s: f64) {
            let feeling = &Feeling::default();
            let under = Under { plate: &self.plate, field: &self.field, felt: &self.felt, feeling };
            trace.push(&under, &finger, time_s);
        }

        fn met(&self, finger: Finger) -> Met {
            let mut trace = Trace::default();
            self.push(&mut trace, finger, 1.0);
            *trace.latest().unwrap()
        }
    }

    #[test]
    fn the_amplitude_is_the_mean_over_the_contact_and_nothing_is_met_beyond_the_boundary() {
        let membrane = sounding("membrane", 0.18);
        let Sounding { plate, field, .. } = &membrane;
        // A fingertip, and a patch from edge to edge of the plate.
        for contact_m in [0.01, 0.05] {
            let finger = Finger { contact_m, ..Finger::light(0.15) };
            let (mut sum, mut area) = (0.0, 0.0);
            for i in 0..200 {
                let x_m = 0.15 + contact_m * ((f64::from(i) + 0.5) / 200.0 - 0.5);
                let half_m = (0.5 * contact_m).min(plate.half_width_m(x_m));
                // The mean of cos(pi z/2W) over |z| <= half_m.
                let angle = std::f64::consts::FRAC_PI_2 * half_m / plate.half_width_m(x_m);
                sum += half_m * field.bound_at(x_m) * angle.sin() / angle;
                area += half_m;
            }
            let here = membrane.met(finger);
            assert!((here.amplitude_m / (sum / area) - 1.0).abs() < 0.01, "{here:?}");
            assert_eq!((here.friction, here.place_m), (None, 0.15), "below 20 kHz");
        }
        let [here, beyond] = [0.15, 0.31].map(|place_m| membrane.met(Finger::light(place_m)).amplitude_m);
        assert!(beyond < 0.02 * here);
    }

    #[test]
    fn above_20_khz_the_friction_follows_the_amplitude() {
        let plate = slipline_plate::preset("al-bending").unwrap();
        let (start, end) = plate.span_m();
        let mut aluminium = sounding("al-bending", 0.5 * (start + end));
        for scale in [0.0, 1e-2] {
            aluminium.field.bound_m.iter_mut().for_each(|bound| *bound *= scale);
            let met = aluminium.met(Finger::light(aluminium.field.tones[0].peak_position_m.unwrap()));
            let curve = slipline_plate::check::sensation::FrictionCurve::default();
            assert_eq!(met.friction, Some(curve.ratio(met.amplitude_m)));
        }
    }

    #[test]
    fn a_finger_that_is_dragged_stops_feeling_at_the_felt_edge_however_hard_it_presses() {
        for (name, x_m) in [("membrane", 0.12), ("al-bending", 0.23)] {
            let mut plate = sounding(name, x_m);
            let edge_m = plate.felt.edge.place_m().unwrap();
            let firm = Finger::firm(edge_m - 0.02);
            let tone = plate.field.tones[0].tone;
            plate.field = SteadyField::solve_touched(&plate.plate, &[tone], Some(&firm));
            for (off_m, is_felt) in [(-5e-4, true), (5e-4, false)] {
                let met = plate.met(Finger { place_m: edge_m + off_m, ..firm });
                assert_eq!(met.felt >= 1.0, is_felt, "{name} {off_m}: {met:?}");
            }
        }
    }

    /// A trace with a frame every 50 ms, with the finger at `place_m` of each time.
    fn traced(frames: usize, place_m: impl Fn(f64) -> f64) -> Trace {
        let membrane = sounding("membrane", 0.18);
        let mut trace = Trace::default();
        for time_s in (0..frames).map(|i| 0.05 * i as f64) {
            membrane.push(&mut trace, Finger::light(place_m(time_s)), time_s);
        }
        trace
    }

    #[test]
    fn the_trace_holds_the_last_seconds() {
        let trace = traced(200, |_| 0.1);
        let times: Vec<f64> = trace.iter().map(|met| met.time_s).collect();
        assert!((times[0] - 5.95).abs() < 0.06 && (times.last().unwrap() - 9.95).abs() < 1e-9, "{times:?}");
    }

    #[test]
    fn the_speed_is_how_fast_the_finger_moves_in_either_direction() {
        for velocity in [0.03, -0.03] {
            let trace =
                traced(60, |time_s| if time_s < 1.0 { 0.15 } else { 0.15 + velocity * (time_s - 1.0) });
            let speed = |seconds: f64| trace.before(seconds).unwrap().speed_m_per_s;
            assert!((speed(0.0) - 0.03).abs() < 1e-9, "{}", speed(0.0));
            assert_eq!(speed(2.5), 0.0, "it rests");
        }
    }

    #[test]
    fn a_pause_begins_a_new_trace_and_no_time_counts_twice() {
        let membrane = sounding("membrane", 0.18);
        let mut trace = traced(20, |_| 0.1);
        let mut push = |place_m, time_s| {
            membrane.push(&mut trace, Finger::light(place_m), time_s);
            (trace.iter().count(), trace.latest().unwrap().speed_m_per_s)
        };
        assert_eq!(push(0.2, 0.95), (20, 0.0), "the same time again");
        let (count, speed) = push(0.11, 1.45);
        assert!(count == 21 && (speed - 0.02).abs() < 1e-9, "{count} {speed}: half a second is no pause");
        assert_eq!(push(0.3, 2.0), (1, 0.0), "0.55 s later");
        trace.clear();
        assert!(trace.latest().is_none() && trace.before(0.0).is_none());
    }

    #[test]
    fn what_was_met_before_is_found_by_its_time() {
        let trace = traced(21, |time_s| 0.1 * time_s);
        let place = |seconds| trace.before(seconds).map(|met| met.place_m);
        for (seconds, wanted) in [(0.0, 0.1), (0.5, 0.05), (0.98, 0.0), (0.52, 0.05)] {
            assert!((place(seconds).unwrap() - wanted).abs() < 1e-9, "{seconds}: {:?}", place(seconds));
        }
        assert_eq!(place(1.5), None, "the trace began later");
    }
}

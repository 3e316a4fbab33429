//! What the equation of one width mode misses between the driven end and a sensor near it.
//!
//! An end that moves its whole width alike, as a bar does, moves the third width mode by a third of the first. A taper makes some of it,
//! too. The wave's fronts are circles about the point where the edges would meet, and the end is straight: where along the front
//! the wave begins depends on how the end moves across the width.

use super::data::Datum;
use crate::calibrate::fit::pairs::means_beside;
use crate::calibrate::fit::response::plate_response::PlateResponse;
use crate::calibrate::measurement::sensor::SensorKind;
use crate::definition::Plate;
use crate::special::ramp::ramp;
use num_complex::Complex64;
use std::f64::consts::PI;

/// The third width mode's amplitude over the first one's at an end that moves its whole width alike: of 1 = sum c_n cos(q_n z/W),
/// c_n = 2 sin(q_n)/q_n.
pub(crate) const OF_A_BAR: f64 = 1.0 / 3.0;
/// What its wave misses of it, over the first one's amplitude: the modes beyond it, and what they all hand each other again. Of a bar, by
/// five coupled modes, up to 0.1.
const LEFT: f64 = 0.1;
/// Points of its wave.
const POINTS: usize = 256;
/// Frequencies whose waves are computed side by side: each next point waits for a division by the one before.
const LANES: usize = 4;

/// How far the wave's front on the centre line is ahead of its mean over the width, which an end moves that is a bar, at the driven end,
/// metres: the front is a circle of the radius W/|W'|, z^2 |W'|/(2 W) deep, and the mean of z^2/W^2 over cos(pi z/(2 W)) is
/// 1 - 8/pi^2.
pub(crate) fn front_m(plate: &Plate) -> f64 {
    let mean_square = 1.0 - 8.0 / (PI * PI);
    0.5 * mean_square * plate.half_width_m(0.0).powi(2) * plate.narrowing_per_m(0.0).abs()
}

/// The third width mode's wave along a plate, by its own amplitude equation f'' + (W'/W) f' + k3^2 f = 0 from where the driven end moves
/// it; what the modes hand each other on a taper is left out.
struct ThirdMode<'a> {
    plate: &'a Plate,
    step_m: f64,
    /// The width's part of k3^2, and W'/W times half a step, at each point.
    points: Vec<(f64, f64)>,
}

impl<'a> ThirdMode<'a> {
    fn of(plate: &'a Plate) -> Self {
        let (mode, step_m) = (plate.width_mode(3), plate.length_m() / (POINTS - 1) as f64);
        let point = |x: f64| (mode.width_term(x), 0.5 * step_m * plate.narrowing_per_m(x));
        Self { plate, step_m, points: ramp(0.0, plate.length_m(), POINTS).map(point).collect() }
    }

    /// Its amplitude at places over that at the driven end, at each frequency.
    fn shares(&self, frequencies_hz: &[f64], places_m: &[f64]) -> Vec<Vec<Complex64>> {
        let mut shares = Vec::with_capacity(frequencies_hz.len());
        for group in frequencies_hz.chunks(LANES) {
            // A group that is not full repeats its last frequency.
            let frequency_hz = |lane: usize| group[lane.min(group.len() - 1)];
            let ratios = self.ratios(std::array::from_fn(frequency_hz));
            shares.extend((0..group.len()).map(|lane| {
                let ratio = |i: usize| ratios[i][lane];
                places_m.iter().map(|place_m| self.share(ratio, *place_m)).collect()
            }));
        }
        shares
    }

    /// R of f[i] = R[i] f[i - 1] from the narrow end, beyond which it decays.
    fn ratios(&self, frequencies_hz: [f64; LANES]) -> Vec<[Complex64; LANES]> {
        let axial =
            frequencies_hz.map(|hz| self.plate.width_mode(3).axial_squared(hz) * self.plate.lossy(hz));
        let last = POINTS - 1;
        let mut ratios = vec![[Complex64::ONE; LANES]; POINTS];
        ratios[last] = axial.map(|axial| (-(self.points[last].0 - axial).sqrt() * self.step_m).exp());
        for i in (1..last).rev() {
            let (across, sided) = self.points[i];
            let next = ratios[i + 1];
            ratios[i] = std::array::from_fn(|lane| {
                let middle = (axial[lane] - across) * (self.step_m * self.step_m) - 2.0;
                (sided - 1.0) / (middle + (1.0 + sided) * next[lane])
            });
        }
        ratios
    }

    /// The amplitude at a place over that at the driven end.
    fn share(&self, ratio: impl Fn(usize) -> Complex64, place_m: f64) -> Complex64 {
        let place = (place_m / self.step_m).clamp(0.0, (POINTS - 1) as f64);
        let whole = place.floor() as usize;
        let here: Complex64 = (1..=whole).map(&ratio).product();
        let next = if whole + 1 < POINTS { ratio(whole + 1) } else { Complex64::ONE };
        here * (1.0 + (next - 1.0) * (place - whole as f64))
    }
}

/// Length by which a taper hands the third width mode the first one's slope: it is forced as `length p'` along the plate, so an end that
/// moves in the shape of the first mode alone sends out `-length p'(0)` of it. 2 (W'/W) a p' of the coupled modes over k1^2 - k3^2 =
/// 2 pi^2/W^2, with a = 3/4 the mean of the third mode times the change of the first by ln W: 3 W |W'|/(4 pi^2).
fn forced_m(plate: &Plate) -> f64 {
    0.75 / (PI * PI) * plate.half_width_m(0.0).powi(2) * plate.narrowing_per_m(0.0).abs()
}

/// Adds what the third width mode shows at the sensor's places to responses of `plate`: as high as the first one at the driven end, and
/// as the taper sends it out there.
pub(crate) fn add_third(answers: &mut [PlateResponse], plate: &Plate, kind: SensorKind, places_m: &[f64]) {
    let (mode, forced_m) = (ThirdMode::of(plate), forced_m(plate));
    let frequencies_hz: Vec<f64> = answers.iter().map(|answer| answer.frequency_hz).collect();
    for (answer, shares) in answers.iter_mut().zip(mode.shares(&frequencies_hz, places_m)) {
        let hz = answer.frequency_hz;
        let [value, slope] = answer.at_end;
        let seen = |(share, &place_m): (Complex64, &f64)| {
            let share = match kind {
                SensorKind::Strain => -share * plate.width_mode(3).lossy_wavenumber_squared(place_m, hz),
                _ => share,
            };
            [share * value, -share * slope * forced_m]
        };
        answer.third = shares.into_iter().zip(places_m).map(seen).collect();
    }
}

/// Widens the errors of a sensor's responses at a place by what [`add_third`] misses there.
pub(crate) fn widen(data: &mut [Datum], plate: &Plate, place_m: f64, frequencies_hz: &[f64]) {
    let mode = ThirdMode::of(plate);
    let squares: Vec<f64> = data.iter().map(|datum| datum.response.norm_sqr()).collect();
    let shares = mode.shares(frequencies_hz, &[place_m]);
    for ((datum, share), square) in data.iter_mut().zip(shares).zip(means_beside(&squares)) {
        let share = share[0].norm().min(1.0);
        datum.variance += (LEFT * share).powi(2) * square;
    }
}

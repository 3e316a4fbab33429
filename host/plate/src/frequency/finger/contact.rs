//! The response of a finger's contact besides the propagating wave: all waves that decay around it.
//!
//! The contact is divided into cells: columns along x, each divided into bands across; a band lies on both sides of the
//! centre line. A force on a cell also moves the higher width modes and, in bending, the evanescent wave of each. On a
//! straight strip as wide as the plate at the finger, the mode n (1, 3, 5, ..) with q_n = n pi/2W responds to a force
//! per length with e^(-gamma |x|)/(2 gamma S):
//! | plate | waves of the mode n | sign |
//! |---|---|---|
//! | membrane, shear wave | gamma^2 = q_n^2 - K^2 for n = 3, 5, .. | + |
//! | bending | gamma^2 = q_n^2 - K^2 for n = 3, 5, .. | + |
//! | | gamma^2 = q_n^2 + K^2 for n = 1, 3, 5, .. | - |
//!
//! with S of the propagating wave, (S p')' + S k^2 p = -force per length. A clamped strip is treated as a supported one
//! of the same cut-off.

use super::Finger;
use crate::definition::plate::Plate;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// Columns of cells along the contact.
pub(super) const COLUMNS: usize = 6;
/// Bands of cells across half of the contact.
pub(super) const BANDS: usize = 4;
/// Highest width mode included; the terms fall with the fourth power of its number.
const MODE_MAX: u32 = 99;
/// Decay exponent beyond which a wave is neglected.
const EXPONENTS_MAX: f64 = 30.0;

/// The contact of a finger on a strip as wide as the plate at its place.
pub(super) struct Contact {
    begins_m: f64,
    ends_m: f64,
    waves: Vec<Wave>,
}

/// A wave that decays around the contact, or a higher width mode that propagates away from it.
struct Wave {
    gamma: Complex64,
    /// The mode's mean over each band.
    mean: [f64; BANDS],
    /// Sign from the table above.
    sign: f64,
}

impl Contact {
    pub(super) fn new(finger: &Finger, plate: &Plate, frequency_hz: f64) -> Self {
        let (begins_m, ends_m) = finger.reach(plate);
        let half_width = strip_half_width(plate, finger.place_m);
        let half_contact = finger.half_across(plate, finger.place_m);
        let loss = Complex64::new(1.0, plate.wave_loss_at(frequency_hz).max(1e-9));
        let axial = plate.wavenumber_squared(frequency_hz) * plate.width_mode(1).local(finger.place_m) * loss;
        let bends = plate.spec().model.bending().is_some();
        let mut waves = Vec::new();
        for mode in (1..=MODE_MAX).step_by(2) {
            let number = f64::from(mode) * FRAC_PI_2 / half_width;
            let mean = means_across(half_contact, half_width, mode);
            if mode > 1 {
                waves.push(Wave { gamma: (number * number - axial).sqrt(), mean, sign: 1.0 });
            }
            if bends {
                waves.push(Wave { gamma: (number * number + axial).sqrt(), mean, sign: -1.0 });
            }
        }
        Self { begins_m, ends_m, waves }
    }

    /// Start of column `column`, metres; for the column after the last, the end of the contact.
    pub(super) fn column_m(&self, column: usize) -> f64 {
        self.begins_m + (self.ends_m - self.begins_m) * column as f64 / COLUMNS as f64
    }

    /// Mean motion by these waves over a cell of band `k`, per unit of force on a cell of band `l` that is `apart`
    /// columns away, times S, m: [apart][k][l].
    pub(super) fn compliance(&self) -> [[[Complex64; BANDS]; BANDS]; COLUMNS] {
        let mut sum = [[[Complex64::ZERO; BANDS]; BANDS]; COLUMNS];
        let width = (self.ends_m - self.begins_m) / COLUMNS as f64;
        for wave in &self.waves {
            let gamma = wave.gamma;
            let decay = (-gamma * width).exp();
            // The double integral of e^(-gamma |x - x'|)/(2 gamma) over two columns, divided by the square of their
            // width: for one column with itself, and for two neighbours. Each further column between them adds one
            // factor of the decay.
            let scale = (gamma * gamma * gamma * width * width).inv() * wave.sign;
            let itself = (gamma * width - 1.0 + decay) * scale;
            let mut apart = 0.5 * (1.0 - decay) * (1.0 - decay) * scale;
            for (distance, block) in sum.iter_mut().enumerate() {
                let both = if distance == 0 { itself } else { apart };
                for (row, mean) in block.iter_mut().zip(wave.mean) {
                    for (term, other) in row.iter_mut().zip(wave.mean) {
                        *term += both * (mean * other);
                    }
                }
                if distance > 0 {
                    apart *= decay;
                }
            }
        }
        sum
    }

    /// Mean motion of the whole contact by these waves per unit of a force that is spread evenly over it, times S, m.
    pub(super) fn receptance(&self) -> Complex64 {
        let length = self.ends_m - self.begins_m;
        let of_wave = |wave: &Wave| {
            let (gamma, mean) = (wave.gamma, wave.mean.iter().sum::<f64>() / BANDS as f64);
            let turns = gamma * length;
            let itself = (turns - 1.0 + (-turns).exp()) / (gamma * turns * turns);
            itself * (wave.sign * mean * mean)
        };
        self.waves.iter().map(of_wave).sum()
    }

    /// The field that decays around the contact, on the centre line; `force` is that on each cell. A higher mode that
    /// propagates is left out, because it leaves the contact.
    pub(super) fn near_field(&self, force: &[[Complex64; BANDS]; COLUMNS]) -> NearField<'_> {
        let width = (self.ends_m - self.begins_m) / COLUMNS as f64;
        let waves = self.waves.iter().filter(|wave| wave.gamma.re > wave.gamma.im.abs());
        let around = waves.map(|wave| {
            let gamma = wave.gamma;
            let scale = wave.sign / (2.0 * gamma * gamma * width);
            let push: [Complex64; COLUMNS] = std::array::from_fn(|column| {
                let all: Complex64 =
                    force[column].iter().zip(wave.mean).map(|(force, mean)| force * mean).sum();
                all * scale
            });
            let from = |distance: f64| (-gamma * distance).exp();
            let (mut before, mut after) = (Complex64::ZERO, Complex64::ZERO);
            for (column, push) in push.iter().enumerate() {
                let (begins, ends) = (self.column_m(column), self.column_m(column + 1));
                before += push * (from(begins - self.begins_m) - from(ends - self.begins_m));
                after += push * (from(self.ends_m - ends) - from(self.ends_m - begins));
            }
            Around { gamma, push, before, after }
        });
        NearField { contact: self, around: around.collect() }
    }
}

/// The field that decays around the contact, times S.
pub(super) struct NearField<'a> {
    contact: &'a Contact,
    around: Vec<Around>,
}

/// One wave around the contact.
struct Around {
    gamma: Complex64,
    /// Amplitude that each column excites.
    push: [Complex64; COLUMNS],
    /// Amplitude at the start of the contact, from which it decays towards the drive.
    before: Complex64,
    /// Amplitude at the end of the contact, from which it decays away from the drive.
    after: Complex64,
}

impl NearField<'_> {
    /// The field on the centre line at `x`, N m.
    pub(super) fn at(&self, x: f64) -> Complex64 {
        let (before, after) = (self.contact.begins_m - x, x - self.contact.ends_m);
        let away = before.max(after).max(0.0);
        let near = self.around.iter().filter(|wave| wave.gamma.re * away < EXPONENTS_MAX);
        near.map(|wave| {
            let from = |distance: f64| (-wave.gamma * distance).exp();
            if before > 0.0 {
                return wave.before * from(before);
            }
            if after > 0.0 {
                return wave.after * from(after);
            }
            let columns = wave.push.iter().enumerate().map(|(column, push)| {
                let (begins, ends) = (self.contact.column_m(column), self.contact.column_m(column + 1));
                let both = if x < begins {
                    from(begins - x) - from(ends - x)
                } else if x > ends {
                    from(x - ends) - from(x - begins)
                } else {
                    2.0 - from(x - begins) - from(ends - x)
                };
                push * both
            });
            columns.sum()
        })
        .sum()
    }
}

/// Mean of the width mode `mode` (odd), which is 1 on the centre line, over each band of a contact that extends
/// `half_contact_m` to both sides.
pub(super) fn means_across(half_contact_m: f64, half_width_m: f64, mode: u32) -> [f64; BANDS] {
    let number = f64::from(mode) * PI / (2.0 * half_width_m);
    let band = half_contact_m / BANDS as f64;
    std::array::from_fn(|k| {
        let (inner, outer) = (k as f64 * band, (k as f64 + 1.0) * band);
        ((number * outer).sin() - (number * inner).sin()) / (number * band)
    })
}

/// Half-width of the supported strip that has the plate's cut-off at `x`, metres.
pub(super) fn strip_half_width(plate: &Plate, x: f64) -> f64 {
    plate.swinging_half_width_m(x) * FRAC_PI_2 / plate.width_mode(1).number
}

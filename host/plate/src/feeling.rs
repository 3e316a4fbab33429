//! The sensation of a fingertip along the plate: one model for the felt edge, the felt strip, textures and
//! merit.
//!
//! The values are illustrative and settable, because fingers differ. A tone below 20 kHz is felt as vibration above the
//! threshold at its frequency. Tones above 20 kHz together make the plate slippery, which is felt once the friction has
//! fallen by [`Feeling::least_friction_change`]. A finger feels the mean square over its contact. Threshold and
//! friction are in [`crate::check::sensation`]. Source and spread of every number are in PHYSICS.md, section 5.

use crate::check::sensation::{FrictionCurve, SLIPPERY_FROM_HZ, threshold_m};
use crate::definition::Plate;
use crate::quantity::{OutOfRange, Range, from_decibels};
use num_complex::Complex64;

/// Spread of the thresholds of persons, dB: half of it above [`Feeling`]'s own and half below. No source: a round
/// value. The conditions of the touch change a threshold by more: A. Brisben, S. Hsiao and K. Johnson (J. Neurophysiol.
/// 81, 1548, 1999) find 10 dB at 40 Hz and 19 dB at 300 Hz between a probe of 1 mm and a grasped rod.
pub const PERSONS_DB: f64 = 8.0;

/// Parameters of the sensation model. All values are illustrative.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Feeling {
    /// Threshold of vibration, in units of [`threshold_m`] at the tone's frequency; above 0.
    // JSON, 1: Threshold of the finger, over the usual one
    pub threshold: f64,
    /// Friction over ultrasonic amplitude.
    pub friction: FrictionCurve,
    /// Smallest fall of the friction that is felt, over the friction on the plate at rest; above 0, below 1.
    // JSON, 1: Least change of friction that is felt
    pub least_friction_change: f64,
    /// Length of the contact along the plate, metres; at least 0.
    // JSON: Length of the finger's contact
    pub contact_m: f64,
}

impl Default for Feeling {
    /// The threshold of [`threshold_m`], the default friction curve, a tenth less friction as just felt (D. Gueorguiev
    /// et al., J. R. Soc. Interface 14, 20170641, 2017: a Weber fraction of 0.11), a contact of 10 mm (no source: a
    /// round value).
    fn default() -> Self {
        Self {
            threshold: 1.0,
            friction: FrictionCurve::default(),
            least_friction_change: 0.1,
            contact_m: crate::frequency::CONTACT_M,
        }
    }
}

/// A tone in the field that the finger touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeltTone<'a> {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Mean square displacement at places uniform from 0 to the plate's end, metres squared.
    pub squares: &'a [f64],
}

/// The end of the felt part of the plate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum FeltEdge {
    /// Place of the edge, metres from the driven end: beyond it nothing is felt.
    At(f64),
    /// Something is felt up to the plate's end.
    PlateEnd,
    /// Nothing is felt on the whole plate.
    Nowhere,
}

/// The felt edges for persons at both ends of [`PERSONS_DB`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EdgesByPerson {
    /// Edge for a threshold higher by half of [`PERSONS_DB`].
    pub near: FeltEdge,
    /// Edge for a threshold lower by half of [`PERSONS_DB`].
    pub far: FeltEdge,
}

impl FeltEdge {
    /// The place of the edge, metres; `None` if there is no edge on the plate.
    pub fn place_m(self) -> Option<f64> {
        match self {
            Self::At(place_m) => Some(place_m),
            Self::PlateEnd | Self::Nowhere => None,
        }
    }
}

impl Feeling {
    /// These values, if each is in its range: `threshold` 0.01 to 100, `friction.scale_m` 1 nm to 1 mm,
    /// `friction.residual` 0 to 0.99, `friction.exponent` 0.1 to 10, `least_friction_change` 0.001 to 0.99, `contact_m`
    /// 0 to 100 mm.
    ///
    /// # Errors
    /// The first value that is outside its range.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        for (field, value, low, high, unit) in [
            ("feeling.threshold", self.threshold, 0.01, 100.0, ""),
            ("feeling.friction_scale_m", self.friction.scale_m, 1e-9, 1e-3, "m"),
            ("feeling.friction_residual", self.friction.residual, 0.0, 0.99, ""),
            ("feeling.friction_exponent", self.friction.exponent, 0.1, 10.0, ""),
            ("feeling.least_friction_change", self.least_friction_change, 0.001, 0.99, ""),
            ("feeling.contact_m", self.contact_m, 0.0, 0.1, "m"),
        ] {
            OutOfRange::check(field, value, Range::new(low, high, unit))?;
        }
        Ok(self)
    }

    /// Smallest displacement amplitude at which a tone of this frequency alone is felt, metres. Infinite from 20 kHz on
    /// if even the residual friction is not low enough.
    pub fn just_felt_m(&self, frequency_hz: f64) -> f64 {
        if frequency_hz < SLIPPERY_FROM_HZ {
            return self.threshold * threshold_m(frequency_hz);
        }
        let share = self.least_friction_change / (1.0 - self.friction.residual);
        if share < 1.0 {
            self.friction.scale_m * (-(1.0 - share).ln()).powf(1.0 / self.friction.exponent)
        } else {
            f64::INFINITY
        }
    }

    /// Strength of the sensation at each place, over that which is just felt. All tones have the same number of places.
    pub fn strength(&self, plate: &Plate, tones: &[FeltTone<'_>]) -> Vec<f64> {
        let places = tones.iter().map(|tone| tone.squares.len()).min().unwrap_or(0);
        let mut vibration = vec![0.0; places];
        let mut ultrasound = vec![0.0; places];
        for tone in tones {
            let (sum, share) = if tone.frequency_hz < SLIPPERY_FROM_HZ {
                (&mut vibration, self.just_felt_m(tone.frequency_hz).powi(-2))
            } else {
                (&mut ultrasound, 1.0)
            };
            for (sum, square) in sum.iter_mut().zip(tone.squares) {
                // The squared amplitude is twice the mean square.
                *sum += 2.0 * square * share;
            }
        }
        let mut strength = self.under_contact(&vibration, plate.length_m());
        strength.iter_mut().for_each(|level| *level = level.sqrt());
        // Most often no tone is ultrasonic: nothing slips.
        if tones.iter().any(|tone| tone.frequency_hz >= SLIPPERY_FROM_HZ) {
            let change =
                |square: f64| (1.0 - self.friction.ratio(square.sqrt())) / self.least_friction_change;
            let ultrasound = self.under_contact(&ultrasound, plate.length_m());
            for (strength, square) in strength.iter_mut().zip(ultrasound) {
                *strength = strength.max(change(square));
            }
        }
        strength
    }

    /// The amplitude of a tone that a finger feels at each place: the root of the mean of |w|^2 over its contact.
    pub(crate) fn contact_amplitude(&self, plate: &Plate, field: &[Complex64]) -> Vec<f64> {
        let squares: Vec<f64> = field.iter().map(Complex64::norm_sqr).collect();
        self.under_contact(&squares, plate.length_m()).into_iter().map(f64::sqrt).collect()
    }

    /// The felt edge of a strength along the plate: the last place where the strength falls to 1.
    pub fn edge(plate: &Plate, strength: &[f64]) -> FeltEdge {
        Self::edge_from(plate, strength, 1.0)
    }

    /// The felt edges for persons: for thresholds of vibration half of [`PERSONS_DB`] higher and lower, and for just
    /// felt falls of the friction that are larger and smaller by the same factor.
    pub fn edges_by_person(plate: &Plate, strength: &[f64]) -> EdgesByPerson {
        let half = from_decibels(0.5 * PERSONS_DB);
        EdgesByPerson {
            near: Self::edge_from(plate, strength, half),
            far: Self::edge_from(plate, strength, half.recip()),
        }
    }

    /// The last place where a strength falls to `least`.
    fn edge_from(plate: &Plate, strength: &[f64], least: f64) -> FeltEdge {
        let Some(last) = strength.iter().rposition(|&strength| strength >= least) else {
            return FeltEdge::Nowhere;
        };
        let Some(&beyond) = strength.get(last + 1) else { return FeltEdge::PlateEnd };
        let step_m = plate.length_m() / (strength.len() - 1) as f64;
        // Linear interpolation of the logarithm, because the amplitude falls exponentially there.
        let (felt, beyond) = ((strength[last] / least).ln(), (beyond / least).max(f64::MIN_POSITIVE).ln());
        FeltEdge::At((last as f64 + felt / (felt - beyond)) * step_m)
    }

    /// The mean over the part of the contact around each place that lies on the plate.
    fn under_contact(&self, squares: &[f64], length_m: f64) -> Vec<f64> {
        let last = squares.len().saturating_sub(1) as f64;
        let half = 0.5 * self.contact_m / length_m * last;
        if squares.len() < 2 || half <= 0.0 {
            return squares.to_vec();
        }
        // Integral from 0 to each place, by the trapezoidal rule.
        let mut integral = vec![0.0];
        let mut sum = 0.0;
        for pair in squares.windows(2) {
            sum += 0.5 * (pair[0] + pair[1]);
            integral.push(sum);
        }
        let up_to = |at: f64| {
            let before = (at as usize).min(squares.len() - 2);
            let t = at - before as f64;
            let (here, next) = (squares[before], squares[before + 1]);
            integral[before] + t * (here + 0.5 * t * (next - here))
        };
        (0..squares.len())
            .map(|place| {
                let (from, to) = ((place as f64 - half).max(0.0), (place as f64 + half).min(last));
                (up_to(to) - up_to(from)) / (to - from)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::preset;

    const PLACES: usize = 201;

    fn plate() -> Plate {
        preset("membrane").expect("a preset")
    }

    fn tone(frequency_hz: f64, squares: &[f64]) -> FeltTone<'_> {
        FeltTone { frequency_hz, squares }
    }

    #[test]
    fn a_tone_at_its_threshold_is_just_felt_and_tones_add_in_power() {
        let amplitude = threshold_m(150.0);
        let squares = vec![0.5 * amplitude * amplitude; PLACES];
        let one = Feeling::default().strength(&plate(), &[tone(150.0, &squares)]);
        assert!(one.iter().all(|strength| (strength - 1.0).abs() < 1e-12));
        let two = Feeling::default().strength(&plate(), &[tone(150.0, &squares), tone(150.0, &squares)]);
        assert!(two.iter().all(|strength| (strength - 2.0_f64.sqrt()).abs() < 1e-12));
        let dull = Feeling { threshold: 2.0, ..Feeling::default() };
        assert!(dull.strength(&plate(), &[tone(150.0, &squares)]).iter().all(|s| (s - 0.5).abs() < 1e-12));
    }

    #[test]
    fn ultrasound_is_felt_from_the_least_change_of_friction_on() {
        let feeling = Feeling::default();
        // Here 1 - mu/mu0 = 0.8 (1 - e^-(a/a0)^1.5) is 0.1.
        let amplitude = feeling.friction.scale_m * (-(1.0_f64 - 0.1 / 0.8).ln()).powf(1.0 / 1.5);
        assert!((feeling.just_felt_m(25e3) / amplitude - 1.0).abs() < 1e-12);
        let rough = FrictionCurve { residual: 0.9, ..feeling.friction };
        assert_eq!(Feeling { friction: rough, ..feeling }.just_felt_m(25e3), f64::INFINITY);
        let squares = vec![0.5 * amplitude * amplitude; PLACES];
        let strength = feeling.strength(&plate(), &[tone(25e3, &squares)]);
        assert!(strength.iter().all(|strength| (strength - 1.0).abs() < 1e-9), "{}", strength[0]);
    }

    #[test]
    fn a_value_outside_its_range_is_refused_by_its_name() {
        let usual = Feeling::default();
        assert_eq!(usual.checked(), Ok(usual));
        let friction = |change: fn(&mut FrictionCurve)| {
            let mut feeling = usual;
            change(&mut feeling.friction);
            feeling
        };
        for (feeling, field) in [
            (Feeling { threshold: 0.0, ..usual }, "feeling.threshold"),
            (friction(|curve| curve.scale_m = f64::NAN), "feeling.friction_scale_m"),
            (friction(|curve| curve.residual = 1.0), "feeling.friction_residual"),
            (friction(|curve| curve.exponent = -1.0), "feeling.friction_exponent"),
            (Feeling { least_friction_change: 0.0, ..usual }, "feeling.least_friction_change"),
            (Feeling { contact_m: f64::INFINITY, ..usual }, "feeling.contact_m"),
        ] {
            assert_eq!(feeling.checked().map_err(|refused| refused.field), Err(field));
        }
    }

    #[test]
    fn the_edge_is_where_the_strength_falls_to_one() {
        let plate = plate();
        let step_m = plate.length_m() / (PLACES - 1) as f64;
        let fall = |edge_m: f64| -> Vec<f64> {
            (0..PLACES).map(|place| (40.0 * (edge_m - place as f64 * step_m)).exp()).collect()
        };
        let FeltEdge::At(edge_m) = Feeling::edge(&plate, &fall(0.1234)) else { panic!("an edge") };
        assert!((edge_m - 0.1234).abs() < 1e-12, "{edge_m}");
        assert_eq!(Feeling::edge(&plate, &fall(-0.01)), FeltEdge::Nowhere);
        assert_eq!(Feeling::edge(&plate, &fall(plate.length_m() + 0.01)), FeltEdge::PlateEnd);
        assert_eq!(Feeling::edge(&plate, &[]), FeltEdge::Nowhere);
    }

    #[test]
    fn persons_feel_it_end_where_the_strength_is_half_of_their_spread_off() {
        let plate = plate();
        let step_m = plate.length_m() / (PLACES - 1) as f64;
        // The strength falls by 4 dB in 11.5 mm.
        let fall: Vec<f64> = (0..PLACES).map(|place| (40.0 * (0.16 - place as f64 * step_m)).exp()).collect();
        let EdgesByPerson { near, far } = Feeling::edges_by_person(&plate, &fall);
        let off_m = 0.5 * PERSONS_DB / 20.0 * std::f64::consts::LN_10 / 40.0;
        let places_m = [near, far].map(|edge| edge.place_m().expect("an edge"));
        assert!((places_m[0] - (0.16 - off_m)).abs() < 1e-12 && (places_m[1] - (0.16 + off_m)).abs() < 1e-12);
        let weak: Vec<f64> = fall.iter().map(|strength| strength * (-6.4_f64).exp() / 1.2).collect();
        assert_eq!(Feeling::edge(&plate, &weak), FeltEdge::Nowhere);
        let some = Feeling::edges_by_person(&plate, &weak);
        assert!(some.near == FeltEdge::Nowhere && some.far.place_m().is_some());
    }

    #[test]
    fn the_contact_takes_the_mean_square() {
        let plate = plate();
        // A ramp keeps its value in the middle; at the ends the mean is over the part of the contact on the plate.
        let ramp: Vec<f64> = (0..PLACES).map(|place| place as f64).collect();
        let feeling =
            Feeling { contact_m: 8.0 * plate.length_m() / (PLACES - 1) as f64, ..Feeling::default() };
        let mean = feeling.under_contact(&ramp, plate.length_m());
        assert!((mean[100] - 100.0).abs() < 1e-9 && (mean[0] - 2.0).abs() < 1e-9);
        assert!((mean[PLACES - 1] - (PLACES as f64 - 3.0)).abs() < 1e-9);
        let point = Feeling { contact_m: 0.0, ..feeling };
        assert_eq!(point.under_contact(&ramp, plate.length_m()), ramp);
    }
}

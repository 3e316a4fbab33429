//! Sensation of a finger along the plate under a steady field, by [`slipline_plate::feeling`].
//!
//! It is computed from the plate's motion without the finger, because thresholds are stated for that motion;
//! so a felt place does not depend on the finger's pressure. Illustrative: fingers differ.

use crate::field::steady_field::{SteadyField, interpolate};
use slipline_plate::check::sensation::SLIPPERY_FROM_HZ;
use slipline_plate::feeling::{EdgesByPerson, Feeling, FeltEdge, FeltTone};
use slipline_plate::second_boundary::SecondBoundary;
use slipline_plate::{Complex64, Plate};

/// Strength over the threshold from which a place is clearly felt: 6 dB.
const CLEARLY: f64 = 2.0;

/// Degree of sensation at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    /// At least twice the threshold.
    Clearly,
    /// From the threshold to twice the threshold.
    Just,
    /// Below the threshold.
    Not,
}

impl Zone {
    /// All zones, the strongest first.
    pub const ALL: [Self; 3] = [Self::Clearly, Self::Just, Self::Not];

    /// The zone of a strength.
    #[must_use]
    pub fn of(strength: f64) -> Self {
        match strength {
            strength if strength >= CLEARLY => Self::Clearly,
            strength if strength >= 1.0 => Self::Just,
            _ => Self::Not,
        }
    }

    /// Its name in the legend.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clearly => "clearly felt",
            Self::Just => "just felt",
            Self::Not => "not felt",
        }
    }
}

/// Why a tone is not felt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotFelt {
    /// On an ultrasonic plate a tone below 20 kHz does not reduce friction, and skin does not feel it as a
    /// vibration.
    BelowUltrasound,
    /// The amplitude is too low.
    TooWeak,
}

impl NotFelt {
    /// Why a tone of this frequency is not felt on this plate.
    #[must_use]
    pub fn of(plate: &Plate, frequency_hz: f64) -> Self {
        if frequency_hz < SLIPPERY_FROM_HZ && plate.band_hz().1 >= SLIPPERY_FROM_HZ {
            Self::BelowUltrasound
        } else {
            Self::TooWeak
        }
    }

    /// The reason in words.
    #[must_use]
    pub const fn reason(self) -> &'static str {
        match self {
            Self::BelowUltrasound => "below 20 kHz",
            Self::TooWeak => "too weak",
        }
    }

    /// A sentence that nothing is felt, with the reason.
    #[must_use]
    pub fn words(self) -> String {
        format!("not felt: {}", self.reason())
    }
}

/// Where the sensation ends for different persons, in words: `237 to 257 mm depending on the person`. `None` if it ends for everybody at the plate's
/// end or nowhere.
#[must_use]
pub fn by_person_words(edges: EdgesByPerson) -> Option<String> {
    by_person_places(edges).map(|places| format!("{places} depending on the person"))
}

/// The places of [`by_person_words`] alone: `237 to 257 mm`.
#[must_use]
pub fn by_person_places(EdgesByPerson { near, far }: EdgesByPerson) -> Option<String> {
    let place = |edge: FeltEdge| match edge {
        FeltEdge::At(place_m) => format!("{:.0} mm", 1e3 * place_m),
        FeltEdge::PlateEnd => "the plate's end".to_owned(),
        FeltEdge::Nowhere => "nowhere".to_owned(),
    };
    let from = match (near, far) {
        (FeltEdge::At(near_m), FeltEdge::At(_)) => format!("{:.0}", 1e3 * near_m),
        _ => place(near),
    };
    (near != far).then(|| format!("{from} to {}", place(far)))
}

/// Sensation along a plate.
#[derive(Clone, Debug)]
pub struct Felt {
    length_m: f64,
    /// Strength at places uniform from 0 to the plate's end; 1 is the threshold.
    pub strength: Vec<f64>,
    /// Where the sensation ends.
    pub edge: FeltEdge,
    /// Where it ends by person.
    pub by_person: EdgesByPerson,
    /// Half of the interval of that place on a calibrated plate, metres, from the uncertainty of the boundary
    /// and of the level. `None` for a plate that is not calibrated, and without an edge.
    pub tolerance_m: Option<f64>,
    /// Why nothing is felt, if so.
    pub not_felt: Option<NotFelt>,
    /// The harmonic of the drive that is felt most beyond the edge, where harmonics are counted in.
    pub second: Option<SecondBoundary>,
}

impl Felt {
    /// The sensation of all tones of a field without a finger.
    #[must_use]
    pub fn of(plate: &Plate, feeling: &Feeling, field: &SteadyField) -> Self {
        let tones: Vec<(f64, &[Complex64])> =
            field.tones.iter().map(|wave| (wave.tone.frequency_hz, &wave.wave[..])).collect();
        Self::of_tones(plate, feeling, &tones)
    }

    /// The sensation of these tones: the frequency of each in Hz, and its displacement amplitude at places
    /// uniform from 0 to the plate's end, in metres.
    #[must_use]
    pub fn of_tones(plate: &Plate, feeling: &Feeling, tones: &[(f64, &[Complex64])]) -> Self {
        let squares: Vec<Vec<f64>> = tones
            .iter()
            .map(|(_, wave)| wave.iter().map(|amplitude| 0.5 * amplitude.norm_sqr()).collect())
            .collect();
        let strength_of = |squares: &[Vec<f64>]| {
            let tones = tones.iter().zip(squares);
            let felt: Vec<FeltTone<'_>> =
                tones.map(|(&(frequency_hz, _), squares)| FeltTone { frequency_hz, squares }).collect();
            feeling.strength(plate, &felt)
        };
        let strength = strength_of(&squares);
        let edge = Feeling::edge(plate, &strength);
        let tolerance_m = edge.place_m().and_then(|edge_m| {
            let boundary_m = plate.boundary_tolerance_m(edge_m)?;
            let level_db = plate.spec().calibration.as_ref()?.level_tolerance_db;
            // Shift of the edge if the level is at an end of its interval.
            let moved_m = |db: f64| {
                let louder =
                    |squares: &Vec<f64>| squares.iter().map(|it| it * 10_f64.powf(0.1 * db)).collect();
                let squares: Vec<Vec<f64>> = squares.iter().map(louder).collect();
                let edge = Feeling::edge(plate, &strength_of(&squares));
                edge.place_m().map_or(0.0, |moved_m| (moved_m - edge_m).abs())
            };
            let by_level_m = level_db.map_or(0.0, |db| moved_m(db).max(moved_m(-db)));
            Some(boundary_m + by_level_m)
        });
        let highest_hz = tones.iter().map(|&(frequency_hz, _)| frequency_hz).fold(0.0, f64::max);
        let not_felt = (edge == FeltEdge::Nowhere).then(|| NotFelt::of(plate, highest_hz));
        let by_person = Feeling::edges_by_person(plate, &strength);
        let length_m = plate.length_m();
        Self { length_m, strength, edge, by_person, tolerance_m, not_felt, second: None }
    }

    /// The second boundary in words, if a finger feels one: `second boundary at 231 mm, +12 dB over the threshold`.
    #[must_use]
    pub fn second_words(&self) -> Option<String> {
        Some(self.second.filter(SecondBoundary::is_felt)?.words(self.length_m))
    }

    /// Strength at a place; 0 off the plate.
    #[must_use]
    pub fn at(&self, x_m: f64) -> f64 {
        interpolate(&self.strength, x_m / self.length_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::SteadyTone;
    use slipline_plate::Calibration;
    use slipline_plate::quantity::from_decibels;

    fn felt(name: &str, hertz: &[f64], peak_m: f64) -> Felt {
        let plate = slipline_plate::preset(name).unwrap();
        let tones: Vec<SteadyTone> =
            (0..).zip(hertz).map(|(slot, &frequency_hz)| SteadyTone { slot, frequency_hz, peak_m }).collect();
        Felt::of(&plate, &Feeling::default(), &SteadyField::solve(&plate, &tones))
    }

    #[test]
    fn a_slippery_area_ends_with_a_narrow_zone_that_is_just_felt() {
        let felt = felt("al-bending", &[25e3], 2.5e-6);
        let FeltEdge::At(edge_m) = felt.edge else { panic!("{:?}", felt.edge) };
        assert_eq!([0.02, 0.002, -0.002].map(|before_m| Zone::of(felt.at(edge_m - before_m))), Zone::ALL);
        assert!((felt.at(edge_m) - 1.0).abs() < 0.01 && felt.at(9.0) == 0.0);
        assert_eq!(felt.not_felt, None);
    }

    #[test]
    fn a_wide_peak_is_felt_by_its_amplitude_over_the_threshold() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let felt = felt("membrane", &[150.0], 1e-5);
        let strongest = felt.strength.iter().copied().fold(0.0, f64::max);
        // The mean under the contact is slightly below the peak.
        let over = 1e-5 / slipline_plate::check::sensation::threshold_m(150.0);
        assert!((0.97..1.0).contains(&(strongest / over)), "{strongest} {over}");
        assert!(felt.edge.place_m().unwrap() < plate.length_m());
    }

    #[test]
    fn the_edge_by_person_matches_a_tone_four_decibels_weaker_and_stronger() {
        for (hertz, peak_m) in [(110.0, 1e-5), (150.0, 1e-5), (180.0, 1e-5)] {
            let edge_m = |db: f64| {
                let edge = felt("membrane", &[hertz], peak_m * from_decibels(db)).edge;
                edge.place_m().unwrap()
            };
            let by_person = felt("membrane", &[hertz], peak_m).by_person;
            let (near_m, far_m) = (by_person.near.place_m().unwrap(), by_person.far.place_m().unwrap());
            assert!((near_m - edge_m(-4.0)).abs() < 1e-5 && (far_m - edge_m(4.0)).abs() < 1e-5);
            // 8 dB of threshold are 10 to 20 mm on the membrane.
            assert!((0.010..0.021).contains(&(far_m - near_m)), "{hertz} Hz: {near_m} to {far_m} m");
        }
    }

    #[test]
    fn the_edge_by_person_is_printed_in_millimetres() {
        use FeltEdge::{At, Nowhere, PlateEnd};
        let words = |near, far| by_person_words(EdgesByPerson { near, far });
        assert_eq!(words(At(0.2371), At(0.2568)).as_deref(), Some("237 to 257 mm depending on the person"));
        assert_eq!(
            words(At(0.2371), PlateEnd).as_deref(),
            Some("237 mm to the plate's end depending on the person")
        );
        assert_eq!(words(Nowhere, At(0.2568)).as_deref(), Some("nowhere to 257 mm depending on the person"));
        assert_eq!((words(Nowhere, Nowhere), words(PlateEnd, PlateEnd)), (None, None));
    }

    #[test]
    fn a_calibrated_edge_is_known_as_well_as_its_boundary_and_its_level() {
        let nominal = slipline_plate::preset("membrane").unwrap();
        let felt = |speed: f64, level_tolerance_db: Option<f64>, peak_m: f64| {
            let mut spec = nominal.spec().clone();
            spec.wave_speed_tolerance = speed;
            spec.calibration = Some(Calibration {
                chi2_per_n: 1.0,
                half_width_tolerance: 0.0,
                taper_tolerance: 0.0,
                level_tolerance_db,
                source_tolerance: None,
                correction: None,
            });
            let plate = Plate::new(spec).unwrap();
            let tones = [SteadyTone { slot: 0, frequency_hz: 150.0, peak_m }];
            Felt::of(&plate, &Feeling::default(), &SteadyField::solve(&plate, &tones))
        };
        assert_eq!(self::felt("membrane", &[150.0], 1e-5).tolerance_m, None, "not calibrated");
        let edge_m = |peak_m: f64| felt(0.0, None, peak_m).edge.place_m().unwrap();
        // 1 % of wave speed is 1 % of 1/d, about 2.2 mm.
        let by_speed_m = felt(0.01, None, 1e-5).tolerance_m.unwrap();
        assert!((1.8e-3..2.6e-3).contains(&by_speed_m), "{by_speed_m}");
        let louder = from_decibels(1.0);
        let by_level_m = felt(0.0, Some(1.0), 1e-5).tolerance_m.unwrap();
        let wanted_m = (edge_m(1e-5 * louder) - edge_m(1e-5)).max(edge_m(1e-5) - edge_m(1e-5 / louder));
        assert!(wanted_m > 1e-4 && (by_level_m / wanted_m - 1.0).abs() < 1e-3, "{by_level_m} {wanted_m}");
        let both_m = felt(0.01, Some(1.0), 1e-5).tolerance_m.unwrap();
        assert!((both_m - by_speed_m - by_level_m).abs() < 1e-9);
        assert_eq!(felt(0.01, Some(1.0), 1e-9).tolerance_m, None, "nothing is felt");
    }

    #[test]
    fn the_highest_tone_decides_why_nothing_is_felt() {
        for (name, hertz, peak_m, why) in [
            ("al-bending", &[19.5e3][..], 2.5e-6, Some(NotFelt::BelowUltrasound)),
            ("al-bending", &[19.5e3, 25e3], 1e-8, Some(NotFelt::TooWeak)),
            ("al-bending", &[19.5e3, 25e3], 2.5e-6, None),
            ("membrane", &[150.0], 1e-9, Some(NotFelt::TooWeak)),
        ] {
            assert_eq!(felt(name, hertz, peak_m).not_felt, why, "{name} {hertz:?} {peak_m}");
        }
    }
}

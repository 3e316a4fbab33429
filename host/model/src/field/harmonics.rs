//! What the drive's harmonics add to a setup's field: their waves, and the second boundaries that a finger feels.
//!
//! A plate file without harmonics adds nothing, and nothing is computed. The line of a tone stays that of the tone itself.

use crate::field::felt::Felt;
use crate::field::steady_field::{POINTS, SteadyField, ToneWave};
use crate::setup::{Setup, ToneSetup};
use slipline_plate::feeling::{FeltEdge, FeltTone};
use slipline_plate::intermodulation::products;
use slipline_plate::second_boundary::{DrivenTone, HarmonicWave, SecondBoundary};

/// A setup's tone by its drive; `wave` is that of the tone in metres of displacement, without a finger.
fn driven(setup: &Setup, tone: &ToneSetup, wave: &ToneWave) -> DrivenTone {
    DrivenTone {
        frequency_hz: wave.tone.frequency_hz,
        level: setup.played_level(tone),
        drive_m: wave.drive_m.into(),
    }
}

/// The waves of the harmonics of a setup's tone; `wave` is that of the tone in metres of displacement, without a finger.
#[must_use]
pub fn waves_of(setup: &Setup, tone: &ToneSetup, wave: &ToneWave) -> Vec<HarmonicWave> {
    // Three times the frequency of a tone far beyond the span may be out of range. Such a harmonic does not turn on the plate.
    HarmonicWave::of_tone(&setup.plate, &driven(setup, tone, wave), POINTS).unwrap_or_default()
}

/// The second boundary of a tone that a finger feels most, beyond its felt edge `edge`. `None` for a plate file without harmonics, and
/// where the tone is felt up to the plate's end.
#[must_use]
pub fn second_boundary(
    setup: &Setup,
    tone: &ToneSetup,
    wave: &ToneWave,
    edge: FeltEdge,
) -> Option<SecondBoundary> {
    let waves = waves_of(setup, tone, wave);
    SecondBoundary::loudest(&SecondBoundary::each(&setup.plate, &setup.feeling, edge, &waves))
}

/// The sensation of all tones of a setup with the harmonics of the drive; `field` is that of the setup without a finger. The felt
/// edge is that of the tones themselves.
#[must_use]
pub fn felt_with_harmonics(setup: &Setup, field: &SteadyField) -> Felt {
    let plate = &setup.plate;
    let mut felt = Felt::of(plate, &setup.feeling, field);
    if plate.spec().harmonics.is_none() {
        return felt;
    }
    let placed: Vec<(&ToneSetup, &ToneWave)> =
        field.tones.iter().filter_map(|wave| Some((setup.tone(wave.tone.slot)?, wave))).collect();
    let waves: Vec<HarmonicWave> =
        placed.iter().flat_map(|(tone, wave)| waves_of(setup, tone, wave)).collect();
    felt.second = SecondBoundary::loudest(&SecondBoundary::each(plate, &setup.feeling, felt.edge, &waves));
    let all_driven: Vec<DrivenTone> = placed.iter().map(|(tone, wave)| driven(setup, tone, wave)).collect();
    let of_tone = |wave: &ToneWave| wave.wave.iter().map(|f| 0.5 * f.norm_sqr()).collect();
    let of_tones = field.tones.iter().map(|wave| (wave.tone.frequency_hz, of_tone(wave)));
    let mut all: Vec<(f64, Vec<f64>)> = of_tones.collect();
    all.extend(products(plate, &all_driven, POINTS).unwrap_or_default());
    let tones: Vec<FeltTone<'_>> =
        all.iter().map(|(hz, squares)| FeltTone { frequency_hz: *hz, squares }).collect();
    felt.strength = setup.feeling.strength(plate, &tones);
    felt
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::felt::Zone;
    use crate::field::steady_field::steady_tones;
    use crate::field::tone_places::TonePlaces;
    use slipline_plate::{DriveTable, Harmonics, KNOTS_MAX, Plate, PlateSpec, ResponseCurve, preset};
    use std::sync::Arc;

    fn distorting(level: f64) -> Setup {
        let flat = |db: f64| ResponseCurve { points: vec![[50.0, db, 0.0], [500.0, db, 0.0]] };
        let harmonics = Harmonics { level: 0.8, second: Some(flat(-40.0)), third: Some(flat(-46.0)) };
        let spec = preset("membrane").unwrap().spec().clone();
        let plate = Plate::new(PlateSpec { harmonics: Some(harmonics), ..spec }).unwrap();
        let mut setup = Setup::new(Arc::new(plate));
        setup.tones.truncate(1);
        (setup.tones[0].position_m, setup.tones[0].level, setup.master_db) = (0.08, level, 0.0);
        setup
    }

    #[test]
    fn a_strip_shows_the_second_boundary_and_keeps_the_edge_of_the_tone() {
        let setup = distorting(0.8);
        let table = DriveTable::build(&setup.plate, 400e3, KNOTS_MAX).unwrap();
        let clean = Setup::new(Arc::new(preset("membrane").unwrap()));
        let clean = Setup { tones: setup.tones.clone(), master_db: 0.0, ..clean };
        let felt = |setup: &Setup| {
            let field = SteadyField::solve(&setup.plate, &steady_tones(setup, Some(&table)));
            felt_with_harmonics(setup, &field)
        };
        let (with, without) = (felt(&setup), felt(&clean));
        assert_eq!((with.edge, without.second), (without.edge, None));
        let second = with.second.expect("felt");
        assert!((second.turning_point_m - 0.2314).abs() < 1e-3 && second.order == 2, "{second:?}");
        assert_eq!((Zone::of(with.at(0.215)), Zone::of(without.at(0.215))), (Zone::Clearly, Zone::Not));
        let words = TonePlaces::of(&setup, &setup.tones[0], &table).felt_words();
        assert!(words.ends_with("; second boundary at 231 mm, +12 dB over the threshold"), "{words}");
        assert!(!TonePlaces::of(&clean, &clean.tones[0], &table).felt_words().contains("second"));
    }

    #[test]
    fn ten_decibels_less_level_take_twenty_from_the_second_harmonic() {
        let squares = |level: f64| {
            let setup = distorting(level);
            let table = DriveTable::build(&setup.plate, 400e3, KNOTS_MAX).unwrap();
            let field = SteadyField::solve(&setup.plate, &steady_tones(&setup, Some(&table)));
            let waves = waves_of(&setup, &setup.tones[0], &field.tones[0]);
            waves.into_iter().map(|wave| wave.squares()[200]).collect::<Vec<f64>>()
        };
        for ((loud, soft), fall_db) in
            squares(0.8).into_iter().zip(squares(0.8 / 10_f64.sqrt())).zip([20.0, 30.0])
        {
            assert!((10.0 * (loud / soft).log10() - fall_db).abs() < 1e-6, "{fall_db}");
        }
    }
}

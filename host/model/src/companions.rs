//! Tones at rest whose harmonics are cancelled: each with companions at twice and three times its frequency, as one comb.
//!
//! ```text
//! setup, plate file with harmonics, device's table --> a base frequency of which all tones are multiples
//!                                                  --> f, 2f, 3f of each tone, the upper two opposite to the drive's harmonics
//! ```
//! What the drive adds at the sums of several tones' frequencies stays. The companions are tones of the same comb, so they stand still against their tone. While a tone glides its companions would have
//! to follow it, which no message of the protocol asks for.

use crate::setup::{Setup, ToneSetup};
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::limits::{COMB_BLOCK, MAX_FREQUENCY_PER_MILLE, MAX_TONES};
use slipline_link::{CombRequest, DeviceTable, HarmonicRequest};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::show_frequency;
use slipline_plate::{Companion, Harmonics};
use thiserror::Error;

/// Shortest and longest period of a comb that is tried, in blocks: from 10 ms to 21 s at 400 kS/s.
const PERIOD_BLOCKS: (u16, u16) = (32, u16::MAX);
/// Relative error of a frequency at which the search ends: it moves a boundary by some micrometres.
const CLOSE: f64 = 2e-5;
/// Largest relative error of a frequency: a boundary then moves by a tenth of a millimetre.
const FARTHEST: f64 = 5e-4;

/// Why the harmonics of a setup cannot be cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoCompanions {
    /// The plate file states no harmonics.
    #[error(
        "the plate file states no harmonics of the drive that could be cancelled: `slipline measure --harmonics` finds them"
    )]
    NoHarmonics,
    /// More tones than have room with their companions.
    #[error("{tones} tones with their companions need {slots} slots of the device, which has {}", MAX_TONES)]
    TooMany {
        /// The setup's tones.
        tones: usize,
        /// They and their companions.
        slots: usize,
    },
    /// No base frequency has all tones as multiples, each another one.
    #[error(
        "no comb has all tones with their companions as multiples of its base frequency: move one of them a little"
    )]
    Crowded,
    /// A tone is outside the table's span.
    #[error("a tone is outside the span of the device's table")]
    OffSpan,
    /// A companion is above the device's highest frequency.
    #[error("a companion at {} is above the device's highest frequency", show_frequency(*.0))]
    TooHigh(f64),
    /// The amplitudes exceed full scale.
    #[error(
        "the tones with their companions need {} of full scale: lower the level by {} dB",
        with_decimals(*.0, 3),
        with_decimals(20.0 * .0.log10() + 0.05, 1)
    )]
    TooLoud(f64),
}

/// A tone of the comb before its multiple is known.
struct Part {
    /// The index of the setup's tone, and its order: 1, 2 or 3.
    of: usize,
    order: u8,
    level: f64,
    phase_turns: f64,
}

/// The comb that plays the tones of a setup with the companions that cancel the drive's harmonics; `table` is that of the setup's plate
/// on a device. It begins in silence, and no tone glides.
///
/// # Errors
/// [`NoCompanions`].
pub fn with_companions(setup: &Setup, table: &DeviceTable) -> Result<CombRequest, NoCompanions> {
    let plate = &setup.plate;
    let Some(harmonics) = &plate.spec().harmonics else { return Err(NoCompanions::NoHarmonics) };
    let stated = Harmonics::ORDERS.into_iter().filter(|order| harmonics.curve(*order).is_some()).count();
    let (tones, slots) = (setup.tones.len(), setup.tones.len() * (1 + stated));
    if slots > MAX_TONES {
        return Err(NoCompanions::TooMany { tones, slots });
    }
    let rate_hz = f64::from(table.header().sample_rate_hz);
    let frequency_hz = |tone: &ToneSetup| table.position(tone.position_m).map(|at| table.frequency_hz(at));
    let frequencies_hz: Option<Vec<f64>> = setup.tones.iter().map(frequency_hz).collect();
    let frequencies_hz = frequencies_hz.ok_or(NoCompanions::OffSpan)?;
    let top_hz = frequencies_hz.iter().copied().fold(0.0, f64::max) * f64::from(1 + stated as u8);
    if top_hz > rate_hz * f64::from(MAX_FREQUENCY_PER_MILLE) / 1000.0 {
        return Err(NoCompanions::TooHigh(top_hz));
    }
    let gain = |hz: f64| table.gain_of_turns(hz / rate_hz);
    let mut parts = Vec::with_capacity(slots);
    let mut sum = 0.0;
    for (of, (tone, &hz)) in setup.tones.iter().zip(&frequencies_hz).enumerate() {
        let amplitude = tone.level * gain(hz);
        parts.push(Part { of, order: 1, level: tone.level, phase_turns: tone.phase_turns });
        sum += amplitude * setup.master();
        for Companion { order, ratio, phase_turns } in
            plate.companions(hz, tone.level * setup.master(), rate_hz)
        {
            let turns = f64::from(order) * tone.phase_turns + phase_turns;
            let level = amplitude * ratio / gain(f64::from(order) * hz);
            parts.push(Part { of, order, level, phase_turns: turns.rem_euclid(1.0) });
            sum += amplitude * ratio * setup.master();
        }
    }
    if sum > 1.0 || parts.iter().any(|part| part.level > 1.0) {
        return Err(NoCompanions::TooLoud(parts.iter().map(|part| part.level).fold(sum, f64::max)));
    }
    let (period_blocks, multiples) = base(&frequencies_hz, 1 + stated as u8, rate_hz)?;
    let multiple = |part: &Part| multiples[part.of] * u16::from(part.order);
    let mut tones: Vec<HarmonicRequest> = parts
        .iter()
        .map(|part| HarmonicRequest {
            harmonic: multiple(part),
            level: part.level,
            phase_turns: part.phase_turns,
        })
        .collect();
    tones.sort_by_key(|tone| tone.harmonic);
    let (master_db, glide_s) = (setup.master_db, setup.glide_s);
    Ok(CombRequest { period_blocks, tones, master_db, glide_s, apply: Apply::Next })
}

/// The comb's period in blocks, and the multiple of its base frequency for each tone: the shortest period that is close enough, else the
/// closest one. With their companions, up to `orders` times the multiple, no two tones share one.
fn base(frequencies_hz: &[f64], orders: u8, rate_hz: f64) -> Result<(u16, Vec<u16>), NoCompanions> {
    let mut best: Option<(f64, u16, Vec<u16>)> = None;
    for period_blocks in PERIOD_BLOCKS.0..=PERIOD_BLOCKS.1 {
        let period_s = f64::from(COMB_BLOCK) * f64::from(period_blocks) / rate_hz;
        let wanted = frequencies_hz.iter().map(|hz| hz * period_s);
        let most = f64::from(u16::MAX) / f64::from(orders);
        if wanted.clone().any(|multiple| multiple > most) {
            break;
        }
        let error = wanted.clone().map(|it| (it.round() / it - 1.0).abs()).fold(0.0, f64::max);
        if best.as_ref().is_some_and(|(least, ..)| error >= *least) {
            continue;
        }
        let multiples: Vec<u16> = wanted.map(|it| it.round() as u16).collect();
        let mut all: Vec<u16> =
            multiples.iter().flat_map(|it| (1..=u16::from(orders)).map(move |order| it * order)).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        if all.len() == count && all[0] > 0 {
            best = Some((error, period_blocks, multiples));
            if error < CLOSE {
                break;
            }
        }
    }
    best.filter(|(error, ..)| *error < FARTHEST)
        .map(|(_, period_blocks, multiples)| (period_blocks, multiples))
        .ok_or(NoCompanions::Crowded)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::table_for;
    use slipline_plate::{Plate, PlateSpec, ResponseCurve, preset};
    use std::sync::Arc;

    fn setup(places_m: &[f64], level: f64, third: bool) -> Setup {
        let flat = |db: f64| Some(ResponseCurve { points: vec![[50.0, db, 0.0], [500.0, db, 0.0]] });
        let harmonics =
            Harmonics { level: 0.8, second: flat(-40.0), third: if third { flat(-46.0) } else { None } };
        let spec = preset("membrane").unwrap().spec().clone();
        let plate = Plate::new(PlateSpec { harmonics: Some(harmonics), ..spec }).unwrap();
        let mut setup = Setup::new(Arc::new(plate));
        setup.master_db = 0.0;
        setup.tones = (0..)
            .zip(places_m)
            .map(|(slot, &position_m)| ToneSetup { slot, position_m, level, phase_turns: 0.125 })
            .collect();
        setup
    }

    #[test]
    fn a_tone_has_companions_of_the_stated_level_at_twice_and_three_times_its_frequency() {
        let setup = setup(&[0.12], 0.8, true);
        let (_, table) = table_for(&setup.plate, 400_000).unwrap();
        let comb = with_companions(&setup, &table).unwrap();
        let [one, two, three] = comb.tones[..] else { panic!("{comb:?}") };
        assert_eq!((two.harmonic, three.harmonic), (2 * one.harmonic, 3 * one.harmonic));
        let base_hz = 400e3 / (128.0 * f64::from(comb.period_blocks));
        let hertz = table.frequency_hz(table.position(0.12).unwrap());
        assert!((f64::from(one.harmonic) * base_hz / hertz - 1.0).abs() < CLOSE);
        let amplitude = |tone: &HarmonicRequest| {
            tone.level * table.gain_of_turns(f64::from(tone.harmonic) * base_hz / 400e3)
        };
        for (companion, db) in [(two, -40.0), (three, -46.0)] {
            let is_db = 20.0 * (amplitude(&companion) / amplitude(&one)).log10();
            assert!((is_db - db).abs() < 0.01, "{is_db}");
        }
        // 10 dB less level: 20 dB less of the second.
        let quiet = Setup { master_db: -10.0, ..setup };
        let less = with_companions(&quiet, &table).unwrap();
        assert!(
            (20.0 * (less.tones[1].level / two.level).log10() + 10.0).abs() < 1e-9,
            "and the master level"
        );
    }

    #[test]
    fn five_tones_have_room_with_their_companions_and_what_has_none_is_refused_with_the_reason() {
        let (_, table) = table_for(&setup(&[0.1], 0.1, true).plate, 400_000).unwrap();
        let made = |places_m: &[f64], level: f64| with_companions(&setup(places_m, level, true), &table);
        let comb = made(&[0.09, 0.12, 0.16, 0.2, 0.25], 0.15).unwrap();
        assert_eq!(comb.tones.len(), 15);
        assert!(comb.tones.windows(2).all(|pair| pair[0].harmonic < pair[1].harmonic));
        let refused = made(&[0.09, 0.1, 0.11, 0.12, 0.13, 0.14], 0.1).unwrap_err();
        assert_eq!(refused, NoCompanions::TooMany { tones: 6, slots: 18 });
        let loud = made(&[0.1, 0.2], 0.8).unwrap_err();
        assert!(
            matches!(loud, NoCompanions::TooLoud(sum) if sum > 1.0) && loud.to_string().contains("dB"),
            "{loud}"
        );
        let clean = Setup::new(Arc::new(preset("membrane").unwrap()));
        assert_eq!(with_companions(&clean, &table), Err(NoCompanions::NoHarmonics));
    }
}

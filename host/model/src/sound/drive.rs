//! The drive itself as sound: for a voice coil at the output of a sound card.

use super::{Partial, Sound};
use crate::sounding::SoundingDrive;
use slipline_link::PlayedTone;

/// The highest frequency that is played, in Hz: sound cards and amplifiers are made for hearing; above it a
/// boundary's level would depend on the device in use.
pub const HIGHEST_DRIVE_HZ: f64 = 1_000.0;

/// The device's output to its amplifier, up to [`HIGHEST_DRIVE_HZ`]: the tones with the table's gains, levels
/// and master, times the factor `foldback_per_mille` of the device's thermal limit.
#[must_use]
pub fn of_drive(sounding: &SoundingDrive, foldback_per_mille: u16) -> Sound {
    let left = f64::from(foldback_per_mille.min(1000)) / 1000.0;
    let partial = |PlayedTone { slot, frequency_hz, amplitude, .. }| Partial {
        slot,
        frequency_hz,
        amplitude: amplitude * left,
    };
    let partials = sounding.played.tones(&sounding.table).into_iter().map(partial);
    Sound {
        partials: partials.filter(|partial| partial.frequency_hz <= HIGHEST_DRIVE_HZ).collect(),
        noise: 0.0,
    }
}

/// The lowest frequency of a drive that is not played because it is above [`HIGHEST_DRIVE_HZ`], in Hz.
#[must_use]
pub fn left_out_hz(sounding: &SoundingDrive) -> Option<f64> {
    let frequencies = sounding.tones.iter().map(|tone| tone.frequency_hz);
    frequencies.filter(|&frequency_hz| frequency_hz > HIGHEST_DRIVE_HZ).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::device_table;
    use crate::field::steady_field::SteadyTone;
    use slipline_link::protocol::command::{Apply, Drive, Tone};
    use slipline_link::protocol::units::{CentiDecibel, Gain, Level, Phase, Position};
    use std::sync::Arc;

    fn drive(preset: &str, level: u16, master: i16) -> SoundingDrive {
        let plate = slipline_plate::preset(preset).unwrap();
        let table = slipline_plate::DriveTable::build(&plate, 400e3, 65).unwrap();
        let table = Arc::new(device_table(&table).unwrap());
        let tone = Tone { slot: 3, position: Position(30_000), level: Level(level), phase: Phase(0) };
        let steady = SteadyTone { slot: 3, frequency_hz: table.frequency_hz(tone.position), peak_m: 1e-4 };
        let tones = [tone].into_iter().collect();
        let drive = Drive { tones, master: CentiDecibel(master), glide: 400, apply: Apply::Next };
        let played = drive.into();
        SoundingDrive { number: 1, played, table, tones: vec![steady], began: 0, reached: 0 }
    }

    #[test]
    fn the_sound_equals_the_codes_that_the_device_sends() {
        let full = drive("membrane", u16::MAX, 0);
        let gain = f64::from(full.table.setting(Position(30_000).fine()).gain.0) / f64::from(Gain::FULL.0);
        let [partial] = of_drive(&full, 1000).partials[..] else { panic!("one tone") };
        assert_eq!((partial.slot, partial.frequency_hz), (3, full.tones[0].frequency_hz));
        assert!((partial.amplitude - gain).abs() < 1e-12 && gain > 0.01);
        let amplitude = |drive: &SoundingDrive, foldback| of_drive(drive, foldback).partials[0].amplitude;
        assert!((amplitude(&full, 250) / gain - 0.25).abs() < 1e-12);
        assert!((amplitude(&drive("membrane", u16::MAX, -600), 1000) / gain - 0.501_187).abs() < 1e-6);
        assert!((amplitude(&drive("membrane", 13_107, 0), 1000) / gain - 0.2).abs() < 1e-6);
        assert_eq!(left_out_hz(&full), None);
    }

    #[test]
    fn what_a_sound_card_cannot_drive_is_left_out_and_reported() {
        let ultrasound = drive("al-bending", u16::MAX, 0);
        assert!(of_drive(&ultrasound, 1000).is_silent());
        assert_eq!(left_out_hz(&ultrasound), Some(ultrasound.tones[0].frequency_hz));
    }
}

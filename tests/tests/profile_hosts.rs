//! Random hosts against the actuator's profile, in front of a model of the actuator: amplitude, travel, rise and time.

use crate::profile::{armed, flash_with, plain};
use proptest::prelude::*;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_protocol::command::{ArmLease, DigestWindow, TravelSetting};
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::hold::{HoldSetting, HoldTone};
use slipline_protocol::limits::{HOLD_PAUSE_BLOCKS, STOP_RAMP_MS};
use slipline_protocol::profile::{ActuatorProfile, TravelLimit};
use slipline_protocol::refusal::Field;
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::measure::peak;
use slipline_tests::rig::{BLOCK, MID, RATE_HZ, Rig, Table, chord, comb, drive};
use std::f64::consts::TAU;

/// Codes from mid-scale to full scale.
const FULL: f64 = 2047.0;
const RESONANCE_HZ: f64 = 30_000.0;
const QUALITY: f64 = 4.0;
/// Samples, long enough for the actuator to follow.
const GLIDE: u32 = 2000;
const UNLIMITED: Command = Command::SetTravelLimit(TravelSetting { limit: None });

/// A profile with a resonance in the middle of the usual table; `static_travel` as a share of the peak travel.
fn resonant(max_sum_per_mille: u16, static_travel: f64) -> ActuatorProfile {
    let travel = TravelLimit {
        resonance_uhz: (RESONANCE_HZ * 1e6) as u64,
        quality_per_mille: (QUALITY * 1e3) as u32,
        static_ppm: (static_travel * 1e6) as u32,
    };
    ActuatorProfile { max_sum_per_mille, travel: Some(travel), ..plain() }
}

/// The largest deflection, of the peak travel, of a mass on a spring that a voltage of these codes, held from each to the next,
/// drives: `x'' + w/Q x' + w^2 (x - static_travel u) = 0`, in closed form for each sample.
fn travel(codes: &[u16], static_travel: f64) -> f64 {
    let resonance = TAU * RESONANCE_HZ;
    let decay = resonance / (2.0 * QUALITY);
    let ringing = (resonance * resonance - decay * decay).sqrt();
    let step = 1.0 / f64::from(RATE_HZ);
    let (sine, cosine, left) = ((ringing * step).sin(), (ringing * step).cos(), (-decay * step).exp());
    let (mut place, mut speed, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
    for &code in codes {
        let rest = static_travel * (f64::from(code) - f64::from(MID)) / FULL;
        let away = place - rest;
        place = rest + left * (away * cosine + (speed + decay * away) / ringing * sine);
        speed = left * (speed * cosine - (decay * speed + resonance * resonance * away) / ringing * sine);
        most = most.max(place.abs());
    }
    most
}

/// Something that a client does with these random numbers from 0 to 1.
#[derive(Clone, Debug)]
struct Act {
    kind: u8,
    minor: u8,
    place: f64,
    level: f64,
    other: f64,
    pause_ms: u32,
}

fn acts() -> impl Strategy<Value = Vec<Act>> {
    let act = (0u8..10, 0u8..=3, 0.0..1.0, 0.0..1.0, 0.0..1.0, 1u32..25).prop_map(
        |(kind, minor, place, level, other, pause_ms)| Act { kind, minor, place, level, other, pause_ms },
    );
    prop::collection::vec(act, 1..14)
}

/// Sends what an act says, whatever the device answers, and lets time pass.
fn perform(rig: &mut Rig, Act { kind, minor, place, level, other, pause_ms }: Act) {
    match kind {
        0..=2 => {
            rig.send(&Command::Drive(drive(&[(0, place, level), (1, other, level * other)], GLIDE)));
        }
        3 => {
            // Of 390.6 Hz: 20 to 60 kHz.
            let harmonic = 52 + (place * 100.0) as u16;
            let tones = [(harmonic, level, 0.0), (52 + (other * 100.0) as u16, other, 0.5)];
            rig.send(&Command::Chord(chord(10, &tones)));
        }
        4 => {
            let tones = [(100 + (place * 200.0) as u16, level, 0.0), (200, other * 0.3, 0.25)];
            rig.send(&Command::Comb(comb(16, &tones)));
        }
        5 => {
            rig.send(&Command::Stop);
            rig.live_ms(2 * STOP_RAMP_MS);
        }
        6 => {
            rig.hello_of_minor(minor);
            rig.live_ms(2 * STOP_RAMP_MS);
            rig.send(&Command::Arm);
        }
        7 => {
            // A table whose frequencies go through the resonance elsewhere, while another sounds.
            let table =
                Table::line(33, 20_000.0 + 40_000.0 * place, 20_000.0 + 40_000.0 * other, |_| level.max(0.1));
            rig.send(&Command::TableBegin(table.header));
            for chunk in table.chunks() {
                rig.send(&Command::TableChunk(chunk));
            }
            rig.send(&Command::TableCommit);
        }
        8 => {
            rig.send(&UNLIMITED);
        }
        _ => {
            rig.send(&Command::Disarm);
            rig.live_ms(2 * STOP_RAMP_MS);
            rig.send(&Command::Arm);
        }
    }
    rig.live_ms(pause_ms);
}

#[test]
fn the_model_moves_by_what_the_limit_says() {
    // At its resonance a tone of level 1 moves it by Q times the static travel, 2; the table's gain there is 0.875.
    let mut rig = armed(resonant(1000, 0.5), 3);
    let tone = |level| Command::Drive(drive(&[(0, 0.75, level)], GLIDE));
    let loud = rig.refused(&tone(1.0));
    let Refusal::Travel { travel_per_mille, allowed_per_mille } = loud else { panic!("{loud:?}") };
    assert!((1750..1760).contains(&travel_per_mille), "{travel_per_mille}");
    rig.record();
    rig.accepted(&tone(f64::from(allowed_per_mille) / 1000.0));
    rig.live_ms(30);
    let most = travel(&rig.recording.codes, 0.5);
    assert!((0.98..1.005).contains(&most), "{most}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn whatever_a_host_does_the_actuator_keeps_within_its_amplitude_and_travel(
        max_sum_per_mille in 100u16..=1000,
        static_travel in 0.1..3.0,
        minor in 0u8..=3,
        acts in acts(),
    ) {
        //
        let mut rig = armed(resonant(max_sum_per_mille, static_travel), minor);
        rig.record();
        for act in acts {
            perform(&mut rig, act);
        }
        // A code is rounded.
        let most = FULL * f64::from(max_sum_per_mille) / 1000.0 + 1.0;
        prop_assert!(f64::from(peak(&rig.recording.codes)) <= most, "{} of {most}", peak(&rig.recording.codes));
        // What a change adds as free motion, and the noise of the codes.
        let most = travel(&rig.recording.codes, static_travel);
        prop_assert!(most <= 1.03, "{most} of the peak travel");
    }
}

/// A sensor that hears this share of the codes.
struct Slipped(f64);

impl SimulatedInputs for Slipped {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn sample(&mut self, codes: &[u16; BLOCK as usize], _: bool, sensed: &mut [[u16; BLOCK as usize]; 2]) {
        for (code, sensor) in codes.iter().zip(&mut sensed[0]) {
            let swing = f64::from(*code) - f64::from(MID);
            *sensor = (f64::from(MID) + self.0 * swing).round().clamp(0.0, 4095.0) as u16;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn whatever_rise_a_host_asks_for_no_tone_rises_beyond_the_profiles(
        max_rise in 0i16..=1200,
        asked in 0i16..=2000,
        level in 0.05..0.2,
        heard in 0.1..0.9,
    ) {
        //
        let flash = flash_with(ActuatorProfile { max_rise: CentiDecibel(max_rise), ..plain() });
        let options = Options { flash, ..Options::default() };
        let mut rig = Rig::of(SimulatedDevice::with_inputs(options, Box::new(Slipped(heard))));
        rig.hello();
        rig.upload(&Table::line(65, 60_000.0, 20_000.0, |_| 1.0));
        rig.arm();
        rig.accepted(&Command::Drive(drive(&[(0, 0.4, level)], GLIDE)));
        rig.live_ms(10);
        let blocks = 40;
        let hold = Command::Hold(HoldSetting {
            input: 0,
            time_constant: 0,
            blocks,
            max_rise: CentiDecibel(asked),
            slew: CentiDecibel(602),
            // All of the drive, of which the sensor hears a part.
            tones: [HoldTone { slot: 0, amplitude: (FULL * level * 256.0) as u32 }].into_iter().collect(),
        });
        rig.record();
        if asked > max_rise {
            let refusal = rig.refused(&hold);
            let is_named = matches!(refusal, Refusal::OutOfRange { field: Field::MaxRise, max, .. } if max == i64::from(max_rise));
            prop_assert!(is_named, "{refusal:?}");
        } else {
            rig.accepted(&hold);
        }
        rig.live_blocks(12 * u64::from(blocks + HOLD_PAUSE_BLOCKS));
        let rise = f64::from(asked.min(max_rise)) / 2000.0;
        let most = FULL * level * 10.0_f64.powf(rise) * 1.002 + 1.0;
        let found = f64::from(peak(&rig.recording.codes));
        prop_assert!(found <= most, "{found} of {most}");
        let lost = -20.0 * heard.log10();
        if asked <= max_rise && f64::from(asked) / 100.0 > lost {
            // There it is given back: the test hears a hold at work.
            prop_assert!(found > 0.97 * FULL * level / heard, "{found}");
        }
    }

    #[test]
    fn whatever_else_a_host_sends_a_drive_ends_after_the_profiles_time(
        max_drive_ms in 1000u32..4000,
        minor in 0u8..=3,
        sent in prop::collection::vec(0u8..8, 12),
    ) {
        // at 8 kS/s, so that seconds are few blocks.
        let flash = flash_with(ActuatorProfile { max_drive_ms, ..plain() });
        let mut rig = Rig::new(Options { sample_rate_hz: 8000, flash, ..Options::default() });
        rig.hello_of_minor(minor);
        let table = Table::usual().at_rate(8000);
        rig.upload(&table);
        rig.arm();
        let at = rig.accepted(&Command::Drive(drive(&[(0, 0.5, 0.5)], 100)));
        rig.record();
        for kind in sent {
            match kind {
                0 => rig.send(&Command::Arm),
                1 => rig.send(&Command::ArmFor(ArmLease { lease_ms: 600_000 })),
                2 => rig.send(&Command::Status),
                3 => rig.send(&UNLIMITED),
                4 => rig.send(&Command::TableDigest),
                5 => rig.send(&Command::ClearFaults),
                6 => rig.send(&Command::DigestStart(DigestWindow { from: rig.device.now() + 1000, count: 100 })),
                // Refused: it names a slot that there is not.
                _ => rig.send(&Command::Drive(drive(&[(16, 0.5, 0.5)], 100))),
            };
            rig.live_ms(400);
        }
        let end = rig.recording.end_of_sound();
        let latest = at + rig.samples(max_drive_ms + STOP_RAMP_MS) + 20 * BLOCK;
        prop_assert!(end.is_some_and(|end| (latest - 22 * BLOCK..=latest).contains(&end)), "{end:?} {latest}");
        let status = rig.status();
        let is_over = status.first_fault == Some(Fault::DriveTime) || status.state != State::Driving;
        prop_assert!(is_over, "{status:?}");
        prop_assert!(matches!(rig.send(&Command::Status), Event::Status(_)));
    }
}

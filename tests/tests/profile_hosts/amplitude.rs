//! Single drives against the profile: their travel, the rise of their hold, and their way to silence.

use super::*;

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
    let most = travel(&rig.recording.codes, &resonator(0.5));
    assert!((0.98..1.005).contains(&most), "{most}");
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
        rig.play(&[(0, 0.4, level)], GLIDE, 10);
        let blocks = 40;
        let hold = Command::Hold(HoldSetting {
            input: 0,
            time_constant: 0,
            blocks,
            max_rise: CentiDecibel(asked),
            slew: CentiDecibel(602),
            // The whole drive; the sensor receives a part of it.
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
            // There it is given back: the test sees a hold at work.
            prop_assert!(found > 0.97 * FULL * level / heard, "{found}");
        }
    }
}

#[test]
fn no_fade_to_silence_exceeds_the_profiles_amplitude() {
    // the drive keeps within a tenth of full scale where the table's gain is low; a drive to level 0 leads it, while it still
    // sounds, to where the gain is high.
    let quiet = ActuatorProfile { max_sum_per_mille: 100, ..plain() };
    let mut rig = armed(quiet, 3);
    rig.accepted(&Command::Stop);
    rig.live_ms(60);
    rig.upload(&Table::line(33, 60_000.0, 20_000.0, |u| if u < 0.1 { 0.1 } else { 1.0 }));
    rig.play(&[(0, 0.0, 0.9)], GLIDE, 10);
    rig.record();
    let fades = Command::Drive(drive(&[(0, 1.0, 0.0)], 20_000));
    let answer = rig.send(&fades);
    rig.live_ms(60);
    let most = peak(&rig.recording.codes);
    assert!(f64::from(most) <= FULL * 0.1 + 1.0, "{most} after {answer:?}");
}

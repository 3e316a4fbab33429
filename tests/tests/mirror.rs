//! The mirror and the device, code by code, while a user who cannot sit still plays with it.

use std::sync::Arc;

use proptest::prelude::*;
use slipline::mirror::Mirror;
use slipline_app::Stop;
use slipline_protocol::command::{Apply, Drive};
use slipline_protocol::event::Event;
use slipline_protocol::units::{CentiDecibel, Phase};
use slipline_protocol::{Command, Refusal};
use slipline_tests::rig::{BLOCK, RATE_HZ, Rig, Table, tone};

/// What the user does next.
#[derive(Clone, Debug)]
enum Act {
    Drive { tones: Vec<(u8, f64, f64, u16)>, master: i16, glide: u32, ahead: Option<u64> },
    Table(u8),
    Stop,
    EmergencyStop,
    Rest,
}

fn act() -> impl Strategy<Value = Act> {
    let tones = prop::collection::vec((0..16u8, 0.0..=1.0, 0.0..=1.0, any::<u16>()), 0..5);
    let glide = prop_oneof![2000u32..4000, 2000u32..40_000];
    let ahead = prop::option::weighted(0.2, 0u64..4000);
    prop_oneof![
        10 => (tones, -2000i16..=0, glide, ahead)
            .prop_map(|(tones, master, glide, ahead)| Act::Drive { tones, master, glide, ahead }),
        2 => (0..3u8).prop_map(Act::Table),
        1 => Just(Act::Stop),
        1 => Just(Act::EmergencyStop),
        2 => Just(Act::Rest),
    ]
}

fn table(number: u8) -> Table {
    match number {
        0 => Table::usual(),
        1 => Table::line(33, 25_000.0, 90_000.0, |u| 0.3 + 0.6 * (1.0 - u)),
        _ => Table::line(1025, 500.0, 4_000.0, |u| 0.2 + 0.7 * u * u),
    }
}

/// Plays the acts on a device and on a mirror, and returns the device's codes with their largest allowed step.
fn storm(acts: &[(Act, u64)]) -> Result<Vec<u16>, TestCaseError> {
    let mut rig = Rig::default();
    rig.hello();
    let mut mirror = Mirror::new(RATE_HZ, 0);
    let usual = Table::usual();
    rig.stage(&usual);
    let at = rig.accepted(&Command::TableCommit);
    mirror.acknowledge_table(Arc::from(usual.knots), at).unwrap();
    rig.arm();
    for (act, blocks) in acts {
        match act {
            Act::Drive { tones, master, glide, ahead } => {
                // The levels are scaled so that most drives have the headroom, and some have not.
                let scale = 1.2 / tones.len().max(1) as f64;
                let drive = Drive {
                    tones: tones
                        .iter()
                        .map(|&(slot, position, level, phase)| {
                            let mut tone = tone(slot, position, (level * scale).min(1.0));
                            tone.phase = Phase(phase);
                            tone
                        })
                        .collect(),
                    master: CentiDecibel(*master),
                    glide: *glide,
                    apply: ahead.map_or(Apply::Next, |ahead| Apply::At(rig.device.now() + 2 * BLOCK + ahead)),
                };
                match rig.send(&Command::Drive(drive.clone())) {
                    Event::Accepted(accepted) => mirror.acknowledge_drive(&drive, accepted.at).unwrap(),
                    Event::Refused(
                        Refusal::Headroom { .. } | Refusal::SlotTwice { .. } | Refusal::Busy(_),
                    ) => {}
                    other => return Err(TestCaseError::fail(format!("{other:?}"))),
                }
            }
            Act::Table(number) => {
                let table = table(*number);
                let begun = rig.send(&Command::TableBegin(table.header));
                if begun == Event::Refused(Refusal::Busy(slipline_protocol::refusal::Busy::TableInUse)) {
                    continue;
                }
                for chunk in table.chunks() {
                    rig.accepted(&Command::TableChunk(chunk));
                }
                match rig.send(&Command::TableCommit) {
                    Event::Accepted(accepted) => {
                        mirror.acknowledge_table(Arc::from(table.knots), accepted.at).unwrap();
                    }
                    Event::Refused(Refusal::Headroom { .. } | Refusal::Busy(_)) => {}
                    other => return Err(TestCaseError::fail(format!("{other:?}"))),
                }
            }
            Act::Stop => {
                let at = rig.accepted(&Command::Stop);
                mirror.acknowledge_stop(Stop::Normal, at).unwrap();
            }
            Act::EmergencyStop => {
                let at = rig.accepted(&Command::EmergencyStop);
                mirror.acknowledge_stop(Stop::Emergency, at).unwrap();
                rig.live_ms(40);
                rig.accepted(&Command::ClearFaults);
                rig.arm();
            }
            Act::Rest => rig.live_ms(60),
        }
        rig.live_blocks(*blocks);
    }
    let until = rig.device.now();
    let mut replayed = Vec::new();
    mirror.render(until, |_, codes| replayed.extend_from_slice(codes));
    prop_assert!(mirror.is_true());
    let difference = replayed.iter().zip(&rig.recording.codes).position(|(a, b)| a != b);
    prop_assert_eq!(difference, None, "the first different code");
    prop_assert_eq!(replayed.len(), rig.recording.codes.len());
    prop_assert_eq!(rig.status().counters.clips, 0);
    Ok(rig.recording.codes)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    // mirror and device are equal bit for bit, nothing clips, and no code jumps.
    #[test]
    fn mirror_and_device_send_the_same_codes_under_a_storm_of_commands(
        acts in prop::collection::vec((act(), 1u64..40), 1..40),
    ) {
        storm(&acts)?;
    }
}

//! The bench: a device that drives while its mute pin stays low.

use super::profile::{flash_with, plain};
use proptest::prelude::*;
use slipline_link::simulator::{Options, Wires};
use slipline_protocol::board::{MutePin, MuteStep, MuteTrial, PinLevel};
use slipline_protocol::command::{Apply, ArmLease, Drive};
use slipline_protocol::event::{Event, Fault, State, TriggerReport};
use slipline_protocol::limits::{DEAD_MAN_MS, LEASE_MS};
use slipline_protocol::profile::ActuatorProfile;
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::commands::every_command;
use slipline_tests::rig::{MID, Rig, Table, drive};

/// A bench of a minute.
pub(crate) const BENCH: Command = Command::Bench(ArmLease { lease_ms: 60_000 });

pub(crate) fn mute_pin(rig: &mut Rig, trial: MuteTrial) -> MutePin {
    answer!(rig, Command::MutePin(MuteStep { trial }), MutePin)
}

/// A device of these options on the bench, with the usual table and one tone that sounds.
pub(crate) fn sounding(options: Options) -> Rig {
    let mut rig = Rig::greeted_with(options);
    rig.upload(&Table::usual());
    rig.record();
    rig.accepted(&BENCH);
    rig.keep_alive();
    rig.live_ms(10);
    rig.play(&[(0, 0.5, 0.5)], 2000, 20);
    assert_eq!(rig.status().state, State::Driving);
    rig
}

/// Whether nothing that was recorded could be heard.
pub(crate) fn was_muted_throughout(rig: &Rig) -> bool {
    rig.recording.muted.iter().all(|muted| *muted)
}

#[test]
fn a_device_on_the_bench_drives_as_an_armed_one_with_its_mute_pin_low() {
    let mut rig = sounding(Options::default());
    let low = MutePin { level: PinLevel::Low, is_on_bench: true, fall: None };
    assert_eq!(mute_pin(&mut rig, MuteTrial::Read), low);
    let mut armed = Rig::greeted();
    armed.upload(&Table::usual());
    armed.record();
    armed.accepted(&Command::ArmFor(ArmLease { lease_ms: 60_000 }));
    armed.keep_alive();
    armed.live_ms(10);
    armed.play(&[(0, 0.5, 0.5)], 2000, 20);
    let high = MutePin { level: PinLevel::High, is_on_bench: false, fall: None };
    assert_eq!(mute_pin(&mut armed, MuteTrial::Read), high);
    assert!(rig.recording.codes.iter().any(|code| code.abs_diff(MID) > 500));
    assert_eq!(rig.recording.codes, armed.recording.codes, "no code is another");
    rig.accepted(&Command::Disarm);
    rig.live_ms(60);
    assert!(was_muted_throughout(&rig));
    assert_eq!(mute_pin(&mut rig, MuteTrial::Read), MutePin { is_on_bench: false, ..low });
    // Only then can it be armed otherwise.
    rig.arm();
    assert!(!rig.device.is_muted());
}

#[test]
fn neither_arming_changes_into_the_other() {
    let mut rig = sounding(Options::default());
    for arm in [Command::Arm, Command::ArmFor(ArmLease { lease_ms: 1000 })] {
        assert_eq!(rig.refused(&arm), Refusal::Armed);
    }
    rig.accepted(&Command::Stop);
    // It still ramps, and then stays on the bench.
    assert_eq!(rig.refused(&Command::Arm), Refusal::Armed);
    rig.accepted(&Command::Disarm);
    assert_eq!(rig.refused(&Command::Arm), Refusal::Busy(Busy::DriveActive), "while it ramps");
    rig.live_ms(60);
    assert!(was_muted_throughout(&rig));
    rig.arm();
    assert_eq!(rig.refused(&BENCH), Refusal::Armed);
    assert!(!rig.device.is_muted());
    let too_long = Command::Bench(ArmLease { lease_ms: LEASE_MS.1 + 1 });
    assert!(matches!(rig.refused(&too_long), Refusal::OutOfRange { field: Field::Lease, .. }));
}

/// What ends a drive ends one on the bench: the state, the fault, and how long it takes until nothing sounds, in ms.
#[test]
fn all_that_ends_a_drive_ends_one_on_the_bench() {
    let stop_input = ActuatorProfile { has_stop_input: true, ..plain() };
    let short_drives = ActuatorProfile { max_drive_ms: 1000, ..plain() };
    type End = (&'static str, ActuatorProfile, u32, fn(&mut Rig), u32, State, Option<Fault>);
    let ends: [End; 8] = [
        (
            "button",
            plain(),
            60_000,
            |rig| rig.device.press_button(true),
            5,
            State::Fault,
            Some(Fault::DeskStop),
        ),
        (
            "stop input",
            stop_input.clone(),
            60_000,
            |rig| rig.device.open_stop_input(true),
            2,
            State::Fault,
            Some(Fault::DeskStop),
        ),
        (
            "spike on the stop wire",
            stop_input,
            60_000,
            |rig| {
                rig.device.open_stop_input(true);
                rig.device.open_stop_input(false);
            },
            2,
            State::Fault,
            Some(Fault::DeskStop),
        ),
        (
            "emergency stop",
            plain(),
            60_000,
            |rig| {
                rig.accepted(&Command::EmergencyStop);
            },
            4,
            State::Fault,
            Some(Fault::EmergencyStop),
        ),
        (
            "underrun",
            plain(),
            60_000,
            |rig| rig.device.inject_underrun(),
            4,
            State::Fault,
            Some(Fault::Underrun),
        ),
        ("lease", plain(), 1000, |rig| rig.live_ms(1000), 40, State::Idle, None),
        ("profile", short_drives, 60_000, |rig| rig.live_ms(1000), 60, State::Fault, Some(Fault::DriveTime)),
        (
            "lost host",
            plain(),
            60_000,
            |rig| rig.silent_ms(DEAD_MAN_MS),
            60,
            State::Fault,
            Some(Fault::HostLost),
        ),
    ];
    for (name, profile, lease_ms, end, within_ms, state, fault) in ends {
        let mut rig = Rig::greeted_with(Options { flash: flash_with(profile), ..Options::default() });
        rig.upload(&Table::usual());
        rig.record();
        rig.accepted(&Command::Bench(ArmLease { lease_ms }));
        rig.keep_alive();
        rig.live_ms(10);
        rig.play(&[(0, 0.5, 0.5)], 2000, 20);
        rig.keep_alive();
        end(&mut rig);
        let ended = rig.device.now();
        rig.silent_ms(100);
        let silent = rig.recording.end_of_sound().unwrap();
        assert!(silent <= ended + rig.samples(within_ms), "{name}: {} samples", silent - ended);
        let status = rig.status();
        assert_eq!((status.state, status.first_fault), (state, fault), "{name}");
        let pin = MutePin { level: PinLevel::Low, is_on_bench: false, fall: None };
        assert_eq!(mute_pin(&mut rig, MuteTrial::Read), pin, "{name}");
        assert!(was_muted_throughout(&rig), "{name}");
    }
}

#[test]
fn a_wire_between_the_triggers_begins_a_drive_that_waits_on_the_bench() {
    let waiting = Command::Drive(Drive { apply: Apply::AtTrigger, ..drive(&[(0, 0.5, 0.5)], 2000) });
    for (trigger, block_waits) in [(true, false), (true, true), (false, true)] {
        let wires = Wires { trigger, ..Wires::default() };
        let mut rig = Rig::greeted_with(Options { wires, block_waits, ..Options::default() });
        rig.upload(&Table::usual());
        rig.accepted(&BENCH);
        rig.keep_alive();
        rig.live_ms(10);
        let from = rig.accepted(&waiting);
        rig.live_ms(10);
        let report = answer!(rig, Command::Trigger, Trigger);
        if trigger {
            // The output rises 2 samples before the code at the answer's index.
            let delay = report.began.unwrap() - (from - 2);
            assert!(!report.waits && (129..=260).contains(&delay), "{delay} samples");
        } else {
            assert_eq!(report, TriggerReport { waits: true, began: None });
        }
    }
    // Off the bench the output marks programs alone.
    let wires = Wires { trigger: true, ..Wires::default() };
    let mut rig = Rig::greeted_with(Options { wires, ..Options::default() });
    rig.upload(&Table::usual());
    rig.arm();
    rig.accepted(&waiting);
    rig.live_ms(10);
    assert_eq!(answer!(rig, Command::Trigger, Trigger), TriggerReport { waits: true, began: None });
}

/// What may happen to a device: the number of a command, or something on the desk.
#[derive(Clone, Debug)]
enum Happening {
    Command(usize),
    Drive { position: f64, waits: bool },
    Button(bool),
    StopInput(bool),
    Rise,
    Underrun,
    Mute,
    Hello,
}

fn happenings() -> impl Strategy<Value = Vec<(Happening, u64)>> {
    let happening = prop_oneof![
        8 => (0..every_command().len()).prop_map(Happening::Command),
        3 => (0.0..1.0, any::<bool>()).prop_map(|(position, waits)| Happening::Drive { position, waits }),
        1 => any::<bool>().prop_map(Happening::Button),
        1 => any::<bool>().prop_map(Happening::StopInput),
        1 => Just(Happening::Rise),
        1 => Just(Happening::Underrun),
        1 => Just(Happening::Mute),
        1 => Just(Happening::Hello),
    ];
    prop::collection::vec((happening, 0u64..60), 1..60)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// No sequence of commands, and nothing on the desk, unmutes a device before it was armed by `Arm` or `ArmFor`, and none
    /// unmutes it on the bench.
    #[test]
    fn nothing_unmutes_before_arm(happenings in happenings(), block_waits in any::<bool>()) {
        let profile = ActuatorProfile { has_stop_input: true, ..plain() };
        let flash = flash_with(profile);
        let mut rig = Rig::greeted_with(Options { flash, block_waits, ..Options::default() });
        rig.upload(&Table::usual());
        let commands = every_command();
        let mut was_armed = false;
        for (happening, blocks) in happenings {
            match happening {
                Happening::Command(number) => match &commands[number] {
                    Command::Hello(_) | Command::BootloaderEnter(_) => {}
                    command => {
                        let is_accepted = matches!(rig.send(command), Event::Accepted(_));
                        was_armed |= is_accepted && matches!(command, Command::Arm | Command::ArmFor(_));
                    }
                },
                Happening::Drive { position, waits } => {
                    let apply = if waits { Apply::AtTrigger } else { Apply::Next };
                    // More likely to sound than not.
                    rig.send(&BENCH);
                    rig.live_blocks(10);
                    rig.send(&Command::Drive(Drive { apply, ..drive(&[(0, position, 0.5)], 2000) }));
                }
                Happening::Button(is_pressed) => rig.device.press_button(is_pressed),
                Happening::StopInput(is_open) => rig.device.open_stop_input(is_open),
                Happening::Rise => rig.device.raise_trigger(),
                Happening::Underrun => rig.device.inject_underrun(),
                Happening::Mute => rig.device.inject_mute(),
                Happening::Hello => {
                    rig.hello();
                }
            }
            let is_on_bench = mute_pin(&mut rig, MuteTrial::Read).is_on_bench;
            rig.record();
            rig.live_blocks(blocks);
            // A bench that ends meanwhile leaves the pin low, too.
            prop_assert!(was_muted_throughout(&rig) || (was_armed && !is_on_bench));
        }
    }
}

#[test]
fn the_dac_is_stalled_on_the_bench_alone_and_the_device_notices_it() {
    let mut rig = Rig::greeted();
    assert_eq!(rig.refused(&Command::Stall), Refusal::NotArmed);
    rig.upload(&Table::usual());
    rig.arm();
    assert_eq!(rig.refused(&Command::Stall), Refusal::NotArmed, "the amplifier is on");
    let mut rig = sounding(Options::default());
    rig.accepted(&Command::Stall);
    rig.live_ms(10);
    assert_eq!(rig.status().first_fault, Some(Fault::Underrun));
    rig.accepted(&Command::ClearFaults);
    rig.live_ms(10);
    rig.accepted(&BENCH);
    rig.live_ms(10);
    assert_eq!(rig.status().state, State::Armed);
    assert!(was_muted_throughout(&rig));
}

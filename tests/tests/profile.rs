//! The actuator's profile: the device's own limits for every host.

use proptest::prelude::*;
use slipline_link::simulator::{MemoryFlash, Options};
use slipline_protocol::command::{Apply, Drive, ProfileSetting, TravelSetting};
use slipline_protocol::event::{Event, Fault, Faults, ProfileReport, ResetCause, State, StoredConfig};
use slipline_protocol::limits::{HAND_MS, MAX_DRIVE_MS, MAX_RISE_CDB, STOP_RAMP_MS};
use slipline_protocol::profile::{ActuatorProfile, CoilHeat, TravelLimit};
use slipline_protocol::refusal::Field;
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::measure::peak;
use slipline_tests::rig::{BLOCK, Rig, Table, chord, comb, drive};
use std::sync::OnceLock;

/// The constants of a device without a profile.
const HEAT: CoilHeat = CoilHeat { winding_ms: 8000, body_ms: 120_000, full_sine_per_mille: 1300 };

pub(crate) fn plain() -> ActuatorProfile {
    ActuatorProfile {
        name: "plain".try_into().unwrap(),
        max_sum_per_mille: 1000,
        travel: None,
        heat: HEAT,
        max_rise: CentiDecibel(MAX_RISE_CDB),
        max_drive_ms: MAX_DRIVE_MS,
        has_stop_input: false,
    }
}

fn quiet() -> ActuatorProfile {
    ActuatorProfile { max_sum_per_mille: 400, ..plain() }
}

fn writes(profile: Option<ActuatorProfile>) -> Command {
    Command::WriteProfile(ProfileSetting { profile })
}

fn report(rig: &mut Rig) -> ProfileReport {
    answer!(rig, Command::Profile, Profile)
}

/// Presses the button, and holds it.
fn press(rig: &mut Rig) {
    rig.device.press_button(false);
    rig.live_ms(10);
    rig.device.press_button(true);
    rig.live_ms(10);
}

/// Writes a profile with the button held.
fn write(rig: &mut Rig, profile: Option<ActuatorProfile>) {
    press(rig);
    rig.accepted(&writes(profile));
    rig.device.press_button(false);
    rig.live_ms(10);
}

/// A flash with this profile.
pub(crate) fn flash_with(profile: ActuatorProfile) -> MemoryFlash {
    let mut rig = Rig::greeted();
    write(&mut rig, Some(profile));
    rig.device.flash()
}

/// A device with this profile, said hello to by a host of this minor, with the usual table, armed.
pub(crate) fn armed(profile: ActuatorProfile, minor: u8) -> Rig {
    let mut rig = Rig::new(Options { flash: flash_with(profile), ..Options::default() });
    rig.hello_of_minor(minor);
    rig.upload(&Table::usual());
    rig.arm();
    rig
}

#[test]
fn a_profile_is_not_written_without_the_button_nor_while_it_is_armed() {
    //
    let mut rig = Rig::greeted();
    rig.live_ms(10);
    assert_eq!(report(&mut rig), ProfileReport::default());
    for profile in [Some(plain()), None] {
        assert_eq!(rig.refused(&writes(profile)), Refusal::HoldButton);
    }
    rig.arm();
    assert_eq!(rig.refused(&writes(Some(plain()))), Refusal::DisarmFirst);
    rig.accepted(&Command::Disarm);
    rig.live_ms(50);
    press(&mut rig);
    rig.accepted(&writes(Some(plain())));
    assert!(matches!(rig.send(&writes(Some(plain()))), Event::Unchanged(_)), "not written again");
    assert_eq!(report(&mut rig), ProfileReport { profile: Some(plain()), stored: StoredConfig::Loaded });
    rig.device.restart(ResetCause::Pin);
    rig.hello();
    assert_eq!(report(&mut rig).profile, Some(plain()));
    press(&mut rig);
    rig.accepted(&writes(None));
    rig.device.press_button(false);
    assert_eq!(report(&mut rig), ProfileReport::default());
    rig.device.restart(ResetCause::Pin);
    rig.hello();
    assert_eq!(report(&mut rig), ProfileReport::default());
}

#[test]
fn values_out_of_range_are_named() {
    let cases: [(ActuatorProfile, Field, i64); 6] = [
        (ActuatorProfile { max_sum_per_mille: 1001, ..plain() }, Field::ProfileSum, 1001),
        (ActuatorProfile { max_rise: CentiDecibel(-1), ..plain() }, Field::MaxRise, -1),
        (ActuatorProfile { max_drive_ms: 600_001, ..plain() }, Field::DriveTime, 600_001),
        (ActuatorProfile { heat: CoilHeat { body_ms: 999, ..HEAT }, ..plain() }, Field::CoilTime, 999),
        (
            ActuatorProfile { heat: CoilHeat { full_sine_per_mille: 9, ..HEAT }, ..plain() },
            Field::FullSine,
            9,
        ),
        (
            ActuatorProfile {
                travel: Some(TravelLimit { resonance_uhz: 1, quality_per_mille: 1000, static_ppm: 1 }),
                ..plain()
            },
            Field::Resonance,
            1,
        ),
    ];
    let mut rig = Rig::greeted();
    rig.device.press_button(true);
    rig.live_ms(10);
    for (profile, named, value) in cases {
        let refusal = rig.refused(&writes(Some(profile)));
        assert!(
            matches!(refusal, Refusal::OutOfRange { field, got, .. } if (field, got) == (named, value)),
            "{refusal:?}"
        );
    }
    assert_eq!(report(&mut rig), ProfileReport::default());
}

#[test]
fn a_profile_is_written_within_30_s_of_a_press_that_this_run_has_seen() {
    // not by a button that is stuck, or that is held since before the start.
    let mut rig = Rig::greeted_with(Options { sample_rate_hz: 8000, ..Options::default() });
    rig.live_ms(100);
    press(&mut rig);
    rig.live_ms(HAND_MS - 50);
    rig.accepted(&writes(Some(plain())));
    rig.live_ms(100);
    assert_eq!(rig.refused(&writes(None)), Refusal::HoldButton, "stuck");
    press(&mut rig);
    rig.accepted(&writes(Some(quiet())));
    rig.device.restart(ResetCause::Pin);
    rig.hello();
    rig.live_ms(100);
    assert_eq!(rig.refused(&writes(None)), Refusal::HoldButton, "held since before the start");
    press(&mut rig);
    rig.accepted(&writes(None));
}

#[test]
fn the_older_profile_limits_until_a_hand_on_the_board_accepts_it() {
    // the newer one has decayed. The table's copy, which has a fault of its own, is cleared by a host alone.
    for minor in 0..=3 {
        let mut flash = kept();
        for slot in [1, 3] {
            flash.slots[slot][40] ^= 1;
        }
        let mut rig = Rig::new(Options { flash, ..Options::default() });
        rig.hello_of_minor(minor);
        rig.upload(&Table::usual());
        rig.accepted(&Command::ClearFaults);
        let fault = [Fault::StoreDamaged, Fault::StoreFellBack, Fault::StoreFellBack, Fault::ProfileFellBack];
        assert_eq!(rig.status().faults, Faults::NONE.with(fault[usize::from(minor)]));
        assert!(matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. }));
        press(&mut rig);
        rig.accepted(&Command::ClearFaults);
        rig.device.press_button(false);
        rig.live_ms(2100);
        rig.arm();
        assert_eq!(rig.status().state, State::Armed);
        let loud = rig.refused(&Command::Drive(drive(&[(0, 1.0, 0.41)], 2000)));
        assert!(matches!(loud, Refusal::Headroom { sum_per_mille: 410..=411 }), "{loud:?}");
        // The next start asks again.
        rig.device.restart(ResetCause::Pin);
        rig.hello();
        assert_eq!(
            report(&mut rig),
            ProfileReport { profile: Some(quiet()), stored: StoredConfig::FellBack }
        );
    }
}

#[test]
fn where_a_profile_is_kept_the_bootloader_needs_the_button() {
    // the next image would know nothing of it.
    for minor in 0..=3 {
        let mut rig = Rig::new(Options { flash: flash_with(quiet()), ..Options::default() });
        rig.hello_of_minor(minor);
        let token = |rig: &mut Rig| answer!(rig, Command::BootloaderToken, BootloaderToken);
        let shown = token(&mut rig);
        let refusal = if minor < 3 { Refusal::NotSupported } else { Refusal::HoldButton };
        assert_eq!(rig.refused(&Command::BootloaderEnter(shown)), refusal);
        press(&mut rig);
        rig.accepted(&Command::BootloaderEnter(shown));
        rig.live_ms(100);
        assert!(rig.device.is_in_bootloader());
    }
}

#[test]
fn a_profiles_amplitude_holds_for_drives_chords_and_combs_of_hosts_of_every_minor() {
    // the table's gain is 1 at position 1, 0.5 at 0.
    for minor in 0..=3 {
        let mut rig = armed(quiet(), minor);
        let loud = rig.refused(&Command::Drive(drive(&[(0, 1.0, 0.41)], 2000)));
        assert!(matches!(loud, Refusal::Headroom { sum_per_mille: 410..=411 }), "{loud:?}");
        rig.play(&[(0, 1.0, 0.2), (1, 1.0, 0.19)], 2000, 10);
        // Together they would be, on the way, too.
        let more = [(0, 1.0, 0.2), (1, 1.0, 0.2), (2, 1.0, 0.2)];
        assert!(matches!(rig.refused(&Command::Drive(drive(&more, 2000))), Refusal::Headroom { .. }));
        rig.accepted(&Command::Stop);
        rig.live_ms(50);
        if minor >= 2 {
            let tones = [(300, 0.5, 0.0), (400, 0.6, 0.25)];
            let refused = rig.refused(&Command::Chord(chord(12, &tones)));
            assert!(matches!(refused, Refusal::Peak { peak_per_mille: 401.. }), "{refused:?}");
        }
        if minor >= 3 {
            let refused = rig.refused(&Command::Comb(comb(128, &[(123, 0.5, 0.0), (254, 0.5, 0.25)])));
            assert!(matches!(refused, Refusal::Headroom { .. }), "{refused:?}");
        }
    }
}

#[test]
fn a_profiles_travel_holds_beside_a_sessions_and_longer_than_it() {
    //
    let limit =
        |static_ppm| TravelLimit { resonance_uhz: 19_000_000_000, quality_per_mille: 2000, static_ppm };
    let mut rig = armed(ActuatorProfile { travel: Some(limit(1_000_000)), ..plain() }, 3);
    let beyond = Command::Drive(drive(&[(0, 1.0, 0.9)], 2000));
    assert!(matches!(rig.refused(&beyond), Refusal::Travel { .. }));
    for setting in [Some(limit(1000)), None] {
        let event = rig.send(&Command::SetTravelLimit(TravelSetting { limit: setting }));
        assert_eq!(event, Event::TravelLimit(TravelSetting { limit: setting }));
        assert!(matches!(rig.refused(&beyond), Refusal::Travel { .. }), "the session's is looser");
    }
    rig.send(&Command::SetTravelLimit(TravelSetting { limit: Some(limit(100_000_000)) }));
    let quiet = Command::Drive(drive(&[(0, 1.0, 0.1)], 2000));
    assert!(matches!(rig.refused(&quiet), Refusal::Travel { .. }), "the session's is tighter");
    rig.send(&Command::SetTravelLimit(TravelSetting { limit: None }));
    rig.accepted(&quiet);
    // The profile also limits a table that was stored before it.
    let mut rig = Rig::greeted();
    rig.upload(&Table::usual());
    rig.live_ms(20);
    write(&mut rig, Some(ActuatorProfile { travel: Some(limit(1_000_000)), ..plain() }));
    rig.arm();
    let way = Command::Drive(drive(&[(0, 0.5, 0.9)], 2000));
    rig.accepted(&way);
    rig.live_ms(20);
    assert!(matches!(rig.refused(&beyond), Refusal::Travel { .. }));
}

#[test]
fn a_profiles_longest_time_and_heat_bind_the_device() {
    // at 8 kS/s, so that seconds are few blocks.
    let heat = CoilHeat { winding_ms: 1000, body_ms: 1000, full_sine_per_mille: 20_000 };
    for (profile, fault) in [
        (ActuatorProfile { max_drive_ms: 5000, ..plain() }, Fault::DriveTime),
        (ActuatorProfile { heat, ..plain() }, Fault::Overheat),
    ] {
        let flash = flash_with(profile);
        let mut rig = Rig::new(Options { sample_rate_hz: 8000, flash, ..Options::default() });
        rig.hello_of_minor(0);
        rig.upload(&Table::usual().at_rate(8000));
        rig.arm();
        rig.play(&[(0, 1.0, 0.9)], 100, 4000);
        if fault == Fault::DriveTime {
            assert_eq!(rig.status().state, State::Driving);
        }
        rig.live_ms(2000);
        let status = rig.status();
        if fault == Fault::DriveTime {
            assert_eq!(status.first_fault, Some(fault));
        } else {
            assert!(status.foldback_per_mille < 1000 || status.first_fault == Some(fault), "{status:?}");
        }
    }
}

#[test]
fn a_drive_that_begins_later_does_not_lengthen_the_one_that_sounds() {
    // a longest drive of a second, and one that begins three seconds later; from silence one may begin when it likes.
    let profile = ActuatorProfile { max_drive_ms: 1000, ..plain() };
    for sounds in [true, false] {
        let flash = flash_with(profile.clone());
        let mut rig = Rig::greeted_with(Options { sample_rate_hz: 8000, flash, ..Options::default() });
        rig.upload(&Table::usual().at_rate(8000));
        rig.arm();
        rig.record();
        let first = drive(&[(0, 1.0, 0.9)], 100);
        let from = if sounds { rig.accepted(&Command::Drive(first.clone())) } else { rig.device.now() };
        rig.live_ms(50);
        let at = from + rig.samples(3000);
        rig.accepted(&Command::Drive(Drive { apply: Apply::At(at), ..first }));
        rig.live_ms(3600);
        let (end, status) = (rig.recording.end_of_sound().unwrap(), rig.status());
        if sounds {
            assert!(end < from + rig.samples(1000 + STOP_RAMP_MS) + 16 * BLOCK, "{}", end - from);
            assert_eq!(status.first_fault, Some(Fault::DriveTime));
        } else {
            assert_eq!(status.state, State::Driving);
            rig.live_ms(600);
            assert_eq!(rig.status().first_fault, Some(Fault::DriveTime), "then its own time runs");
        }
    }
}

#[test]
fn a_plain_profile_changes_no_code() {
    let mut with = armed(plain(), 3);
    let mut without = Rig::new(Options { flash: MemoryFlash::default(), ..Options::default() });
    without.hello();
    without.upload(&Table::usual());
    without.arm();
    for rig in [&mut with, &mut without] {
        rig.record();
        for command in [
            Command::Drive(drive(&[(0, 0.3, 0.5), (1, 0.9, 0.4)], 4000)),
            Command::Drive(drive(&[(0, 0.8, 0.5), (2, 0.1, 0.4)], 9000)),
            Command::Stop,
        ] {
            rig.accepted(&command);
            rig.live_ms(60);
        }
        rig.accepted(&Command::Chord(chord(12, &[(300, 0.5, 0.0), (400, 0.6, 0.25)])));
        rig.live_ms(60);
    }
    assert_eq!(with.recording.codes, without.recording.codes);
}

#[test]
fn the_stop_input_mutes_and_keeps_the_device_from_being_armed() {
    //
    let mut rig = armed(ActuatorProfile { has_stop_input: true, ..plain() }, 3);
    rig.play(&[(0, 0.5, 0.5)], 2000, 10);
    rig.device.open_stop_input(true);
    assert!(rig.device.is_muted(), "at once");
    rig.live_ms(5);
    let status = rig.status();
    assert_eq!((status.first_fault, status.counters.underruns), (Some(Fault::DeskStop), 0));
    rig.accepted(&Command::ClearFaults);
    assert_eq!(rig.status().first_fault, Some(Fault::DeskStop), "its cause is still there");
    rig.device.open_stop_input(false);
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    assert_eq!(rig.status().state, State::Armed);
    // Open from the start.
    rig.device.open_stop_input(true);
    let mut rig = Rig::new(Options { flash: rig.device.flash(), ..Options::default() });
    rig.device.open_stop_input(true);
    rig.hello();
    assert!(matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. }));
    assert!(rig.device.is_muted());
    // Without a profile nobody knows whether one is fitted.
    let mut rig = Rig::default();
    rig.device.open_stop_input(true);
    rig.hello();
    rig.arm();
    assert_eq!(rig.status().state, State::Armed);
}

#[test]
fn a_spike_on_the_stop_wire_is_a_stop_and_no_underrun() {
    // it is over before the next block.
    let mut rig = armed(ActuatorProfile { has_stop_input: true, ..plain() }, 3);
    rig.play(&[(0, 0.5, 0.5)], 2000, 10);
    rig.device.open_stop_input(true);
    rig.device.open_stop_input(false);
    assert!(rig.device.is_muted());
    rig.live_ms(5);
    let status = rig.status();
    assert_eq!((status.first_fault, status.counters.underruns), (Some(Fault::DeskStop), 0));
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    rig.live_ms(10);
    // Another cause, later, is no stop.
    rig.device.inject_mute();
    rig.live_ms(5);
    assert_eq!(rig.status().first_fault, Some(Fault::Underrun));
}

#[test]
fn a_table_that_is_forgotten_or_of_an_older_image_leaves_the_profile_and_the_reverse() {
    let mut rig = Rig::greeted_with(Options { flash: flash_with(quiet()), ..Options::default() });
    rig.upload(&Table::usual());
    rig.live_ms(20);
    rig.accepted(&Command::Store);
    write(&mut rig, Some(plain()));
    let both = rig.device.flash();
    rig.accepted(&Command::Forget);
    assert_eq!(report(&mut rig).profile, Some(plain()));
    rig.device.restart(ResetCause::Pin);
    rig.hello();
    assert_eq!((report(&mut rig).profile, rig.status().table_crc), (Some(plain()), 0));
    let mut rig = Rig::greeted_with(Options { flash: both, ..Options::default() });
    assert_eq!(rig.status().table_crc, Table::usual().header.crc);
    write(&mut rig, None);
    rig.device.restart(ResetCause::Pin);
    rig.hello();
    assert_eq!(rig.status().table_crc, Table::usual().header.crc);
}

/// A flash in which two profiles have been kept, one after the other.
fn kept() -> MemoryFlash {
    static KEPT: OnceLock<MemoryFlash> = OnceLock::new();
    let make = || {
        let mut rig = Rig::greeted_with(Options { flash: flash_with(quiet()), ..Options::default() });
        write(&mut rig, Some(plain()));
        rig.device.flash()
    };
    KEPT.get_or_init(make).clone()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_profile_that_has_decayed_is_never_ignored_in_silence(
        slot in 2usize..4,
        damage in prop::collection::vec((0usize..128, 1u8..), 1..4),
    ) {
        // the other one is in force with a fault, or the device cannot be armed at all.
        let mut flash = kept();
        let before = flash.clone();
        for (at, bits) in damage {
            flash.slots[slot][at] ^= bits;
        }
        prop_assume!(flash != before);
        let mut rig = Rig::greeted_with(Options { flash, ..Options::default() });
        let found = report(&mut rig);
        match (&found.profile, found.stored) {
            (Some(profile), StoredConfig::FellBack) => {
                prop_assert!([quiet(), plain()].contains(profile));
                prop_assert_eq!(rig.status().first_fault, Some(Fault::ProfileFellBack));
                // A host alone does not clear it.
                rig.accepted(&Command::ClearFaults);
                prop_assert_eq!(rig.status().first_fault, Some(Fault::ProfileFellBack));
                let is_refused = matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. });
                prop_assert!(is_refused);
            }
            // The damage lies where the older record has nothing, or behind the newer one's header.
            (Some(profile), StoredConfig::Loaded) => prop_assert_eq!((profile, slot), (&plain(), 2)),
            (None, StoredConfig::Damaged) => {
                rig.accepted(&Command::ClearFaults);
                prop_assert_eq!(rig.status().first_fault, Some(Fault::StoreDamaged));
                let is_refused = matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. });
                prop_assert!(is_refused);
                rig.live_ms(20);
                write(&mut rig, Some(quiet()));
                rig.accepted(&Command::ClearFaults);
                rig.arm();
                prop_assert_eq!(rig.status().state, State::Armed);
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }

    #[test]
    fn whatever_a_host_sends_the_amplitude_stays_within_the_profile(
        max_sum_per_mille in 50u16..1000,
        minor in 0u8..=3,
        steps in prop::collection::vec((0u8..4, 0.0f64..1.0, 0.0f64..1.0, 0.0f64..1.0, 1u32..60), 1..12),
    ) {
        //
        let mut rig = armed(ActuatorProfile { max_sum_per_mille, ..plain() }, minor);
        rig.record();
        for (kind, place, level, other, pause_ms) in steps {
            let command = match kind {
                0 | 1 => Command::Drive(drive(&[(0, place, level), (1, other, level * other)], 2000)),
                2 => Command::Chord(chord(10, &[(60, level, place), (80, other, 0.0), (100, level, 0.5)])),
                _ => Command::Comb(comb(16, &[(100, level, place), (200, other, 0.3)])),
            };
            rig.send(&command);
            rig.live_ms(pause_ms);
            if other < 0.3 {
                rig.accepted(&Command::Stop);
                rig.live_ms(40);
            }
        }
        // A code is rounded.
        let most = 2047.0 * f64::from(max_sum_per_mille) / 1000.0 + 1.0;
        prop_assert!(f64::from(peak(&rig.recording.codes)) <= most, "{} of {most}", peak(&rig.recording.codes));
    }
}

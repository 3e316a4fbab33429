//! Flash storage: written only by a disarmed, silent device, and only what is new; read at the next start, with a fault
//! when anything of it was lost.

use proptest::prelude::*;
use slipline_link::simulator::{MemoryFlash, Options};
use slipline_protocol::event::{Event, Fault, Maintenance, ResetCause, State, StoredConfig, Wear};
use slipline_protocol::refusal::Busy;
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::rig::{MID, Rig, Table, drive};

fn stored(rig: &mut Rig) -> StoredConfig {
    match rig.hello().event {
        Event::Hello(identity) => identity.stored,
        other => panic!("{other:?}"),
    }
}

/// A device that holds the usual table and is disarmed and muted.
fn disarmed() -> Rig {
    let mut rig = Rig::armed();
    disarm(&mut rig);
    rig
}

/// Disarms and waits until the amplifier is off.
fn disarm(rig: &mut Rig) {
    rig.accepted(&Command::Disarm);
    rig.live_ms(5);
}

/// A device's flash after the usual table was stored.
fn kept() -> MemoryFlash {
    let mut rig = disarmed();
    rig.accepted(&Command::Store);
    rig.device.flash()
}

/// Another table than the usual one.
fn other(first_hz: f64) -> Table {
    Table::line(33, first_hz, 20_000.0, |_| 0.5)
}

fn wear(rig: &mut Rig) -> Wear {
    answer!(rig, Command::Wear, Wear)
}

fn maintenance(rig: &mut Rig) -> Maintenance {
    answer!(rig, Command::Maintenance, Maintenance)
}

#[test]
fn the_flash_is_written_only_while_nothing_sounds() {
    //
    let mut rig = Rig::armed();
    let blank = rig.device.flash();
    rig.accepted(&Command::Drive(drive(&[(0, 0.5, 0.5)], 2000)));
    for command in [Command::Store, Command::Forget] {
        assert_eq!(rig.refused(&command), Refusal::Busy(Busy::DriveActive), "pending");
        rig.live_ms(10);
        assert_eq!(rig.refused(&command), Refusal::Busy(Busy::DriveActive), "sounding");
    }
    rig.accepted(&Command::Stop);
    rig.live_ms(10);
    assert_eq!(rig.refused(&Command::Store), Refusal::Busy(Busy::DriveActive), "ramping");
    assert_eq!(rig.device.flash(), blank);
    rig.live_ms(40);
    assert_eq!(rig.status().state, State::Armed);
    for command in [Command::Store, Command::Forget] {
        assert_eq!(rig.refused(&command), Refusal::DisarmFirst, "armed and silent");
    }
    rig.accepted(&Command::Disarm);
    assert!(!rig.device.is_muted());
    assert_eq!(rig.refused(&Command::Store), Refusal::Busy(Busy::DriveActive), "not muted yet");
    assert_eq!(rig.device.flash(), blank);
    rig.live_ms(5);
    assert!(rig.device.is_muted());
    rig.accepted(&Command::Store);
    assert_ne!(rig.device.flash(), blank);
}

#[test]
fn a_table_that_the_flash_holds_is_not_written_again_and_the_reply_says_so() {
    let mut rig = disarmed();
    assert!(matches!(rig.send(&Command::Forget), Event::Unchanged(_)), "nothing is kept");
    assert_eq!(maintenance(&mut rig).erasures, 0);
    rig.accepted(&Command::Store);
    assert_eq!(maintenance(&mut rig).erasures, 1);
    let kept = rig.device.flash();
    for _ in 0..3 {
        assert!(matches!(rig.send(&Command::Store), Event::Unchanged(_)), "the same table");
    }
    assert_eq!(rig.device.flash(), kept);
    assert_eq!(maintenance(&mut rig).erasures, 1);

    // A table that differs in one knot is another one.
    rig.upload(&other(60_001.0));
    rig.live_ms(50);
    rig.accepted(&Command::Store);
    rig.upload(&Table::usual());
    rig.live_ms(50);
    rig.accepted(&Command::Store);
    assert_eq!(maintenance(&mut rig).erasures, 3);
    rig.accepted(&Command::Forget);
    assert!(matches!(rig.send(&Command::Forget), Event::Unchanged(_)));
    assert_eq!(maintenance(&mut rig).erasures, 4);
}

#[test]
fn two_tables_stored_in_turn_wear_the_flash_by_16_erasures_and_one_a_minute() {
    // a host that stores without a pause, at 8 kS/s, so that a minute is few blocks.
    let mut rig = Rig::greeted_with(Options { sample_rate_hz: 8000, ..Options::default() });
    let tables = [60_001.0, 60_002.0].map(|first_hz| other(first_hz).at_rate(8000));
    let mut turn = 0;
    let mut try_often = |rig: &mut Rig| {
        rig.upload(&tables[turn % 2]);
        rig.live_ms(50);
        turn += 1;
        rig.send(&if turn % 5 == 0 { Command::Forget } else { Command::Store })
    };
    for stored in 1..=16 {
        assert!(matches!(try_often(&mut rig), Event::Accepted(_)));
        assert_eq!(wear(&mut rig).stores_left, 16 - stored);
    }
    let refused = try_often(&mut rig);
    assert!(matches!(refused, Event::Refused(Refusal::StoresSpent { wait_s: 55..=60 })), "{refused:?}");
    for _ in 0..20 {
        rig.live_ms(30_000);
        try_often(&mut rig);
        // A turn at which the same table is kept already takes none.
        assert!(wear(&mut rig).stores_left <= 1);
    }
    let erasures = maintenance(&mut rig).erasures;
    assert!((16 + 5..=16 + 11).contains(&erasures), "{erasures}");
    // A table that the flash holds already costs nothing.
    let kept = rig.send(&Command::Store);
    assert!(matches!(kept, Event::Unchanged(_) | Event::Refused(_)), "{kept:?}");
    // To a host of 1.2 it is a store that failed.
    rig.hello_of_minor(2);
    assert_eq!(try_often(&mut rig), Event::Refused(Refusal::StoreFailed));
    rig.live_ms(16 * 60_000);
    rig.hello();
    assert_eq!(wear(&mut rig).stores_left, 16);
}

#[test]
fn a_host_of_1_0_gets_its_own_answer_to_a_refused_or_needless_store() {
    let mut rig = Rig::armed();
    rig.hello_of_minor(0);
    rig.arm();
    assert_eq!(rig.refused(&Command::Store), Refusal::Armed);
    disarm(&mut rig);
    rig.accepted(&Command::Store);
    let kept = rig.device.flash();
    rig.accepted(&Command::Store);
    assert_eq!(rig.device.flash(), kept, "not written again");
    assert_eq!(rig.refused(&Command::Maintenance), Refusal::UnknownMessage { id: 0x04 });
}

#[test]
fn the_wear_is_counted_across_starts_and_reported_with_what_the_data_sheet_promises() {
    let mut flash = MemoryFlash::default();
    for start in 0..5 {
        let mut rig = Rig::greeted_with(Options { flash, ..Options::default() });
        assert_eq!(maintenance(&mut rig).erasures, 2 * start);
        for which in 0..2 {
            rig.upload(&other(50_000.0 + f64::from(2 * start + which)));
            rig.live_ms(50);
            rig.accepted(&Command::Store);
        }
        let wear = maintenance(&mut rig);
        assert_eq!((wear.erasures, wear.erasures_promised), (2 * start + 2, 20_000));
        flash = rig.device.flash();
    }
}

#[test]
fn a_device_reports_whether_its_brown_out_level_is_set() {
    for brown_out_guarded in [false, true] {
        let mut rig = Rig::greeted_with(Options { brown_out_guarded, ..Options::default() });
        assert_eq!(maintenance(&mut rig).brown_out_guarded, brown_out_guarded);
    }
}

/// A device whose flash holds an older and a newer table, the newer one with a header that has decayed.
fn decayed() -> Rig {
    let mut rig = disarmed();
    rig.accepted(&Command::Store);
    rig.upload(&other(60_000.0));
    rig.live_ms(50);
    rig.accepted(&Command::Store);
    let mut flash = rig.device.flash();
    // In the sequence number of the newer record, which stands in the second slot.
    flash.slots[1][9] ^= 0x10;
    Rig::new(Options { flash, ..Options::default() })
}

#[test]
fn an_older_table_is_not_used_in_silence_when_the_newer_one_has_decayed() {
    let mut rig = decayed();
    assert_eq!(stored(&mut rig), StoredConfig::FellBack);
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::StoreFellBack)));
    assert_eq!(status.table_crc, Table::usual().header.crc, "the older one is in use");
    assert_eq!(rig.refused(&Command::Arm), Refusal::Faulted { faults: status.faults });

    // Cleared, the device may drive; the next start reports the fault again.
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    rig.device.restart(ResetCause::Pin);
    assert_eq!(stored(&mut rig), StoredConfig::FellBack);

    // The older table is whole, but to store it mends the other place, so it is no needless write.
    rig.accepted(&Command::Store);
    rig.device.restart(ResetCause::Pin);
    assert_eq!(stored(&mut rig), StoredConfig::Loaded);
    assert_eq!(rig.status().first_fault, None);
    assert_eq!(maintenance(&mut rig).erasures, 3, "two records and the one that was lost");
}

#[test]
fn a_host_of_1_0_sees_a_decayed_store_as_a_damaged_one() {
    let mut rig = decayed();
    let hello = rig.hello_of_minor(0);
    assert!(matches!(hello.event, Event::Hello(identity) if identity.stored == StoredConfig::Loaded));
    assert_eq!(rig.status().first_fault, Some(Fault::StoreDamaged));
    rig.accepted(&Command::ClearFaults);
    rig.arm();
}

#[test]
fn a_table_that_was_forgotten_does_not_hide_one_that_has_decayed() {
    let mut rig = disarmed();
    rig.accepted(&Command::Store);
    rig.accepted(&Command::Forget);
    rig.accepted(&Command::Store);
    let mut flash = rig.device.flash();
    // The first slot holds the newest record, a table; the second one marks the absence of a table.
    flash.slots[0][0] ^= 1;
    let mut rig = Rig::new(Options { flash, ..Options::default() });
    assert_eq!(stored(&mut rig), StoredConfig::Damaged);
    assert_eq!((rig.status().first_fault, rig.status().table_crc), (Some(Fault::StoreDamaged), 0));
}

#[test]
fn an_erase_that_stalls_the_processor_is_no_fault_and_no_sound() {
    // the DAC runs dry for as long as the erase takes; it repeats mid-scale.
    let mut rig = disarmed();
    rig.record();
    rig.accepted(&Command::Store);
    for _ in 0..10 {
        rig.device.inject_underrun();
        rig.live_blocks(1);
    }
    let status = rig.status();
    assert_eq!((status.state, status.first_fault, status.counters.underruns), (State::Idle, None, 10));
    assert!(rig.recording.codes.iter().all(|&code| code == MID));
}

#[test]
fn a_stored_table_survives_a_reset_and_a_forgotten_one_does_not() {
    let mut rig = Rig::new(Options { flash: kept(), ..Options::default() });
    assert_eq!(stored(&mut rig), StoredConfig::Loaded);
    assert_eq!(rig.status().table_crc, Table::usual().header.crc);
    let report = rig.send(&Command::TableDigest);
    assert!(matches!(report, Event::Table(table) if table.active == Some(Table::usual().header)));
    rig.arm();
    rig.play(&[(0, 0.5, 0.5)], 2000, 10);
    assert_eq!(rig.status().state, State::Driving);

    rig.accepted(&Command::Stop);
    rig.live_ms(50);
    disarm(&mut rig);
    rig.accepted(&Command::Forget);
    rig.device.restart(ResetCause::Pin);
    assert_eq!(stored(&mut rig), StoredConfig::Empty);
    assert_eq!(rig.status().table_crc, 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_damaged_store_is_visible_and_the_device_starts_with_nothing(
        damage in prop::collection::vec((0usize..2100, 1u8..), 1..6),
    ) {
        //
        let mut flash = kept();
        let before = flash.clone();
        for (at, bits) in damage {
            flash.slots[0][at] ^= bits;
        }
        prop_assume!(flash != before);
        let mut rig = Rig::new(Options { flash, ..Options::default() });
        prop_assert_eq!(stored(&mut rig), StoredConfig::Damaged);
        let status = rig.status();
        prop_assert_eq!((status.first_fault, status.table_crc), (Some(Fault::StoreDamaged), 0));
        let refusal = rig.refused(&Command::Arm);
        prop_assert_eq!(refusal, Refusal::Faulted { faults: status.faults });
        rig.accepted(&Command::ClearFaults);
        rig.upload(&Table::usual());
        rig.arm();
        disarm(&mut rig);
        rig.accepted(&Command::Store);
        rig.device.restart(ResetCause::Pin);
        prop_assert_eq!(stored(&mut rig), StoredConfig::Loaded);
    }

    #[test]
    fn a_flash_full_of_anything_never_stops_the_device_from_starting(slots in prop::collection::vec(any::<u8>(), 0..4000)) {
        //
        let mut flash = MemoryFlash::default();
        for (i, byte) in slots.into_iter().enumerate() {
            flash.slots[i % 2][i / 2] = byte;
        }
        let mut rig = Rig::new(Options { flash, ..Options::default() });
        prop_assert_ne!(stored(&mut rig), StoredConfig::Loaded);
    }
}

#[test]
fn a_table_stored_for_another_sample_rate_is_reported_as_such() {
    //
    let mut rig = Rig::new(Options { flash: kept(), sample_rate_hz: 200_000, ..Options::default() });
    assert_eq!(stored(&mut rig), StoredConfig::WrongVersion);
    assert_eq!(rig.status().table_crc, 0);
}

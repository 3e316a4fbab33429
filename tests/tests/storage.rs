//! Flash storage: written only while nothing sounds, read at the next start, dropped with a report when damaged.

use proptest::prelude::*;
use slipline_link::simulator::{MemoryFlash, Options};
use slipline_protocol::event::{Event, Fault, ResetCause, State, StoredConfig};
use slipline_protocol::refusal::Busy;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::rig::{MID, Rig, Table, drive};

fn stored(rig: &mut Rig) -> StoredConfig {
    match rig.hello().event {
        Event::Hello(identity) => identity.stored,
        other => panic!("{other:?}"),
    }
}

/// A device's flash after the usual table was stored.
fn kept() -> MemoryFlash {
    let mut rig = Rig::armed();
    rig.accepted(&Command::Store);
    rig.device.flash()
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
    rig.accepted(&Command::Store);
    assert_ne!(rig.device.flash(), blank);
}

#[test]
fn an_erase_that_stalls_the_processor_is_no_fault_and_no_sound() {
    // the DAC runs dry for as long as the erase takes; it repeats mid-scale.
    let mut rig = Rig::armed();
    rig.record();
    rig.accepted(&Command::Store);
    for _ in 0..10 {
        rig.device.inject_underrun();
        rig.live_blocks(1);
    }
    let status = rig.status();
    assert_eq!((status.state, status.first_fault, status.counters.underruns), (State::Armed, None, 10));
    assert!(rig.recording.codes.iter().all(|&code| code == MID));
}

#[test]
fn what_was_stored_is_there_after_a_reset_and_what_was_forgotten_is_not() {
    let mut rig = Rig::new(Options { flash: kept(), ..Options::default() });
    assert_eq!(stored(&mut rig), StoredConfig::Loaded);
    assert_eq!(rig.status().table_crc, Table::usual().header.crc);
    let report = rig.send(&Command::TableDigest);
    assert!(matches!(report, Event::Table(table) if table.active == Some(Table::usual().header)));
    rig.arm();
    rig.accepted(&Command::Drive(drive(&[(0, 0.5, 0.5)], 2000)));
    rig.live_ms(10);
    assert_eq!(rig.status().state, State::Driving);

    rig.accepted(&Command::Stop);
    rig.live_ms(50);
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

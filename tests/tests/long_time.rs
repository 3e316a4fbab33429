//! Large sample indices: nothing wraps, nothing drifts.

use slipline_link::simulator::Options;
use slipline_protocol::event::{Fault, State};
use slipline_protocol::limits::DEAD_MAN_MS;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, Rig, drive};

/// A short session that begins at a sample index: table, arm, drives across the first 40 000 samples, a host that dies.
fn session(first_index: u64) -> Rig {
    let mut rig = Rig::new(Options { first_index, ..Options::default() });
    rig.make_ready();
    rig.play(&[(0, 0.2, 0.5), (1, 0.9, 0.4)], 2000, 30);
    rig.play(&[(0, 0.7, 0.5), (1, 0.1, 0.4)], 8000, 60);
    rig.keep_alive();
    let last = rig.device.now();
    rig.silent_ms(DEAD_MAN_MS + 100);
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end > last + 400_000 && end < last + 421_000);
    rig
}

#[test]
fn sample_indices_across_2_to_the_32_and_2_to_the_63_give_the_same_codes() {
    // starts some blocks before the wrap of 32 bits and of 63, so that both fall amid the glides.
    let mut usual = session(0);
    let a = usual.status();
    assert_eq!(a.first_fault, Some(Fault::HostLost));
    for first in [(1u64 << 32) - 20_480, (1u64 << 63) - 20_480] {
        let mut late = session(first);
        assert_eq!(late.recording.first, first);
        assert_eq!(late.recording.codes, usual.recording.codes);
        assert_eq!(late.recording.muted, usual.recording.muted);
        let b = late.status();
        assert_eq!((a.state, a.first_fault, a.counters), (b.state, b.first_fault, b.counters));
        assert_eq!(a.first_fault_at + first, b.first_fault_at);
        assert_eq!(a.heat_per_mille, b.heat_per_mille);
    }
}

#[test]
fn near_the_last_sample_index_the_device_drives_and_refuses_without_a_panic() {
    // 2^64 samples are 1.4 million years, so only this is tested: it drives, refuses and does not panic.
    let first_index = u64::MAX - 2000 * BLOCK;
    let mut rig = Rig::new(Options { first_index, ..Options::default() });
    rig.make_ready();
    rig.play(&[(0, 0.2, 0.5)], 2000, 20);
    assert_eq!(rig.status().state, State::Driving);
    let command = Command::Drive(slipline_protocol::command::Drive {
        apply: slipline_protocol::command::Apply::At(0),
        ..drive(&[], 2000)
    });
    assert!(matches!(rig.refused(&command), Refusal::OutOfRange { .. }));
}

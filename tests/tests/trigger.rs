//! The trigger output rises with each program, at the answered index, and at no other time.

use slipline_link::simulator::SimulatedDevice;
use slipline_protocol::Command;
use slipline_protocol::command::Apply;
use slipline_protocol::units::SampleIndex;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, Rig, Table, drive};

/// Lets blocks pass and returns the indices of those with which the output rises.
fn rises(device: &mut SimulatedDevice, blocks: u64) -> Vec<SampleIndex> {
    let mut seen = Vec::new();
    device.advance(blocks, |block| {
        if block.begins {
            seen.push(block.first);
        }
    });
    seen
}

#[test]
fn the_trigger_rises_at_the_answered_index_even_in_successive_blocks() {
    let mut rig = Rig::armed();
    let mut answered = Vec::new();
    let mut seen = Vec::new();
    for position in [0.1, 0.3, 0.5] {
        answered.push(rig.accepted(&Command::Drive(drive(&[(0, position, 0.5)], 2000))));
        // Until it has begun; the next one begins with the block after.
        while seen.len() < answered.len() {
            seen.extend(rises(&mut rig.device, 1));
            assert!(rig.device.now() < answered[0] + 64 * BLOCK, "{seen:?}");
        }
    }
    let later = rig.device.now() + 20 * BLOCK + 5;
    let at = Command::Drive(slipline_protocol::command::Drive {
        apply: Apply::At(later),
        ..drive(&[(0, 0.2, 0.5)], 2000)
    });
    answered.push(rig.accepted(&at));
    assert_eq!(answered.last(), Some(&later.next_multiple_of(BLOCK)));
    seen.extend(rises(&mut rig.device, 40));
    assert_eq!(seen, answered);
}

#[test]
fn the_trigger_rises_with_a_table_that_comes_into_force_while_armed() {
    let mut rig = Rig::armed();
    rig.stage(&Table::line(65, 50_000.0, 30_000.0, |_| 1.0));
    let at = rig.accepted(&Command::TableCommit);
    assert_eq!(rises(&mut rig.device, 20), [at]);
    rig.accepted(&Command::Disarm);
    rig.live_ms(100);
    rig.stage(&Table::usual());
    rig.accepted(&Command::TableCommit);
    assert_eq!(rises(&mut rig.device, 20), [0_u64; 0], "a disarmed device raises nothing");
}

#[test]
fn the_trigger_does_not_rise_where_no_program_begins() {
    let mut rig = Rig::armed();
    rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
    rises(&mut rig.device, 40);
    for command in [Command::Stop, Command::Disarm, Command::Arm] {
        rig.accepted(&command);
        assert_eq!(rises(&mut rig.device, 200), [0_u64; 0], "{command:?}");
    }
}

#[test]
fn the_trigger_does_not_rise_for_a_program_that_is_dropped_or_whose_block_is_late() {
    let mut rig = Rig::armed();
    let apply = Apply::At(rig.device.now() + 40 * BLOCK);
    let later = Command::Drive(slipline_protocol::command::Drive { apply, ..drive(&[(0, 0.2, 0.5)], 2000) });
    rig.accepted(&later);
    rises(&mut rig.device, 4);
    rig.accepted(&Command::Stop);
    assert_eq!(rises(&mut rig.device, 80), [0_u64; 0], "stopped before it began");

    let at = rig.accepted(&Command::Drive(drive(&[(0, 0.2, 0.5)], 2000)));
    let before = (at - rig.device.now()) / BLOCK;
    assert_eq!(rises(&mut rig.device, before), [0_u64; 0]);
    rig.device.inject_underrun();
    assert_eq!(rises(&mut rig.device, 80), [0_u64; 0], "its block is not played");
}

//! R-53 in the mirror: a fold-back that comes and goes is replayed code for code, from the status alone.

use std::sync::Arc;

use slipline_app::Timing;
use slipline_app::thermal::Heat;
use slipline_link::mirror::Mirror;
use slipline_link::simulator::Options;
use slipline_protocol::Command;
use slipline_tests::client::Client;
use slipline_tests::rig::{RATE_HZ, Rig, Table, drive};

/// Lives for some blocks, tells the mirror what the status says of the limit, and compares all codes since. Returns
/// the limit, per mille.
fn follow(rig: &mut Rig, mirror: &mut Mirror, blocks: u64) -> u16 {
    rig.live_blocks(blocks);
    let status = rig.status();
    mirror.acknowledge_limit(status.foldback_per_mille, Timing::at(RATE_HZ).limit_since(status.now)).unwrap();
    mirror.render(rig.device.now(), |first, codes| {
        if let Some(at) = first.checked_sub(rig.recording.first) {
            let sent = &rig.recording.codes[at as usize..][..codes.len()];
            assert_eq!(sent, codes, "at {first}, limit {}", status.foldback_per_mille);
        }
    });
    rig.record();
    status.foldback_per_mille
}

#[test]
fn the_mirror_of_a_hot_coil_folds_back_with_it_code_for_code() {
    let mut rig = Rig::new(Options { heat: Heat::AssumedHot, ..Options::default() });
    rig.hello();
    let table = Table::usual();
    let mut mirror = Mirror::new(RATE_HZ, 0);
    let at = rig.upload(&table);
    mirror.acknowledge_table(Arc::from(table.knots), at).unwrap();
    rig.arm();
    let status = rig.status();
    mirror.acknowledge_limit(status.foldback_per_mille, Timing::at(RATE_HZ).limit_since(status.now)).unwrap();
    let sound = |rig: &mut Rig, mirror: &mut Mirror, level| {
        let drive = drive(&[(0, 1.0, level)], 4000);
        let at = rig.accepted(&Command::Drive(drive.clone()));
        mirror.acknowledge_drive(&drive, at).unwrap();
    };
    let mut limits = Vec::new();
    // Softly while it cools, then as loud as it goes until it is folded back again.
    for (level, rounds) in [(0.2, 24), (1.0, 60)] {
        sound(&mut rig, &mut mirror, level);
        for round in 0..rounds {
            // Never in step with the limit's own grid, and never longer than its step.
            limits.push(follow(&mut rig, &mut mirror, 600 + 37 * (round % 10)));
        }
    }
    assert!(mirror.is_true());
    assert_eq!(limits[0], 500, "hot at first");
    assert!(limits.contains(&1000), "then cool: {limits:?}");
    assert!(limits.last().is_some_and(|&limit| limit < 900), "then hot again: {limits:?}");
}

#[test]
fn a_limit_that_is_told_after_its_time_makes_the_mirror_untrue() {
    let mut mirror = Mirror::new(RATE_HZ, 0);
    mirror.acknowledge_limit(1000, 0).unwrap();
    let step = Timing::at(RATE_HZ).limit_period;
    mirror.render(2 * step, |_, _| {});
    mirror.acknowledge_limit(1000, step).unwrap();
    assert!(mirror.is_true(), "nothing new was told");
    assert!(mirror.acknowledge_limit(990, step).is_err());
    assert!(!mirror.is_true());
    mirror.silence(3 * step);
    assert!(mirror.is_true(), "silence begins anew, with the limit that was told last");
}

//! R-53 in the mirror: a fold-back that comes and goes is replayed code for code, from the status alone.

use std::sync::Arc;

use slipline_app::Timing;
use slipline_app::safety::thermal::Heat;
use slipline_link::foldback::FoldbackSteps;
use slipline_link::mirror::Mirror;
use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::{Change, Port, Request};
use slipline_protocol::event::Status;
use slipline_protocol::{Command, Event};
use slipline_tests::client::Client;
use slipline_tests::faulty_ports::as_real;
use slipline_tests::link_rig::{self, LinkRig};
use slipline_tests::rig::{BLOCK, RATE_HZ, Rig, Table, drive};

/// Lives for some blocks, gives the mirror the changes of the limit between the last two statuses, and compares all codes
/// since. Returns the limit, per mille.
fn follow(rig: &mut Rig, mirror: &mut Mirror, before: &mut Option<Status>, blocks: u64) -> u16 {
    rig.live_blocks(blocks);
    let status = rig.status();
    let heard = FoldbackSteps::between(before.as_ref(), &status, &Timing::at(RATE_HZ));
    assert!(heard.is_complete);
    for (at, per_mille) in heard.steps {
        mirror.acknowledge_limit(per_mille, at).unwrap();
    }
    *before = Some(status);
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
    let mut rig = Rig::greeted_with(Options { heat: Heat::AssumedHot, ..Options::default() });
    let table = Table::usual();
    let mut mirror = Mirror::new(RATE_HZ, 0);
    let at = rig.upload(&table);
    mirror.acknowledge_table(Arc::from(table.knots), at).unwrap();
    rig.arm();
    let mut heard = None;
    follow(&mut rig, &mut mirror, &mut heard, 1);
    let sound = |rig: &mut Rig, mirror: &mut Mirror, level| {
        let drive = drive(&[(0, 1.0, level)], 4000);
        let at = rig.accepted(&Command::Drive(drive.clone()));
        mirror.acknowledge_play(drive, at).unwrap();
    };
    let mut limits = Vec::new();
    // Softly while it cools, then as loud as it goes until it is folded back again.
    // A status in every period of the limit; then one in several periods, as when answers are lost: up to the longest
    // gap that a connection survives. Never in step with the periods.
    for (level, rounds, blocks) in [(0.2, 24, 600), (1.0, 60, 600), (1.0, 12, 2700)] {
        sound(&mut rig, &mut mirror, level);
        for round in 0..rounds {
            limits.push(follow(&mut rig, &mut mirror, &mut heard, blocks + 37 * (round % 10)));
        }
    }
    assert!(mirror.is_true());
    assert_eq!(limits[0], 500, "hot at first");
    assert!(limits.contains(&1000), "then cool: {limits:?}");
    assert!(limits.last().is_some_and(|&limit| limit < 900), "then hot again: {limits:?}");
}

#[test]
fn a_limit_that_is_reported_after_its_time_makes_the_mirror_untrue() {
    let mut mirror = Mirror::new(RATE_HZ, 0);
    mirror.acknowledge_limit(1000, 0).unwrap();
    let step = Timing::at(RATE_HZ).limit_period;
    mirror.render(2 * step, |_, _| {});
    mirror.acknowledge_limit(1000, step).unwrap();
    assert!(mirror.is_true(), "no new limit was reported");
    assert!(mirror.acknowledge_limit(990, step).is_err());
    assert!(!mirror.is_true());
    mirror.silence(3 * step);
    assert!(mirror.is_true(), "after silence it starts with the limit that was reported last");
}

/// The steps that the link notes of a device that cools down, when the answers at these times, in ms, are lost.
fn noted(lost: &[(u64, u32)]) -> Vec<(u64, u16, bool)> {
    let mut rig = LinkRig::new();
    rig.ports().device = SimulatedDevice::new(Options { heat: Heat::AssumedHot, ..Options::default() });
    rig.ask(Request::Connect(Port::Serial("A".to_owned())));
    let mut passed = 0;
    for &(ms, count) in lost {
        rig.pass_ms(ms - passed);
        rig.ports().drop_replies = count;
        passed = ms;
    }
    rig.pass_ms(4000 - passed);
    assert!(rig.view().is_connected());
    let steps = rig.view().record.journal.iter().filter_map(|entry| match entry.change {
        Change::Limit(per_mille) => Some((entry.at, per_mille, entry.is_exact)),
        _ => None,
    });
    steps.collect()
}

#[test]
fn the_journal_has_every_step_of_the_fold_back_despite_lost_answers() {
    let steps = noted(&[]);
    assert!(steps.len() > 5, "{steps:?}");
    assert_eq!(noted(&[(500, 2), (1700, 3), (2900, 1)]), steps);
}

/// Follows the link, and compares the last 0.4 s with what the device has sent. Returns whether the replay calls
/// these codes exact: if it does and they differ, `slipline verify` would raise a false alarm.
fn is_exact(rig: &LinkRig, replay: &mut Replay) -> bool {
    let history = DeviceHistory::of(rig.view()).unwrap();
    replay.follow(&history);
    let count = RATE_HZ * 2 / 5;
    let from = history.now - u64::from(count) - BLOCK;
    let Some(codes) = replay.exact_codes(from, count) else { return false };
    let codes: Vec<u16> = codes.collect();
    assert!(codes == rig.sent(from, count), "from {from}");
    true
}

/// A hot device that is driven through the link, and a replay that knows its codes.
fn replayed() -> (LinkRig, Replay) {
    let mut rig = LinkRig::armed_as(Options { heat: Heat::AssumedHot, ..Options::default() });
    rig.record();
    rig.ask_and_pass(link_rig::drive(0.05), 1000);
    let mut replay = Replay::new(RATE_HZ as usize);
    assert!(is_exact(&rig, &mut replay));
    (rig, replay)
}

#[test]
fn a_lost_status_leaves_the_replay_exact() {
    let (mut rig, mut replay) = replayed();
    let mut limits = Vec::new();
    for round in 0..30 {
        if round % 4 == 1 {
            rig.ports().drop_replies = 1;
        }
        rig.pass_ms(230);
        assert!(is_exact(&rig, &mut replay), "round {round}");
        limits.push(rig.view().drive.status.unwrap().foldback_per_mille);
    }
    limits.dedup();
    assert!(limits.len() > 5, "the fold-back changed all the time: {limits:?}");
    assert!(rig.view().link.counters.timeouts >= 7, "{:?}", rig.view().link.counters);
}

#[test]
fn after_more_lost_steps_than_a_status_holds_the_replay_is_inexact_until_the_fold_back_is_known() {
    let (mut rig, mut replay) = replayed();
    // Seven steps more than the host knows, as after a gap longer than what a status covers.
    rig.ports().rewrite = |event| match as_real(event) {
        Event::Status(status) => {
            Event::Status(Status { foldback_changes: status.foldback_changes + 7, ..status })
        }
        event => event,
    };
    let mut exact = Vec::new();
    for _ in 0..80 {
        rig.pass_ms(20);
        exact.push(is_exact(&rig, &mut replay));
    }
    assert!(exact.contains(&false), "the gap was noticed");
    assert_eq!(exact.last(), Some(&true), "and is over: {exact:?}");
    exact.dedup();
    assert_eq!(exact, [true, false, true]);
}

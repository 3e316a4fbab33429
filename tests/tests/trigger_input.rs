//! A drive that waits for the trigger input: when it begins, what drops it, and that its codes are the mirror's.

use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::simulator::Options;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::{Change, DeviceTable, DriveRequest, Played, Request, Sounding};
use slipline_protocol::Command;
use slipline_protocol::command::{Apply, Drive};
use slipline_protocol::event::{Fault, State, TriggerReport};
use slipline_protocol::limits::MAX_DRIVE_MS;
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::SampleIndex;
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, Rig, Table, drive};
use std::sync::Arc;

/// A drive of one tone that waits.
fn waiting(position: f64) -> Command {
    Command::Drive(Drive { apply: Apply::AtTrigger, ..drive(&[(0, position, 0.5)], 2000) })
}

/// The device's report of the drive that waits.
fn report(rig: &mut Rig) -> TriggerReport {
    answer!(rig, Command::Trigger, Trigger)
}

/// Lets blocks pass, fed, and returns where programs began.
fn begun(rig: &mut Rig, blocks: u64) -> Vec<SampleIndex> {
    let mut seen = Vec::new();
    rig.keep_alive();
    rig.device.advance(blocks, |block| {
        if block.begins {
            seen.push(block.first);
        }
    });
    seen
}

#[test]
fn a_waiting_drive_begins_with_the_first_block_that_is_rendered_after_the_rise() {
    let mut rig = Rig::armed();
    for position in [0.1, 0.6] {
        let from = rig.accepted(&waiting(position));
        assert_eq!(begun(&mut rig, 300), [0_u64; 0]);
        assert_eq!(rig.status().state, State::Waiting);
        let before = report(&mut rig);
        assert!(before.waits);
        rig.device.raise_trigger();
        let at = rig.device.now();
        assert!(from < at);
        assert_eq!(begun(&mut rig, 20), [at], "the next block, and then no other");
        assert_eq!(report(&mut rig), TriggerReport { waits: false, began: Some(at) });
        assert_eq!(rig.status().state, State::Driving);
    }
}

#[test]
fn a_rise_that_came_before_counts_for_nothing() {
    let mut rig = Rig::armed();
    rig.device.raise_trigger();
    begun(&mut rig, 3);
    rig.accepted(&waiting(0.1));
    assert_eq!(begun(&mut rig, 100), [0_u64; 0]);
    // For the drive that takes its place neither, although the device was listening already.
    rig.device.raise_trigger();
    rig.accepted(&waiting(0.2));
    assert_eq!(begun(&mut rig, 100), [0_u64; 0]);
    assert_eq!(report(&mut rig), TriggerReport { waits: true, began: None });
}

#[test]
fn a_drive_waits_until_the_motion_that_it_was_planned_from_rests() {
    let mut rig = Rig::armed();
    rig.accepted(&Command::Drive(drive(&[(0, 0.1, 0.5)], 2000)));
    begun(&mut rig, 100);
    let at = rig.accepted(&Command::Drive(drive(&[(0, 0.9, 0.5)], 40_000)));
    assert_eq!(begun(&mut rig, 2), [at]);
    let from = rig.accepted(&waiting(0.3));
    assert!(from >= at + 40_000, "the glide is over: {from}");
    rig.device.raise_trigger();
    let blocks = (from - rig.device.now()) / BLOCK;
    assert_eq!(begun(&mut rig, blocks + 100), [0_u64; 0], "a rise during the glide counts for nothing");
    rig.device.raise_trigger();
    assert_eq!(begun(&mut rig, 3).len(), 1);
}

#[test]
fn a_newer_drive_replaces_a_waiting_one_and_a_table_waits_for_it() {
    let mut rig = Rig::armed();
    rig.accepted(&waiting(0.1));
    rig.stage(&Table::line(65, 50_000.0, 30_000.0, |_| 1.0));
    assert_eq!(rig.refused(&Command::TableCommit), Refusal::Busy(Busy::CommitPending));
    // One that is refused changes nothing.
    let twice = Drive { apply: Apply::Next, ..drive(&[(0, 0.2, 0.1), (0, 0.3, 0.1)], 2000) };
    assert_eq!(rig.refused(&Command::Drive(twice)), Refusal::SlotTwice { slot: 0 });
    assert!(report(&mut rig).waits);
    let at = rig.accepted(&Command::Drive(drive(&[(0, 0.2, 0.5)], 2000)));
    assert_eq!(begun(&mut rig, 10), [at]);
    rig.device.raise_trigger();
    assert_eq!(begun(&mut rig, 100), [0_u64; 0]);
    assert_eq!(report(&mut rig), TriggerReport { waits: false, began: None });
    rig.accepted(&Command::TableCommit);
}

#[test]
fn stops_disarming_and_a_hello_drop_a_waiting_drive() {
    for command in [Command::Stop, Command::EmergencyStop, Command::Disarm] {
        let mut rig = Rig::armed();
        rig.accepted(&waiting(0.1));
        begun(&mut rig, 10);
        rig.accepted(&command);
        rig.device.raise_trigger();
        assert_eq!(begun(&mut rig, 200), [0_u64; 0], "{command:?}");
        assert_eq!(report(&mut rig), TriggerReport { waits: false, began: None }, "{command:?}");
    }
    let mut rig = Rig::armed();
    rig.accepted(&waiting(0.1));
    rig.hello();
    rig.arm();
    rig.device.raise_trigger();
    assert_eq!(begun(&mut rig, 200), [0_u64; 0], "another session");
}

#[test]
fn the_dead_man_and_a_fault_drop_a_waiting_drive() {
    let mut rig = Rig::armed();
    rig.accepted(&waiting(0.1));
    begun(&mut rig, 10);
    // Nothing sounds: no harm is done, and the device disarms.
    rig.device.advance(3200, |block| assert!(!block.begins));
    assert_eq!(rig.status().state, State::Idle);
    rig.device.raise_trigger();
    assert_eq!(begun(&mut rig, 200), [0_u64; 0]);

    let mut rig = Rig::armed();
    rig.accepted(&Command::Drive(drive(&[(0, 0.1, 0.5)], 2000)));
    begun(&mut rig, 40);
    rig.accepted(&waiting(0.6));
    begun(&mut rig, 10);
    rig.device.inject_underrun();
    begun(&mut rig, 10);
    assert_eq!(rig.status().first_fault, Some(Fault::Underrun));
    rig.device.raise_trigger();
    assert_eq!(begun(&mut rig, 200), [0_u64; 0]);
    assert!(!report(&mut rig).waits);
}

#[test]
fn the_drive_time_counts_from_the_rise() {
    // At 8 kS/s, so that ten minutes are few blocks.
    let rate = 8000;
    let mut rig = Rig::greeted_with(Options { sample_rate_hz: rate, ..Options::default() });
    rig.upload(&Table::usual().at_rate(rate));
    rig.arm();
    rig.accepted(&waiting(0.1));
    // The instrument is late: the wait is no drive.
    rig.live_ms(MAX_DRIVE_MS + 2000);
    rig.device.raise_trigger();
    rig.live_ms(MAX_DRIVE_MS - 1000);
    assert_eq!(rig.status().state, State::Driving);
    rig.live_ms(2000);
    assert_eq!(rig.status().first_fault, Some(Fault::DriveTime));
}

/// A link with a device, and the codes that it has sent since.
struct Watched {
    loopback: Loopback,
    codes: Vec<u16>,
    replay: Replay,
}

impl Watched {
    fn new() -> Self {
        let mut loopback = Loopback::connect(400_000).unwrap();
        let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        let mut codes = Vec::new();
        let before = loopback.samples();
        loopback.perform(Request::Upload(Arc::new(table)), |block| codes.extend(block)).unwrap();
        codes.splice(0..0, std::iter::repeat_n(2048, before as usize));
        Self { loopback, codes, replay: Replay::new(10_000_000) }
    }

    fn perform(&mut self, request: Request) -> SampleIndex {
        self.loopback.perform(request, |block| self.codes.extend(block)).unwrap()
    }

    fn pass(&mut self, samples: u64) {
        self.loopback.pass(samples, |block| self.codes.extend(block));
    }

    fn wait_at(&mut self, boundary_m: f64) -> SampleIndex {
        let drive = DriveRequest { apply: Apply::AtTrigger, ..DriveRequest::at(&[(boundary_m, 0.5)]) };
        self.perform(Request::Play(Sounding::Drive(drive)))
    }

    /// Every code that the mirror knows, which are those of the device; returns how many.
    fn compare(&mut self) -> usize {
        self.replay.follow(&DeviceHistory::of(self.loopback.view()).unwrap());
        assert!(self.replay.exact_since().is_some());
        let (first, codes) = self.replay.drive_codes();
        let codes: Vec<u16> = codes.collect();
        assert_eq!(codes, self.codes[first as usize..][..codes.len()]);
        first as usize + codes.len()
    }
}

#[test]
fn the_mirror_waits_for_the_reported_rise_and_is_exact_from_there_on() {
    let mut watched = Watched::new();
    watched.perform(Request::Play(Sounding::Drive(DriveRequest::at(&[(0.02, 0.4)]))));
    watched.pass(20_000);
    let from = watched.wait_at(0.05);
    watched.pass(200_000);
    let known = watched.compare();
    assert!(known as u64 > from, "what sounds while it waits is known: {known}");
    watched.loopback.raise_trigger();
    let rose = watched.loopback.samples();
    for _ in 0..400 {
        // With each block: at no moment does the mirror take a code for granted that is another in the device.
        watched.pass(BLOCK);
        watched.compare();
    }
    watched.perform(Request::Refresh);
    watched.pass(2000);
    assert!(watched.compare() as u64 > rose + 40_000);
    let report = watched.loopback.view().drive.trigger.unwrap();
    assert_eq!(report, TriggerReport { waits: false, began: Some(rose) });
}

#[test]
fn a_stop_that_is_reported_before_the_drive_that_it_ended_is_mirrored_behind_it() {
    let mut watched = Watched::new();
    watched.wait_at(0.05);
    watched.pass(100_000);
    watched.loopback.raise_trigger();
    // Sooner than the next status.
    watched.pass(4 * BLOCK);
    watched.perform(Request::Stop);
    for _ in 0..200 {
        watched.pass(BLOCK);
        watched.compare();
    }
    let kinds: Vec<&str> = watched
        .loopback
        .view()
        .record
        .journal
        .iter()
        .filter_map(|entry| match entry.change {
            Change::Play(Played::Drive(_)) => Some("drive"),
            Change::Stop => Some("stop"),
            _ => None,
        })
        .collect();
    assert_eq!(kinds, ["drive", "stop"]);
    assert!(watched.codes.iter().any(|&code| code != 2048), "it sounded");
}

#[test]
fn a_drive_that_took_the_place_of_one_that_waited_is_mirrored_with_it_or_without() {
    for rises in [false, true] {
        let mut watched = Watched::new();
        watched.wait_at(0.05);
        watched.pass(50_000);
        if rises {
            watched.loopback.raise_trigger();
        }
        watched.pass(4 * BLOCK);
        let second = watched.wait_at(0.08);
        watched.pass(20_000);
        watched.compare();
        watched.loopback.raise_trigger();
        for _ in 0..400 {
            watched.pass(BLOCK);
            watched.compare();
        }
        watched.perform(Request::Play(Sounding::Drive(DriveRequest::at(&[(0.01, 0.3)]))));
        watched.pass(100_000);
        watched.perform(Request::Refresh);
        watched.pass(2000);
        assert!(watched.compare() as u64 > second + 100_000, "{rises}");
    }
}

//! The host's link with a present device: replies that are lost, requests that overtake each other, in virtual time.

use std::sync::Arc;
use std::time::Duration;

use proptest::prelude::*;
use slipline_link::DeviceTable;
use slipline_link::{
    Acknowledged, Change, DriveRequest, FRAMES_KEPT, LinkError, LinkState, Outcome, Played, Port, Request,
    Sounding, Ticket, ToneRequest,
};
use slipline_protocol::Command;
use slipline_protocol::event::{Fault, State};
use slipline_protocol::limits::{KEEP_ALIVE_PERIOD_MS, MAX_RETRIES, REPLY_TIMEOUT_MS};
use slipline_tests::faulty_ports::board;
use slipline_tests::link_rig::{LOST_AFTER_MS, LinkRig, drive};

#[test]
fn a_lost_reply_is_asked_for_again_and_the_command_is_done_once() {
    //
    let mut rig = LinkRig::armed();
    let duplicates = rig.view().drive.status.unwrap().counters.duplicates;
    rig.ports().drop_replies = 1;
    let ticket = rig.ask(drive(0.05));
    rig.pass_ms(2 * u64::from(REPLY_TIMEOUT_MS));
    assert!(matches!(rig.outcome(ticket), Some(Outcome::Done { .. })));
    rig.pass_ms(u64::from(KEEP_ALIVE_PERIOD_MS) + 10);
    assert_eq!(
        rig.view().drive.status.unwrap().counters.duplicates,
        duplicates + 1,
        "answered from the cache"
    );
    let drives = rig
        .view()
        .record
        .journal
        .iter()
        .filter(|entry| matches!(entry.change, Change::Play(Played::Drive(_))))
        .count();
    assert_eq!(drives, 1);
}

#[test]
fn a_device_that_answers_no_more_is_lost_after_three_repeats_of_the_same_number() {
    //
    let mut rig = LinkRig::armed();
    rig.ask(Request::AutoReconnect(false));
    rig.ports().drop_replies = u32::MAX;
    rig.ports().commands.clear();
    let ticket = rig.ask(Request::Disarm);
    rig.pass_ms(LOST_AFTER_MS + 10);
    assert_eq!(rig.view().link.state, LinkState::Lost(LinkError::Silent));
    assert_eq!(rig.outcome(ticket), Some(Outcome::NotConnected));
    let ports = rig.ports();
    let disarms: Vec<u16> =
        ports.commands.iter().filter(|(_, c)| *c == Command::Disarm).map(|(s, _)| *s).collect();
    assert_eq!(disarms.len() as u32, 1 + MAX_RETRIES);
    assert!(disarms.iter().all(|sequence| *sequence == disarms[0]));
}

#[test]
fn at_rest_the_link_wakes_only_for_its_keep_alives() {
    let rig = LinkRig::connected();
    let due = rig.connection.deadline(rig.now).unwrap();
    assert!(due > rig.now && due <= rig.now + Duration::from_millis(u64::from(KEEP_ALIVE_PERIOD_MS)));
}

#[test]
fn a_status_that_is_requested_after_a_sleep_is_new() {
    let mut rig = LinkRig::armed();
    rig.ask_and_pass(drive(0.05), 100);
    // The device answers a keep-alive, and the host sleeps before it reads the answer.
    rig.ports().commands.clear();
    let is_sent = (0..=KEEP_ALIVE_PERIOD_MS).any(|_| {
        rig.pass_ms(1);
        rig.ports().commands.iter().any(|(_, command)| matches!(command, Command::KeepAlive(_)))
    });
    assert!(is_sent);
    rig.sleep(Duration::from_secs(2));
    let awake_at = rig.ports().device.now();
    let refresh = rig.ask(Request::Refresh);
    rig.pass_ms(100);
    assert!(matches!(rig.outcome(refresh), Some(Outcome::Done { at }) if at >= awake_at));
    assert_eq!(rig.state(), State::Fault);
}

#[test]
fn the_newest_drive_wins_and_a_stop_overtakes_all_of_them() {
    let mut rig = LinkRig::armed();
    rig.ports().commands.clear();
    let tickets: Vec<Ticket> = [0.01, 0.02, 0.03, 0.04].map(|x_m| rig.only_ask(drive(x_m))).to_vec();
    let stop = rig.ask(Request::Stop);
    rig.pass_ms(50);
    assert!(tickets.iter().all(|ticket| rig.outcome(*ticket) == Some(Outcome::Superseded)));
    assert!(matches!(rig.outcome(stop), Some(Outcome::Done { .. })));
    assert!(!rig.ports().commands.iter().any(|(_, command)| matches!(command, Command::Drive(_))));
}

#[test]
fn a_disconnect_stops_and_disarms_first() {
    let mut rig = LinkRig::armed();
    rig.ask_and_pass(drive(0.05), 100);
    rig.ask_and_pass(Request::Disconnect, 100);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    let ports = rig.ports();
    let last: Vec<&Command> = ports.commands.iter().rev().take(2).map(|(_, command)| command).collect();
    assert_eq!(last, [&Command::Disarm, &Command::Stop]);
    assert!(ports.device.is_muted());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn every_request_under_way_when_the_link_closes_has_an_outcome(
        asked in prop::collection::vec((0..11usize, 0..3u64), 1..30),
        dropped in prop::option::weighted(0.3, 1..6u32),
    ) {
        let table = || {
            let knots = (0..100).map(|i| (200.0 + f64::from(i), 0.5));
            Arc::new(DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap())
        };
        let requests: [fn() -> Request; 10] = [
            || drive(0.05),
            || Request::Stop,
            || Request::EmergencyStop,
            || Request::ClearFaults,
            || Request::Arm,
            || Request::Disarm,
            || Request::Refresh,
            || Request::ReadBoard,
            || Request::CancelUpload,
            || Request::Store,
        ];
        let mut rig = LinkRig::armed();
        rig.ports().drop_replies = dropped.unwrap_or_default();
        let mut tickets = Vec::new();
        for (kind, milliseconds) in asked {
            tickets.push(rig.only_ask(requests.get(kind).map_or_else(|| Request::Upload(table()), |make| make())));
            rig.pass_ms(milliseconds);
        }
        tickets.push(rig.ask(Request::Disconnect));
        rig.pass_ms(1000);
        for ticket in tickets {
            prop_assert!(rig.outcome(ticket).is_some(), "{ticket:?}");
        }
    }
}

#[test]
fn a_drag_during_a_table_swap_uses_the_positions_of_the_table_in_force() {
    let mut rig = LinkRig::armed();
    let knots = (0..100).map(|i| (100.0 + f64::from(i), 0.5));
    let wide = Arc::new(DeviceTable::from_knots((0.0, 0.2), 400e3, knots, 1e-6).unwrap());
    let upload = rig.ask(Request::Upload(wide));
    for _ in 0..300 {
        if rig.outcome(upload).is_none() {
            rig.only_ask(drive(0.05));
        }
        rig.pass_ms(1);
    }
    assert!(matches!(rig.outcome(upload), Some(Outcome::Done { .. })));
    let mut span_um = 100_000;
    let mut spans = Vec::new();
    for entry in rig.view().record.journal.iter() {
        match &entry.change {
            Change::Table(table) => span_um = table.header().span_end_um,
            Change::Play(Played::Drive(drive)) => {
                // 50 mm of the span, in 65 536ths of it.
                let part = f64::from(drive.tones[0].position.0) / 65536.0;
                assert!((part * f64::from(span_um) - 50_000.0).abs() < 5.0, "{part} of {span_um} um");
                spans.push(span_um);
            }
            _ => {}
        }
    }
    spans.dedup();
    assert_eq!(spans, [100_000, 200_000], "drives before and after");
}

#[test]
fn a_disconnect_while_the_link_closes_for_another_port_cancels_the_connect() {
    let mut rig = LinkRig::armed();
    rig.ports().listed.push(board("B"));
    let connect = rig.only_ask(Request::Connect(Port::Serial("B".to_owned())));
    let disconnect = rig.ask(Request::Disconnect);
    rig.pass_ms(1000);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    assert_eq!(rig.outcome(connect), Some(Outcome::Superseded));
    assert!(matches!(rig.outcome(disconnect), Some(Outcome::Done { .. })));
    assert_eq!(rig.ports().opened.len(), 1);
}

#[test]
fn frames_are_kept_only_on_request() {
    let mut rig = LinkRig::connected();
    rig.pass_ms(1000);
    assert_eq!(rig.view().record.frames.len(), 0);
    let mut rig = LinkRig::new();
    rig.connection.keep_frames();
    rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), 1000);
    let frames: Vec<String> = rig.view().record.frames.iter().map(ToString::to_string).collect();
    assert!(frames[0].contains(" to device ") && frames[0].contains("Hello"), "{frames:?}");
    assert!(frames[1].contains(" to host ") && frames[1].contains("Hello"), "{frames:?}");
    rig.pass_ms(20_000);
    assert_eq!(rig.view().record.frames.len(), FRAMES_KEPT);
}

#[test]
fn a_step_in_which_nothing_happens_changes_nothing() {
    let mut rig = LinkRig::connected();
    rig.pass_ms(300);
    rig.connection.take_changes();
    rig.connection.step(rig.now);
    assert_eq!(rig.connection.take_changes(), (false, false));
}

#[test]
fn a_stop_by_the_device_itself_is_journalled_with_an_inexact_index() {
    // the samples cannot be known from the journal until the next silence.
    let mut rig = LinkRig::armed();
    rig.ask_and_pass(drive(0.05), 300);
    rig.ports().device.inject_underrun();
    rig.pass_ms(300);
    let status = rig.view().drive.status.unwrap();
    assert_eq!(status.first_fault, Some(Fault::Underrun));
    let summary = |entry: &Acknowledged| (entry.at, entry.change.clone(), entry.is_exact);
    assert_eq!(
        rig.view().record.journal.back().map(|entry| summary(entry)),
        Some((status.first_fault_at, Change::Stop, false))
    );

    // The user's requests are, whatever the status says first.
    for request in [Request::ClearFaults, Request::Arm, drive(0.05)] {
        rig.ask_and_pass(request, 100);
    }
    rig.ports().drop_replies = 1;
    rig.ask_and_pass(Request::EmergencyStop, 1000);
    assert_eq!(rig.view().drive.status.unwrap().state, State::Fault);
    assert_eq!(rig.view().record.journal.iter().filter(|entry| !entry.is_exact).count(), 1, "that of before");
}

#[test]
fn a_request_that_waits_for_the_handshake_does_not_keep_the_link_awake() {
    //
    let mut rig = LinkRig::new();
    rig.ports().drop_replies = u32::MAX;
    rig.ask(Request::Connect(Port::Serial("A".to_owned())));
    rig.ask(Request::Disarm);
    assert!(rig.connection.deadline(rig.now).unwrap() > rig.now);
}

#[test]
fn values_out_of_range_never_reach_the_wire() {
    let mut rig = LinkRig::armed();
    rig.ports().commands.clear();
    let tone = |boundary_m, level, phase_turns| ToneRequest { slot: 0, boundary_m, level, phase_turns };
    let good = DriveRequest::of(vec![tone(0.05, 0.5, 0.0)]);
    for (request, field) in [
        (DriveRequest::of(vec![tone(f64::NAN, 0.5, 0.0)]), "boundary"),
        (DriveRequest::of(vec![tone(0.2, 0.5, 0.0)]), "boundary"),
        (DriveRequest::of(vec![tone(0.05, 1.1, 0.0)]), "level"),
        (DriveRequest::of(vec![tone(0.05, 0.5, f64::INFINITY)]), "phase"),
        (DriveRequest::of(vec![ToneRequest { slot: 16, ..tone(0.05, 0.5, 0.0) }]), "slot"),
        (DriveRequest::of(vec![tone(0.05, 0.1, 0.0); 17]), "17 tones"),
        (DriveRequest { master_db: 1.0, ..good.clone() }, "master"),
        (DriveRequest { glide_s: f64::NAN, ..good }, "glide"),
    ] {
        let ticket = rig.ask(Request::Play(Sounding::Drive(request)));
        match rig.outcome(ticket) {
            Some(Outcome::Refused(refusal)) => assert!(refusal.to_string().contains(field), "{refusal}"),
            other => panic!("{field}: {other:?}"),
        }
    }
    assert!(rig.ports().commands.iter().all(|(_, command)| !matches!(command, Command::Drive(_))));
}

#[test]
fn the_window_asks_for_the_stop_on_a_panic_before_it_paints_anything() {
    // It needs a screen to run, so its source is read.
    let path = slipline_tests::source_tree::root().join("host/window/src/app/window.rs");
    let source = std::fs::read_to_string(path).unwrap();
    let made = source.find("Worker::spawn").expect("the link's thread");
    let asked = source.find("stop_on_panic(").expect("it is asked for");
    let painted = source.find("App::new(").expect("the window");
    assert!(made < asked && asked < painted);
}

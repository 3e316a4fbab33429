//! The limit of the actuator's travel: set by the link with the table, kept by the device, gone with the session.

use std::sync::Arc;

use slipline_app::Timing;
use slipline_link::DeviceTable;
use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::{DriveRequest, LinkState, Outcome, Request, Severity, Sounding};
use slipline_protocol::command::{TravelLimit, TravelSetting};
use slipline_protocol::event::{Event, ResetCause, State};
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::faulty_ports::identified;
use slipline_tests::link_rig::LinkRig;
use slipline_tests::rig::{RATE_HZ, Rig, Table, drive};

/// A voice coil with its resonance at 50 Hz, Q = 4, that a quarter of full scale would hold at its peak travel.
const COIL: TravelLimit =
    TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 4000, static_ppm: 4_000_000 };

/// Two periods of 50 Hz.
const SHORTEST: u32 = RATE_HZ / 25;

/// From 10 Hz to 110 Hz over 100 mm: the resonance lies at 40 mm.
fn table() -> DeviceTable {
    let knots = (0..=100).map(|i| (10.0 + f64::from(i), 1.0));
    DeviceTable::from_knots((0.0, 0.1), f64::from(RATE_HZ), knots, 1e-6).unwrap()
}

fn limited() -> Arc<DeviceTable> {
    Arc::new(table().with_travel_limit(50.0, 4.0, 4.0).unwrap())
}

fn on_the_wire() -> Table {
    Table::line(101, 10.0, 110.0, |_| 1.0)
}

fn set(limit: Option<TravelLimit>) -> Command {
    Command::SetTravelLimit(TravelSetting { limit })
}

fn in_force(rig: &mut Rig) -> Option<TravelLimit> {
    match rig.send(&Command::TravelLimit) {
        Event::TravelLimit(setting) => setting.limit,
        other => panic!("{other:?}"),
    }
}

/// A real device with the table of a plate whose travel is limited, armed.
fn driving(table: &Arc<DeviceTable>) -> LinkRig {
    let mut rig = LinkRig::connected();
    for request in [Request::Upload(Arc::clone(table)), Request::Arm] {
        rig.done(request, 200);
    }
    rig
}

#[test]
fn a_drive_beyond_the_peak_travel_is_refused_with_the_levels_that_are_allowed_and_makes_no_sound() {
    let mut rig = Rig::armed_with(&on_the_wire());
    assert_eq!(in_force(&mut rig), None, "a session begins without");
    assert_eq!(rig.send(&set(Some(COIL))), Event::TravelLimit(TravelSetting { limit: Some(COIL) }));
    // At 50 Hz the travel is Q times the static one: 16 times the peak travel, and the thousandth for rounding.
    let loud = rig.refused(&Command::Drive(drive(&[(0, 0.4, 1.0)], SHORTEST)));
    let Refusal::Travel { travel_per_mille, allowed_per_mille } = loud else { panic!("{loud:?}") };
    assert!((16_000..16_050).contains(&travel_per_mille) && allowed_per_mille == 62, "{loud:?}");
    assert_eq!(rig.status().state, State::Armed);
    assert_eq!(
        loud.to_string(),
        "the tones would move the actuator by 1601.7 % of its peak travel; lower their levels to 6.2 % of what they are, \
         or less"
    );
    rig.play(&[(0, 0.4, 0.062)], SHORTEST, 200);
    assert_eq!(rig.status().state, State::Driving);
    // Two such tones would be too much together.
    let both = rig.refused(&Command::Drive(drive(&[(0, 0.4, 0.062), (1, 0.41, 0.062)], SHORTEST)));
    assert!(matches!(both, Refusal::Travel { .. }), "{both:?}");
}

#[test]
fn a_device_without_a_limit_drives_as_before_and_says_that_it_has_none() {
    let mut rig = Rig::armed_with(&on_the_wire());
    rig.accepted(&Command::Drive(drive(&[(0, 0.4, 1.0)], 2000)));
    assert_eq!(in_force(&mut rig), None);
}

#[test]
fn a_glide_that_the_actuator_cannot_follow_is_refused_with_the_shortest() {
    let mut rig = Rig::armed_with(&on_the_wire());
    rig.send(&set(Some(COIL)));
    assert_eq!(
        rig.refused(&Command::Drive(drive(&[(0, 0.9, 0.01)], SHORTEST - 1))),
        Refusal::OutOfRange {
            field: Field::Glide,
            min: SHORTEST.into(),
            max: 4_000_000,
            got: i64::from(SHORTEST) - 1
        }
    );
    assert_eq!(Timing::at(RATE_HZ).shortest_glide(&COIL), SHORTEST);
}

#[test]
fn a_limit_is_changed_only_while_nothing_sounds_and_a_bad_one_changes_nothing() {
    let mut rig = Rig::armed_with(&on_the_wire());
    rig.send(&set(Some(COIL)));
    let bad = TravelLimit { quality_per_mille: 0, ..COIL };
    assert_eq!(
        rig.refused(&set(Some(bad))),
        Refusal::OutOfRange { field: Field::Quality, min: 100, max: 1_000_000, got: 0 }
    );
    assert_eq!(in_force(&mut rig), Some(COIL));
    rig.play(&[(0, 0.9, 0.01)], SHORTEST, 10);
    assert_eq!(rig.refused(&set(None)), Refusal::Busy(Busy::DriveActive));
    assert_eq!(in_force(&mut rig), Some(COIL));
    rig.accepted(&Command::Stop);
    rig.live_ms(100);
    assert_eq!(rig.send(&set(None)), Event::TravelLimit(TravelSetting::default()));
}

#[test]
fn a_table_that_comes_after_the_limit_is_judged_by_it_and_so_is_one_that_came_before() {
    for limit_first in [true, false] {
        let mut rig = Rig::greeted();
        if limit_first {
            rig.send(&set(Some(COIL)));
        }
        rig.stage(&on_the_wire());
        if !limit_first {
            rig.send(&set(Some(COIL)));
        }
        rig.accepted(&Command::TableCommit);
        rig.live_blocks(2);
        rig.arm();
        // A glide across the resonance, from one harmless place to another.
        rig.play(&[(0, 1.0, 0.5)], SHORTEST, 100);
        let across = rig.refused(&Command::Drive(drive(&[(0, 0.0, 0.2)], 10 * SHORTEST)));
        assert!(matches!(across, Refusal::Travel { allowed_per_mille: 0, .. }), "{limit_first}: {across:?}");
        rig.accepted(&Command::Drive(drive(&[(0, 0.9, 0.5)], SHORTEST)));
    }
}

#[test]
fn a_table_that_would_take_a_sounding_tone_to_the_resonance_is_refused_and_the_one_in_force_stays() {
    let harmless = Table::line(101, 500.0, 600.0, |_| 1.0);
    let mut rig = Rig::armed_with(&harmless);
    rig.send(&set(Some(COIL)));
    rig.play(&[(0, 0.0, 0.5)], SHORTEST, 100);
    rig.stage(&on_the_wire());
    let refused = rig.refused(&Command::TableCommit);
    assert!(matches!(refused, Refusal::Travel { .. }), "{refused:?}");
    let status = rig.status();
    assert_eq!((status.state, status.table_crc), (State::Driving, harmless.header.crc));
    rig.upload(&Table::line(101, 300.0, 400.0, |_| 1.0));
}

#[test]
fn a_table_is_judged_by_its_own_knots_and_gains_whatever_was_in_its_place_before() {
    let glides = |rig: &mut Rig| {
        rig.play(&[(0, 1.0, 0.5)], SHORTEST, 100);
        rig.play(&[(0, 0.0, 0.5)], SHORTEST, 100);
    };
    let mut rig = Rig::armed_with(&on_the_wire());
    rig.send(&set(Some(COIL)));
    // There are two places: the third table takes that of the first.
    for first_hz in [200.0, 210.0] {
        rig.upload(&Table::line(101, first_hz, 300.0, |_| 1.0));
        glides(&mut rig);
    }
    // Across the resonance, where full scale would be 16 times the peak travel.
    rig.accepted(&Command::Stop);
    rig.live_ms(100);
    rig.upload(&Table::line(101, 10.0, 110.0, |_| 0.12));
    glides(&mut rig);
}

#[test]
fn a_reset_and_a_new_session_leave_no_limit() {
    let mut rig = Rig::armed_with(&on_the_wire());
    rig.send(&set(Some(COIL)));
    rig.hello();
    assert_eq!(in_force(&mut rig), None, "another host's plate is not this one's");
    rig.send(&set(Some(COIL)));
    rig.device.restart(ResetCause::Watchdog);
    rig.hello();
    assert_eq!(in_force(&mut rig), None);
}

#[test]
fn a_host_of_1_0_neither_gets_a_limit_nor_can_ask_for_one() {
    let mut rig = Rig::default();
    rig.hello_as(Version { minor: 0, ..Version::OURS });
    for command in [set(Some(COIL)), Command::TravelLimit] {
        assert_eq!(rig.refused(&command), Refusal::UnknownMessage { id: command.id() });
    }
    rig.upload(&on_the_wire());
    rig.arm();
    rig.accepted(&Command::Drive(drive(&[(0, 0.4, 1.0)], 2000)));
}

#[test]
fn the_link_sets_the_limit_before_the_table_and_makes_its_glides_long_enough() {
    let mut rig = driving(&limited());
    assert_eq!(rig.view().drive.travel_limit, Some(COIL));
    {
        let ports = rig.ports();
        let place =
            |which: fn(&Command) -> bool| ports.commands.iter().position(|(_, command)| which(command));
        let limit = place(|command| *command == set(Some(COIL)));
        assert!(limit.is_some() && limit < place(|command| matches!(command, Command::TableBegin(_))));
    }
    rig.record();
    // The request is 20 ms.
    let began = rig.ask(Request::Play(Sounding::Drive(DriveRequest::at(&[(0.09, 0.3)]))));
    rig.pass_ms(300);
    rig.ask_and_pass(Request::Refresh, 10);
    let Some(Outcome::Done { at }) = rig.outcome(began) else { panic!("{:?}", rig.outcome(began)) };
    let glides: Vec<u32> = rig
        .ports()
        .commands
        .iter()
        .filter_map(|(_, command)| match command {
            Command::Drive(drive) => Some(drive.glide),
            _ => None,
        })
        .collect();
    assert_eq!(glides, [SHORTEST]);
    // The mirror knows what was sent, so it needs no limit of its own.
    let mut replay = Replay::new(RATE_HZ as usize);
    replay.follow(&DeviceHistory::of(rig.view()).expect("a status came"));
    let codes: Vec<u16> = replay.exact_codes(at, 60_000).expect("exact").collect();
    assert!(codes == rig.sent(at, 60_000));
    assert!(codes.iter().any(|&code| code > 2500));

    let loud = rig.ask(Request::Play(Sounding::Drive(DriveRequest::at(&[(0.04, 0.3)]))));
    rig.pass_ms(100);
    let Some(Outcome::Refused(refusal)) = rig.outcome(loud) else { panic!("{:?}", rig.outcome(loud)) };
    assert!(refusal.to_string().contains("of its peak travel"), "{refusal}");
}

#[test]
fn a_plate_without_a_limit_lifts_that_of_the_plate_before() {
    let mut rig = driving(&limited());
    rig.done(Request::Upload(Arc::new(table())), 200);
    assert_eq!(rig.view().drive.travel_limit, None);
    // The knots are the same: neither they nor the existing limit were sent again.
    rig.done(Request::Upload(Arc::new(table())), 200);
    let count = |which: fn(&Command) -> bool| {
        rig.ports().commands.iter().filter(|(_, command)| which(command)).count()
    };
    assert_eq!(count(|command| matches!(command, Command::SetTravelLimit(_))), 2);
}

#[test]
fn after_a_reset_the_limit_is_set_again_although_the_device_has_kept_the_table() {
    let mut rig = driving(&limited());
    for request in [Request::Disarm, Request::Store] {
        rig.ask_and_pass(request, 300);
    }
    rig.ports().device.restart(ResetCause::Watchdog);
    rig.pass_ms(5000);
    assert_eq!(rig.view().link.state, LinkState::Connected);
    assert_eq!(rig.view().drive.travel_limit, None, "the device has forgotten it, and the snapshot says so");
    let table = limited();
    assert!(!rig.view().limits_travel_for(&table));
    rig.ports().commands.clear();
    rig.done(Request::Upload(Arc::clone(&table)), 300);
    assert!(rig.view().limits_travel_for(&table));
    assert!(rig.view().table.confirmed.is_some());
    let is_sent = |(_, command): &(u16, Command)| matches!(command, Command::TableBegin(_));
    assert!(!rig.ports().commands.iter().any(is_sent), "only the limit was sent");
}

#[test]
fn the_user_learns_of_a_device_of_1_0_which_is_driven_without_a_limit() {
    let rig = LinkRig::new();
    rig.ports().rewrite = |event| identified(event, |identity| identity.version.minor = 0);
    let mut rig = rig.connect();
    rig.done(Request::Upload(limited()), 200);
    assert!(!rig.view().can_limit_travel());
    assert_eq!(rig.view().drive.travel_limit, None);
    let warns = |text: &str| {
        rig.view()
            .record
            .log
            .iter()
            .any(|line| line.severity == Severity::Warning && line.text.contains(text))
    };
    assert!(warns("does not limit the actuator's travel"));
    let is_sent = |(_, command): &(u16, Command)| matches!(command, Command::SetTravelLimit(_));
    assert!(!rig.ports().commands.iter().any(is_sent), "nothing newer than the device is sent");
}

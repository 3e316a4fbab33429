//! Faults: hangs, crashes, heat, the longest drive time, and how each is reported.

use slipline_app::safety::thermal::{BODY_S, FULL_SINE, Heat, WARN, WINDING_S};
use slipline_link::simulator::{Options, WATCHDOG_MS};
use slipline_protocol::board::BrownOut;
use slipline_protocol::event::{Event, Fault, Faults, ResetCause, State};
use slipline_protocol::limits::{DEAD_MAN_MS, EMERGENCY_RAMP_MS, MAX_DRIVE_MS, STOP_RAMP_MS};
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::commands::every_command;
use slipline_tests::measure::mean_square;
use slipline_tests::rig::{BLOCK, RATE_HZ, Rig, Table, drive};

#[test]
fn the_watchdog_starves_when_the_link_hangs_and_not_before() {
    // the renderer goes on without the link and takes the drive to silence by itself.
    let mut rig = Rig::driving(&[(0, 0.5, 0.5)], 2000, 5000);
    assert!(!rig.device.is_watchdog_starved());
    rig.device.freeze_link(true);
    rig.record();
    rig.silent_ms(DEAD_MAN_MS + 100);
    assert!(rig.device.is_muted());
    rig.silent_ms(WATCHDOG_MS);
    assert!(rig.device.is_watchdog_starved());

    rig.device.restart(ResetCause::Watchdog);
    assert!(rig.device.is_muted());
    let reply = rig.hello();
    assert!(matches!(reply.event, Event::Hello(identity) if identity.reset == ResetCause::Watchdog));
    assert_eq!(rig.status().first_fault, Some(Fault::Watchdog));
}

#[test]
fn each_task_has_its_own_pulse() {
    // a task whose count another one moves could hang unnoticed.
    let mut rig = Rig::armed();
    let before = rig.device.pulses();
    for _ in 0..10 {
        rig.device.feed(b"x");
    }
    let fed = rig.device.pulses();
    assert_ne!(fed.link, before.link);
    assert_eq!((fed.renderer, fed.safety), (before.renderer, before.safety), "no time has passed");
    rig.device.freeze_link(true);
    rig.silent_ms(100);
    let frozen = rig.device.pulses();
    assert_ne!(frozen.renderer, fed.renderer);
    assert_eq!((frozen.link, frozen.safety), (fed.link, fed.safety), "the thread stands still");
    rig.device.freeze_link(false);
    rig.silent_ms(100);
    assert_ne!(rig.device.pulses().safety, frozen.safety);
}

#[test]
fn a_panic_is_reported_at_the_next_hello_and_the_third_in_a_row_is_safe_mode() {
    //
    let mut rig = Rig::armed();
    for n in 1..=4 {
        rig.device.panic("index out of bounds at bank.rs:7");
        let reply = rig.hello();
        let Event::Hello(identity) = reply.event else { panic!("{reply:?}") };
        assert_eq!(identity.reset, ResetCause::Panic);
        assert_eq!(identity.crash.as_str(), "index out of bounds at bank.rs:7");
        assert!(rig.status().faults.contains(Fault::Crash));
        rig.accepted(&Command::ClearFaults);
        if n < 3 {
            assert_eq!(rig.status().state, State::Idle);
            rig.arm();
        } else {
            assert_eq!(rig.status().state, State::SafeMode);
            assert_eq!(rig.refused(&Command::Arm), Refusal::SafeMode);
            assert_eq!(rig.refused(&Command::Drive(drive(&[], 2000))), Refusal::SafeMode);
        }
    }
    rig.device.restart(ResetCause::PowerOn);
    rig.hello();
    assert_eq!(rig.status().state, State::Idle);
}

#[test]
fn a_cold_coil_at_full_drive_is_folded_back_when_the_two_time_constants_say() {
    // the smallest t with 1.3 (1 - (e^(-t/8) + e^(-t/120)) / 2) >= 0.8.
    let rise = |t: f64| {
        let part = |tau: f32| (-t / f64::from(tau)).exp();
        f64::from(FULL_SINE) * (1.0 - (part(WINDING_S) + part(BODY_S)) / 2.0)
    };
    let want = (0..600_000).map(|i| f64::from(i) / 1e4).find(|&t| rise(t) >= f64::from(WARN)).unwrap();
    let mut rig = Rig::armed();
    let begin = rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
    let mut status = rig.status();
    while status.foldback_per_mille == 1000 {
        rig.live_ms(100);
        rig.record();
        status = rig.status();
        assert!((status.now as f64) < 2.0 * want * f64::from(RATE_HZ));
    }
    let got = (status.now - begin) as f64 / f64::from(RATE_HZ);
    assert!((got / want - 1.0).abs() < 0.05, "{got} s for {want} s");
    // It settles below the limit and goes on sounding, more softly.
    rig.live_ms(60_000);
    rig.record();
    rig.live_ms(100);
    let status = rig.status();
    assert_eq!(status.state, State::Driving);
    assert!((800..1000).contains(&status.heat_per_mille), "{}", status.heat_per_mille);
    let share = mean_square(&rig.recording.codes) / (2047.0 * 2047.0 / 2.0);
    let foldback = f64::from(status.foldback_per_mille) / 1000.0;
    assert!((share.sqrt() / foldback - 1.0).abs() < 0.01, "{share} for {foldback}");
}

/// The coil as the test reckons it, from the codes alone.
struct Coil {
    winding: f64,
    body: f64,
}

impl Coil {
    fn warm(&mut self, codes: &[u16]) -> f64 {
        let power = f64::from(FULL_SINE) * mean_square(codes) / (2047.0 * 2047.0 / 2.0);
        let seconds = codes.len() as f64 / f64::from(RATE_HZ);
        self.winding += (1.0 - (-seconds / f64::from(WINDING_S)).exp()) * (power - self.winding);
        self.body += (1.0 - (-seconds / f64::from(BODY_S)).exp()) * (power - self.body);
        f64::midpoint(self.winding, self.body)
    }
}

#[test]
fn neither_stopping_nor_reconnecting_nor_resetting_gets_more_out_of_a_hot_coil() {
    //
    let mut rig = Rig::armed();
    let mut coil = Coil { winding: 0.0, body: 0.0 };
    let mut hottest: f64 = 0.0;
    let full = Command::Drive(drive(&[(0, 1.0, 1.0)], 2000));
    rig.accepted(&full);
    for _ in 0..40 {
        rig.live_ms(1000);
        hottest = hottest.max(coil.warm(&rig.recording.codes));
        rig.record();
    }
    assert!(hottest > f64::from(WARN), "the test does heat it: {hottest}");
    for round in 0..40u32 {
        // Each round breaks the drive off in another way, and begins again at once.
        match round % 4 {
            0 => {
                rig.accepted(&Command::Stop);
                rig.live_ms(40);
            }
            1 => {
                rig.hello();
                rig.live_ms(40);
                rig.arm();
            }
            2 => {
                rig.accepted(&Command::EmergencyStop);
                rig.live_ms(20);
                rig.accepted(&Command::ClearFaults);
                rig.arm();
            }
            _ => {
                rig.device.restart(ResetCause::Pin);
                rig.record();
                rig.make_ready();
            }
        }
        rig.accepted(&full);
        for _ in 0..10 {
            rig.live_ms(100);
            hottest = hottest.max(coil.warm(&rig.recording.codes));
            rig.record();
        }
    }
    assert!(hottest <= 1.0, "{hottest}");
}

#[test]
fn a_reset_is_taken_as_hot_and_a_rest_of_some_seconds_lifts_it() {
    //
    let mut rig = Rig::greeted_with(Options { heat: Heat::AssumedHot, ..Options::default() });
    rig.silent_ms(10);
    assert!((500..510).contains(&rig.status().foldback_per_mille));
    rig.silent_ms(10_000);
    assert_eq!(rig.status().foldback_per_mille, 1000);
}

/// One tone, at 8 kS/s, so that ten minutes are few blocks.
fn driving_at_8_khz() -> Rig {
    let rate = 8000;
    let mut rig = Rig::greeted_with(Options { sample_rate_hz: rate, ..Options::default() });
    rig.upload(&Table::usual().at_rate(rate));
    rig.arm();
    rig.accepted(&Command::Drive(drive(&[(0, 0.5, 0.5)], 100)));
    rig
}

#[test]
fn an_untouched_drive_ends_after_its_longest_time() {
    //
    let mut rig = driving_at_8_khz();
    rig.live_ms(MAX_DRIVE_MS / 2);
    let again = rig.accepted(&Command::Drive(drive(&[(0, 0.6, 0.5)], 100)));
    rig.live_ms(MAX_DRIVE_MS - 1000);
    assert_eq!(rig.status().state, State::Driving, "a command from the user restarts the time");
    rig.live_ms(2000);
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::DriveTime)));
    let after = status.first_fault_at - again;
    assert!(after >= rig.samples(MAX_DRIVE_MS) && after < rig.samples(MAX_DRIVE_MS) + 16 * BLOCK);
    assert!(rig.device.is_muted());
}

#[test]
fn a_device_that_stays_armed_and_silent_is_not_taken_for_one_that_drives() {
    // A drive without tones fades out and stays armed.
    let mut rig = driving_at_8_khz();
    rig.live_ms(1000);
    rig.accepted(&Command::Drive(drive(&[], 100)));
    rig.live_ms(MAX_DRIVE_MS + 1000);
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Armed, None));
}

#[test]
fn an_emergency_stop_behind_a_thousand_frames_is_done_within_a_block() {
    //
    let mut rig = Rig::driving(&[(0, 1.0, 1.0)], 2000, 20);
    let mut bytes = Vec::new();
    for step in 0..1000u32 {
        bytes.extend(rig.frame(&Command::Drive(drive(&[(0, f64::from(step) / 1000.0, 1.0)], 2000))));
    }
    bytes.extend(rig.frame(&Command::EmergencyStop));
    rig.record();
    let sent = rig.device.now();
    rig.device.feed(&bytes);
    rig.silent_ms(10);
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end <= sent + 2 * BLOCK + rig.samples(2), "{}", end - sent);
    rig.collect();
    let stopped = rig
        .replies
        .iter()
        .any(|reply| matches!(reply.event, Event::Accepted(accepted) if accepted.at <= sent + BLOCK));
    assert!(stopped, "{:?}", rig.replies);
    rig.replies.clear();
    assert_eq!(rig.status().first_fault, Some(Fault::EmergencyStop));
}

#[test]
fn both_stops_work_in_every_state() {
    // idle, armed, driving, pending, stopping, amid an upload, in a fault, in safe mode, before any hello.
    type Scene = fn() -> Rig;
    let scenes: [Scene; 8] = [
        Rig::default,
        || Rig::greeted(),
        Rig::armed,
        || {
            let mut rig = Rig::armed();
            rig.accepted(&Command::Drive(drive(&[(0, 0.5, 0.9)], 2000)));
            rig
        },
        || {
            let mut rig = Rig::driving(&[(0, 0.5, 0.9)], 2000, 10);
            rig.accepted(&Command::Stop);
            rig.live_ms(5);
            rig
        },
        || {
            let mut rig = Rig::driving(&[(0, 0.5, 0.9)], 2000, 10);
            rig.accepted(&Command::TableBegin(Table::usual().header));
            rig
        },
        || {
            let mut rig = Rig::armed();
            rig.accepted(&Command::EmergencyStop);
            rig
        },
        || {
            let mut rig = Rig::armed();
            for _ in 0..3 {
                rig.device.panic("again");
            }
            rig.hello();
            rig
        },
    ];
    for (number, scene) in scenes.into_iter().enumerate() {
        for command in [Command::Stop, Command::EmergencyStop] {
            let mut rig = scene();
            rig.record();
            let sent = rig.device.now();
            let at = rig.accepted(&command);
            assert!(at <= sent + BLOCK, "scene {number}");
            rig.live_ms(60);
            let end = rig.recording.end_of_sound().unwrap_or(sent);
            let is_emergency = command == Command::EmergencyStop;
            let ramp_ms = if is_emergency { EMERGENCY_RAMP_MS } else { STOP_RAMP_MS };
            assert!(
                end <= sent + rig.samples(ramp_ms) + 2 * BLOCK,
                "scene {number}, {command:?}: {}",
                end - sent
            );
            assert!(rig.device.is_muted() || !is_emergency, "scene {number}");
        }
    }
}

#[test]
fn every_fault_has_its_own_text() {
    //
    let texts: Vec<&str> = Fault::ALL.iter().map(|fault| fault.text()).collect();
    for (i, text) in texts.iter().enumerate() {
        assert!(!text.is_empty());
        assert_eq!(texts.iter().position(|other| other == text), Some(i));
        assert_eq!(Fault::ALL[i] as usize, i, "the bit is the place");
    }
}

#[test]
fn in_a_fault_the_device_answers_and_clears_but_does_not_drive() {
    // the command matrix of the safe state.
    for command in every_command() {
        let mut rig = Rig::armed();
        rig.accepted(&Command::EmergencyStop);
        rig.live_ms(20);
        if matches!(command, Command::Hello(_)) {
            assert!(matches!(rig.hello().event, Event::Hello(_)));
            continue;
        }
        let faults = Faults::NONE.with(Fault::EmergencyStop);
        let event = rig.send(&command);
        let expected = match command {
            Command::Arm
            | Command::ArmFor(_)
            | Command::Bench(_)
            | Command::Stall
            | Command::FaultOrder(_)
            | Command::Drive(_)
            | Command::Chord(_)
            | Command::Comb(_) => event == Event::Refused(Refusal::Faulted { faults }),
            Command::KeepAlive(_) | Command::Status => {
                matches!(&event, Event::Status(status) if status.state == State::Fault && status.faults == faults)
            }
            Command::SetTravelLimit(_) | Command::TravelLimit => matches!(event, Event::TravelLimit(_)),
            Command::TableDigest => matches!(event, Event::Table(_)),
            Command::DigestRead => event == Event::Refused(Refusal::NoDigest),
            Command::TableChunk(_) | Command::TableCommit => event == Event::Refused(Refusal::NoUpload),
            Command::FaultToken => matches!(event, Event::FaultTrial(_)),
            Command::BootloaderToken => matches!(event, Event::BootloaderToken(_)),
            Command::BootloaderEnter(_) => event == Event::Refused(Refusal::BadToken),
            Command::Hello(_)
            | Command::Disarm
            | Command::Stop
            | Command::EmergencyStop
            | Command::ClearFaults
            | Command::TableBegin(_)
            | Command::TableAbort
            | Command::DigestStart(_)
            | Command::ListenStop
            | Command::CaptureStop
            | Command::Store
            | Command::Forget => matches!(event, Event::Accepted(_) | Event::Unchanged(_)),
            Command::Maintenance => matches!(event, Event::Maintenance(_)),
            Command::Board => matches!(event, Event::Board(_)),
            Command::Profile => matches!(event, Event::Profile(_)),
            Command::Wear => matches!(event, Event::Wear(_)),
            Command::Analogue => matches!(event, Event::Analogue(_)),
            Command::MutePin(_) => matches!(event, Event::MutePin(_)),
            Command::Clock => matches!(event, Event::Clock(_)),
            // It is high enough.
            Command::BrownOut(_) => matches!(event, Event::BrownOut(BrownOut { restarts: false, .. })),
            Command::WriteProfile(_) => event == Event::Refused(Refusal::HoldButton),
            Command::Trigger => matches!(event, Event::Trigger(_)),
            Command::Inputs => matches!(event, Event::Inputs(_)),
            // It has none.
            Command::Listen(_)
            | Command::ListenRead(_)
            | Command::Capture(_)
            | Command::CaptureRead(_)
            | Command::Hold(_)
            | Command::HoldRead => event == Event::Refused(Refusal::NotSupported),
        };
        assert!(expected, "{command:?}: {event:?}");
        rig.live_ms(20);
        assert!(rig.device.is_muted());
    }
}

#[test]
fn the_first_of_several_faults_stays_the_first_with_its_time() {
    //
    let mut rig = Rig::driving(&[(0, 0.5, 0.9)], 2000, 10);
    rig.device.inject_underrun();
    let dry = rig.device.now();
    rig.live_ms(1);
    rig.accepted(&Command::EmergencyStop);
    rig.live_ms(50);
    let status = rig.status();
    assert_eq!(status.faults, Faults::NONE.with(Fault::Underrun).with(Fault::EmergencyStop));
    assert_eq!(status.first_fault, Some(Fault::Underrun));
    assert!(status.first_fault_at.abs_diff(dry) <= 2 * BLOCK);
    rig.accepted(&Command::ClearFaults);
    assert_eq!(rig.status().faults, Faults::NONE);
}

//! The level hold through the host's link: the request, the state in the snapshot, the journal and the mirror.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::simulator::loopback::Loopback;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_link::{
    Change, DeviceTable, DriveRequest, HoldProgress, HoldRequest, HoldState, HoldToneRequest, ListenRequest,
    Outcome, Request, Sounding, WindowShape,
};
use slipline_tests::rig::{BLOCK, MID, RATE_HZ};

/// The sensor receives half of the drive, and half of that while a finger is on the plate.
#[derive(Clone, Default)]
struct Finger(Arc<AtomicBool>);

impl SimulatedInputs for Finger {
    fn sample(&mut self, codes: &[u16; BLOCK as usize], _: bool, sensed: &mut [[u16; BLOCK as usize]; 2]) {
        let parts = if self.0.load(Ordering::Relaxed) { 4 } else { 2 };
        sensed[0] = codes.map(|code| (MID * (parts - 1) + code) / parts);
    }
}

const LEVEL: f64 = 0.2;
const CODES: f64 = 0.5 * 2047.0 * LEVEL;

fn connected() -> (Loopback, Finger) {
    let finger = Finger::default();
    let options = Options { sample_rate_hz: RATE_HZ, ..Options::default() };
    let device = SimulatedDevice::with_inputs(options, Box::new(finger.clone()));
    let mut loopback = Loopback::connect_to(device).unwrap();
    let knots = (0..65).map(|i| (60e3 - 600.0 * f64::from(i), 1.0));
    let table = DeviceTable::from_knots((0.05, 0.2), f64::from(RATE_HZ), knots, 1e-6).unwrap();
    loopback.perform(Request::Upload(Arc::new(table)), |_| ()).unwrap();
    (loopback, finger)
}

fn hold() -> HoldRequest {
    HoldRequest {
        input: 0,
        time_constant_s: 0.001,
        blocks: 40,
        max_rise_db: 12.0,
        slew_db: 6.02,
        tones: vec![HoldToneRequest { slot: 0, amplitude_codes: CODES }],
    }
}

fn drive() -> Request {
    Request::Play(Sounding::Drive(DriveRequest::at(&[(0.1, LEVEL)])))
}

/// Lets seconds pass.
fn pass(loopback: &mut Loopback, seconds: f64) {
    loopback.pass((seconds * f64::from(RATE_HZ)) as u64, |_| ());
}

#[test]
fn the_snapshot_says_how_the_hold_stands_for_as_long_as_it_is_on() {
    let (mut loopback, finger) = connected();
    assert!(loopback.view().drive.hold.is_none());
    // The hold follows the drive at once: it waits until that is in force.
    let driven = loopback.hand_over(drive());
    let held = loopback.hand_over(Request::Hold(hold()));
    finger.0.store(true, Ordering::Relaxed);
    pass(&mut loopback, 0.6);
    for ticket in [driven, held] {
        assert!(matches!(loopback.view().outcome(ticket), Some(Outcome::Done { .. })));
    }
    let report = loopback.view().drive.hold.clone().unwrap();
    assert!(loopback.view().is_holding() && report.windows > 20, "{report:?}");
    let tone = report.tones[0];
    assert_eq!((tone.slot, tone.state), (0, HoldState::Held));
    assert!((f64::from(tone.correction.0) / 100.0 - 6.02).abs() < 0.1, "{tone:?}");
    assert!((f64::from(tone.amplitude) / 256.0 / CODES - 1.0).abs() < 0.01, "{tone:?}");
    assert!(loopback.view().record.journal.iter().any(|entry| entry.change == Change::Hold));

    // The end, by the host's word and by a drive.
    loopback.perform(Request::Hold(HoldRequest::OFF), |_| ()).unwrap();
    assert!(loopback.view().drive.hold.is_none());
    pass(&mut loopback, 0.1);
    loopback.perform(Request::Hold(hold()), |_| ()).unwrap();
    pass(&mut loopback, 0.3);
    loopback.perform(drive(), |_| ()).unwrap();
    pass(&mut loopback, 0.3);
    assert_eq!(loopback.view().drive.hold.as_ref().map(|report| report.progress), Some(HoldProgress::Ended));
    let asked = loopback.view().link.counters.commands;
    pass(&mut loopback, 1.0);
    // Five keep-alives a second.
    assert!(loopback.view().link.counters.commands - asked <= 6, "it is not asked for any more");
}

#[test]
fn a_hold_replaces_a_window_under_way_and_refuses_a_later_one() {
    let (mut loopback, _) = connected();
    loopback.perform(drive(), |_| ()).unwrap();
    pass(&mut loopback, 0.05);
    let window = ListenRequest { from: None, blocks: 4000, shape: WindowShape::Hann, slots: 1, input: 0 };
    let first = loopback.hand_over(Request::Listen(window));
    pass(&mut loopback, 0.05);
    loopback.perform(Request::Hold(hold()), |_| ()).unwrap();
    assert_eq!(loopback.view().outcome(first), Some(&Outcome::Superseded));
    let refused = loopback.perform(Request::Listen(window), |_| ()).unwrap_err();
    assert_eq!(refused.to_string(), "the level hold measures; end it first");
}

#[test]
fn the_codes_are_unknown_from_a_hold_until_the_next_silence() {
    let (mut loopback, _) = connected();
    let at = loopback.perform(drive(), |_| ()).unwrap();
    pass(&mut loopback, 0.05);
    let mut replay = Replay::new(400_000);
    let mut follow = |loopback: &mut Loopback| {
        loopback.perform(Request::Refresh, |_| ()).unwrap();
        replay.follow(&DeviceHistory::of(loopback.view()).unwrap());
        (replay.exact_since(), replay.exact_codes(at, 1000).is_some())
    };
    assert_eq!(follow(&mut loopback), (Some(128), true));
    loopback.perform(Request::Hold(hold()), |_| ()).unwrap();
    pass(&mut loopback, 0.1);
    assert_eq!(follow(&mut loopback), (None, false));
    loopback.perform(Request::Hold(HoldRequest::OFF), |_| ()).unwrap();
    pass(&mut loopback, 0.3);
    assert_eq!(follow(&mut loopback), (None, false));
    loopback.perform(Request::Stop, |_| ()).unwrap();
    pass(&mut loopback, 0.5);
    let again = loopback.perform(drive(), |_| ()).unwrap();
    pass(&mut loopback, 0.05);
    let (since, _) = follow(&mut loopback);
    assert!(since.is_some_and(|since| since <= again), "{since:?} {again}");
}

#[test]
fn what_does_not_fit_the_devices_units_is_named_with_its_range() {
    let (mut loopback, _) = connected();
    let tone = |amplitude_codes| vec![HoldToneRequest { slot: 3, amplitude_codes }];
    for (request, sentence) in [
        (HoldRequest { time_constant_s: 61.0, ..hold() }, "the time constant (s) is 61; allowed are 0 to 60"),
        (
            HoldRequest { max_rise_db: f64::NAN, ..hold() },
            "the largest rise (dB) is NaN; allowed are 0 to 20",
        ),
        (
            HoldRequest { slew_db: 0.0, ..hold() },
            "the largest change from window to window (dB) is 0; allowed are 0.01 to 60.2",
        ),
        (
            HoldRequest { tones: tone(0.01), ..hold() },
            "tone 4: amplitude to hold (codes) is 0.01; allowed are 0.063 to 2047",
        ),
        (HoldRequest { tones: tone(1.0), ..hold() }, "no tone sounds in slot 3"),
    ] {
        let refused = loopback.perform(Request::Hold(request), |_| ()).unwrap_err();
        assert_eq!(refused.to_string(), sentence);
    }
}

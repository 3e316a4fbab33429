use super::*;
use crate::chord::ChordRequest;
use crate::comb::CombRequest;
use crate::drive::{DriveError, DriveRequest};
use crate::error::LinkError;
use crate::harmonic::HarmonicRequest;
use crate::hold::{HoldRequest, HoldToneRequest};
use crate::listen::{CaptureRequest, Captured, ListenRequest, Listened, WindowShape};
use crate::log::Severity;
use crate::out_of_range::OutOfRange;
use crate::port::Port;
use crate::refusal::Refusal;
use crate::request::Request;
use crate::simulator::loopback::Loopback;
use crate::sounding::Sounding;
use crate::trace::TracedMessage;
use serde::de::DeserializeOwned;
use slipline_protocol::board::{BrownOutOrder, FaultOrder};
use slipline_protocol::command::DigestWindow;
use slipline_protocol::version::Compatibility;
use slipline_protocol::{Command, refusal};
use std::fmt::Debug;
use std::time::Duration;

/// The value after it was sent to another worker.
fn sent<T: Serialize + DeserializeOwned>(value: &T) -> T {
    postcard::from_bytes(&postcard::to_extend(value, Vec::new()).unwrap()).unwrap()
}

/// By their text: not every type can be compared, and the text has every field.
#[track_caller]
fn assert_same<T: Serialize + DeserializeOwned + Debug>(value: &T) {
    assert_eq!(format!("{:?}", sent(value)), format!("{value:?}"));
}

fn table(gain: f64) -> Arc<DeviceTable> {
    let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), gain));
    let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
    Arc::new(table.with_heights(vec![1.0, 0.5, 0.25]).unwrap().with_travel_limit(40.0, 2.0, 3.0).unwrap())
}

fn drive(boundary_m: f64) -> Request {
    Request::Play(DriveRequest::at(&[(boundary_m, 0.3), (0.02, 0.1)]).into())
}

#[test]
fn every_request_arrives_as_it_was_sent() {
    let tones = || vec![HarmonicRequest { harmonic: 200, level: 0.1, phase_turns: 0.25 }];
    let hold_tone = HoldToneRequest { slot: 3, amplitude_codes: 100.5 };
    let requests = [
        Request::Connect(Port::Simulated),
        Request::Connect(Port::Serial("COM3".to_owned())),
        Request::Disconnect,
        Request::Arm,
        Request::ArmFor(Duration::from_millis(1500)),
        Request::Disarm,
        drive(0.07),
        Request::Play(Sounding::Chord(ChordRequest::of(12, tones()))),
        Request::Play(Sounding::Comb(CombRequest::of(40, tones()))),
        Request::Listen(ListenRequest {
            from: Some(7),
            blocks: 9,
            shape: WindowShape::Hann,
            slots: 5,
            input: 1,
        }),
        Request::Capture(CaptureRequest { from: None, input: 0, log2_codes: 3, values: 4096 }),
        Request::Hold(HoldRequest { tones: vec![hold_tone], ..HoldRequest::OFF }),
        Request::Stop,
        Request::EmergencyStop,
        Request::ClearFaults,
        Request::Upload(table(1.0)),
        Request::CancelUpload,
        Request::ReadBack,
        Request::Store,
        Request::Forget,
        Request::WriteProfile(Box::new(None)),
        Request::Bootloader,
        Request::Stall,
        Request::BrownOut(BrownOutOrder { is_written: true }),
        Request::FaultToken,
        Request::FaultOrder(FaultOrder { token: 7, ..FaultOrder::default() }),
        Request::Await(Duration::from_secs(1)),
        Request::Refresh,
        Request::AutoReconnect(true),
        Request::Observe,
        Request::Digest(DigestWindow { from: 128, count: 512 }),
        Request::Note(Severity::Warning, "a line".to_owned()),
    ];
    for request in &requests {
        assert_same(request);
    }
}

#[test]
fn every_outcome_arrives_as_it_was_sent() {
    let value = OutOfRange { field: "level".into(), got: 2.0, min: 0.0, max: f64::INFINITY };
    let mut listened = Listened::begun(640, 12);
    listened.answers[3] = Some((0.1, -2.5e-9));
    let refused = [
        Refusal::Device(refusal::Refusal::Malformed),
        Refusal::Link(LinkError::NoSuchPort(Port::Unix("/run/it.sock".into()))),
        Refusal::Link(LinkError::Io("broken".to_owned())),
        Refusal::Incompatible(Compatibility::FlashDevice),
        Refusal::Drive(DriveError::Tone { slot: 2, value }),
        Refusal::TableDiffers,
        Refusal::InputLost { at: 77 },
    ];
    let outcomes = [
        Outcome::Done { at: 5 },
        Outcome::Listened(Arc::new(listened)),
        Outcome::Captured(Arc::new(Captured { from: 1, log2_codes: 2, values: vec![3, 4, 5] })),
        Outcome::DeviceTooOld,
        Outcome::Superseded,
        Outcome::NotConnected,
    ];
    for outcome in outcomes.into_iter().chain(refused.map(Outcome::Refused)) {
        assert_eq!(sent(&outcome), outcome);
    }
}

/// Sends what is new, and checks that the copy has all of the original.
#[track_caller]
fn follow(copy: &mut Snapshot, older: &mut Snapshot, newer: &Snapshot) -> usize {
    let bytes = postcard::to_extend(&SnapshotUpdate::between(older, newer), Vec::new()).unwrap();
    *copy = postcard::from_bytes::<SnapshotUpdate>(&bytes).unwrap().apply(copy);
    *older = newer.clone();
    assert_eq!(format!("{copy:?}"), format!("{newer:?}"));
    bytes.len()
}

#[test]
fn a_copy_follows_the_snapshot_through_a_session() {
    let mut loopback = Loopback::connect(400_000).unwrap();
    let (mut copy, mut older) = (Snapshot::default(), Snapshot::default());
    follow(&mut copy, &mut older, loopback.view());
    loopback.perform(Request::Upload(table(1.0)), |_| ()).unwrap();
    follow(&mut copy, &mut older, loopback.view());
    let confirmed = copy.table.confirmed.clone().unwrap();
    // More than the journal and the outcomes hold.
    for i in 0..200 {
        loopback.perform(drive(0.01 + 1e-4 * f64::from(i)), |_| ()).unwrap();
        let first = copy.record.journal.back().cloned();
        let length = follow(&mut copy, &mut older, loopback.view());
        assert!(length < 1000, "an update of {length} bytes");
        let kept = copy.record.journal.iter().rev().nth(1);
        assert!(
            first.zip(kept).is_some_and(|(first, kept)| Arc::ptr_eq(&first, kept)),
            "the common entries stay"
        );
    }
    assert!(Arc::ptr_eq(copy.table.confirmed.as_ref().unwrap(), &confirmed), "the table is not sent again");
    loopback.perform(Request::Upload(table(0.5)), |_| ()).unwrap();
    follow(&mut copy, &mut older, loopback.view());
    loopback.perform(Request::Disconnect, |_| ()).unwrap();
    follow(&mut copy, &mut older, loopback.view());
    assert_eq!(copy.table.confirmed, None);
}

#[test]
fn a_list_that_has_lost_entries_in_its_middle_is_followed() {
    let frame = |sequence| {
        let message = TracedMessage::Command(Command::Arm);
        Arc::new(TracedFrame { time: Duration::from_micros(u64::from(sequence)), sequence, message })
    };
    let mut original = Snapshot::default();
    let (mut copy, mut older) = (Snapshot::default(), Snapshot::default());
    for sequence in 0..200 {
        let frames = Arc::make_mut(&mut original.record.frames);
        frames.push_back(frame(sequence));
        frames.push_back(frame(sequence));
        if frames.len() > 60 {
            frames.remove(usize::from(sequence) % 50);
            frames.remove(20);
        }
        follow(&mut copy, &mut older, &original);
    }
    Arc::make_mut(&mut original.record.frames).clear();
    follow(&mut copy, &mut older, &original);
}

//! Jobs that a stop, an emergency stop and a disarm drop from the queue.

use super::*;
use crate::chord::ChordRequest;
use crate::comb::CombRequest;
use crate::commands::CommandQueue;
use crate::drive::DriveRequest;
use crate::listen::{Captured, Listened};
use crate::recorder::Recorder;
use crate::request::{Outcome, Request};
use crate::table::DeviceTable;
use slipline_protocol::board::{BrownOutOrder, FaultOrder, MuteStep};
use slipline_protocol::command::{
    Apply, ArmLease, Chord, Comb, DigestWindow, Drive, Hello, KeepAlive, ProfileSetting, TableChunk,
    TableHeader, TravelSetting,
};
use slipline_protocol::hold::HoldSetting;
use slipline_protocol::listen::{CapturePart, CaptureWindow, ListenPart, ListenWindow, WindowShape};
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::version::Version;
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Dropped,
    Kept,
}
use Fate::{Dropped, Kept};

/// The rows of a table: a variant, one of its values, and its fate at a stop, an emergency stop and a disarm.
/// A variant without a row does not compile.
macro_rules! fates {
    ($type:ty: $($variant:pat = $value:expr, $at_stop:expr, $at_emergency_stop:expr, $at_disarm:expr;)+) => {{
        const fn has_a_row(value: &$type) {
            match value {
                $( $variant => (), )+
            }
        }
        let rows: Vec<($type, [Fate; 3])> = vec![$( ($value, [$at_stop, $at_emergency_stop, $at_disarm]), )+];
        let is_of_its_variant = [$( (|value: &$type| matches!(value, $variant)) as fn(&$type) -> bool, )+];
        for ((value, _), is_of_its_variant) in rows.iter().zip(is_of_its_variant) {
            has_a_row(value);
            assert!(is_of_its_variant(value), "{value:?} stands in another variant's row");
        }
        rows
    }};
}

fn jobs() -> Vec<(Job, [Fate; 3])> {
    let table = DeviceTable::from_knots((0.1, 0.2), 400e3, [(40e3, 1.0), (20e3, 1.0)], 1e-6).unwrap();
    let drive = DriveRequest { tones: Vec::new(), master_db: 0.0, glide_s: 0.01, apply: Apply::Next };
    let chord = ChordRequest {
        period_log2: 12,
        tones: Vec::new(),
        master_db: 0.0,
        glide_s: 0.01,
        apply: Apply::Next,
    };
    let comb = CombRequest {
        period_blocks: 128,
        tones: Vec::new(),
        master_db: 0.0,
        glide_s: 0.01,
        apply: Apply::Next,
    };
    let listen = ListenRequest { from: None, blocks: 10, shape: WindowShape::Hann, slots: 1, input: 0 };
    let capture = CaptureRequest { from: None, input: 0, log2_codes: 0, values: 10 };
    let listened =
        Box::new(ListenReading { request: listen, first_slot: 0, listened: Listened::begun(0, 10) });
    let codes = Captured { from: 0, log2_codes: 0, values: Vec::new() };
    let captured = Box::new(CaptureReading { request: capture, captured: codes });
    fates! { Job:
        // Its commands have a table of their own.
        Job::Send(_) = Job::Send(Command::Trigger), Kept, Kept, Kept;
        Job::ArmUnasked = Job::ArmUnasked, Kept, Dropped, Kept;
        Job::Play(Sounding::Drive(_)) = Job::Play(Sounding::Drive(drive)), Dropped, Dropped, Dropped;
        Job::Play(Sounding::Chord(_)) = Job::Play(Sounding::Chord(chord)), Dropped, Dropped, Dropped;
        Job::Play(Sounding::Comb(_)) = Job::Play(Sounding::Comb(comb)), Dropped, Dropped, Dropped;
        Job::Listen(_) = Job::Listen(listen), Kept, Kept, Kept;
        Job::Capture(_) = Job::Capture(capture), Kept, Kept, Kept;
        Job::Hold(_) = Job::Hold(HoldRequest::OFF), Dropped, Dropped, Dropped;
        Job::BeginUpload(_) = Job::BeginUpload(Upload::new(ASKED, Arc::new(table))), Kept, Kept, Kept;
        Job::CancelUpload = Job::CancelUpload, Kept, Kept, Kept;
        Job::DigestRead = Job::DigestRead, Kept, Kept, Kept;
        Job::ListenRead(_) = Job::ListenRead(listened), Kept, Kept, Kept;
        Job::CaptureRead(_) = Job::CaptureRead(captured), Kept, Kept, Kept;
        Job::HoldRead = Job::HoldRead, Kept, Kept, Kept;
        Job::FirstReadBack = Job::FirstReadBack, Kept, Kept, Kept;
    }
}

fn commands() -> Vec<(Command, [Fate; 3])> {
    let (master, glide, apply) = (CentiDecibel(0), 4000, Apply::Next);
    let drive = Drive { tones: heapless::Vec::new(), master, glide, apply };
    let chord = Chord { period_log2: 12, tones: heapless::Vec::new(), master, glide, apply };
    let comb = Comb { period_blocks: 128, tones: heapless::Vec::new(), master, glide, apply };
    let chunk = TableChunk { first: 0, knots: heapless::Vec::new() };
    let listen = ListenWindow { from: None, blocks: 10, shape: WindowShape::Hann, slots: 1, input: None };
    let capture = CaptureWindow { from: None, input: 0, log2_codes: 0, values: 10 };
    let hello = Hello { version: Version::OURS, nonce: [0; 4] };
    let digest = DigestWindow { from: 0, count: 100 };
    let part = ListenPart { input: 0, first_slot: 0 };
    fates! { Command:
        Command::Hello(_) = Command::Hello(hello), Kept, Kept, Kept;
        Command::KeepAlive(_) = Command::KeepAlive(KeepAlive { beat: 1 }), Kept, Kept, Kept;
        Command::Status = Command::Status, Kept, Kept, Kept;
        Command::Maintenance = Command::Maintenance, Kept, Kept, Kept;
        Command::Board = Command::Board, Kept, Kept, Kept;
        Command::Profile = Command::Profile, Kept, Kept, Kept;
        Command::Wear = Command::Wear, Kept, Kept, Kept;
        Command::Analogue = Command::Analogue, Kept, Kept, Kept;
        Command::MutePin(_) = Command::MutePin(MuteStep::default()), Kept, Kept, Kept;
        Command::Clock = Command::Clock, Kept, Kept, Kept;
        Command::Stall = Command::Stall, Kept, Kept, Kept;
        Command::WriteProfile(_) = Command::WriteProfile(ProfileSetting::default()), Kept, Kept, Kept;
        Command::BrownOut(_) = Command::BrownOut(BrownOutOrder { is_written: true }), Kept, Kept, Kept;
        Command::Arm = Command::Arm, Kept, Dropped, Kept;
        Command::ArmFor(_) = Command::ArmFor(ArmLease { lease_ms: 1000 }), Kept, Dropped, Kept;
        Command::Bench(_) = Command::Bench(ArmLease { lease_ms: 1000 }), Kept, Dropped, Kept;
        Command::Disarm = Command::Disarm, Kept, Kept, Kept;
        Command::Drive(_) = Command::Drive(drive), Dropped, Dropped, Dropped;
        Command::Stop = Command::Stop, Kept, Kept, Kept;
        Command::EmergencyStop = Command::EmergencyStop, Kept, Kept, Kept;
        Command::ClearFaults = Command::ClearFaults, Kept, Dropped, Kept;
        Command::SetTravelLimit(_) = Command::SetTravelLimit(TravelSetting::default()), Kept, Kept, Kept;
        Command::TravelLimit = Command::TravelLimit, Kept, Kept, Kept;
        Command::Trigger = Command::Trigger, Kept, Kept, Kept;
        Command::Chord(_) = Command::Chord(chord), Dropped, Dropped, Dropped;
        Command::Comb(_) = Command::Comb(comb), Dropped, Dropped, Dropped;
        Command::TableBegin(_) = Command::TableBegin(TableHeader::default()), Kept, Kept, Kept;
        Command::TableChunk(_) = Command::TableChunk(chunk), Kept, Kept, Kept;
        Command::TableCommit = Command::TableCommit, Kept, Kept, Kept;
        Command::TableAbort = Command::TableAbort, Kept, Kept, Kept;
        Command::TableDigest = Command::TableDigest, Kept, Kept, Kept;
        Command::DigestStart(_) = Command::DigestStart(digest), Kept, Kept, Kept;
        Command::DigestRead = Command::DigestRead, Kept, Kept, Kept;
        Command::Store = Command::Store, Kept, Kept, Kept;
        Command::Forget = Command::Forget, Kept, Kept, Kept;
        Command::BootloaderToken = Command::BootloaderToken, Kept, Kept, Kept;
        Command::BootloaderEnter(_) = Command::BootloaderEnter(0), Kept, Kept, Kept;
        Command::FaultToken = Command::FaultToken, Kept, Kept, Kept;
        Command::FaultOrder(_) = Command::FaultOrder(FaultOrder::default()), Dropped, Dropped, Dropped;
        Command::Inputs = Command::Inputs, Kept, Kept, Kept;
        Command::Listen(_) = Command::Listen(listen), Kept, Kept, Kept;
        Command::ListenRead(_) = Command::ListenRead(part), Kept, Kept, Kept;
        Command::ListenStop = Command::ListenStop, Kept, Kept, Kept;
        Command::Capture(_) = Command::Capture(capture), Kept, Kept, Kept;
        Command::CaptureRead(_) = Command::CaptureRead(CapturePart { first: 0 }), Kept, Kept, Kept;
        Command::CaptureStop = Command::CaptureStop, Kept, Kept, Kept;
        Command::Hold(_) = Command::Hold(HoldSetting::default()), Dropped, Dropped, Dropped;
        Command::HoldRead = Command::HoldRead, Kept, Kept, Kept;
    }
}

/// The ticket of the job that a stop overtakes.
const ASKED: Ticket = Ticket(1);
const STOP: Ticket = Ticket(2);

#[test]
fn every_job_is_dropped_or_kept_at_each_stop_as_the_table_has_it() {
    let sent = commands().into_iter().map(|(command, fates)| (Job::Send(command), fates));
    for (job, fates) in jobs().into_iter().chain(sent) {
        for (stop, fate) in [Request::Stop, Request::EmergencyStop, Request::Disarm].into_iter().zip(fates) {
            let case = format!("{job:?} at {stop:?}");
            let (mut recorder, now) = (Recorder::default(), Duration::ZERO);
            // One job waits; the same job has been sent and is not answered.
            let mut queue = CommandQueue::begin([1; 4], false, None, now);
            queue.tasks.push_back(Task::new(Some(ASKED), job.clone()));
            queue.current = Some(Current::Task(Box::new(Task::new(None, job.clone()))));
            queue.request(STOP, stop, &mut recorder, now);

            let waits = queue.tasks.iter().any(|task| task.ticket == Some(ASKED));
            assert_eq!(if waits { Kept } else { Dropped }, fate, "{case}, waiting");
            let ended = recorder.view.outcome(ASKED);
            assert_eq!(ended, (fate == Dropped).then_some(&Outcome::Superseded), "{case}, its outcome");
            let Some(Current::Task(task)) = &queue.current else {
                panic!("{case}: what was sent is forgotten")
            };
            assert_eq!(task.is_overtaken, fate == Dropped, "{case}, sent");
        }
    }
}

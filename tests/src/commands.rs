//! One of every command.

use slipline_protocol::board::{BrownOutOrder, FaultOrder, MuteStep};
use slipline_protocol::command::{
    ArmLease, DigestWindow, Hello, KeepAlive, ProfileSetting, TableChunk, TravelLimit, TravelSetting,
};
use slipline_protocol::hold::HoldSetting;
use slipline_protocol::listen::{CapturePart, CaptureWindow, ListenPart, ListenWindow, WindowShape};
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Decoder};

use crate::rig::{Table, chord, comb, drive};

/// One of every command, in the order of their ids.
///
/// # Panics
/// If a command has been added to the protocol and not here.
#[must_use]
pub fn every_command() -> Vec<Command> {
    let table = Table::usual();
    let chunk = TableChunk {
        first: 0,
        knots: heapless::Vec::from_slice(&table.knots[..3]).expect("three knots fit a chunk"),
    };
    let limit = TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 2000, static_ppm: 100_000 };
    let commands = vec![
        Command::Hello(Hello { version: Version::OURS, nonce: *b"else" }),
        Command::KeepAlive(KeepAlive { beat: 1_000_000 }),
        Command::Status,
        Command::Maintenance,
        Command::Board,
        Command::Profile,
        Command::Wear,
        Command::Analogue,
        Command::MutePin(MuteStep::default()),
        Command::Clock,
        Command::Stall,
        Command::Arm,
        Command::Disarm,
        Command::Drive(drive(&[(0, 0.1, 0.2), (3, 0.9, 0.3)], 3000)),
        Command::Stop,
        Command::EmergencyStop,
        Command::ClearFaults,
        Command::SetTravelLimit(TravelSetting { limit: Some(limit) }),
        Command::TravelLimit,
        Command::Trigger,
        // 29.3 and 39.1 kHz.
        Command::Chord(chord(12, &[(300, 0.5, 0.0), (400, 0.6, 0.25)])),
        // 3 to 6.2 kHz.
        Command::Comb(comb(128, &[(123, 0.1, 0.0), (254, 0.2, 0.25)])),
        Command::ArmFor(ArmLease { lease_ms: 60_000 }),
        Command::Bench(ArmLease { lease_ms: 60_000 }),
        Command::TableBegin(table.header),
        Command::TableChunk(chunk),
        Command::TableCommit,
        Command::TableAbort,
        Command::TableDigest,
        Command::DigestStart(DigestWindow { from: 1_000_000, count: 100 }),
        Command::DigestRead,
        Command::Store,
        Command::Forget,
        Command::WriteProfile(ProfileSetting::default()),
        Command::BrownOut(BrownOutOrder { is_written: true }),
        Command::BootloaderToken,
        Command::BootloaderEnter(0),
        Command::FaultToken,
        Command::FaultOrder(FaultOrder::default()),
        Command::Inputs,
        Command::Listen(ListenWindow {
            from: None,
            blocks: 10,
            shape: WindowShape::Hann,
            slots: 3,
            input: None,
        }),
        Command::ListenRead(ListenPart { input: 0, first_slot: 0 }),
        Command::ListenStop,
        Command::Capture(CaptureWindow { from: None, input: 0, log2_codes: 2, values: 100 }),
        Command::CaptureRead(CapturePart { first: 0 }),
        Command::CaptureStop,
        Command::Hold(HoldSetting::default()),
        Command::HoldRead,
    ];
    let ids: Vec<u8> = commands.iter().map(Command::id).collect();
    let all: Vec<u8> = Command::TABLE.iter().map(|row| row.id).collect();
    assert_eq!(ids, all, "one of every command");
    commands
}

/// The body in a frame.
///
/// # Panics
/// If these bytes are not one whole frame.
#[must_use]
pub fn body_of(frame: &[u8]) -> Vec<u8> {
    let mut decoder = Decoder::new();
    let bodies: Vec<Vec<u8>> =
        frame.iter().filter_map(|&byte| decoder.push(byte, |frame| frame.body.to_vec())).collect();
    bodies.into_iter().next().expect("a whole frame")
}

//! The codes that a device at 400 kS/s must send, and the results of its lock-ins, by the mirror: for tests
//! that are not written in Rust.
//!
//! `cargo run -p slipline-link --example mirror_codes`
//!
//! Standard input, one line each: first `begin <index>` for a device that is silent there, else at 0;
//! `<index> <frame>` for a command that the device has accepted, where the frame is the command's bytes on
//! the link in hexadecimal and the index that of the device's reply (upload commands before the commit have
//! none: any number); `limit <index> <per mille>` for the thermal limit in a status; last,
//! `play <from> <until>` or `listen <from> <blocks> <shape> <slots> <codes>`.
//!
//! Standard output of `play`: the codes from..until, two bytes each, little-endian. Of `listen`, for a window
//! of whole blocks and the codes sampled by an input in it, written likewise, in hexadecimal (`shape` is 0
//! for a rectangular window, 1 for a Hann window): the weight and the slots without interruption, and for
//! each slot a line with I and Q, 0 if it was interrupted.

#![warn(clippy::wildcard_enum_match_arm)]

use std::io::{self, BufRead, Write};
use std::sync::Arc;

use slipline_app::Stop;
use slipline_app::dds::bank::{BLOCK, TONES};
use slipline_app::dds::lock_in::{InPhaseQuadrature, LockIn, Shape, State, Window};
use slipline_link::mirror::Mirror;
use slipline_protocol::table::Knot;
use slipline_protocol::{Command, Decoder};

const RATE_HZ: u32 = 400_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut mirror = Mirror::new(RATE_HZ, 0);
    let mut knots: Vec<Knot> = Vec::new();
    for line in io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["begin", index] => mirror = Mirror::new(RATE_HZ, index.parse()?),
            ["play", from, until] => return play(&mut mirror, from.parse()?, until.parse()?),
            ["listen", from, blocks, shape, slots, codes] => {
                let shape = if shape == "1" { Shape::Hann } else { Shape::Rectangular };
                let (begin, blocks, slots) = (from.parse()?, blocks.parse()?, slots.parse()?);
                return listen(
                    &mut mirror,
                    Window { begin, blocks, shape, slots, input: None },
                    &bytes(codes),
                );
            }
            ["limit", index, per_mille] => mirror.acknowledge_limit(per_mille.parse()?, index.parse()?)?,
            [index, frame] => {
                let at = index.parse()?;
                match command(frame).ok_or_else(|| format!("no command: {line}"))? {
                    Command::TableBegin(_) => knots.clear(),
                    Command::TableChunk(chunk) => knots.extend_from_slice(&chunk.knots),
                    Command::TableCommit => mirror.acknowledge_table(Arc::from(knots.as_slice()), at)?,
                    Command::Drive(drive) => mirror.acknowledge_play(drive.clone(), at)?,
                    Command::Chord(chord) => mirror.acknowledge_play(chord.clone(), at)?,
                    Command::Comb(comb) => mirror.acknowledge_play(comb.clone(), at)?,
                    Command::Stop | Command::Disarm => mirror.acknowledge_stop(Stop::Normal, at)?,
                    Command::EmergencyStop => mirror.acknowledge_stop(Stop::Emergency, at)?,
                    // They change no code.
                    Command::Hello(_)
                    | Command::KeepAlive(_)
                    | Command::Status
                    | Command::Maintenance
                    | Command::Board
                    | Command::Profile
                    | Command::Wear
                    | Command::Analogue
                    | Command::MutePin(_)
                    | Command::Clock
                    | Command::Stall
                    | Command::WriteProfile(_)
                    | Command::BrownOut(_)
                    | Command::Arm
                    | Command::ArmFor(_)
                    | Command::Bench(_)
                    | Command::ClearFaults
                    | Command::SetTravelLimit(_)
                    | Command::TravelLimit
                    | Command::Trigger
                    | Command::TableAbort
                    | Command::TableDigest
                    | Command::DigestStart(_)
                    | Command::DigestRead
                    | Command::Store
                    | Command::Forget
                    | Command::BootloaderToken
                    | Command::BootloaderEnter(_)
                    | Command::FaultToken
                    | Command::FaultOrder(_)
                    | Command::Inputs
                    | Command::Listen(_)
                    | Command::ListenRead(_)
                    | Command::ListenStop
                    | Command::Capture(_)
                    | Command::CaptureRead(_)
                    | Command::CaptureStop
                    | Command::Hold(_)
                    | Command::HoldRead => {}
                }
            }
            _ => return Err(format!("not understood: {line}").into()),
        }
    }
    Err("nothing to play".into())
}

/// The command in a frame's hexadecimal bytes.
fn command(hexadecimal: &str) -> Option<Command> {
    let mut decoder = Decoder::new();
    bytes(hexadecimal)
        .into_iter()
        .find_map(|byte| decoder.push(byte, |frame| Command::decode(frame.header.id, frame.body).ok()))
        .flatten()
}

fn bytes(hexadecimal: &str) -> Vec<u8> {
    (0..hexadecimal.len() / 2)
        .filter_map(|i| u8::from_str_radix(hexadecimal.get(2 * i..2 * i + 2)?, 16).ok())
        .collect()
}

fn play(mirror: &mut Mirror, from: u64, until: u64) -> Result<(), Box<dyn std::error::Error>> {
    let mut bytes = Vec::new();
    mirror.render(until.next_multiple_of(128), |first, codes| {
        for (index, code) in (first..).zip(codes) {
            if (from..until).contains(&index) {
                bytes.extend_from_slice(&code.to_le_bytes());
            }
        }
    });
    io::stdout().lock().write_all(&bytes)?;
    Ok(())
}

fn listen(mirror: &mut Mirror, window: Window, codes: &[u8]) -> Result<(), Box<dyn std::error::Error>> {
    let codes: Vec<u16> = codes.as_chunks().0.iter().map(|code| u16::from_le_bytes(*code)).collect();
    let mut lock_in = LockIn::<1>::new();
    lock_in.start(window, 0).map_err(|error| format!("{window:?}: {error:?}"))?;
    mirror.render(window.begin, |_, _| ());
    for (index, codes) in (window.begin..).step_by(BLOCK).zip(codes.as_chunks::<BLOCK>().0) {
        mirror.render(index + BLOCK as u64, |_, _| ());
        lock_in.take_block(index, &[*codes], Some(&mirror.played()));
    }
    if lock_in.state() != State::Finished {
        return Err(format!("{} codes are not the window's", codes.len()).into());
    }
    let reading = lock_in.reading();
    println!("{} {}", reading.weight, reading.followed);
    for slot in 0..TONES {
        let InPhaseQuadrature { in_phase, quadrature } = reading.answer(0, slot).unwrap_or_default();
        println!("{in_phase} {quadrature}");
    }
    Ok(())
}

//! The codes a device at 400 kS/s must send, by the mirror: for tests that are not written in Rust.
//!
//! `cargo run -p slipline-link --example mirror_codes`
//!
//! Standard input, one line each: first `begin <index>` for a device that is silent there, else at 0; `<index> <frame>`
//! for a command the device has accepted, where the frame is the command's bytes on the link in hexadecimal and the index
//! the one the device named (upload commands before the commit have none: any number); `limit <index> <per mille>` for
//! the thermal limit that a status tells; last, `play <from> <until>`. Standard output: the codes from..until, two bytes
//! each, little-endian.

use std::io::{self, BufRead, Write};
use std::sync::Arc;

use slipline_app::Stop;
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
            ["limit", index, per_mille] => mirror.acknowledge_limit(per_mille.parse()?, index.parse()?)?,
            [index, frame] => {
                let at = index.parse()?;
                match command(frame).ok_or_else(|| format!("no command: {line}"))? {
                    Command::TableBegin(_) => knots.clear(),
                    Command::TableChunk(chunk) => knots.extend_from_slice(&chunk.knots),
                    Command::TableCommit => mirror.acknowledge_table(Arc::from(knots.as_slice()), at)?,
                    Command::Drive(drive) => mirror.acknowledge_drive(&drive, at)?,
                    Command::Chord(chord) => mirror.acknowledge_chord(&chord, at)?,
                    Command::Comb(comb) => mirror.acknowledge_comb(&comb, at)?,
                    Command::Stop | Command::Disarm => mirror.acknowledge_stop(Stop::Normal, at)?,
                    Command::EmergencyStop => mirror.acknowledge_stop(Stop::Emergency, at)?,
                    _ => {}
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
    (0..hexadecimal.len() / 2)
        .filter_map(|i| u8::from_str_radix(hexadecimal.get(2 * i..2 * i + 2)?, 16).ok())
        .find_map(|byte| decoder.push(byte, |frame| Command::decode(frame.header.id, frame.body).ok()))
        .flatten()
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

//! The fuzz targets and the properties that must hold for every input.
//!
//! Each function is one target: it takes bytes and panics if a property does not hold. The fuzzer's binaries under
//! `fuzz/` call them; a plain `cargo test` replays the inputs under `corpus/` (tests/fuzz_corpora.rs).

use crate::client::Client;
use crate::commands::body_of;
use crate::rig::{BLOCK, MID, Rig, Table, drive};
use slipline_plate::Plate;
use slipline_protocol::command::{Hello, KeepAlive};
use slipline_protocol::event::State;
use slipline_protocol::limits::{DEAD_MAN_MS, DEAD_MAN_RAMP_MS};
use slipline_protocol::version::{Minor, Version};
use slipline_protocol::{Command, Event};

/// Noise on the link of a device that is driving: as long as no frame is whole, nothing changes but the counters, and
/// the noise does not keep the drive alive.
///
/// # Panics
/// If that does not hold.
pub fn rx_bytes(data: &[u8]) {
    let mut rig = Rig::armed();
    rig.accepted(&Command::Drive(drive(&[(0, 0.3, 0.5)], 4000)));
    rig.keep_alive();
    let frames = rig.status().counters.frames;
    for chunk in data.chunks(61) {
        rig.device.feed(chunk);
        rig.silent_blocks(1);
        rig.replies.clear();
    }
    rig.silent_ms(DEAD_MAN_MS + DEAD_MAN_RAMP_MS + 5);
    rig.record();
    rig.silent_blocks(2);
    assert!(rig.recording.codes.iter().all(|&code| code == MID), "noise kept the drive alive");
    rig.device.feed(&[0]);
    let status = rig.status();
    // The last status is a frame itself. If random bytes happened to make a whole frame, the state may be any.
    if status.counters.frames == frames + 1 {
        assert_eq!(status.state, State::Fault);
    }
}

/// One message: its id, then its body. A message that can be decoded is encoded to the same message.
///
/// # Panics
/// If that does not hold.
pub fn decode(data: &[u8]) {
    let Some((&id, body)) = data.split_first() else { return };
    if let Ok(command) = Command::decode(id, body) {
        let again = command.frame_for(Minor::OURS, 0, 0).expect("what was read fits a frame");
        assert_eq!(Command::decode(id, &body_of(&again)), Ok(command));
    }
    if let Ok(event) = Event::decode(id, body) {
        let again = event.frame_for(Minor::OURS, 0, 0).expect("what was read fits a frame");
        assert_eq!(Event::decode(id, &body_of(&again)), Ok(event));
    }
}

/// A session: each step is one byte that chooses the action, then the action's arguments. Afterwards the host sends
/// nothing, and the device must be silent.
///
/// # Panics
/// If a code leaves the DAC's range, if the device does not answer a status, or if it is not silent at the end.
pub fn session(data: &[u8]) {
    let mut rig = Rig::default();
    let table = Table::usual();
    let mut bytes = data.iter().copied();
    let mut beat = 0;
    for _ in 0..200 {
        let Some(step) = bytes.next() else { break };
        let command = match step % 16 {
            0 => {
                rig.silent_blocks(u64::from(bytes.next().unwrap_or(1)) * 8);
                continue;
            }
            1 => {
                let count = usize::from(bytes.next().unwrap_or(0));
                let noise: Vec<u8> = bytes.by_ref().take(count).collect();
                rig.device.feed(&noise);
                rig.replies.clear();
                continue;
            }
            2 => Command::Hello(Hello { version: Version::OURS, nonce: [bytes.next().unwrap_or(0); 4] }),
            3 => {
                beat += u32::from(bytes.next().unwrap_or(1));
                Command::KeepAlive(KeepAlive { beat })
            }
            4 => Command::Arm,
            5 => Command::Disarm,
            6 | 7 => {
                let mut byte = || bytes.next().unwrap_or(0);
                let tones =
                    [(); 3].map(|()| (byte() % 20, f64::from(byte()) / 255.0, f64::from(byte()) / 255.0));
                Command::Drive(drive(&tones[..usize::from(byte() % 4)], u32::from(byte()) * 400))
            }
            8 => Command::Stop,
            9 => Command::EmergencyStop,
            10 => Command::ClearFaults,
            11 => Command::TableBegin(table.header),
            12 => {
                let at = usize::from(bytes.next().unwrap_or(0)) % table.chunks().count();
                table.chunks().nth(at).map(Command::TableChunk).expect("within the table")
            }
            13 => Command::TableCommit,
            14 => Command::Store,
            _ => {
                // A well-framed message of any kind, with any body.
                let id = bytes.next().unwrap_or(0);
                let count = usize::from(bytes.next().unwrap_or(0) % 32);
                let body: Vec<u8> = bytes.by_ref().take(count).collect();
                match Command::decode(id, &body) {
                    Ok(command) => command,
                    Err(_) => continue,
                }
            }
        };
        if matches!(command, Command::Hello(_)) {
            // As every host does: a delimiter first, in case half a frame is in the device's buffer.
            rig.device.feed(&[0]);
            rig.hello();
            beat = 0;
        } else {
            let frame = rig.frame(&command);
            let _ = rig.exchange(&frame);
        }
        rig.silent_blocks(1);
    }
    assert!(rig.recording.codes.iter().all(|&code| code < 4096));
    if rig.device.is_in_bootloader() {
        return;
    }
    rig.silent_ms(DEAD_MAN_MS + DEAD_MAN_RAMP_MS + 5);
    rig.record();
    rig.silent_blocks(4);
    assert!(rig.recording.codes.iter().all(|&code| code == MID), "a silent host leaves a silent device");
    assert!(rig.device.is_muted(), "and a muted one");
    assert_eq!(rig.recording.codes.len() as u64, 4 * BLOCK);
    rig.device.feed(&[0]);
    rig.hello();
    assert!(matches!(rig.status().state, State::Idle | State::Fault | State::SafeMode));
}

/// A plate file: an error or a plate, never a panic; a plate survives being written and read again.
///
/// # Panics
/// If that does not hold.
pub fn load_plate(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(plate) = Plate::from_toml(text) {
        let again = Plate::from_toml(&plate.to_toml()).expect("what was written can be read");
        assert_eq!(again.to_toml(), plate.to_toml());
        let (low, high) = plate.band_hz();
        assert!(low.is_finite() && high.is_finite());
    }
}

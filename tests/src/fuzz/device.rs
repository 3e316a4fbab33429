//! Targets on the device's side of the link: what it receives, and what it reads back from its flash.

use crate::answer;
use crate::client::Client;
use crate::commands::body_of;
use crate::random_actions::{Action, play};
use crate::rig::{BLOCK, MID, Rig, Table, drive};
use slipline_app::ports::FLASH_WORD;
use slipline_link::simulator::{MemoryFlash, Options};
use slipline_protocol::command::{Hello, KeepAlive};
use slipline_protocol::event::{State, StoredConfig};
use slipline_protocol::frame::CRC;
use slipline_protocol::limits::{DEAD_MAN_MS, DEAD_MAN_RAMP_MS, MAX_KNOT_STEP};
use slipline_protocol::table::Knot;
use slipline_protocol::units::Gain;
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

/// A user's drives, tables and stops, each of one byte that chooses it and some more: the device's codes are the mirror's
/// and nothing clips.
///
/// # Panics
/// If that does not hold.
pub fn program(data: &[u8]) {
    let mut bytes = data.iter().copied();
    let block_waits = data.len().is_multiple_of(2);
    let tables = [(); 3].map(|()| any_table(&mut bytes));
    let mut actions = Vec::new();
    while actions.len() < 30 {
        let Some(choice) = bytes.next() else { break };
        let mut byte = || bytes.next().unwrap_or(0);
        let share = |byte: u8| f64::from(byte) / 255.0;
        let action = match choice % 16 {
            0 => Action::Stop,
            1 => Action::EmergencyStop,
            2 => Action::Rest,
            3 | 4 => Action::Table(usize::from(byte() % 3)),
            5..=7 => {
                let period_log2 = 5 + byte() % 12;
                let tones = (0..byte() % 17)
                    .map(|_| (share(byte()) * 1.1, share(byte()), u16::from(byte()) << 8))
                    .collect();
                let glide = 2000 + u32::from(u16::from_le_bytes([byte(), byte()]));
                let ahead = (byte() % 4 == 0).then(|| u64::from(byte()) * 20);
                Action::Chord { period_log2, tones, glide, ahead }
            }
            8 | 9 => {
                let period_blocks = u16::from_le_bytes([byte(), byte() % 64]);
                let tones = (0..byte() % 17)
                    .map(|_| (share(byte()), share(byte()), u16::from(byte()) << 8))
                    .collect();
                let glide = 2000 + u32::from(u16::from_le_bytes([byte(), byte()]));
                let ahead = (byte() % 4 == 0).then(|| u64::from(byte()) * 20);
                Action::Comb { period_blocks, highest: 0.45, tones, glide, ahead }
            }
            _ => {
                let tones = (0..byte() % 6)
                    .map(|_| (byte() % 16, share(byte()), share(byte()), u16::from(byte()) << 8))
                    .collect();
                let glide = 2000 + u32::from(u16::from_le_bytes([byte(), byte()]));
                let ahead = (byte() % 4 == 0).then(|| u64::from(byte()) * 20);
                Action::Drive { tones, master: -i16::from(byte()) * 20, glide, ahead }
            }
        };
        let blocks = 1 + u64::from(byte() % 40);
        actions.push((action, blocks));
    }
    if let Err(fault) = play(&actions, &tables, block_waits) {
        panic!("{fault}");
    }
}

/// A table that the device takes: its frequencies rise or fall, by as much as the bytes say.
fn any_table(bytes: &mut impl Iterator<Item = u8>) -> Table {
    let mut byte = || u32::from(bytes.next().unwrap_or(7));
    let (count, rises) = (2 + byte() % 40, byte() % 2 == 0);
    let most = (MAX_KNOT_STEP - 1) / count / 256;
    let mut step = 1;
    let mut knots: Vec<Knot> = (0..count)
        .map(|_| {
            step += 1 + byte() * most;
            Knot { step, gain: Gain((Gain::FULL.0 / 255 * byte()).max(1)) }
        })
        .collect();
    if !rises {
        knots.reverse();
    }
    Table::of(knots)
}

/// The flash after anything: a kept table, with bytes changed where the data says (slot, place, value; place 0xffff makes
/// the checksums right again). The device starts, reports what it found, and a table that it has taken can be driven.
///
/// # Panics
/// If that does not hold.
pub fn stored(data: &[u8]) {
    let mut flash = kept();
    for patch in data.chunks_exact(4) {
        let slot = &mut flash.slots[usize::from(patch[0] & 1)];
        match u16::from_le_bytes([patch[1], patch[2]]) {
            0xffff => seal(slot),
            // The header's two words and a few knots' are where most fields are.
            place => {
                let end = if patch[0] & 2 == 0 { slot.len() } else { 3 * FLASH_WORD };
                slot[usize::from(place) % end] = patch[3];
            }
        }
    }
    let mut rig = Rig::new(Options { flash, ..Options::default() });
    let reply = rig.hello();
    let Event::Hello(identity) = reply.event else { panic!("{reply:?}") };
    let report = answer!(rig, Command::TableDigest, Table);
    let is_loaded = matches!(identity.stored, StoredConfig::Loaded | StoredConfig::FellBack);
    assert_eq!(is_loaded, report.active.is_some());
    // Its digest is that of the knots in force, so it is one of the two that were kept, whole.
    if let Some(active) = report.active {
        assert!(
            KEPT_KNOTS.contains(&active.knots) && active == kept_table(active.knots).header,
            "{active:?}"
        );
    }
    if rig.status().faults.is_empty() {
        rig.arm();
        if report.active.is_some() {
            rig.send(&Command::Drive(drive(&[(0, 0.3, 1.0), (1, 1.0, 0.2)], 2000)));
        }
        rig.live_ms(20);
    }
    assert!(rig.recording.codes.iter().all(|&code| code < 4096));
    assert_eq!(rig.status().counters.clips, 0);
    // Another table can replace any stored one.
    rig.accepted(&Command::Disarm);
    rig.silent_ms(100);
    rig.accepted(&Command::ClearFaults);
    rig.upload(&Table::usual());
    rig.accepted(&Command::Store);
}

/// The knots of the two tables that are kept.
const KEPT_KNOTS: [u16; 2] = [9, 5];

fn kept_table(knots: u16) -> Table {
    Table::line(knots, 60_000.0, 20_000.0, |u| 0.5 + 0.5 * u)
}

/// A flash in which two tables have been kept, one after the other.
fn kept() -> MemoryFlash {
    static KEPT: std::sync::OnceLock<MemoryFlash> = std::sync::OnceLock::new();
    let make = || {
        let mut rig = Rig::greeted();
        for knots in KEPT_KNOTS {
            rig.upload(&kept_table(knots));
            rig.live_ms(10);
            rig.accepted(&Command::Store);
        }
        rig.device.flash()
    };
    KEPT.get_or_init(make).clone()
}

/// Makes the checksums of a slot's record those of what stands in it (firmware/app/src/store.rs has the layout).
fn seal(slot: &mut [u8]) {
    let knots = usize::from(u16::from_le_bytes([slot[FLASH_WORD + 12], slot[FLASH_WORD + 13]]));
    let end = (FLASH_WORD * (2 + knots.div_ceil(4))).min(slot.len());
    let payload = CRC.checksum(&slot[FLASH_WORD..end]);
    slot[16..20].copy_from_slice(&payload.to_le_bytes());
    let header = CRC.checksum(&slot[..FLASH_WORD - 4]);
    slot[FLASH_WORD - 4..FLASH_WORD].copy_from_slice(&header.to_le_bytes());
}

//! The application as it is compiled for a Cortex-M4, run by an emulator in real time, against the mirror. All else that a chip
//! could change is shown by the flashed images on models of their chips (`tests/board/`).
//!
//! Needs `qemu-system-arm`: `cargo test --test chain -- --ignored qemu::`.

use std::collections::BTreeMap;
use std::sync::Arc;

use slipline_app::BLOCK;
use slipline_link::mirror::Mirror;
use slipline_protocol::command::{Apply, Command, Drive};
use slipline_protocol::units::SampleIndex;
use slipline_tests::client::Client;
use slipline_tests::qemu::{Emulator, Host, Line};
use slipline_tests::rig::{MID, RATE_HZ, Table, drive};

const MILLISECOND: u64 = RATE_HZ as u64 / 1000;
/// What a slow computer may lose between asking for the index and naming one in a command.
const AHEAD: u64 = 300 * MILLISECOND;

/// A device with the usual table, armed, and a mirror of it that has the table.
fn armed(emulator: &Emulator) -> (Host, Mirror) {
    let mut host = emulator.host();
    host.hello();
    let mut mirror = Mirror::new(RATE_HZ, 0);
    let table = Table::usual();
    let at = host.upload(&table);
    mirror.acknowledge_table(Arc::from(table.knots), at).expect("the mirror is at 0");
    let from = host.accepted(&Command::Arm);
    host.keep_alive_if_due();
    host.live_until(from + 10 * MILLISECOND);
    (host, mirror)
}

/// Sends a drive for an index that lies safely ahead, to the device and to the mirror.
fn drive_ahead(host: &mut Host, mirror: &mut Mirror, mut drive: Drive) -> SampleIndex {
    drive.apply = Apply::At(host.status().now + AHEAD);
    let at = host.accepted(&Command::Drive(drive.clone()));
    mirror.acknowledge_play(drive, at).expect("the mirror has not been played so far");
    at
}

/// Sixteen tones all over the plate, as loud as the headroom lets them be.
fn sixteen(shift: f64) -> Drive {
    let tones: Vec<_> = (0..16u8).map(|slot| (slot, (f64::from(slot) + shift) / 17.0, 0.06)).collect();
    drive(&tones, 40 * MILLISECOND as u32)
}

/// The mirror's blocks up to an index, by the index of their first code.
fn played(mirror: &mut Mirror, until: SampleIndex) -> BTreeMap<SampleIndex, [u16; BLOCK]> {
    let mut blocks = BTreeMap::new();
    mirror.render(until, |first, codes| {
        blocks.insert(first, *codes);
    });
    blocks
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn sixteen_gliding_tones_match_the_mirror_bit_for_bit() {
    let mut emulator = Emulator::start(Line::Socket);
    let (mut host, mut mirror) = armed(&emulator);
    let start = drive_ahead(&mut host, &mut mirror, sixteen(0.0));
    // At the index itself the first drive may still be pending, and a second one would be refused.
    host.live_until(start + BLOCK as u64);
    // The drag: every tone moves at once, and the DAC is watched meanwhile: 64 ms before it and as much after it.
    let drag = drive_ahead(&mut host, &mut mirror, sixteen(0.9));
    host.live_until(drag - 64 * MILLISECOND);
    emulator.ask(200);
    emulator.ask(200);
    let shown = emulator.shown(400);
    let end = shown.last().expect("400 blocks").0 + BLOCK as u64;
    assert!(
        shown[0].0 < drag && end > drag + 40 * MILLISECOND,
        "the glide was watched: {} {drag} {end}",
        shown[0].0
    );
    let expected = played(&mut mirror, end);
    for (first, codes) in &shown {
        assert_eq!(
            &expected[first],
            codes,
            "block at {first}, {} after the drag",
            *first as i64 - drag as i64
        );
    }
    assert!(shown.iter().any(|(_, codes)| codes.iter().any(|code| code.abs_diff(MID) > 500)), "it sounds");
}

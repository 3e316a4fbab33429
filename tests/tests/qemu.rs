//! The application as it is compiled for a Cortex-M4, run by an emulator, against the mirror and the limits.
//!
//! Needs `qemu-system-arm`: `cargo test --test chain -- --ignored qemu::`.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use slipline_app::Stop;
use slipline_app::bank::BLOCK;
use slipline_link::mirror::Mirror;
use slipline_link::native::Worker;
use slipline_link::table::DeviceTable;
use slipline_link::{DriveRequest, Outcome, Port, Request, Sounding, ToneRequest};
use slipline_protocol::command::{Apply, Command, DigestWindow, Drive};
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::frame::CRC;
use slipline_protocol::limits::{DEAD_MAN_MS, DEAD_MAN_RAMP_MS, STOP_RAMP_MS};
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
fn the_emulated_board_says_who_it_is() {
    let emulator = Emulator::start(Line::Socket);
    let identity = emulator.host().hello();
    assert_eq!(identity.board.as_str(), "mps2-an386 (emulated)");
    assert_eq!((identity.sample_rate_hz, usize::from(identity.block), identity.tones), (RATE_HZ, BLOCK, 16));
    assert!(identity.simulated);
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn sixteen_gliding_tones_are_the_mirrors_bit_for_bit() {
    let mut emulator = Emulator::start(Line::Socket);
    let (mut host, mut mirror) = armed(&emulator);
    let start = drive_ahead(&mut host, &mut mirror, sixteen(0.0));
    host.live_until(start);
    // The drag: every tone moves at once, and the DAC is watched meanwhile.
    let drag = drive_ahead(&mut host, &mut mirror, sixteen(0.9));
    host.live_until(drag - 20 * MILLISECOND);
    emulator.ask(200);
    let shown = emulator.shown(200);
    host.live_until(drag);
    let end = shown.last().expect("200 blocks").0 + BLOCK as u64;
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

#[test]
#[ignore = "needs qemu-system-arm"]
fn the_digest_of_a_window_is_the_mirrors() {
    let emulator = Emulator::start(Line::Socket);
    let (mut host, mut mirror) = armed(&emulator);
    let start = drive_ahead(&mut host, &mut mirror, sixteen(0.5));
    let window = DigestWindow { from: start + 777, count: 100 * MILLISECOND as u32 };
    host.accepted(&Command::DigestStart(window));
    let end = window.from + u64::from(window.count);
    host.live_until(end + 2 * BLOCK as u64);
    let Event::Digest(digest) = host.send(&Command::DigestRead) else { panic!("a digest should come") };
    let codes: Vec<u8> = played(&mut mirror, end + BLOCK as u64)
        .iter()
        .flat_map(|(first, codes)| (*first..).zip(codes))
        .filter(|(index, _)| (window.from..end).contains(index))
        .flat_map(|(_, code)| code.to_le_bytes())
        .collect();
    assert_eq!(codes.len(), 2 * window.count as usize);
    assert_eq!(digest.crc, Some(CRC.checksum(&codes)));
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn a_stop_is_silent_after_its_ramp() {
    let mut emulator = Emulator::start(Line::Socket);
    let (mut host, mut mirror) = armed(&emulator);
    let start = drive_ahead(&mut host, &mut mirror, sixteen(0.0));
    host.live_until(start + 60 * MILLISECOND);
    emulator.ask(255);
    let at = host.accepted(&Command::Stop);
    mirror.acknowledge_stop(Stop::Normal, at).expect("the mirror has not been played so far");
    let shown = emulator.shown(255);
    let silent = at + u64::from(STOP_RAMP_MS) * MILLISECOND + BLOCK as u64;
    let expected = played(&mut mirror, shown[254].0 + BLOCK as u64);
    for (first, codes) in &shown {
        assert_eq!(&expected[first], codes);
        if *first >= silent {
            assert_eq!(codes, &[MID; BLOCK], "silence from {silent} on, not at {first}");
        }
    }
    assert!(shown[254].0 > silent && shown[0].1 != [MID; BLOCK]);
    assert_eq!(host.status().state, State::Armed);
}

///
#[test]
#[ignore = "needs qemu-system-arm"]
fn a_host_that_dies_is_followed_by_silence() {
    let mut emulator = Emulator::start(Line::Socket);
    let (mut host, mut mirror) = armed(&emulator);
    let start = drive_ahead(&mut host, &mut mirror, sixteen(0.0));
    let last = host.live_until(start).now;
    // As if killed: no stop, no disarm, and the line is gone.
    let session = host.session();
    drop(host);
    let mut onlooker = emulator.onlooker(session);
    let status = onlooker.watch_until(|status| status.state == State::Fault);
    assert_eq!(status.first_fault, Some(Fault::HostLost));
    // The last keep-alive came at most a period before the last look, and the device looks for it every few blocks.
    let after = (status.first_fault_at - last) / MILLISECOND;
    assert!(
        (DEAD_MAN_MS / 2..DEAD_MAN_MS + 100).contains(&u32::try_from(after).unwrap_or(u32::MAX)),
        "{after} ms"
    );
    let silent = status.first_fault_at + u64::from(DEAD_MAN_RAMP_MS) * MILLISECOND + BLOCK as u64;
    // One block is rendered ahead of the one that plays.
    onlooker.watch_until(|status| status.now >= silent + 2 * BLOCK as u64);
    emulator.ask(1);
    let (first, codes) = emulator.shown(1)[0];
    assert!(first >= silent);
    assert_eq!(codes, [MID; BLOCK]);
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn a_host_that_does_not_read_does_not_stop_the_samples() {
    let mut emulator = Emulator::start(Line::Socket);
    let (mut host, mut mirror) = armed(&emulator);
    let start = drive_ahead(&mut host, &mut mirror, sixteen(0.0));
    host.live_until(start);
    // Thousands of replies that nobody takes fill every buffer on the way.
    host.flood_with_questions(2_000);
    emulator.ask(100);
    let shown = emulator.shown(100);
    for pair in shown.windows(2) {
        assert_eq!(pair[1].0, pair[0].0 + BLOCK as u64);
    }
}

/// The production host on a serial port, from hello to disarm.
#[test]
#[ignore = "needs qemu-system-arm"]
fn the_hosts_own_link_drives_it_through_a_serial_port() {
    const REPLY_TIMEOUT: Duration = Duration::from_secs(30);
    let emulator = Emulator::start(Line::Terminal);
    let worker = Worker::spawn(|| {}).expect("a worker starts");
    let done = |request: Request| {
        let outcome = worker.wait(worker.send(request.clone()), REPLY_TIMEOUT);
        match outcome {
            Some(outcome @ (Outcome::Done { .. } | Outcome::Digest(_))) => outcome,
            other => panic!("{request:?}: {other:?}"),
        }
    };
    done(Request::Connect(Port::Serial(emulator.link().display().to_string())));
    let knots = [(60_000.0, 0.5), (40_000.0, 0.8), (20_000.0, 1.0)];
    let table = DeviceTable::from_knots((0.08, 0.27), f64::from(RATE_HZ), knots, 1e-6).expect("a table");
    done(Request::Upload(Arc::new(table)));
    done(Request::Arm);
    let tones = vec![ToneRequest { slot: 0, boundary_m: 0.175, level: 0.5, phase_turns: 0.0 }];
    done(Request::Play(Sounding::Drive(DriveRequest::of(tones))));
    let sum = worker.handle().wait_for(REPLY_TIMEOUT, |snapshot| {
        snapshot.status.as_ref().filter(|s| s.state == State::Driving).map(|s| s.sum_per_mille)
    });
    assert!(sum.is_some(), "it drives");
    done(Request::Stop);
    done(Request::Disconnect);
}

//! The command line, as a process of its own, on an emulated device behind a pseudo-terminal: as a user runs it on a
//! board.
//!
//! Needs `qemu-system-arm`: `cargo test --test chain -- --ignored qemu_cli::`.
#![cfg(unix)]

use std::process::{Child, Command as Process, Output, Stdio};

use serde_json::Value;
use slipline_app::BLOCK;
use slipline_protocol::limits::{DEAD_MAN_MS, DEAD_MAN_RAMP_MS, KEEP_ALIVE_PERIOD_MS, STOP_RAMP_MS};
use slipline_protocol::units::SampleIndex;
use slipline_tests::programs::program;
use slipline_tests::qemu::{Emulator, Line};
use slipline_tests::rig::{MID, RATE_HZ};

const SAMPLES: u64 = BLOCK as u64;

/// `slipline ... --port <port> --json`.
fn slipline(port: &str, arguments: &[&str]) -> Process {
    let mut process = Process::new(program());
    process.args(arguments).args(["--port", port, "--json"]).stdin(Stdio::null());
    process
}

fn run(port: &str, arguments: &[&str]) -> (Output, Value) {
    let output = slipline(port, arguments).output().expect("it runs");
    let value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output, value)
}

const DRIVE: [&str; 9] =
    ["drive", "--plate", "al-sh", "--turning-point", "300mm", "--level", "0.8", "--for", "60s"];

/// A drive that goes on for a minute unless it is ended; it is ended with this value.
struct Driving(Child);

impl Driving {
    /// Returns when the device sounds, with the index of a block that does.
    fn start(emulator: &mut Emulator, port: &str) -> (Self, SampleIndex) {
        let driving = Self(
            slipline(port, &DRIVE).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs"),
        );
        for _ in 0..200_000 {
            emulator.ask(1);
            let (first, codes) = emulator.shown(1)[0];
            // Loud: the glide that begins the drive is over.
            if codes.iter().any(|code| code.abs_diff(MID) > 500) {
                return (driving, first);
            }
        }
        panic!("nothing sounds");
    }
}

impl Drop for Driving {
    fn drop(&mut self) {
        // Both fail only if it has ended already.
        let _ended = self.0.kill().and_then(|()| self.0.wait());
    }
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn info_identifies_the_emulated_board() {
    let emulator = Emulator::start(Line::Terminal);
    let (output, answer) = run(&emulator.link().display().to_string(), &["info"]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(answer["board"], "mps2-an386 (emulated)");
    assert_eq!(answer["sample_rate_hz"], RATE_HZ);
    assert_eq!(answer["state"], "Idle");
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn drive_sounds_for_its_time_and_leaves_silence() {
    let mut emulator = Emulator::start(Line::Terminal);
    let port = emulator.link().display().to_string();
    let mut arguments = DRIVE;
    arguments[8] = "300ms";
    let (output, answer) = run(&port, &arguments);
    assert!(output.status.success(), "{output:?}");
    let (from, until) = (&answer["at_samples"], &answer["stopped_at_samples"]);
    assert!(until.as_u64() > from.as_u64(), "{answer}");
    assert_eq!(answer["clipped_samples"], 0);
    let silent =
        until.as_u64().expect("an index") + u64::from(STOP_RAMP_MS) * u64::from(RATE_HZ) / 1000 + SAMPLES;
    loop {
        emulator.ask(1);
        let (first, codes) = emulator.shown(1)[0];
        if first >= silent {
            assert_eq!(codes, [MID; BLOCK]);
            return;
        }
    }
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn a_host_that_is_killed_while_it_drives_is_followed_by_silence() {
    // R-20, with a real process and a real signal: SIGKILL leaves it no time to say anything.
    let mut emulator = Emulator::start(Line::Terminal);
    let port = emulator.link().display().to_string();
    let (mut driving, before) = Driving::start(&mut emulator, &port);
    driving.0.kill().expect("it runs until it is killed");
    let status = driving.0.wait().expect("it has ended");
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&status), Some(9));
    // Every code from here on for one and a half seconds of the device's own time.
    let blocks = 3 * u64::from(RATE_HZ) / 2 / SAMPLES;
    let mut shown = Vec::new();
    for asked in (0..blocks).step_by(255) {
        let count = (blocks - asked).min(255) as u8;
        emulator.ask(count);
    }
    shown.extend(emulator.shown(blocks as usize));
    assert!(shown.windows(2).all(|pair| pair[1].0 == pair[0].0 + SAMPLES), "not a block is missing");
    // The largest distance from the middle in each 3.2 ms: many periods of the tone, some tens of kilohertz.
    const STRIDE: usize = 10;
    let distance = |(_, codes): &(u64, [u16; BLOCK])| codes.map(|code| code.abs_diff(MID)).into_iter().max();
    let peaks: Vec<u16> =
        shown.chunks(STRIDE).map(|blocks| blocks.iter().filter_map(distance).max().unwrap_or(0)).collect();
    // The glide that begins the drive may still be on; it takes 20 ms.
    let steady = peaks[32];
    assert!(steady > 500, "it sounds on after the host has died: {steady}");
    let silent = peaks.iter().rposition(|&peak| peak > 0).expect("it sounds") + 1;
    assert!(silent < peaks.len(), "it falls silent");
    let samples = |ms: u32| u64::from(ms) * u64::from(RATE_HZ) / 1000;
    let after = shown[silent * STRIDE].0 - before;
    // The last sign of life came at most a period before the kill, or lay on the line then.
    let soonest = samples(DEAD_MAN_MS - KEEP_ALIVE_PERIOD_MS - 100);
    let latest = samples(DEAD_MAN_MS + DEAD_MAN_RAMP_MS + 300);
    assert!((soonest..latest).contains(&after), "{after} samples after the kill");
    // The ramp: as long as it should be, and it only falls.
    let begin = peaks.iter().rposition(|&peak| peak + 2 >= steady).expect("it was steady");
    let ramp = &peaks[begin..silent];
    assert!(ramp.windows(2).all(|pair| pair[1] <= pair[0]), "{ramp:?}");
    let (length, want) = ((ramp.len() * STRIDE) as u64 * SAMPLES, samples(DEAD_MAN_RAMP_MS));
    assert!(length > want * 8 / 10 && length < want * 12 / 10, "{length} samples: {ramp:?}");
}

#[test]
#[ignore = "needs qemu-system-arm"]
fn verify_reports_that_the_emulated_codes_match_the_mirror() {
    let emulator = Emulator::start(Line::Terminal);
    let (output, answer) = run(&emulator.link().display().to_string(), &["verify"]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(answer["equal"], true);
    assert_eq!(answer["windows"].as_array().map(Vec::len), Some(4));
}

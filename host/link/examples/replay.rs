//! Replay of a drive's journal: the same DAC codes as the device has sent, bit for bit.
//!
//! `cargo run -p slipline-link --example replay`
//!
//! Link and simulated device run in virtual time, so a second takes some milliseconds.

use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::simulator::loopback::Loopback;
use slipline_link::{Change, DeviceTable, DriveRequest, Played, Request, Sounding};
use std::error::Error;
use std::sync::Arc;

const RATE_HZ: u32 = 400_000;

fn main() -> Result<(), Box<dyn Error>> {
    // Sample 0 is the first element.
    let mut sent: Vec<u16> = Vec::new();
    let mut loopback = Loopback::connect(RATE_HZ)?;
    sent.resize(loopback.samples() as usize, 0);

    let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
    let table = DeviceTable::from_knots((0.0, 0.1), f64::from(RATE_HZ), knots, 1e-6)?;
    loopback.perform(Request::Upload(Arc::new(table)), |codes| sent.extend(codes))?;
    let drive = Request::Play(Sounding::Drive(DriveRequest::at(&[(0.03, 0.4), (0.07, 0.4)])));
    let began = loopback.perform(drive, |codes| sent.extend(codes))?;
    loopback.pass(u64::from(RATE_HZ / 2), |codes| sent.extend(codes));
    // The replay ends at the device's index in the latest status.
    loopback.perform(Request::Refresh, |codes| sent.extend(codes))?;

    for entry in loopback.view().record.journal.iter() {
        let name = match &entry.change {
            Change::Session => "session",
            Change::Armed => "armed",
            Change::Disarmed => "disarmed",
            Change::Play(Played::Drive(_)) => "drive",
            Change::Play(Played::Chord(_)) => "chord",
            Change::Play(Played::Comb(_)) => "comb",
            Change::Hold => "level hold",
            Change::Stop => "stop",
            Change::EmergencyStop => "emergency stop",
            Change::Table(_) => "table",
            Change::Limit(_) => "thermal fold-back",
        };
        println!("sample {:7}: {name}", entry.at);
    }
    let history = DeviceHistory::of(loopback.view()).ok_or("the device has not reported its status")?;
    let mut replay = Replay::new(RATE_HZ as usize);
    replay.follow(&history);
    let count = u32::try_from(history.now - began)? / 128 * 128;
    let replayed = replay.exact_codes(began, count).ok_or("the journal has a gap")?;
    let device = sent.iter().skip(began as usize).copied();
    let differing = replayed.zip(device).filter(|(mirror, device)| mirror != device).count();
    println!("{count} codes from sample {began} on: {differing} differ");
    if differing == 0 { Ok(()) } else { Err("the replay is not the device's".into()) }
}

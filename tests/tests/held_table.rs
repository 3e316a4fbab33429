//! A table that the device holds from before: recognised without being sent, and mirrored.

use slipline_link::DeviceTable;
use slipline_link::mirror::Mirror;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::{Change, DriveRequest, Request, Sounding, ToneRequest};
use slipline_model::field::simulation::table_for;
use slipline_plate::preset;
use std::sync::Arc;

const RATE_HZ: u32 = 400_000;

fn table() -> Arc<DeviceTable> {
    table_for(&preset("membrane").unwrap(), RATE_HZ).unwrap().1
}

fn restarted_with_the_stored_table() -> Loopback {
    let mut before = Loopback::connect(RATE_HZ).unwrap();
    before.perform(Request::Upload(table()), |_| ()).unwrap();
    before.perform(Request::Disarm, |_| ()).unwrap();
    before.perform(Request::Store, |_| ()).unwrap();
    let options = Options { flash: before.flash(), ..Options::default() };
    Loopback::connect_to(SimulatedDevice::new(options)).unwrap()
}

#[test]
fn a_stored_table_is_not_sent_again() {
    let mut chain = restarted_with_the_stored_table();
    let said = chain.view().link.counters.commands;
    chain.perform(Request::Upload(table()), |_| ()).unwrap();
    assert!(chain.view().link.counters.commands <= said + 1, "nothing but a keep-alive");
    assert_eq!(chain.view().table.confirmed.as_ref().map(|known| known.crc()), Some(table().crc()));
    assert!(chain.view().record.journal.iter().any(|entry| matches!(entry.change, Change::Table(_))));
}

#[test]
fn another_table_is_sent() {
    let mut chain = restarted_with_the_stored_table();
    let other = table_for(&preset("al-sh").unwrap(), RATE_HZ).unwrap().1;
    let said = chain.view().link.counters.commands;
    chain.perform(Request::Upload(other.clone()), |_| ()).unwrap();
    assert!(chain.view().link.counters.commands > said + 10);
    assert_eq!(chain.view().table.report.active, Some(other.header()));
}

#[test]
fn the_mirror_follows_a_drive_that_plays_a_stored_table() {
    let mut chain = restarted_with_the_stored_table();
    chain.perform(Request::Upload(table()), |_| ()).unwrap();
    let tones = vec![ToneRequest { slot: 0, boundary_m: 0.2, level: 0.8, phase_turns: 0.0 }];
    chain.perform(Request::Play(Sounding::Drive(DriveRequest::of(tones))), |_| ()).unwrap();
    let mut sent: Vec<u16> = Vec::new();
    chain.pass(20_000, |codes| sent.extend_from_slice(codes));

    let mut journal = chain.view().record.journal.iter();
    let mut mirror = Mirror::new(RATE_HZ, journal.next().unwrap().at);
    for entry in journal {
        match &entry.change {
            Change::Table(table) => mirror.acknowledge_table(table.knots().into(), entry.at).unwrap(),
            Change::Play(played) => mirror.acknowledge_play(played.clone(), entry.at).unwrap(),
            _ => {}
        }
    }
    let from = chain.samples() - sent.len() as u64;
    let mut mirrored: Vec<u16> = Vec::new();
    mirror.render(chain.samples(), |first, codes| {
        if first >= from {
            mirrored.extend_from_slice(codes);
        }
    });
    assert!(mirror.is_true());
    assert_eq!(mirrored, sent);
    assert!(sent.iter().any(|&code| code > 2500));
}

//! Frames that come twice, late, in another order, or from the host of an earlier session.

use proptest::prelude::*;
use slipline_protocol::Command;
use slipline_protocol::command::TableChunk;
use slipline_protocol::event::{Event, State};
use slipline_protocol::refusal::Refusal;
use slipline_tests::client::Client;
use slipline_tests::faulty_link::{FaultyLink, LinkFaults};
use slipline_tests::rig::{Rig, Table, drive};

/// A session from hello to stop, each frame sent through `link`.
fn play(mut link: FaultyLink) -> Rig {
    let mut rig = Rig::greeted();
    let table = Table::usual();
    let mut commands = vec![Command::TableBegin(table.header)];
    commands.extend(table.chunks().map(Command::TableChunk));
    commands.extend([Command::TableCommit, Command::Store, Command::Arm]);
    for command in commands {
        let frame = rig.frame(&command);
        let bytes = link.pass(&frame);
        rig.device.feed(&bytes);
        rig.silent_blocks(8);
    }
    rig.collect();
    rig.record();
    for step in 0..20 {
        let frame = rig.frame(&Command::Drive(drive(&[(0, f64::from(step) / 20.0, 0.5)], 2000)));
        let bytes = link.pass(&frame);
        rig.device.feed(&bytes);
        rig.live_blocks(5);
    }
    rig
}

#[test]
fn a_frame_that_comes_twice_is_done_once_and_answered_twice_alike() {
    //
    let mut once = play(FaultyLink::new(1, LinkFaults::default()));
    let mut twice = play(FaultyLink::new(1, LinkFaults { duplicate: 1.0, ..LinkFaults::default() }));
    assert_eq!(once.recording.codes, twice.recording.codes);
    assert_eq!(once.device.flash(), twice.device.flash(), "the flash is written once");
    let (a, b) = (once.status().counters, twice.status().counters);
    assert_eq!(a.duplicates, 0);
    assert_eq!(b.frames - a.frames, b.duplicates, "each repeated frame is counted");
    assert!(b.duplicates > 30);

    once.collect();
    twice.collect();
    let numbered = |rig: &Rig| -> Vec<_> {
        rig.replies.iter().filter(|reply| !matches!(reply.event, Event::Status(_))).cloned().collect()
    };
    let mut pairs = numbered(&twice);
    pairs.dedup();
    assert_eq!(pairs, numbered(&once), "the cached replies are the first ones");
}

#[test]
fn a_frame_out_of_order_is_refused_with_the_number_the_device_waits_for() {
    //
    let mut rig = Rig::armed();
    let next = rig.sequence() + 1;
    for wrong in [next + 1, next + 7, next.wrapping_sub(2), 0xffff] {
        let frame = rig.frame_as(&Command::Drive(drive(&[(0, 0.5, 0.5)], 2000)), rig.session(), wrong);
        let reply = rig.exchange(&frame).unwrap();
        assert_eq!(reply.event, Event::Refused(Refusal::BadSequence { expected: next }));
        assert_eq!(reply.header.sequence, wrong);
    }
    assert_eq!(rig.status().state, State::Armed);
}

/// Sends a command over a link with faults until it is answered.
fn insist(rig: &mut Rig, link: &mut FaultyLink, back: &mut FaultyLink, command: &Command) -> Event {
    let frame = rig.frame(command);
    let number = rig.sequence();
    for _ in 0..200 {
        let bytes = link.pass(&frame);
        rig.device.feed(&bytes);
        let echoes = link.echoes();
        assert!(echoes.is_empty());
        let mut said = Vec::new();
        rig.device.take(&mut said);
        let received = back.pass(&said);
        let mut decoder = slipline_protocol::Decoder::new();
        // The host listens from a fresh delimiter on: what was cut before must not spoil this.
        let mut answer = None;
        for byte in std::iter::once(0).chain(received) {
            let found = decoder.push(byte, |frame| {
                (frame.header.sequence == number).then(|| Event::decode(frame.header.id, frame.body).unwrap())
            });
            if let Some(Some(event)) = found
                && !matches!(event, Event::Refused(Refusal::BadSequence { .. }) | Event::Status(_))
            {
                answer = Some(event);
            }
        }
        if let Some(event) = answer {
            return event;
        }
        rig.live_blocks(1);
    }
    panic!("{command:?} was never answered");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn an_upload_through_a_link_that_reorders_loses_and_repeats_is_whole_or_not_at_all(seed: u64) {
        //
        let faults = LinkFaults { drop: 0.1, duplicate: 0.2, reorder: 0.3, delay: 0.1, split: 0.1, truncate: 0.05, insert: 0.05, ..LinkFaults::default() };
        let (mut there, mut back) = (FaultyLink::new(seed, faults), FaultyLink::new(!seed, faults));
        let mut rig = Rig::greeted();
        let table = Table::line(150, 50_000.0, 20_000.0, |_| 0.8);
        insist(&mut rig, &mut there, &mut back, &Command::TableBegin(table.header));
        for chunk in table.chunks() {
            let event = insist(&mut rig, &mut there, &mut back, &Command::TableChunk(chunk));
            prop_assert!(matches!(event, Event::Accepted(_)), "{event:?}");
        }
        let event = insist(&mut rig, &mut there, &mut back, &Command::TableCommit);
        prop_assert!(matches!(event, Event::Accepted(_)), "{event:?}");
        // Frames that are still in the link must do no harm either.
        for _ in 0..10 {
            let late = there.pass(&[]);
            rig.device.feed(&late);
        }
        rig.device.feed(&[0]);
        rig.collect();
        prop_assert_eq!(rig.status().table_crc, table.header.crc);
    }
}

#[test]
fn chunks_out_of_order_are_refused_and_the_upload_goes_on() {
    //
    let mut rig = Rig::greeted();
    let table = Table::usual();
    let chunks: Vec<TableChunk> = table.chunks().collect();
    rig.accepted(&Command::TableBegin(table.header));
    rig.accepted(&Command::TableChunk(chunks[0].clone()));
    for wrong in [0, 2, 3] {
        assert_eq!(
            rig.refused(&Command::TableChunk(chunks[wrong].clone())),
            Refusal::ChunkOrder { expected: chunks[1].first }
        );
    }
    for chunk in &chunks[1..] {
        rig.accepted(&Command::TableChunk(chunk.clone()));
    }
    let mut beyond = chunks[0].clone();
    beyond.first = table.header.knots;
    let expected = table.header.knots;
    assert_eq!(rig.refused(&Command::TableChunk(beyond)), Refusal::ChunkOrder { expected });
    rig.accepted(&Command::TableCommit);
    assert_eq!(rig.status().table_crc, table.header.crc);
}

#[test]
fn a_second_host_ends_the_first_ones_session_and_its_sound() {
    //
    let mut rig = Rig::driving(&[(0, 0.5, 0.5)], 2000, 10);
    let (old_session, old_number) = (rig.session(), rig.sequence());
    rig.hello();
    assert_ne!(rig.session(), old_session);
    rig.live_ms(60);
    assert_eq!(rig.status().state, State::Idle);
    assert!(rig.device.is_muted());
    for command in [Command::Arm, Command::Status, Command::Drive(drive(&[(0, 0.5, 0.5)], 2000))] {
        let frame = rig.frame_as(&command, old_session, old_number + 1);
        assert_eq!(rig.exchange(&frame).unwrap().event, Event::Refused(Refusal::StaleSession));
    }
    assert_eq!(rig.status().state, State::Idle);
}

#[test]
fn a_hello_that_comes_twice_is_one_session_and_a_stop_from_an_old_one_still_stops() {
    //
    let mut rig = Rig::armed();
    let session = rig.session();
    rig.play(&[(0, 0.5, 0.5)], 2000, 10);
    rig.hello_as(slipline_protocol::version::Version::OURS);
    assert_eq!(rig.session(), session, "the same nonce is the same session");
    assert_eq!(rig.status().state, State::Driving);
    let stop = rig.frame_as(&Command::Stop, session ^ 0x55, 9);
    assert!(matches!(rig.exchange(&stop).unwrap().event, Event::Accepted(_)));
    rig.live_ms(40);
    assert_eq!(rig.status().state, State::Armed);
}

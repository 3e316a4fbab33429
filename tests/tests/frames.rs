//! Damaged, cut, overlong, foreign and unknown frames: nothing happens but a count.

use proptest::prelude::*;
use slipline_protocol::event::{Event, State};
use slipline_protocol::frame::{Direction, Header, encode};
use slipline_protocol::limits::MAX_BODY;
use slipline_protocol::version::Minor;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::commands::{body_of, every_command};
use slipline_tests::rig::{Rig, drive};

/// A device that sounds two tones.
fn driving() -> Rig {
    let mut rig = Rig::driving(&[(0, 0.3, 0.4), (1, 0.7, 0.5)], 2000, 10);
    rig.record();
    rig
}

/// The codes of a device to which nothing happens.
fn undisturbed(blocks: u64) -> Vec<u16> {
    let mut rig = driving();
    rig.silent_blocks(blocks);
    rig.recording.codes
}

/// A frame with any header and body.
fn raw_frame(session: u32, sequence: u16, id: u8, body: &[u8]) -> Vec<u8> {
    let header = Header { direction: Direction::ToDevice, session, sequence, id };
    encode(header, |buffer| {
        buffer[..body.len()].copy_from_slice(body);
        Ok(body.len())
    })
    .unwrap()
    .to_vec()
}

#[test]
fn a_frame_with_flipped_bits_changes_no_code_and_no_state() {
    //
    let want = undisturbed(40);
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(60));
    let flips = prop::collection::vec((any::<prop::sample::Index>(), 0..8u8), 1..6);
    for command in every_command() {
        // Sessions and numbers that fit: only the damage can save the device.
        runner
            .run(&flips, |flips| {
                let mut rig = driving();
                let before = rig.status();
                let good = rig.frame(&command);
                let end = good.iter().position(|&byte| byte == 0).unwrap();
                let mut bad = good.clone();
                for (at, bit) in flips {
                    bad[at.index(end)] ^= 1 << bit;
                }
                prop_assume!(bad != good);
                prop_assert_eq!(rig.exchange(&bad), None, "a damaged frame is not answered");
                rig.silent_blocks(40);
                prop_assert_eq!(&rig.recording.codes, &want);
                let after = rig.status();
                prop_assert_eq!((after.state, after.faults), (before.state, before.faults));
                prop_assert!(after.counters.crc_errors > before.counters.crc_errors);
                Ok(())
            })
            .unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_stream_cut_into_any_pieces_is_understood_the_same(cuts in prop::collection::vec(1usize..90, 0..40)) {
        //
        let script = |rig: &mut Rig| -> Vec<u8> {
            [
                Command::DigestRead,
                Command::Drive(drive(&[(0, 0.5, 0.5)], 2000)),
                Command::TableDigest,
                Command::BootloaderToken,
                Command::Store,
                Command::ClearFaults,
                Command::TableAbort,
            ]
            .iter()
            .flat_map(|command| rig.frame(command))
            .collect()
        };
        let mut whole = driving();
        let stream = script(&mut whole);
        whole.device.feed(&stream);
        whole.collect();
        whole.silent_blocks(10);

        let mut pieces = driving();
        let stream = script(&mut pieces);
        let mut rest = stream.as_slice();
        for cut in cuts {
            let (piece, left) = rest.split_at(cut.min(rest.len()));
            pieces.device.feed(piece);
            rest = left;
        }
        pieces.device.feed(rest);
        pieces.collect();
        pieces.silent_blocks(10);
        prop_assert_eq!(whole.replies.len(), 7);
        // The sessions differ in their number only if the rigs differ; all else must be equal.
        prop_assert_eq!(&pieces.replies, &whole.replies);
        prop_assert_eq!(&pieces.recording.codes, &whole.recording.codes);
    }

    #[test]
    fn listening_from_the_middle_of_a_frame_loses_that_frame_only(offset in 1usize..60) {
        //
        let mut rig = driving();
        let first = rig.frame(&Command::Status);
        let second = rig.frame(&Command::Status);
        let stream: Vec<u8> = first.iter().chain(&second).copied().collect();
        rig.device.feed(&stream[offset.min(first.len() - 1)..]);
        rig.collect();
        prop_assert_eq!(rig.replies.len(), 1);
    }

    #[test]
    fn bodies_that_are_too_short_or_too_long_do_nothing(extra in 1usize..30, which in 0usize..20) {
        //
        let command = &every_command()[which];
        let mut body = body_of(&command.frame_for(Minor::OURS, 0, 0).unwrap());
        let length = body.len();
        body.resize(MAX_BODY, 0);
        let mut rig = driving();
        let session = if matches!(command, Command::Hello(_)) { 0 } else { rig.session() };
        let mut wrong = vec![body[..(length + extra).min(MAX_BODY)].to_vec()];
        if let Some(shorter) = length.checked_sub(1) {
            wrong.push(body[..shorter].to_vec());
        }
        for body in wrong {
            if body.len() == length {
                continue;
            }
            let before = rig.status();
            let frame = raw_frame(session, rig.sequence() + 1, command.id(), &body);
            let reply = rig.exchange(&frame).map(|reply| reply.event);
            let refused = [
                Some(Event::Refused(Refusal::Malformed)),
                Some(Event::Refused(Refusal::StaleSession)),
                // The number was used up by the refusal before.
                Some(Event::Refused(Refusal::BadSequence { expected: rig.sequence() + 2 })),
            ];
            prop_assert!(refused.contains(&reply), "{reply:?}");
            let after = rig.status();
            prop_assert_eq!((after.state, after.faults), (before.state, before.faults));
        }
    }
}

#[test]
fn every_id_that_is_no_command_is_refused_by_name_and_does_nothing() {
    //
    let known: Vec<u8> = Command::TABLE.iter().map(|row| row.id).collect();
    let mut sequence = 0;
    let mut rig = Rig::greeted();
    for id in 0..=255u8 {
        if known.contains(&id) {
            continue;
        }
        sequence += 1;
        let frame = raw_frame(rig.session(), sequence, id, &[1, 2, 3]);
        let reply = rig.exchange(&frame).unwrap();
        assert_eq!(reply.event, Event::Refused(Refusal::UnknownMessage { id }));
        assert_eq!(rig.status().state, State::Idle);
    }
}

#[test]
fn bytes_without_a_delimiter_are_dropped_and_counted_once() {
    //
    let mut rig = driving();
    for _ in 0..1000 {
        rig.device.feed(&[0x55; 1000]);
    }
    rig.device.feed(&[0]);
    rig.collect();
    assert!(rig.replies.is_empty());
    let status = rig.status();
    assert_eq!((status.counters.overlong, status.state), (1, State::Driving));
}

#[test]
fn the_device_ignores_its_own_echo_modem_probes_and_typing() {
    //
    let mut rig = Rig::default();
    let mut bytes = Vec::new();
    rig.silent_ms(100);
    rig.device.feed(b"AT+CGMI\r\n\0#\0R\0\x1b[A\0+++\0");
    rig.device.take(&mut bytes);
    assert!(bytes.is_empty(), "nothing is said before a hello");

    // A terminal with its echo on sends every reply back.
    rig.hello();
    let status_frame = rig.frame(&Command::Status);
    for _ in 0..100 {
        rig.device.feed(&status_frame);
        let mut said = Vec::new();
        rig.device.take(&mut said);
        assert!(!said.is_empty());
        rig.device.feed(&said);
        let mut again = Vec::new();
        rig.device.take(&mut again);
        assert!(again.is_empty(), "an echo is not answered");
    }
    for character in 0..=255u8 {
        rig.device.feed(&[character, 0]);
    }
    rig.silent_ms(10);
    let status = rig.status();
    assert_eq!((status.state, rig.device.is_in_bootloader()), (State::Idle, false));
}

#[test]
fn no_reply_ever_ends_with_a_full_usb_packet() {
    // The endpoint hands a transfer over only when a packet of less than 64 bytes ends it.
    let mut lengths = Vec::new();
    for length in 0..=96usize {
        let mut rig = Rig::default();
        rig.device.panic(&"x".repeat(length));
        let hello = Command::Hello(slipline_protocol::command::Hello {
            version: slipline_protocol::version::Version::OURS,
            nonce: [1; 4],
        });
        rig.device.feed(&hello.frame_for(Minor::OURS, 0, 0).unwrap());
        let mut sent = Vec::new();
        rig.device.take(&mut sent);
        assert!(!sent.is_empty());
        assert_ne!(sent.len() % 64, 0, "with a crash message of {length} bytes");
        lengths.push(sent.len());
    }
    lengths.dedup();
    assert!(lengths.len() > 64, "the sweep passes a multiple of 64: {lengths:?}");
}

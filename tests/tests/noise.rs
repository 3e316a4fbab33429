//! Noise on the link: no command is taken from it, and it does not feed the dead-man.

use proptest::prelude::*;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_protocol::Command;
use slipline_protocol::command::KeepAlive;
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::limits::{DEAD_MAN_MS, DEAD_MAN_RAMP_MS};
use slipline_tests::client::Client;
use slipline_tests::commands::every_command;
use slipline_tests::faulty_link::{FaultyLink, LinkFaults, Random};
use slipline_tests::rig::{BLOCK, Rig, drive};

fn driving() -> Rig {
    let mut rig = Rig::driving(&[(0, 0.3, 0.9)], 2000, 10);
    rig.keep_alive();
    rig.record();
    rig
}

#[test]
fn endless_random_bytes_neither_change_the_output_nor_feed_the_dead_man() {
    // as fast as full-speed USB carries them, and with frames of no session between them.
    let mut quiet = driving();
    quiet.silent_ms(DEAD_MAN_MS + 2 * DEAD_MAN_RAMP_MS);
    let mut noisy = driving();
    let mut random = Random::new(7);
    while noisy.device.now() < quiet.device.now() {
        let noise: Vec<u8> = (0..320).map(|_| random.bits() as u8).collect();
        noisy.device.feed(&noise);
        if random.happens(0.01) {
            let session = random.bits() as u32;
            let beat = noisy.frame_as(&Command::KeepAlive(KeepAlive { beat: u32::MAX }), session, 0);
            noisy.device.feed(&[&[0], beat.as_slice()].concat());
        }
        noisy.silent_blocks(1);
    }
    assert_eq!(noisy.recording.codes, quiet.recording.codes);
    noisy.device.feed(&[0]);
    noisy.collect();
    noisy.replies.clear();
    let status = noisy.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::HostLost)));
    assert!(status.counters.crc_errors > 100);
}

/// What may arrive, or not.
#[derive(Clone, Debug)]
enum Arrival {
    Bytes(Vec<u8>),
    Command { which: usize, session_fits: bool, number_fits: bool },
    Time(u64),
    Underrun,
}

fn arrival() -> impl Strategy<Value = Arrival> {
    prop_oneof![
        1 => prop::collection::vec(any::<u8>(), 0..300).prop_map(Arrival::Bytes),
        6 => (0..20usize, prop::bool::weighted(0.9), prop::bool::weighted(0.9))
            .prop_map(|(which, session_fits, number_fits)| Arrival::Command { which, session_fits, number_fits }),
        4 => (1..200u64).prop_map(Arrival::Time),
        1 => Just(Arrival::Underrun),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn no_sequence_of_bytes_commands_and_time_breaks_what_must_always_hold(
        arrivals in prop::collection::vec(arrival(), 1..60),
    ) {
        // the session fuzzer's invariants, on every plain test run.
        let mut rig = driving();
        let commands = every_command();
        let mut silent_since = rig.device.now();
        for arrival in arrivals {
            match arrival {
                Arrival::Bytes(bytes) => rig.device.feed(&bytes),
                Arrival::Command { which, session_fits, number_fits } => {
                    let mut frame = vec![0];
                    let command = &commands[which];
                    if session_fits && number_fits {
                        frame.extend(rig.frame(command));
                    } else {
                        let session = rig.session() ^ u32::from(!session_fits);
                        frame.extend(rig.frame_as(command, session, rig.sequence() + 5));
                    }
                    rig.device.feed(&frame);
                    if matches!(command, Command::KeepAlive(_) | Command::Arm) {
                        silent_since = rig.device.now();
                    }
                }
                Arrival::Time(blocks) => rig.silent_blocks(blocks),
                Arrival::Underrun => rig.device.inject_underrun(),
            }
            rig.collect();
        }
        rig.silent_ms(1);
        // The device still answers, speaks of no impossible state, and has not clipped.
        rig.device.feed(&[0]);
        rig.collect();
        rig.replies.clear();
        rig.hello();
        let status = rig.status();
        prop_assert_eq!(status.counters.clips, 0);
        prop_assert!(status.sum_per_mille <= 1000);
        if status.state != State::Fault {
            prop_assert_eq!(status.first_fault, None);
        }
        // Silence comes at the latest when the dead-man says so, and a new session has disarmed at once.
        let due = rig.samples(DEAD_MAN_MS + DEAD_MAN_RAMP_MS) + 4 * BLOCK;
        while rig.device.now() < silent_since + due {
            rig.silent_blocks(100);
        }
        rig.record();
        rig.silent_blocks(10);
        prop_assert_eq!(rig.recording.first_sound(rig.recording.first), None);
        prop_assert!(rig.device.is_muted());
    }
}

/// Sends a command through a noisy line and back, again and again; returns how often it had to be sent.
fn sends_needed(rig: &mut Rig, there: &mut FaultyLink, back: &mut FaultyLink, command: &Command) -> u32 {
    let frame = rig.frame(command);
    for sends in 1..=20 {
        let bytes = there.pass(&frame);
        rig.device.feed(&bytes);
        let mut said = Vec::new();
        rig.device.take(&mut said);
        let received = back.pass(&said);
        let mut decoder = slipline_protocol::Decoder::new();
        let number = rig.sequence();
        let answered = received.iter().any(|&byte| {
            let found = decoder.push(byte, |frame| {
                frame.header.sequence == number && Event::decode(frame.header.id, frame.body).is_ok()
            });
            found == Some(true)
        });
        if answered {
            return sends;
        }
        // What is left of the damaged frame must not spoil the next.
        rig.device.feed(&[0]);
        rig.silent_blocks(1);
    }
    u32::MAX
}

#[test]
fn at_one_wrong_bit_in_ten_thousand_every_command_gets_through_with_the_hosts_retries() {
    //
    let noisy = LinkFaults { flip: 1e-4, ..LinkFaults::default() };
    let (mut there, mut back) = (FaultyLink::new(3, noisy), FaultyLink::new(4, noisy));
    let mut rig = Rig::armed();
    let mut most = 0;
    for step in 0..2000u32 {
        let command = Command::Drive(drive(&[(0, f64::from(step % 100) / 100.0, 0.5)], 2000));
        most = most.max(sends_needed(&mut rig, &mut there, &mut back, &command));
        rig.live_blocks(4);
    }
    let retries = 1 + slipline_protocol::limits::MAX_RETRIES;
    assert!((2..=retries).contains(&most), "sent {most} times");
    assert_eq!(rig.status().state, State::Driving);
}

#[test]
fn at_one_wrong_bit_in_a_hundred_the_output_falls_silent() {
    //
    let noisy = LinkFaults { flip: 1e-2, ..LinkFaults::default() };
    let mut link = FaultyLink::new(5, noisy);
    let mut rig = driving();
    for beat in 0..300u32 {
        let frame = rig.frame(&Command::KeepAlive(KeepAlive { beat: 1000 + beat }));
        let bytes = link.pass(&frame);
        rig.device.feed(&bytes);
        rig.silent_ms(200);
        if rig.device.is_muted() {
            break;
        }
    }
    assert!(rig.device.is_muted());
    rig.device.feed(&[0]);
    rig.collect();
    rig.replies.clear();
    assert_eq!(rig.status().first_fault, Some(Fault::HostLost));
}

#[test]
fn of_a_million_damaged_frames_none_is_taken_for_a_command() {
    // the soak. Every frame carries the right session and the next number, and some flipped bits.
    let mut rig = driving();
    let commands = every_command();
    let frames: Vec<Vec<u8>> =
        commands.iter().map(|command| rig.frame_as(command, rig.session(), rig.sequence() + 1)).collect();
    let before = rig.status();
    let mut random = Random::new(11);
    for number in 0..1_000_000usize {
        let mut frame = frames[number % frames.len()].clone();
        let end = frame.iter().position(|&byte| byte == 0).unwrap_or(1);
        for _ in 0..1 + random.below(4) {
            let at = random.below(end as u64) as usize;
            frame[at] ^= 1 << random.below(8);
        }
        if !frames.contains(&frame) {
            rig.device.feed(&frame);
        }
    }
    rig.collect();
    assert!(rig.replies.is_empty(), "{:?}", rig.replies);
    let after = rig.status();
    assert_eq!((after.state, after.faults, after.now), (before.state, before.faults, before.now));
    assert_eq!(after.counters.frames, before.counters.frames + 1);
}

#[test]
fn an_unfinished_frame_of_one_host_does_not_lose_the_next_hosts_hello() {
    let mut device = SimulatedDevice::new(Options::default());
    device.feed(&[9, 2, 3, 4]);
    let chain = Loopback::connect_to(device).unwrap();
    let view = chain.view();
    assert!(view.is_connected());
    assert_eq!((view.link.counters.retries, view.link.counters.timeouts), (0, 0));
}

//! The loop against ports that misbehave.

use core::cell::RefCell;
use core::convert::Infallible;
use core::future::poll_fn;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use std::boxed::Box;
use std::vec::Vec;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_io_async::{ErrorKind, ErrorType};
use slipline_dds::bank::BLOCK;
use slipline_protocol::command::{Apply, Drive, Hello, TableChunk, TableHeader, Tone};
use slipline_protocol::event::State;
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::table::{self, Knot};
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};
use slipline_protocol::version::{Minor, Version};
use slipline_protocol::{Command, Decoder, Event};

use super::*;
use crate::ports::NoFlash;
use crate::renderer::Renderer;
use crate::timing::TICK_BLOCKS;

const RATE: u32 = 400_000;

struct Nothing;

impl System for Nothing {
    fn has_bootloader(&self) -> bool {
        false
    }

    fn has_trigger_input(&self) -> bool {
        false
    }

    fn is_brown_out_guarded(&self) -> bool {
        true
    }

    fn enter_bootloader(&mut self) {}
}

/// What a read gives.
#[derive(Clone, Copy, PartialEq)]
enum Port {
    Bytes,
    Ended,
    Broken,
}

struct Wire {
    port: Port,
    to_device: Vec<u8>,
    /// What comes after a read has found nothing: while a command is being done.
    meanwhile: Vec<u8>,
    from_device: Vec<u8>,
    /// Bytes a write takes at most; 0 is an error of the port's.
    write_size: usize,
    /// Bytes the host still takes before it stops reading.
    room: usize,
    reads: u32,
    /// Writes that the port has refused.
    refused_writes: u32,
}

struct End<'a>(&'a RefCell<Wire>);

impl ErrorType for End<'_> {
    type Error = ErrorKind;
}

impl Read for End<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        poll_fn(|_| {
            let mut wire = self.0.borrow_mut();
            wire.reads += 1;
            match wire.port {
                Port::Ended => Poll::Ready(Ok(0)),
                Port::Broken => Poll::Ready(Err(ErrorKind::BrokenPipe)),
                Port::Bytes if wire.to_device.is_empty() => {
                    wire.to_device = core::mem::take(&mut wire.meanwhile);
                    Poll::Pending
                }
                Port::Bytes => {
                    let count = buffer.len().min(wire.to_device.len());
                    for (to, from) in buffer.iter_mut().zip(wire.to_device.drain(..count)) {
                        *to = from;
                    }
                    Poll::Ready(Ok(count))
                }
            }
        })
        .await
    }
}

impl Write for End<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        poll_fn(|_| {
            let mut wire = self.0.borrow_mut();
            if wire.write_size == 0 {
                wire.refused_writes += 1;
                assert!(wire.refused_writes < 1000, "the loop does not yield");
                return Poll::Ready(Err(ErrorKind::BrokenPipe));
            }
            let count = bytes.len().min(wire.write_size).min(wire.room);
            if count == 0 {
                return Poll::Pending;
            }
            wire.room -= count;
            wire.from_device.extend_from_slice(&bytes[..count]);
            Poll::Ready(Ok(count))
        })
        .await
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// Runs a link while `play` drives the rest; each call of its argument lets blocks pass.
fn play(wire: &RefCell<Wire>, script: impl FnOnce(&mut dyn FnMut(u64))) {
    let mailbox = Box::new(Mailbox::<NoopRawMutex>::new());
    let mut candidate = Candidate::new();
    let captured = crate::listening::capture::Values::new();
    let mut link =
        Link::new(Device::of_a_test(RATE), Boot::cold(), NoFlash, Nothing, &mut candidate, &captured);

    let mut renderer = Renderer::new(Timing::at(RATE));
    let mut codes = [0; BLOCK];
    let mut running = pin!(link.run(&mailbox, End(wire), End(wire)));
    let mut pass = |blocks: u64| {
        for _ in 0..blocks {
            renderer.render(&mailbox, &mut codes);
            let poll: Poll<Infallible> =
                running.as_mut().poll(&mut Context::from_waker(Waker::noop())).map(|never| never);
            assert!(poll.is_pending());
        }
    };
    script(&mut pass);
}

fn wire() -> RefCell<Wire> {
    RefCell::new(Wire {
        port: Port::Bytes,
        to_device: Vec::new(),
        meanwhile: Vec::new(),
        from_device: Vec::new(),
        write_size: 64,
        room: usize::MAX,
        reads: 0,
        refused_writes: 0,
    })
}

fn say_hello(wire: &RefCell<Wire>) {
    let hello = Command::Hello(Hello { version: Version::OURS, nonce: [1; 4] });
    wire.borrow_mut().to_device.extend_from_slice(&hello.frame_for(Minor::OURS, 0, 0).unwrap());
}

fn replies(wire: &RefCell<Wire>) -> usize {
    let mut decoder = Decoder::new();
    let bytes = core::mem::take(&mut wire.borrow_mut().from_device);
    bytes.iter().filter(|&&byte| decoder.push(byte, |_| ()).is_some()).count()
}

#[test]
fn a_port_that_is_gone_is_tried_again_at_each_tick_and_not_more_often() {
    for gone in [Port::Ended, Port::Broken] {
        let wire = wire();
        play(&wire, |pass| {
            pass(TICK_BLOCKS);
            wire.borrow_mut().port = gone;
            wire.borrow_mut().reads = 0;
            pass(100 * TICK_BLOCKS);
            let reads = wire.borrow().reads;
            assert!((90..=110).contains(&reads), "{reads}");
            wire.borrow_mut().port = Port::Bytes;
            say_hello(&wire);
            pass(2 * TICK_BLOCKS);
            assert_eq!(replies(&wire), 1);
        });
    }
}

#[test]
fn a_reply_goes_out_in_pieces_of_any_size() {
    for size in 1..80 {
        let wire = wire();
        wire.borrow_mut().write_size = size;
        play(&wire, |pass| {
            say_hello(&wire);
            pass(1);
            assert_eq!(replies(&wire), 1, "pieces of {size} bytes");
        });
    }
}

#[test]
fn a_port_that_cannot_be_written_loses_the_reply_and_nothing_else() {
    let wire = wire();
    wire.borrow_mut().write_size = 0;
    play(&wire, |pass| {
        for _ in 0..20 {
            say_hello(&wire);
            pass(1);
        }
        wire.borrow_mut().write_size = 64;
        say_hello(&wire);
        pass(1);
        assert_eq!(replies(&wire), 1);
    });
}

#[test]
fn a_reply_that_was_cut_off_half_way_does_not_spoil_the_next() {
    // 20 ms are 62.5 blocks: once, and many times.
    for (taken, blocks) in (0..60).flat_map(|taken| [(taken, 80), (taken, 1000)]) {
        let wire = wire();
        wire.borrow_mut().room = taken;
        play(&wire, |pass| {
            say_hello(&wire);
            pass(blocks);
            wire.borrow_mut().room = usize::MAX;
            say_hello(&wire);
            pass(1);
            assert_eq!(replies(&wire), 1, "after {taken} bytes and {blocks} blocks");
        });
    }
}

#[test]
fn the_loop_yields_when_only_a_delimiter_is_owed_and_the_port_refuses_it() {
    for taken in 1..60 {
        let wire = wire();
        wire.borrow_mut().room = taken;
        play(&wire, |pass| {
            say_hello(&wire);
            // The reply is dropped after 20 ms, 62.5 blocks.
            pass(80);
            wire.borrow_mut().write_size = 0;
            pass(80);
            say_hello(&wire);
            pass(80);
            let refused = wire.borrow().refused_writes;
            assert!((1..10).contains(&refused), "{refused} writes after {taken} bytes");
            wire.borrow_mut().write_size = 64;
            wire.borrow_mut().room = usize::MAX;
            say_hello(&wire);
            pass(1);
            assert_eq!(replies(&wire), 1, "after {taken} bytes");
        });
    }
}

#[test]
fn a_reply_that_was_cut_off_half_way_takes_no_other_ones_room() {
    for hellos in 1..20 {
        let wire = wire();
        wire.borrow_mut().room = 5;
        play(&wire, |pass| {
            for _ in 0..hellos {
                say_hello(&wire);
                pass(1);
            }
            wire.borrow_mut().room = usize::MAX;
            pass(1);
            assert_eq!(replies(&wire), hellos.min(8), "of {hellos}");
        });
    }
}

/// A host that waits for each answer.
struct Host<'a> {
    wire: &'a RefCell<Wire>,
    session: u32,
    sequence: u16,
}

impl Host<'_> {
    fn frame(&mut self, command: &Command) -> Vec<u8> {
        if command.is_sequenced() {
            self.sequence += 1;
        }
        command.frame_for(Minor::OURS, self.session, self.sequence).unwrap().to_vec()
    }

    fn answers(&mut self) -> Vec<Event> {
        let mut decoder = Decoder::new();
        let bytes = core::mem::take(&mut self.wire.borrow_mut().from_device);
        let take = |byte: &u8| {
            decoder.push(*byte, |frame| {
                self.session = frame.header.session;
                Event::decode(frame.header.id, frame.body).unwrap()
            })
        };
        bytes.iter().filter_map(take).collect()
    }

    fn send(&mut self, pass: &mut dyn FnMut(u64), command: &Command) -> Vec<Event> {
        let frame = self.frame(command);
        self.wire.borrow_mut().to_device.extend(frame);
        pass(8);
        self.answers()
    }
}

#[test]
fn a_stop_is_found_while_a_drive_is_planned() {
    let knots = [200_000_000, 100_000_000].map(|step| Knot { step, gain: Gain::FULL });
    let crc = table::digest(0, 300_000, RATE, 2, |index| knots[usize::from(index)]);
    let header = TableHeader { knots: 2, span_start_um: 0, span_end_um: 300_000, sample_rate_hz: RATE, crc };
    let drive = Command::Drive(Drive {
        tones: [Tone { slot: 0, position: Position(0), level: Level::FULL, phase: Phase(0) }]
            .into_iter()
            .collect(),
        master: CentiDecibel(0),
        glide: Timing::at(RATE).min_glide,
        apply: Apply::Next,
    });
    let wire = wire();
    play(&wire, |pass| {
        let mut host = Host { wire: &wire, session: 0, sequence: 0 };
        host.send(pass, &Command::Hello(Hello { version: Version::OURS, nonce: [1; 4] }));
        for command in [
            Command::TableBegin(header),
            Command::TableChunk(TableChunk { first: 0, knots: knots.into_iter().collect() }),
            Command::TableCommit,
            Command::Arm,
        ] {
            let answers = host.send(pass, &command);
            assert!(matches!(answers[..], [Event::Accepted(_)]), "{command:?}: {answers:?}");
        }
        let stop = host.frame(&Command::Stop);
        wire.borrow_mut().meanwhile = stop;
        let answers = host.send(pass, &drive);
        assert_eq!(answers[0], Event::Refused(Refusal::Busy(Busy::DriveActive)));
        assert!(matches!(answers[1..], [Event::Accepted(_)]), "{answers:?}");
        let status = host.send(pass, &Command::Status);
        assert!(matches!(&status[..], [Event::Status(status)] if status.state == State::Armed), "{status:?}");
    });
}

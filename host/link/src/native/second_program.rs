//! A program at a device that another program has: it is refused as taken, but its stops are executed.

use crate::simulator::realtime::RealtimeLine;
use slipline_protocol::version::Minor;
use slipline_protocol::{Command, Decoder, Direction, Event, Header, Refusal};

/// The frames of such a program since its last answer.
#[derive(Default)]
pub(super) struct SecondProgram {
    decoder: Decoder,
    /// Each frame's header, and the command if it is a stop.
    frames: Vec<(Header, Option<Command>)>,
}

impl SecondProgram {
    /// Takes bytes of the program.
    pub(super) fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let frame = self.decoder.push(byte, |frame| {
                let command = Command::decode(frame.header.id, frame.body).ok();
                (frame.header, command.filter(|it| matches!(it, Command::Stop | Command::EmergencyStop)))
            });
            self.frames.extend(frame.filter(|(header, _)| header.direction == Direction::ToDevice));
        }
    }

    /// Whether a stop is among the frames that are not answered.
    pub(super) fn stops(&self) -> bool {
        self.frames.iter().any(|(_, stop)| stop.is_some())
    }

    /// Answers its frames. A stop is taken from every session, so the device itself answers it; everything else belongs to no
    /// session of the device.
    pub(super) fn answer(&mut self, line: &mut RealtimeLine, answers: &mut Vec<u8>) {
        for (Header { session, sequence, .. }, stop) in self.frames.drain(..) {
            let reply = match stop {
                Some(stop) => stop.frame_for(Minor::FIRST, session, sequence).map(|frame| {
                    // This cuts a frame that the other program may be sending; it sends the frame again.
                    line.exchange(&[&[0], &frame[..]].concat(), answers);
                }),
                None => Event::Refused(Refusal::StaleSession)
                    .frame_for(Minor::FIRST, session, sequence)
                    .map(|frame| answers.extend_from_slice(&frame)),
            };
            // Neither is too long, nor newer than the first minor.
            debug_assert!(reply.is_ok());
        }
    }
}

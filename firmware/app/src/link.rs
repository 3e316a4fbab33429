//! The loop of the thread side: bytes in, bytes out, and a tick every few blocks.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use core::future::{Future, pending, poll_fn, ready};
use core::pin::pin;
use core::task::{Context, Poll};

use embassy_futures::select::{Either4, select4};
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::{Read, Write};

use crate::controller::{Controller, Device};
use crate::inbox::Inbox;
use crate::listening::capture::Values;
use crate::mailbox::Mailbox;
use crate::planning::chord::Candidate;
use crate::ports::{FlashPages, System};
use crate::safety::boot::Boot;
use crate::session::Session;

/// Bytes read at once: a full-speed USB packet.
const PACKET: usize = 64;

/// Session and controller together, on a stream of bytes.
pub struct Link<'a, F, S> {
    inbox: Inbox,
    session: Session,
    controller: Controller<'a, F, S>,
}

impl<'a, F: FlashPages, S: System> Link<'a, F, S> {
    /// A link before the first byte. `candidate` is the memory in which chords are proven, `captured` that of the listener.
    #[must_use]
    pub fn new(
        device: Device,
        boot: Boot,
        flash: F,
        system: S,
        candidate: &'a mut Candidate,
        captured: &'a Values,
    ) -> Self {
        Self {
            inbox: Inbox::new(),
            session: Session::new(),
            controller: Controller::new(device, boot, flash, system, candidate, captured),
        }
    }

    /// Loads the stored table, then receives and answers for ever.
    ///
    /// Each turn of the loop does the first of these that is ready:
    /// 1. the tick;
    /// 2. received bytes, so that a stop takes effect before any command in the queue;
    /// 3. bytes to send;
    /// 4. the first command in the queue.
    ///
    /// A command or a tick that takes long looks for received bytes meanwhile.
    ///
    /// Nothing waits for the host to read. `read` and `write` must lose nothing when their futures are dropped. When
    /// `read` fails or ends, the port is gone: the loop tries it again at the next tick. When `write` fails, the reply
    /// is dropped.
    pub async fn run<M: RawMutex>(
        &mut self,
        mailbox: &Mailbox<M>,
        mut read: impl Read,
        mut write: impl Write,
    ) -> ! {
        let Self { inbox, session, controller } = self;
        controller.start(mailbox);
        let mut packet = [0; PACKET];
        let mut gone = false;
        loop {
            mailbox.pulse_link();
            let bytes = async { if gone { pending().await } else { read.read(&mut packet).await } };
            let room = async {
                match session.unsent() {
                    [] => pending().await,
                    unsent => write.write(unsent).await,
                }
            };
            let work = async { if inbox.has_work() { ready(()).await } else { pending().await } };
            match select4(mailbox.tick(), bytes, room, work).await {
                Either4::First(()) => {
                    let was_gone = core::mem::take(&mut gone);
                    poll_fn(|context| {
                        let stops = inbox.stops();
                        let mut is_stopped = || {
                            receive_now(inbox, &mut read, &mut packet, context, mailbox);
                            // The turn of a level hold makes way for the drive that ends it.
                            inbox.stops() != stops || inbox.has_drive()
                        };
                        // A port that is gone is read once a tick.
                        if !was_gone {
                            is_stopped();
                        }
                        controller.tick(&mut is_stopped, mailbox);
                        Poll::Ready(())
                    })
                    .await;
                    session.expire(mailbox.now(), controller.timing().transmit);
                }
                Either4::Second(Ok(count)) if count > 0 => {
                    let stops = inbox.stops();
                    inbox.receive(packet.get(..count).unwrap_or_default(), mailbox);
                    if inbox.stops() != stops {
                        // A renderer that runs in turn with this loop, not above it, takes the stop before the answer
                        // says where the ramp begins.
                        yield_now().await;
                    }
                }
                Either4::Second(_) => gone = true,
                Either4::Third(Ok(count)) if count > 0 => session.sent(count, mailbox.now()),
                Either4::Third(_) => session.drop_first(mailbox.now()),
                Either4::Fourth(()) => {
                    poll_fn(|context| {
                        let receive = |inbox: &mut Inbox| {
                            receive_now(inbox, &mut read, &mut packet, context, mailbox);
                        };
                        session.step(inbox, receive, controller, mailbox);
                        Poll::Ready(())
                    })
                    .await;
                }
            }
        }
    }
}

/// Gives the inbox what has come already. A port that is gone is noticed by the loop.
fn receive_now<M: RawMutex>(
    inbox: &mut Inbox,
    read: &mut impl Read,
    packet: &mut [u8; PACKET],
    context: &mut Context<'_>,
    mailbox: &Mailbox<M>,
) {
    if let Some(count) = read_now(read, packet, context) {
        inbox.receive(packet.get(..count).unwrap_or_default(), mailbox);
    }
}

/// Bytes that have come already, as a count; none if there are none or the port is gone.
fn read_now(read: &mut impl Read, packet: &mut [u8], context: &mut Context<'_>) -> Option<usize> {
    match pin!(read.read(packet)).poll(context) {
        Poll::Ready(Ok(count @ 1..)) => Some(count),
        _ => None,
    }
}

#[cfg(test)]
mod tests;

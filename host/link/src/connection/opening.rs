//! Opens ports: the one that the user names, the port of a lost device, and a missing port as soon as it appears.

use super::{Connection, Open, Phase, SEEK_PERIOD};
use crate::commands::{CommandQueue, Next};
use crate::error::LinkError;
use crate::log::Severity;
use crate::port::{Port, PortInfo};
use crate::rediscovery::Rediscovery;
use crate::request::{Outcome, Ticket};
use crate::snapshot::LinkState;
use crate::transport::{Opener, Transport as _};
use std::time::Duration;

/// A session shorter than this was probably ended by another program, not by a restart...
const SHORT_LIFE: Duration = Duration::from_secs(5);
/// ...if this many consecutive sessions are that short: two programs that take a device from each other would
/// stop its drive repeatedly.
const SHORT_LIVES: u32 = 3;

impl<O: Opener> Connection<O> {
    /// After a reconnection: checks that it is the same device.
    pub(super) fn verify_identity(&mut self) -> Next {
        let Some(rediscovery) = &mut self.rediscovery else { return Next::Continue };
        let Some(unit) = self.recorder.view.device.identity.as_ref().map(|identity| identity.unit) else {
            return Next::Continue;
        };
        let is_it = rediscovery.is_it(unit, self.recorder.view.link.port.as_ref());
        if is_it { Next::Continue } else { Next::Lose(LinkError::Gone) }
    }

    pub(super) fn lose(&mut self, error: LinkError, now: Duration) {
        if self.entry_deadline().is_some() {
            // It was not yet gone, is only coming back, or another device answers at its port.
            self.shut(&Outcome::NotConnected);
            self.recorder.forget_device(None);
            self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
            return;
        }
        let was_first = self.recorder.view.link.state == LinkState::Connecting;
        let error = match (&self.recorder.view.link.port, error) {
            (Some(port), LinkError::Silent) if was_first || self.waits_for_port => {
                LinkError::NoAnswer(port.clone())
            }
            (_, error) => error,
        };
        let is_leaving = self.leave.is_some() || self.next.is_some();
        let outcome = if was_first { Outcome::Refused(error.clone().into()) } else { Outcome::NotConnected };
        self.shut(&outcome);
        if is_leaving {
            return self.close(now);
        }
        let is_short = error == LinkError::SessionEnded && now < self.opened_at + SHORT_LIFE;
        self.short_lives = if is_short { self.short_lives + 1 } else { 0 };
        let earlier = if let LinkState::Reconnecting(loss) = &self.recorder.view.link.state {
            Some(loss.clone())
        } else {
            None
        };
        let was_seeking = earlier.is_some();
        // For a device that has answered before, its loss remains the reason.
        let reason = earlier.filter(|_| !self.waits_for_port).unwrap_or_else(|| error.clone());
        self.recorder.forget_device(Some(reason));
        if was_first || self.short_lives >= SHORT_LIVES {
            self.recorder.link(LinkState::Disconnected);
        } else if was_seeking {
            // A port that exists but does not answer yet may still be starting.
            self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
            self.still_missing(error);
        } else {
            self.waits_for_port = false;
            self.recorder.log(Severity::Error, format!("Connection lost: {error}."));
            self.recorder.link(LinkState::Lost(error));
        }
    }

    pub(super) fn seek(&mut self, error: LinkError, now: Duration) {
        self.recorder.log(Severity::Info, "Looking for the device.");
        self.recorder.link(LinkState::Reconnecting(error));
        self.phase = Phase::Seeking { next: now };
    }

    pub(super) fn open_next(&mut self, now: Duration) {
        let Some((ticket, port)) = self.next.take() else { return };
        let known = self.opener.list().into_iter().find(|info| info.port == port);
        let info = known.unwrap_or_else(|| PortInfo {
            label: port.to_string(),
            port: port.clone(),
            is_ours: false,
            usb_serial: None,
        });
        self.recorder.view.link.port = Some(port.clone());
        self.recorder.begin();
        self.rediscovery = Some(Rediscovery::at(info));
        self.waits_for_port = false;
        self.recorder.log(Severity::Info, format!("Connecting to {port}."));
        self.recorder.link(LinkState::Connecting);
        if let Err(error) = self.open(&port, Some(ticket), now) {
            self.recorder.forget_device(Some(error.clone()));
            self.waits_for_port =
                matches!(error, LinkError::NoSuchPort(_)) && self.recorder.view.link.auto_reconnect;
            if self.waits_for_port {
                self.recorder.log(Severity::Info, format!("Waiting for {port}."));
                self.recorder.link(LinkState::Reconnecting(error.clone()));
                self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
            } else {
                self.recorder.link(LinkState::Disconnected);
                self.phase = Phase::Closed;
            }
            self.recorder.finish(Some(ticket), Outcome::Refused(error.into()));
        }
    }

    fn open(&mut self, port: &Port, ticket: Option<Ticket>, now: Duration) -> Result<(), LinkError> {
        let transport = self.opener.open(port, &self.waker)?;
        self.opened_at = now;
        let queue = CommandQueue::begin((self.nonces)(), self.keeps_frames, ticket, now);
        self.phase = Phase::Open(Box::new(Open { transport, queue, is_new: true }));
        Ok(())
    }

    /// Waits for a port that opens some time after the request. The hello is sent, and counts as unanswered, only once it is
    /// open.
    pub(super) fn await_opening(&mut self) -> Next {
        self.has_more = false;
        let Phase::Open(open) = &mut self.phase else { return Next::Continue };
        if self.leave.is_some() || self.next.is_some() {
            return Next::Close;
        }
        let (Some(port), Err(error)) = (&self.recorder.view.link.port, open.transport.read(&mut [0])) else {
            return Next::Continue;
        };
        match LinkError::transfer(&error) {
            None => Next::Continue,
            Some(_) => Next::Lose(LinkError::opening(port, &error)),
        }
    }

    /// Looks once for the lost device or the missing port.
    pub(super) fn look(&mut self, now: Duration) {
        self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
        let ports = self.opener.list();
        let Some(port) = self.rediscovery.as_mut().and_then(|lost| lost.find(ports)) else { return };
        match self.open(&port, None, now) {
            Ok(()) => {
                self.recorder.view.link.port = Some(port);
                self.recorder.begin();
            }
            Err(error) => self.still_missing(error),
        }
    }

    /// Reports why the awaited port cannot be used yet: it may exist by now, but be busy or silent.
    fn still_missing(&mut self, error: LinkError) {
        let state = LinkState::Reconnecting(error.clone());
        if self.waits_for_port && self.recorder.view.link.state != state {
            self.recorder.log(Severity::Warning, format!("Still waiting: {error}."));
            self.recorder.view.link.error = Some(error);
            self.recorder.link(state);
        }
    }
}

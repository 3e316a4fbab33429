//! What goes out to the shell beside what is shown: messages, actions, and when the next turn is due.
//!
//! A message about a state stays as long as the state; a message about an event disappears after a time. Each can be dismissed.
//! The log has each of them whole: a refusal in the link's own line, which the message only introduces, the others in a line of
//! their own.

use super::shell::{Output, Page};
use slipline_link::Severity;
use slipline_plate::order;
use std::fmt::Display;
use std::time::Duration;

/// A message to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its text.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
    /// Incremented with every message, so that a repeated text counts as a new message.
    pub number: u64,
    /// How long it is shown, in seconds; `None` while its cause lasts.
    pub lasts_s: Option<f64>,
}

/// How long a message about a success is shown, in seconds.
const PLAIN_S: f64 = 5.0;
/// How long a message about a single failure is shown, in seconds. The log keeps it.
const ERROR_S: f64 = 30.0;

/// The subject of a message. There is at most one message for each subject at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum About {
    /// Why the device stopped by itself, until that fault is cleared. It comes first: no other message hides it.
    Stop,
    /// A refusal of the device.
    Refusal,
    /// That the window did not respond while it drove, for a time, or that the drive was paused; until something is driven again.
    Hang,
    /// Why there is no connection, until there is one.
    Trouble,
    /// Why Drive cannot act yet, until the device's state changes.
    Obstacle,
    /// The latest success or failure.
    Latest,
}

/// Messages and actions for the shell; every room adds to them.
#[derive(Default)]
pub struct Outbox {
    /// The messages in the order in which they are shown.
    standing: Vec<(About, Notice)>,
    count: u64,
    /// Lines for the log.
    unlogged: Vec<(Severity, String)>,
    outputs: Vec<Output>,
    /// The time after which the instrument must be turned again.
    wake: Option<Duration>,
}

/// A text as a line of the log: closed with a full stop.
fn line(text: &str) -> String {
    let end = if text.ends_with(['.', '?', '!']) { "" } else { "." };
    format!("{text}{end}")
}

impl Outbox {
    fn put(&mut self, about: About, text: String, is_error: bool, lasts_s: Option<f64>) {
        self.count += 1;
        self.end(about);
        self.standing.push((about, Notice { text, is_error, number: self.count, lasts_s }));
        order::sort_by_key(&mut self.standing, |(about, _)| *about);
    }

    fn end(&mut self, about: About) {
        self.standing.retain(|(other, _)| *other != about);
    }

    /// Shows a success.
    pub fn post(&mut self, text: String) {
        let logged = line(&text);
        self.report(Severity::Info, text, logged);
    }

    /// Shows a failure.
    pub fn fail(&mut self, text: String) {
        let logged = line(&text);
        self.report(Severity::Error, text, logged);
    }

    /// Shows a success or, from a warning on, a failure that the log has in other words: the log is sent to others, and holds no
    /// folders.
    pub fn report(&mut self, severity: Severity, text: String, logged: String) {
        let is_error = severity >= Severity::Warning;
        self.put(About::Latest, text, is_error, Some(if is_error { ERROR_S } else { PLAIN_S }));
        self.unlogged.push((severity, logged));
    }

    /// The lines for the log since the last call.
    pub(crate) fn take_unlogged(&mut self) -> Vec<(Severity, String)> {
        std::mem::take(&mut self.unlogged)
    }

    /// Reports that the device refused the drive on the screen: plate and screen differ until the device accepts
    /// another one.
    pub(crate) fn refuse_drive(&mut self, text: String) {
        self.put(About::Refusal, text, true, None);
    }

    /// Reports that the device refused a single request.
    pub(crate) fn refuse(&mut self, text: String) {
        self.put(About::Refusal, text, true, Some(ERROR_S));
    }

    /// Reports why the device has stopped by itself.
    pub(crate) fn stopped(&mut self, text: String) {
        self.unlogged.push((Severity::Warning, line(&text)));
        self.put(About::Stop, text, true, None);
    }

    /// Reports a fault, which the link has in the log; it stays until it is cleared.
    pub(crate) fn fault(&mut self, text: String) {
        self.put(About::Stop, text, true, None);
    }

    /// Reports that the window did not respond, and the drive was ended.
    pub(crate) fn hung(&mut self, text: String) {
        self.unlogged.push((Severity::Warning, line(&text)));
        // It responds again, so this is an event: the message does not stay for good.
        self.put(About::Hang, text, true, Some(ERROR_S));
    }

    /// Reports that the drive was paused, until something is driven again.
    pub(crate) fn pause(&mut self, text: String) {
        self.unlogged.push((Severity::Info, line(&text)));
        self.put(About::Hang, text, false, None);
    }

    /// Reports why there is no connection.
    pub(crate) fn miss(&mut self, text: String) {
        self.put(About::Trouble, text, true, None);
    }

    /// Reports why Drive cannot act now, and what helps.
    pub(crate) fn hinder(&mut self, text: String) {
        self.unlogged.push((Severity::Warning, line(&text)));
        self.put(About::Obstacle, text, true, Some(ERROR_S));
    }

    /// Reports why Drive acts only later.
    pub(crate) fn delay(&mut self, text: String) {
        self.unlogged.push((Severity::Info, line(&text)));
        self.put(About::Obstacle, text, false, Some(PLAIN_S));
    }

    /// Removes the message about the connection: it exists, or a new attempt has begun.
    pub(crate) fn connected(&mut self) {
        self.end(About::Trouble);
    }

    /// Removes the message about a refusal: the device has accepted something newer, or nothing sounds any more.
    pub(crate) fn settle(&mut self) {
        self.end(About::Refusal);
    }

    /// Removes the messages about the end or refusal of the last drive: the device sounds a newer one.
    pub(crate) fn driven(&mut self) {
        self.settle();
        self.end(About::Hang);
    }

    /// Removes the message about a stop: its fault is cleared.
    pub(crate) fn cleared(&mut self) {
        self.end(About::Stop);
    }

    /// Removes the message about Drive: the device's state has changed, so the obstacle may be gone.
    pub(crate) fn state_changed(&mut self) {
        self.end(About::Obstacle);
    }

    /// Removes the message with this number.
    pub fn dismiss(&mut self, number: u64) {
        self.standing.retain(|(_, notice)| notice.number != number);
    }

    /// Reports why a file was not opened.
    pub fn not_opened(&mut self, name: &str, reason: &impl Display) {
        let reason = slipline_link::capitalized(&reason.to_string());
        self.fail(format!("{name} was not opened, nothing has changed. {reason}"));
    }

    pub(crate) fn push(&mut self, output: Output) {
        self.outputs.push(output);
    }

    pub(crate) fn open(&mut self, page: Page) {
        self.push(Output::Open(page));
    }

    pub(crate) fn save(&mut self, name: &str, kind: &'static str, extension: &'static str, text: String) {
        self.push(Output::Save { name: name.to_owned(), kind, extension, bytes: text.into_bytes() });
    }

    pub(crate) fn wake_after(&mut self, after: Duration) {
        self.wake = Some(self.wake.map_or(after, |wake| wake.min(after)));
    }

    /// Actions for the shell, in order.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.outputs)
    }

    /// The time after which [`Instrument::turn`](super::Instrument::turn) must be called again, if any.
    pub fn take_wake(&mut self) -> Option<Duration> {
        self.wake.take()
    }

    /// The messages, the latest last.
    pub fn notices(&self) -> impl Iterator<Item = &Notice> {
        self.standing.iter().map(|(_, notice)| notice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_the_state_removes_the_reason_of_a_delay_and_no_other_notice() {
        let mut out = Outbox::default();
        out.delay("Later".to_owned());
        out.post("Saved".to_owned());
        let shown = |out: &Outbox| out.notices().map(|notice| notice.text.clone()).collect::<Vec<_>>();
        assert_eq!(shown(&out), ["Later", "Saved"]);
        assert!(out.notices().all(|notice| !notice.is_error && notice.lasts_s == Some(PLAIN_S)));
        out.state_changed();
        assert_eq!(shown(&out), ["Saved"]);
        assert_eq!(out.take_unlogged().len(), 2);
    }
}

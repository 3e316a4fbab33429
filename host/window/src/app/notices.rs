//! The messages that stand. One that tells of a state stands as long as that state; one that tells of an event goes
//! after a time. Each can be dismissed.

use crate::scene::Notice;

/// How long a message stands that tells of nothing wrong, in seconds.
const PLAIN_S: f64 = 5.0;
/// How long a message stands that tells of something that went wrong once, in seconds. The log keeps it.
const ERROR_S: f64 = 30.0;

/// What a message is about. There is one message about each at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum About {
    /// What the device refused.
    Refusal,
    /// Why the device stopped by itself, until that fault is cleared.
    Stop,
    /// Why there is no connection, until there is one.
    Trouble,
    /// Why Drive cannot act, until the device's state is another.
    Obstacle,
    /// What was done last, or went wrong.
    Latest,
}

/// The messages that stand.
#[derive(Default)]
pub(super) struct Notices {
    /// In the order in which they are shown.
    standing: Vec<(About, Notice)>,
    count: u64,
}

impl Notices {
    fn put(&mut self, about: About, text: String, is_error: bool, lasts_s: Option<f64>) {
        self.count += 1;
        self.end(about);
        self.standing.push((about, Notice { text, is_error, number: self.count, lasts_s }));
        self.standing.sort_by_key(|(about, _)| *about);
    }

    fn end(&mut self, about: About) {
        self.standing.retain(|(other, _)| *other != about);
    }

    /// Tells what was done.
    pub(super) fn tell(&mut self, text: String) {
        self.put(About::Latest, text, false, Some(PLAIN_S));
    }

    /// Tells what went wrong.
    pub(super) fn fail(&mut self, text: String) {
        self.put(About::Latest, text, true, Some(ERROR_S));
    }

    /// Tells that the device refused the drive that the screen shows: plate and screen differ until another is taken.
    pub(super) fn refuse_drive(&mut self, text: String) {
        self.put(About::Refusal, text, true, None);
    }

    /// Tells that the device refused something that was asked for once.
    pub(super) fn refuse(&mut self, text: String) {
        self.put(About::Refusal, text, true, Some(ERROR_S));
    }

    /// Tells why the device has stopped by itself.
    pub(super) fn stopped(&mut self, text: String) {
        self.put(About::Stop, text, true, None);
    }

    /// Tells why there is no connection.
    pub(super) fn miss(&mut self, text: String) {
        self.put(About::Trouble, text, true, None);
    }

    /// Tells why Drive cannot act now, and what helps.
    pub(super) fn hinder(&mut self, text: String) {
        self.put(About::Obstacle, text, true, Some(ERROR_S));
    }

    /// There is a connection, or another is being made.
    pub(super) fn connected(&mut self) {
        self.end(About::Trouble);
    }

    /// The device has taken something newer than what it refused, or nothing sounds any more.
    pub(super) fn settle(&mut self) {
        self.end(About::Refusal);
    }

    /// The fault for which the device stopped is cleared.
    pub(super) fn cleared(&mut self) {
        self.end(About::Stop);
    }

    /// The device's state is another: what stood in the way of Drive may be gone.
    pub(super) fn state_changed(&mut self) {
        self.end(About::Obstacle);
    }

    /// Takes away the message of this number.
    pub(super) fn dismiss(&mut self, number: u64) {
        self.standing.retain(|(_, notice)| notice.number != number);
    }

    /// The messages, the latest thing told last.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Notice> {
        self.standing.iter().map(|(_, notice)| notice)
    }
}

//! The messages that stand: why the device does not do what was asked, as long as that holds, and beside it what was
//! told last.

use crate::scene::Notice;

/// The messages that stand.
#[derive(Default)]
pub(super) struct Notices {
    /// What the device refused or stopped for, until it takes something newer.
    refusal: Option<Notice>,
    /// Why there is no connection, until there is one.
    trouble: Option<Notice>,
    latest: Option<Notice>,
    count: u64,
}

impl Notices {
    fn make(&mut self, text: String, is_error: bool) -> Option<Notice> {
        self.count += 1;
        Some(Notice { text, is_error, number: self.count })
    }

    /// Tells what was done.
    pub(super) fn tell(&mut self, text: String) {
        self.latest = self.make(text, false);
    }

    /// Tells what went wrong.
    pub(super) fn fail(&mut self, text: String) {
        self.latest = self.make(text, true);
    }

    /// Tells that the device refused something, or stopped by itself.
    pub(super) fn refuse(&mut self, text: String) {
        self.refusal = self.make(text, true);
    }

    /// Tells why there is no connection.
    pub(super) fn miss(&mut self, text: String) {
        self.trouble = self.make(text, true);
    }

    /// There is a connection.
    pub(super) fn connected(&mut self) {
        self.trouble = None;
    }

    /// The device has taken something newer than what it refused.
    pub(super) fn settle(&mut self) {
        self.refusal = None;
    }

    /// Takes away the message of this number.
    pub(super) fn dismiss(&mut self, number: u64) {
        for standing in [&mut self.refusal, &mut self.trouble, &mut self.latest] {
            if standing.as_ref().is_some_and(|notice| notice.number == number) {
                *standing = None;
            }
        }
    }

    /// The messages, the latest thing told last.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Notice> {
        self.refusal.iter().chain(&self.trouble).chain(&self.latest)
    }
}

//! The minor version that two sides share.

/// Rises when messages or variants are added.
pub const MINOR: u8 = 3;

/// A minor version that two sides share: neither sends the other anything newer. By default the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Minor(u8);

impl Minor {
    /// The minor that every device and host of the major version knows; the only one before the hello.
    pub const FIRST: Self = Self(0);
    /// The minor of this build.
    pub const OURS: Self = Self(MINOR);

    pub(crate) const fn new(minor: u8) -> Self {
        Self(minor)
    }

    /// Whether what was added in a minor may be sent.
    #[must_use]
    pub const fn has(self, since: u8) -> bool {
        since <= self.0
    }
}

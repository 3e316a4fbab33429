//! The result of a step, like the colour of a light.

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Not shown: the sentence names what is missing.
    Skipped,
    /// Every number is within its limits.
    Green,
    /// The board works; the sentence names what to mend.
    Amber,
    /// A number is beyond its limit, or the device did not do what the step asked.
    Red,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Skipped, Self::Green, Self::Amber, Self::Red];

    /// As a word: `skipped`, `green`, `amber` or `red`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Skipped => "skipped",
            Self::Green => "green",
            Self::Amber => "amber",
            Self::Red => "red",
        }
    }
}

//! What a procedure asks a person at the board to do.

/// What a person at the board is asked to do, within ten seconds, or half a minute for the reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prompt {
    /// Press the user button.
    PressButton,
    /// Let it go.
    ReleaseButton,
    /// Press the user button and hold it, so that a profile can be written.
    HoldButton,
    /// Open the stop input.
    OpenStopInput,
    /// Close it.
    CloseStopInput,
    /// Press the reset button.
    PressReset,
}

impl Prompt {
    /// As a sentence.
    #[must_use]
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::PressButton => "Press the user button now.",
            Self::ReleaseButton => "Let the user button go now.",
            Self::HoldButton => "Press the user button now and hold it.",
            Self::OpenStopInput => "Open the stop input now.",
            Self::CloseStopInput => "Close the stop input now.",
            Self::PressReset => "The board is in its bootloader. Press its reset button now.",
        }
    }
}

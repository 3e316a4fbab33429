//! The answer about the level of a board's brown-out reset.

use serde::Serialize;
use slipline_link::protocol::board::BrownOut;

/// The fields of `slipline board brown-out --json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "host/JSON.md has the meaning of each field")]
pub struct BrownOutAnswer {
    pub brown_out_guarded: bool,
    // JSON, count: Level of the brown-out reset, counted from the lowest threshold
    pub brown_out_level: u8,
    // JSON, count: Lowest level that guards the board
    pub brown_out_level_needed: u8,
    // JSON, text: The chip's register of option bytes that holds the level, eight hexadecimal digits
    pub option_bytes: String,
    // JSON, true or false: Whether the level was written, and compared after the restart
    pub written: bool,
}

impl BrownOutAnswer {
    /// The fields of what a device reports.
    #[must_use]
    pub fn of(report: &BrownOut) -> Self {
        Self {
            brown_out_guarded: report.level >= report.needed,
            brown_out_level: report.level,
            brown_out_level_needed: report.needed,
            option_bytes: format!("{:08x}", report.options),
            written: report.restarts,
        }
    }
}

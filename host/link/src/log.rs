//! The lines that the link, the device and the app write into one log.

use std::fmt;
use std::time::Duration;

/// How much an entry of the log matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// For the curious.
    Detail,
    /// What was done.
    Info,
    /// Something to look at.
    Warning,
    /// Something went wrong.
    Error,
}

/// One line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogEntry {
    /// How much it matters.
    pub severity: Severity,
    /// When, since the worker was started.
    pub time: Duration,
    /// What.
    pub text: String,
}

impl fmt::Display for LogEntry {
    /// One line: the time in seconds, the severity, the text.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = match self.severity {
            Severity::Detail => "detail",
            Severity::Info => "info",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        write!(f, "{:9.3} {level:7} {}", self.time.as_secs_f64(), self.text)
    }
}

/// Lines the log keeps.
pub const LOG_LINES: usize = 500;

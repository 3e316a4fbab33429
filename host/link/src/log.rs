//! The common log of the link, the device and the app.

use std::fmt;
use std::time::Duration;

/// Importance of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Severity {
    /// For diagnosis.
    Detail,
    /// A completed action.
    Info,
    /// A condition to check.
    Warning,
    /// An error.
    Error,
}

/// One line of the log.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LogEntry {
    /// Importance.
    pub severity: Severity,
    /// Time since the worker was started.
    pub time: Duration,
    /// Text of the entry.
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
pub(crate) const LOG_LINES: usize = 500;

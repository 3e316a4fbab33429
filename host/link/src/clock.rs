//! The time that a caller brings.

use std::sync::Arc;
use std::time::Duration;

/// The time since a fixed moment, monotonic: the computer's clock, or a test's.
pub type Clock = Arc<dyn Fn() -> Duration + Send + Sync>;

//! Why eframe has ended the event loop: it names the error in its log only.

use log::{Level, LevelFilter, Log, Metadata, Record};
use std::sync::{Mutex, PoisonError};

/// How eframe begins the line with the error that ended it.
const ENDED: &str = "Exiting because of error: ";

static ERROR: Mutex<Option<String>> = Mutex::new(None);

struct Listener;

impl Log for Listener {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() == Level::Error && metadata.target().starts_with("eframe")
    }

    fn log(&self, record: &Record<'_>) {
        let text = record.args().to_string();
        if self.enabled(record.metadata())
            && let Some(reason) = text.strip_prefix(ENDED)
        {
            *ERROR.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason.to_owned());
        }
    }

    fn flush(&self) {}
}

/// Listens to eframe's log from now on.
pub(super) fn listen() {
    // Nothing else in this program listens to this log.
    if log::set_logger(&Listener).is_ok() {
        log::set_max_level(LevelFilter::Error);
    }
}

/// The error that has ended the event loop, once.
pub(super) fn take_error() -> Option<String> {
    ERROR.lock().unwrap_or_else(PoisonError::into_inner).take()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_that_ended_the_loop_is_kept_and_other_lines_are_not() {
        listen();
        log::error!(target: "eframe::native::run", "a frame was late");
        log::error!(target: "egui", "Exiting because of error: another library's");
        assert_eq!(take_error(), None);
        log::error!(target: "eframe::native::run", "Exiting because of error: no OpenGL");
        assert_eq!((take_error().as_deref(), take_error()), (Some("no OpenGL"), None));
    }
}

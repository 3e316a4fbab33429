//! Opened files: recognition of a text by its content, and the reports.

use super::Instrument;
use crate::recording::{Recording, RecordingError};
use slipline_model::response::is_measurement;
use std::fmt::Display;

impl Instrument {
    /// Opens a recorded drag or a measurement; returns whether the text is one of them.
    pub fn opened_table(&mut self, name: &str, text: &str) -> bool {
        if Recording::is_one(text) {
            self.open_recording(name, Recording::from_csv(text));
        } else if is_measurement(text) {
            self.open_measurement(name, text.as_bytes().to_vec());
        } else {
            return false;
        }
        true
    }

    fn open_recording(&mut self, name: &str, recording: Result<Recording, RecordingError>) {
        match recording {
            Ok(recording) => {
                self.take_recording(recording);
                self.notices.post(format!("Opened {name}: press Play on the page Play"));
            }
            Err(error) => self.not_opened(name, &error),
        }
    }

    /// Reports why a file was not opened.
    pub fn not_opened(&mut self, name: &str, reason: &impl Display) {
        let reason = slipline_link::capitalized(&reason.to_string());
        self.fail(format!("{name} was not opened, nothing has changed. {reason}"));
    }
}

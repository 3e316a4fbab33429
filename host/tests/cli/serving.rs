//! A command that serves until it is ended by a signal.

use super::{program, signal};
use serde_json::Value;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};

/// A program that serves, and the line of JSON with which it began.
pub(crate) struct Serving(pub(crate) Child, pub(crate) Value);

impl Serving {
    /// Begins in this folder.
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut command = program(["--json"].iter().chain(arguments));
        let mut child = command.current_dir(folder).stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        Self(child, serde_json::from_str(&line).unwrap())
    }

    /// Ends it by this signal, such as `-TERM`.
    pub(crate) fn end(mut self, option: &str) -> ExitStatus {
        signal(self.0.id(), option);
        self.0.wait().unwrap()
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        // Ended already, unless the test has failed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

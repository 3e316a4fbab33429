//! Files that a command reads; `-` is standard input.

use super::failure::Failure;
use slipline_model::atomic_file::{self, STANDARD_STREAM, said};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a file of the command was standard input, which can be read once.
static IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// Whether a file of the command was standard input.
pub(super) fn is_standard_input_taken() -> bool {
    IS_TAKEN.load(Ordering::Relaxed)
}

/// As [`atomic_file::read_text`].
pub(super) fn read_text(path: &Path, most: usize) -> io::Result<String> {
    read_bytes(path, most).and_then(atomic_file::text)
}

/// The text of a file of the command; the error names the file.
pub(super) fn text_of(path: &Path, most: usize) -> Result<String, Failure> {
    read_text(path, most).map_err(|error| Failure::of_file(path, said(&error)))
}

/// The bytes of a file of the command; the error names the file.
pub(super) fn bytes_of(path: &Path, most: usize) -> Result<Vec<u8>, Failure> {
    read_bytes(path, most).map_err(|error| Failure::of_file(path, said(&error)))
}

/// As [`atomic_file::read_bytes`].
fn read_bytes(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    if path != Path::new(STANDARD_STREAM) {
        return atomic_file::read_bytes(path, most);
    }
    if IS_TAKEN.swap(true, Ordering::Relaxed) {
        let reason = "standard input is read already: it can be one file of a command";
        return Err(io::Error::new(ErrorKind::InvalidInput, reason));
    }
    atomic_file::read_limited(io::stdin().lock(), most)
}

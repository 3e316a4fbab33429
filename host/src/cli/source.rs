//! Files that a command reads; `-` is standard input.

use slipline_model::atomic_file::{self, STANDARD_STREAM};
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

/// As [`atomic_file::read_bytes`].
pub(super) fn read_bytes(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    if path != Path::new(STANDARD_STREAM) {
        return atomic_file::read_bytes(path, most);
    }
    if IS_TAKEN.swap(true, Ordering::Relaxed) {
        let reason = "standard input is read already: it can be one file of a command";
        return Err(io::Error::new(ErrorKind::InvalidInput, reason));
    }
    atomic_file::read_limited(io::stdin().lock(), most)
}

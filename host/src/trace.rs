//! Diagnostic output of the libraries (`tracing`): `RUST_LOG` selects the events written to standard error,
//! `--trace FILE` writes every frame on the link to a file, one line each.

use crate::cli::{Failure, trace_to_file, trace_to_standard_output};
use slipline_model::atomic_file::{STANDARD_STREAM, is_stream, said};
use slipline_plate::quantity::must_be;
use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::{Mutex, OnceLock};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::layer;
use tracing_subscriber::layer::{Layer as _, SubscriberExt as _};
use tracing_subscriber::util::SubscriberInitExt as _;

/// The variable that selects the events written to standard error.
const VARIABLE: &str = "RUST_LOG";

/// Why the trace is not whole; `None` where the reader of standard output has left, which is no failure.
static BROKEN: OnceLock<Option<String>> = OnceLock::new();

/// Its name in a sentence.
const STANDARD_OUTPUT: &str = "standard output";

/// The lines of the frames. What cannot be written is lost, and the program goes on: it may be driving.
struct Frames {
    /// Where they go, in a sentence.
    name: String,
    out: Box<dyn Write + Send>,
}

impl Write for Frames {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Nothing follows a gap.
        if BROKEN.get().is_none()
            && let Err(error) = self.out.write_all(bytes).and_then(|()| self.out.flush())
        {
            let has_left = self.name == STANDARD_OUTPUT && error.kind() == ErrorKind::BrokenPipe;
            let why = || format!("{} is not whole: {}", self.name, said(&error));
            let _ = BROKEN.set((!has_left).then(why));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Ends the output.
///
/// # Errors
/// [`Failure::Failed`] if a part of the trace is missing.
pub fn end() -> Result<(), Failure> {
    BROKEN.get().cloned().flatten().map_or(Ok(()), |why| Err(Failure::Failed(why)))
}

/// Starts the output. With neither a file nor `RUST_LOG` there is no listener, and the libraries' events cost
/// nothing.
///
/// # Errors
/// [`Failure::Usage`] for a `RUST_LOG` that cannot be read, for a file that exists and may not be replaced, and for standard
/// output with JSON; [`Failure::Failed`] for a file that cannot be written.
pub fn start(file: Option<&Path>, may_replace: bool, json: bool) -> Result<(), Failure> {
    let filter = match std::env::var(VARIABLE) {
        Ok(text) if !text.is_empty() => Some(text.parse::<Targets>().map_err(|error| {
            let allowed = format!("a list like 'slipline_link=debug' or 'info' ({error})");
            Failure::Usage(must_be(format_args!("{VARIABLE} is '{text}'"), allowed))
        })?),
        _ => None,
    };
    let frames = match file {
        Some(path) if path == Path::new(STANDARD_STREAM) => {
            trace_to_standard_output(json)?;
            Some(Frames { name: STANDARD_OUTPUT.to_owned(), out: Box::new(std::io::stdout()) })
        }
        Some(path) => {
            let name = format!("the trace {}", path.display());
            let mut options = OpenOptions::new();
            options.write(true);
            // A pipe or a device exists already; a link to nothing counts as an existing file.
            if !is_stream(path) {
                options.create(true).truncate(true).create_new(!may_replace);
            }
            let out = options.open(path).map_err(|error| {
                if error.kind() == ErrorKind::AlreadyExists {
                    let how = "write --force to replace it, or name another file";
                    return Failure::Usage(format!("{name} exists: {how}"));
                }
                Failure::Failed(format!("{name} cannot be written: {}", said(&error)))
            })?;
            trace_to_file(path);
            Some(Frames { name, out: Box::new(out) })
        }
        None => None,
    };
    if filter.is_none() && frames.is_none() {
        return Ok(());
    }
    let to_file = frames.map(|file| {
        let line = layer().with_ansi(false).without_time().with_level(false).with_target(false);
        let only_frames = Targets::new().with_target(slipline_link::FRAMES, LevelFilter::TRACE);
        line.with_writer(Mutex::new(file)).with_filter(only_frames)
    });
    let to_terminal = filter.map(|filter| layer().with_writer(std::io::stderr).with_filter(filter));
    tracing_subscriber::registry().with(to_file).with(to_terminal).init();
    Ok(())
}

//! Diagnostic output of the libraries (`tracing`): `RUST_LOG` selects the events written to standard error,
//! `--trace FILE` writes every frame on the link to a file, one line each.

use crate::cli::{Failure, trace_to_standard_output};
use slipline_model::atomic_file::STANDARD_STREAM;
use slipline_plate::quantity::must_be;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::layer;
use tracing_subscriber::layer::{Layer as _, SubscriberExt as _};
use tracing_subscriber::util::SubscriberInitExt as _;

/// The variable that selects the events written to standard error.
const VARIABLE: &str = "RUST_LOG";

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
    let frames: Option<Box<dyn Write + Send>> = match file {
        Some(path) if path == Path::new(STANDARD_STREAM) => {
            trace_to_standard_output(json)?;
            Some(Box::new(std::io::stdout()))
        }
        Some(path) if path.is_file() && !may_replace => {
            let name = path.display();
            return Err(Failure::Usage(format!(
                "the trace {name} exists: write --force to replace it, or name another file"
            )));
        }
        Some(path) => Some(Box::new(File::create(path).map_err(|error| {
            Failure::Failed(format!("the trace {} cannot be written: {error}", path.display()))
        })?)),
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

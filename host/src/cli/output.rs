//! The output of a command: aligned lines for people, JSON for programs. Where a file of the command is standard output,
//! the lines go to standard error.

use super::failure::Failure;
use super::schema::finished;
use serde_json::Value;
use slipline_model::atomic_file::{self, said};
use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether standard output has the command's JSON, or one of its files.
static HAS_JSON: AtomicBool = AtomicBool::new(false);
static HAS_FILE: AtomicBool = AtomicBool::new(false);

/// The file of the trace, once it is open.
static TRACE: OnceLock<PathBuf> = OnceLock::new();

/// States whether standard output has the command's JSON, before its files are named.
pub(super) fn begin(as_json: bool) {
    HAS_JSON.store(as_json, Ordering::Relaxed);
}

/// Writes a line to standard error. Where that is full or closed the line is lost, and nothing else.
pub fn note(line: impl Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Takes standard output for a file.
pub(super) fn take() -> Result<(), Failure> {
    refuse_closed()?;
    if HAS_JSON.load(Ordering::Relaxed) {
        let why = "--json and a file named - both need standard output: name another file";
        return Err(Failure::usage(why));
    }
    if HAS_FILE.swap(true, Ordering::Relaxed) {
        return Err(Failure::usage("two files named - both need standard output: name another file"));
    }
    Ok(())
}

/// Refuses what would be written to a closed standard output, and lost.
fn refuse_closed() -> Result<(), Failure> {
    if is_closed() {
        let why = "standard output is closed, so what the command writes there would be lost";
        return Err(Failure::Failed(why.to_owned()));
    }
    Ok(())
}

/// Whether the program was started with a closed standard output, as by `>&-`: the library of Rust then opens the null device
/// for reading and writing. A shell opens it for writing alone, for a user who wants nothing.
fn is_closed() -> bool {
    let flags = || {
        let status = std::fs::read_to_string("/proc/self/fdinfo/1").ok()?;
        let flags = status.lines().find_map(|line| line.strip_prefix("flags:"))?;
        u32::from_str_radix(flags.trim(), 8).ok()
    };
    let is_null = std::fs::read_link("/proc/self/fd/1").is_ok_and(|file| file == Path::new("/dev/null"));
    is_null && flags().is_some_and(|flags| flags & 0b11 == 0b10)
}

/// Prints what the parser of the command line has to say, its help or the version.
pub(super) fn print_of_parser(text: &clap::Error) -> Result<(), Failure> {
    if !text.use_stderr() {
        refuse_closed()?;
    }
    match text.print().and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(unwritten(&error)),
        _ => Ok(()),
    }
}

/// Writes a file to standard output, as [`atomic_file::write_to`].
pub(super) fn write<E: From<io::Error>>(
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    atomic_file::write_to(&mut Unbroken(io::stdout().lock()), write)
}

/// A stream whose reader may leave, as that of `slipline table --out - | head`: what follows is dropped.
struct Unbroken<W>(W);

impl<W: Write> Write for Unbroken<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(bytes.len()),
            written => written,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            flushed => flushed,
        }
    }
}

/// Prints one line of JSON; returns whether its reader is still there.
pub(super) fn line(value: &Value) -> Result<bool, Failure> {
    refuse_closed()?;
    let mut out = io::stdout().lock();
    match writeln!(out, "{}", finished(value)).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        written => written.map(|()| true).map_err(|error| unwritten(&error)),
    }
}

fn unwritten(error: &io::Error) -> Failure {
    Failure::Failed(format!("standard output: {}", said(error)))
}

/// Prints `value` as one line of JSON, or else the text of `text`.
pub(super) fn print(
    as_json: bool,
    value: &Value,
    text: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let stream: &mut dyn Write = if HAS_FILE.load(Ordering::Relaxed) {
        &mut io::stderr().lock()
    } else {
        refuse_closed()?;
        &mut io::stdout().lock()
    };
    let mut out = BufWriter::new(Unbroken(stream));
    let written = if as_json { writeln!(out, "{}", finished(value)) } else { text(&mut out) };
    written.and_then(|()| out.flush()).map_err(|error| unwritten(&error))
}

/// Writes (name, value) lines with the values in one column.
pub(super) fn lines(out: &mut dyn Write, lines: &[(&str, String)]) -> io::Result<()> {
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (name, value) in lines {
        writeln!(out, "{name:<width$}  {value}")?;
    }
    Ok(())
}

/// Writes a table with a header; the first column is left-aligned, the others right.
pub(super) fn table(out: &mut dyn Write, rows: &[Vec<String>]) -> io::Result<()> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns)
        .map(|column| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max())
        .map(Option::unwrap_or_default)
        .collect();
    for row in rows {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .enumerate()
            .map(
                |(column, (cell, &width))| {
                    if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        writeln!(out, "{}", cells.join("  ").trim_end())?;
    }
    Ok(())
}

/// Takes standard output for the trace: the command's text goes to standard error then.
///
/// # Errors
/// [`Failure::Usage`] with JSON, which needs standard output, too.
pub fn trace_to_standard_output(json: bool) -> Result<(), Failure> {
    begin(json);
    take()
}

/// The trace is written to this file, which is open: no other file of the command may be the same.
pub fn trace_to_file(path: &Path) {
    if let Ok(path) = path.canonicalize() {
        let _ = TRACE.set(path);
    }
}

/// Whether a file is that of the trace, even if their paths are written differently.
pub(super) fn is_trace(path: &Path) -> bool {
    let trace = TRACE.get().filter(|trace| !atomic_file::is_stream(trace));
    trace.is_some_and(|trace| path.canonicalize().is_ok_and(|path| path == *trace))
}

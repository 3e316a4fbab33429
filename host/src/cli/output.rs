//! What a command says: aligned lines for people, JSON for programs.

use super::failure::Failure;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Prints `value` as one line of JSON, or else what `text` writes.
pub(super) fn print(
    as_json: bool,
    value: &serde_json::Value,
    text: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    let written = if as_json { writeln!(out, "{value}") } else { text(&mut out) };
    match written.and_then(|()| out.flush()) {
        // Whoever read us has had enough: `slipline table | head` is no error.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result.map_err(|error| Failure::Failed(format!("standard output: {error}"))),
    }
}

/// Writes (name, value) lines with the values in one column.
pub(super) fn lines(out: &mut dyn Write, lines: &[(&str, String)]) -> std::io::Result<()> {
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (name, value) in lines {
        writeln!(out, "{name:<width$}  {value}")?;
    }
    Ok(())
}

/// Writes a table with a header; the first column is left-aligned, the others right.
pub(super) fn table(out: &mut dyn Write, rows: &[Vec<String>]) -> std::io::Result<()> {
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

/// Writes a file through `write`; a file that cannot be written fails with its name.
pub(super) fn file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> anyhow::Result<()>,
) -> Result<(), Failure> {
    let failed = |error: anyhow::Error| Failure::Failed(format!("{}: {error}", path.display()));
    let mut out = BufWriter::new(File::create(path).map_err(|error| failed(error.into()))?);
    write(&mut out).map_err(failed)?;
    out.flush().map_err(|error| failed(error.into()))
}

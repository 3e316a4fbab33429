//! The output of a command: aligned lines for people, JSON for programs.

use super::failure::Failure;
use slipline_model::atomic_file::said;
use std::io::{BufWriter, Write};

/// Prints `value` as one line of JSON, or else the text of `text`.
pub(super) fn print(
    as_json: bool,
    value: &serde_json::Value,
    text: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    let written = if as_json { writeln!(out, "{value}") } else { text(&mut out) };
    match written.and_then(|()| out.flush()) {
        // The reader of the pipe has closed it, as in `slipline table | head`: no error.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result.map_err(|error| Failure::Failed(format!("standard output: {}", said(&error)))),
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

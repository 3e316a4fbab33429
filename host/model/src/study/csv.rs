//! The results of a study as CSV: a header, then a row for each plate, in SI units. Every number reads back to the same bits.

use super::chunk::Chunk;
use super::plates::Study;
use std::fmt::Write as _;

/// The header, with the whole specification, and the names of the columns.
#[must_use]
pub fn head(study: &Study) -> String {
    let spec = study.spec();
    let mut text =
        format!("# Study of {} plates around {:?}, by Slipline\n", spec.count(), study.nominal().name());
    for result in spec.results() {
        let _ = writeln!(text, "# {}: {}", result.name(), result.meaning());
    }
    text.push_str("# units: SI; an empty cell has no value, and status says why. The specification:\n");
    for line in spec.to_toml().lines() {
        let _ = writeln!(text, "{}", format!("# {line}").trim_end());
    }
    text.push_str("plate,status");
    for varied in spec.varied() {
        let _ = write!(text, ",{}", varied.column());
    }
    for place_m in spec.turning_point_m() {
        for result in spec.results() {
            let _ = write!(text, ",{}_at_{place_m}", result.name());
        }
    }
    text.push('\n');
    text
}

/// The rows of a range of plates.
#[must_use]
pub fn rows(study: &Study, chunk: &Chunk) -> String {
    let (fields, places) = (study.spec().varied().len(), study.spec().turning_point_m().len());
    let mut text = String::new();
    for (row, status) in chunk.status.iter().enumerate() {
        let _ = write!(text, "{},{}", chunk.first + row as u64, status.meaning());
        for value in &chunk.varied[row * fields..][..fields] {
            let _ = write!(text, ",{value:e}");
        }
        for place in row * places..(row + 1) * places {
            for numbers in &chunk.results {
                if numbers[place].is_finite() {
                    let _ = write!(text, ",{:e}", numbers[place]);
                } else {
                    text.push(',');
                }
            }
        }
        text.push('\n');
    }
    text
}

//! A recorded drag: places of the boundary lines over time; its playback; its CSV file.

use slipline_model::setup::MAX_TONES;
use slipline_plate::quantity::{Count, Counted, OutOfRange, Range, WrongCount, must_be};
use slipline_plate::text_table::{BadLine, Table};
use std::fmt::Write as _;
use thiserror::Error;

/// The longest recording, in seconds.
pub(crate) const LONGEST_S: f64 = 600.0;
/// The most moves of a recording.
pub(crate) const MOVES_MAX: usize = 20_000;
/// Allowed places of lines in a file, in metres: up to the longest plate.
const PLACES_M: Range = Range::new(0.0, 10.0, "m");
/// The names of the columns, by which a file is recognized.
const COLUMNS: &str = "time_s,tone,place_m";

/// One move of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Time, in seconds from the first move.
    pub time_s: f64,
    /// The slot of its tone.
    pub slot: u8,
    /// New place, in metres from the driven end.
    pub place_m: f64,
}

/// The moves of a drag, in the order of their times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    moves: Vec<Move>,
}

/// Why a file is not a recording.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// It has no move, or too many.
    #[error(transparent)]
    Moves(WrongCount),
    /// A line cannot be read.
    #[error("{0}. Write TIME,TONE,PLACE in seconds and metres, such as 0.25,1,0.12")]
    Line(#[from] BadLine),
    /// A value is out of its range.
    #[error("line {line}: {}", error.in_suitable_units())]
    Value {
        /// The line, from 1.
        line: usize,
        /// The value and its range.
        error: OutOfRange,
    },
    /// The number of the tone is out of range.
    #[error("{}", must_be(format_args!("line {line}: tone = {tone}"), format_args!("1 to {MAX_TONES}")))]
    Tone {
        /// The line, from 1.
        line: usize,
        /// The number in the file.
        tone: f64,
    },
    /// A move is earlier than the previous one.
    #[error("line {line}: the times must not fall")]
    Order {
        /// The line, from 1.
        line: usize,
    },
}

impl Recording {
    /// The moves.
    #[must_use]
    pub fn moves(&self) -> &[Move] {
        &self.moves
    }

    /// Its duration, in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.moves.last().map_or(0.0, |last| last.time_s)
    }

    /// Adds a move at `now_s` of a clock in seconds; `begun_s` is the time of the first move on the same
    /// clock. Returns whether there is room for more.
    pub fn push(&mut self, now_s: f64, begun_s: &mut Option<f64>, slot: u8, place_m: f64) -> bool {
        let time_s = (now_s - *begun_s.get_or_insert(now_s)).max(self.duration_s());
        if time_s > LONGEST_S || self.moves.len() == MOVES_MAX {
            return false;
        }
        self.moves.push(Move { time_s, slot, place_m });
        true
    }

    /// The last place of each moved line among the moves after `from_s` up to `to_s`, in seconds; a negative
    /// `from_s` includes the start.
    pub fn between(&self, from_s: f64, to_s: f64) -> impl Iterator<Item = Move> + use<> {
        let start = self.moves.partition_point(|step| step.time_s <= from_s);
        let end = self.moves.partition_point(|step| step.time_s <= to_s).max(start);
        let mut last = [None; MAX_TONES];
        for step in &self.moves[start..end] {
            if let Some(last) = last.get_mut(usize::from(step.slot)) {
                *last = Some(*step);
            }
        }
        last.into_iter().flatten()
    }

    /// Whether a text is a recording, by its columns.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        let mut lines = text.trim_start_matches('\u{feff}').lines();
        let head = lines.find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or("");
        COLUMNS.split(',').eq(head.split([',', ';', '\t']).map(|name| name.trim().trim_matches('"')))
    }

    /// Reads a recording as [`Self::to_csv`] writes it.
    ///
    /// # Errors
    /// [`RecordingError`], with the line.
    pub fn from_csv(text: &str) -> Result<Self, RecordingError> {
        let mut moves: Vec<Move> = Vec::new();
        let table = Table::read(text.trim_start_matches('\u{feff}'))?;
        for (table, row) in table.iter().flat_map(|table| table.rows().iter().map(move |row| (table, row))) {
            let line = row.line;
            let (time_s, tone, place_m) =
                (table.finite(row, 0)?, table.finite(row, 1)?, table.finite(row, 2)?);
            let value = |error| RecordingError::Value { line, error };
            OutOfRange::check("time_s", time_s, Range::new(0.0, LONGEST_S, "s")).map_err(value)?;
            OutOfRange::check("place_m", place_m, PLACES_M).map_err(value)?;
            let is_slot = tone.fract() == 0.0 && (1.0..=MAX_TONES as f64).contains(&tone);
            let slot =
                if is_slot { tone as u8 - 1 } else { return Err(RecordingError::Tone { line, tone }) };
            if moves.last().is_some_and(|before| before.time_s > time_s) {
                return Err(RecordingError::Order { line });
            }
            moves.push(Move { time_s, slot, place_m });
        }
        let allowed = Count::new(1, MOVES_MAX, Counted::Points);
        WrongCount::check("the recording", moves.len(), allowed).map_err(RecordingError::Moves)?;
        Ok(Self { moves })
    }

    /// The recording as CSV: time in seconds, number of the tone from 1, place of its line in metres.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = format!("{COLUMNS}\n");
        for Move { time_s, slot, place_m } in &self.moves {
            let _ = writeln!(text, "{time_s:.4},{},{place_m:.6}", slot + 1);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Recording {
        let mut recording = Recording::default();
        let mut begun_s = None;
        for (now_s, slot, place_m) in [(7.0, 0, 0.12), (7.05, 0, 0.125), (7.05, 2, 0.2), (8.5, 0, 0.13)] {
            assert!(recording.push(now_s, &mut begun_s, slot, place_m));
        }
        recording
    }

    #[test]
    fn a_recording_reads_back_as_it_was_written() {
        let text = sample().to_csv();
        assert!(Recording::is_one(&text) && !Recording::is_one("place_m,amplitude\n0,1\n"));
        let read = Recording::from_csv(&text).unwrap();
        assert_eq!(read.to_csv(), text);
        assert_eq!((read.moves().len(), read.duration_s()), (4, 1.5));
        // As spreadsheets write it where a comma is the decimal sign.
        let text = format!("\u{feff}{}", text.replace(',', ";").replace('.', ","));
        assert_eq!(Recording::from_csv(&text).unwrap(), read);
    }

    #[test]
    fn a_replay_yields_the_last_place_of_each_line() {
        let recording = sample();
        let due = |from_s, to_s| -> Vec<(u8, f64)> {
            recording.between(from_s, to_s).map(|step| (step.slot, step.place_m)).collect()
        };
        assert_eq!(due(-1.0, 0.0), [(0, 0.12)]);
        assert_eq!(due(0.0, 0.2), [(0, 0.125), (2, 0.2)]);
        assert_eq!(due(0.2, 1.0), []);
        assert_eq!(due(1.5, 9.0), [], "what was due at 1.5 s is not due again");
        assert_eq!(due(-1.0, 9.0), [(0, 0.13), (2, 0.2)]);
    }

    #[test]
    fn a_bad_file_is_refused_with_line_field_and_range() {
        let with = |line: &str| format!("{COLUMNS}\n# a comment\n0.5,1,0.1\n{line}\n");
        for (line, wanted) in [
            ("0.6,1", "line 4: 2 cells, but most rows have 3"),
            ("0.6,1,", "line 4: column 3 *place_m* = : must be a number. Write TIME,TONE,PLACE"),
            ("0.6,x,0.1", "line 4: column 2: \"x\" is no number"),
            ("601,1,0.1", "line 4: time_s = 601 s: must be 0 to 600 s"),
            ("nan,1,0.1", "line 4: column 1 *time_s* = nan"),
            ("0.6,1,inf", "line 4: column 3 *place_m* = inf"),
            ("0.6,17,0.1", "line 4: tone = 17: must be 1 to 16"),
            ("0.6,-9223372036854775808,0.1", "line 4"),
            ("0.4,1,0.1", "line 4: the times must not fall"),
        ] {
            let error = Recording::from_csv(&with(line)).unwrap_err().to_string();
            assert!(error.contains(wanted), "{line}: {error}");
        }
        assert!(Recording::from_csv(COLUMNS).is_err());
        let many = with(&"0.6,1,0.1\n".repeat(MOVES_MAX));
        assert!(Recording::from_csv(&many).unwrap_err().to_string().contains("20000"));
    }

    #[test]
    fn a_recording_is_bounded() {
        let (mut recording, mut begun_s) = (Recording::default(), None);
        assert!((0..MOVES_MAX).all(|_| recording.push(1.0, &mut begun_s, 0, 0.1)));
        assert!(!recording.push(1.0, &mut begun_s, 0, 0.1));
        let mut recording = Recording::default();
        assert!(recording.push(1.0, &mut begun_s, 0, 0.1) && !recording.push(602.0, &mut begun_s, 0, 0.1));
    }
}

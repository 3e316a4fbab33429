//! Lines of standard input that change a drive while it sounds.
//!
//! ```text
//! felt-edge 210mm        # the place of the first tone; further places are those of the next tones, as X[:LEVEL]
//! turning-point 160mm
//! level 0.5              # its level; a tone requested by its felt edge keeps that edge
//! glide 20ms             # how long the next changes take
//! stop
//! ```

use super::argument;
use super::failure::Failure;
use super::tones::{PlaceKind, ToneArgument, tone};
use slipline_model::atomic_file::said;
use slipline_model::setup::GLIDE_RANGE_S;
use slipline_plate::quantity::must_be;
use std::fmt::Display;
use std::io::{self, BufRead, Read as _};
use std::sync::mpsc::{Sender, SyncSender, sync_channel};
use std::thread::Builder;

/// Most bytes of a line.
const LONGEST: usize = 1000;
/// Most characters of a line that a refusal repeats.
const REPEATED: usize = 60;

/// What wakes a command that drives.
pub(super) enum Wake {
    /// A signal that ends it.
    Signal,
    /// A line, with its end if it is whole.
    Line(String),
    /// The lines have ended: the reason, if they cannot be read.
    End(Option<String>),
}

/// Reads the lines on a thread of its own, the next one only on request: lines that are not followed yet stay with the
/// program that writes it.
pub(super) struct InputLines(SyncSender<()>);

impl InputLines {
    /// Begins with the first line.
    pub(super) fn begin(wakes: Sender<Wake>) -> Result<Self, Failure> {
        let (asks, asked) = sync_channel(1);
        // It ends with the input or with the program.
        let read = move || {
            let mut input = io::stdin().lock();
            loop {
                let wake = match next(&mut input) {
                    Ok(Some(line)) => Wake::Line(line),
                    Ok(None) => Wake::End(None),
                    Err(error) => Wake::End(Some(said(&error))),
                };
                let is_end = matches!(wake, Wake::End(_));
                if wakes.send(wake).is_err() || is_end || asked.recv().is_err() {
                    return;
                }
            }
        };
        Builder::new().spawn(read).map_err(|error| Failure::Failed(said(&error)))?;
        Ok(Self(asks))
    }

    /// Asks for the next line.
    pub(super) fn ask(&self) {
        // The thread has gone after the last line.
        let _ = self.0.send(());
    }
}

/// The next line, `None` at the end. Of a line that is too long the rest is dropped.
fn next(input: &mut impl BufRead) -> io::Result<Option<String>> {
    let mut bytes = Vec::new();
    if input.by_ref().take(LONGEST as u64 + 1).read_until(b'\n', &mut bytes)? == 0 {
        return Ok(None);
    }
    let mut is_whole = bytes.len() <= LONGEST || bytes.last() == Some(&b'\n');
    while !is_whole {
        let buffer = input.fill_buf()?;
        let end = buffer.iter().position(|&byte| byte == b'\n');
        let count = end.map_or(buffer.len(), |end| end + 1);
        is_whole = end.is_some() || buffer.is_empty();
        input.consume(count);
    }
    Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
}

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Line {
    /// The places of the tones, in their order.
    Places(PlaceKind, Vec<ToneArgument>),
    /// Their levels, in the same order.
    Levels(Vec<f64>),
    /// How long the next changes take, in seconds.
    Glide(f64),
    /// The end of the drive.
    Stop,
}

impl Line {
    /// Reads a line; `None` for an empty one.
    pub(super) fn read(text: &str) -> Result<Option<Self>, Failure> {
        if text.len() > LONGEST {
            return Err(Failure::Usage(must_be("a line", format_args!("up to {LONGEST} bytes"))));
        }
        // The mark that some editors and shells put before a text.
        let mut words = text.strip_prefix('\u{feff}').unwrap_or(text).split_whitespace();
        let Some(word) = words.next() else { return Ok(None) };
        let values = with_units(words);
        let values: Vec<&str> = values.iter().map(String::as_str).collect();
        let places = |kind: PlaceKind| all(word, &values, tone).map(|places| Self::Places(kind, places));
        Ok(Some(match (word, &values[..]) {
            ("felt-edge", [_, ..]) => places(PlaceKind::FeltEdge)?,
            ("turning-point", [_, ..]) => places(PlaceKind::TurningPoint)?,
            ("level", [_, ..]) => Self::Levels(all(word, &values, argument::level)?),
            ("glide", [value]) => {
                let (low, high) = GLIDE_RANGE_S;
                Self::Glide(
                    argument::seconds(low, high)(value).map_err(|error| refused(word, value, &error))?,
                )
            }
            ("stop", []) => Self::Stop,
            _ => {
                let repeated = text.trim().chars().take(REPEATED).collect::<String>();
                let repeated = repeated.replace(char::is_control, "\u{fffd}");
                let allowed = "felt-edge PLACE, turning-point PLACE, level LEVEL, glide TIME or stop";
                return Err(Failure::Usage(must_be(format_args!("'{repeated}'"), allowed)));
            }
        }))
    }
}

/// The values of these words: a unit that stands alone belongs to the number before it, as in `0.21 m`.
fn with_units<'w>(words: impl Iterator<Item = &'w str>) -> Vec<String> {
    let mut values: Vec<String> = Vec::new();
    for word in words {
        match values.last_mut() {
            Some(number)
                if word.starts_with(|first: char| first.is_alphabetic() || first == '%')
                    && number.ends_with(|last: char| last.is_ascii_digit() || ".,".contains(last)) =>
            {
                number.push_str(word);
            }
            _ => values.push(word.to_owned()),
        }
    }
    values
}

/// All values of a line.
fn all<T, E: Display>(
    word: &str,
    values: &[&str],
    parse: impl Fn(&str) -> Result<T, E>,
) -> Result<Vec<T>, Failure> {
    values.iter().map(|value| parse(value).map_err(|error| refused(word, value, &error))).collect()
}

fn refused(word: &str, value: &str, error: &impl Display) -> Failure {
    let value = value.replace(char::is_control, "\u{fffd}");
    Failure::Usage(format!("invalid value '{value}' for '{word}': {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Option<Line>, String> {
        Line::read(text).map_err(|failure| failure.to_string())
    }

    #[test]
    fn a_line_is_a_word_and_its_values() {
        let places = |text: &str| vec![tone(text).expect("a tone")];
        assert_eq!(read("felt-edge 210mm\n"), Ok(Some(Line::Places(PlaceKind::FeltEdge, places("210mm")))));
        let two = [places("160mm"), places("105Hz:0.2")].concat();
        let turning = Line::Places(PlaceKind::TurningPoint, two);
        assert_eq!(read(" turning-point 160mm  105Hz:0.2\r\n"), Ok(Some(turning)));
        assert_eq!(read("level 0.5 1"), Ok(Some(Line::Levels(vec![0.5, 1.0]))));
        assert_eq!(read("glide 20ms"), Ok(Some(Line::Glide(0.02))));
        assert_eq!(read("stop"), Ok(Some(Line::Stop)));
        // With a blank before the unit, and with the mark before the text.
        assert_eq!(read("felt-edge 0.21 m"), Ok(Some(Line::Places(PlaceKind::FeltEdge, places("0.21m")))));
        let two = [places("12cm:50%"), places("0,1kHz")].concat();
        let spaced = Line::Places(PlaceKind::TurningPoint, two);
        assert_eq!(read("\u{feff}turning-point 12 cm:50 % 0,1 kHz"), Ok(Some(spaced)));
        assert_eq!(read("level -6 dB 50 % 1"), read("level -6dB 50% 1"));
        assert_eq!(read("glide 20 ms"), read("glide 0.02s"));
        assert_eq!(read(" \t\n"), Ok(None));
    }

    #[test]
    fn a_bad_line_is_refused_with_what_is_allowed() {
        for (text, words) in [
            ("felt-egde 210mm", "'felt-egde 210mm': must be felt-edge PLACE, turning-point PLACE"),
            ("felt-edge", "must be felt-edge PLACE"),
            ("stop now", "must be felt-edge PLACE"),
            ("glide 20ms 30ms", "glide TIME"),
            ("glide 1h", "invalid value '1h' for 'glide'"),
            ("glide 1ms", "5 ms to 10 s"),
            ("level 2", "invalid value '2' for 'level': must be 0 to 1"),
            ("level 0.5 x", "invalid value '0.5x' for 'level'"),
            ("turning-point 160mm:2", "its level"),
            ("\u{1b}[2J", "'\u{fffd}[2J'"),
        ] {
            let refusal = read(text).expect_err(text);
            assert!(refusal.contains(words), "{text}: {refusal}");
        }
    }

    #[test]
    fn a_line_without_end_is_dropped_to_its_end() {
        let long = format!("level 0.5{}9\nstop", " ".repeat(100_000));
        let mut input = io::BufReader::with_capacity(7, long.as_bytes());
        let mut line = || next(&mut input).expect("readable");
        let first = line().expect("a line");
        assert!(first.len() == LONGEST + 1, "{}", first.len());
        assert_eq!(read(&first), Err("a line: must be up to 1000 bytes".to_owned()));
        assert_eq!(line().as_deref(), Some("stop"));
        assert_eq!(line(), None);
    }
}

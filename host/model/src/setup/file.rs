//! Setups as TOML files, and plates opened as if they were setups.
//!
//! ```toml
//! slipline_setup = 1            # version of this format
//! master_db = -6.0              # -96 to 0 dB
//! glide_s = 0.02                # 0.005 to 10 s
//! chord_gain_db = 3.0           # only where all tones are multiples of the sample rate / 16384: 0 to 15 dB
//! [boundary]
//! holds = "felt-edge"           # or "turning-point"
//! [feeling]                     # each value may be left out; see slipline_plate::feeling
//! threshold = 1.0               # 0.01 to 100, in units of the threshold at the tone's frequency
//! friction_scale_m = 1e-6       # 1e-9 to 1e-3 m
//! friction_residual = 0.2       # 0 to 0.99
//! friction_exponent = 1.5       # 0.1 to 10
//! least_friction_change = 0.1   # 0.001 to 0.99
//! contact_m = 0.01              # 0 to 0.1 m
//! [[tones]]                     # 1 to 16
//! slot = 0                      # 0 to 15, each once
//! position_m = 0.16             # turning point, within the plate's span
//! level = 0.8                   # 0 to 1
//! phase_turns = 0.0             # 0 to 1
//! [plate]                       # a plate file
//! ```

pub mod feeling;
mod text;

use crate::setup::edit::{Edit, EditError, apply};
use crate::setup::{BoundaryMode, CHORD_GAIN_RANGE_DB, MAX_TONES, Setup, ToneSetup};
use slipline_plate::quantity::{Count, Counted, OutOfRange, Range, WrongCount, must_be};
use slipline_plate::{Plate, PlateFileError};
use std::sync::Arc;
pub use text::FeelingText;
use text::{BoundaryText, SetupText, ToneText};

/// The largest file that is read, in bytes: a plate file with every taper point fits.
pub const FILE_BYTES_MAX: usize = 1 << 20;
/// The version this program writes.
const VERSION: i64 = 1;

/// Why a file was refused. Nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum SetupFileError {
    /// The file is too large.
    #[error(transparent)]
    TooBig(WrongCount),
    /// Not TOML, or not of this form.
    #[error("line {line}: {message}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The parser's message.
        message: String,
    },
    /// A version that this program does not know.
    #[error("slipline_setup = {0}: this program reads version {VERSION}; install a newer one")]
    Version(i64),
    /// The plate in the file is refused.
    #[error("plate: {0}")]
    Plate(#[from] PlateFileError),
    /// A value is outside its range.
    #[error("{0}")]
    Value(#[from] EditError),
    /// A tone's place is not on the span of the file's plate.
    #[error("{0}, the plate's span")]
    OffSpan(#[source] OutOfRange),
    /// The number of tones is wrong.
    #[error(transparent)]
    Tones(WrongCount),
    /// A slot is out of range or used twice.
    #[error("tones: slot {0} is named twice or outside 0 to 15")]
    Slot(i64),
    /// The `holds` value is unknown.
    #[error("{}", must_be(format_args!("boundary.holds = {:?}", .0), "\"felt-edge\" or \"turning-point\""))]
    Holds(String),
}

/// A setup read from a file, or a plate read from one.
#[derive(Debug)]
pub enum Opened {
    /// A whole setup.
    Setup(Box<Setup>),
    /// A plate alone.
    Plate(Arc<Plate>),
}

/// Reads a setup or a plate from TOML text.
///
/// # Errors
/// [`SetupFileError`]: too big, not TOML, a field that is missing, unknown or out of range.
pub fn read(text: &str) -> Result<Opened, SetupFileError> {
    let allowed = Count::at_most(FILE_BYTES_MAX, Counted::Bytes);
    WrongCount::check("the file", text.len(), allowed).map_err(SetupFileError::TooBig)?;
    let table: toml::Table = toml::from_str(text).map_err(|fault| syntax(text, &fault))?;
    // Recognized by keys that only a setup has, so that a plate file with misspelt sections still gets the
    // errors of a plate file.
    let is_setup =
        ["slipline_setup", "tones", "plate", "boundary"].iter().any(|key| table.contains_key(*key));
    if !is_setup {
        return Ok(Opened::Plate(Arc::new(Plate::from_toml(text)?)));
    }
    // Checked first, because fields of another version are not mistakes in the file.
    if let Some(version) = table.get("slipline_setup").and_then(toml::Value::as_integer)
        && version != VERSION
    {
        return Err(SetupFileError::Version(version));
    }
    let parsed: SetupText = toml::from_str(text).map_err(|fault| syntax(text, &fault))?;
    build(parsed).map(|setup| Opened::Setup(Box::new(setup)))
}

/// The parser's refusal of a text, with its line.
fn syntax(text: &str, fault: &toml::de::Error) -> SetupFileError {
    let start = fault.span().map_or(0, |span| span.start.min(text.len()));
    let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
    // A field of a plate has words for what it must be.
    let is_setup = text.lines().any(|line| line.trim_start().starts_with("[plate"));
    let of_plate = if is_setup { plate_lines(text) } else { text.to_owned() };
    let message = match Plate::from_toml(&of_plate) {
        Err(PlateFileError::Syntax { line: of_plate, message }) if of_plate == line => message,
        _ => fault.message().trim().to_owned(),
    };
    SetupFileError::Syntax { line, message }
}

/// The sections of a setup's plate as those of a plate file, on the same lines; the other lines are empty.
fn plate_lines(text: &str) -> String {
    let mut is_of_plate = false;
    let mut of_plate = |line: &str| {
        let line = line.trim_start();
        if line.starts_with('[') {
            is_of_plate = line.starts_with("[plate]") || line.starts_with("[plate.");
            return line.strip_prefix("[plate.").map_or_else(String::new, |section| format!("[{section}"));
        }
        if is_of_plate { line.to_owned() } else { String::new() }
    };
    text.lines().map(&mut of_plate).collect::<Vec<_>>().join("\n")
}

fn build(parsed: SetupText) -> Result<Setup, SetupFileError> {
    let plate_text = toml::to_string(&parsed.plate).unwrap_or_default();
    // The line number belongs to the rewritten text and would mislead.
    let plate = Arc::new(Plate::from_toml(&plate_text).map_err(PlateFileError::without_line)?);
    let allowed = Count::new(1, MAX_TONES, Counted::Tones);
    WrongCount::check("the setup", parsed.tones.len(), allowed).map_err(SetupFileError::Tones)?;
    let mut setup = Setup { tones: Vec::new(), ..Setup::new(plate) };
    let mut edits = vec![Edit::Master(parsed.master_db), Edit::Glide(parsed.glide_s)];
    for tone in &parsed.tones {
        let slot = u8::try_from(tone.slot)
            .ok()
            .filter(|&slot| usize::from(slot) < MAX_TONES && setup.tone(slot).is_none())
            .ok_or(SetupFileError::Slot(tone.slot))?;
        let (start, end) = setup.plate.span_m();
        OutOfRange::check("tones.position_m", tone.position_m, Range::new(start, end, "m"))
            .map_err(SetupFileError::OffSpan)?;
        setup.tones.push(ToneSetup { slot, position_m: tone.position_m, level: 0.0, phase_turns: 0.0 });
        edits.push(Edit::Level { slot, level: tone.level });
        edits.push(Edit::Phase { slot, turns: tone.phase_turns });
    }
    edits.push(Edit::Boundary(match parsed.boundary.holds.as_str() {
        "turning-point" => BoundaryMode::TurningPoint,
        "felt-edge" => BoundaryMode::FeltEdge,
        other => return Err(SetupFileError::Holds(other.chars().take(40).collect())),
    }));
    edits.push(Edit::Feeling(parsed.feeling.into()));
    for edit in &edits {
        setup = apply(&setup, edit)?;
    }
    if let Some(gain_db) = parsed.chord_gain_db {
        let (low, high) = CHORD_GAIN_RANGE_DB;
        OutOfRange::check("chord_gain_db", gain_db, Range::new(low, high, "dB"))
            .map_err(|error| SetupFileError::Value(EditError::OutOfRange(error)))?;
    }
    setup.chord_gain_db = parsed.chord_gain_db;
    Ok(setup)
}

/// The setup as TOML text that [`read`] reads back to the same setup.
#[must_use]
pub fn write(setup: &Setup) -> String {
    let tone = |&ToneSetup { slot, position_m, level, phase_turns }: &ToneSetup| ToneText {
        slot: slot.into(),
        position_m,
        level,
        phase_turns,
    };
    let tones = setup.tones.iter().map(tone).collect();
    let text = SetupText {
        slipline_setup: VERSION,
        master_db: setup.master_db,
        glide_s: setup.glide_s,
        chord_gain_db: setup.chord_gain_db,
        boundary: BoundaryText { holds: setup.boundary.word().to_owned() },
        feeling: setup.feeling.into(),
        tones,
        plate: toml::from_str(&setup.plate.to_toml()).unwrap_or_default(),
    };
    toml::to_string(&text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use slipline_plate::feeling::Feeling;

    fn sample() -> Setup {
        let mut setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        for edit in [
            Edit::Add { position_m: 0.12 },
            Edit::Level { slot: 1, level: 0.25 },
            Edit::Phase { slot: 1, turns: 0.5 },
            Edit::Master(-6.5),
            Edit::Glide(0.1),
            Edit::Boundary(BoundaryMode::TurningPoint),
            Edit::Feeling(Feeling { threshold: 2.0, contact_m: 0.008, ..Feeling::default() }),
        ] {
            setup = apply(&setup, &edit).unwrap();
        }
        setup
    }

    fn setup_of(text: &str) -> Result<Setup, SetupFileError> {
        read(text).map(|opened| match opened {
            Opened::Setup(setup) => *setup,
            Opened::Plate(_) => panic!("a setup was wanted"),
        })
    }

    #[test]
    fn a_setup_reads_back_as_it_was_written() {
        let setup = sample();
        assert_eq!(setup_of(&write(&setup)).unwrap(), setup);
        let chord = Setup { chord_gain_db: Some(3.25), ..setup };
        assert_eq!(setup_of(&write(&chord)).unwrap(), chord);
        for (edit, is_chord) in [(Edit::Master(-3.0), true), (Edit::Level { slot: 1, level: 0.2 }, false)] {
            assert_eq!(apply(&chord, &edit).unwrap().chord_gain_db.is_some(), is_chord);
        }
        for preset in slipline_plate::presets() {
            let setup = Setup::new(Arc::new(preset.plate().unwrap()));
            assert_eq!(setup_of(&write(&setup)).unwrap(), setup, "{}", preset.name);
        }
    }

    #[test]
    fn a_plate_file_opens_as_a_plate() {
        let preset = slipline_plate::presets()[1];
        assert!(
            matches!(read(preset.toml), Ok(Opened::Plate(plate)) if plate.name() == preset.plate().unwrap().name())
        );
    }

    #[test]
    fn a_decimal_comma_is_refused_in_the_same_words_as_a_plate_file_and_in_a_setup() {
        let plate = slipline_plate::presets()[0].toml;
        let broken = plate.replacen("length_m = 0.", "length_m = 0,", 1);
        assert_ne!(broken, plate);
        let of_plate = Plate::from_toml(&broken).unwrap_err().to_string();
        for part in ["length_m = 0,", "with a decimal point", " to ", "m"] {
            assert!(of_plate.contains(part), "{part}: {of_plate}");
        }
        assert_eq!(read(&broken).unwrap_err().to_string(), of_plate);
        let words = |text: &str| text.split_once(": ").map(|(_, words)| words.to_owned());
        let setup = write(&sample()).replacen("length_m = 0.", "length_m = 0,", 1);
        let of_setup = read(&setup).unwrap_err().to_string();
        assert!(words(&of_setup).is_some_and(|words| words.starts_with("length_m = 0,")), "{of_setup}");
        // A field of the setup itself keeps the parser's words.
        let tone = write(&sample()).replacen("level = 0.", "level = 0,", 1);
        assert!(!read(&tone).unwrap_err().to_string().contains("decimal point"));
    }

    #[test]
    fn a_mistyped_plate_file_gets_the_fields_of_plates_and_a_setup_those_of_setups() {
        let plate = slipline_plate::presets()[0].toml;
        let setup = write(&sample());
        for (text, from, to, want) in [
            (plate, "[taper]", "[tapper]", "did you mean [taper]?"),
            (plate, "length_m", "lenght_m", "did you mean length_m?"),
            (&setup, "slipline_setup", "slipline_setap", "unknown field `slipline_setap`"),
            (&setup, "slipline_setup = 1\n", "", "missing field `slipline_setup`"),
            (&setup, "[plate]", "[plait]", "unknown field `plait`"),
        ] {
            assert!(text.contains(from), "{from}");
            let error = read(&text.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.contains(want), "{to}: {error}");
        }
    }

    #[test]
    fn a_file_of_a_newer_version_asks_for_a_newer_program_whatever_else_it_has() {
        let newer = write(&sample()).replacen("slipline_setup = 1", "slipline_setup = 2\nstrange = true", 1);
        let error = setup_of(&newer).unwrap_err().to_string();
        assert!(error.contains("install a newer one"), "{error}");
    }

    #[test]
    fn a_bad_value_is_named_with_its_range() {
        let good = write(&sample());
        for (from, to, want) in [
            ("master_db = -6.5", "master_db = 6.5", "master level"),
            ("master_db = -6.5", "master_db = nan", "master level"),
            ("glide_s = 0.1", "glide_s = inf", "glide"),
            ("glide_s = 0.1", "glide_s = 0.1\nchord_gain_db = 16.0", "chord_gain_db"),
            ("glide_s = 0.1", "glide_s = 0.1\nchord_gain_db = nan", "chord_gain_db"),
            ("level = 0.25", "level = 25.0", "level"),
            ("position_m = 0.12", "position_m = 9.0", "tones.position_m"),
            ("position_m = 0.12", "position_m = nan", "tones.position_m"),
            ("slot = 1", "slot = 0", "slot 0"),
            ("slot = 1", "slot = 99", "slot 99"),
            ("holds = \"turning-point\"", "holds = \"x\"", "felt-edge"),
            ("threshold = 2.0", "threshold = 0.0", "feeling.threshold"),
            ("contact_m = 0.008", "contact_m = nan", "feeling.contact_m"),
            ("slipline_setup = 1", "slipline_setup = 7", "version 1"),
            ("glide_s = 0.1", "glyde_s = 0.1", "glyde_s"),
            ("loss_factor = ", "loss_factor = 9", "loss_factor"),
        ] {
            assert!(good.contains(from), "{from} is not in\n{good}");
            let error = setup_of(&good.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.contains(want), "{to}: {error}");
        }
        assert!(setup_of("\n\nnonsense").unwrap_err().to_string().starts_with("line 3"));
        assert!(matches!(read(&" ".repeat(FILE_BYTES_MAX + 1)), Err(SetupFileError::TooBig { .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn damaged_files_never_panic(at in 0usize..900, byte in 0u8..128, cut in 0usize..900) {
            let mut bytes = write(&sample()).into_bytes();
            let length = bytes.len();
            bytes[at % length] = byte;
            bytes.truncate(length - cut % length);
            let _ = read(&String::from_utf8_lossy(&bytes));
        }
    }
}

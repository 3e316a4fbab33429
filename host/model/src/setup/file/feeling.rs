//! A finger's feeling as a TOML file: that of a setup file, or alone.
//!
//! ```toml
//! [feeling]            # each value may be left out; ranges: the setup file's
//! threshold = 1.6
//! contact_m = 0.008
//! ```

use super::text::FeelingText;
use super::{FILE_BYTES_MAX, Opened, SetupFileError, syntax};
use crate::setup::edit::EditError;
use serde::{Deserialize, Serialize};
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::{Count, Counted, WrongCount};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FeelingFile {
    feeling: FeelingText,
}

/// Reads the feeling of a file that holds it alone, or of a setup file.
///
/// # Errors
/// [`SetupFileError`]: too big, not TOML, a field that is missing, unknown or out of range.
pub fn read(text: &str) -> Result<Feeling, SetupFileError> {
    let allowed = Count::at_most(FILE_BYTES_MAX, Counted::Bytes);
    WrongCount::check("the file", text.len(), allowed).map_err(SetupFileError::TooBig)?;
    let table: toml::Table = toml::from_str(text).map_err(|fault| syntax(text, &fault))?;
    if table.contains_key("slipline_setup")
        && let Opened::Setup(setup) = super::read(text)?
    {
        return Ok(setup.feeling);
    }
    let file: FeelingFile = toml::from_str(text).map_err(|fault| syntax(text, &fault))?;
    let checked = Feeling::from(file.feeling).checked();
    checked.map_err(|error| SetupFileError::Value(EditError::OutOfRange(error)))
}

/// The feeling as TOML text that [`read`] reads back to the same feeling.
#[must_use]
pub fn write(feeling: &Feeling) -> String {
    toml::to_string(&FeelingFile { feeling: (*feeling).into() }).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Setup;
    use std::sync::Arc;

    #[test]
    fn a_feeling_reads_back_alone_and_from_a_setup() {
        let feeling = Feeling { threshold: 1.625, contact_m: 0.008, ..Feeling::default() };
        assert_eq!(read(&write(&feeling)).unwrap(), feeling);
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let setup = Setup { feeling, ..Setup::new(plate) };
        assert_eq!(read(&super::super::write(&setup)).unwrap(), feeling);
        assert_eq!(read("[feeling]\n").unwrap(), Feeling::default());
    }

    #[test]
    fn a_bad_feeling_is_named_with_its_range() {
        for (text, want) in [
            ("", "missing field `feeling`"),
            ("[feeling]\nthreshhold = 1.0", "threshhold"),
            ("[feeling]\nthreshold = 0.0", "feeling.threshold"),
            ("[feeling]\ncontact_m = nan", "feeling.contact_m"),
            ("[feeling]\n[other]\n", "other"),
            ("feeling = 3\n", "line 1"),
            ("slipline_setup = 1\n", "missing field"),
            (slipline_plate::presets()[0].toml, "unknown field"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(want), "{text:.60}: {error}");
        }
        assert!(matches!(read(&" ".repeat(FILE_BYTES_MAX + 1)), Err(SetupFileError::TooBig(_))));
    }
}

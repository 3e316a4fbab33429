//! The feeling of a finger by which felt edges are computed, and where it is from.

use slipline_model::answer::feeling::FeelingAnswer;
use slipline_model::setup::Setup;
use slipline_model::setup::file::{SetupFileError, feeling};
use slipline_plate::feeling::Feeling;

/// A feeling and its file. The default is that of a usual finger.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedFeeling {
    /// The feeling.
    pub feeling: Feeling,
    /// Its file; `None` for the default.
    pub from: Option<String>,
}

impl NamedFeeling {
    /// The feeling of a file's text.
    ///
    /// # Errors
    /// [`SetupFileError`]: what is wrong with the text.
    pub fn read(text: &str, file: String) -> Result<Self, SetupFileError> {
        Ok(Self { feeling: feeling::read(text)?, from: Some(file) })
    }

    /// The feeling of a setup's file.
    #[must_use]
    pub fn of_setup(setup: &Setup, file: String) -> Self {
        Self { feeling: setup.feeling, from: Some(file) }
    }

    /// It and its source as a sentence.
    #[must_use]
    pub fn words(&self) -> String {
        let from = self.from.as_ref().map_or_else(|| "a usual finger".to_owned(), |path| format!("{path:?}"));
        format!("Felt edges are those of {from} (illustrative).")
    }

    /// Its source and values as fields.
    #[must_use]
    pub fn answer(&self) -> FeelingAnswer<'_> {
        FeelingAnswer::of(&self.feeling, self.from.as_deref())
    }
}

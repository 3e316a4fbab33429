//! The feeling of a finger by which felt edges are computed, and where it is from.

use super::Failure;
use super::source::read_text;
use clap::Args;
use slipline_model::answer::feeling::FeelingAnswer;
use slipline_model::atomic_file::said;
use slipline_model::setup::Setup;
use slipline_model::setup::file::{FILE_BYTES_MAX, feeling};
use slipline_plate::feeling::Feeling;
use std::path::{Path, PathBuf};

/// The file of a feeling.
#[derive(Debug, Args)]
pub(super) struct FeelingArgument {
    /// The finger's feeling by which felt edges are computed, from a setup file or from a file of
    /// `calibrate --feeling-out`; by default, that of a usual finger. All values are illustrative.
    #[arg(long, value_name = "FEELING.toml")]
    feeling: Option<PathBuf>,
}

impl FeelingArgument {
    /// The feeling of the file, else the default.
    pub(super) fn read(&self) -> Result<NamedFeeling, Failure> {
        let Some(path) = &self.feeling else { return Ok(NamedFeeling::usual()) };
        let refused = |message: String| Failure::Usage(format!("{}: {message}", path.display()));
        let text = read_text(path, FILE_BYTES_MAX).map_err(|error| refused(said(&error)))?;
        let feeling = feeling::read(&text).map_err(|error| Failure::in_file(path, error))?;
        Ok(NamedFeeling { feeling, from: Some(path.display().to_string()) })
    }
}

/// A feeling and its source.
#[derive(Clone, Debug)]
pub(super) struct NamedFeeling {
    pub(super) feeling: Feeling,
    /// Its file; `None` for the default.
    from: Option<String>,
}

impl NamedFeeling {
    /// That of a usual finger.
    fn usual() -> Self {
        Self { feeling: Feeling::default(), from: None }
    }

    /// That of a setup's file.
    pub(super) fn of_setup(setup: &Setup, path: &Path) -> Self {
        Self { feeling: setup.feeling, from: Some(path.display().to_string()) }
    }

    /// It and its source as a sentence.
    pub(super) fn words(&self) -> String {
        let from = self.from.as_ref().map_or_else(|| "a usual finger".to_owned(), |path| format!("{path:?}"));
        format!("Felt edges are those of {from} (illustrative).")
    }

    /// Its source and values as fields.
    pub(super) fn answer(&self) -> FeelingAnswer<'_> {
        FeelingAnswer::of(&self.feeling, self.from.as_deref())
    }

    /// Its file.
    pub(super) fn from(&self) -> Option<&str> {
        self.from.as_deref()
    }
}

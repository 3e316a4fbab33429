//! `--feeling`: the feeling of a finger by which felt edges are computed.

use super::failure::Failure;
use super::source::text_of;
use clap::Args;
use slipline_instrument::requests::NamedFeeling;
use slipline_model::setup::file::FILE_BYTES_MAX;
use std::path::PathBuf;

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
        let Some(path) = &self.feeling else { return Ok(NamedFeeling::default()) };
        let text = text_of(path, FILE_BYTES_MAX)?;
        NamedFeeling::read(&text, path.display().to_string()).map_err(|error| Failure::in_file(path, error))
    }
}

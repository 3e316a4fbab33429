//! Choosing, reading and writing files off the UI thread.

#[cfg(not(target_arch = "wasm32"))]
#[cfg_attr(
    all(not(test), target_os = "linux"),
    expect(clippy::disallowed_methods, reason = "the system's environment")
)]
mod native;
#[cfg(not(target_arch = "wasm32"))]
#[cfg_attr(
    not(test),
    expect(clippy::disallowed_methods, reason = "the system's files, each job on its own thread")
)]
mod system;

#[cfg(not(target_arch = "wasm32"))]
pub use system::SystemFiles;

use slipline_model::content::Content;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// A file to save: its content and the name that is offered.
#[derive(Clone, Debug)]
pub struct Save {
    /// The name offered.
    pub name: String,
    /// The kind of file, as the dialog shows it.
    pub kind: &'static str,
    /// The extension, without a dot.
    pub extension: &'static str,
    /// The bytes.
    pub bytes: Arc<[u8]>,
}

/// Something to do with files.
#[derive(Clone, Debug)]
pub enum FileJob {
    /// Let the user choose a file and read it.
    Choose,
    /// Read this file.
    Open(PathBuf),
    /// Let the user choose a file of a measurement and read it.
    ChooseMeasurement,
    /// Read this file of a measurement.
    OpenMeasurement(PathBuf),
    /// Let the user choose a profile (CSV or PNG) and read it.
    ChooseProfile,
    /// Read this profile.
    OpenProfile(PathBuf),
    /// Let the user choose a path, and write to it.
    Save(Save),
    /// Let the user choose a folder and write these files (name, text) into it.
    SaveFolder(Vec<(String, String)>),
    /// Write to this path.
    SaveAs {
        /// The path.
        path: PathBuf,
        /// The content.
        save: Save,
        /// Whether an existing file is replaced.
        may_replace: bool,
    },
    /// Write these files (name, text) into this folder.
    SaveInto(PathBuf, Vec<(String, String)>),
}

impl FileJob {
    /// Whether the user is asked for a path, in a dialog of the system.
    #[must_use]
    pub fn needs_dialog(&self) -> bool {
        matches!(
            self,
            Self::Choose
                | Self::ChooseMeasurement
                | Self::ChooseProfile
                | Self::Save(_)
                | Self::SaveFolder(_)
        )
    }
}

/// The extensions of profiles: breakpoints, and images whose middle row is one.
pub const PROFILE_EXTENSIONS: [&str; 2] = ["csv", "png"];

/// The extensions of measurements by other programs, which are never a setup or a plate: text of REW, tables, universal files,
/// recordings of the sweep.
pub const MEASUREMENT_EXTENSIONS: [&str; 14] =
    ["txt", "frd", "uff", "unv", "wav", "flac", "m4a", "aif", "aiff", "aifc", "tsv", "dat", "asc", "prn"];

/// The extensions of all that can be opened: setups, plates, recorded drags, measurements. A measurement has all of them, too:
/// a description of a sweep is TOML and belongs to a recording.
#[must_use]
pub fn openable_extensions() -> Vec<&'static str> {
    [&["toml", "csv"][..], &MEASUREMENT_EXTENSIONS].concat()
}

/// Whether a file of this name is a measurement by another program.
#[must_use]
pub fn is_measurement(path: &Path) -> bool {
    has_extension(path, &MEASUREMENT_EXTENSIONS)
}

/// What a file of any kind is: a measurement by its name, or by bytes that are no text, which are then called what they are;
/// else the text that `text` makes of them.
pub fn opened(
    path: PathBuf,
    bytes: Result<Vec<u8>, FileError>,
    text: impl FnOnce(Vec<u8>) -> Result<String, FileError>,
) -> FileEvent {
    match bytes {
        Ok(bytes) if is_measurement(&path) || Content::of(&bytes) != Content::Other => {
            FileEvent::Measurement(path, Ok(bytes))
        }
        bytes => FileEvent::Opened(path, bytes.and_then(text)),
    }
}

/// Whether the name ends with one of these, in small or capital letters.
#[must_use]
pub fn has_extension(path: &Path, known: &[&str]) -> bool {
    path.extension().is_some_and(|extension| known.iter().any(|known| extension.eq_ignore_ascii_case(known)))
}

/// Why a file was not read or written.
#[derive(Clone, Debug, Error)]
pub enum FileError {
    /// The system's reason.
    #[cfg(not(target_arch = "wasm32"))]
    #[error("{}", slipline_model::atomic_file::said(.0))]
    System(Arc<std::io::Error>),
    /// The browser's reason.
    #[cfg(target_arch = "wasm32")]
    #[error("{0}")]
    Browser(String),
    /// It is too large to be read.
    #[cfg(target_arch = "wasm32")]
    #[error("it has {bytes} bytes, more than the {most} that are read")]
    TooBig {
        /// Its size.
        bytes: u64,
        /// The largest size.
        most: usize,
    },
    /// The folder of the file does not exist.
    #[error("{0}")]
    NoFolder(String),
    /// A folder holds a file of this name, and it may not be replaced.
    #[error("{0} exists already: choose another folder")]
    Exists(String),
}

#[cfg(not(target_arch = "wasm32"))]
impl From<std::io::Error> for FileError {
    fn from(error: std::io::Error) -> Self {
        Self::System(Arc::new(error))
    }
}

/// The result of a job.
#[derive(Clone, Debug)]
pub enum FileEvent {
    /// A file was read, or the reason why not.
    Opened(PathBuf, Result<String, FileError>),
    /// A file of a measurement was read, or the reason why not.
    Measurement(PathBuf, Result<Vec<u8>, FileError>),
    /// A profile was read, or the reason why not.
    Profile(PathBuf, Result<Vec<u8>, FileError>),
    /// A file was written, or the reason why not.
    Saved(PathBuf, Result<(), FileError>),
    /// The system has no dialog to choose a path for this job.
    NoDialog(FileJob),
    /// A file of that name exists and may not be replaced.
    Exists(PathBuf, Save),
}

/// The app's access to files.
pub trait Files {
    /// Begins a job; returns at once.
    fn begin(&mut self, job: FileJob);
    /// The next finished job, if any.
    fn take(&mut self) -> Option<FileEvent>;
}

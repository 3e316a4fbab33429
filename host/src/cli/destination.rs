//! Files that a command writes: none that is there is lost unasked, and none is left half-written.

use super::Failure;
use clap::Args;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once, PoisonError};

/// Whether files may be replaced.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct ForceArgument {
    /// Replace files that are there already; without it, nothing is done if one is.
    #[arg(long)]
    pub(super) force: bool,
}

/// A file to be written: looked at before the work begins, so that no work is done in vain.
#[derive(Debug)]
pub(super) struct Destination {
    path: PathBuf,
    /// A pipe or a device: nothing to replace, and nothing to put in its place.
    is_stream: bool,
}

/// The file that is being written under its temporary name, for Ctrl-C to remove.
static PART: Mutex<Option<PathBuf>> = Mutex::new(None);

impl Destination {
    /// A file that may be written.
    pub(super) fn new(path: &Path, may_replace: ForceArgument) -> Result<Self, Failure> {
        let name = path.display();
        match path.metadata() {
            Ok(found) if found.is_dir() => {
                Err(Failure::Usage(format!("{name} is a folder: name a file in it")))
            }
            Ok(found) if found.is_file() && !may_replace.force => Err(Failure::Usage(format!(
                "{name} exists: write --force to replace it, or name another file"
            ))),
            Ok(found) if found.is_file() => {
                // What a link leads to is replaced, not the link.
                let path = path.canonicalize().map_err(|error| failed(path, &error))?;
                Ok(Self { path, is_stream: false })
            }
            Ok(_) => Ok(Self { path: path.to_owned(), is_stream: true }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                match path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
                    Some(folder) => {
                        Err(Failure::Failed(format!("{name}: there is no folder {}", folder.display())))
                    }
                    None => Ok(Self { path: path.to_owned(), is_stream: false }),
                }
            }
            Err(error) => Err(failed(path, &error)),
        }
    }

    /// A file that is asked for or not.
    pub(super) fn perhaps(path: Option<&Path>, may_replace: ForceArgument) -> Result<Option<Self>, Failure> {
        path.map(|path| Self::new(path, may_replace)).transpose()
    }

    /// A folder, made if it is not there, in which none of these files is (or may be replaced).
    pub(super) fn folder(
        folder: &Path,
        names: &[&str],
        may_replace: ForceArgument,
    ) -> Result<Vec<Self>, Failure> {
        let name = folder.display();
        if folder.exists() && !folder.is_dir() {
            return Err(Failure::Usage(format!("{name} is a file: name a folder")));
        }
        let there: Vec<&str> = names.iter().copied().filter(|name| folder.join(name).exists()).collect();
        if !there.is_empty() && !may_replace.force {
            let there = there.join(", ");
            return Err(Failure::Usage(format!(
                "{name} holds {there} already: write --force to replace what is there, or name another folder"
            )));
        }
        std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
        names.iter().map(|name| Self::new(&folder.join(name), may_replace)).collect()
    }

    /// Whether two of them are one file, however its path was written.
    pub(super) fn is(&self, other: &Self) -> bool {
        let place = |path: &Path| {
            let folder =
                path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            (folder.canonicalize().ok(), path.file_name().map(ToOwned::to_owned))
        };
        !self.is_stream && place(&self.path) == place(&other.path)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes it through `write`: under another name first, so that the old file is there until the new one is whole.
    pub(super) fn write(
        &self,
        write: impl FnOnce(&mut BufWriter<File>) -> anyhow::Result<()>,
    ) -> Result<(), Failure> {
        let failed = |error: anyhow::Error| failed(&self.path, &error);
        let whole = |file: File| -> anyhow::Result<()> {
            let mut out = BufWriter::new(file);
            write(&mut out)?;
            Ok(out.flush()?)
        };
        if self.is_stream {
            return File::create(&self.path).map_err(anyhow::Error::from).and_then(whole).map_err(failed);
        }
        let mut name = self.path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let part = self.path.with_file_name(name);
        begin(&part);
        let written = File::create(&part)
            .map_err(anyhow::Error::from)
            .and_then(whole)
            .and_then(|()| Ok(std::fs::rename(&part, &self.path)?));
        *PART.lock().unwrap_or_else(PoisonError::into_inner) = None;
        written.map_err(|error| {
            // It may not even have been made.
            let _ = std::fs::remove_file(&part);
            failed(error)
        })
    }
}

/// From now on Ctrl-C removes this file.
fn begin(part: &Path) {
    static WATCH: Once = Once::new();
    *PART.lock().unwrap_or_else(PoisonError::into_inner) = Some(part.to_owned());
    WATCH.call_once(|| {
        // Without a handler Ctrl-C still ends the program; only the part is left.
        let _ = ctrlc::set_handler(|| {
            if let Some(part) = PART.lock().unwrap_or_else(PoisonError::into_inner).take() {
                let _ = std::fs::remove_file(part);
            }
            // What a shell gives a program that Ctrl-C ended.
            std::process::exit(130);
        });
    });
}

fn failed(path: &Path, error: &impl fmt::Display) -> Failure {
    Failure::Failed(format!("{}: {}", path.display(), said(error)))
}

/// What the system says, without its number.
pub(super) fn said(error: &impl fmt::Display) -> String {
    let sentence = error.to_string();
    sentence.split(" (os error").next().unwrap_or_default().to_lowercase()
}

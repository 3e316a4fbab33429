//! Files that a command writes; `-` is standard output. An existing file is never replaced without permission.

use super::failure::Failure;
use super::output;
use clap::Args;
use slipline_model::atomic_file::{self, STANDARD_STREAM, said};
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether files may be replaced.
#[derive(Clone, Copy, Debug, Default, Args)]
#[command(next_help_heading = "Output")]
pub struct ForceArgument {
    /// Replace existing files; without it, the command writes nothing if one exists.
    #[arg(long)]
    pub(super) force: bool,
}

/// A file to write. It is checked before the computation begins, so that no computation is wasted.
#[derive(Debug)]
pub(super) struct Destination {
    path: PathBuf,
    /// Whether an existing file may be replaced: by permission, or because this command has written it.
    may_replace: AtomicBool,
}

impl Destination {
    /// A file that may be written.
    pub(super) fn new(path: &Path, may_replace: ForceArgument) -> Result<Self, Failure> {
        if path == Path::new(STANDARD_STREAM) {
            output::take()?;
            return Ok(Self::at(path, may_replace));
        }
        let name = path.display();
        if output::is_trace(path) {
            return Err(Failure::Usage(format!("{name} is the file of --trace: name another file")));
        }
        match path.metadata() {
            Ok(found) if found.is_dir() => {
                Err(Failure::Usage(format!("{name} is a folder: name a file in it")))
            }
            Ok(found) if found.is_file() && !may_replace.force => Err(Failure::Usage(format!(
                "{name} exists: write --force to replace it, or name another file"
            ))),
            Ok(_) => Ok(()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                match atomic_file::missing_folder(path) {
                    Some(reason) => Err(Failure::Failed(format!("{name}: {reason}"))),
                    None if path.is_symlink() && !may_replace.force => Err(Failure::Usage(format!(
                        "{name} is a link to a file that is missing: write --force to replace the link, or name another file"
                    ))),
                    None => Ok(()),
                }
            }
            Err(error) => Err(failed(path, &error)),
        }?;
        // By trying: permissions alone do not show whether a file system can be written.
        atomic_file::try_to_write(path).map_err(|error| failed(path, &error))?;
        Ok(Self::at(path, may_replace))
    }

    fn at(path: &Path, may_replace: ForceArgument) -> Self {
        Self { path: path.to_owned(), may_replace: AtomicBool::new(may_replace.force) }
    }

    /// An optional file.
    pub(super) fn perhaps(path: Option<&Path>, may_replace: ForceArgument) -> Result<Option<Self>, Failure> {
        path.map(|path| Self::new(path, may_replace)).transpose()
    }

    /// The files in a folder, which is created if needed. An error if one of them exists and may not be replaced.
    pub(super) fn folder(
        folder: &Path,
        names: &[&str],
        may_replace: ForceArgument,
    ) -> Result<Vec<Self>, Failure> {
        let name = folder.display();
        if folder == Path::new(STANDARD_STREAM) {
            return Err(Failure::usage("several files do not fit standard output: name a folder"));
        }
        if folder.exists() && !folder.is_dir() {
            return Err(Failure::Usage(format!("{name} is a file: name a folder")));
        }
        let there: Vec<&str> = names.iter().copied().filter(|name| is_there(&folder.join(name))).collect();
        if !there.is_empty() && !may_replace.force {
            let there = there.join(", ");
            return Err(Failure::Usage(format!(
                "{name} holds {there} already: write --force to replace it, or name another folder"
            )));
        }
        std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
        names.iter().map(|name| Self::new(&folder.join(name), may_replace)).collect()
    }

    /// Whether both are the same file, even if their paths are written differently.
    pub(super) fn is(&self, other: &Self) -> bool {
        let place = |path: &Path| {
            let folder =
                path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let in_folder = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
            // A file that does not exist yet is identified by its folder and name.
            path.canonicalize().ok().or_else(in_folder)
        };
        !atomic_file::is_stream(&self.path) && place(&self.path) == place(&other.path)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is standard output.
    pub(super) fn is_standard_output(&self) -> bool {
        self.path == Path::new(STANDARD_STREAM)
    }

    /// The names of written files, for the JSON.
    pub(super) fn names<'a>(files: impl IntoIterator<Item = &'a Self>) -> Vec<String> {
        files.into_iter().map(|file| file.path.display().to_string()).collect()
    }

    /// Writes a measurement, which cannot be repeated exactly. If the file cannot be written any more, the text goes to a
    /// file among the temporary ones, which the error names.
    pub(super) fn write_measured(&self, text: &str) -> Result<(), Failure> {
        let Err(why) = self.write(|out| Ok(out.write_all(text.as_bytes())?)) else { return Ok(()) };
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let kept = std::env::temp_dir().join(format!("slipline-{}-{name}", std::process::id()));
        let into = atomic_file::write(&kept, |out| -> io::Result<()> { out.write_all(text.as_bytes()) });
        Err(Failure::Failed(match into {
            Ok(()) => format!("{why}; what was measured is in {}", kept.display()),
            Err(again) => format!("{why}; {}: {}", kept.display(), said(&again)),
        }))
    }

    /// Writes the file through `write`: completely or not at all.
    pub(super) fn write(
        &self,
        write: impl FnOnce(&mut BufWriter<&File>) -> anyhow::Result<()>,
    ) -> Result<(), Failure> {
        let written = if self.is_standard_output() {
            output::write(write)
        } else if self.may_replace.load(Ordering::Relaxed) {
            atomic_file::write(&self.path, write)
        } else {
            atomic_file::create(&self.path, write)
        };
        written.map_err(|error| match error.downcast_ref::<io::Error>().map(io::Error::kind) {
            Some(io::ErrorKind::AlreadyExists) => Failure::Failed(format!(
                "{} was created by another program meanwhile, and is not replaced: name another file",
                self.path.display()
            )),
            _ => failed(&self.path, &error),
        })?;
        self.may_replace.store(true, Ordering::Relaxed);
        Ok(())
    }
}

/// Whether there is a file, or a link, even if it leads to no file.
fn is_there(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

fn failed(path: &Path, error: &impl fmt::Display) -> Failure {
    Failure::Failed(format!("{}: {}", path.display(), said(error)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_measured_is_kept_in_a_place_that_is_named() {
        let folder = std::env::temp_dir().join(format!("slipline-lost-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let out = Destination::new(&folder.join("measured.csv"), ForceArgument::default()).expect("writable");
        out.write_measured("1,2").expect("written");
        assert_eq!(std::fs::read_to_string(out.path()).expect("there"), "1,2");
        // The folder is gone by the time the measurement has ended.
        std::fs::remove_dir_all(&folder).expect("removed");
        let message = out.write_measured("3,4").expect_err("no folder").to_string();
        let (_, kept) = message.split_once("; what was measured is in ").expect("a place");
        assert_eq!(std::fs::read_to_string(kept).expect("there"), "3,4");
        std::fs::remove_file(kept).expect("removed");
    }
}

//! The dialogs and the disk of the system.

use super::{
    FileError, FileEvent, FileJob, Files, PROFILE_EXTENSIONS, Save, native, openable_extensions, opened,
};
use slipline_instrument::measured_file;
use slipline_model::atomic_file;
use slipline_model::setup::file::FILE_BYTES_MAX;
use slipline_model::texture::PROFILE_FILE_BYTES_MAX;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// Runs a job, as long as it takes; `None` when the user cancelled the dialog.
type Perform = fn(FileJob) -> Option<FileEvent>;

/// The dialogs and disk of the system; each job runs on its own thread, so a dialog may stay open while the device is
/// driven.
pub struct SystemFiles {
    perform: Perform,
    wake: Arc<dyn Fn() + Send + Sync>,
    sender: Sender<FileEvent>,
    events: Receiver<FileEvent>,
}

impl SystemFiles {
    /// `wake` is called when a job is done.
    #[must_use]
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self::with(perform, wake)
    }

    fn with(perform: Perform, wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (sender, events) = channel();
        Self { perform, wake: Arc::new(wake), sender, events }
    }
}

impl Files for SystemFiles {
    fn begin(&mut self, job: FileJob) {
        let sender = self.sender.clone();
        let (perform, wake) = (self.perform, Arc::clone(&self.wake));
        let act = move |job| {
            if let Some(event) = perform(job) {
                // The receiver is gone if the window was closed.
                let _ = sender.send(event);
                wake();
            }
        };
        let (give, given) = channel();
        let here = act.clone();
        let begun = std::thread::Builder::new().spawn(move || given.into_iter().for_each(act));
        match begun {
            Ok(_) => drop(give.send(job)),
            // The system starts no more threads: the window waits.
            Err(_) => here(job),
        }
    }

    fn take(&mut self) -> Option<FileEvent> {
        self.events.try_recv().ok()
    }
}

/// Runs a job; `None` when the user cancelled the dialog.
fn perform(job: FileJob) -> Option<FileEvent> {
    if job.needs_dialog() && !native::is_there() {
        return Some(FileEvent::NoDialog(job));
    }
    match job {
        FileJob::Choose => {
            let path = rfd::FileDialog::new()
                .add_filter("Setup, plate, measurement or recorded drag", &openable_extensions())
                .pick_file()?;
            Some(open(path))
        }
        FileJob::Open(path) => Some(open(path)),
        FileJob::ChooseMeasurement => {
            let dialog = rfd::FileDialog::new().add_filter("Measurement", &openable_extensions());
            Some(open_measurement(dialog.add_filter("Any file", &["*"]).pick_file()?))
        }
        FileJob::OpenMeasurement(path) => Some(open_measurement(path)),
        FileJob::ChooseProfile => {
            let path = rfd::FileDialog::new().add_filter("Profile", &PROFILE_EXTENSIONS).pick_file()?;
            Some(open_profile(path))
        }
        FileJob::OpenProfile(path) => Some(open_profile(path)),
        FileJob::Save(save) => {
            let dialog = rfd::FileDialog::new().add_filter(save.kind, &[save.extension]);
            let path = dialog.set_file_name(&save.name).save_file()?;
            // The dialog has already asked before replacing an existing file.
            Some(save_as(path, save, true))
        }
        FileJob::SaveFolder(files) => {
            let folder = rfd::FileDialog::new().set_title("A folder for the files").pick_folder()?;
            Some(save_into(folder, &files))
        }
        FileJob::SaveAs { path, save, may_replace } => Some(save_as(path, save, may_replace)),
        FileJob::SaveInto(folder, files) => Some(save_into(folder, &files)),
    }
}

fn open(path: PathBuf) -> FileEvent {
    let bytes = atomic_file::read_bytes(&path, measured_file::BYTES_MAX).map_err(FileError::from);
    opened(path, bytes, |bytes| {
        Ok(atomic_file::read_limited(&bytes[..], FILE_BYTES_MAX).and_then(atomic_file::text)?)
    })
}

fn open_measurement(path: PathBuf) -> FileEvent {
    let bytes = atomic_file::read_bytes(&path, measured_file::BYTES_MAX).map_err(FileError::from);
    FileEvent::Measurement(path, bytes)
}

fn open_profile(path: PathBuf) -> FileEvent {
    let bytes = atomic_file::read_bytes(&path, PROFILE_FILE_BYTES_MAX).map_err(FileError::from);
    FileEvent::Profile(path, bytes)
}

fn save_as(mut path: PathBuf, save: Save, may_replace: bool) -> FileEvent {
    if path.extension().is_none() {
        path.set_extension(save.extension);
    }
    if !may_replace && path.exists() {
        return FileEvent::Exists(path, save);
    }
    let result = write(&path, &save.bytes);
    FileEvent::Saved(path, result)
}

/// Writes all files, or none if one of them already exists: choosing a folder is no permission to replace its
/// files.
fn save_into(folder: PathBuf, files: &[(String, String)]) -> FileEvent {
    let result = match files.iter().find(|(name, _)| folder.join(name).exists()) {
        Some((name, _)) => Err(FileError::Exists(name.clone())),
        None => write_all(&folder, files),
    };
    FileEvent::Saved(folder, result)
}

fn write_all(folder: &Path, files: &[(String, String)]) -> Result<(), FileError> {
    files.iter().try_for_each(|(name, text)| write(&folder.join(name), text.as_bytes()))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    atomic_file::write(path, |out| out.write_all(bytes)).map_err(|error: io::Error| {
        atomic_file::missing_folder(path).map_or(error.into(), FileError::NoFolder)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// An empty folder for one test.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("slipline-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_dialog_that_stays_open_blocks_nothing() {
        static OPEN: Mutex<()> = Mutex::new(());
        // Held by this test: begin() would wait for itself if it did not return while the dialog is open.
        let is_open = OPEN.lock().unwrap();
        let dialog: Perform = |_| {
            let _closed = OPEN.lock().unwrap();
            Some(FileEvent::Opened(PathBuf::from("chosen.toml"), Ok(String::new())))
        };
        let (woken, wakes) = channel();
        let mut files = SystemFiles::with(dialog, move || woken.send(()).unwrap());
        files.begin(FileJob::Choose);
        assert!(files.take().is_none() && wakes.try_recv().is_err());
        drop(is_open);
        wakes.recv().unwrap();
        assert!(matches!(files.take(), Some(FileEvent::Opened(path, _)) if path.ends_with("chosen.toml")));
    }

    #[test]
    fn an_existing_file_is_replaced_only_on_request() {
        let folder = folder("replaced");
        let save = |text: &str| Save {
            name: String::new(),
            kind: "Setup",
            extension: "toml",
            bytes: text.as_bytes().into(),
        };
        let write = |text: &str, may_replace: bool| {
            perform(FileJob::SaveAs { path: folder.join("mine"), save: save(text), may_replace }).unwrap()
        };
        assert!(matches!(write("a", false), FileEvent::Saved(path, Ok(())) if path.ends_with("mine.toml")));
        assert!(matches!(write("b", false), FileEvent::Exists(path, _) if path.ends_with("mine.toml")));
        let kept = || std::fs::read_to_string(folder.join("mine.toml")).unwrap();
        assert_eq!(kept(), "a");
        assert!(matches!(write("b", true), FileEvent::Saved(_, Ok(()))));
        assert_eq!(kept(), "b");
        let missing = folder.join("missing");
        let files = vec![("x.svg".to_owned(), "<svg/>".to_owned())];
        let expected = format!("there is no folder {}", missing.display());
        assert!(matches!(
            perform(FileJob::SaveInto(missing, files.clone())),
            Some(FileEvent::Saved(_, Err(reason))) if reason.to_string() == expected
        ));
        assert!(matches!(
            perform(FileJob::SaveInto(folder.clone(), files)),
            Some(FileEvent::Saved(_, Ok(())))
        ));
        assert!(folder.join("x.svg").exists());
        let again = ["new.svg", "x.svg"].map(|name| (name.to_owned(), "<other/>".to_owned()));
        let Some(FileEvent::Saved(_, Err(reason))) =
            perform(FileJob::SaveInto(folder.clone(), again.to_vec()))
        else {
            panic!("it was replaced")
        };
        assert_eq!(reason.to_string(), "x.svg exists already: choose another folder");
        assert_eq!(std::fs::read_to_string(folder.join("x.svg")).unwrap(), "<svg/>");
        assert!(!folder.join("new.svg").exists(), "all or none");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

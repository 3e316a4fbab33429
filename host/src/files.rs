//! Choosing, reading and writing files off the UI thread.

use crate::setup_file::FILE_BYTES_MAX;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// What is written, and how the file is called if the user gives no other name.
#[derive(Clone, Debug)]
pub struct Save {
    /// The name offered.
    pub name: String,
    /// What kind of file it is, as the user reads it.
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
    /// Let the user choose where to, and write.
    Save(Save),
    /// Let the user choose a folder and write these files (name, text) into it.
    SaveFolder(Vec<(String, String)>),
}

/// How it went.
#[derive(Clone, Debug)]
pub enum FileEvent {
    /// A file was read, or not; then a sentence says why.
    Opened(PathBuf, Result<String, String>),
    /// A file was written, or not; then a sentence says why.
    Saved(PathBuf, Result<(), String>),
}

/// Where files come from and go to.
pub trait Files {
    /// Begins a job; returns at once.
    fn begin(&mut self, job: FileJob);
    /// What has been done since.
    fn take(&mut self) -> Option<FileEvent>;
}

/// The system's own dialogs and disk, each job on a thread of its own.
pub struct SystemFiles {
    wake: Arc<dyn Fn() + Send + Sync>,
    sender: Sender<FileEvent>,
    events: Receiver<FileEvent>,
}

impl SystemFiles {
    /// `wake` is called when a job is done.
    #[must_use]
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (sender, events) = channel();
        Self { wake: Arc::new(wake), sender, events }
    }
}

impl Files for SystemFiles {
    fn begin(&mut self, job: FileJob) {
        let sender = self.sender.clone();
        let wake = Arc::clone(&self.wake);
        std::thread::spawn(move || {
            if let Some(event) = perform(job) {
                // The window may be closed by now.
                let _ = sender.send(event);
                wake();
            }
        });
    }

    fn take(&mut self) -> Option<FileEvent> {
        self.events.try_recv().ok()
    }
}

/// Does a job; `None` when the user chose nothing.
fn perform(job: FileJob) -> Option<FileEvent> {
    match job {
        FileJob::Choose => {
            let path = rfd::FileDialog::new().add_filter("Setup or plate", &["toml"]).pick_file()?;
            let text = read_text(&path);
            Some(FileEvent::Opened(path, text))
        }
        FileJob::Open(path) => {
            let text = read_text(&path);
            Some(FileEvent::Opened(path, text))
        }
        FileJob::Save(save) => {
            let dialog = rfd::FileDialog::new().add_filter(save.kind, &[save.extension]);
            let mut path = dialog.set_file_name(&save.name).save_file()?;
            if path.extension().is_none() {
                path.set_extension(save.extension);
            }
            let result = write_whole(&path, &save.bytes).map_err(|error| error.to_string());
            Some(FileEvent::Saved(path, result))
        }
        FileJob::SaveFolder(files) => {
            let folder = rfd::FileDialog::new().set_title("A folder for the files").pick_folder()?;
            let result = write_all(&folder, &files).map_err(|error| error.to_string());
            Some(FileEvent::Saved(folder, result))
        }
    }
}

fn write_all(folder: &Path, files: &[(String, String)]) -> io::Result<()> {
    files.iter().try_for_each(|(name, text)| write_whole(&folder.join(name), text.as_bytes()))
}

/// The text of a file that is not too big; what is too big is not read.
pub(crate) fn read_text(path: &Path) -> Result<String, String> {
    let read = || -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        // One byte more than allowed tells a file that is too big from one that just fits.
        File::open(path)?.take(FILE_BYTES_MAX as u64 + 1).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let bytes = read().map_err(|error| error.to_string())?;
    if bytes.len() > FILE_BYTES_MAX {
        return Err(format!("the file is larger than the {FILE_BYTES_MAX} bytes that are read"));
    }
    String::from_utf8(bytes).map_err(|_| "the file is not text".to_owned())
}

/// Writes a file as a whole: a half-written one never takes the old one's place.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let mut file = File::create(&part)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    drop(file);
    std::fs::rename(part, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_missing_and_binary_files_are_refused_in_words() {
        let folder = std::env::temp_dir().join(format!("slipline-files-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a.toml");
        assert!(read_text(&path).is_err());
        write_whole(&path, &vec![b' '; FILE_BYTES_MAX + 1]).unwrap();
        assert!(read_text(&path).unwrap_err().contains("larger"));
        write_whole(&path, &[0xff, 0xfe]).unwrap();
        assert!(read_text(&path).unwrap_err().contains("not text"));
        write_whole(&path, b"x = 1").unwrap();
        assert_eq!(read_text(&path).unwrap(), "x = 1");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "no part is left behind");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

//! Files without a disk and dialogs: the test sets the contents and reads what was saved.

use slipline_window::files::{FileError, FileEvent, FileJob, Files, Save, opened};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// A list that the test and the app both hold.
type Shared<T> = Rc<RefCell<Vec<T>>>;

/// Fake file access: the test sets the contents and reads what was saved.
#[derive(Clone, Default)]
pub(crate) struct FakeFiles {
    /// The result of opening each path.
    pub(crate) contents: Shared<(PathBuf, Result<String, String>)>,
    /// The result of opening each profile.
    pub(crate) profiles: Shared<(PathBuf, Result<Vec<u8>, String>)>,
    /// What was saved.
    pub(crate) saved: Shared<(String, Vec<u8>)>,
    /// Whether the system has no dialogs for files.
    pub(crate) has_no_dialogs: Rc<Cell<bool>>,
    /// Whether the dialog for files stays open.
    pub(crate) stays_open: Rc<Cell<bool>>,
    events: Rc<RefCell<VecDeque<FileEvent>>>,
}

/// What the disk gives, with the system's reason if it gives nothing.
fn read<T>(content: Option<Result<T, String>>) -> Result<T, FileError> {
    content
        .unwrap_or_else(|| Err("no such file".to_owned()))
        .map_err(|reason| io::Error::other(reason).into())
}

impl FakeFiles {
    /// The bytes of a profile, or of another content.
    fn bytes_of(&self, path: &Path) -> Result<Vec<u8>, FileError> {
        let (profiles, contents) = (self.profiles.borrow(), self.contents.borrow());
        let dropped = profiles.iter().find(|it| it.0 == path).map(|it| it.1.clone());
        let typed = || contents.iter().find(|it| it.0 == path).map(|it| it.1.clone());
        read(dropped.or_else(|| typed().map(|text| text.map(String::into_bytes))))
    }

    fn write(&self, path: PathBuf, save: Save) -> FileEvent {
        self.saved.borrow_mut().push((save.name, save.bytes.to_vec()));
        FileEvent::Saved(path, Ok(()))
    }
}

impl Files for FakeFiles {
    fn begin(&mut self, job: FileJob) {
        if job.needs_dialog() && self.stays_open.get() {
            return;
        }
        let event = match job {
            job if job.needs_dialog() && self.has_no_dialogs.get() => FileEvent::NoDialog(job),
            FileJob::Choose => {
                let (path, text) = self.contents.borrow()[0].clone();
                FileEvent::Opened(path, read(Some(text)))
            }
            FileJob::ChooseMeasurement => {
                let (path, text) = self.contents.borrow()[0].clone();
                FileEvent::Measurement(path, read(Some(text)).map(String::into_bytes))
            }
            FileJob::OpenMeasurement(path) => {
                let bytes = self.bytes_of(&path);
                FileEvent::Measurement(path, bytes)
            }
            FileJob::ChooseProfile => {
                let (path, bytes) = self.profiles.borrow()[0].clone();
                FileEvent::Profile(path, read(Some(bytes)))
            }
            FileJob::OpenProfile(path) => {
                let profiles = self.profiles.borrow();
                let bytes = profiles.iter().find(|(other, _)| *other == path).map(|(_, bytes)| bytes.clone());
                FileEvent::Profile(path, read(bytes))
            }
            FileJob::Open(path) => {
                let bytes = self.bytes_of(&path);
                opened(path, bytes, |bytes| {
                    String::from_utf8(bytes).map_err(|why| io::Error::other(why).into())
                })
            }
            FileJob::Save(save) => self.write(PathBuf::from(&save.name), save),
            FileJob::SaveAs { path, save, may_replace } => {
                let is_there = self.contents.borrow().iter().any(|(other, _)| *other == path);
                if is_there && !may_replace {
                    FileEvent::Exists(path, save)
                } else {
                    self.contents.borrow_mut().push((path.clone(), Ok(String::new())));
                    self.write(path, save)
                }
            }
            FileJob::SaveFolder(files) | FileJob::SaveInto(_, files) => {
                let files = files.into_iter().map(|(name, text)| (name, text.into_bytes()));
                self.saved.borrow_mut().extend(files);
                FileEvent::Saved(PathBuf::from("folder"), Ok(()))
            }
        };
        self.events.borrow_mut().push_back(event);
    }

    fn take(&mut self) -> Option<FileEvent> {
        self.events.borrow_mut().pop_front()
    }
}

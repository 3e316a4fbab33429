//! Files by the browser: chosen in its dialog, saved as downloads. Nothing has a path, only a name.

use crate::host::Host;
use eframe::egui;
use js_sys::{Array, Uint8Array};
use slipline_instrument::measured_file;
use slipline_model::content::NOT_TEXT;
use slipline_model::setup::file::FILE_BYTES_MAX;
use slipline_model::texture::PROFILE_FILE_BYTES_MAX;
use slipline_window::files::{
    self, FileError, FileEvent, FileJob, Files, PROFILE_EXTENSIONS, openable_extensions,
};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::JsCast as _;
use wasm_bindgen_futures::{JsFuture, spawn_local};

type Events = Rc<RefCell<VecDeque<FileEvent>>>;
/// The files that were dropped on the page lately. A browser opens no other file by its name.
pub(crate) type Dropped = Rc<RefCell<Vec<Arc<dyn egui::DroppedFile + Send + Sync>>>>;

/// The browser's dialogs.
pub(crate) struct BrowserFiles {
    host: Rc<Host>,
    ctx: egui::Context,
    dropped: Dropped,
    events: Events,
}

impl BrowserFiles {
    pub(crate) fn new(host: Rc<Host>, ctx: egui::Context, dropped: Dropped) -> Self {
        Self { host, ctx, dropped, events: Events::default() }
    }

    fn end(&self, event: FileEvent) {
        self.events.borrow_mut().push_back(event);
        self.ctx.request_repaint();
    }

    /// Has a file that was dropped read, which `read` turns into an event; `read` gets no bytes if there is no such file.
    fn read_dropped(&self, path: PathBuf, read: fn(String, Result<Vec<u8>, FileError>) -> FileEvent) {
        let name = path.display().to_string();
        let file = self.dropped.borrow().iter().rev().find(|file| file.path() == path).cloned();
        let Some(file) = file else {
            let error = FileError::Browser("a browser opens no file by its name: use File, Open".to_owned());
            return self.end(read(name, Err(error)));
        };
        let (events, ctx) = (Rc::clone(&self.events), self.ctx.clone());
        spawn_local(async move {
            let bytes = file.bytes_async().await.map_err(FileError::Browser);
            events.borrow_mut().push_back(read(name, bytes));
            ctx.request_repaint();
        });
    }

    /// Has the user choose a file, which `read` turns into an event.
    fn choose(&self, extensions: &[&str], read: fn(String, Result<Vec<u8>, FileError>) -> FileEvent) {
        let extensions: Vec<String> = extensions.iter().map(|extension| format!(".{extension}")).collect();
        let choice = JsFuture::from(self.host.choose(&extensions.join(",")));
        let (events, ctx) = (Rc::clone(&self.events), self.ctx.clone());
        spawn_local(async move {
            // Null when the user has chosen none.
            let Some(file) = choice.await.ok().and_then(|file| file.dyn_into::<Array>().ok()) else { return };
            let name = file.get(0).as_string().unwrap_or_default();
            let bytes = Uint8Array::new(&file.get(1)).to_vec();
            events.borrow_mut().push_back(read(name, Ok(bytes)));
            ctx.request_repaint();
        });
    }
}

fn within(bytes: Result<Vec<u8>, FileError>, most: usize) -> Result<Vec<u8>, FileError> {
    let bytes = bytes?;
    if bytes.len() > most {
        return Err(FileError::TooBig { bytes: bytes.len() as u64, most });
    }
    Ok(bytes)
}

fn opened(name: String, bytes: Result<Vec<u8>, FileError>) -> FileEvent {
    files::opened(name.into(), within(bytes, measured_file::BYTES_MAX), |bytes| {
        String::from_utf8(within(Ok(bytes), FILE_BYTES_MAX)?)
            .map_err(|_| FileError::Browser(NOT_TEXT.to_owned()))
    })
}

fn measurement(name: String, bytes: Result<Vec<u8>, FileError>) -> FileEvent {
    FileEvent::Measurement(name.into(), within(bytes, measured_file::BYTES_MAX))
}

fn profile(name: String, bytes: Result<Vec<u8>, FileError>) -> FileEvent {
    FileEvent::Profile(name.into(), within(bytes, PROFILE_FILE_BYTES_MAX))
}

impl Files for BrowserFiles {
    fn begin(&mut self, job: FileJob) {
        match job {
            FileJob::Choose => self.choose(&openable_extensions(), opened),
            FileJob::ChooseMeasurement => self.choose(&openable_extensions(), measurement),
            FileJob::ChooseProfile => self.choose(&PROFILE_EXTENSIONS, profile),
            FileJob::Save(save) | FileJob::SaveAs { save, .. } => {
                self.host.save(&save.name, &save.bytes);
                self.end(FileEvent::Saved(save.name.into(), Ok(())));
            }
            FileJob::SaveFolder(files) | FileJob::SaveInto(_, files) => {
                for (name, text) in &files {
                    self.host.save(name, text.as_bytes());
                }
                self.end(FileEvent::Saved(format!("{} files", files.len()).into(), Ok(())));
            }
            FileJob::Open(path) => self.read_dropped(path, opened),
            FileJob::OpenMeasurement(path) => self.read_dropped(path, measurement),
            FileJob::OpenProfile(path) => self.read_dropped(path, profile),
        }
    }

    fn take(&mut self) -> Option<FileEvent> {
        self.events.borrow_mut().pop_front()
    }
}

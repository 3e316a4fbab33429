//! Typed paths, for systems without a file dialog.

use super::App;
use crate::files::FileJob;
use crate::intent::{Dialog, PathQuestion};
use std::path::{Path, PathBuf};

impl App {
    /// Asks for the path of a job; `existing` is a path that was typed and names a file that exists.
    pub(super) fn ask_for_path(&mut self, job: FileJob, existing: Option<&Path>) {
        let (title, verb, name) = match &job {
            FileJob::Choose => ("Open a setup, a plate or a measurement", "Open", ""),
            FileJob::ChooseMeasurement => ("Open a measurement", "Open", ""),
            FileJob::ChooseProfile => ("Open a profile (CSV or PNG)", "Open", ""),
            FileJob::Save(save) => ("Save as", "Save", save.name.as_str()),
            FileJob::SaveFolder(_) => ("A folder for the files", "Save", ""),
            // These jobs have a path already.
            FileJob::Open(_)
            | FileJob::OpenMeasurement(_)
            | FileJob::OpenProfile(_)
            | FileJob::SaveAs { .. }
            | FileJob::SaveInto(..) => return,
        };
        let existing = existing.map(|path| path.display().to_string());
        let offered =
            existing.clone().unwrap_or_else(|| self.usual_folder().join(name).display().to_string());
        // The pages of a calibration come back after it.
        let before = self.dialog.take();
        self.behind = before.filter(|dialog| *dialog == Dialog::Calibrate).or(self.behind.take());
        self.dialog = Some(Dialog::Path(PathQuestion { title, verb, offered, existing }));
        self.asked = Some(job);
    }

    /// Runs the job that waited for this path.
    pub(super) fn take_path(&mut self, text: &str, may_replace: bool) {
        self.dialog = self.behind.take();
        let path = self.typed_path(text);
        let job = match self.asked.take() {
            Some(FileJob::Choose) => FileJob::Open(path),
            Some(FileJob::ChooseMeasurement) => FileJob::OpenMeasurement(path),
            Some(FileJob::ChooseProfile) => FileJob::OpenProfile(path),
            Some(FileJob::Save(save)) => FileJob::SaveAs { path, save, may_replace },
            Some(FileJob::SaveFolder(files)) => FileJob::SaveInto(path, files),
            Some(
                FileJob::Open(_)
                | FileJob::OpenMeasurement(_)
                | FileJob::OpenProfile(_)
                | FileJob::SaveAs { .. }
                | FileJob::SaveInto(..),
            )
            | None => return,
        };
        self.services.files.begin(job);
    }

    /// A typed text as a path: `~` is the home folder, and a relative path begins in the usual folder.
    fn typed_path(&self, text: &str) -> PathBuf {
        let text = text.trim();
        match (text.strip_prefix("~/"), std::env::home_dir()) {
            (Some(rest), Some(home)) => home.join(rest),
            _ => self.usual_folder().join(text),
        }
    }

    /// The folder of the file that was used last, else the home folder.
    fn usual_folder(&self) -> PathBuf {
        let last = self.settings.recent.first().and_then(|path| path.parent()).map(Path::to_owned);
        let last = last.filter(|folder| folder.is_dir());
        last.or_else(std::env::home_dir).unwrap_or_default()
    }
}

//! Work that takes longer than a frame: the validity lights, the plate in two dimensions, the designer, the
//! 2-D sheet; their progress and their cancellation.

use super::shown::{Awaited, Background, DesignState, Waiting};
use super::{Instrument, Jobs};
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::field::sheet::{self, FieldSource, Frame, SheetJob, SourceChoice};
use slipline_model::field::time_domain::TimeDomainJob;
use slipline_model::jobs::check::CheckJob;
use slipline_model::jobs::design::Draft;
use slipline_model::jobs::plane::PlaneJob;
use slipline_model::jobs::table::{TableMade, TableState};
use slipline_model::setup::edit::Edit;
use slipline_plate::Plate;
use slipline_plate::check::Conditions;
use std::sync::Arc;
use std::time::Duration;

/// Work that takes longer than this gets a progress bar and a Cancel button, in seconds; what the screen computes by itself
/// after a drag gets them later, so that they do not come and go.
const PATIENCE_S: f64 = 0.3;
const LONG_PATIENCE_S: f64 = 3.0;
/// Time between two updates of the progress bar.
const BAR: Duration = Duration::from_millis(100);
/// The sample rate that is assumed until a device reports its own, in Hz.
const USUAL_RATE_HZ: f64 = 400e3;

/// The state of the app's background work.
#[derive(Default)]
pub(crate) struct Work {
    /// The part that the views show.
    pub(crate) shown: Background,
    /// Plate, rate and choice for which the source of the wave was decided.
    decided: Option<(Arc<Plate>, f64, SourceChoice)>,
    frame: Option<Frame>,
    /// The latest drive that the device has accepted.
    pub(crate) driven: Option<TimeDomainJob>,
    /// Whether a drag has kept that drive from the sheet.
    is_sheet_owed: bool,
    /// Plate time that has passed in slow motion, in seconds.
    plate_time_s: f64,
    /// The table that was finished last.
    kept: Option<Arc<TableMade>>,
    /// The work that the user waits for, and since when.
    since: Option<(Awaited, f64)>,
    is_long: bool,
}

impl Work {
    /// Keeps the table that was finished last: it is restored when the computation of another one is cancelled.
    pub(crate) fn keep(&mut self, table: &TableState) {
        if let Some(made) = table.made() {
            self.kept = Some(Arc::clone(made));
        }
    }

    /// The work that the user waits for, once it has taken longer than the user's patience.
    pub(crate) fn waiting(&self, jobs: &Jobs) -> Option<Waiting> {
        under_way(jobs).filter(|_| self.is_long)
    }
}

/// The work in progress, the most important first.
fn under_way(jobs: &Jobs) -> Option<Waiting> {
    [
        (Awaited::Table, jobs.tables.progress()),
        (Awaited::Design, jobs.designs.progress()),
        (Awaited::Texture, jobs.textures.progress()),
        (Awaited::Plane, jobs.planes.progress()),
        (Awaited::Sheet, jobs.sheets.progress()),
        (Awaited::Check, jobs.checks.progress()),
    ]
    .into_iter()
    .find_map(|(what, share)| Some(Waiting { what, share: share? }))
}

/// How long this work may take before it is shown, in seconds.
const fn patience_s(what: Awaited) -> f64 {
    match what {
        Awaited::Sheet | Awaited::Check => LONG_PATIENCE_S,
        Awaited::Table | Awaited::Design | Awaited::Texture | Awaited::Plane => PATIENCE_S,
    }
}

impl Instrument {
    /// Starts the work that the screen needs, and tracks how long it takes.
    pub(crate) fn update_background(&mut self) {
        self.decide_source();
        if self.background.is_sheet_owed && !self.attention.is_dragging {
            self.background.is_sheet_owed = false;
            if self.is_sounding() {
                self.resume_sheet();
            }
        }
        // While the pointer is down, boundary and levels still change.
        if !self.attention.is_dragging && !self.attention.is_pressed {
            self.check();
        }
        self.update_texture();
        self.update_measures();
        let now = self.attention.now_s;
        let Some(Waiting { what, .. }) = under_way(&self.jobs) else {
            self.background.since = None;
            self.background.is_long = false;
            return;
        };
        let since = match self.background.since {
            Some((before, since)) if before == what => since,
            _ => now,
        };
        self.background.since = Some((what, since));
        self.background.is_long = now - since > patience_s(what);
        self.wake_after(BAR);
    }

    pub(crate) fn sample_rate_hz(&self) -> f64 {
        self.snapshot.identity.as_ref().map_or(USUAL_RATE_HZ, |identity| f64::from(identity.sample_rate_hz))
    }

    fn decide_source(&mut self) {
        let (plate, rate_hz, wish) = (&self.setup.plate, self.sample_rate_hz(), self.attention.wave);
        let is_decided =
            self.background.decided.as_ref().is_some_and(|(of, rate, wished)| {
                Arc::ptr_eq(of, plate) && *rate == rate_hz && *wished == wish
            });
        if is_decided {
            return;
        }
        self.background.shown.source = Some(sheet::source(plate, rate_hz, wish));
        self.background.decided = Some((Arc::clone(plate), rate_hz, wish));
        if let Some(job) = self.background.driven.take() {
            self.run_sheet(job);
        }
    }

    /// Requests the lights for the plate and boundary on the screen, unless that was done already.
    fn check(&mut self) {
        let Some(tone) = self.setup.tone(self.selected) else { return };
        let others = self.setup.tones.iter().filter(|other| other.slot != tone.slot);
        let job = CheckJob {
            plate: Arc::clone(&self.setup.plate),
            boundary_m: tone.position_m,
            conditions: Conditions {
                sample_rate_hz: self.sample_rate_hz(),
                level: (tone.level * self.setup.master()).clamp(0.0, 1.0),
                off_centre: false,
                other_boundaries_m: others.map(|other| other.position_m).collect(),
            },
        };
        if self.background.shown.asked.as_ref() != Some(&job) {
            self.background.shown.asked = Some(job.clone());
            self.jobs.checks.ask(job);
        }
    }

    /// The plate and boundary on the screen, to be computed in two dimensions.
    pub(crate) fn plane_job(&self) -> Option<PlaneJob> {
        let tone = self.setup.tone(self.selected)?;
        let plate = Arc::clone(&self.setup.plate);
        Some(PlaneJob { plate, boundary_m: tone.position_m, finger: self.load() })
    }

    /// Requests the plate on the screen in two dimensions.
    pub fn check_plane(&mut self) {
        if let Some(job) = self.plane_job() {
            self.background.shown.plane_asked = Some(job.clone());
            self.jobs.planes.ask(job);
        }
    }

    /// Passes this drive to the sheet, if the wave is drawn from it.
    pub(crate) fn run_sheet(&mut self, drive: TimeDomainJob) {
        self.background.driven = Some(drive.clone());
        self.decide_source();
        if self.attention.is_dragging {
            // A drag makes dozens of drives a second, and the sheet would settle all the time, on a core of its own: until the
            // end of the drag the modal lines are drawn.
            self.background.is_sheet_owed = true;
            self.jobs.sheets.cancel();
            return self.drop_sheet();
        }
        // A finger that moves would make another sheet, which begins at rest.
        if self.background.shown.source == Some(FieldSource::Sheet)
            && Arc::ptr_eq(&drive.plate, &self.setup.plate)
            && self.load().is_none()
        {
            self.jobs.sheets.ask(SheetJob { drive, time_s: self.background.plate_time_s });
        }
    }

    /// Advances the sheet by `step_s` seconds of the user's time.
    pub(crate) fn advance_sheet(&mut self, step_s: f64) {
        let Some(sounding) = &self.playback.sounding else { return };
        self.background.plate_time_s += step_s / slow_factor(&sounding.steady);
        let is_behind = self.jobs.sheets.progress().is_some();
        let is_shown = self.shown_sheet().is_some();
        if let Some(drive) = self.background.driven.as_ref().filter(|drive| drive.number == sounding.number)
            && is_shown
            && !is_behind
        {
            let job = SheetJob { drive: drive.clone(), time_s: self.background.plate_time_s };
            self.jobs.sheets.ask(job);
        }
    }

    /// Forgets the sheet's state, because it is no longer that of the drive.
    pub(crate) fn drop_sheet(&mut self) {
        self.background.frame = None;
    }

    /// Runs the sheet on, after the finger was taken off or a drag has ended.
    pub(crate) fn resume_sheet(&mut self) {
        if let Some(job) = self.background.driven.clone() {
            self.run_sheet(job);
        }
    }

    /// The sheet, if the wave of the plate on the screen is drawn from it.
    pub fn shown_sheet(&self) -> Option<&Frame> {
        // The sheet runs forward only: at a time of the user's choice the modal lines are shown.
        if self.load().is_some() || self.playback.is_scrubbed {
            return None;
        }
        let frame = self
            .background
            .frame
            .as_ref()
            .filter(|_| self.background.shown.source == Some(FieldSource::Sheet))?;
        frame.plate.as_ref().is_some_and(|plate| Arc::ptr_eq(plate, &self.setup.plate)).then_some(frame)
    }

    pub(crate) fn take_background(&mut self) {
        if let Some(checked) = self.jobs.checks.take() {
            self.background.shown.checked = Some(checked);
        }
        if let Some(checked) = self.jobs.planes.take() {
            self.background.shown.plane = Some(checked);
        }
        if let Some(done) = self.jobs.calibrations.take() {
            self.calibrating.latest = Some(done);
        }
        if let Some(compared) = self.jobs.comparisons.take() {
            self.measures.latest = Some(compared);
        }
        if let Some(recorded) = self.jobs.recordings.take() {
            self.take_recorded(recorded);
        }
        if let Some(textured) = self.jobs.textures.take() {
            // While a profile is drawn, each fit is waited for again.
            self.background.since = self.background.since.filter(|(what, _)| *what != Awaited::Texture);
            self.take_texture(textured);
        }
        if let Some(designed) = self.jobs.designs.take()
            && designed.draft == self.background.shown.draft
        {
            self.background.shown.design = DesignState::Ready(Arc::new(designed));
        }
        if let Some(frame) = self.jobs.sheets.take() {
            self.background.frame = Some(frame);
        }
    }

    /// Requests the design of a draft.
    pub fn design(&mut self, draft: Draft) {
        self.background.shown.draft = draft.clone();
        self.background.shown.design = DesignState::Making;
        self.jobs.designs.ask(draft);
    }

    /// Cancels the work in progress. If that is a table, the plate and the table from before are restored.
    pub fn cancel_work(&mut self) {
        match under_way(&self.jobs).map(|waiting| waiting.what) {
            Some(Awaited::Table) => {
                self.jobs.tables.cancel();
                self.table = TableState::Cancelled;
                let kept = self.background.kept.clone();
                if let Some(kept) = kept.filter(|kept| !Arc::ptr_eq(&kept.plate, &self.setup.plate)) {
                    self.edit(&Edit::Plate(Arc::clone(&kept.plate)));
                    self.jobs.tables.cancel();
                    self.table = TableState::Ready(kept);
                    self.edges_m.clear();
                    self.forget_prediction();
                }
            }
            Some(Awaited::Design) => {
                self.jobs.designs.cancel();
                self.background.shown.design = DesignState::Cancelled;
            }
            Some(Awaited::Texture) => {
                self.jobs.textures.cancel();
                self.textures.give_up();
            }
            Some(Awaited::Plane) => {
                self.jobs.planes.cancel();
                self.background.shown.plane_asked = None;
            }
            Some(Awaited::Sheet) => {
                self.jobs.sheets.cancel();
                self.background.shown.source =
                    Some(FieldSource::Lines(Some("the sheet was cancelled".to_owned())));
            }
            Some(Awaited::Check) => self.jobs.checks.cancel(),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_screen_computes_by_itself_shows_no_cancel_for_a_moment_after_a_drag() {
        let [asked, unasked] = [Awaited::Table, Awaited::Sheet].map(patience_s);
        // A sheet starts again after each drag and is done within a second or two.
        assert!(asked < 0.5 && unasked >= 3.0 && patience_s(Awaited::Check) == unasked);
    }
}

//! Work that takes longer than a frame: the validity lights, the plate in two dimensions, the designer, the
//! 2-D sheet; their progress and their cancellation.

use super::{Screen, Sight};
use crate::instrument::desk::Desk;
use crate::instrument::drive::Drive;
use crate::instrument::outbox::Outbox;
use crate::instrument::shown::{Awaited, Background, DesignState, Waiting};
use crate::instrument::work::Jobs;
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::field::sheet::{self, FieldSource, Frame, SheetJob, SourceChoice};
use slipline_model::field::time_domain::TimeDomainJob;
use slipline_model::jobs::check::CheckJob;
use slipline_model::jobs::design::{Designed, Draft};
use slipline_model::jobs::plane::PlaneJob;
use slipline_model::jobs::{JobQueue, LatestResult};
use slipline_model::setup::edit::Edit;
use slipline_model::setup::undo::Gesture;
use slipline_plate::Plate;
use slipline_plate::check::Conditions;
use std::mem::take;
use std::sync::Arc;
use std::time::Duration;

/// Work that takes longer than this gets a progress bar and a Cancel button, in seconds; what the screen computes by itself
/// after a drag gets them later, so that they do not come and go.
const PATIENCE_S: f64 = 0.3;
const LONG_PATIENCE_S: f64 = 3.0;
/// Time between two updates of the progress bar.
const BAR: Duration = Duration::from_millis(100);

/// The background work and its state.
#[derive(Default)]
pub(super) struct Work {
    /// The part that the views show.
    pub(super) shown: Background,
    /// Plate, rate and choice for which the source of the wave was decided.
    decided: Option<(Arc<Plate>, f64, SourceChoice)>,
    frame: Option<Frame>,
    /// The latest drive that the device has accepted.
    pub(super) driven: Option<TimeDomainJob>,
    /// Whether a drag has kept that drive from the sheet.
    is_sheet_owed: bool,
    /// Plate time that has passed in slow motion, in seconds.
    plate_time_s: f64,
    /// The work that the user waits for, and since when.
    since: Option<(Awaited, f64)>,
    is_long: bool,
    designs: JobQueue<Draft, Designed>,
    sheets: JobQueue<SheetJob, Frame>,
}

impl Work {
    pub(super) fn new(jobs: &mut Jobs) -> Self {
        Self {
            shown: Background {
                checks: LatestResult::of(take(&mut jobs.checks)),
                planes: LatestResult::of(take(&mut jobs.planes)),
                ..Background::default()
            },
            designs: take(&mut jobs.designs),
            sheets: take(&mut jobs.sheets),
            ..Self::default()
        }
    }

    fn take_results(&mut self) {
        self.shown.checks.take();
        self.shown.planes.take();
        if let Some(designed) = self.designs.take().filter(|designed| designed.draft == self.shown.draft) {
            self.shown.design = DesignState::Ready(Arc::new(designed));
        }
        self.frame = self.sheets.take().or(self.frame.take());
    }

    /// Tracks how long the user waits for this work, at this time in seconds; returns whether there is any.
    fn track(&mut self, under_way: Option<Awaited>, now_s: f64) -> bool {
        self.since = under_way.map(|what| match self.since {
            Some((before, since_s)) if before == what => (what, since_s),
            _ => (what, now_s),
        });
        self.is_long = self.since.is_some_and(|(what, since_s)| now_s - since_s > patience_s(what));
        self.since.is_some()
    }
}

/// Whether the user has asked for this work; the screen computes the other by itself.
const fn is_asked(what: Awaited) -> bool {
    match what {
        Awaited::Sheet | Awaited::Check => false,
        Awaited::Table | Awaited::Design | Awaited::Texture | Awaited::Plane => true,
    }
}

/// How long this work may take before it is shown, in seconds.
const fn patience_s(what: Awaited) -> f64 {
    if is_asked(what) { PATIENCE_S } else { LONG_PATIENCE_S }
}

impl Screen {
    /// Starts the work that the screen needs, and tracks how long it takes.
    pub(super) fn update_background(&mut self, sight: Sight<'_>, out: &mut Outbox) {
        self.decide_source(sight);
        let is_dragging = sight.attention.is_dragging;
        if self.background.is_sheet_owed && !is_dragging {
            self.background.is_sheet_owed = false;
            if self.is_sounding() {
                self.resume_sheet(sight);
            }
        }
        // While the pointer is down, boundary and levels still change.
        if !is_dragging && !sight.attention.is_pressed {
            self.check(sight);
        }
        self.update_texture(sight);
        let under_way = self.under_way(sight.drive).map(|waiting| waiting.what);
        if self.background.track(under_way, sight.attention.now_s) {
            out.wake_after(BAR);
        }
    }

    /// The work in progress, the most important first.
    pub(crate) fn under_way(&self, drive: &Drive) -> Option<Waiting> {
        let work = &self.background;
        [
            (Awaited::Table, drive.table_progress()),
            (Awaited::Design, work.designs.progress()),
            (Awaited::Texture, self.textures.progress()),
            (Awaited::Plane, work.shown.planes.progress()),
            (Awaited::Sheet, work.sheets.progress()),
            (Awaited::Check, work.shown.checks.progress()),
        ]
        .into_iter()
        .find_map(|(what, share)| Some(Waiting { what, share: share? }))
    }

    /// The work that the user waits for, once it has taken longer than the user's patience. A replay moves the lines all the
    /// time, as a drag does: nobody waits for what the screen computes by itself meanwhile.
    pub(super) fn waiting(&self, drive: &Drive, is_replayed: bool) -> Option<Waiting> {
        let waiting = self.under_way(drive).filter(|_| self.background.is_long)?;
        (!is_replayed || is_asked(waiting.what)).then_some(waiting)
    }

    /// Stores the results of the work; returns the edit by which the setup follows a drawing.
    pub(crate) fn take_results(&mut self, is_animated: bool) -> Option<(Gesture, Edit)> {
        self.playback.take_results(is_animated);
        self.background.take_results();
        let made = self.textures.take_result()?;
        // While a profile is drawn, each fit is waited for by itself.
        self.background.since = self.background.since.filter(|(what, _)| *what != Awaited::Texture);
        made.and_then(|made| self.drawn_edit(&made))
    }

    fn decide_source(&mut self, sight: Sight<'_>) {
        let (plate, rate_hz) = (&self.plate, sight.drive.sample_rate_hz());
        let wish = sight.attention.wave;
        let is_decided =
            self.background.decided.as_ref().is_some_and(|(of, rate, wished)| {
                Arc::ptr_eq(of, plate) && *rate == rate_hz && *wished == wish
            });
        if is_decided {
            return;
        }
        self.background.shown.source = Some(sheet::source(plate, rate_hz, wish));
        self.background.decided = Some((Arc::clone(plate), rate_hz, wish));
        self.feed_sheet(sight);
    }

    /// Requests the lights for the plate and boundary on the screen, unless that was done already.
    fn check(&mut self, sight: Sight<'_>) {
        let (setup, Some(tone)) = (sight.desk.setup(), sight.desk.tone()) else { return };
        let others = setup.tones.iter().filter(|other| other.slot != tone.slot);
        self.background.shown.checks.ask(CheckJob {
            plate: Arc::clone(&setup.plate),
            boundary_m: tone.position_m,
            conditions: Conditions {
                sample_rate_hz: sight.drive.sample_rate_hz(),
                level: (tone.level * setup.master()).clamp(0.0, 1.0),
                off_centre: false,
                linear_share: sight.drive.snapshot().linear_share(),
                other_boundaries_m: others.map(|other| other.position_m).collect(),
            },
        });
    }

    /// The plate and boundary on the screen, to be computed in two dimensions.
    pub(super) fn plane_job(&self, desk: &Desk) -> Option<PlaneJob> {
        let plate = Arc::clone(&self.plate);
        Some(PlaneJob { plate, boundary_m: desk.tone()?.position_m, finger: self.load() })
    }

    /// Requests the plate on the screen in two dimensions.
    pub(crate) fn check_plane(&mut self, desk: &Desk) {
        if let Some(job) = self.plane_job(desk) {
            self.background.shown.planes.ask(job);
        }
    }

    /// Passes this drive to the sheet, if the wave is drawn from it.
    pub(super) fn run_sheet(&mut self, drive: TimeDomainJob, sight: Sight<'_>) {
        self.background.driven = Some(drive);
        self.resume_sheet(sight);
    }

    /// Runs the sheet on, after the finger was taken off or a drag has ended.
    pub(super) fn resume_sheet(&mut self, sight: Sight<'_>) {
        self.decide_source(sight);
        self.feed_sheet(sight);
    }

    fn feed_sheet(&mut self, sight: Sight<'_>) {
        let Some(drive) = self.background.driven.clone() else { return };
        if sight.attention.is_dragging {
            // A drag makes dozens of drives a second, and the sheet would settle all the time, on a core of its own: until the
            // end of the drag the modal lines are drawn.
            self.background.is_sheet_owed = true;
            self.background.sheets.cancel();
            return self.drop_sheet();
        }
        // A finger that moves would make another sheet, which begins at rest.
        if self.background.shown.source == Some(FieldSource::Sheet)
            && Arc::ptr_eq(&drive.plate, &self.plate)
            && self.load().is_none()
        {
            self.background.sheets.ask(SheetJob { drive, time_s: self.background.plate_time_s });
        }
    }

    /// Advances the sheet by `step_s` seconds of the user's time.
    pub(super) fn advance_sheet(&mut self, step_s: f64) {
        let Some(sounding) = &self.playback.sounding else { return };
        self.background.plate_time_s += step_s / slow_factor(&sounding.steady);
        let is_behind = self.background.sheets.progress().is_some();
        let is_shown = self.sheet().is_some();
        if let Some(drive) = self.background.driven.as_ref().filter(|drive| drive.number == sounding.number)
            && is_shown
            && !is_behind
        {
            let job = SheetJob { drive: drive.clone(), time_s: self.background.plate_time_s };
            self.background.sheets.ask(job);
        }
    }

    /// Forgets the sheet's state, because it is no longer that of the drive.
    pub(super) fn drop_sheet(&mut self) {
        self.background.frame = None;
    }

    /// The sheet, if the wave of the plate on the screen is drawn from it.
    pub fn sheet(&self) -> Option<&Frame> {
        // The sheet runs forward only: at a time of the user's choice the modal lines are shown.
        if self.load().is_some() || self.playback.is_scrubbed {
            return None;
        }
        let is_sheet = self.background.shown.source == Some(FieldSource::Sheet);
        let frame = self.background.frame.as_ref().filter(|_| is_sheet)?;
        frame.plate.as_ref().is_some_and(|plate| Arc::ptr_eq(plate, &self.plate)).then_some(frame)
    }

    /// Requests the design of a draft.
    pub fn design(&mut self, draft: Draft) {
        self.background.shown.draft = draft.clone();
        self.background.shown.design = DesignState::Making;
        self.background.designs.ask(draft);
    }

    /// Cancels this work; the table is the drive's.
    pub(crate) fn cancel(&mut self, what: Awaited) {
        let work = &mut self.background;
        match what {
            Awaited::Table => {}
            Awaited::Design => {
                work.designs.cancel();
                work.shown.design = DesignState::Cancelled;
            }
            Awaited::Texture => self.textures.give_up(),
            Awaited::Plane => work.shown.planes.forget(),
            Awaited::Sheet => {
                work.sheets.cancel();
                work.shown.source = Some(FieldSource::Lines(Some("the sheet was cancelled".to_owned())));
            }
            Awaited::Check => work.shown.checks.cancel(),
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

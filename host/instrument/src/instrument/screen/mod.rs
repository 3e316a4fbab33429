//! The screen: what is predicted, what sounds, and the work that the views need. It looks at the other rooms and changes none:
//! an edit by the brush is returned.

mod background;
mod brush;
mod finger;
mod playback;
mod prediction;
mod texture;

use super::desk::{Desk, SetupChange};
use super::drive::Drive;
use super::lab::Lab;
use super::outbox::Outbox;
use super::shell::Attention;
use super::shown::{Background, Shown};
use super::work::Jobs;
use background::Work;
use brush::Brush;
use finger::OnPlate;
use playback::Playback;
use prediction::{Predicted, Prediction};
use slipline_model::field::line::Line;
use slipline_model::field::rings::Rings;
use slipline_model::jobs::LatestResult;
use slipline_model::jobs::measured_places::{MeasuredPlace, MeasuredPlacesJob};
use slipline_plate::Plate;
use std::mem::take;
use std::sync::Arc;
use texture::Textures;

/// What the views show, and the work for it.
pub struct Screen {
    plate: Arc<Plate>,
    prediction: Prediction,
    finger: OnPlate,
    playback: Playback,
    background: Work,
    textures: Textures,
    brush: Brush,
    /// What was measured of a real plate.
    measured_places: LatestResult<MeasuredPlacesJob, Vec<MeasuredPlace>>,
}

/// What the screen looks at.
#[derive(Clone, Copy)]
pub(crate) struct Sight<'a> {
    pub(crate) desk: &'a Desk,
    pub(crate) drive: &'a Drive,
    pub(crate) lab: &'a Lab,
    pub(crate) attention: &'a Attention,
}

impl Screen {
    /// A screen for this plate; it takes its queues from `jobs`.
    pub(crate) fn new(plate: &Arc<Plate>, jobs: &mut Jobs) -> Self {
        Self {
            plate: Arc::clone(plate),
            prediction: Prediction::default(),
            finger: OnPlate::default(),
            playback: Playback::new(jobs),
            background: Work::new(jobs),
            textures: Textures::of(plate, take(&mut jobs.textures)),
            brush: Brush::default(),
            measured_places: LatestResult::of(take(&mut jobs.measured_places)),
        }
    }

    /// Advances the work for what is shown.
    pub(crate) fn turn(&mut self, sight: Sight<'_>, out: &mut Outbox) {
        self.update_background(sight, out);
        self.compare_actual_plate(sight);
        self.playback.simulate(sight.attention);
        if !self.is_sounding() {
            self.finger.trace.clear();
        }
    }

    /// The setup has changed, by a drawing or otherwise.
    pub(crate) fn use_setup(&mut self, desk: &Desk, change: &SetupChange, is_drawing: bool) {
        self.brush.follow_change(is_drawing);
        self.keep_edges(Vec::new());
        if change.has_new_plate {
            self.plate = Arc::clone(desk.plate());
            self.playback.measured = None;
            self.finger.trace.clear();
        }
        if change.has_new_feeling {
            self.playback.feel(&desk.setup().feeling);
        }
    }

    /// The setup or its table has changed, and the lines keep these felt edges, by slot and in metres.
    pub(crate) fn keep_edges(&mut self, edges_m: Vec<(u8, f64)>) {
        self.prediction.keep_edges(edges_m);
    }

    /// The felt edges that lines keep while levels change, by slot and in metres.
    pub(crate) fn edges_m(&self, desk: &Desk, drive: &Drive) -> Vec<(u8, f64)> {
        self.prediction.edges_m(desk, drive, self.load())
    }

    fn predicted(&self, sight: Sight<'_>) -> &Predicted {
        self.prediction.predicted(sight.desk, sight.drive, self.load())
    }

    /// The line of the tone in a slot.
    pub(crate) fn line(&self, slot: u8, sight: Sight<'_>) -> Option<&Line> {
        self.predicted(sight).lines.iter().find(|line| line.slot == slot)
    }

    /// The latest results of the background work.
    #[must_use]
    pub const fn background(&self) -> &Background {
        &self.background.shown
    }

    /// Compares what was measured of a real plate with the plate on the screen.
    fn compare_actual_plate(&mut self, sight: Sight<'_>) {
        self.measured_places.take();
        let snapshot = sight.drive.snapshot();
        let is_real = snapshot.is_connected() && !snapshot.is_simulated();
        let measurements = sight.lab.drawn().filter(|_| is_real).cloned().collect();
        self.measured_places.ask(MeasuredPlacesJob { plate: Arc::clone(sight.desk.plate()), measurements });
    }

    /// Everything that a shell shows.
    pub(crate) fn shown<'a>(&'a self, sight: Sight<'a>, out: &'a Outbox) -> Shown<'a> {
        let Sight { desk, drive, lab, .. } = sight;
        let snapshot = drive.snapshot();
        let Predicted { field, felt, lines } = self.predicted(sight);
        let plate = desk.plate();
        let is_hidden = lab.simulated_plate(plate, snapshot).is_some_and(|truth| !Arc::ptr_eq(truth, plate));
        Shown {
            setup: desk.setup(),
            selected: desk.selected(),
            snapshot,
            touch: self.finger.touch,
            finger: self.finger(),
            load: self.load(),
            trace: self.trace(),
            drive_wanted: drive.is_wanted(),
            predicted: field,
            felt: felt.as_ref(),
            lines,
            limits_m: self.prediction.limits_m(desk, drive),
            sounding: self.sounding(),
            full_peak_m: drive.full_peak_m(),
            drive_table: drive.drive_table(),
            table: drive.table(),
            waveform: &self.playback.waveform,
            measured: self
                .playback
                .shown_measured(&self.plate)
                .map(|(measured, is_current)| Rings::new(measured, is_current, is_hidden.then_some(field))),
            measured_places: self.measured_places.current().map_or(&[], Vec::as_slice),
            background: self.background(),
            texture: self.textures.scene(self.brush.is_drawn()),
            measure: lab.measure_scene(snapshot),
            selftest: lab.selftest_scene(snapshot),
            hold: lab.hold_scene(snapshot),
            calibration: lab.calibration_scene(),
            calibration_side: None,
            tour: None,
            plane_job: self.plane_job(desk),
            sheet: self.sheet(),
            waiting: self.waiting(drive, desk.recorder().played_s().is_some()),
            notices: out.notices().collect(),
            compare: desk.compare(),
            recorder: desk.recorder(),
            undo: desk.undo_names(),
            wave_time_s: self.playback.wave_time_s,
        }
    }
}

#[cfg(test)]
mod tests;

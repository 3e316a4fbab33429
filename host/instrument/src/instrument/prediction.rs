//! Prediction of the setup's response on its plate. It is computed on demand, once after any number of
//! changes.

use super::Instrument;
#[cfg(test)]
use super::tests;
use slipline_link::ChordRequest;
use slipline_model::field::felt::Felt;
use slipline_model::field::line::{self, Holds, Line};
use slipline_model::field::steady_field::{SteadyField, steady_tones};
use slipline_model::jobs::table::TableMade;
use slipline_model::setup::{BoundaryMode, Setup};
use slipline_model::texture::chord_of;
use slipline_plate::feeling::Feeling;
use slipline_plate::{DriveTable, Plate};
use std::cell::OnceCell;
use std::sync::Arc;

/// Predicted quantities of the setup's tones. The default: nothing is computed yet.
#[derive(Default)]
pub(crate) struct Prediction {
    field: OnceCell<Predicted>,
    chord: OnceCell<Option<ChordRequest>>,
}

/// The range of a line, in metres, and all that it follows from. The place of the line is not among that, so a drag finds the
/// range once.
pub(crate) struct Limits {
    plate: Arc<Plate>,
    made: Option<Arc<TableMade>>,
    level: f64,
    master_db: f64,
    boundary: BoundaryMode,
    feeling: Feeling,
    range_m: (f64, f64),
}

impl Limits {
    fn is_of(&self, setup: &Setup, level: f64, made: Option<&Arc<TableMade>>) -> bool {
        Arc::ptr_eq(&self.plate, &setup.plate)
            && self.made.as_ref().map(Arc::as_ptr) == made.map(Arc::as_ptr)
            && self.level == level
            && self.master_db == setup.master_db
            && self.boundary == setup.boundary
            && self.feeling == setup.feeling
    }
}

/// The field and what is read from it.
pub(crate) struct Predicted {
    /// The plate under the tones, with the finger if there is one.
    pub(crate) field: SteadyField,
    /// What is felt without a finger; `None` while its height is not known.
    pub(crate) felt: Option<Felt>,
    /// The boundary line of each tone, in their order.
    pub(crate) lines: Vec<Line>,
}

impl Instrument {
    /// Discards the prediction: the setup, its table or the finger has changed.
    pub(crate) fn forget_prediction(&mut self) {
        self.prediction = Prediction::default();
    }

    /// The prediction for the setup.
    pub(crate) fn predicted(&self) -> &Predicted {
        self.prediction.field.get_or_init(|| {
            #[cfg(test)]
            tests::count(&tests::FIELDS);
            let (plate, table) = (&self.setup.plate, self.drive_table());
            let tones = match self.chord() {
                Some(_) => steady_tones(&self.setup, table),
                None => steady_tones(&self.setup.without_chord(), table),
            };
            let alone = SteadyField::solve(plate, &tones);
            let known = table.map(|_| &alone);
            Predicted {
                lines: line::lines(&self.setup, known),
                felt: known.map(|known| Felt::of(plate, &self.setup.feeling, known)),
                field: match self.load() {
                    None => alone,
                    Some(finger) => SteadyField::solve_touched(plate, &tones, Some(&finger)),
                },
            }
        })
    }

    /// The setup's tones as a chord, if they are one that the device can play with its plate's table.
    pub(crate) fn chord(&self) -> Option<&ChordRequest> {
        let made = self.screen_table().filter(|_| self.snapshot.can_play_chords())?;
        let chord = self.prediction.chord.get_or_init(|| {
            #[cfg(test)]
            tests::count(&tests::CHORDS);
            chord_of(&self.setup, &made.device_table)
        });
        chord.as_ref()
    }

    /// The line of the tone in a slot.
    pub fn line(&self, slot: u8) -> Option<&Line> {
        self.predicted().lines.iter().find(|line| line.slot == slot)
    }

    /// Place of the felt edge that the line of a slot keeps while levels change, in metres.
    pub(crate) fn edge_m(&self, slot: u8) -> Option<f64> {
        let kept = self.edges_m.iter().find(|(of, _)| *of == slot).map(|(_, place_m)| *place_m);
        let line = || self.line(slot).filter(|line| line.holds == Holds::FeltEdge);
        kept.or_else(|| line().map(|line| line.place_m))
    }

    /// Range of the line of the selected tone, in metres.
    pub(crate) fn limits_m(&self) -> (f64, f64) {
        let setup = &self.setup;
        let Some(tone) = setup.tone(self.selected) else { return setup.plate.span_m() };
        let made = self.screen_table();
        let known = self.limits.borrow();
        if let Some(limits) = known.as_ref().filter(|limits| limits.is_of(setup, tone.level, made)) {
            return limits.range_m;
        }
        drop(known);
        #[cfg(test)]
        tests::count(&tests::LIMITS);
        let range_m = line::limits_m(setup, tone, self.drive_table());
        let (plate, made) = (Arc::clone(&setup.plate), made.cloned());
        let Setup { master_db, boundary, feeling, .. } = *setup;
        let limits = Limits { plate, made, level: tone.level, master_db, boundary, feeling, range_m };
        self.limits.replace(Some(limits));
        range_m
    }

    /// The peak at level 1 and full master, in metres; `None` until the plate's table is finished.
    pub fn full_peak_m(&self) -> Option<f64> {
        self.drive_table().map(|table| table.peak_at_full_scale_m())
    }

    /// The table of the setup's plate, once it is finished.
    pub(crate) fn drive_table(&self) -> Option<&DriveTable> {
        self.screen_table().map(|made| &made.drive_table)
    }
}

//! Prediction of the setup's response on its plate. It is computed on demand, once after any number of
//! changes.

use crate::instrument::desk::Desk;
use crate::instrument::drive::Drive;
#[cfg(test)]
use crate::instrument::tests;
use slipline_model::field::felt::Felt;
use slipline_model::field::harmonics::felt_with_harmonics;
use slipline_model::field::line::{self, Holds, Line};
use slipline_model::field::steady_field::{SteadyField, steady_tones};
use slipline_model::jobs::table::TableMade;
use slipline_model::setup::{BoundaryMode, Setup};
use slipline_plate::feeling::Feeling;
use slipline_plate::{Finger, Plate};
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

/// Predicted quantities of the setup's tones. The default: nothing is computed yet.
#[derive(Default)]
pub(super) struct Prediction {
    field: OnceCell<Predicted>,
    limits: RefCell<Option<Limits>>,
    /// Felt edges by slot, in metres, that the lines keep since the latest change that moved one.
    edges_m: Vec<(u8, f64)>,
}

/// The range of a line, in metres, and all that it follows from. The place of the line is not among that, so a drag finds the
/// range once.
struct Limits {
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
pub(super) struct Predicted {
    /// The plate under the tones, with the finger if there is one.
    pub(super) field: SteadyField,
    /// What is felt without a finger; `None` while its height is not known.
    pub(super) felt: Option<Felt>,
    /// The boundary line of each tone, in their order.
    pub(super) lines: Vec<Line>,
}

impl Prediction {
    /// Discards the field: the setup, its table or the finger has changed.
    pub(super) fn forget(&mut self) {
        self.field = OnceCell::new();
    }

    /// The setup or its table has changed, and the lines keep these felt edges, by slot and in metres.
    pub(super) fn keep_edges(&mut self, edges_m: Vec<(u8, f64)>) {
        self.forget();
        self.edges_m = edges_m;
    }

    /// The prediction for the setup, under this finger.
    pub(super) fn predicted(&self, desk: &Desk, drive: &Drive, load: Option<Finger>) -> &Predicted {
        self.field.get_or_init(|| {
            #[cfg(test)]
            tests::count(&tests::FIELDS);
            let (setup, table) = (desk.setup(), drive.drive_table());
            let without_chord = drive.chord(setup).is_none().then(|| setup.without_chord());
            let played = without_chord.as_ref().unwrap_or(setup);
            let tones = steady_tones(played, table);
            let alone = SteadyField::solve(&setup.plate, &tones);
            let known = table.map(|_| &alone);
            let mut lines = line::lines(setup, known);
            // Until the height is known, the lines that keep a place stand there.
            for line in lines.iter_mut().filter(|_| known.is_none()) {
                if let Some((_, place_m)) = self.edges_m.iter().find(|(slot, _)| *slot == line.slot) {
                    *line = Line { place_m: *place_m, holds: Holds::FeltEdge, ..*line };
                }
            }
            Predicted {
                lines,
                felt: known.map(|known| felt_with_harmonics(played, known)),
                field: match load {
                    None => alone,
                    Some(finger) => SteadyField::solve_touched(&setup.plate, &tones, Some(&finger)),
                },
            }
        })
    }

    /// The felt edges that lines keep while levels change, by slot and in metres.
    pub(super) fn edges_m(&self, desk: &Desk, drive: &Drive, load: Option<Finger>) -> Vec<(u8, f64)> {
        let edge_m = |slot| {
            let kept = self.edges_m.iter().find(|(of, _)| *of == slot).map(|(_, place_m)| *place_m);
            let is_edge = |line: &&Line| line.slot == slot && line.holds == Holds::FeltEdge;
            let line = || self.predicted(desk, drive, load).lines.iter().find(is_edge);
            kept.or_else(|| line().map(|line| line.place_m))
        };
        desk.setup().tones.iter().filter_map(|tone| Some((tone.slot, edge_m(tone.slot)?))).collect()
    }

    /// Range of the line of the selected tone, in metres.
    pub(super) fn limits_m(&self, desk: &Desk, drive: &Drive) -> (f64, f64) {
        let setup = desk.setup();
        let Some(tone) = desk.tone() else { return setup.plate.span_m() };
        let made = drive.table_made();
        let known = self.limits.borrow();
        if let Some(limits) = known.as_ref().filter(|limits| limits.is_of(setup, tone.level, made)) {
            return limits.range_m;
        }
        drop(known);
        #[cfg(test)]
        tests::count(&tests::LIMITS);
        let range_m = line::limits_m(setup, tone, drive.drive_table());
        let (plate, made) = (Arc::clone(&setup.plate), made.cloned());
        let Setup { master_db, boundary, feeling, .. } = *setup;
        let limits = Limits { plate, made, level: tone.level, master_db, boundary, feeling, range_m };
        self.limits.replace(Some(limits));
        range_m
    }
}

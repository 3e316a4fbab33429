//! Lines that keep their places when a calibrated plate is used. Only its table shows how far a level moves it, and so how far
//! from its turning point a tone is felt: until then the lines are shown where they were, then the tones follow them.

use super::Instrument;
use slipline_model::setup::edit::Edit;
use slipline_plate::Plate;
use slipline_plate::quantity::{show_length, show_place};
use std::sync::Arc;

/// A line that is farther off its place than this has moved, in metres: the smallest step of the arrow keys.
const MOVED_M: f64 = 1e-4;
/// A full scale that has changed by less than this share is not worth a message.
const SAME: f64 = 0.05;

/// The lines before the calibrated plate was used.
pub(super) struct HeldLines {
    plate: Arc<Plate>,
    /// Their felt edges, by slot and in metres.
    edges_m: Vec<(u8, f64)>,
    /// The peak at level 1 on the plate before, in metres.
    full_peak_m: Option<f64>,
}

impl Instrument {
    /// Uses a plate that was calibrated on the present one; the lines keep their felt edges.
    pub(super) fn use_calibrated(&mut self, plate: Arc<Plate>) {
        let edges_m = self.screen.edges_m(&self.desk, &self.drive);
        let full_peak_m = self.drive.full_peak_m();
        self.edit(&Edit::Plate(Arc::clone(&plate)));
        self.screen.keep_edges(edges_m.clone());
        self.held = Some(HeldLines { plate, edges_m, full_peak_m });
    }

    /// Moves the tones to where the lines keep their places, now that the calibrated plate's table is there. It says how far a
    /// level moves this plate, if the file said something else, and which line could not stay.
    pub(super) fn hold_lines(&mut self) {
        let is_in_use = |held: &HeldLines| Arc::ptr_eq(&held.plate, self.desk.plate());
        let Some(held) = self.held.take().filter(is_in_use) else { return };
        let mut said = Vec::new();
        if let (Some(before_m), Some(now_m)) = (held.full_peak_m, self.drive.full_peak_m())
            && (now_m / before_m - 1.0).abs() > SAME
        {
            let (now, before) = (show_length(now_m), show_length(before_m));
            said.push(format!("At level 1 the calibrated plate moves by {now}, not by {before} as its file said."));
        }
        let count = held.edges_m.len();
        for (slot, place_m) in held.edges_m {
            let table = self.drive.drive_table();
            if let Some(Edit::Move { position_m, .. }) = self.desk.line_move(slot, place_m, table) {
                self.show_line(slot, position_m);
            }
            let Some(now_m) = self.line(slot).map(|line| line.place_m) else { continue };
            if (now_m - place_m).abs() > MOVED_M {
                let (before, now) = (show_place(place_m), show_place(now_m));
                let whose = if count > 1 { format!(" of tone {}", slot + 1) } else { String::new() };
                said.push(format!("The line{whose} cannot stay at {before}: it is at {now}."));
            }
        }
        if !said.is_empty() {
            self.out.post(said.join(" "));
        }
    }
}

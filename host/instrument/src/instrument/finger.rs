//! The finger on the plate: a choice of the view, like the colours. It is not part of the setup, so it is
//! neither saved nor undone. Nothing about it is sent to the device, and the drive does not change.

use super::Instrument;
use slipline_model::field::steady_field::{SteadyField, SteadyTone};
use slipline_model::field::touch::{Touch, Trace, Under, refusal};
use slipline_plate::Finger;

/// The state of the finger.
#[derive(Default)]
pub(crate) struct OnPlate {
    /// Which finger, if any.
    pub(crate) touch: Touch,
    /// Its present or last place, in metres from the driven end.
    pub(crate) place_m: f64,
    /// The amplitudes under it so far.
    pub(crate) trace: Trace,
}

impl Instrument {
    /// The finger on the plate, if there is one; a plate that states no mass has none that loads it.
    pub fn finger(&self) -> Option<Finger> {
        let (plate, touch) = (&self.setup.plate, self.finger.touch);
        let finger = touch.at(self.finger.place_m.clamp(0.0, plate.length_m()))?;
        (!touch.loads() || refusal(plate).is_none()).then_some(finger)
    }

    /// The finger under which the plate moves otherwise, if there is one.
    pub fn load(&self) -> Option<Finger> {
        self.finger().filter(|_| self.finger.touch.loads())
    }

    /// Puts a finger on the plate, at the peak of the selected tone, or takes it off.
    pub fn touch(&mut self, touch: Touch) {
        let before = self.finger.touch;
        if before == Touch::None {
            let wave = self.predicted().field.tone(self.selected);
            let peak_m = wave.map(|wave| wave.peak_position_m.unwrap_or(wave.turning_point_m));
            self.finger.place_m = peak_m.unwrap_or(0.5 * self.setup.plate.length_m());
        }
        self.finger.touch = touch;
        if touch == Touch::None {
            self.end_trace();
        }
        if before.loads() || touch.loads() {
            self.solve_touched();
        }
        if before.loads() && !touch.loads() {
            self.resume_sheet();
        }
    }

    /// Moves the finger to a place, in metres from the driven end; it stays on the plate.
    pub fn move_finger(&mut self, place_m: f64) {
        if place_m.is_finite() {
            self.finger.place_m = place_m.clamp(0.0, self.setup.plate.length_m());
            if self.finger.touch.loads() {
                self.solve_touched();
            }
        }
    }

    /// Lifts the finger temporarily; returns which one it was.
    pub fn lift_finger(&mut self) -> Touch {
        let touch = std::mem::take(&mut self.finger.touch);
        // The sheet did not follow the drive while the plate was touched.
        self.drop_sheet();
        self.solve_touched();
        touch
    }

    /// Puts a finger back after [`lift_finger`](Self::lift_finger).
    pub fn touch_again(&mut self, touch: Touch) {
        self.finger.touch = touch;
        self.solve_touched();
    }

    /// Solves the predicted and the sounding field again.
    fn solve_touched(&mut self) {
        self.forget_prediction();
        let finger = self.load();
        if self.sounding_on_screen().is_some()
            && let Some(sounding) = &mut self.playback.sounding
        {
            let tones: Vec<SteadyTone> = sounding.steady.tones.iter().map(|wave| wave.tone).collect();
            sounding.steady = SteadyField::solve_touched(&sounding.plate, &tones, finger.as_ref());
        }
    }

    /// Adds the present amplitude under the finger to its trace; called only while the wave moves.
    pub(crate) fn trace_finger(&mut self, now_s: f64) {
        let plate = &self.setup.plate;
        let (Some(finger), Some(sounding)) = (self.finger(), self.playback.on(plate)) else { return };
        let (field, felt, feeling) = (&sounding.steady, &sounding.felt, &self.setup.feeling);
        self.finger.trace.push(&Under { plate, field, felt, feeling }, &finger, now_s);
    }

    /// Clears the trace: the finger was lifted, or the wave under it has changed.
    pub(crate) fn end_trace(&mut self) {
        self.finger.trace.clear();
    }
}

//! The finger on the plate: a choice of the view, like the colours. It is not part of the setup, so it is
//! neither saved nor undone. Nothing about it is sent to the device, and the drive does not change.

use super::{Screen, Sight};
use slipline_model::field::steady_field::{SteadyField, SteadyTone};
use slipline_model::field::touch::{Touch, Trace, Under, refusal};
use slipline_plate::Finger;

/// The state of the finger.
#[derive(Default)]
pub(super) struct OnPlate {
    /// Which finger, if any.
    pub(super) touch: Touch,
    /// Its present or last place, in metres from the driven end.
    pub(super) place_m: f64,
    /// The amplitudes under it so far.
    pub(super) trace: Trace,
}

impl Screen {
    /// The finger on the plate, if there is one; a plate that states no mass has none that loads it.
    pub fn finger(&self) -> Option<Finger> {
        let touch = self.finger.touch;
        let finger = touch.at(self.finger.place_m.clamp(0.0, self.plate.length_m()))?;
        (!touch.loads() || refusal(&self.plate).is_none()).then_some(finger)
    }

    /// The finger under which the plate moves otherwise, if there is one.
    pub fn load(&self) -> Option<Finger> {
        self.finger().filter(|_| self.finger.touch.loads())
    }

    /// The finger's present or last place, in metres from the driven end.
    #[must_use]
    pub const fn finger_place_m(&self) -> f64 {
        self.finger.place_m
    }

    /// The recent amplitudes under the finger.
    #[must_use]
    pub const fn trace(&self) -> &Trace {
        &self.finger.trace
    }

    /// Puts a finger on the plate, at the peak of the selected tone, or takes it off.
    pub(crate) fn touch(&mut self, touch: Touch, sight: Sight<'_>) {
        let before = self.finger.touch;
        if before == Touch::None {
            let wave = self.predicted(sight).field.tone(sight.desk.selected());
            let peak_m = wave.map(|wave| wave.peak_position_m.unwrap_or(wave.turning_point_m));
            self.finger.place_m = peak_m.unwrap_or(0.5 * self.plate.length_m());
        }
        self.finger.touch = touch;
        if touch == Touch::None {
            self.finger.trace.clear();
        }
        if before.loads() || touch.loads() {
            self.solve_touched();
        }
        if before.loads() && !touch.loads() {
            self.resume_sheet(sight);
        }
    }

    /// Moves the finger to a place, in metres from the driven end; it stays on the plate.
    pub fn move_finger(&mut self, place_m: f64) {
        if place_m.is_finite() {
            self.finger.place_m = place_m.clamp(0.0, self.plate.length_m());
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
        self.prediction.forget();
        let finger = self.load();
        if self.sounding().is_some()
            && let Some(sounding) = &mut self.playback.sounding
        {
            let tones: Vec<SteadyTone> = sounding.steady.tones.iter().map(|wave| wave.tone).collect();
            sounding.steady = SteadyField::solve_touched(&sounding.plate, &tones, finger.as_ref());
        }
    }

    /// Adds the present amplitude under the finger to its trace; called only while the wave moves.
    pub(super) fn trace_finger(&mut self, sight: Sight<'_>) {
        let plate = &self.plate;
        let (Some(finger), Some(sounding)) = (self.finger(), self.playback.on(plate)) else { return };
        let (field, felt, feeling) = (&sounding.steady, &sounding.felt, &sight.desk.setup().feeling);
        let under = Under { plate, field, felt, feeling };
        self.finger.trace.push(&under, &finger, sight.attention.now_s);
    }
}

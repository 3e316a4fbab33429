//! The demonstration of the very first start, of Help and of a window for visitors: a finger strokes the simulated plate, the
//! line moves, the finger follows.
//!
//! It moves nothing on a real device, makes no sound and no step of undo. What the user does ends it, and then everything is
//! where it was; what a window manager does while it places the window under the pointer does not.

use super::{App, Lead};
use eframe::egui;
use slipline_model::field::touch::Touch;
use slipline_model::setup::Setup;

/// Duration, in seconds.
const LASTS_S: f64 = 10.0;

/// The place of finger and line at these times, in seconds, as shares of the way: the finger's from the driven end to the
/// line (1 is the line), the line's from where it stands to the start of its span.
const COURSE: [(f64, f64, f64); 7] = [
    (0.0, 0.5, 0.0),
    (1.5, 0.2, 0.0),
    (4.0, 1.2, 0.0),
    (6.0, 1.2, 0.8),
    (8.0, 0.4, 0.8),
    (9.0, 0.8, 0.4),
    (10.0, 0.5, 0.0),
];

/// A demonstration under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Demonstration {
    /// When it began; `None` until the plate moves.
    began_s: Option<f64>,
    /// The line's slot and turning point before it, in metres.
    line: (u8, f64),
}

/// The shares of the [`COURSE`] at a time, smooth between its points.
fn shares_at(time_s: f64) -> (f64, f64) {
    let after = COURSE.iter().position(|(at_s, ..)| *at_s > time_s).unwrap_or(COURSE.len() - 1);
    let ((from_s, finger, line), (to_s, next_finger, next_line)) =
        (COURSE[after.max(1) - 1], COURSE[after.max(1)]);
    let share = ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
    let eased = share * share * (3.0 - 2.0 * share);
    (finger + (next_finger - finger) * eased, line + (next_line - line) * eased)
}

impl App {
    /// Shows what the window is for, until the user does something.
    pub fn demonstrate(&mut self) {
        if let Some(demonstration) = self.demonstration() {
            self.lead = Lead::Demonstration(demonstration);
        }
    }

    /// A demonstration with the line of the selected tone, from where it stands.
    pub(super) fn demonstration(&self) -> Option<Demonstration> {
        let tone = self.setup().tone(self.instrument.desk.selected())?;
        Some(Demonstration { began_s: None, line: (tone.slot, tone.position_m) })
    }

    /// Shows the demonstration at the user's request: drives the simulated plate, if it rests. On another device nothing is
    /// moved by itself.
    pub(super) fn replay_demonstration(&mut self) {
        let snapshot = self.instrument.drive.snapshot();
        if !snapshot.is_simulated() {
            let text = "The demonstration moves the simulated plate alone: choose Simulated plate in the list of devices.";
            return self.instrument.out.post(text.to_owned());
        }
        self.instrument.start_simulated();
        self.demonstrate();
    }

    /// Whether a demonstration moves the line.
    #[must_use]
    pub fn is_demonstrating(&self) -> bool {
        matches!(self.lead, Lead::Demonstration(_)) || self.kiosk().is_some_and(|kiosk| kiosk.shows.is_some())
    }

    /// Goes on with the demonstration, or ends it.
    pub(super) fn advance_demonstration(&mut self, ctx: &egui::Context) {
        let Lead::Demonstration(under_way) = self.lead else { return };
        let snapshot = self.instrument.drive.snapshot();
        let is_elsewhere = snapshot.is_connected() && !snapshot.is_simulated();
        if is_elsewhere || self.dialog.is_some() || ctx.input(has_input) {
            return self.end_demonstration();
        }
        match self.demonstrated(ctx, under_way) {
            Some(next) => self.lead = Lead::Demonstration(next),
            None => self.end_demonstration(),
        }
    }

    /// The demonstration after one more step of it; `None` at its end.
    pub(super) fn demonstrated(
        &mut self,
        ctx: &egui::Context,
        under_way: Demonstration,
    ) -> Option<Demonstration> {
        let now_s = ctx.input(|input| input.time);
        if self.instrument.screen.sounding().is_none() {
            // It waits for a plate that does not move yet.
            return under_way.began_s.is_none().then_some(under_way);
        }
        let began_s = under_way.began_s.unwrap_or(now_s);
        if now_s - began_s >= LASTS_S {
            return None;
        }
        let (finger, line) = shares_at(now_s - began_s);
        let (slot, turns_m) = under_way.line;
        let (start_m, _) = self.instrument.desk.setup().plate.span_m();
        self.instrument.show_line(slot, turns_m + line * (start_m - turns_m));
        let line_m = self.instrument.line(slot).map_or(turns_m, |line| line.place_m);
        if self.instrument.screen.finger().is_none() {
            self.instrument.touch(Touch::Ideal);
        }
        self.instrument.screen.move_finger(finger * line_m);
        ctx.request_repaint();
        Some(Demonstration { began_s: Some(began_s), ..under_way })
    }

    /// Ends the demonstration: everything is where it was.
    pub fn end_demonstration(&mut self) {
        let Lead::Demonstration(under_way) = self.lead else { return };
        self.lead = Lead::User;
        self.put_back(under_way);
    }

    /// Puts the line back, and the finger half-way to it.
    pub(super) fn put_back(&mut self, Demonstration { line: (slot, turns_m), began_s }: Demonstration) {
        if began_s.is_some() {
            self.instrument.show_line(slot, turns_m);
            self.rest_finger();
        }
    }

    /// The user's setup, to be kept: the line of a demonstration is not the user's.
    #[must_use]
    pub fn kept_setup(&self) -> Setup {
        let mut setup = self.setup().clone();
        if let Lead::Demonstration(Demonstration { line: (slot, turns_m), began_s: Some(_) }) = self.lead
            && let Some(tone) = setup.tones.iter_mut().find(|tone| tone.slot == slot)
        {
            tone.position_m = turns_m;
        }
        setup
    }

    /// Lays a finger that takes nothing half-way to the line.
    pub(super) fn rest_finger(&mut self) {
        self.instrument.touch(Touch::Ideal);
        if let Some(line) = self.instrument.line(self.instrument.desk.selected()) {
            let half_m = 0.5 * line.place_m;
            self.instrument.screen.move_finger(half_m);
        }
    }
}

/// Whether the user has pressed, typed, turned a wheel or dropped something. A list of what is input and not of what is none:
/// window managers differ in what they send to a window that they map, place and focus. A pointer that only moves ends nothing:
/// it also moves over the window when that is placed under it, and away from the entry in the menu.
pub(super) fn has_input(input: &egui::InputState) -> bool {
    use egui::Event;
    let is_made = |event: &Event| {
        matches!(
            event,
            Event::Key { pressed: true, repeat: false, .. }
                | Event::PointerButton { pressed: true, .. }
                | Event::Touch { phase: egui::TouchPhase::Start, .. }
                | Event::MouseWheel { .. }
                | Event::Zoom(_)
                | Event::Copy
                | Event::Cut
                | Event::Paste(_)
                | Event::AccessKitActionRequest(_)
        )
    };
    input.events.iter().any(is_made) || !input.raw.dropped_files.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_course_begins_and_ends_at_rest_and_crosses_the_line() {
        assert_eq!(shares_at(0.0), shares_at(LASTS_S));
        let finger = |i: i32| shares_at(LASTS_S * f64::from(i) / 200.0).0;
        let crosses = (0..200).filter(|&i| (finger(i) < 1.0) != (finger(i + 1) < 1.0)).count();
        assert!(crosses >= 2, "{crosses}");
        assert!((0..=200).all(|i| (0.0..=1.3).contains(&finger(i))));
    }
}

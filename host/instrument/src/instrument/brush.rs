//! The brush: a wanted amplitude that is drawn over the envelope. The setup's tones follow each fit; a stroke is one step of
//! undo. As with every change, they are sent only while the user has the plate driven.

use super::Instrument;
use slipline_model::setup::edit::Edit;
use slipline_model::setup::undo::Gesture;
use std::time::Duration;

/// Time between two drives of a drawing, in seconds. Each begins from rest, because its tones would glide across the plate.
const BETWEEN_DRIVES_S: f64 = 0.3;

/// A drawing over the envelope. The default: nothing is drawn.
#[derive(Debug, Default)]
pub(crate) struct Brush {
    /// The gesture of the latest stroke; `None` once anything else has changed the setup.
    stroke: Option<Gesture>,
    /// Whether the next change of the setup is the drawing's own.
    is_following: bool,
    /// When tones of the drawing were sent last, in seconds of the user's time.
    sent_s: Option<f64>,
    /// Whether there are newer ones.
    has_unsent: bool,
}

impl Brush {
    /// Whether the setup is that of a drawing.
    pub(crate) const fn is_drawn(&self) -> bool {
        self.stroke.is_some()
    }

    pub(crate) fn begin_stroke(&mut self, gesture: Gesture) {
        self.stroke = Some(gesture);
    }

    /// The setup changes: returns whether the drawing changes it; any other change ends the drawing.
    pub(crate) fn takes_change(&mut self) -> bool {
        if self.is_following {
            self.has_unsent = true;
        } else {
            *self = Self::default();
        }
        self.is_following
    }
}

impl Instrument {
    /// Forgets the drawing: the next stroke begins another one.
    pub fn end_drawing(&mut self) {
        self.brush = Brush::default();
    }

    /// Puts the tones of a drawing into the setup, as a part of its latest stroke.
    pub(crate) fn follow_drawing(&mut self, edit: &Edit) {
        let Some(gesture) = self.brush.stroke else { return };
        self.note_turning_points();
        self.brush.is_following = true;
        self.edit_by(gesture, edit);
        self.brush.is_following = false;
    }

    /// Sends the newest tones of a drawing, once the time for them has come.
    pub(crate) fn send_drawing(&mut self) {
        if !self.brush.has_unsent {
            return;
        }
        let now_s = self.attention.now_s;
        let wait_s = self.brush.sent_s.map_or(0.0, |sent_s| sent_s + BETWEEN_DRIVES_S - now_s);
        if wait_s > 0.0 {
            return self.wake_after(Duration::from_secs_f64(wait_s));
        }
        self.brush.has_unsent = false;
        if self.autopilot.may_drive(&self.snapshot) {
            self.brush.sent_s = Some(now_s);
            self.send_drive();
        }
    }
}

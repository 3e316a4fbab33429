//! The brush: a wanted amplitude that is drawn over the envelope. The setup's tones follow each fit; a stroke is one step of
//! undo. As with every change, they are sent only while the user has the plate driven.

use crate::instrument::outbox::Outbox;
use slipline_model::setup::undo::Gesture;
use std::time::Duration;

/// Time between two drives of a drawing, in seconds. Each begins from rest, because its tones would glide across the plate.
const BETWEEN_DRIVES_S: f64 = 0.3;

/// A drawing over the envelope. The default: nothing is drawn.
#[derive(Debug, Default)]
pub(super) struct Brush {
    /// The gesture of the latest stroke; `None` once anything else has changed the setup.
    stroke: Option<Gesture>,
    /// When tones of the drawing were sent last, in seconds of the user's time.
    sent_s: Option<f64>,
    /// Whether there are newer ones.
    has_unsent: bool,
}

impl Brush {
    /// Whether the setup is that of a drawing.
    pub(super) const fn is_drawn(&self) -> bool {
        self.stroke.is_some()
    }

    /// The gesture of the latest stroke, while the setup is that of a drawing.
    pub(super) const fn stroke(&self) -> Option<Gesture> {
        self.stroke
    }

    pub(super) const fn begin_stroke(&mut self, gesture: Gesture) {
        self.stroke = Some(gesture);
    }

    /// The setup has changed, by the drawing or otherwise; any other change ends the drawing.
    pub(super) fn follow_change(&mut self, is_own: bool) {
        if is_own {
            self.has_unsent = true;
        } else {
            *self = Self::default();
        }
    }

    /// Whether the time has come for the newest tones of a drawing, which are then sent if the plate is driven.
    pub(super) fn is_due(&mut self, now_s: f64, is_driven: bool, out: &mut Outbox) -> bool {
        if !self.has_unsent {
            return false;
        }
        let wait_s = self.sent_s.map_or(0.0, |sent_s| sent_s + BETWEEN_DRIVES_S - now_s);
        if wait_s > 0.0 {
            out.wake_after(Duration::from_secs_f64(wait_s));
            return false;
        }
        self.has_unsent = false;
        if is_driven {
            self.sent_s = Some(now_s);
        }
        is_driven
    }
}

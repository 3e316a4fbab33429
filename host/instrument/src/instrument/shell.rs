//! What passes between an instrument and its shell: the link it is given, what it must know of the shell, and what it has the
//! shell do.

use slipline_link::{Request, Snapshot, Ticket};
use slipline_model::field::sheet::SourceChoice;
use std::sync::Arc;

/// The link as an instrument needs it: the worker, or a test's stand-in that records the requests.
pub trait Link {
    /// Sends a request; never blocks.
    fn send(&self, request: Request) -> Ticket;
    /// The latest snapshot of link and device.
    fn snapshot(&self) -> Arc<Snapshot>;
}

#[cfg(feature = "native")]
impl Link for slipline_link::native::Handle {
    fn send(&self, request: Request) -> Ticket {
        Self::send(self, request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Self::snapshot(self)
    }
}

/// What the shell shows and the user holds, as far as it decides what is done next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Attention {
    /// The user's time, in seconds.
    pub now_s: f64,
    /// Whether a pointer is down: levels and places may still change.
    pub is_pressed: bool,
    /// Whether a line or the finger is dragged.
    pub is_dragging: bool,
    /// Whether the wave moves, or is paused.
    pub is_animated: bool,
    /// Whether a page is in front.
    pub has_page: bool,
    /// Whether that is the calibration.
    pub is_calibration_open: bool,
    /// Whether the page of measurements is open.
    pub is_measurements_open: bool,
    /// Whether the texture page is open.
    pub is_texture_open: bool,
    /// The source from which the wave is to be drawn.
    pub wave: SourceChoice,
    /// Whether a real device gets a new table without being asked.
    pub uploads: bool,
}

/// A page that the shell opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Page {
    /// The calibration.
    Calibration,
    /// The page of measurements.
    Measurements,
    /// The texture page.
    Texture,
    /// The question whether a real amplifier may be unmuted.
    Arm,
}

/// What the shell does for the instrument.
#[derive(Clone, Debug)]
pub enum Output {
    /// Open a page.
    Open(Page),
    /// Close the calibration's pages.
    CloseCalibration,
    /// Have the user choose a file of a measurement.
    ChooseMeasurement,
    /// Have the user save a file.
    Save {
        /// The name that is proposed.
        name: String,
        /// What it is, in a word.
        kind: &'static str,
        /// The ending of its name.
        extension: &'static str,
        /// What is in it.
        bytes: Vec<u8>,
    },
}

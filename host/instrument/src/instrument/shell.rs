//! Interface between an instrument and its shell: the link, the state of the shell that the instrument needs,
//! and the actions that the shell carries out.

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

/// State of the shell that decides the next requests and work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Attention {
    /// The user's time, in seconds.
    pub now_s: f64,
    /// How long before that the press was made that is handled now, in seconds: it has waited for the shell.
    pub press_age_s: f64,
    /// Whether a pointer is down: levels and places may still change.
    pub is_pressed: bool,
    /// Whether a line or the finger is dragged.
    pub is_dragging: bool,
    /// Whether the wave moves, or is paused.
    pub is_animated: bool,
    /// Whether a page is in front.
    pub has_page: bool,
    /// Whether that page is the calibration.
    pub is_calibration_open: bool,
    /// Whether the page of measurements is open.
    pub is_measurements_open: bool,
    /// Whether the texture page is open.
    pub is_texture_open: bool,
    /// The source from which the wave is to be drawn.
    pub wave: SourceChoice,
    /// Whether a real device gets a new table automatically.
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
    /// The page of the line.
    Boundary,
    /// The page of the plate.
    Plate,
    /// The question whether a real amplifier may be unmuted.
    Arm,
}

/// An action that the shell carries out for the instrument.
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
        /// The proposed name.
        name: String,
        /// Its kind, in a word.
        kind: &'static str,
        /// The extension of its name.
        extension: &'static str,
        /// Its content.
        bytes: Vec<u8>,
    },
}

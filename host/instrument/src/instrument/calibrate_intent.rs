//! The requests of the calibration's pages.

use crate::calibration::WizardPage;
use slipline_plate::calibrate::Calipers;

/// A request of the calibration's pages. The sensor's first place is 0, its second 1.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrateIntent {
    /// Open the pages: a new calibration, or the one that was closed.
    Open,
    /// Give the calibration up.
    Cancel,
    /// Open this page.
    Page(WizardPage),
    /// Take what calipers say, or the file's numbers.
    Calipers(Option<Calipers>),
    /// Choose a file of the answer that the open page asks for.
    OpenAnswer,
    /// Take the measurement of this number for the answer at this place.
    TakeAnswer(usize, u64),
    /// Take each answer for the other one.
    Exchange,
    /// Put the calibrated plate in the setup.
    Use,
    /// Save the calibrated plate as a plate file.
    Save,
}

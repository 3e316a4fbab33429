//! The requests of the calibration's pages.

use crate::calibration::WizardPage;
use slipline_plate::calibrate::Calipers;

/// A request of the calibration's pages. The sensor's first place is 0, its second 1, that of the check 2.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrateIntent {
    /// Open the pages: a new calibration, or the one that was closed.
    Open,
    /// Discard the calibration.
    Cancel,
    /// Open this page.
    Page(WizardPage),
    /// Use these caliper measurements, or the file's dimensions.
    Calipers(Option<Calipers>),
    /// Choose a file with the response that the open page asks for.
    OpenAnswer,
    /// Use the measurement of this number as the response at this place.
    TakeAnswer(usize, u64),
    /// Do without the check of a third place.
    LeaveCheckOut,
    /// Swap the two responses.
    Exchange,
    /// Put the calibrated plate in the setup.
    Use,
    /// Save the calibrated plate as a plate file.
    Save,
}

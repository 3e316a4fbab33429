//! The comparison of the device's codes with the mirror's, as `slipline verify` makes it. What ends a measurement ends it, too.

use super::Reach;
use super::under_way::UnderWay;
use crate::measure::{MeasureError, Verified, VerifiedWindow, Verifying};
use slipline_link::protocol::limits::MAX_TONES;

/// Length of each window of codes, in seconds.
pub(super) const WINDOW_S: f64 = 0.1;

impl UnderWay<Verifying> {
    /// Continues the comparison under way, and reports its end.
    pub(super) fn update(&mut self, reach: &mut Reach<'_>) {
        let Some((found, _)) = self.turn(reach) else { return };
        match found {
            Ok(Verified { equal: true, windows }) => reach.out.post(format!(
                "The device sends the mirror's codes: {} windows of {MAX_TONES} tones are equal.",
                windows.len()
            )),
            Ok(Verified { windows, .. }) => reach.out.fail(format!(
                "The device's codes differ from the mirror's: {}.",
                different(&windows).join(", ")
            )),
            Err(MeasureError::Cancelled) => {
                reach.out.post("The comparison of the codes was cancelled.".to_owned());
            }
            Err(error) => reach.out.fail(format!("The codes were not compared: {error}.")),
        }
    }
}

/// The stages whose windows differ.
fn different(windows: &[VerifiedWindow]) -> Vec<&'static str> {
    windows.iter().filter(|window| !window.equal).map(|window| window.stage).collect()
}

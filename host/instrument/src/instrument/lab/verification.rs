//! The comparison of the device's codes with the mirror's, as `slipline verify` makes it. What ends a measurement ends it, too.

use super::measuring::MeasuringRefused;
use super::under_way::UnderWay;
use super::{Lab, Reach};
use crate::hold::HoldEnd;
use crate::measure::{MeasureError, Verified, VerifiedWindow, Verifying};
use slipline_link::protocol::limits::MAX_TONES;

/// Length of each window of codes, in seconds.
const WINDOW_S: f64 = 0.1;

impl Lab {
    /// Begins if the device may drive and holds the table of this plate; otherwise reports the obstacle.
    pub(super) fn begin_verification(&mut self, reach: &mut Reach<'_>) {
        if self.is_measuring() {
            return;
        }
        let obstacle = match reach.drive.obstacle() {
            Some(obstacle) => Some(obstacle.into()),
            None => (!reach.drive.is_table_there()).then_some(MeasuringRefused::NoTable),
        };
        if let Some(obstacle) = obstacle {
            return reach.out.hinder(obstacle.to_string());
        }
        self.end_hold(HoldEnd::Measured, reach.out);
        reach.drive.make_ready();
        let rate_hz = reach.drive.sample_rate_hz();
        let verifying = Verifying::new(reach.desk.plate(), MAX_TONES as u8, WINDOW_S, rate_hz);
        let text = "Comparing the device's codes with the mirror's.".to_owned();
        self.verification.begin(verifying, text, reach);
    }
}

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

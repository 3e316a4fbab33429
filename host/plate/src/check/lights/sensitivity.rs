//! The light for what the table cannot know: the true wave speed and the true loss.

use crate::check::grading::{Finding, Site};
use crate::check::thresholds::SENSITIVITY_DB;
use crate::quantity::number_format::with_decimals;

/// The peak against the table's level where the plate is not quite the file's: the worst of its end, of speed and of loss.
pub(in crate::check) fn sensitivity_light(site: &Site<'_>) -> Finding {
    let (end, speed, loss) = (site.levels.by_end_db, site.levels.by_speed_db, site.levels.by_loss_db);
    let worst = end.max(speed).max(loss);
    // Both others include what the end does.
    let by_end = end > 0.5 * worst;
    let off = if by_end {
        "The near field of the driven end, which this file leaves out,".to_owned()
    } else if loss <= speed {
        "A wave speed that is 1 % off".to_owned()
    } else {
        match site.plate.spec().loss_tolerance {
            Some(tolerance) => {
                format!("A loss that is {} times as high or as low", with_decimals(1.0 + tolerance, 2))
            }
            None => {
                "A loss that is halved or doubled (the plate file does not tell loss_tolerance)".to_owned()
            }
        }
    };
    site.graded(
        "sensitivity",
        worst,
        "dB",
        SENSITIVITY_DB,
        [
            format!("{off} changes the peak by {} dB: the table can be trusted.", with_decimals(worst, 2)),
            format!("{off} changes the peak by {worst:.1} dB: calibrate on your own plate."),
            if by_end {
                format!("{off} changes the peak by {worst:.0} dB: no table holds that, tell the drive's slope or its source.")
            } else if loss <= speed {
                format!("{off} changes the peak by {worst:.0} dB: no table holds that, match the drive end.")
            } else {
                format!("{off} changes the peak by {worst:.0} dB: no table holds that, measure the loss.")
            },
        ],
    )
    .at(site.peak_m())
}

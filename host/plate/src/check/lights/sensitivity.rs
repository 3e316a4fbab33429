//! The light for what the table cannot know: the true wave speed and the true loss.

use super::sound::level_words;
use crate::check::grading::{Finding, Site, colour};
use crate::check::report::{Colour, Limit};
use crate::check::thresholds::SENSITIVITY_DB;
use crate::quantity::number_format::with_decimals;

/// The peak against the table's level where the plate is not quite the file's: the worst of its end, of speed and of loss.
pub(in crate::check) fn sensitivity_light(site: &Site<'_>) -> Finding {
    if let Some(open_db) = site.levels.open_db(site.plate) {
        return calibrated_light(site, open_db);
    }
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

/// On a calibrated plate: what its calibration leaves open. Temperature and tension go on after it, so it is amber where a drift
/// of 1 % would leave nothing of the table.
fn calibrated_light(site: &Site<'_>, open_db: f64) -> Finding {
    let drift_db = site.levels.by_speed_db;
    let drifts = colour(drift_db, SENSITIVITY_DB) == Colour::Red;
    let judged = colour(open_db, SENSITIVITY_DB).max(if drifts { Colour::Amber } else { Colour::Green });
    let known = level_words(open_db);
    let drift = format!("a wave speed that drifts by 1 % changes it by {} dB", with_decimals(drift_db, 1));
    let sentence = match (colour(open_db, SENSITIVITY_DB), drifts) {
        (Colour::Green, false) => format!("By the calibration {known}: the table can be trusted; {drift}."),
        (Colour::Green, true) => {
            format!(
                "By the calibration {known}, but {drift}: calibrate again when the plate is warmer or colder."
            )
        }
        (Colour::Amber, _) => {
            format!("By the calibration {known}: measure it again with less noise; {drift}.")
        }
        _ => format!("By the calibration {known}: no table holds that, measure it again with less noise."),
    };
    let found = site.judged("sensitivity", Some(open_db), "dB", judged, open_db, sentence);
    // Where the drift decides it is not this number.
    let found = if judged > colour(open_db, SENSITIVITY_DB) {
        found
    } else {
        found.limited(Limit::AtMost(SENSITIVITY_DB))
    };
    found.at(site.peak_m())
}

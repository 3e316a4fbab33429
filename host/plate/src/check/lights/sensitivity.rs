//! The light for deviations of the wave speed and the loss from the plate file.

use super::sound::level_words;
use crate::check::grading::{Finding, Site, colour};
use crate::check::report::{Colour, Limit};
use crate::check::thresholds::SENSITIVITY_DB;
use crate::quantity::number_format::with_decimals;

/// Largest change of the peak from the table's level where the driven end, the wave speed or the loss differ from the
/// file's.
pub(in crate::check) fn sensitivity_light(site: &Site<'_>) -> Finding {
    if let Some(open_db) = site.levels.open_db(site.plate) {
        return calibrated_light(site, open_db);
    }
    let (end, speed, loss) = (site.levels.by_end_db, site.levels.by_speed_db, site.levels.by_loss_db);
    let worst = end.max(speed).max(loss);
    // The changes by speed and by loss include that by the end.
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
                "A loss that is halved or doubled (the plate file does not state loss_tolerance)".to_owned()
            }
        }
    };
    site.graded(
        "sensitivity",
        worst,
        "dB",
        Limit::AtMost(SENSITIVITY_DB),
        [
            format!("{off} changes the peak by {} dB: the table can be trusted.", with_decimals(worst, 2)),
            format!("{off} changes the peak by {worst:.1} dB: calibrate on your own plate."),
            if by_end {
                format!("{off} changes the peak by {worst:.0} dB: no table is accurate enough, state the drive's slope or its source.")
            } else if loss <= speed {
                format!("{off} changes the peak by {worst:.0} dB: no table is accurate enough, match the drive end.")
            } else {
                format!("{off} changes the peak by {worst:.0} dB: no table is accurate enough, measure the loss.")
            },
        ],
    )
    .at(site.peak_m())
}

/// The light of a calibrated plate: the interval of its level. Temperature and tension drift after a calibration, so
/// the light is amber where a drift of 1 % would make the table useless.
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
        _ => format!(
            "By the calibration {known}: no table is accurate enough, measure it again with less noise."
        ),
    };
    let found = site.judged("sensitivity", Some(open_db), "dB", judged, open_db, sentence);
    // Where the drift decides the colour, this number has no limit.
    let found = if judged > colour(open_db, SENSITIVITY_DB) {
        found
    } else {
        found.limited(Limit::AtMost(SENSITIVITY_DB))
    };
    found.at(site.peak_m())
}

//! Lights for the driven end, the actuator and the sensitivity of the table.

use crate::check::error::CheckError;
use crate::check::grading::{Finding, Site, colour, pick};
use crate::check::report::Colour;
use crate::check::thresholds::{ACTUATOR_LOSS_DB, DRIVE_MISMATCH, EXCURSION_PERCENT, SENSITIVITY_DB};
use crate::quantity::number_format::with_decimals;
use crate::spec::drive::DriveEnd;
use crate::spec::plate::Plate;
use crate::table::level::{DriveToPeak, level_over_speeds};

/// r = R omega/(T k0) at `frequency_hz`: the source's resistance over the plate's wave impedance at x = 0.
///
/// 0 for a force drive and infinite for a displacement drive, at any frequency. For a resistance `None` if the wave
/// cannot enter.
pub fn drive_ratio(plate: &Plate, frequency_hz: f64) -> Option<f64> {
    let width_mode = plate.width_mode(1);
    let k0 = |frequency_hz: f64| {
        let square = width_mode.wavenumber_squared(0.0, frequency_hz);
        (square > 0.0).then(|| square.sqrt())
    };
    match plate.spec().drive_end {
        DriveEnd::Displacement => Some(f64::INFINITY),
        DriveEnd::Force { .. } => Some(0.0),
        DriveEnd::Resistance { ratio, at_frequency_hz } => {
            Some(ratio * (frequency_hz / k0(frequency_hz)?) * (k0(at_frequency_hz)? / at_frequency_hz))
        }
    }
}

pub(in crate::check) fn match_light(site: &Site<'_>) -> Finding {
    let ratio = drive_ratio(site.plate, site.frequency_hz).unwrap_or(f64::INFINITY);
    let mismatch = ratio.max(1.0 / ratio);
    let reflected = if ratio.is_finite() { 100.0 * ((1.0 - ratio) / (1.0 + ratio)).abs() } else { 100.0 };
    let colour = colour(mismatch, DRIVE_MISMATCH);
    site.judged(
        "drive match",
        Some(ratio),
        "",
        colour,
        mismatch,
        pick(colour, [
            format!("The drive end absorbs the returning wave (r = {ratio:.2}, {reflected:.0} % comes back): the plate hardly resonates."),
            format!("The drive end sends {reflected:.0} % of the returning wave back (r = {ratio:.2}): the plate resonates a little."),
            match site.plate.spec().drive_end {
                DriveEnd::Displacement => "The drive end holds its displacement and sends every wave back: the plate is a resonator, put a damper at its end.".to_owned(),
                DriveEnd::Force { .. } => "The drive end holds its force and sends every wave back: the plate is a resonator, put a damper at its end.".to_owned(),
                DriveEnd::Resistance { .. } => format!("The drive end sends {reflected:.0} % of the returning wave back (r = {ratio:.2}): choose its resistance for this frequency."),
            },
        ]),
    )
}

pub(in crate::check) fn sensitivity_light(site: &Site<'_>) -> Result<Finding, CheckError> {
    let rate = site.prepared.conditions.sample_rate_hz;
    let intended = level_over_speeds(site.plate, &site.prepared.speeds, rate, site.frequency_hz)?;
    let mut worst: f64 = 0.0;
    for actual in &site.prepared.detuned {
        // The band of the detuned plate may end a little above what the sample rate carries; this frequency does not.
        let found = DriveToPeak::unchecked(actual, rate).level(site.frequency_hz)?.amplitude;
        worst = worst.max((20.0 * (found / intended).log10()).abs());
    }
    Ok(site.graded(
        "sensitivity",
        worst,
        "dB per % of wave speed",
        SENSITIVITY_DB,
        [
            format!("A wave speed that is 1 % off changes the peak by {} dB: the table can be trusted.", with_decimals(worst, 2)),
            format!("A wave speed that is 1 % off changes the peak by {worst:.1} dB: calibrate on your own plate."),
            format!("A wave speed that is 1 % off changes the peak by {worst:.0} dB: no table holds that, match the drive end."),
        ],
    ))
}

pub(in crate::check) fn actuator_light(site: &Site<'_>) -> Finding {
    let name = "actuator band";
    let Some(actuator) = site.plate.spec().actuator else {
        let sentence =
            "The plate file names no actuator: whether one reaches this frequency was not checked."
                .to_owned();
        return site.judged(name, None, "dB", Colour::Unchecked, 0.0, sentence);
    };
    let gain_db = 20.0 * actuator.response(site.frequency_hz).norm().log10();
    let loss_db = -gain_db;
    let colour = colour(loss_db, ACTUATOR_LOSS_DB);
    site.judged(
        name,
        Some(gain_db),
        "dB",
        colour,
        loss_db,
        pick(
            colour,
            [
                format!(
                    "The actuator answers with {gain_db:+.0} dB at this frequency: it is within its band."
                ),
                format!(
                    "The actuator answers with {gain_db:+.0} dB at this frequency: it has little travel left."
                ),
                format!(
                    "The actuator answers with {gain_db:+.0} dB at this frequency: it is out of its band."
                ),
            ],
        ),
    )
}

/// How far a tone at level 1 moves the actuator, before the peak travel lowers the table.
pub(in crate::check) fn excursion_light(site: &Site<'_>) -> Result<Finding, CheckError> {
    let name = "excursion";
    let actuator = site.plate.spec().actuator;
    let Some(share) = actuator.and_then(|actuator| actuator.travel_share(site.frequency_hz)) else {
        let sentence =
            "The plate file names no peak travel: how far the actuator moves is not limited.".to_owned();
        return Ok(site.judged(name, None, "%", Colour::Unchecked, 0.0, sentence));
    };
    let rate = site.prepared.conditions.sample_rate_hz;
    let level = DriveToPeak::unchecked(site.plate, rate).level(site.frequency_hz)?.amplitude;
    let percent = 100.0 * share * site.prepared.lowest_gain / level;
    Ok(site.graded(
        name,
        percent,
        "%",
        EXCURSION_PERCENT,
        [
            format!("At level 1 the actuator moves by {percent:.0} % of its peak travel: the table need not be lowered."),
            format!("At level 1 the actuator would move by {percent:.0} % of its peak travel: the table's level is lowered to what it allows."),
            format!("At level 1 the actuator would move by {percent:.0} % of its peak travel: what it allows is less than a tenth of the level."),
        ],
    ))
}

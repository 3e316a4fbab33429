//! Lights for the driven end, the actuator and the sensitivity of the table.

use crate::check::error::CheckError;
use crate::check::grading::{Finding, Site, colour, pick};
use crate::check::report::Colour;
use crate::check::thresholds::{
    ACTUATOR_LOSS_DB, DAC_AMPLITUDE_STEPS, DAC_STEPS, DRIVE_REFLECTION, EXCURSION_PERCENT, SENSITIVITY_DB,
};
use crate::frequency::driven_end::{reflection, resistance_reflection};
use crate::quantity::number_format::with_decimals;
use crate::spec::actuator::Actuator;
use crate::spec::drive::DriveEnd;
use crate::spec::plate::Plate;
use crate::spec::source::Source;
use crate::table::level::{DriveToPeak, level_over_tolerances};

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
        DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. } => Some(f64::INFINITY),
        DriveEnd::Source(source) => {
            Some(source.resistance_n_s_per_m / plate.wave_impedance_n_s_per_m(frequency_hz)?)
        }
        DriveEnd::Force { .. } => Some(0.0),
        DriveEnd::Resistance { ratio, at_frequency_hz } => {
            Some(ratio * (frequency_hz / k0(frequency_hz)?) * (k0(at_frequency_hz)? / at_frequency_hz))
        }
    }
}

/// The light's value is |r| of the end as it really is; for an end in bending whose near field the file leaves out, it is
/// that of the free end with the same damper.
pub(in crate::check) fn match_light(site: &Site<'_>) -> Finding {
    let reflected = |plate: &Plate| reflection(plate, site.frequency_hz).map_or(1.0, |r| r.norm());
    let in_equation = reflected(site.plate);
    let end = site.plate.spec().drive_end;
    let is_one_mode_bending =
        site.plate.spec().model.bending().is_some() && matches!(end, DriveEnd::Resistance { .. });
    let value = if is_one_mode_bending {
        resistance_reflection(site.plate, site.frequency_hz).map(|r| r.norm())
    } else {
        Some(in_equation)
    };
    let mut judged = colour(in_equation, DRIVE_REFLECTION);
    if is_one_mode_bending {
        judged = judged.max(Colour::Amber);
    }
    let percent = 100.0 * value.unwrap_or(in_equation);
    let sentence = match (judged, end) {
        (_, DriveEnd::Resistance { .. }) if is_one_mode_bending => {
            let really = value.map_or_else(
                || "a share that is not known".to_owned(),
                |_| format!("{percent:.0} %"),
            );
            format!(
                "A damper alone does not match a plate in bending: at a real end it sends {really} of the returning wave back (this file leaves the near field out). Use a source with a damped lead-in."
            )
        }
        (Colour::Green | Colour::Unchecked, _) => format!(
            "The drive end absorbs the returning wave ({percent:.0} % comes back): the plate hardly resonates."
        ),
        (_, DriveEnd::Source(source)) if hides_its_match(site, source) => format!(
            "The mass and the stiffness of the drive end hide what would absorb the wave: {percent:.0} % of it comes back. Use a softer actuator."
        ),
        (Colour::Amber, _) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: the plate resonates a little."
        ),
        (Colour::Red, DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. }) => {
            "The drive end holds its displacement and sends every wave back: the plate is a resonator, and a damper or a lead-in behind it would be hidden. Drive it by a force.".to_owned()
        }
        (Colour::Red, DriveEnd::Force { .. }) => {
            "The drive end holds its force and sends every wave back: the plate is a resonator, put a damper at its end.".to_owned()
        }
        (Colour::Red, DriveEnd::Resistance { .. }) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: choose its resistance for this frequency."
        ),
        (Colour::Red, DriveEnd::Source(_)) if site.plate.spec().model.bending().is_some() => format!(
            "The drive end sends {percent:.0} % of the returning wave back: give it a longer or more lossy lead-in."
        ),
        (Colour::Red, DriveEnd::Source(_)) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: give it the wave's resistance, and less mass and stiffness."
        ),
    };
    site.judged("drive match", value, "", judged, in_equation, sentence)
}

/// Whether the end would match without its own mass and stiffness.
fn hides_its_match(site: &Site<'_>, source: Source) -> bool {
    let mut spec = site.plate.spec().clone();
    spec.drive_end = DriveEnd::Source(Source { mass_kg: 0.0, stiffness_n_per_m: 0.0, ..source });
    let soft = Plate::new(spec).ok().and_then(|plate| reflection(&plate, site.frequency_hz));
    soft.is_some_and(|r| r.norm() <= DRIVE_REFLECTION.green)
}

/// The peak against the table's level where the plate is not quite the file's: the worse of speed and loss.
pub(in crate::check) fn sensitivity_light(site: &Site<'_>) -> Result<Finding, CheckError> {
    let rate = site.prepared.conditions.sample_rate_hz;
    let intended = level_over_tolerances(site.plate, &site.prepared.others, rate, site.frequency_hz)?;
    let worst_of = |plates: &[Plate]| -> Result<f64, CheckError> {
        plates.iter().try_fold(0.0, |worst: f64, actual| {
            // The band of another plate may end a little above what the sample rate carries; this frequency does not.
            let found = DriveToPeak::unchecked(actual, rate).level(site.frequency_hz)?.amplitude;
            Ok(worst.max((20.0 * (found / intended).log10()).abs()))
        })
    };
    let (speed, loss) = (worst_of(&site.prepared.detuned)?, worst_of(&site.prepared.lossy)?);
    let worst = speed.max(loss);
    let off = if loss <= speed {
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
    Ok(site.graded(
        "sensitivity",
        worst,
        "dB",
        SENSITIVITY_DB,
        [
            format!("{off} changes the peak by {} dB: the table can be trusted.", with_decimals(worst, 2)),
            format!("{off} changes the peak by {worst:.1} dB: calibrate on your own plate."),
            if loss <= speed {
                format!("{off} changes the peak by {worst:.0} dB: no table holds that, match the drive end.")
            } else {
                format!("{off} changes the peak by {worst:.0} dB: no table holds that, measure the loss.")
            },
        ],
    ))
}

pub(in crate::check) fn actuator_light(site: &Site<'_>) -> Finding {
    let name = "actuator band";
    let Some(actuator) = &site.plate.spec().actuator else {
        let sentence =
            "The plate file names no actuator: whether one reaches this frequency was not checked."
                .to_owned();
        return site.judged(name, None, "dB", Colour::Unchecked, 0.0, sentence);
    };
    if let Actuator::Measured(curve) = actuator
        && !curve.covers(site.frequency_hz)
    {
        let sentence =
            "The actuator's measured curve does not reach this frequency: its nearest end was taken.";
        return site.judged(name, None, "dB", Colour::Amber, 0.0, sentence.to_owned());
    }
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
    let actuator = site.plate.spec().actuator.as_ref().and_then(Actuator::resonator);
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

/// How many steps of the DAC the amplitude of a tone at level 1 has.
pub(in crate::check) fn resolution_light(site: &Site<'_>) -> Result<Finding, CheckError> {
    let prepared = site.prepared;
    let rate = prepared.conditions.sample_rate_hz;
    let level = DriveToPeak::unchecked(site.plate, rate).level(site.frequency_hz)?.amplitude;
    let steps = DAC_AMPLITUDE_STEPS * prepared.lowest_gain / level * prepared.travel_scale;
    let judged = if steps >= DAC_STEPS.green {
        Colour::Green
    } else if steps >= DAC_STEPS.amber {
        Colour::Amber
    } else {
        Colour::Red
    };
    let has = format!("At level 1 the amplitude has {} steps of the 12-bit DAC", with_decimals(steps, 0));
    let sentence = pick(
        judged,
        [
            format!("{has}."),
            format!("{has}: lower levels are coarse, even out the plate's peaks by its drive end."),
            format!("{has}: too few for any level, even out the plate's peaks by its drive end."),
        ],
    );
    Ok(site.judged("DAC resolution", Some(steps), "LSB", judged, -steps, sentence))
}

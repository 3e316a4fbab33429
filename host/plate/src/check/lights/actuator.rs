//! Lights for the actuator's band and travel, and for the steps of the DAC before it.

use crate::check::grading::{Finding, Site};
use crate::check::report::{Colour, Limit};
use crate::check::thresholds::{ACTUATOR_LOSS_DB, DAC_AMPLITUDE_STEPS, DAC_STEPS, EXCURSION_PERCENT, Limits};
use crate::definition::actuator::Actuator;
use crate::quantity::{decibels, number_format::with_decimals};

pub(in crate::check) fn actuator_light(site: &Site<'_>) -> Finding {
    let name = "actuator band";
    let Some(actuator) = &site.plate.spec().actuator else {
        let sentence =
            "The plate file has no actuator: the response of one at this frequency was not checked."
                .to_owned();
        return site.judged(name, None, "dB", Colour::Unchecked, 0.0, sentence);
    };
    if let Actuator::Measured(curve) = actuator
        && !curve.covers(site.frequency_hz)
    {
        let sentence = "The actuator's measured curve does not cover this frequency: its nearest end was used; measure the actuator here as well.";
        return site.judged(name, None, "dB", Colour::Amber, 0.0, sentence.to_owned()).at(0.0);
    }
    let gain_db = decibels(actuator.response(site.frequency_hz).norm());
    let limits = Limits { green: -ACTUATOR_LOSS_DB.green, amber: -ACTUATOR_LOSS_DB.amber };
    let sentences = [
        "it is within its band",
        "it has little travel left; another boundary or actuator has more",
        "it is out of its band, take another boundary or actuator",
    ];
    let sentences = sentences
        .map(|what| format!("The actuator answers with {gain_db:+.0} dB at this frequency: {what}."));
    site.graded(name, gain_db, "dB", Limit::AtLeast(limits), sentences).at(0.0)
}

/// Travel of the actuator for a tone at level 1, before the travel limit lowers the table.
pub(in crate::check) fn excursion_light(site: &Site<'_>) -> Finding {
    let name = "excursion";
    let actuator = site.plate.spec().actuator.as_ref().and_then(Actuator::resonator);
    let Some(share) = actuator.and_then(|actuator| actuator.travel_share(site.frequency_hz)) else {
        let sentence =
            "The plate file states no peak travel: the travel of the actuator is not limited.".to_owned();
        return site.judged(name, None, "%", Colour::Unchecked, 0.0, sentence);
    };
    let percent = 100.0 * share * site.prepared.lowest_gain / site.levels.nominal;
    site.graded(
        name,
        percent,
        "%",
        Limit::AtMost(EXCURSION_PERCENT),
        [
            format!("At level 1 the actuator moves by {percent:.0} % of its peak travel: the table need not be lowered."),
            format!("At level 1 the actuator would move by {percent:.0} % of its peak travel: the table's level is lowered to its limit."),
            format!("At level 1 the actuator would move by {percent:.0} % of its peak travel: its limit leaves less than a tenth of the level."),
        ],
    )
    .at(0.0)
}

/// Amplitude of a tone at level 1 in steps of the DAC.
pub(in crate::check) fn resolution_light(site: &Site<'_>) -> Finding {
    let prepared = site.prepared;
    let steps = DAC_AMPLITUDE_STEPS * prepared.lowest_gain / site.levels.nominal * prepared.travel_scale;
    let has = format!("At level 1 the amplitude has {} steps of the 12-bit DAC", with_decimals(steps, 0));
    let sentences = [
        format!("{has}."),
        format!("{has}: lower levels are coarse, even out the plate's peaks by its drive end."),
        format!("{has}: too few for any level, even out the plate's peaks by its drive end."),
    ];
    site.graded("DAC resolution", steps, "LSB", Limit::AtLeast(DAC_STEPS), sentences)
}

//! Light for the peak of a tone at the DAC, on a device whose output flattens peaks below full scale.

use crate::check::grading::{Finding, Site, pick};
use crate::check::report::Colour;
use crate::quantity::{decibels, number_format::with_decimals};

/// Amplitude of the tone over the largest one that the DAC's output passes undistorted, in %. `None` where that is full scale, which
/// no tone of a table exceeds.
pub(in crate::check) fn linear_output_light(site: &Site<'_>) -> Option<Finding> {
    let prepared = site.prepared;
    let linear = prepared.conditions.linear_share;
    if linear >= 1.0 {
        return None;
    }
    let amplitude =
        prepared.conditions.level * prepared.lowest_gain / site.levels.nominal * prepared.travel_scale;
    let share = amplitude / linear;
    let colour = if share <= 1.0 { Colour::Green } else { Colour::Amber };
    let takes = format!(
        "The tone takes {:.0} % of full scale, and the output of the DAC is linear up to {:.0} %",
        100.0 * amplitude,
        100.0 * linear
    );
    let flattened = format!(
        "{takes}: its peaks are flattened, which adds harmonics. Lower the level by {} dB.",
        with_decimals((10.0 * decibels(share)).ceil() / 10.0, 1)
    );
    let sentences = [format!("{takes}."), flattened.clone(), flattened];
    let found =
        site.judged("linear output", Some(100.0 * share), "%", colour, share, pick(colour, sentences));
    Some(found.at(0.0))
}

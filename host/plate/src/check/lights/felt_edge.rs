//! Light for the felt edge: whether a finger feels the tone end on the plate.

use crate::check::grading::{Finding, Site};
use crate::check::interval::Interval;
use crate::check::report::Colour;
use crate::check::thresholds::ULTRASONIC_HZ;
use crate::feeling::{Feeling, FeltEdge, FeltTone};
use crate::quantity::{from_decibels, number_format::with_decimals};

/// Whether a usual finger feels the tone end on the plate; the value is the place of the felt edge in mm. Amber at most:
/// fingers differ, and the place where a finger feels nothing is no error of the model.
pub(in crate::check) fn felt_edge_light(site: &Site<'_>) -> Finding {
    let strength = strength(site, driven_end_m(site));
    let at_ends = site.interval.as_ref().map_or(Vec::new(), |interval| at_ends(site, interval, &strength));
    let known = site.interval.as_ref().map_or(String::new(), Interval::boundary);
    let judged = |value_mm, colour, severity, sentence: String| {
        site.judged("felt edge", value_mm, "mm", colour, severity, sentence)
    };
    let found = match Feeling::edge(site.plate, &strength) {
        FeltEdge::At(edge_m) => {
            let [edge, turns] = [edge_m, site.boundary_m].map(|place_m| with_decimals(place_m * 1e3, 0));
            let sentence =
                format!("A usual finger feels the tone end at {edge} mm; its wave turns at {turns} mm.");
            judged(Some(edge_m * 1e3), Colour::Green, edge_m, sentence)
        }
        FeltEdge::PlateEnd => {
            let sentence = "A usual finger feels the tone up to the plate's end, so it has no felt edge: take a lower \
                            level or a turning point nearer the drive.";
            judged(None, Colour::Amber, 1.0, sentence.to_owned())
        }
        FeltEdge::Nowhere => {
            let is_below = site.frequency_hz < ULTRASONIC_HZ && site.plate.band_hz().1 >= ULTRASONIC_HZ;
            let why = if is_below {
                "the tone is below 20 kHz, take a turning point farther from the drive"
            } else {
                "the tone is too weak, take a higher level or a stronger drive"
            };
            judged(None, Colour::Amber, 2.0, format!("A usual finger feels nothing: {why}."))
        }
    };
    found.between(&at_ends, &known)
}

/// Displacement of the driven end that gives the tone its peak, metres.
pub(super) fn driven_end_m(site: &Site<'_>) -> f64 {
    let highest = site.response.height();
    if highest > 0.0 { site.prepared.peak_m() / highest } else { 0.0 }
}

/// Strength of the tone along the plate where its driven end moves by `drive_m`, over that which is just felt.
pub(super) fn strength(site: &Site<'_>, drive_m: f64) -> Vec<f64> {
    let amplitude = &site.response.amplitude;
    let squares: Vec<f64> = amplitude.iter().map(|f| 0.5 * (f * drive_m).norm_sqr()).collect();
    let tone = FeltTone { frequency_hz: site.frequency_hz, squares: &squares };
    Feeling::default().strength(site.plate, &[tone])
}

/// Place and colour of the felt edge at the ends of a calibration's intervals, where level and turning point both move it
/// nearer or both farther. The frequency, and with it 20 kHz, is exact.
fn at_ends(site: &Site<'_>, interval: &Interval, strength: &[f64]) -> Vec<(f64, Colour)> {
    let open_db = site.levels.open_db(site.plate).unwrap_or(0.0);
    let end = |side: f64| {
        let factor = from_decibels(side * open_db);
        let strength: Vec<f64> = strength.iter().map(|strength| strength * factor).collect();
        let edge_m =
            Feeling::edge(site.plate, &strength).place_m().map(|edge_m| edge_m + side * interval.boundary_m);
        match edge_m.filter(|edge_m| (0.0..=site.plate.length_m()).contains(edge_m)) {
            Some(edge_m) => (edge_m * 1e3, Colour::Green),
            None => (f64::NAN, Colour::Amber),
        }
    };
    [-1.0, 1.0].map(end).to_vec()
}

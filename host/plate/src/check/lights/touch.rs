//! Lights for the finger on the plate: its room between the edges, and the peak under it.

use crate::check::grading::{Finding, Site, colour, colour_at_least, pick};
use crate::check::interval::{End, Interval};
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{FINGER_DB, FINGER_LOAD, FINGERTIP_M, WIDTH};
use crate::frequency::Finger;
use crate::quantity::{decibels, from_decibels, number_format::with_decimals};

/// Whether a fingertip fits between the edges at the boundary; the value is the plate's width there in fingertips.
pub(in crate::check) fn width_light(site: &Site<'_>) -> Finding {
    let fingers_at = |x: f64| 2.0 * site.plate.half_width_m(x) / FINGERTIP_M;
    let fingers = fingers_at(site.boundary_m);
    let millimetres = with_decimals(fingers * FINGERTIP_M * 1e3, 1);
    let rooms = [
        "a fingertip rests between the edges",
        "a fingertip also rests on the edges, which do not move; a boundary nearer the drive is wider",
        "most of a fingertip rests on the edges, which do not move, take a boundary nearer the drive",
    ];
    let sentences = rooms.map(|room| format!("The plate is {millimetres} mm wide at the boundary: {room}."));
    site.graded("width", fingers, "fingertips", Limit::AtLeast(WIDTH), sentences)
        .over_interval(site, Interval::boundary, |end| {
            let fingers = 2.0 * end.plate.half_width_m(end.boundary_m) / FINGERTIP_M;
            (fingers, colour_at_least(fingers, WIDTH))
        })
        .over(|| {
            let fails = |x: f64| fingers_at(x) < WIDTH.green;
            vec![Stretch::about(site.boundary_m, site.boundary_m, fails)]
        })
}

/// |Z_f|/Z of a light touch, and the reduction of the peak by it; the light has the colour of the worse of the two.
pub(in crate::check) fn finger_load_light(site: &Site<'_>) -> Finding {
    let name = "finger load";
    let place_m = site.peak_m();
    let finger = Finger::light(place_m);
    let Ok(load) = finger.load(site.plate, site.frequency_hz) else {
        let sentence = "The plate file states no tension or thickness: the load of a finger on the wave was not checked.";
        return site.judged(name, None, "", Colour::Unchecked, 0.0, sentence.to_owned());
    };
    let by_load = colour(load, FINGER_LOAD);
    let limit = Limit::AtMost(FINGER_LOAD);
    if site.response.peak.is_none() {
        let sentence = format!(
            "A light touch has {} times the impedance of the wave; there is no peak for it to take.",
            with_decimals(load, 2)
        );
        return site
            .judged(name, Some(load), "", by_load, load, sentence)
            .limited(limit)
            .over_interval(site, Interval::boundary, |end| load_at(site, &finger, end, Colour::Green))
            .at(place_m);
    }
    let [light_db, firm_db] = touched_db(site, &finger);
    // These dB are those of the highest peak over the interval.
    let by_db = colour(light_db, FINGER_DB);
    let judged = by_load.max(by_db);
    let costs = format!(
        "A light touch takes up to {} dB from the peak under it, a firm press {} dB",
        with_decimals(light_db, 1),
        with_decimals(firm_db, 1)
    );
    let severity = (load / FINGER_LOAD.green).max(light_db / FINGER_DB.green);
    let sentence = pick(
        judged,
        [
            format!("{costs}: the peak survives a light touch."),
            format!("{costs}: the felt peak is weaker than the computed one; a heavier plate keeps it."),
            format!("{costs}: a finger stops the wave that it should feel, take a heavier plate."),
        ],
    );
    let found = site
        .judged(name, Some(load), "", judged, severity, sentence)
        .over_interval(site, Interval::boundary, |end| load_at(site, &finger, end, by_db))
        .at(place_m);
    if judged > by_load { found } else { found.limited(limit) }
}

/// |Z_f|/Z at an end of the interval, and its colour, at least `by_db`.
fn load_at(site: &Site<'_>, finger: &Finger, end: &End, by_db: Colour) -> (f64, Colour) {
    let load = finger.load(&end.plate, site.frequency_hz).unwrap_or(f64::NAN);
    (load, colour(load, FINGER_LOAD).max(by_db))
}

/// Largest reduction of the amplitude under a light touch and under a firm press at the place of `light`, dB.
///
/// A force under the contact moves the plate there by Y per unit of force, so a finger of impedance Z leaves
/// 1/(1 + Y Z) of the motion. The light touch is solved; the firm press has the same contact and therefore the same
/// Y. Where another wave speed has a resonance here, Y rises with the peak.
pub(in crate::check) fn touched_db(site: &Site<'_>, light: &Finger) -> [f64; 2] {
    let firm = Finger::firm(light.place_m);
    let left = site.prepared.variants.share_left(light, site.frequency_hz);
    let ratio =
        firm.impedance().at_n_s_per_m(site.frequency_hz) / light.impedance().at_n_s_per_m(site.frequency_hz);
    let rise = from_decibels(site.levels.rise_db);
    let by_light = (left.inv() - 1.0) * rise;
    [by_light, by_light * ratio].map(|by| decibels((1.0 + by).norm()).max(0.0))
}

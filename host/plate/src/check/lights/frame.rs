//! The light for the frame: how far it moves where the plate should be still.

use crate::check::grading::{Finding, Site};
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{FRAME_DB, FRAME_TABLE_STEP_KG};
use crate::feeling::Feeling;
use crate::quantity::number_format::with_decimals;
use crate::quantity::{decibels, from_decibels, show_frequency, show_length};
use num_complex::Complex64;

/// Its value is the frame's motion beyond the boundary at level 1 over what a usual finger just feels, dB.
pub(in crate::check) fn frame_light(site: &Site<'_>) -> Finding {
    let name = "frame";
    let unchecked =
        |sentence: &str| site.judged(name, None, "dB", Colour::Unchecked, 0.0, sentence.to_owned());
    let plate = site.plate;
    let Some(frame) = plate.spec().frame else {
        return unchecked("The plate file states no [frame]: how far the frame moves was not checked.");
    };
    let highest = site.response.height();
    let scale = if highest > 0.0 { site.prepared.peak_m() / highest } else { 0.0 };
    let metres: Vec<Complex64> = site.response.amplitude.iter().map(|f| f * scale).collect();
    let Some(motion) = frame.motion(plate, site.frequency_hz, &metres, site.boundary_m) else {
        return unchecked(
            "The plate file states no tension or thickness: how far the frame moves was not checked.",
        );
    };
    let just_felt_m = Feeling::default().just_felt_m(site.frequency_hz);
    let over_db = decibels(motion.amplitude_m / just_felt_m).max(-FAR_BELOW_DB);
    let below = |db: f64| {
        let digits = with_decimals(db.abs(), 0);
        if db < 0.0 { format!("{digits} dB below") } else { format!("{digits} dB over") }
    };
    let moves = format!(
        "Beyond the boundary the frame moves by {}, {} what a finger feels",
        show_length(motion.amplitude_m),
        below(over_db)
    );
    let stands = if frame.table_mass_kg > 0.0 {
        "it is screwed to a table".to_owned()
    } else {
        format!("its first bending is at {}", show_frequency(frame.first_bending_hz(plate)))
    };
    // The mass that leaves what is green, in whole kilograms.
    let needed_kg = motion.rigid_kg * from_decibels(over_db - FRAME_DB.green) - frame.mass_kg(plate);
    let kilograms = (needed_kg / FRAME_TABLE_STEP_KG).ceil().max(1.0) * FRAME_TABLE_STEP_KG;
    let screw = format!("screw it to a table of {} kg or more", with_decimals(kilograms, 0));
    let sentences = [
        format!("{moves}; {stands}."),
        format!("{moves}; {stands}: {screw}."),
        format!("{moves}; {stands}. The still side vibrates: {screw}."),
    ];
    site.graded(name, over_db, "dB", Limit::AtMost(FRAME_DB), sentences)
        .over(|| vec![Stretch { from_m: site.boundary_m.min(plate.length_m()), to_m: plate.length_m() }])
}

/// Farther below than this is stated as this, dB.
const FAR_BELOW_DB: f64 = 99.0;

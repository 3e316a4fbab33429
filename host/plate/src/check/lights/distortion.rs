//! Light for the harmonics of the drive: whether a finger feels them beyond the felt edge of the tone.

use super::felt_edge::{driven_end_m, strength};
use crate::check::grading::{Finding, Site, colour};
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::HARMONIC_DB;
use crate::feeling::{Feeling, FeltEdge};
use crate::quantity::from_decibels;
use crate::second_boundary::{DrivenTone, HarmonicWave, SecondBoundary};

/// Strength of the loudest harmonic beyond the felt edge of the tone over the threshold, in dB. `None` for a plate file without
/// harmonics, which has no such light.
pub(in crate::check) fn distortion_light(site: &Site<'_>) -> Option<Finding> {
    site.plate.spec().harmonics.as_ref()?;
    let name = "distortion";
    let drive_m = driven_end_m(site);
    let tone = DrivenTone {
        frequency_hz: site.frequency_hz,
        level: site.prepared.conditions.level,
        drive_m: drive_m.into(),
    };
    // Twice and three times a frequency of the span are in the range of every plate's responses.
    let waves = HarmonicWave::of_tone(site.plate, &tone, site.response.amplitude.len()).unwrap_or_default();
    let edge = Feeling::edge(site.plate, &strength(site, drive_m));
    let Some(found) = loudest(site, edge, &waves) else {
        let sentence = "A usual finger feels the tone up to the plate's end: no side is still that a harmonic could disturb.";
        return Some(site.judged(name, None, "dB", Colour::Green, f64::NEG_INFINITY, sentence.to_owned()));
    };
    let (db, ordinal) = (found.over_threshold_db, found.ordinal());
    let felt = format!(
        "The {ordinal} harmonic of the drive disturbs the still side: {}; {}.",
        found.words(site.plate.length_m()),
        found.silent_words()
    );
    let below =
        if db.is_finite() { format!("{:.0} dB below", -db) } else { "without amplitude, below".to_owned() };
    let sentences = [
        format!("The {ordinal} harmonic of the drive stays {below} the threshold beyond the felt edge."),
        format!("{felt} A lower level or a companion tone makes it weaker."),
        format!("{felt} Take a lower level, a companion tone or another drive."),
    ];
    let finding = site.graded(name, db, "dB", Limit::AtMost(HARMONIC_DB), sentences);
    // A level off by its interval moves the felt edge of the tone, too, and the harmonic by more than the tone.
    let open_db = site.levels.open_db(site.plate).unwrap_or(0.0);
    let at_ends: Vec<(f64, Colour)> = site.interval.as_ref().map_or(Vec::new(), |_| {
        let ends = [-open_db, open_db].into_iter().filter_map(|db| {
            let factor = from_decibels(db);
            let edge = Feeling::edge(site.plate, &strength(site, drive_m * factor));
            let waves: Vec<HarmonicWave> = waves.iter().map(|wave| wave.times(factor)).collect();
            loudest(site, edge, &waves)
        });
        ends.map(|it| (it.over_threshold_db, colour(it.over_threshold_db, HARMONIC_DB))).collect()
    });
    let known = site.interval.as_ref().map_or(String::new(), |interval| interval.boundary());
    let end_m = site.plate.length_m();
    let from_m = edge.place_m().unwrap_or(0.0);
    let to_m = found.felt_to.place_m().unwrap_or(end_m).max(from_m);
    let over = move || vec![Stretch { from_m, to_m }];
    Some(finding.over(over).between(&at_ends, &known))
}

/// The loudest harmonic beyond the felt edge of the tone; `None` where the tone is felt up to the plate's end.
fn loudest(site: &Site<'_>, edge: FeltEdge, waves: &[HarmonicWave]) -> Option<SecondBoundary> {
    SecondBoundary::loudest(&SecondBoundary::each(site.plate, &Feeling::default(), edge, waves))
}

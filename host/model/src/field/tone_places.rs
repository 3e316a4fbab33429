//! Both places of a tone: its turning point and its felt edge.
//!
//! ```text
//! turning point x0 --table--> frequency, peak --plate--> wave of the tone alone --feeling--> felt edge
//! ```
//! The felt edge is that of [`crate::field::line`], whatever the line of the setup holds. The other direction, from a
//! felt edge to its tone, is [`crate::field::edge_reach`].

use crate::field::felt::{NotFelt, by_person_words};
use crate::field::harmonics::second_boundary;
use crate::field::line::felt_alone;
use crate::field::steady_field::{SteadyField, SteadyTone, ToneWave};
use crate::setup::{Setup, ToneSetup};
use slipline_link::{DeviceTable, Sounding};
use slipline_plate::DriveTable;
use slipline_plate::feeling::{EdgesByPerson, FeltEdge};
use slipline_plate::quantity::show_place;
use slipline_plate::second_boundary::SecondBoundary;

/// Both places of a tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TonePlaces {
    /// The device's slot of the tone.
    pub slot: u8,
    /// Turning point x0, in metres from the driven end.
    pub turning_point_m: f64,
    /// Frequency by the plate's table, in Hz.
    pub frequency_hz: f64,
    /// Level, 0 to 1, with the setup's master level and the gain of a chord.
    pub level: f64,
    /// Where a finger stops feeling the tone alone.
    pub felt_edge: FeltEdge,
    /// The same for persons at both ends of [`slipline_plate::feeling::PERSONS_DB`].
    pub by_person: EdgesByPerson,
    /// Why the tone is not felt, if so.
    pub not_felt: Option<NotFelt>,
    /// The harmonic of the drive that is felt most beyond the felt edge; `None` for a plate file without harmonics, and where the
    /// tone is felt up to the plate's end.
    pub second: Option<SecondBoundary>,
    /// The plate's length, in metres: a second boundary beyond it is none on the plate.
    length_m: f64,
}

impl TonePlaces {
    /// The places of a setup's tone; `table` is that of the setup's plate.
    #[must_use]
    pub fn of(setup: &Setup, tone: &ToneSetup, table: &DriveTable) -> Self {
        let field = SteadyField::solve(&setup.plate, &[SteadyTone::of(setup, tone, table)]);
        Self::of_wave(setup, tone, table.frequency_hz(tone.position_m), field.tones.first())
    }

    /// The places of a tone whose wave is solved; a tone that does not enter the plate is not felt.
    #[must_use]
    pub fn of_wave(setup: &Setup, tone: &ToneSetup, frequency_hz: f64, wave: Option<&ToneWave>) -> Self {
        let felt = wave.map(|wave| felt_alone(setup, wave));
        let nowhere = EdgesByPerson { near: FeltEdge::Nowhere, far: FeltEdge::Nowhere };
        let felt_edge = felt.as_ref().map_or(FeltEdge::Nowhere, |felt| felt.edge);
        let why = felt.as_ref().and_then(|felt| felt.not_felt).unwrap_or(NotFelt::TooWeak);
        Self {
            slot: tone.slot,
            turning_point_m: tone.position_m,
            frequency_hz,
            level: setup.played_level(tone),
            felt_edge,
            by_person: felt.map_or(nowhere, |felt| felt.by_person),
            not_felt: (felt_edge == FeltEdge::Nowhere).then_some(why),
            second: wave.and_then(|wave| second_boundary(setup, tone, wave, felt_edge)),
            length_m: setup.plate.length_m(),
        }
    }

    /// The places of all tones of a setup, in their order.
    #[must_use]
    pub fn of_setup(setup: &Setup, table: &DriveTable) -> Vec<Self> {
        setup.tones.iter().map(|tone| Self::of(setup, tone, table)).collect()
    }

    /// The places of all tones of a setup as `sounding` plays them, and the gain of the chord that they are, in dB: it counts
    /// for a chord only.
    #[must_use]
    pub fn as_played(
        setup: Setup,
        sounding: Option<&Sounding>,
        table: &DriveTable,
    ) -> (Vec<Self>, Option<f64>) {
        let is_chord = matches!(sounding, Some(Sounding::Chord(_)));
        let chord_gain_db = setup.chord_gain_db.filter(|_| is_chord);
        (Self::of_setup(&Setup { chord_gain_db, ..setup }, table), chord_gain_db)
    }

    /// The tones that a device with this table plays, each with the frequency that it plays, in Hz.
    pub fn on_device<'a>(places: &'a [Self], table: &DeviceTable) -> impl Iterator<Item = (&'a Self, f64)> {
        places
            .iter()
            .filter_map(move |tone| Some((tone, table.frequency_hz(table.position(tone.turning_point_m)?))))
    }

    /// The felt edge in words, without its spread: `felt edge at 210.0 mm`.
    #[must_use]
    pub(crate) fn edge_words(&self) -> String {
        match (self.felt_edge, self.not_felt) {
            (FeltEdge::At(place_m), _) => format!("felt edge at {}", show_place(place_m)),
            (FeltEdge::PlateEnd, _) => "felt to the plate's end".to_owned(),
            (FeltEdge::Nowhere, why) => why.unwrap_or(NotFelt::TooWeak).words(),
        }
    }

    /// The felt edge in words, with its spread: `felt edge at 210.0 mm, 201 to 219 mm by person`; and the second boundary, if a
    /// finger feels one.
    #[must_use]
    pub fn felt_words(&self) -> String {
        let mut words = self.edge_words();
        if let Some(by_person) = by_person_words(self.by_person) {
            words = format!("{words}, {by_person}");
        }
        match self.second.filter(SecondBoundary::is_felt) {
            Some(second) => format!("{words}; {}", second.words(self.length_m)),
            None => words,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::line::{Holds, Line};
    use crate::setup::BoundaryMode;
    use std::sync::Arc;

    #[test]
    fn the_felt_edge_matches_the_windows_line_whatever_the_line_holds() {
        for (name, level) in [("membrane", 0.8), ("al-bending", 0.8), ("al-sh", 0.2), ("paper-rubber", 0.5)] {
            let plate = Arc::new(slipline_plate::preset(name).unwrap());
            let table = DriveTable::build(&plate, 400e3, 65).unwrap();
            let mut setup = Setup::new(plate);
            let (start_m, end_m) = setup.plate.span_m();
            for i in 0..=12 {
                let position_m = start_m + (end_m - start_m) * f64::from(i) / 12.0;
                let tone = ToneSetup { position_m, level, ..setup.tones[0] };
                setup.boundary = BoundaryMode::TurningPoint;
                let places = TonePlaces::of(&setup, &tone, &table);
                setup.boundary = BoundaryMode::FeltEdge;
                let line = Line::of(&setup, &tone, Some(&table));
                match places.felt_edge {
                    FeltEdge::At(place_m) => {
                        assert_eq!((place_m, Holds::FeltEdge), (line.place_m, line.holds), "{name}");
                    }
                    FeltEdge::PlateEnd => assert_eq!(line.holds, Holds::PlateEnd, "{name}"),
                    FeltEdge::Nowhere => {
                        assert_eq!(line.holds, Holds::Unfelt(places.not_felt.unwrap()), "{name}");
                    }
                }
                assert_eq!((places.turning_point_m, places.level), (position_m, level));
                assert_eq!(places.frequency_hz, table.frequency_hz(position_m));
            }
        }
    }

    #[test]
    fn both_places_of_a_chord_match_its_louder_tones() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let table = DriveTable::build(&plate, 400e3, 65).unwrap();
        let mut setup = Setup::new(plate);
        setup.tones[0].level = 0.03;
        let alone = TonePlaces::of_setup(&setup, &table)[0];
        setup.chord_gain_db = Some(6.0);
        let louder = TonePlaces::of_setup(&setup, &table)[0];
        assert!((louder.level / alone.level - 10f64.powf(0.3)).abs() < 1e-12);
        let (FeltEdge::At(near_m), FeltEdge::At(far_m)) = (alone.felt_edge, louder.felt_edge) else {
            panic!("{alone:?} {louder:?}");
        };
        assert!(far_m > near_m + 3e-3, "{near_m} {far_m}");
        assert!(
            louder.felt_words().starts_with("felt edge at ")
                && louder.felt_words().ends_with(" depending on the person")
        );
    }
}

//! A tone by both of its places.

use crate::field::tone_places::TonePlaces;
use serde::Serialize;
use slipline_plate::feeling::{EdgesByPerson, FeltEdge};

/// The fields of a tone: both places, its frequency and its level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToneAnswer {
    /// JSON: Where the wave turns
    pub turning_point_m: f64,
    /// JSON: Where a finger feels the tone end, by its level alone; null where it does not
    pub felt_edge_m: Option<f64>,
    /// JSON: Felt edge of a dull and of a keen finger; null where none is felt
    pub felt_edge_by_person_m: [Option<f64>; 2],
    /// JSON, text: The felt edge as a sentence
    pub felt: String,
    /// JSON: Frequency of the tone or of each answer
    pub frequency_hz: f64,
    /// JSON, 1: Level of the tone, 0 to 1 of the table's full scale
    pub level: f64,
    /// JSON: Turning point of the drive's harmonic that is felt most beyond the felt edge; null without harmonics in the plate
    /// file
    pub second_boundary_m: Option<f64>,
    /// JSON: How far this harmonic is over the threshold there; negative where it is not felt, null without harmonics
    pub second_boundary_db: Option<f64>,
    /// JSON: Where a finger feels this harmonic end; null where it does not end on the plate, is not felt, or without harmonics
    pub second_boundary_felt_to_m: Option<f64>,
}

impl ToneAnswer {
    /// The fields of a tone that the device plays at `frequency_hz`.
    #[must_use]
    pub fn of(places: &TonePlaces, frequency_hz: f64) -> Self {
        Self {
            turning_point_m: places.turning_point_m,
            felt_edge_m: places.felt_edge.place_m(),
            felt_edge_by_person_m: edges_m(places.by_person),
            felt: places.felt_words(),
            frequency_hz,
            level: places.level,
            second_boundary_m: places.second.map(|second| second.turning_point_m),
            second_boundary_db: places
                .second
                .map(|second| second.over_threshold_db)
                .filter(|db| db.is_finite()),
            second_boundary_felt_to_m: places.second.and_then(|second| second.felt_to.place_m()),
        }
    }
}

/// The felt edges of the persons at both ends, in metres; `None` for one at the plate's end or nowhere.
pub(super) fn edges_m(EdgesByPerson { near, far }: EdgesByPerson) -> [Option<f64>; 2] {
    [near, far].map(FeltEdge::place_m)
}

//! A tone by both of its places.

use crate::field::tone_places::TonePlaces;
use serde::Serialize;
use slipline_plate::feeling::{EdgesByPerson, FeltEdge};

/// The fields of a tone: both places, its frequency and its level.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "host/JSON.md has the meaning of each field")]
pub struct ToneAnswer {
    pub turning_point_m: f64,
    pub felt_edge_m: Option<f64>,
    pub felt_edge_by_person_m: [Option<f64>; 2],
    pub felt: String,
    pub frequency_hz: f64,
    pub level: f64,
    pub second_boundary_m: Option<f64>,
    pub second_boundary_db: Option<f64>,
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

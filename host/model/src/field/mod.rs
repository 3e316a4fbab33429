//! Fields on the plate: displacement over x and time, by theory and by simulation.

pub mod asked_place;
pub mod displacement_map;
pub mod edge_reach;
pub mod felt;
pub mod harmonics;
pub mod line;
mod line_at_rest;
pub mod rings;
pub mod sheet;
pub mod simulation;
pub mod steady_field;
pub mod time_domain;
pub mod tone_places;
pub mod touch;

//! The plates of a study, and what the nominal plate's table does on them.

use super::chunk::{Chunk, Status};
use super::draw::{Draw, path_hash};
use super::spec::Spec;
use crate::field::simulation::SAMPLE_RATE_HZ;
use crate::jobs::table::KNOTS;
use slipline_plate::{
    Boundary, DriveTable, NoBoundary, Plate, PlateError, PlateFile, PlateFileError, Progress, TableError,
    boundaries, quantity::decibels,
};
use std::ops::Range;

/// Why a study cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The nominal plate has no table.
    #[error("{0}")]
    Table(#[from] TableError),
    /// The nominal plate has no boundary at a place.
    #[error("turning_point_m = {place_m}: {why}")]
    Place {
        /// The place, metres.
        place_m: f64,
        /// Why.
        why: NoBoundary,
    },
    /// The specification's plate is refused.
    #[error("plate: {0}")]
    Plate(#[from] PlateFileError),
}

/// A specification with the nominal plate's drive, ready for any range of its plates.
///
/// The table of the nominal plate gives each place its frequency and its gain, as a device would send them to every plate. The
/// level is a ratio of peaks by the same gain, so that the gain has no part in it.
///
/// ```
/// use slipline_model::study::{Draft, Study};
/// use slipline_plate::{Progress, preset};
///
/// let text = "plate = \"membrane\"\nseed = 7\ncount = 100\nturning_point_m = [0.16]\n[vary]\nloss_factor = { log_normal = 0.3 }";
/// let spec = Draft::parse(text).unwrap().finish(preset("membrane")).unwrap();
/// let study = Study::new(spec, &mut Progress::unwatched()).unwrap();
/// assert_eq!(study.run_range(40..50), study.run_range(40..50));
/// ```
#[derive(Debug)]
pub struct Study {
    spec: Spec,
    nominal: Plate,
    /// The hashes of the varied fields' paths.
    hashes: Vec<u64>,
    /// The frequency of each place, Hz, and its boundary on the nominal plate.
    frequencies_hz: Vec<f64>,
    boundaries: Vec<Boundary>,
}

impl Study {
    /// Computes the nominal plate's table.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(spec: Spec, progress: &mut Progress<'_>) -> Result<Self, StudyError> {
        let (_, nominal) = PlateFile::parse(&spec.plate_text)?;
        let rate_hz = f64::from(SAMPLE_RATE_HZ);
        let table = DriveTable::build_watched(&nominal, rate_hz, KNOTS, progress)?;
        let frequencies_hz: Vec<f64> =
            spec.turning_point_m.iter().map(|&place_m| table.frequency_hz(place_m)).collect();
        let found = boundaries(&nominal, &frequencies_hz, rate_hz).into_iter().zip(&spec.turning_point_m);
        let boundaries = found
            .map(|(found, &place_m)| found.map_err(|why| StudyError::Place { place_m, why }))
            .collect::<Result<_, _>>()?;
        let hashes = spec.varied.iter().map(|varied| path_hash(&varied.path)).collect();
        Ok(Self { spec, nominal, hashes, frequencies_hz, boundaries })
    }

    /// The specification.
    #[must_use]
    pub const fn spec(&self) -> &Spec {
        &self.spec
    }

    /// The nominal plate.
    #[must_use]
    pub const fn nominal(&self) -> &Plate {
        &self.nominal
    }

    /// The frequency of each place, Hz.
    #[must_use]
    pub fn frequencies_hz(&self) -> &[f64] {
        &self.frequencies_hz
    }

    /// The varied fields of a plate, in the unit of the plate file.
    #[must_use]
    pub fn varied(&self, plate: u64) -> Vec<f64> {
        let of = |(varied, &hash): (&super::Varied, &u64)| {
            varied.law.drawn(varied.nominal, Draw::of(self.spec.seed, plate, hash))
        };
        self.spec.varied.iter().zip(&self.hashes).map(of).collect()
    }

    /// A plate of the study by its number, from 0; numbers beyond the study's count also give plates.
    ///
    /// # Errors
    /// The plate file's refusal of this plate.
    pub fn plate(&self, plate: u64) -> Result<Plate, StudyError> {
        let (file, _) = PlateFile::parse(&self.spec.plate_text)?;
        self.plate_of(&file, &self.varied(plate))
            .map_err(|error| StudyError::Plate(PlateFileError::Plate { line: None, error }))
    }

    fn plate_of(&self, file: &PlateFile<'_>, values: &[f64]) -> Result<Plate, PlateError> {
        let paths = self.spec.varied.iter().map(|varied| varied.path.as_str());
        let changes: Vec<(&str, f64)> = paths.zip(values.iter().copied()).collect();
        file.plate_with(&changes, &self.nominal)
    }

    /// The results of a range of plates. The same bits whatever the range, on whichever thread. A bad plate has NaN and its
    /// reason, and never fails the range.
    #[must_use]
    pub fn run_range(&self, plates: Range<u64>) -> Chunk {
        let mut chunk = Chunk::empty(plates.start);
        // The text has been parsed before, so that it does not fail here.
        let Ok((file, _)) = PlateFile::parse(&self.spec.plate_text) else { return chunk };
        for plate in plates {
            let values = self.varied(plate);
            let status = match self.plate_of(&file, &values) {
                Ok(plate) => self.drive(&plate, &mut chunk),
                Err(_) => {
                    let none = std::iter::repeat_n(f64::NAN, self.frequencies_hz.len());
                    chunk.turning_point_shift_m.extend(none.clone());
                    chunk.level_db.extend(none);
                    Status::Refused
                }
            };
            chunk.status.push(status);
            chunk.varied.extend(values);
        }
        chunk
    }

    /// Appends what the nominal plate's table does on a plate.
    fn drive(&self, plate: &Plate, chunk: &mut Chunk) -> Status {
        let found = boundaries(plate, &self.frequencies_hz, f64::from(SAMPLE_RATE_HZ));
        let mut status = Status::Done;
        for (found, nominal) in found.into_iter().zip(&self.boundaries) {
            let (shift_m, level_db) = match found {
                Ok(boundary) => (
                    boundary.turning_point_m - nominal.turning_point_m,
                    decibels(boundary.peak_m / nominal.peak_m),
                ),
                Err(why) => {
                    // The first place without a boundary gives the reason.
                    if status == Status::Done {
                        status = match why {
                            NoBoundary::CannotEnter => Status::CannotEnter,
                            NoBoundary::TooHigh => Status::TooHigh,
                            NoBoundary::Silent => Status::Silent,
                        };
                    }
                    (f64::NAN, f64::NAN)
                }
            };
            chunk.turning_point_shift_m.push(shift_m);
            chunk.level_db.push(level_db);
        }
        status
    }
}

#[cfg(test)]
mod tests;

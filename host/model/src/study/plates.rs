//! The plates of a study, and what the nominal plate's table does on them.

use super::chunk::{Chunk, Status};
use super::draw::{Draw, path_hash};
use super::drives::Drives;
use super::error::StudyError;
use super::spec::Spec;
use crate::field::simulation::SAMPLE_RATE_HZ;
use crate::jobs::table::KNOTS;
use slipline_plate::{DriveTable, Plate, PlateError, PlateFile, PlateFileError, Progress};
use std::ops::Range;

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
    drives: Drives,
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
        let drives = Drives::new(&spec, &nominal, table)?;
        let hashes = spec.varied.iter().map(|varied| path_hash(&varied.path)).collect();
        Ok(Self { spec, nominal, hashes, drives })
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
        self.drives.frequencies_hz()
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
        let mut chunk = Chunk::empty(plates.start, self.spec.results.len());
        // The text has been parsed before, so that it does not fail here.
        let Ok((file, _)) = PlateFile::parse(&self.spec.plate_text) else { return chunk };
        let palette = self.drives.palette(&self.nominal);
        for plate in plates {
            let values = self.varied(plate);
            let status = match self.plate_of(&file, &values) {
                Ok(plate) => self.drives.add(&plate, palette.as_ref(), &mut chunk),
                Err(_) => {
                    self.drives.skip(&mut chunk);
                    Status::Refused
                }
            };
            chunk.status.push(status);
            chunk.varied.extend(values);
        }
        chunk
    }
}

#[cfg(test)]
mod tests;

//! The drives of a study: a tone for each place by the nominal plate's table, and what each does on another plate.

use super::chunk::{Chunk, Status};
use super::error::StudyError;
use super::results::{Kind, StudyResult};
use super::spec::Spec;
use crate::field::simulation::SAMPLE_RATE_HZ;
use crate::field::steady_field::POINTS;
use slipline_plate::feeling::{Feeling, FeltTone};
use slipline_plate::plane::{self, PlaneError};
use slipline_plate::quantity::decibels;
use slipline_plate::texture::{Figures, Palette, TONES_MAX, Target, Texture};
use slipline_plate::{
    DriveTable, Equation, NoBoundary, Plate, RespondError, Response, airy, boundaries, respond,
};

/// Places along the plate in two dimensions: more than ten per wavelength.
const PLANE_POINTS: usize = 2049;

/// The drives of all places, and what they do on the nominal plate.
#[derive(Debug)]
pub(super) struct Drives {
    kind: Kind,
    results: Vec<StudyResult>,
    table: DriveTable,
    places_m: Vec<f64>,
    frequencies_hz: Vec<f64>,
    nominal: Vec<Line>,
    /// The solid area up to each place, where its figures are wanted.
    areas: Vec<(Texture, Target)>,
}

/// The line of one tone on one plate.
#[derive(Clone, Copy, Debug)]
struct Line {
    turning_point_m: f64,
    /// Displacement of the peak, in units that are the same for every plate; never 0. Where the plate has no peak, the amplitude at
    /// the turning point over 0.6628.
    peak: f64,
    /// NaN without a peak, and where it is not wanted.
    peak_place_m: f64,
    felt_edge_m: f64,
    crest_db: f64,
}

impl Drives {
    /// The drives by this table of the nominal plate.
    pub(super) fn new(spec: &Spec, nominal: &Plate, table: DriveTable) -> Result<Self, StudyError> {
        let places_m = spec.turning_point_m().to_vec();
        let frequencies_hz = places_m.iter().map(|&place_m| table.frequency_hz(place_m)).collect();
        let areas = if spec.results().iter().any(|it| is_of_area(*it)) {
            let palette = Palette::new(nominal, &table);
            let area = |&place_m: &f64| {
                let target = Target::solid(&palette, place_m)?;
                Ok((Texture::fit(&palette, &target, TONES_MAX)?, target))
            };
            let of = |place_m| area(place_m).map_err(|why| StudyError::Area { place_m: *place_m, why });
            places_m.iter().map(of).collect::<Result<_, _>>()?
        } else {
            Vec::new()
        };
        let (kind, results) = (spec.kind(), spec.results().to_vec());
        let mut drives = Self { kind, results, table, places_m, frequencies_hz, nominal: Vec::new(), areas };
        let lines = drives.lines(nominal).into_iter().zip(&drives.places_m);
        let lines = lines.map(|(line, &place_m)| line.map_err(|why| why.of_nominal(place_m)));
        drives.nominal = lines.collect::<Result<_, _>>()?;
        Ok(drives)
    }

    /// The frequency of each place, Hz.
    pub(super) fn frequencies_hz(&self) -> &[f64] {
        &self.frequencies_hz
    }

    /// The tones of the areas as they sound on the nominal plate, if they are wanted.
    pub(super) fn palette<'a>(&'a self, nominal: &'a Plate) -> Option<Palette<'a>> {
        (!self.areas.is_empty()).then(|| Palette::new(nominal, &self.table))
    }

    /// Appends NaN for a plate that is not solved.
    pub(super) fn skip(&self, chunk: &mut Chunk) {
        let none = std::iter::repeat_n(f64::NAN, self.places_m.len());
        chunk.results.iter_mut().for_each(|numbers| numbers.extend(none.clone()));
    }

    /// Appends what the drives do on a plate, and returns its status: the first place without numbers gives the reason.
    pub(super) fn add(&self, plate: &Plate, palette: Option<&Palette<'_>>, chunk: &mut Chunk) -> Status {
        let mut status = Status::Done;
        for (place, line) in self.lines(plate).into_iter().enumerate() {
            let numbers =
                line.map_err(|why| why.status()).and_then(|line| self.numbers(place, &line, plate, palette));
            let numbers = numbers.unwrap_or_else(|why| {
                if status == Status::Done {
                    status = why;
                }
                vec![f64::NAN; self.results.len()]
            });
            chunk.results.iter_mut().zip(numbers).for_each(|(all, number)| all.push(number));
        }
        status
    }

    /// The results of a place, in the order of the specification.
    fn numbers(
        &self,
        place: usize,
        line: &Line,
        plate: &Plate,
        palette: Option<&Palette<'_>>,
    ) -> Result<Vec<f64>, Status> {
        let nominal = &self.nominal[place];
        let figures: Option<Figures> = match (self.areas.get(place), palette) {
            (Some((texture, target)), Some(palette)) => {
                Some(texture.on(plate, palette, target).map_err(|_| Status::Silent)?)
            }
            _ => None,
        };
        let number = |result: &StudyResult| match result {
            StudyResult::TurningPointShift => line.turning_point_m - nominal.turning_point_m,
            StudyResult::Level => decibels(line.peak / nominal.peak),
            StudyResult::PeakShift => line.peak_place_m - nominal.peak_place_m,
            StudyResult::FeltEdge => line.felt_edge_m,
            StudyResult::Contrast => figures.and_then(|it| it.contrast_db).unwrap_or(f64::NAN),
            StudyResult::Ripple => figures.and_then(|it| it.ripple_db).unwrap_or(f64::NAN),
            StudyResult::Crest => line.crest_db,
        };
        Ok(self.results.iter().map(number).collect())
    }

    /// The line of each place on a plate.
    fn lines(&self, plate: &Plate) -> Vec<Result<Line, NoLine>> {
        if self.kind == Kind::Plane {
            return (0..self.places_m.len()).map(|place| self.in_plane(plate, place)).collect();
        }
        let found = boundaries(plate, &self.frequencies_hz, f64::from(SAMPLE_RATE_HZ)).into_iter();
        let has_field = self.results.iter().any(|it| is_of_field(*it));
        let line = |(place, found): (usize, Result<_, NoBoundary>)| {
            let boundary: slipline_plate::Boundary = found.map_err(NoLine::Boundary)?;
            let none = Line {
                turning_point_m: boundary.turning_point_m,
                peak: boundary.peak_m,
                peak_place_m: f64::NAN,
                felt_edge_m: f64::NAN,
                crest_db: f64::NAN,
            };
            if !has_field {
                return Ok(none);
            }
            let field = respond(plate, self.frequencies_hz[place], POINTS, Equation::Corrected);
            let field = field.map_err(|why| NoLine::Plane(why.into()))?;
            Ok(Line { peak: none.peak, ..self.of_field(plate, place, &field) })
        };
        found.enumerate().map(line).collect()
    }

    fn in_plane(&self, plate: &Plate, place: usize) -> Result<Line, NoLine> {
        let hertz = self.frequencies_hz[place];
        let field =
            plane::respond(plate, hertz, PLANE_POINTS, &plane::Setup::of(plate)).map_err(NoLine::Plane)?;
        let line = self.of_field(plate, place, &field);
        if line.peak.is_finite() && line.peak > 0.0 {
            Ok(line)
        } else {
            Err(NoLine::Boundary(NoBoundary::Silent))
        }
    }

    /// The line of a field: its peak in metres at level 1.
    fn of_field(&self, plate: &Plate, place: usize, field: &Response) -> Line {
        let driven_m = self.table.driven_end_m(plate, self.places_m[place]).norm();
        // Without a peak, as a table levels it.
        let is_on_plate = field.turning_point_m <= plate.length_m();
        let at_end = field.amplitude.last().map_or(f64::NAN, |f| f.norm());
        let turning = if is_on_plate { field.amplitude_at_turning_point } else { at_end };
        let peak = field.peak.map_or(turning * airy::PEAK_VALUE / airy::ai(0.0), |peak| peak.amplitude);
        let squares: Vec<f64> = field.amplitude.iter().map(|f| 0.5 * (driven_m * f.norm()).powi(2)).collect();
        let before = field.position_m.iter().take_while(|x_m| **x_m <= field.turning_point_m).count();
        let mean = squares[..before].iter().sum::<f64>() / before as f64;
        let crest = |peak: slipline_plate::Peak| decibels(driven_m * peak.amplitude / (2.0 * mean).sqrt());
        let tone = FeltTone { frequency_hz: field.frequency_hz, squares: &squares };
        let edge = Feeling::edge(plate, &Feeling::default().strength(plate, &[tone]));
        Line {
            turning_point_m: field.turning_point_m,
            peak: driven_m * peak,
            peak_place_m: field.peak.map_or(f64::NAN, |peak| peak.position_m),
            felt_edge_m: edge.place_m().unwrap_or(f64::NAN),
            crest_db: field.peak.map_or(f64::NAN, crest),
        }
    }
}

/// Why a tone has no line on a plate.
#[derive(Debug)]
enum NoLine {
    Boundary(NoBoundary),
    Plane(PlaneError),
}

impl NoLine {
    fn status(&self) -> Status {
        match self {
            Self::Boundary(NoBoundary::CannotEnter)
            | Self::Plane(PlaneError::Respond(RespondError::CannotEnter { .. })) => Status::CannotEnter,
            Self::Boundary(NoBoundary::TooHigh)
            | Self::Plane(PlaneError::Respond(RespondError::Frequency { .. })) => Status::TooHigh,
            Self::Boundary(NoBoundary::Silent) => Status::Silent,
            Self::Plane(_) => Status::NotSolved,
        }
    }

    fn of_nominal(self, place_m: f64) -> StudyError {
        match self {
            Self::Boundary(why) => StudyError::Place { place_m, why },
            Self::Plane(why) => StudyError::Plane { place_m, why },
        }
    }
}

/// Whether it is a number of the whole field, which the peak alone does not give.
const fn is_of_field(result: StudyResult) -> bool {
    matches!(result, StudyResult::PeakShift | StudyResult::FeltEdge | StudyResult::Crest)
}

/// Whether it is a figure of a solid area.
const fn is_of_area(result: StudyResult) -> bool {
    matches!(result, StudyResult::Contrast | StudyResult::Ripple)
}

#[cfg(test)]
mod tests;

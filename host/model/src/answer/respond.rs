//! The field on a plate at one frequency.

use super::{Complex, TwoDimensions};
use serde::Serialize;
use slipline_plate::plane::PlaneError;
use slipline_plate::{
    Complex64, Equation, Finger, Plate, RespondError, Response, TurningWidth, plane, reflection,
    respond_touched,
};
use std::borrow::Cow;

/// The field to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldRequest {
    /// Frequency, in Hz: in the range of the plate of [`plate_of`].
    pub frequency_hz: f64,
    /// Number of places along the plate, 8 to 200 001.
    pub points: usize,
    /// A finger on the plate.
    pub finger: Option<Finger>,
    /// Whether the equation is the paper's, without the W'/W term, on a plate in vacuum.
    pub paper_mode: bool,
    /// Whether the plate is solved in two dimensions, too.
    pub two_dimensions: bool,
}

/// Why a field cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The paper's equation in two dimensions.
    #[error(
        "the paper's equation leaves out a term of the one-mode equation, and the plate in two dimensions has all of them: \
         choose one of the two"
    )]
    PaperInTwoDimensions,
    /// The one-mode equation cannot be solved.
    #[error("{0}")]
    OneMode(#[from] RespondError),
    /// The plate in two dimensions cannot be solved.
    #[error("{0}")]
    Plane(#[from] PlaneError),
}

/// A solved field.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedField<'a> {
    /// The plate; of the paper's equation that in vacuum.
    pub plate: Cow<'a, Plate>,
    /// Whether the equation is the paper's.
    pub paper_mode: bool,
    /// The field: that in two dimensions where it was asked for.
    pub response: Response,
    /// How it differs from that of the one-mode equation.
    pub differences: Option<Differences>,
}

/// Differences between the field in two dimensions and that of the one-mode equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Differences {
    /// Those of the peak and the nodes.
    pub comparison: plane::Comparison,
    /// Magnitude of the reflection at the driven end, by the one-mode equation and in two dimensions.
    pub reflection: [Option<f64>; 2],
}

/// The plate of a field, by which its frequencies are allowed.
#[must_use]
pub fn plate_of(plate: &Plate, paper_mode: bool) -> Cow<'_, Plate> {
    if paper_mode {
        Cow::Owned(plate.in_vacuum().with_turning_width(TurningWidth::Plain))
    } else {
        Cow::Borrowed(plate)
    }
}

/// Solves a field.
///
/// # Errors
/// [`FieldError`]: the unsuitable value and its range.
pub fn solve<'a>(plate: &'a Plate, asked: &FieldRequest) -> Result<SolvedField<'a>, FieldError> {
    let FieldRequest { frequency_hz, points, finger, paper_mode, two_dimensions } = *asked;
    if paper_mode && two_dimensions {
        return Err(FieldError::PaperInTwoDimensions);
    }
    let plate = plate_of(plate, paper_mode);
    let equation = if paper_mode { Equation::Paper } else { Equation::Corrected };
    let one_mode = respond_touched(&plate, finger.as_ref(), frequency_hz, points, equation)?;
    let (response, differences) = if two_dimensions {
        let (response, differences) = in_two_dimensions(&plate, finger, &one_mode, points)?;
        (response, Some(differences))
    } else {
        (one_mode, None)
    };
    Ok(SolvedField { plate, paper_mode, response, differences })
}

/// The field in two dimensions at the frequency of a field of the one-mode equation, and their differences.
fn in_two_dimensions(
    plate: &Plate,
    finger: Option<Finger>,
    one_mode: &Response,
    points: usize,
) -> Result<(Response, Differences), PlaneError> {
    let setup = plane::Setup { finger, ..plane::Setup::of(plate) };
    let frequency_hz = one_mode.frequency_hz;
    let response = plane::respond(plate, frequency_hz, points, &setup)?;
    let in_plane = plane::reflection(plate, frequency_hz, &setup)?;
    let reflection = [reflection(plate, frequency_hz), Some(in_plane)].map(|r| r.map(Complex64::norm));
    let comparison = plane::Comparison::of(one_mode, &response);
    Ok((response, Differences { comparison, reflection }))
}

/// The fields of `slipline respond --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RespondAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// Frequency of the tone or of each answer.
    pub frequency_hz: f64,
    /// JSON, true or false: Whether the paper's equation was solved
    pub paper_mode: bool,
    /// Places along the plate, or the turning point of a knot.
    pub position_m: &'a [f64],
    /// The response at each place, relative to the drive.
    pub amplitude: Vec<Complex>,
    /// JSON, text: Width by which the wave turns: arc or plain
    pub turning_width: &'static str,
    /// Where the wave turns.
    pub turning_point_m: f64,
    /// JSON, true or false: Whether there is a peak
    pub peak_present: bool,
    /// JSON: Place of the peak; null without a peak
    pub peak_position_m: Option<f64>,
    /// JSON, times the drive: Amplitude of the peak over that of the drive; null without a peak
    pub peak_amplitude: Option<f64>,
    /// JSON: From the peak to a tenth of its amplitude
    pub edge_width_m: f64,
    /// How the plate in two dimensions differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub two_dimensions: Option<FieldDifferences>,
}

/// The fields of `two_dimensions`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldDifferences {
    /// The peaks and the nodes of both.
    #[serde(flatten)]
    pub comparison: TwoDimensions,
    /// JSON, 1: Reflection at the driven end, in two dimensions
    pub reflection: Option<f64>,
    /// JSON, 1: The same by the one-mode equation
    pub one_mode_reflection: Option<f64>,
}

impl<'a> RespondAnswer<'a> {
    /// The fields of a response of the plate of [`plate_of`].
    #[must_use]
    pub fn of(plate: &'a Plate, paper_mode: bool, response: &'a Response) -> Self {
        let peak = response.peak;
        Self {
            plate: plate.name(),
            frequency_hz: response.frequency_hz,
            paper_mode,
            position_m: &response.position_m,
            amplitude: Complex::of_each(&response.amplitude),
            turning_width: plate.spec().turning_width.word(),
            turning_point_m: response.turning_point_m,
            peak_present: peak.is_some(),
            peak_position_m: peak.map(|peak| peak.position_m),
            peak_amplitude: peak.map(|peak| peak.amplitude),
            edge_width_m: response.edge_width_m,
            two_dimensions: None,
        }
    }
}

impl SolvedField<'_> {
    /// The fields of the differences between two dimensions and one mode.
    #[must_use]
    pub fn differences(&self) -> Option<FieldDifferences> {
        self.differences.as_ref().map(|Differences { comparison, reflection }| {
            let [one_mode_reflection, reflection] = *reflection;
            FieldDifferences { comparison: TwoDimensions::of(comparison), reflection, one_mode_reflection }
        })
    }

    /// Its fields.
    #[must_use]
    pub fn answer(&self) -> RespondAnswer<'_> {
        let two_dimensions = self.differences();
        RespondAnswer { two_dimensions, ..RespondAnswer::of(&self.plate, self.paper_mode, &self.response) }
    }
}

//! A designed plate.

use super::check::{self, CheckAnswer};
use serde::Serialize;
use slipline_plate::Progress;
use slipline_plate::check::{CheckError, Conditions, Report};
use slipline_plate::design::{self, BandEnd, ChosenFrame, Damper, Design, DesignError, Request};

/// Designs a plate, and checks it over its span.
///
/// A band above the range of the usual device is still designed; only its lights are missing.
///
/// # Errors
/// [`DesignError`]: the unsuitable value and its range, or that the caller has cancelled it.
pub fn design(
    request: &Request,
    progress: &mut Progress<'_>,
) -> Result<(Design, Result<Report, CheckError>), DesignError> {
    let designed = design::design(request, &mut progress.part(0.0, 0.5))?;
    match check::check(&designed.plate, None, Conditions::default(), &mut progress.part(0.5, 1.0)) {
        Err(CheckError::Stopped(stopped)) => Err(stopped.into()),
        lights => Ok((designed, lights)),
    }
}

/// The fields of `slipline design --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DesignAnswer<'a> {
    /// Name of the plate.
    pub plate: &'a str,
    /// JSON, text: The plate file
    pub toml: String,
    /// JSON: Rate d of the taper
    pub rate_per_m: f64,
    /// JSON: Half of the width, at the driven end or at this place
    pub half_width_m: f64,
    /// JSON: Half of the width at the narrow end
    pub end_half_width_m: f64,
    /// The lower end of the band.
    pub lowest: BandEnd,
    /// The upper end of the band.
    pub highest: BandEnd,
    /// JSON, 1: Loss factor
    pub loss_factor: f64,
    /// JSON, 1: Loss factor up to which the peak is the largest amplitude
    pub loss_factor_limit: f64,
    /// JSON: Farthest turning point without a second one, the drive on the centre line
    pub single_turning_point_to_m: f64,
    /// JSON: Farthest turning point without a second one, the drive beside the centre line
    pub single_turning_point_off_centre_to_m: f64,
    /// JSON: Travel without a second width mode, the drive on the centre line
    pub mode_free_travel_m: f64,
    /// The damper at the driven end.
    pub damper: Damper,
    /// JSON: Tension per width; null for a plate that is not stretched
    pub tension_n_per_m: Option<f64>,
    /// JSON, text: How the parts are mounted
    pub mounting: &'a str,
    /// The frame.
    pub frame: Option<ChosenFrame>,
    /// JSON, text: A caution that no measurement reveals and the user must check
    pub caution: Option<String>,
    /// The lights of the designed plate.
    pub check: Option<CheckAnswer<'a>>,
    /// JSON, text: Why the lights are missing; null if they are present
    pub not_checked: Option<String>,
}

impl<'a> DesignAnswer<'a> {
    /// The fields of a design and its lights.
    #[must_use]
    pub fn of(designed: &'a Design, lights: &'a Result<Report, CheckError>) -> Self {
        let plate = &designed.plate;
        Self {
            plate: plate.name(),
            toml: plate.to_toml(),
            rate_per_m: designed.rate_per_m,
            half_width_m: plate.cut_half_width_m(0.0),
            end_half_width_m: plate.cut_half_width_m(plate.length_m()),
            lowest: designed.low,
            highest: designed.high,
            loss_factor: plate.spec().loss_factor,
            loss_factor_limit: designed.loss_factor_limit,
            single_turning_point_to_m: designed.single_boundary_to_m,
            single_turning_point_off_centre_to_m: designed.single_boundary_off_centre_to_m,
            mode_free_travel_m: designed.mode_free_travel_m(),
            damper: designed.damper,
            tension_n_per_m: designed.tension_n_per_m,
            mounting: designed.mounting.sentence(),
            frame: designed.frame,
            caution: designed.caution(),
            check: lights.as_ref().ok().map(CheckAnswer::of),
            not_checked: lights.as_ref().err().map(ToString::to_string),
        }
    }
}

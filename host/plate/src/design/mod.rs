//! The plate designer: from a material, a thickness, a band and a length to a plate, its damper and its cut files.
//!
//! ```text
//! Request -> design() -> Design { plate, damper, low, high, .. } -> plate.to_toml()
//!                                                               -> plate_drawing(), frame_drawing() -> SVG, DXF
//! ```
//! The taper is exponential, W = W0 e^(-d x). Both ends of the band turn where half the arc between the edges is q/K,
//! that is where W = tan(d q/K)/d, so d = ln(tan(d q/K1)/tan(d q/K2))/(x2 - x1) and W0 = W1 e^(d x1). K is that of the
//! plate's model with its air, also for thick plates. Between the edges of a film W is the half-width of the membrane that turns
//! where the film does (`definition/film.rs`).

mod caution;
mod damper;
mod drawing;
mod dxf;
mod frame;
mod material;
mod mounting;
mod outline;
mod request;
mod svg;

use crate::check::{loss_integral, thresholds, wavelengths};
use crate::definition::air::AirLoad;
use crate::definition::drive::DriveEnd;
use crate::definition::error::{Consequence, Origin, PlateError};
use crate::definition::film::FilmEdge;
use crate::definition::free_wave::FreeWave;
use crate::definition::limits;
use crate::definition::model::Model;
use crate::definition::plate::{Plate, PlateSpec};
use crate::definition::taper::Taper;
use crate::definition::turning_width::TurningWidth;
use crate::progress::{Progress, Stopped};
use crate::quantity::Range;
use crate::special::airy;
use serde::Serialize;
use std::f64::consts::TAU;
use thiserror::Error;

pub use damper::Damper;
pub use drawing::{Drawing, Layer, Shape};
pub use frame::ChosenFrame;
pub use material::{Material, material_names};
pub use mounting::Mounting;
pub use request::{Edge, Request, Wave};

/// The boundary at one end of the band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, serde::Deserialize)]
pub struct BandEnd {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Turning point, metres.
    #[serde(rename = "turning_point_m")]
    pub boundary_m: f64,
    /// Half-width at the turning point, metres.
    pub half_width_m: f64,
    /// Distance from the peak to a tenth of its amplitude, metres.
    pub edge_width_m: f64,
    /// Number of wavelengths from the driven end to the boundary.
    pub wavelengths: f64,
    /// Loss integral I: the wave arrives with e^-I of its amplitude.
    pub loss_integral: f64,
}

/// A designed plate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Design {
    /// The plate; its drive end is matched by the damper.
    #[serde(with = "crate::exchange::by_text")]
    pub plate: Plate,
    /// Rate d of the taper, 1/m.
    pub rate_per_m: f64,
    /// The lowest frequency's boundary.
    pub low: BandEnd,
    /// The highest frequency's boundary.
    pub high: BandEnd,
    /// Loss factor at which the larger loss integral of the two ends of the span reaches 3, so that its peak is no
    /// longer the largest amplitude. (The material's own loss factor is the plate's `loss_factor`.)
    pub loss_factor_limit: f64,
    /// Up to this boundary, metres, no higher width mode enters if the drive is on the centre line.
    pub single_boundary_to_m: f64,
    /// The same for a drive off the centre line, metres; it may lie before the nearest boundary.
    pub single_boundary_off_centre_to_m: f64,
    /// What absorbs the returning wave: a damper at the driven end, or a lead-in with a damper behind the drive.
    pub damper: Damper,
    /// Tension of a membrane, N per metre of width; `None` for a plate that needs none.
    pub tension_n_per_m: Option<f64>,
    rim_m: f64,
    /// The frame, which the plate file states, too.
    pub frame: Option<ChosenFrame>,
    /// How the frame holds the sheet.
    pub mounting: Mounting,
}

/// Why a design was not finished.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DesignError {
    /// The request cannot be met.
    #[error("{0}")]
    Plate(#[from] PlateError),
    /// The caller stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Designs the plate: finds the taper that puts the two ends of the band at the margins, and the matching damper.
///
/// # Errors
/// [`DesignError::Plate`] names the field of the request that is out of range, or the length if the margins do not
/// leave a tenth of it for the span; [`DesignError::Stopped`].
pub fn design(request: &Request, progress: &mut Progress<'_>) -> Result<Design, DesignError> {
    progress.at(0.0)?;
    request.material.validate()?;
    limits::THICKNESS.check("thickness_m", request.thickness_m)?;
    limits::LENGTH.check("length_m", request.length_m)?;
    limits::FREQUENCY.check("band low", request.band_hz.0)?;
    let (low_hz, high_hz) = request.band_hz;
    band_high_range(low_hz).check_from(Origin::BandLow(low_hz), "band high", high_hz)?;
    limits::FULL_SCALE.check("full_scale_m", request.full_scale_m)?;
    limits::RIM.check("rim_m", request.rim_m)?;
    let model = request.model();
    model.validate()?;
    if let Some(air) = &request.air {
        air.validate(&model)?;
    }
    check_film(request, &model)?;
    let taper = taper_for(request, &model)?;
    progress.at(0.1)?;
    let mut spec = PlateSpec {
        name: request.name.clone(),
        description: request.describe(),
        taper: Taper::Exponential { half_width_m: taper.half_width_m, rate_per_m: taper.rate_per_m },
        length_m: request.length_m,
        model,
        thickness: None,
        turning_width: TurningWidth::Arc,
        loss_factor: request.material.loss_factor,
        wave_speed_tolerance: WAVE_SPEED_TOLERANCE,
        loss_tolerance: None,
        loss_exponent: None,
        loss_exponent_tolerance: None,
        edge_give_m: None,
        edge_give_tolerance_m: None,
        tension_ratio: None,
        tension_ratio_tolerance: None,
        drive_end: DriveEnd::Displacement,
        actuator: None,
        harmonics: None,
        amplifier_bandwidth_hz: None,
        full_scale_m: request.full_scale_m,
        span_start_m: taper.near_m,
        span_end_m: taper.far_m,
        air: request.air,
        frame: None,
        calibration: None,
    };
    let undamped = Plate::new(spec.clone())?;
    progress.at(0.2)?;
    let (drive_end, damper) = damper::matched(&undamped, request.band_hz);
    spec.drive_end = drive_end;
    let driven = Plate::new(spec.clone())?;
    progress.at(0.4)?;
    let (frame, chosen) = frame::choose(&driven, request.rim_m).unzip();
    spec.frame = frame;
    let plate = Plate::new(spec)?;
    progress.at(0.5)?;
    let surface_density = request.material.density_kg_per_m3 * request.thickness_m;

    let (low, high) = (band_end(&plate, request.band_hz.0), band_end(&plate, request.band_hz.1));
    progress.at(0.8)?;
    let alone_to = |mode: u32| {
        let enters_at_hz = plate.width_mode(mode).cut_off_hz(0.0);
        plate.turning_point_m(enters_at_hz).unwrap_or(0.0).min(taper.far_m)
    };
    let loss_factor_limit = loss_factor_limit(&plate)?;
    progress.at(1.0)?;
    Ok(Design {
        rate_per_m: taper.rate_per_m,
        low,
        high,
        loss_factor_limit,
        single_boundary_to_m: alone_to(3),
        single_boundary_off_centre_to_m: alone_to(2),
        damper,
        tension_n_per_m: match request.wave {
            Wave::Membrane { wave_speed_m_per_s } => Some(surface_density * wave_speed_m_per_s.powi(2)),
            Wave::Bending { .. } | Wave::ShearHorizontal => None,
        },
        rim_m: request.rim_m,
        frame: chosen,
        mounting: match request.wave {
            Wave::Bending { edge: Edge::Supported, .. } => Mounting::Lip,
            Wave::Bending { edge: Edge::Clamped, .. } | Wave::ShearHorizontal => Mounting::Gripped,
            Wave::Membrane { .. } => Mounting::Stretched,
        },
        plate,
    })
}

impl Design {
    /// Length of the span over which no higher width mode enters, metres, measured from the nearest boundary, for a
    /// drive on the centre line.
    pub fn mode_free_travel_m(&self) -> f64 {
        (self.single_boundary_to_m - self.low.boundary_m).max(0.0)
    }

    /// Drawing of the sheet.
    pub fn plate_drawing(&self) -> Drawing {
        outline::plate(&self.plate, self.rim_m, self.mounting)
    }

    /// Drawing of the frame, which is cut twice.
    pub fn frame_drawing(&self) -> Drawing {
        outline::frame(&self.plate, self.rim_m, self.mounting)
    }
}

struct FoundTaper {
    half_width_m: f64,
    rate_per_m: f64,
    near_m: f64,
    far_m: f64,
}

/// Room before the nearest boundary, in units of 1/kappa: up to the first node of the Airy form, so that the whole
/// antinode of the peak fits.
const START_ROOM: f64 = 2.338;
/// The same with clamped edges: half as much again. With less, the lowest frequency enters so near to its cut-off that a
/// lead-in with much loss is unlike the plate there. One with less loss has to be longer by more than this room (107 mm for
/// 49 mm on 2 mm of aluminium from 20 to 40 kHz), or none keeps the level within 1 dB.
const START_ROOM_CLAMPED: f64 = 3.5;
/// Room behind the farthest boundary, in units of 1/kappa: there the amplitude is 5 % of the peak.
const END_ROOM: f64 = 2.172;
/// Largest angle of an edge to the centre line at the nearest boundary, radians (75 degrees): near a right angle no
/// half-width has an arc that is long enough. The light of the edge slope is red from 27 degrees on.
const ANGLE_MOST: f64 = 75.0 / 180.0 * std::f64::consts::PI;
/// Largest relative change of the taper's rate after which it is taken as found: the band is then right to 1e-6.
const SETTLED: f64 = 1e-7;
/// Shortest span over the plate's length.
const SPAN_LEAST: f64 = 0.1;
/// A metal's handbook constants and its measured thickness give the wave speed to about 1 %.
const WAVE_SPEED_TOLERANCE: f64 = 0.01;

/// The allowed highest frequencies of a band that starts at `low_hz`, Hz: from 5 % above it to 1e7.
pub fn band_high_range(low_hz: f64) -> Range {
    Range { low: (1.0 + 0.01 * limits::BAND_WIDTH_MIN_PERCENT) * low_hz, ..limits::FREQUENCY }
}

/// The allowed distances from the driven end to the nearest boundary on a plate of this length, metres: 0.001 to 0.9 of
/// the length.
pub fn start_margin_range(length_m: f64) -> Range {
    Range { high: (1.0 - SPAN_LEAST) * length_m, ..limits::span_start(length_m) }
}

/// The allowed distances from the farthest boundary to the narrow end on a plate of this length, metres: 0 to 0.9 of
/// the length.
pub fn end_margin_range(length_m: f64) -> Range {
    Range::new(0.0, (1.0 - SPAN_LEAST) * length_m, "m")
}

/// Refuses a film that is too stiff for the highest frequency, which turns where the plate is narrowest.
fn check_film(request: &Request, model: &Model) -> Result<(), PlateError> {
    let (Some(film), Some(square)) = (model.film(), model.film_square()) else { return Ok(()) };
    let wave = FreeWave { model, load: AirLoad::of(request.air.as_ref(), model) };
    let wavenumber = wave.wavenumber_squared(TAU * request.band_hz.1).sqrt();
    let (half_width_m, _) = FilmEdge::outline_m(model.width_number(1) / wavenumber, square.sqrt());
    film.check("thickness_m", square.sqrt(), half_width_m)
}

/// The edges where a wave turns.
struct Turning {
    /// Their angle to the centre line, radians; of a film that of the membrane's.
    angle: f64,
    /// The rate at which the width of the wave falls, 1/m.
    rate_per_m: f64,
    /// Half-width of the plate, metres.
    half_width_m: f64,
}

impl Turning {
    /// Where half the arc between edges that narrow at `rate`, 1/m, is `half_arc_m`.
    fn of(rate: f64, half_arc_m: f64, film_edge_m: Option<f64>) -> Self {
        let across = |rate_per_m: f64| {
            let angle = (rate_per_m * half_arc_m).min(ANGLE_MOST);
            Self { angle, rate_per_m, half_width_m: angle.tan() / rate_per_m }
        };
        let mut found = across(rate);
        let Some(edge_m) = film_edge_m else { return found };
        // The membrane's width falls faster than the film's, by a factor that hardly depends on the width.
        let mut half_width_m = f64::NAN;
        for _ in 0..RATE_STEPS {
            let rise;
            (half_width_m, rise) = FilmEdge::outline_m(found.half_width_m, edge_m);
            found = across(rate * rise);
        }
        Self { half_width_m, ..found }
    }
}

/// Steps that settle the membrane's rate of a film.
const RATE_STEPS: usize = 12;

fn taper_for(request: &Request, model: &Model) -> Result<FoundTaper, PlateError> {
    let wave = FreeWave { model, load: AirLoad::of(request.air.as_ref(), model) };
    let wavenumber = |frequency_hz: f64| wave.wavenumber_squared(TAU * frequency_hz).sqrt();
    let (near_k, far_k) = (wavenumber(request.band_hz.0), wavenumber(request.band_hz.1));
    // K of a membrane in air falls before the turning point, too.
    let fall_share = |hertz: f64| wave.along(TAU * hertz).map_or(1.0, |air| air.fall_share());
    let (near_share, far_share) = (fall_share(request.band_hz.0), fall_share(request.band_hz.1));
    let (number, slope) = (model.width_number(1), model.width_slope(1));
    let length = request.length_m;
    if let Some(margin_m) = request.start_margin_m {
        start_margin_range(length).check("start_margin_m", margin_m)?;
    }
    if let Some(margin_m) = request.end_margin_m {
        end_margin_range(length).check("end_margin_m", margin_m)?;
    }
    let start_room = match model {
        Model::BendingClamped(_) => START_ROOM_CLAMPED,
        _ => START_ROOM,
    };
    // The margins depend on kappa, kappa on the rate and the rate on the margins: iterate, with a share of the new rate and
    // the rest of the old one so that it converges. On a plate without room for a span the edges are steep and the rate jumps:
    // there it takes a smaller share.
    let mut rate = (far_k / near_k).ln() / (0.6 * length);
    let (mut near_m, mut far_m) = (0.0, length);
    let film_edge_m = model.film_square().map(f64::sqrt);
    let turning = |rate: f64, k: f64| Turning::of(rate, number / k, film_edge_m);
    let half_width = |rate: f64, k: f64| turning(rate, k).half_width_m;
    let span_least_m = SPAN_LEAST * length * (1.0 - 1e-9);
    let rate_over = |rate: f64, span: f64| (half_width(rate, near_k) / half_width(rate, far_k)).ln() / span;
    let shares = std::iter::repeat_n(0.5, 60).chain(std::iter::repeat_n(0.05, 600));
    for (i, share) in shares.enumerate() {
        if i == 60 && far_m - near_m >= span_least_m {
            break;
        }
        // The arc falls more slowly than the half-width: with sin(2 angle)/(2 angle) of its rate.
        let kappa = |k: f64, share: f64| {
            let Turning { angle, rate_per_m, .. } = turning(rate, k);
            let doubled = 2.0 * angle;
            (2.0 * rate_per_m * doubled.sin() / doubled * slope * k * k * share).cbrt()
        };
        near_m = request.start_margin_m.unwrap_or(start_room / kappa(near_k, near_share));
        far_m = length - request.end_margin_m.unwrap_or(END_ROOM / kappa(far_k, far_share));
        let wanted = rate_over(rate, (far_m - near_m).max(SPAN_LEAST * length));
        rate = (1.0 - share) * rate + share * wanted;
    }
    if far_m - near_m < span_least_m {
        let margins_m = near_m + length - far_m;
        let consequence = Consequence::Margins { band_hz: request.band_hz, margins_m };
        return Err(PlateError::unfit("length_m", length, consequence));
    }
    // The margins are final; only the rate is iterated to the last digit.
    for _ in 0..60 {
        rate = 0.5 * rate + 0.5 * rate_over(rate, far_m - near_m);
    }
    let rate_per_m = rate;
    // Edges so steep that the rate does not settle have another band than the one asked for.
    let is_settled = (rate_over(rate, far_m - near_m) / rate - 1.0).abs() < SETTLED;
    if !is_settled || turning(rate_per_m, near_k).angle >= ANGLE_MOST {
        let consequence = Consequence::Converging { frequency_hz: request.band_hz.0 };
        return Err(PlateError::unfit("length_m", length, consequence));
    }
    let half_width_m = half_width(rate_per_m, near_k) * (rate_per_m * near_m).exp();
    Ok(FoundTaper { half_width_m, rate_per_m, near_m, far_m })
}

/// The loss factor at which the larger loss integral of the two ends of the span reaches the green limit. The integral
/// is proportional to the loss factor, so one value of it is enough.
fn loss_factor_limit(plate: &Plate) -> Result<f64, PlateError> {
    let loss_factor = 0.1;
    let lossy = Plate::new(PlateSpec { loss_factor, ..plate.spec().clone() })?;
    let (start, end) = lossy.span_m();
    Ok(thresholds::LOSS.green * loss_factor / loss_integral(&lossy, start).max(loss_integral(&lossy, end)))
}

fn band_end(plate: &Plate, frequency_hz: f64) -> BandEnd {
    let boundary_m = plate.turning_point_m(frequency_hz).unwrap_or(0.0);
    BandEnd {
        frequency_hz,
        boundary_m,
        half_width_m: plate.half_width_m(boundary_m),
        edge_width_m: plate.kappa_per_m(frequency_hz).map_or(f64::NAN, |kappa| airy::EDGE_WIDTH / kappa),
        wavelengths: wavelengths(plate, boundary_m),
        loss_integral: loss_integral(plate, boundary_m),
    }
}

#[cfg(test)]
mod tests;

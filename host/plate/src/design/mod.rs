//! The plate designer: from a material, a thickness, a band and a length to a plate, its damper and its cut files.
//!
//! ```text
//! Request -> design() -> Design { plate, damper, low, high, .. } -> plate.to_toml()
//!                                                               -> plate_drawing(), frame_drawing() -> SVG, DXF
//! ```
//! The taper is the exponential one: W = W0 e^(-d x) with W = q/K at both ends of the band, so
//! d = ln(K2/K1)/(x2 - x1) and W0 = (q/K1) e^(d x1). K comes from the plate's own model, thick plates included.

mod damper;
mod drawing;
mod dxf;
mod material;
mod outline;
mod svg;

use crate::airy;
use crate::check::{loss_integral, thresholds, wavelengths};
use crate::drive::DriveEnd;
use crate::error::{Consequence, Origin, PlateError};
use crate::model::{Bending, Model};
use crate::plate::{Plate, PlateSpec};
use crate::range::{self, Range};
use crate::taper::Taper;
use serde::Serialize;
use std::f64::consts::TAU;

pub use damper::Damper;
pub use drawing::{Drawing, Layer, Shape};
pub use material::{Material, material_names};

/// How the sheet carries the wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wave {
    /// A stiff plate in bending.
    Bending {
        /// How its edges are held.
        edge: Edge,
        /// Whether shear and rotary inertia are included (Mindlin).
        thick_plate: bool,
    },
    /// A stretched membrane between fixed edges.
    Membrane {
        /// Wave speed sqrt(tension stress/density), m/s (0.1 to 20 000).
        wave_speed_m_per_s: f64,
    },
    /// The shear-horizontal wave of the material between fixed edges.
    ShearHorizontal,
}

impl Wave {
    /// A membrane of this material and thickness (m) under `tension_n_per_m`: speed = sqrt(tension/(density thickness)).
    #[must_use]
    pub fn under_tension(tension_n_per_m: f64, material: &Material, thickness_m: f64) -> Self {
        let surface_density = material.density_kg_per_m3 * thickness_m;
        Self::Membrane { wave_speed_m_per_s: (tension_n_per_m / surface_density).sqrt() }
    }
}

/// How the long edges of a bending plate are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Edge {
    /// On a knife edge: no displacement, free to turn.
    Supported,
    /// Between the halves of a stiff frame: no displacement, no turn.
    Clamped,
}

/// What a plate is wanted for.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Short name of the plate, 1 to 80 characters.
    pub name: String,
    /// The sheet.
    pub material: Material,
    /// Thickness of the sheet, metres (1e-6 to 0.1).
    pub thickness_m: f64,
    /// How the sheet carries the wave.
    pub wave: Wave,
    /// Lowest and highest frequency of the boundary, Hz (0.5 to 1e7, at least 5 % apart).
    pub band_hz: (f64, f64),
    /// Length from the driven end to the narrow end, metres (0.005 to 10).
    pub length_m: f64,
    /// From the driven end to the nearest boundary, metres; `None`: as much as its peak needs.
    pub start_margin_m: Option<f64>,
    /// From the farthest boundary to the narrow end, metres; `None`: as much as its tail needs.
    pub end_margin_m: Option<f64>,
    /// Displacement of the drive at DAC full scale, metres (1e-9 to 0.1).
    pub full_scale_m: f64,
    /// Width of the frame's rim, metres (0.01 to 0.5: the bolts need room).
    pub rim_m: f64,
}

impl Request {
    /// A request with the usual rest: automatic margins, a rim of 20 mm, a drive of 1 um from 1 kHz on and 100 um
    /// below.
    pub fn new(
        name: &str,
        material: Material,
        thickness_m: f64,
        wave: Wave,
        band_hz: (f64, f64),
        length_m: f64,
    ) -> Self {
        Self {
            name: name.to_owned(),
            material,
            thickness_m,
            wave,
            band_hz,
            length_m,
            start_margin_m: None,
            end_margin_m: None,
            full_scale_m: if band_hz.0 >= 1e3 { 1e-6 } else { 1e-4 },
            rim_m: 0.02,
        }
    }
}

/// What the plate does at one end of its band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandEnd {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Turning point, metres.
    pub boundary_m: f64,
    /// Half-width there, metres.
    pub half_width_m: f64,
    /// From the peak to a tenth of it, metres.
    pub edge_width_m: f64,
    /// Wavelengths from the drive to the boundary.
    pub wavelengths: f64,
    /// Loss integral I: the wave arrives with e^-I of its amplitude.
    pub loss_integral: f64,
}

/// A designed plate.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The plate, with the damper as its drive end.
    pub plate: Plate,
    /// Rate d of the taper, 1/m.
    pub rate_per_m: f64,
    /// The lowest frequency's boundary.
    pub low: BandEnd,
    /// The highest frequency's boundary.
    pub high: BandEnd,
    /// Loss factor at which the worst boundary's loss integral reaches 3 and its peak is no longer the largest
    /// amplitude; the material's own loss factor is the plate's `loss_factor`.
    pub loss_factor_limit: f64,
    /// Boundaries from the nearest up to this one are alone on the plate when the drive is on the centre line, metres.
    pub single_boundary_to_m: f64,
    /// The same for a drive beside the centre line, metres; nearer than the nearest boundary if there is none.
    pub single_boundary_off_centre_to_m: f64,
    /// The damper that matches the drive end.
    pub damper: Damper,
    /// Tension of a membrane, N per metre of width; `None` for a plate that needs none.
    pub tension_n_per_m: Option<f64>,
    rim_m: f64,
    edges_free_to_turn: bool,
}

/// Designs the plate.
///
/// # Errors
/// [`PlateError`] names the field of the request that is out of range and what is allowed.
pub fn design(request: &Request) -> Result<Design, PlateError> {
    request.material.validate()?;
    range::THICKNESS.check("thickness_m", request.thickness_m)?;
    range::LENGTH.check("length_m", request.length_m)?;
    range::FREQUENCY.check("band low", request.band_hz.0)?;
    let (low_hz, high_hz) = request.band_hz;
    band_high_range(low_hz).check_from(Origin::BandLow(low_hz), "band high", high_hz)?;
    range::FULL_SCALE.check("full_scale_m", request.full_scale_m)?;
    range::RIM.check("rim_m", request.rim_m)?;
    let model = model(request);
    model.validate()?;
    let taper = taper_for(request, &model)?;
    let mut spec = PlateSpec {
        name: request.name.clone(),
        description: describe(request),
        taper: Taper::Exponential { half_width_m: taper.half_width_m, rate_per_m: taper.rate_per_m },
        length_m: request.length_m,
        model,
        loss_factor: request.material.loss_factor,
        wave_speed_tolerance: WAVE_SPEED_TOLERANCE,
        drive_end: DriveEnd::Displacement,
        actuator: None,
        full_scale_m: request.full_scale_m,
        span_start_m: taper.near_m,
        span_end_m: taper.far_m,
    };
    let undamped = Plate::new(spec.clone())?;
    let (match_frequency_hz, ratio_range) = damper::best_match(&undamped, request.band_hz);
    spec.drive_end = DriveEnd::Resistance { ratio: 1.0, at_frequency_hz: match_frequency_hz };
    let plate = Plate::new(spec)?;
    let surface_density = request.material.density_kg_per_m3 * request.thickness_m;
    let resistance_n_s_per_m = damper::wave_impedance(&plate, surface_density, match_frequency_hz);

    let (low, high) = (band_end(&plate, request.band_hz.0), band_end(&plate, request.band_hz.1));
    let alone_to = |mode: u32| {
        let enters_at_hz = plate.guide(mode).cut_off_hz(0.0);
        plate.turning_point_m(enters_at_hz).unwrap_or(0.0).min(taper.far_m)
    };
    Ok(Design {
        rate_per_m: taper.rate_per_m,
        low,
        high,
        loss_factor_limit: loss_factor_limit(&plate)?,
        single_boundary_to_m: alone_to(3),
        single_boundary_off_centre_to_m: alone_to(2),
        damper: Damper { resistance_n_s_per_m, match_frequency_hz, ratio_range },
        tension_n_per_m: match request.wave {
            Wave::Membrane { wave_speed_m_per_s } => Some(surface_density * wave_speed_m_per_s.powi(2)),
            Wave::Bending { .. } | Wave::ShearHorizontal => None,
        },
        rim_m: request.rim_m,
        edges_free_to_turn: matches!(request.wave, Wave::Bending { edge: Edge::Supported, .. }),
        plate,
    })
}

impl Design {
    /// Boundaries that are alone on the plate, as a length of travel from the nearest one, metres (drive on the
    /// centre line).
    pub fn mode_free_travel_m(&self) -> f64 {
        (self.single_boundary_to_m - self.low.boundary_m).max(0.0)
    }

    /// The sheet to cut.
    pub fn plate_drawing(&self) -> Drawing {
        outline::plate(&self.plate, self.rim_m, self.edges_free_to_turn)
    }

    /// The frame to cut, twice where the edges are clamped.
    pub fn frame_drawing(&self) -> Drawing {
        outline::frame(&self.plate, self.rim_m)
    }
}

struct FoundTaper {
    half_width_m: f64,
    rate_per_m: f64,
    near_m: f64,
    far_m: f64,
}

/// Room before the nearest boundary, in 1/kappa: to the first node of its Airy form, so that its peak is whole.
const START_ROOM: f64 = 2.338;
/// Room behind the farthest boundary, in 1/kappa: to 5 % of its peak.
const END_ROOM: f64 = 2.172;
/// Shortest span, as a part of the length.
const SPAN_LEAST: f64 = 0.1;
/// Handbook constants of a metal and a gauge of its thickness give the wave speed to about 1 %.
const WAVE_SPEED_TOLERANCE: f64 = 0.01;

/// How far the end of a band is above its start at least, percent.
pub const BAND_WIDTH_MIN_PERCENT: f64 = 5.0;

/// The highest frequency of a band that starts at `low_hz`, Hz.
pub fn band_high_range(low_hz: f64) -> Range {
    Range { low: (1.0 + 0.01 * BAND_WIDTH_MIN_PERCENT) * low_hz, ..range::FREQUENCY }
}

/// From the driven end to the nearest boundary, metres, on a plate of this length.
pub fn start_margin_range(length_m: f64) -> Range {
    Range { high: (1.0 - SPAN_LEAST) * length_m, ..range::span_start(length_m) }
}

/// From the farthest boundary to the narrow end, metres, on a plate of this length.
pub fn end_margin_range(length_m: f64) -> Range {
    Range::new(0.0, (1.0 - SPAN_LEAST) * length_m, "m")
}

fn taper_for(request: &Request, model: &Model) -> Result<FoundTaper, PlateError> {
    let wavenumber = |frequency_hz: f64| model.wavenumber_squared(TAU * frequency_hz).sqrt();
    let (near_k, far_k) = (wavenumber(request.band_hz.0), wavenumber(request.band_hz.1));
    let (number, slope) = (model.width_number(1), model.width_slope(1));
    let length = request.length_m;
    if let Some(margin_m) = request.start_margin_m {
        start_margin_range(length).check("start_margin_m", margin_m)?;
    }
    if let Some(margin_m) = request.end_margin_m {
        end_margin_range(length).check("end_margin_m", margin_m)?;
    }
    // kappa depends on the rate and the rate on the margins: a few rounds settle it.
    let mut rate = (far_k / near_k).ln() / (0.6 * length);
    let (mut near_m, mut far_m) = (0.0, length);
    for _ in 0..60 {
        let kappa = |k: f64| (2.0 * rate * slope * k * k).cbrt();
        near_m = request.start_margin_m.unwrap_or(START_ROOM / kappa(near_k));
        far_m = length - request.end_margin_m.unwrap_or(END_ROOM / kappa(far_k));
        let span = (far_m - near_m).max(SPAN_LEAST * length);
        rate = 0.5 * rate + 0.5 * (far_k / near_k).ln() / span;
    }
    if far_m - near_m < SPAN_LEAST * length * (1.0 - 1e-9) {
        let margins_m = near_m + length - far_m;
        let consequence = Consequence::Margins { band_hz: request.band_hz, margins_m };
        return Err(PlateError::unfit("length_m", length, consequence));
    }
    let rate_per_m = (far_k / near_k).ln() / (far_m - near_m);
    let half_width_m = number / near_k * (rate_per_m * near_m).exp();
    Ok(FoundTaper { half_width_m, rate_per_m, near_m, far_m })
}

fn model(request: &Request) -> Model {
    let material = &request.material;
    match request.wave {
        Wave::Membrane { wave_speed_m_per_s } => Model::Membrane { wave_speed_m_per_s },
        Wave::ShearHorizontal => Model::ShearHorizontal {
            shear_modulus_pa: material.shear_modulus_pa(),
            density_kg_per_m3: material.density_kg_per_m3,
        },
        Wave::Bending { edge, thick_plate } => {
            let bending = Bending {
                youngs_modulus_pa: material.youngs_modulus_pa,
                poisson_ratio: material.poisson_ratio,
                density_kg_per_m3: material.density_kg_per_m3,
                thickness_m: request.thickness_m,
                thick_plate,
            };
            match edge {
                Edge::Supported => Model::BendingSupported(bending),
                Edge::Clamped => Model::BendingClamped(bending),
            }
        }
    }
}

fn describe(request: &Request) -> String {
    let wave = match request.wave {
        Wave::Membrane { .. } => "stretched",
        Wave::ShearHorizontal => "SH wave",
        Wave::Bending { edge: Edge::Supported, .. } => "bending, supported edges",
        Wave::Bending { edge: Edge::Clamped, .. } => "bending, clamped edges",
    };
    format!(
        "Designed: {} {:.3} mm, {wave}, boundary from {:.1} to {:.1} Hz",
        request.material.name,
        request.thickness_m * 1e3,
        request.band_hz.0,
        request.band_hz.1
    )
}

/// The loss integral is proportional to the loss factor: scaled from a plate of known loss.
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

//! Thickness laws of a plate in bending along x.
//!
//! With h = h0 e^v, the bending stiffness D is proportional to h^3 and the mass per area to h. So K^2 is proportional
//! to 1/h and the power of a wave to h^2:
//!
//! ```text
//! k^2 = a (K0^2 h0/h - (q/s)^2),    (S f')' + S k^2 f = 0,    S = W h^2
//! ```
//! A wave turns where K0 s sqrt(h0/h) = q: as on a plate of uniform thickness h0 with the turning half-width
//! s sqrt(h0/h).

use super::turning_width::TurningLaw;
use crate::definition::air::Air;
use crate::definition::drive::DriveEnd;
use crate::definition::error::{Consequence, PlateError};
use crate::definition::limits;
use crate::definition::log_width::LogWidth;
use crate::definition::model::{Bending, Model};
use crate::definition::taper::WidthLaw;
use crate::quantity::Range;

/// The law of the thickness h(x) of a plate in bending; the thickness of the model is h0 = h(0).
///
/// ```
/// use slipline_plate::{DriveEnd, Plate, PlateSpec, Thickness, TurningWidth, preset};
///
/// let mut spec = preset("al-bending").unwrap().spec().clone();
/// spec.drive_end = DriveEnd::Displacement;
/// spec.turning_width = TurningWidth::Plain;
/// spec.thickness = Some(Thickness::Exponential { rate_per_m: 2.0 });
/// let plate = Plate::new(spec).unwrap();
/// // x0 = ln(f/fc0)/(2 d - g).
/// let x0 = (30e3 / plate.cut_off_hz()).ln() / (2.0 * 4.62 - 2.0);
/// assert!((plate.turning_point_m(30e3).unwrap() - x0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Thickness {
    /// h = h0 e^(-g x).
    Exponential {
        /// Rate g, 1/m (-1000 to 1000; below twice the taper's rate); negative where the plate becomes thicker.
        rate_per_m: f64,
    },
    /// A straight line from h0 at x = 0 to the plate's end.
    Linear {
        /// Thickness at the narrow end, metres (1e-6 to 0.1).
        end_thickness_m: f64,
    },
    /// Measured or drawn points, joined by a cubic curve of ln h that is monotone between neighbouring points.
    Sampled {
        /// 2 to 10 000 pairs `[position_m, thickness_m]`. Positions rise from 0 to at least the plate's length in steps
        /// of at least 1e-6 m; the first thickness is that of the model.
        points: Vec<[f64; 2]>,
    },
}

impl Thickness {
    /// Checks the numbers for a plate of this model and length, and that the other sections allow a thickness law.
    pub(crate) fn validate(
        &self,
        model: &Model,
        air: Option<&Air>,
        drive_end: &DriveEnd,
        length_m: f64,
    ) -> Result<(), PlateError> {
        let Some(bending) = model.bending() else {
            return Err(PlateError::unexpected(
                "thickness",
                "only a plate in bending has a law of its thickness",
            ));
        };
        if bending.thick_plate {
            let reason = "shear and rotary inertia are not modelled where the thickness changes ([thickness]): leave it out";
            return Err(PlateError::unexpected("model.thick_plate", reason));
        }
        if let Model::BendingClamped(_) = model {
            let reason = "clamped edges are not modelled where the thickness changes";
            return Err(PlateError::unexpected("thickness", reason));
        }
        if let Some(Air::Around { .. }) = air {
            return Err(PlateError::unexpected(
                "air",
                "the mass of the air is not modelled where the thickness changes ([thickness])",
            ));
        }
        match drive_end {
            DriveEnd::Displacement | DriveEnd::Force { .. } | DriveEnd::Resistance { .. } => {}
            DriveEnd::DisplacementAndSlope { .. } => {
                let reason =
                    "the near field of an end is not modelled where the thickness changes ([thickness])";
                return Err(PlateError::unexpected("drive.slope", reason));
            }
            DriveEnd::Source(_) => {
                let reason = "the near field behind a \"source\" is not modelled where the thickness changes ([thickness]); a \"resistance\" has no near field";
                return Err(PlateError::unexpected("drive.end", reason));
            }
        }
        self.validate_numbers(bending, length_m)
    }

    fn validate_numbers(&self, bending: &Bending, length_m: f64) -> Result<(), PlateError> {
        match self {
            Self::Exponential { rate_per_m } => {
                let end = bending.thickness_m * (-rate_per_m * length_m).exp();
                limits::THICKNESS.check("thickness.rate_per_m", end).map_err(|_| {
                    let range = limits::THICKNESS;
                    let at = |thickness_m: f64| (bending.thickness_m / thickness_m).ln() / length_m;
                    Range::new(at(range.high), at(range.low), "1/m").refuse(
                        "thickness.rate_per_m",
                        *rate_per_m,
                        None,
                    )
                })
            }
            Self::Linear { .. } => Ok(()),
            Self::Sampled { points } => {
                limits::TAPER_POINTS.check("thickness.points", points.len())?;
                let mut before_m = f64::NEG_INFINITY;
                for (index, [position_m, thickness_m]) in points.iter().copied().enumerate() {
                    let places = Range::new((before_m + 1e-6).max(0.0), limits::TAPER_PLACE.high, "m");
                    places.check(format_args!("thickness.points[{index}][0]"), position_m)?;
                    limits::THICKNESS.check(format_args!("thickness.points[{index}][1]"), thickness_m)?;
                    before_m = position_m;
                }
                let ([first_m, driven_m], last) = (points[0], points.len() - 1);
                Range::new(0.0, 0.0, "m").check("thickness.points[0][0]", first_m)?;
                let same = Range::new(bending.thickness_m, bending.thickness_m, "m");
                same.check("thickness.points[0][1]", driven_m)?;
                let field = format!("thickness.points[{last}][0]");
                Range::new(length_m * (1.0 - 1e-9), limits::TAPER_PLACE.high, "m")
                    .check(&field, points[last][0])
            }
        }
    }

    /// v = ln(h/h0) over x, with h0 = `driven_m`.
    fn law(&self, driven_m: f64, length_m: f64) -> WidthLaw {
        match self {
            Self::Exponential { rate_per_m } => {
                WidthLaw::Exponential { log_width: 0.0, rate_per_m: *rate_per_m }
            }
            Self::Linear { end_thickness_m } => {
                WidthLaw::Linear { half_width_m: 1.0, fall: (1.0 - end_thickness_m / driven_m) / length_m }
            }
            Self::Sampled { points } => WidthLaw::curve(
                points.iter().map(|point| point[0]).collect(),
                points.iter().map(|point| (point[1] / driven_m).ln()).collect(),
            ),
        }
    }
}

/// The thickness prepared for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grading {
    law: WidthLaw,
    /// ln(s sqrt(h0/h)), which determines the turning points.
    turning: TurningLaw,
}

/// Intervals of the curve of turning widths over the plate, and the length of its continuation beyond the end, over the
/// plate's length.
const INTERVALS: usize = 1024;
const BEYOND: f64 = 0.5;

impl Grading {
    /// The grading of a validated plate, with `turning` as its law of the turning half-width.
    ///
    /// # Errors
    /// [`PlateError::Unfit`] where the plate does not narrow faster than the root of its thickness.
    pub(crate) fn new(
        thickness: &Thickness,
        driven_m: f64,
        length_m: f64,
        turning: &TurningLaw,
        reach_m: f64,
    ) -> Result<Self, PlateError> {
        let law = thickness.law(driven_m, length_m);
        let thinnest_m = if let WidthLaw::Linear { .. } = law { law.reach_m() } else { f64::INFINITY };
        let thinnest_m = if thinnest_m > 0.0 { thinnest_m } else { f64::INFINITY };
        let end = ((1.0 + BEYOND) * length_m).min(0.99 * reach_m.min(thinnest_m)).max(length_m);
        let step = length_m / INTERVALS as f64;
        let count = (end / step).ceil() as usize;
        let (mut position, mut value, mut slope) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..=count {
            let x = (i as f64 * step).min(end);
            let (s, h) = (turning.at(x), law.at(x));
            let fall = s.slope - 0.5 * h.slope;
            let place = s.value - 0.5 * h.value;
            let falls = fall < 0.0 && value.last().is_none_or(|before| place < *before);
            if !falls && x <= length_m {
                let consequence = Consequence::Turning { place_m: x };
                return Err(PlateError::unfit("model.thickness_m", driven_m, consequence));
            }
            if !falls {
                break;
            }
            position.push(x);
            value.push(place);
            slope.push(fall);
        }
        Ok(Self { law, turning: TurningLaw::Width(WidthLaw::Curve { position, value, slope }) })
    }

    /// ln(h/h0) at `x`.
    pub(crate) fn log(&self, x: f64) -> LogWidth {
        self.law.at(x)
    }

    /// ln(s sqrt(h0/h)) at `x` and its derivative.
    pub(crate) fn turning(&self) -> &TurningLaw {
        &self.turning
    }
}

//! Unknowns of the plate as coordinates that a fit moves, and their standard deviations beforehand, by calipers and plate
//! file.
//!
//! | coordinate | of | known beforehand to (standard deviation) |
//! |---|---|---|
//! | 0 | ln of the wave speed over the file's | 10 % |
//! | 1 | ln of the loss factor over the file's | a factor of e |
//! | 2 | ln(W0/W(L)) over the file's, less 1 | [`Priors::taper`] |
//! | 3 | ln of W0 over the file's | [`Priors::half_width`] |
//! | 4 | how far the edges give beyond the file's, metres | [`Priors::edge_give_m`], or what the file states |
//! | 5, of a plate in air | ln of the air's coefficient over the file's | [`Priors::air`], or what the mounting leaves open |
//! | 6, of a membrane in air | share of the pressure at a distance beside the file's | the same |
//! | the last, where the file states how well it is known | exponent of the loss over the frequency, beside the file's | the file's `loss_exponent_tolerance` |

use crate::definition::limits;
use crate::definition::taper::WidthLaw;
use crate::definition::{Air, AirMounting, BAFFLE, BARE_FRAME, Model, PlateSpec};
use crate::quantity::{OutOfRange, Range};

/// Coordinates of the plate: [`OF_PLATE`] of them, those of its air where air swings with it, and that of the loss's exponent where
/// it is open ([`of_plate`]). Those of the sensors follow.
pub(crate) const SPEED: usize = 0;
pub(crate) const LOSS: usize = 1;
pub(crate) const TAPER: usize = 2;
pub(crate) const HALF_WIDTH: usize = 3;
pub(crate) const EDGE_GIVE: usize = 4;
pub(crate) const OF_PLATE: usize = 5;
pub(crate) const AIR: usize = 5;
pub(crate) const DISTANT_AIR: usize = 6;
/// The most that a plate has.
pub(crate) const OF_PLATE_MAX: usize = 8;
/// Standard deviation of how far edges give, metres: a lip that pivots in its 1 mm, a line of glue, a kerf.
const GIVE: f64 = 3e-4;
/// The same of clamped edges, over the thickness: a clamp of the plate's own material turns by some of it.
const CLAMPED_GIVE: f64 = 0.5;
/// The edges of a plate with a narrow end are made more finely: there it is at most this share of the half-width.
const GIVE_SHARE: f64 = 0.1;
/// Standard deviation of ln alpha in a baffle.
const OF_BAFFLE: f64 = 0.02;
/// alpha of the air around a plate of unknown mounting that is tried first: that of a bare frame, of a baffle, and between.
const TRIED: [f64; 3] = [BARE_FRAME, AirMounting::Unknown.coefficient().0, BAFFLE];
/// Standard deviations of a 95 % interval.
pub(crate) const INTERVAL: f64 = 1.96;
/// Standard deviation of a coordinate that is held.
pub(crate) const HELD: f64 = 1e-9;
/// Ways over which derivatives by the coordinates up to those of the air are taken, and by the exponent of the loss.
const STEPS: [f64; DISTANT_AIR + 1] = [1e-6, 1e-4, 1e-6, 1e-6, 1e-7, 1e-5, 1e-3];
const EXPONENT_STEP: f64 = 1e-3;

/// How well the plate's numbers are known before it is measured, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Priors {
    /// Deviation of ln(wave speed) (0.001 to 0.5).
    pub wave_speed: f64,
    /// Deviation of ln(loss factor) (0.01 to 3).
    pub loss: f64,
    /// Deviation of ln(W0/W(L)), relative (1e-5 to 0.1): for an exponential taper, of its rate.
    pub taper: f64,
    /// Deviation of W0, relative (1e-5 to 0.1).
    pub half_width: f64,
    /// Deviation of how far the edges give, metres (1e-9 to 0.005); `None` for that of the file's `edge_give_tolerance_m`, and
    /// where it states none for 0.3 mm, of clamped edges half the thickness where that is more, and at most a tenth of the
    /// half-width at the narrow end.
    pub edge_give_m: Option<f64>,
    /// Deviations of ln of the air's coefficient, and of the share of the pressure at a distance (1e-5 to 1), on a
    /// plate in air; `None` for what its mounting leaves open.
    pub air: Option<f64>,
}

impl Default for Priors {
    /// A plate that was cut to 0.3 % of its width and 0.4 % of its taper, of a material known to 10 % of wave speed and
    /// a factor of e of loss.
    fn default() -> Self {
        Self { wave_speed: 0.1, loss: 1.0, taper: 4e-3, half_width: 3e-3, edge_give_m: None, air: None }
    }
}

impl Priors {
    /// Refuses a standard deviation that is out of its range.
    pub(crate) fn check(&self) -> Result<(), OutOfRange> {
        let widths = Range::new(1e-5, 0.1, "");
        OutOfRange::check("priors.wave_speed", self.wave_speed, Range::new(1e-3, 0.5, ""))?;
        OutOfRange::check("priors.loss", self.loss, Range::new(0.01, 3.0, ""))?;
        OutOfRange::check("priors.taper", self.taper, widths)?;
        OutOfRange::check("priors.half_width", self.half_width, widths)?;
        if let Some(give_m) = self.edge_give_m {
            let range = Range::new(HELD, limits::EDGE_GIVE.high, "m");
            OutOfRange::check("priors.edge_give_m", give_m, range)?;
        }
        self.air.map_or(Ok(()), |air| OutOfRange::check("priors.air", air, Range::new(1e-5, 1.0, "")))
    }

    /// The standard deviations of the coordinates that every plate has, in their order.
    pub(crate) fn deviations(&self, nominal: &PlateSpec) -> [f64; OF_PLATE] {
        let edge_give_m = self.edge_give_m.unwrap_or_else(|| edge_give_known_m(nominal));
        // Another tension across is another half-width: half of the ratio's error beside that of the cut.
        let ratio = nominal.tension_ratio_tolerance.unwrap_or(0.0) / nominal.tension_ratio.unwrap_or(1.0);
        let half_width = self.half_width.hypot(0.5 * ratio / INTERVAL);
        [self.wave_speed, self.loss, self.taper, half_width, edge_give_m]
    }

    /// The same of all coordinates of this plate.
    pub(crate) fn deviations_of(&self, nominal: &PlateSpec) -> Vec<f64> {
        let of_air = mounting_of(nominal).into_iter().flat_map(|mounting| {
            [mounting.deviation(), mounting.distant_deviation()].map(|usual| self.air.unwrap_or(usual))
        });
        let of_air = of_air.take(of_air_count(nominal));
        self.deviations(nominal).into_iter().chain(of_air).chain(exponent_known(nominal)).collect()
    }
}

/// Standard deviation of how far the edges give, by the file.
fn edge_give_known_m(nominal: &PlateSpec) -> f64 {
    let narrowest_m = WidthLaw::new(&nominal.taper, nominal.length_m).at(nominal.length_m).value.exp();
    let made_m = match &nominal.model {
        Model::BendingClamped(bending) => GIVE.max(CLAMPED_GIVE * bending.thickness_m),
        _ => GIVE,
    };
    let usual_m = made_m.min(GIVE_SHARE * narrowest_m);
    nominal.edge_give_tolerance_m.map_or(usual_m, |half_m| (half_m / INTERVAL).max(HELD))
}

/// The coordinates of every plate with this wave speed and loss, and all else as the file states it.
pub(crate) const fn with_speed(speed: f64, loss: f64) -> [f64; OF_PLATE] {
    let mut coordinates = [0.0; OF_PLATE];
    (coordinates[SPEED], coordinates[LOSS]) = (speed, loss);
    coordinates
}

/// Number of coordinates of this plate.
pub(crate) fn of_plate(nominal: &PlateSpec) -> usize {
    OF_PLATE + of_air_count(nominal) + usize::from(exponent_at(nominal).is_some())
}

/// The coordinate of the exponent of the loss; `None` where the file holds it.
pub(crate) fn exponent_at(nominal: &PlateSpec) -> Option<usize> {
    exponent_known(nominal).map(|_| OF_PLATE + of_air_count(nominal))
}

/// Its standard deviation by the file.
fn exponent_known(nominal: &PlateSpec) -> Option<f64> {
    nominal.loss_exponent_tolerance.filter(|half| *half > 0.0).map(|half| half / INTERVAL)
}

/// The ways over which derivatives by the coordinates of this plate are taken.
pub(crate) fn steps(nominal: &PlateSpec) -> Vec<f64> {
    let exponent = exponent_known(nominal).map(|_| EXPONENT_STEP);
    STEPS.into_iter().take(OF_PLATE + of_air_count(nominal)).chain(exponent).collect()
}

/// Number of coordinates of this plate's air.
pub(crate) fn of_air_count(nominal: &PlateSpec) -> usize {
    match (&nominal.air, &nominal.model) {
        (None | Some(Air::Vacuum), _) => 0,
        // Above a table no pressure at a distance counts.
        (Some(Air::Around { mounting, gap_m: None, .. }), Model::Membrane { .. })
            if mounting.distant_deviation() > 0.0 =>
        {
            2
        }
        (Some(Air::Around { .. }), _) => 1,
    }
}

/// Whether the pressure at a distance is one of its coordinates.
pub(crate) fn has_distant_air(nominal: &PlateSpec) -> bool {
    OF_PLATE + of_air_count(nominal) > DISTANT_AIR
}

fn mounting_of(spec: &PlateSpec) -> Option<AirMounting> {
    spec.air.as_ref().and_then(Air::mounting)
}

/// What is known beside the coordinates themselves, in standard deviations: a plate that holds the pressure at a distance together
/// stands in a baffle, where the wave does not depend on alpha and alpha is a convention. `None` where the plate has no such
/// coordinates.
pub(crate) fn of_baffle(nominal: &PlateSpec, coordinates: &[f64]) -> Option<f64> {
    if !has_distant_air(nominal) {
        return None;
    }
    let mounting = mounting_of(nominal)?;
    let distant = mounting.distant() + coordinates.get(DISTANT_AIR)?;
    let (alpha, _) = mounting.coefficient();
    Some(distant * ((alpha / BAFFLE).max(f64::MIN_POSITIVE).ln() + coordinates.get(AIR)?) / OF_BAFFLE)
}

/// The specification at these coordinates of the plate: of every plate's alone, its air stays.
pub(crate) fn spec_at(nominal: &PlateSpec, coordinates: &[f64]) -> PlateSpec {
    let mut spec = nominal.clone();
    let speed = coordinates[SPEED].exp();
    spec.model.speed_up(speed);
    // A lossless file has nothing to multiply: its coordinate is taken from a small loss.
    spec.loss_factor = (loss_of(nominal) * coordinates[LOSS].exp()).min(limits::LOSS_FACTOR.high);
    let (scale, power) = (coordinates[HALF_WIDTH].exp(), 1.0 + coordinates[TAPER]);
    spec.taper = spec.taper.stretched(scale, power);
    // Where the edges are held, the taper keeps its law: between edges that give by any length it is a curve through many places.
    if let Some(give_m) = coordinates.get(EDGE_GIVE).filter(|give_m| give_m.abs() > HELD) {
        spec.edge_give_m = Some(spec.edge_give_m.unwrap_or(0.0) + give_m);
    }
    if let (Some(Air::Around { mounting, gap_m, .. }), Some(air)) = (&mut spec.air, coordinates.get(AIR)) {
        let alpha = (mounting.coefficient().0 * air.exp()).min(limits::AIR_COEFFICIENT.high);
        let more = if has_distant_air(nominal) { coordinates.get(DISTANT_AIR) } else { None };
        let range = limits::DISTANT_AIR;
        let stated = if gap_m.is_none() { mounting.distant() } else { 0.0 };
        let distant = (stated + more.unwrap_or(&0.0)).clamp(range.low, range.high);
        *mounting = mounting.found(alpha, distant);
    }
    if let Some(exponent) = exponent_at(nominal).and_then(|at| coordinates.get(at)) {
        let range = limits::LOSS_EXPONENT;
        let stated = nominal.loss_exponent.unwrap_or(0.0);
        spec.loss_exponent = Some((stated + exponent).clamp(range.low, range.high));
    }
    spec
}

/// A membrane of unknown mounting in air of each tried coefficient, without the pressure at a distance; none where the mounting
/// is known or the plate has no such pressure. From a share of that pressure which the actual air does not have, a fit on clean
/// data does not find the coefficient.
pub(crate) fn in_tried_air(nominal: &PlateSpec) -> Vec<PlateSpec> {
    let Some(Air::Around { gas, mounting: AirMounting::Unknown, gap_m }) = nominal.air else {
        return Vec::new();
    };
    if !has_distant_air(nominal) {
        return Vec::new();
    }
    let (_, faces) = AirMounting::Unknown.coefficient();
    let with = |alpha: f64| Air::Around { gas, mounting: AirMounting::Coefficient { alpha, faces }, gap_m };
    TRIED.map(|alpha| PlateSpec { air: Some(with(alpha)), ..nominal.clone() }).into()
}

/// The coordinates of `nominal` that mean the plate of `tried` ([`in_tried_air`]) at its coordinates.
pub(crate) fn from_tried_air(nominal: &PlateSpec, tried: &PlateSpec, coordinates: &[f64]) -> Vec<f64> {
    let (Some(mounting), Some(of_tried)) = (mounting_of(nominal), mounting_of(tried)) else {
        return coordinates.to_vec();
    };
    let mut found = coordinates.to_vec();
    found[AIR] += (of_tried.coefficient().0 / mounting.coefficient().0).ln();
    found.insert(DISTANT_AIR, of_tried.distant() - mounting.distant());
    found
}

/// The loss factor that the fit starts from.
pub(crate) fn loss_of(nominal: &PlateSpec) -> f64 {
    nominal.loss_factor.max(1e-4)
}

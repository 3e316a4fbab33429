//! A plate: taper, material and edge, loss, drive end, and the span its boundary is dragged over.
//!
//! A user edits a [`PlateSpec`]. [`Plate`] is a validated specification, so the solvers need no checks of
//! their own.

use super::limits::{self, BAND_RATIO_MAX, WAVELENGTHS_MAX};
use crate::definition::air::AirLoad;
use crate::definition::drive::DriveEnd;
use crate::definition::error::{Consequence, Origin, PlateError};
use crate::definition::fields::check_ranges;
use crate::definition::film::{self, FilmEdge};
use crate::definition::log_width::LogWidth;
use crate::definition::model::Model;
use crate::definition::spec::PlateSpec;
use crate::definition::strip_table::StripTable;
use crate::definition::taper::{Taper, WidthLaw};
use crate::definition::thickness::Grading;
use crate::definition::turning_width::{TurningLaw, TurningWidth};
use crate::quantity::Range;
use crate::special::ramp::ramp;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A validated plate.
///
/// ```
/// let plate = slipline_plate::preset("membrane").unwrap();
/// let frequency_hz = plate.frequency_for_boundary_hz(0.16);
/// assert!((plate.turning_point_m(frequency_hz).unwrap() - 0.16).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    spec: PlateSpec,
    /// The half-width of the plate as it is cut.
    pub(crate) outline: WidthLaw,
    /// The half-width between the edges that hold the wave: the outline, and how far its edges give.
    pub(crate) edges: WidthLaw,
    /// The half-width over which the wave swings: that between the edges, or that of the membrane that swings as a film does.
    pub(crate) width: WidthLaw,
    /// The half-width that decides where a wave turns.
    pub(crate) turning: TurningLaw,
    /// How the thickness changes, where it does.
    pub(super) grading: Option<Arc<Grading>>,
    /// b of the term b W''/(2 W) in k^2.
    bend_weight: f64,
    /// What the air adds to its inertia, where it carries any.
    pub(super) air_load: Option<AirLoad>,
    /// The law of the first width mode between clamped edges, with the plate's loss in the middle of its span; `None` for
    /// other edges.
    pub(super) strip: Option<Arc<StripTable>>,
}

impl Plate {
    /// Validates a specification. Besides the range of each field it checks the band of the span: its frequencies must
    /// be 0.5 Hz to 10 MHz and at most a factor of 64 apart, at most 60 wavelengths may lie before the span's end, and
    /// the drive end's own frequency must enter the plate.
    ///
    /// # Errors
    /// [`PlateError`] names the first field that is out of range and the allowed range.
    pub fn new(spec: PlateSpec) -> Result<Self, PlateError> {
        Self::sharing(spec, None)
    }

    /// As [`Plate::new`]; takes the law between clamped edges from a plate `like` it, if that has the same loss.
    pub(super) fn like(spec: PlateSpec, like: Option<&Self>) -> Result<Self, PlateError> {
        Self::sharing(spec, like.and_then(|plate| plate.strip.clone()))
    }

    /// As [`Plate::new`]; `strip` is the law between clamped edges of a plate with the same loss.
    fn sharing(spec: PlateSpec, strip: Option<Arc<StripTable>>) -> Result<Self, PlateError> {
        let plate = Self::unbanded(spec, strip)?;
        plate.validate_band()?;
        Ok(plate)
    }

    /// As [`Plate::new`], but the band of the span and the drive end's frequency are not checked.
    pub(super) fn with_any_band(spec: PlateSpec) -> Result<Self, PlateError> {
        Self::unbanded(spec, None)
    }

    fn unbanded(mut spec: PlateSpec, strip: Option<Arc<StripTable>>) -> Result<Self, PlateError> {
        limits::NAME.check_text("name", &spec.name)?;
        limits::DESCRIPTION.check_text("description", &spec.description)?;
        if let Some(actuator) = &spec.actuator {
            actuator.validate()?;
        }
        check_ranges(&mut spec)?;
        spec.taper.validate(spec.length_m)?;
        spec.model.validate()?;
        if let Some(air) = &spec.air {
            air.validate(&spec.model)?;
        }
        if let Some(thickness) = &spec.thickness {
            thickness.validate(&spec.model, spec.air.as_ref(), &spec.drive_end, spec.length_m)?;
        }
        spec.check_loss_exponent()?;
        spec.drive_end.validate(&spec.model)?;
        if let Some(harmonics) = &spec.harmonics {
            harmonics.validate()?;
        }
        if let Some(correction) = spec.calibration.as_ref().and_then(|it| it.correction.as_ref()) {
            correction.validate("calibration.points")?;
        }
        limits::span_start(spec.length_m).check("span_start_m", spec.span_start_m)?;
        let shortest = spec.span_start_m + 1e-3 * spec.length_m;
        Range::new(shortest, spec.length_m, "m").check("span_end_m", spec.span_end_m)?;

        let outline = WidthLaw::new(&spec.taper, spec.length_m);
        let edges = edges(&outline, &spec)?;
        let width = swinging(&edges, &spec);
        let turning = TurningLaw::new(&width, spec.length_m, spec.turning_width);
        let bend_weight = spec.turning_width.bend_weight(&spec.model);
        let air_load = AirLoad::of(spec.air.as_ref(), &spec.model);
        let mut plate =
            Self { spec, outline, edges, width, turning, grading: None, bend_weight, air_load, strip: None };
        plate.grading = plate.graded()?;
        plate.set_strip(strip);
        Ok(plate)
    }

    /// The grading of its thickness and its present turning width.
    fn graded(&self) -> Result<Option<Arc<Grading>>, PlateError> {
        let (Some(thickness), Some(bending)) = (&self.spec.thickness, self.spec.model.bending()) else {
            return Ok(None);
        };
        let (length_m, reach_m) = (self.spec.length_m, self.edges.reach_m());
        let grading = Grading::new(thickness, bending.thickness_m, length_m, &self.turning, reach_m)?;
        Ok(Some(Arc::new(grading)))
    }

    /// Gives a plate between clamped edges their law; `strip` if that has the plate's loss.
    fn set_strip(&mut self, strip: Option<Arc<StripTable>>) {
        let Model::BendingClamped(_) = self.spec.model else { return };
        let (low_hz, high_hz) = self.band_hz();
        let loss = self.wave_loss_at((low_hz * high_hz).sqrt());
        let strip = strip.filter(|strip| strip.loss() == loss);
        self.strip = Some(strip.unwrap_or_else(|| Arc::new(StripTable::new(loss))));
    }

    /// The same plate without air around it.
    #[must_use]
    pub fn in_vacuum(&self) -> Self {
        let mut plate = self.clone();
        plate.spec.air = None;
        if plate.air_load.take().is_some() {
            let strip = plate.strip.take();
            plate.set_strip(strip);
        }
        plate
    }

    /// The same plate without the stiffness of its film: the ideal membrane.
    #[must_use]
    pub fn without_film(&self) -> Self {
        let mut plate = self.clone();
        if let Model::Membrane { film, .. } = &mut plate.spec.model
            && film.take().is_some()
        {
            plate.width.clone_from(&plate.edges);
            plate.set_turning_width(plate.spec.turning_width);
        }
        plate
    }

    /// The same plate with a drive without harmonics.
    #[must_use]
    pub fn without_harmonics(&self) -> Self {
        let mut plate = self.clone();
        plate.spec.harmonics = None;
        plate
    }

    /// The same plate with the thickness of its driven end everywhere.
    #[must_use]
    pub fn with_uniform_thickness(&self) -> Self {
        let mut plate = self.clone();
        (plate.spec.thickness, plate.grading) = (None, None);
        plate
    }

    pub(super) fn set_turning_width(&mut self, turning_width: TurningWidth) {
        let spec = &mut self.spec;
        spec.turning_width = turning_width;
        self.turning = TurningLaw::new(&self.width, spec.length_m, turning_width);
        self.bend_weight = turning_width.bend_weight(&spec.model);
        // The arc falls where the plate narrows, whichever way it is measured: what was valid stays so.
        if let Ok(grading) = self.graded() {
            self.grading = grading;
        }
        if self.air_load.is_some() {
            let strip = self.strip.take();
            self.set_strip(strip);
        }
    }

    fn validate_band(&self) -> Result<(), PlateError> {
        let (low, high) = self.band_hz();
        let allowed = limits::FREQUENCY;
        let at_start = |it| Err(PlateError::unfit("span_start_m", self.spec.span_start_m, it));
        let at_end = |it| Err(PlateError::unfit("span_end_m", self.spec.span_end_m, it));
        if low.is_nan() || low < allowed.low {
            return at_start(Consequence::Frequency(low));
        }
        if high.is_nan() || high > allowed.high {
            return at_end(Consequence::Frequency(high));
        }
        if high > low * BAND_RATIO_MAX {
            return at_start(Consequence::BandRatio(low, high));
        }
        if let (Some(film), Some(square)) = (self.spec.model.film(), self.spec.model.film_square()) {
            film.check("model.thickness_m", square.sqrt(), self.half_width_m(self.spec.span_end_m))?;
        }
        let wavelengths = self.width_mode(1).phase_to(self.spec.span_end_m, high) / TAU;
        if wavelengths.is_nan() || wavelengths > WAVELENGTHS_MAX {
            return at_end(Consequence::Wavelengths(wavelengths));
        }
        if let Some(frequency_hz) = self.spec.drive_end.at_frequency_hz() {
            let entering = Range { low: self.cut_off_hz() * 1.0001, ..allowed };
            entering.check_from(Origin::Entry, "drive.at_frequency_hz", frequency_hz)?;
        }
        Ok(())
    }

    /// The specification this plate was made from.
    pub fn spec(&self) -> &PlateSpec {
        &self.spec
    }

    /// What lies between the DAC and the driven end at `frequency_hz`, over the displacement at full scale: the actuator,
    /// and what a calibration found to be different from this plate's own drive.
    pub fn drive_response(&self, frequency_hz: f64) -> Complex64 {
        let actuator = self.spec.actuator.as_ref().map(|actuator| actuator.response(frequency_hz));
        let correction = self.spec.calibration.as_ref().and_then(|it| it.correction.as_ref());
        let correction = correction.map(|curve| curve.response(frequency_hz));
        actuator.unwrap_or(Complex64::ONE) * correction.unwrap_or(Complex64::ONE)
    }

    /// Short name.
    pub fn name(&self) -> &str {
        &self.spec.name
    }

    /// Length, metres.
    pub fn length_m(&self) -> f64 {
        self.spec.length_m
    }

    /// Half-width at `x` metres from the driven end, metres, with which every law computes: that of the cut and how far the edges
    /// give. Beyond the plate's end the taper is continued.
    pub fn half_width_m(&self, x: f64) -> f64 {
        self.edges.at(x).value.exp()
    }

    /// Half-width W of the plate as it is cut, at `x` metres from the driven end, metres: what calipers measure and a cut file draws.
    pub fn cut_half_width_m(&self, x: f64) -> f64 {
        self.outline.at(x).value.exp()
    }

    /// Slope of [`Plate::half_width_m`] over it at `x`, 1/m; negative because the plate narrows.
    pub fn narrowing_per_m(&self, x: f64) -> f64 {
        self.edges.at(x).slope
    }

    /// The half-width over which the wave swings at `x`, metres: W, less in a film.
    pub(crate) fn swinging_half_width_m(&self, x: f64) -> f64 {
        self.width.at(x).value.exp()
    }

    /// The strip of the film as wide as the plate at `x`; `None` for a plate without a film's stiffness.
    pub(crate) fn film_edge(&self, x: f64) -> Option<FilmEdge> {
        let square = self.spec.model.film_square()?;
        Some(FilmEdge::new(self.half_width_m(x) / square.sqrt()))
    }

    /// What edges that bend add to k^2 at `x`, see [`TurningWidth`]: b W''/(2 W), 1/m^2. `weight` is [`Plate::weight_at`] at `x`,
    /// which is W where the thickness is the same everywhere.
    pub(crate) fn edge_bend(&self, x: f64, weight: LogWidth) -> f64 {
        let width = if self.grading.is_some() { self.width.at(x) } else { weight };
        0.5 * self.bend_weight * width.bend()
    }

    /// eta of the amplitude equation, K^2 -> K^2 (1 + j eta), in the middle of the band. For membranes and SH waves it is the loss
    /// factor. In bending it is half of that, because K^2 is proportional to 1/sqrt(E).
    pub fn wave_loss(&self) -> f64 {
        self.share_of_loss() * self.spec.loss_factor
    }

    /// Turning points at the start and at the end of the span, metres.
    pub fn span_m(&self) -> (f64, f64) {
        (self.spec.span_start_m, self.spec.span_end_m)
    }

    /// `count` turning points at equal distances over the span, both ends included, metres.
    pub(crate) fn over_span_m(&self, count: usize) -> impl Iterator<Item = f64> + use<> {
        ramp(self.spec.span_start_m, self.spec.span_end_m, count)
    }

    /// Cut-off frequency at the wide end, Hz: its wave turns at x = 0, and lower frequencies cannot enter the plate.
    pub fn cut_off_hz(&self) -> f64 {
        self.width_mode(1).cut_off_hz(0.0)
    }

    /// The frequency whose turning point is `x`, Hz.
    pub fn frequency_for_boundary_hz(&self, x: f64) -> f64 {
        self.width_mode(1).cut_off_hz(x)
    }

    /// Frequencies whose turning points are the start and the end of the span, Hz.
    pub fn band_hz(&self) -> (f64, f64) {
        (
            self.frequency_for_boundary_hz(self.spec.span_start_m),
            self.frequency_for_boundary_hz(self.spec.span_end_m),
        )
    }

    /// The same plate with a phase speed `factor` times as high (0.5 to 2) at equal frequency; of the wave without air, where
    /// the plate has any.
    ///
    /// It scales the membrane's wave speed by `factor`, its tension and the shear modulus by its square, and Young's modulus by its
    /// fourth power. The last is exact for a thin plate and approximate where `thick_plate` is set. A film keeps its own stiffness.
    ///
    /// # Errors
    /// [`PlateError`] when `factor`, the material or the plate's band leaves its allowed range.
    pub fn with_wave_speed(&self, factor: f64) -> Result<Self, PlateError> {
        Range::new(0.5, 2.0, "").check("wave speed factor", factor)?;
        let mut spec = self.spec.clone();
        spec.model.speed_up(factor);
        Self::sharing(spec, self.strip.clone())
    }

    /// The same plate with a loss factor `factor` times as high, but at most the highest that a plate may have.
    pub(crate) fn with_loss(&self, factor: f64) -> Result<Self, PlateError> {
        let mut spec = self.spec.clone();
        spec.loss_factor = (factor * spec.loss_factor).min(limits::LOSS_FACTOR.high);
        Self::new(spec)
    }

    /// The same plate with another taper, whose edges give by `more_m` metres more.
    ///
    /// # Errors
    /// As [`Plate::new`].
    pub(crate) fn with_edges(&self, taper: Taper, more_m: f64) -> Result<Self, PlateError> {
        let mut spec = PlateSpec { taper, ..self.spec.clone() };
        if more_m != 0.0 {
            spec.edge_give_m = Some(spec.edge_give_m.unwrap_or(0.0) + more_m);
        }
        Self::sharing(spec, self.strip.clone())
    }

    /// The same plate with another end, which must be valid for it.
    pub(crate) fn with_drive_end(&self, drive_end: DriveEnd) -> Self {
        let mut plate = self.clone();
        plate.spec.drive_end = drive_end;
        plate
    }
}

/// The half-width between the edges of `outline`, which give as the specification says.
///
/// # Errors
/// They give so far inward that no plate is left at its end.
fn edges(outline: &WidthLaw, spec: &PlateSpec) -> Result<WidthLaw, PlateError> {
    let share = tension_share(spec)?;
    let scaled = |edges: WidthLaw| share.map_or(edges.clone(), |share| edges.scaled(share));
    let Some(give_m) = spec.edge_give_m else { return Ok(scaled(outline.clone())) };
    let end_m = outline.at(spec.length_m).value.exp();
    let left = Range { low: limits::HALF_WIDTH.low - end_m, ..limits::EDGE_GIVE };
    if give_m < left.low {
        return Err(left.refuse("edge_give_m", give_m, Some(Origin::EndHalfWidth(end_m + give_m))));
    }
    let clamped = spec.model.is_clamped();
    Ok(scaled(outline.giving(spec.length_m, give_m, clamped)))
}

/// The half-width of one tension over that of two, 1/sqrt(Tz/Tx); `None` of one tension.
fn tension_share(spec: &PlateSpec) -> Result<Option<f64>, PlateError> {
    let stated =
        [("tension_ratio", spec.tension_ratio), ("tension_ratio_tolerance", spec.tension_ratio_tolerance)];
    for (field, value) in stated {
        if value.is_some() && !matches!(spec.model, Model::Membrane { .. }) {
            return Err(PlateError::unexpected(field, "only a membrane has a tension"));
        }
    }
    Ok(spec.tension_ratio.map(|ratio| ratio.sqrt().recip()))
}

/// The half-width over which a wave swings between these edges.
fn swinging(edges: &WidthLaw, spec: &PlateSpec) -> WidthLaw {
    match spec.model.film_square() {
        Some(square) => film::membrane_width(edges, spec.length_m, square.sqrt()),
        None => edges.clone(),
    }
}

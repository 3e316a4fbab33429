//! The description of a plate as numbers, before validation.

use super::limits;
use crate::definition::actuator::Actuator;
use crate::definition::air::Air;
use crate::definition::calibration::Calibration;
use crate::definition::drive::DriveEnd;
use crate::definition::frame::Frame;
use crate::definition::harmonics::Harmonics;
use crate::definition::model::Model;
use crate::definition::taper::Taper;
use crate::definition::thickness::Thickness;
use crate::definition::turning_width::TurningWidth;

/// The description of a plate, before validation. Lengths in metres, frequencies in hertz.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateSpec {
    /// Short name, 1 to 80 characters.
    pub name: String,
    /// One line that says what the plate is, at most 400 characters.
    pub description: String,
    /// How the half-width narrows.
    pub taper: Taper,
    /// How far the edges give, delta, metres (-0.002 to 0.005): every law takes the half-width W + delta, with one delta for the
    /// whole plate, and the taper states W as it is cut. An edge clamped by a rotational stiffness of D/(c h) per length has
    /// delta = c h: between clamped edges laws take the half-width of the strip that cuts off like that one, which is W + delta to
    /// the first order. `None` as 0.
    pub edge_give_m: Option<f64>,
    /// Half of the 95 % interval of `edge_give_m`, metres (0 to 0.005). `None` if it is unknown.
    pub edge_give_tolerance_m: Option<f64>,
    /// Tension across over tension along a membrane, Tz/Tx (0.5 to 2); `None` as 1. Stretched by its root the plate is that of one
    /// tension, so every law takes the half-width (W + delta)/sqrt(Tz/Tx).
    pub tension_ratio: Option<f64>,
    /// Half of the 95 % interval of that ratio (0 to 0.5). `None` as 0: a calibration holds it.
    pub tension_ratio_tolerance: Option<f64>,
    /// Which width decides where a wave turns.
    pub turning_width: TurningWidth,
    /// Length L from the driven end to the narrow end, metres (0.005 to 10).
    pub length_m: f64,
    /// Material, edge and wave.
    pub model: Model,
    /// How the thickness of a plate in bending changes along it, from that of the model on; `None` if it is the same everywhere.
    pub thickness: Option<Thickness>,
    /// The air that swings with the plate; `None` as in a vacuum, or if the plate's own numbers hold it.
    pub air: Option<Air>,
    /// The frame that holds the plate; `None` if it is not stated.
    pub frame: Option<Frame>,
    /// Loss factor of the material's modulus or of the tension (0 to 0.5); see [`wave_loss`](crate::Plate::wave_loss).
    pub loss_factor: f64,
    /// Exponent p of its course over the frequency (-2 to 2): `loss_factor` is that of the geometric middle of the band, and at f it
    /// is (f over that)^p times as large, at most 0.5. `None` as 0. Not of a plate between clamped edges, whose law has one loss.
    pub loss_exponent: Option<f64>,
    /// Half of the 95 % interval of that exponent (0 to 2). `None` as 0: a calibration holds it.
    pub loss_exponent_tolerance: Option<f64>,
    /// Relative uncertainty of the wave speed (0 to 0.05). The drive table is levelled for all wave speeds within
    /// this tolerance, not only for the nominal one. Useful with a matched drive end, whose ripple is small.
    pub wave_speed_tolerance: f64,
    /// Relative uncertainty t of the loss factor (0 to 4): the true one lies between `loss_factor`/(1 + t) and
    /// (1 + t) `loss_factor`, so 1 is "halved or doubled". `None` if that is unknown.
    pub loss_tolerance: Option<f64>,
    /// What is held at x = 0.
    pub drive_end: DriveEnd,
    /// The actuator's response, if it matters.
    pub actuator: Option<Actuator>,
    /// The harmonics that the drive adds to a tone; `None` if they are not known. They change neither table nor response.
    pub harmonics: Option<Harmonics>,
    /// Bandwidth of the amplifier, a low-pass of second order, Hz (10 to 1e8); `None` if it is not known. It changes neither table nor
    /// response: it bounds the error of a measured current.
    pub amplifier_bandwidth_hz: Option<f64>,
    /// Displacement of the drive at DAC full scale, metres (1e-9 to 0.1). Illustrative until you have measured it.
    pub full_scale_m: f64,
    /// Turning point nearest to the drive that a user can choose, metres (0.001 L to 0.999 L).
    pub span_start_m: f64,
    /// Turning point farthest from the drive that a user can choose, metres (at least 0.001 L beyond `span_start_m`,
    /// at most L).
    pub span_end_m: f64,
    /// What a calibration found of the drive and of the widths; `None` for an uncalibrated plate.
    pub calibration: Option<Calibration>,
}

impl PlateSpec {
    /// Nothing stated: no plate has these numbers.
    pub(crate) fn blank() -> Self {
        Self {
            name: String::new(),
            description: String::new(),
            taper: Taper::Sampled { points: Vec::new() },
            edge_give_m: None,
            edge_give_tolerance_m: None,
            tension_ratio: None,
            tension_ratio_tolerance: None,
            turning_width: TurningWidth::default(),
            length_m: 0.0,
            model: Model::Membrane { wave_speed_m_per_s: 0.0, tension_n_per_m: None, film: None },
            thickness: None,
            air: None,
            frame: None,
            loss_factor: 0.0,
            wave_speed_tolerance: 0.0,
            loss_tolerance: None,
            loss_exponent: None,
            loss_exponent_tolerance: None,
            drive_end: DriveEnd::Displacement,
            actuator: None,
            harmonics: None,
            amplifier_bandwidth_hz: None,
            full_scale_m: 0.0,
            span_start_m: 0.0,
            span_end_m: 0.0,
            calibration: None,
        }
    }

    /// Appends `mark` to the name, of which so much stays that both are within [`limits::NAME`]; a name that ends with it already
    /// stays as it is.
    pub fn mark_name(&mut self, mark: &str) {
        if !self.name.ends_with(mark) {
            let room = limits::NAME.most.saturating_sub(mark.chars().count());
            self.name = self.name.chars().take(room).chain(mark.chars()).collect();
        }
    }
}

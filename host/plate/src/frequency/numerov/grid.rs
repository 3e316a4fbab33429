//! The amplitude equation of one plate on a grid, and what it is at one frequency.

use super::breaks;
use crate::definition::air_along::AirAlong;
use crate::definition::log_width::LogWidth;
use crate::definition::plate::Plate;
use crate::definition::strip_table::StripTable;
use crate::frequency::axial::lossy_axial_squared;
use crate::frequency::equation::Equation;
use crate::frequency::far_air::FarAir;
use crate::frequency::strip_grid::StripGrid;
use num_complex::Complex64;
use std::ops::Range;
use std::sync::Arc;

/// Exponents of decay over which the taper is continued beyond the plate's end, so that the condition at the end of the
/// grid has no effect.
const BEYOND_EXPONENTS: f64 = 14.0;

/// The frequency-independent part of the problem: the first width mode of one plate, one equation, one grid.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    pub(super) step_m: f64,
    /// Points on the plate (from 0 to its end).
    pub(super) on_plate: usize,
    /// a (q/s)^2 + (sqrt W)''/sqrt W less the term of bent edges, at the grid points -1, 0, 1, ..; point i has the index
    /// i + 1. It continues beyond the plate's end. With the strip's law only the last two.
    pub(super) barrier: Vec<f64>,
    /// Whether the barrier rises from point to point, as on most plates.
    is_rising: bool,
    /// a K^2 at each index of the barrier over that at the driven end: h0/h. Empty where the thickness is the same everywhere.
    pub(super) local: Vec<f64>,
    /// 1/sqrt(W/W0) on the plate, with S for W where the thickness changes (1 for the paper's equation).
    pub(super) scale: Vec<f64>,
    /// (sqrt W)'/sqrt W at 0, or that of S (0 for the paper's equation).
    root_slope: f64,
    /// The law of the clamped strip, where it takes the place of a K^2 (1 + j eta) - a (q/W)^2.
    pub(super) strip: Option<StripGrid>,
    /// (q/s)^2 of a membrane in air, whose K changes along the plate; the barrier is without it.
    pub(super) in_air: Option<Vec<f64>>,
    /// What the law of the air along it leaves out.
    pub(super) far_air: Option<FarAir>,
}

/// A grid's equation at one frequency.
#[derive(Clone, Copy)]
pub(super) enum At<'g> {
    /// a K^2 (1 + j eta), from which the barrier is taken.
    Separable(Complex64),
    /// The same at the driven end, and over the barrier what it is elsewhere over that.
    Graded(Complex64, &'g [f64]),
    /// The law of the strip, and ln K^2 without loss.
    Strip(&'g StripGrid, f64),
    /// (q/s)^2 of a membrane, its air, and eta of its stiffness.
    Air(&'g [f64], AirAlong, f64),
}

impl Grid {
    pub(crate) fn new(plate: &Plate, equation: Equation, points: usize, refinement: usize) -> Self {
        let law = plate.width_mode(1).strip.filter(|_| equation == Equation::Corrected);
        Self::with_law(plate, equation, points, refinement, law)
    }

    /// As [`Grid::new`] with `Equation::Corrected`, but between clamped edges with the tangent of the strip's law at the
    /// cut-off, to which a figure compares that law.
    pub(crate) fn tangent(plate: &Plate, points: usize, refinement: usize) -> Self {
        Self::with_law(plate, Equation::Corrected, points, refinement, None)
    }

    fn with_law(
        plate: &Plate,
        equation: Equation,
        points: usize,
        refinement: usize,
        law: Option<&Arc<StripTable>>,
    ) -> Self {
        #[cfg(test)]
        super::work::count(|work| work.grids += 1);
        let width_mode = plate.width_mode(1);
        let is_in_air = equation == Equation::Corrected && width_mode.air(plate.band_hz().1).is_some();
        let on_plate = (points - 1) * refinement + 1;
        let step_m = plate.length_m() / (on_plate - 1) as f64;
        let with_width = |has_width: bool| {
            move |x: f64, weight: LogWidth| match equation {
                Equation::Corrected => {
                    let across = if has_width { width_mode.width_term(x) } else { 0.0 };
                    across + weight.root_curvature() - plate.edge_bend(x, weight)
                }
                Equation::Paper => width_mode.width_term(x),
            }
        };
        let barrier_at = with_width(law.is_none() && !is_in_air);
        let mut barrier: Vec<f64> = Vec::with_capacity(on_plate + 64);
        barrier.push(barrier_at(-step_m, plate.weight_at(-step_m)));
        let weights: Vec<LogWidth> = (0..on_plate).map(|i| plate.weight_at(i as f64 * step_m)).collect();
        barrier.extend(weights.iter().enumerate().map(|(i, weight)| barrier_at(i as f64 * step_m, *weight)));
        // The wave that turns at the plate's end decays slowest beyond it.
        let end_term = width_mode.width_term(plate.length_m());
        let end_hz = width_mode.cut_off_hz(plate.length_m());
        let (mut exponents, mut i) = (0.0, on_plate);
        while exponents < BEYOND_EXPONENTS && barrier.len() < 4 * on_plate + 64 {
            let x = i as f64 * step_m;
            if x > 0.98 * plate.width.reach_m() {
                break;
            }
            let decay = match law {
                Some(_) => -width_mode.wavenumber_squared(x, end_hz),
                None if plate.is_graded() => -width_mode.wavenumber_squared(x, end_hz),
                None => width_mode.width_term(x) - end_term,
            };
            exponents += decay.max(0.0).sqrt() * step_m;
            barrier.push(barrier_at(x, plate.weight_at(x)));
            i += 1;
        }
        let (scale, root_slope) = match equation {
            Equation::Corrected => {
                let start = weights[0];
                let scale = |weight: &LogWidth| (0.5 * (start.value - weight.value)).exp();
                (weights.iter().map(scale).collect(), 0.5 * start.slope)
            }
            Equation::Paper => (vec![1.0; on_plate], 0.0),
        };
        let is_rising = barrier.is_sorted();
        let whole_at = with_width(law.is_none());
        breaks::mend(&mut barrier, step_m, plate, |x| whole_at(x, plate.weight_at(x)));
        let local = if plate.is_graded() {
            (0..barrier.len()).map(|index| width_mode.local((index as f64 - 1.0) * step_m)).collect()
        } else {
            Vec::new()
        };
        let strip = law.map(|law| StripGrid::new(&width_mode, law, step_m, barrier.len()));
        let places = || (0..barrier.len()).map(|index| (index as f64 - 1.0) * step_m);
        let in_air: Option<Vec<f64>> =
            is_in_air.then(|| places().map(|x| width_mode.width_term(x)).collect());
        let far_air = in_air.as_ref().and_then(|_| FarAir::of(plate, on_plate));
        Self { step_m, on_plate, barrier, is_rising, local, scale, root_slope, strip, in_air, far_air }
    }

    pub(super) fn at(&self, plate: &Plate, frequency_hz: f64) -> At<'_> {
        if let Some(strip) = &self.strip {
            return At::Strip(strip, plate.wavenumber_squared(frequency_hz).ln());
        }
        let width_mode = plate.width_mode(1);
        let axial = || lossy_axial_squared(&width_mode, frequency_hz);
        match (&self.in_air, width_mode.air(frequency_hz)) {
            (Some(width_square), Some(air)) => {
                At::Air(width_square, air, plate.stiffness_loss_at(frequency_hz))
            }
            _ if self.local.is_empty() => At::Separable(axial()),
            _ => At::Graded(axial(), &self.local),
        }
    }

    /// Q at the index `i` of the barrier.
    pub(super) fn q(&self, at: At<'_>, i: usize) -> Complex64 {
        match at {
            At::Separable(axial) => axial - self.barrier[i],
            At::Graded(axial, local) => axial * local[i] - self.barrier[i],
            At::Strip(strip, log_wavenumber) => strip.wavenumber_squared(i, log_wavenumber) - self.barrier[i],
            At::Air(width_square, air, loss) => {
                let here = air.at(width_square[i]);
                let lossy = Complex64::new(1.0, loss * here.loss_share);
                here.wavenumber_squared * lossy - width_square[i] - self.barrier[i]
            }
        }
    }

    /// The first index at which Q may be negative.
    pub(super) fn turn(&self, at: At<'_>) -> usize {
        match at {
            At::Separable(axial) if self.is_rising => {
                self.barrier.partition_point(|&barrier| barrier <= axial.re)
            }
            At::Separable(_) | At::Graded(..) => 1,
            At::Strip(strip, log_wavenumber) => strip.turn(log_wavenumber),
            At::Air(width_square, air, _) => width_square.partition_point(|&square| square <= air.turning),
        }
    }

    /// (sqrt w)'/sqrt w at 0, 1/m, with w = W, or W Omega by the strip's law.
    pub(super) fn root_slope(&self, at: At<'_>) -> Complex64 {
        match at {
            At::Separable(_) | At::Graded(..) | At::Air(..) => Complex64::from(self.root_slope),
            At::Strip(strip, log_wavenumber) => self.root_slope + strip.weight_slope(log_wavenumber),
        }
    }
}

impl At<'_> {
    /// Multiplies a `part` of a field g/sqrt W at each `every`-th point on the plate by what the power weight of the strip's law adds,
    /// 1 at 0.
    pub(super) fn weigh(self, grid: &Grid, field: &mut [Complex64], every: usize, part: Range<usize>) {
        match self {
            At::Separable(_) | At::Graded(..) => {}
            At::Strip(strip, log_wavenumber) => strip.weigh(log_wavenumber, field, every, part),
            At::Air(width_square, air, _) => {
                let squares = width_square[1 + part.start * every..].iter().step_by(every);
                let places = part.clone().map(|i| (i * every) as f64 * grid.step_m);
                for ((f, square), x) in field[part].iter_mut().zip(squares).zip(places) {
                    *f /= air.weight_from_end(*square, x).sqrt();
                }
            }
        }
    }
}

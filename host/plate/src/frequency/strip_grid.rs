//! The law of the clamped strip on a grid along the plate.

use crate::definition::clamped_strip::CUT_OFF;
use crate::definition::strip_table::StripTable;
use crate::definition::width_mode::WidthMode;
use num_complex::Complex64;
use std::ops::Range;
use std::sync::Arc;

/// Inputs of the law at each point of a grid; point -1 has the index 0.
#[derive(Debug, Clone)]
pub(crate) struct StripGrid {
    pub(crate) law: Arc<StripTable>,
    /// ln s^2 with the turning half-width s in metres.
    pub(crate) log_square: Vec<f64>,
    /// 1/s^2, 1/m^2.
    inverse_square: Vec<f64>,
    /// d ln s/dx at 0, 1/m.
    narrowing: f64,
}

/// Arrays for a sweep with steps of h.
pub(crate) struct Scaled {
    /// h^2/12 over W^2.
    pub(crate) inverse_square: Vec<f64>,
    /// 1 less h^2/12 times the barrier.
    pub(crate) rest: Vec<f64>,
}

impl StripGrid {
    pub(crate) fn new(width_mode: &WidthMode<'_>, law: &Arc<StripTable>, step_m: f64, points: usize) -> Self {
        let places = (0..points).map(|index| (index as f64 - 1.0) * step_m);
        let log_square: Vec<f64> = places.map(|x| width_mode.log_square(x)).collect();
        let inverse_square = log_square.iter().map(|log| (-log).exp()).collect();
        let narrowing = width_mode.plate.turning.at(0.0).slope;
        Self { law: Arc::clone(law), log_square, inverse_square, narrowing }
    }

    /// The arrays of a sweep, from h^2/12 (`h2`) and the barrier times that.
    pub(crate) fn scaled(&self, barrier: &[f64], h2: f64) -> Scaled {
        Scaled {
            inverse_square: self.inverse_square.iter().map(|inverse| inverse * h2).collect(),
            rest: barrier.iter().map(|barrier| 1.0 - barrier).collect(),
        }
    }

    /// k^2 = s/W^2 with loss at index `i`, 1/m^2; `log_wavenumber` is ln K^2.
    pub(crate) fn wavenumber_squared(&self, i: usize, log_wavenumber: f64) -> Complex64 {
        self.law.wavenumber_squared(self.log_square[i] + log_wavenumber) * self.inverse_square[i]
    }

    /// The first index beyond the turning point. (sqrt W)''/sqrt W may make Q negative slightly before it, which only
    /// lengthens the computed tail.
    pub(crate) fn turn(&self, log_wavenumber: f64) -> usize {
        let narrowest = CUT_OFF.ln() - log_wavenumber;
        self.log_square.partition_point(|&log| log >= narrowest)
    }

    /// (sqrt Omega)'/sqrt Omega at 0, 1/m.
    pub(crate) fn weight_slope(&self, log_wavenumber: f64) -> Complex64 {
        2.0 * self.narrowing * self.law.weight_rise(self.log_square[1] + log_wavenumber)
    }

    /// Multiplies a `part` of a field at every `every`-th point from 0 by (Omega at 0/Omega)^(1/2).
    pub(crate) fn weigh(
        &self,
        log_wavenumber: f64,
        field: &mut [Complex64],
        every: usize,
        part: Range<usize>,
    ) {
        let at_drive = self.law.spread(self.log_square[1] + log_wavenumber).inv();
        let logs = self.log_square[1 + part.start * every..].iter().step_by(every);
        for (f, log) in field[part].iter_mut().zip(logs) {
            *f *= self.law.spread(log + log_wavenumber) * at_drive;
        }
    }
}

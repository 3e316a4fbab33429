//! What the waves of eight frequencies meet along the plate: Q of the amplitude equation g'' + Q g = 0, as a sweep takes it.
//!
//! Q is a frequency less a barrier where the two separate, and that with the local thickness; the law of the clamped strip and
//! that of the air along a membrane do not separate.

use crate::definition::air_along::AirAlong;
use crate::definition::strip_table::StripTable;

/// Frequencies that are computed together.
pub(crate) const LANES: usize = 8;

pub(super) type Lanes = [f64; LANES];

/// What the wave of each frequency meets along the plate.
pub(crate) trait Medium {
    /// Real and imaginary part of 1 + h^2 Q/12 at a grid point for each frequency.
    fn factor(&self, point: usize) -> (Lanes, Lanes);
}

/// Q = a K^2 (1 + j eta) - barrier: the loss does not depend on x, and the barrier not on the frequency.
pub(crate) struct Separable<'a> {
    /// h^2/12 times the barrier at each grid point, from point -1 on.
    pub(crate) barrier: &'a [f64],
    /// 1 + h^2/12 times a K^2 (1 + j eta) of each frequency.
    pub(crate) axial_re: Lanes,
    pub(crate) axial_im: Lanes,
}

impl Medium for Separable<'_> {
    #[inline(always)]
    fn factor(&self, point: usize) -> (Lanes, Lanes) {
        let barrier = self.barrier[point];
        let mut re = self.axial_re;
        for re in &mut re {
            *re -= barrier;
        }
        (re, self.axial_im)
    }
}

/// Q = a K^2 (1 + j eta) h0/h - barrier: the thickness changes along the plate.
pub(crate) struct Graded<'a> {
    /// h^2/12 times the barrier at each grid point, from point -1 on, and times h0/h.
    pub(crate) barrier: &'a [f64],
    pub(crate) local: &'a [f64],
    /// a K^2 (1 + j eta) at the driven end of each frequency.
    pub(crate) axial_re: Lanes,
    pub(crate) axial_im: Lanes,
}

impl Medium for Graded<'_> {
    #[inline(always)]
    fn factor(&self, point: usize) -> (Lanes, Lanes) {
        let (barrier, local) = (self.barrier[point], self.local[point]);
        (self.axial_re.map(|re| 1.0 + local * re - barrier), self.axial_im.map(|im| local * im))
    }
}

/// Q = s/W^2 - barrier with s by the law of the clamped strip.
pub(crate) struct Strip<'a> {
    pub(crate) law: &'a StripTable,
    /// ln W^2, h^2/12 over W^2, and 1 less h^2/12 times the barrier, at each grid point from point -1 on.
    pub(crate) log_square: &'a [f64],
    pub(crate) inverse_square: &'a [f64],
    pub(crate) rest: &'a [f64],
    /// ln K^2 of each frequency, without loss.
    pub(crate) log_wavenumber: Lanes,
}

impl Medium for Strip<'_> {
    #[inline(always)]
    fn factor(&self, point: usize) -> (Lanes, Lanes) {
        let (log_square, scale, rest) =
            (self.log_square[point], self.inverse_square[point], self.rest[point]);
        let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let s = self.law.wavenumber_squared(log_square + self.log_wavenumber[lane]);
            re[lane] = rest + scale * s.re;
            im[lane] = scale * s.im;
        }
        (re, im)
    }
}

/// Q = K(x)^2 (1 + j eta/Omega) - (q/s)^2 - barrier on a membrane in air.
pub(crate) struct InAir<'a> {
    /// (q/s)^2, and 1 less h^2/12 times the barrier, at each grid point from point -1 on.
    pub(crate) width_square: &'a [f64],
    pub(crate) rest: &'a [f64],
    /// h^2/12.
    pub(crate) scale: f64,
    /// eta of the plate's own stiffness.
    pub(crate) loss: Lanes,
    pub(crate) air: [AirAlong; LANES],
}

impl Medium for InAir<'_> {
    #[inline(always)]
    fn factor(&self, point: usize) -> (Lanes, Lanes) {
        let (across, rest) = (self.width_square[point], self.rest[point]);
        let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let here = self.air[lane].at(across);
            re[lane] = rest + self.scale * (here.wavenumber_squared - across);
            im[lane] = self.scale * here.wavenumber_squared * self.loss[lane] * here.loss_share;
        }
        (re, im)
    }
}

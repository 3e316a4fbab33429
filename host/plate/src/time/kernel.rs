//! The three inner loops of the time-domain plate, compiled for the widest vectors of the machine.
//!
//! They consist of products and sums in a fixed order, [`Fused`] where that is written; the filter's dot product adds
//! eight partial sums in a fixed order. So every processor computes the same bits.

use crate::fused::Fused;
use pulp::{Simd, WithSimd};

/// Number of positions whose sums are kept in registers together.
pub(crate) const TILE: usize = 16;

/// Dot products of a window with the real and the imaginary taps.
pub(crate) struct Filter<'a> {
    pub(crate) window: &'a [f64],
    pub(crate) tap_re: &'a [f64],
    pub(crate) tap_im: &'a [f64],
}

impl WithSimd for Filter<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> (f64, f64) {
        let (mut re, mut im) = ([0.0; 8], [0.0; 8]);
        let (window, window_rest) = self.window.as_chunks::<8>();
        let (tap_re, re_rest) = self.tap_re.as_chunks::<8>();
        let (tap_im, im_rest) = self.tap_im.as_chunks::<8>();
        for ((w, a), b) in window.iter().zip(tap_re).zip(tap_im) {
            for lane in 0..8 {
                re[lane] = w[lane].fused(a[lane], re[lane]);
                im[lane] = w[lane].fused(b[lane], im[lane]);
            }
        }
        let mut sum = (re.iter().sum::<f64>(), im.iter().sum::<f64>());
        for ((w, a), b) in window_rest.iter().zip(re_rest).zip(im_rest) {
            sum.0 += w * a;
            sum.1 += w * b;
        }
        sum
    }
}

/// State and step coefficients of all oscillators, as separate real and imaginary parts.
#[derive(Clone, Default)]
pub(crate) struct ModalStates {
    pub(crate) re: Vec<f64>,
    pub(crate) im: Vec<f64>,
    pub(crate) advance_re: Vec<f64>,
    pub(crate) advance_im: Vec<f64>,
    /// Factor of each of the six spline coefficients: one row per coefficient.
    pub(crate) inject_re: [Vec<f64>; 6],
    pub(crate) inject_im: [Vec<f64>; 6],
}

/// One step of all oscillators: z = advance z + sum over k of inject[k] coefficient[k].
pub(crate) struct Step<'a> {
    pub(crate) oscillators: &'a mut ModalStates,
    pub(crate) coefficient_re: [f64; 6],
    pub(crate) coefficient_im: [f64; 6],
}

impl WithSimd for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let (c_re, c_im) = (self.coefficient_re, self.coefficient_im);
        let count = self.oscillators.re.len();
        let (re, im) = (&mut self.oscillators.re[..count], &mut self.oscillators.im[..count]);
        let (a_re, a_im) = (&self.oscillators.advance_re[..count], &self.oscillators.advance_im[..count]);
        let b_re = self.oscillators.inject_re.each_ref().map(|row| &row[..count]);
        let b_im = self.oscillators.inject_im.each_ref().map(|row| &row[..count]);
        for i in 0..count {
            let mut next_re = re[i] * a_re[i] - im[i] * a_im[i];
            let mut next_im = re[i] * a_im[i] + im[i] * a_re[i];
            for k in 0..6 {
                next_re = b_re[k][i].fused(c_re[k], (-b_im[k][i]).fused(c_im[k], next_re));
                next_im = b_re[k][i].fused(c_im[k], b_im[k][i].fused(c_re[k], next_im));
            }
            re[i] = next_re;
            im[i] = next_im;
        }
    }
}

/// The field from the signals: field[x] = sum over signals of shape[signal][x] signal. `shape` is stored as [`tiles`]
/// returns it.
pub(crate) struct FieldSum<'a> {
    pub(crate) shape: &'a [f32],
    pub(crate) signal: &'a [[f32; 2]],
    pub(crate) re: &'a mut [f32],
    pub(crate) im: &'a mut [f32],
}

impl WithSimd for FieldSum<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let tiles = self.shape.chunks_exact(2 * TILE * self.signal.len().max(1));
        let (re, _) = self.re.as_chunks_mut::<TILE>();
        let (im, _) = self.im.as_chunks_mut::<TILE>();
        for ((tile, re), im) in tiles.zip(re).zip(im) {
            let (mut sum_re, mut sum_im) = ([0.0_f32; TILE], [0.0_f32; TILE]);
            let (rows, _) = tile.as_chunks::<TILE>();
            let (rows, _) = rows.as_chunks::<2>();
            for ([a, b], z) in rows.iter().zip(self.signal) {
                for lane in 0..TILE {
                    sum_re[lane] = a[lane].fused(z[0], (-b[lane]).fused(z[1], sum_re[lane]));
                    sum_im[lane] = a[lane].fused(z[1], b[lane].fused(z[0], sum_im[lane]));
                }
            }
            *re = sum_re;
            *im = sum_im;
        }
    }
}

/// Stores a complex matrix for [`FieldSum`]: for each tile of positions, for each signal, TILE real parts and then TILE
/// imaginary parts. The number of positions is rounded up to whole tiles; the additional ones are zero.
pub(crate) fn tiles(places: usize, signals: usize, value: impl Fn(usize, usize) -> [f32; 2]) -> Vec<f32> {
    let mut shape = Vec::with_capacity(places.div_ceil(TILE) * signals * 2 * TILE);
    for tile in 0..places.div_ceil(TILE) {
        for signal in 0..signals {
            for part in 0..2 {
                for lane in 0..TILE {
                    let place = tile * TILE + lane;
                    shape.push(if place < places { value(place, signal)[part] } else { 0.0 });
                }
            }
        }
    }
    shape
}

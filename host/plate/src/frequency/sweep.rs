//! Numerov's recursion for eight frequencies at once, in vector registers.
//!
//! 1/(1 + h^2 Q/12) takes one real division per position and frequency; the recursion itself consists of products and
//! sums. Q comes from a [`Medium`].

use super::medium::{LANES, Lanes, Medium};
use pulp::{Simd, WithSimd};

/// One sweep from the tail to the driven end.
pub(crate) struct Sweep<'a, M> {
    pub(crate) medium: M,
    /// Index at which the sweep of each frequency begins, and the ratio of its first two values, that of a decaying
    /// tail.
    pub(crate) start: [usize; LANES],
    pub(crate) ratio_re: Lanes,
    pub(crate) ratio_im: Lanes,
    /// g at each grid point; zero beyond the start of a frequency.
    pub(crate) g_re: &'a mut [Lanes],
    pub(crate) g_im: &'a mut [Lanes],
}

/// Value at the start of a sweep: small, so that the values stay finite when they grow by e^60.
const SEED: f64 = 1e-30;

/// What the condition at the driven end needs from a sweep: g at point 0, and the slope of g there.
pub(crate) struct Ends {
    pub(crate) g_re: Lanes,
    pub(crate) g_im: Lanes,
    /// g (1 + h^2 Q/6) at point 1 minus the same at point -1: 2 h times the slope of g at point 0.
    pub(crate) difference_re: Lanes,
    pub(crate) difference_im: Lanes,
}

impl<M: Medium> WithSimd for Sweep<'_, M> {
    type Output = Ends;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> Ends {
        let last = self.g_re.len() - 1;
        let (mut y_re, mut y_im) = ([0.0; LANES], [0.0; LANES]);
        let (mut next_re, mut next_im) = ([0.0; LANES], [0.0; LANES]);
        let mut side_re = [[0.0; LANES]; 3];
        let mut side_im = [[0.0; LANES]; 3];
        let first = self.start.iter().copied().max().unwrap_or(last).min(last);
        for row in self.g_re[first + 1..].iter_mut().chain(&mut self.g_im[first + 1..]) {
            *row = [0.0; LANES];
        }
        let mut begins = Some(first);
        for i in (0..=first).rev() {
            if begins == Some(i) {
                for lane in 0..LANES {
                    if self.start[lane] == i {
                        y_re[lane] = SEED;
                        next_re[lane] = SEED * self.ratio_re[lane];
                        next_im[lane] = SEED * self.ratio_im[lane];
                    }
                }
                begins = self.start.iter().copied().filter(|&start| start < i).max();
            }
            let (factor_re, factor_im) = self.medium.factor(i);
            let (mut g_re, mut g_im) = ([0.0; LANES], [0.0; LANES]);
            let mut before_re = [0.0; LANES];
            let mut before_im = [0.0; LANES];
            for lane in 0..LANES {
                // p = 1 + h^2 Q/12; y[i-1] = (12/p - 10) y[i] - y[i+1]; g = y/p. The recursion is in y and not in g,
                // because that has fewer operations between y[i] and y[i-1], which must wait for it.
                let (re, im) = (factor_re[lane], factor_im[lane]);
                let inverse = 1.0 / (re * re + im * im);
                let (inv_re, inv_im) = (re * inverse, -im * inverse);
                g_re[lane] = y_re[lane] * inv_re - y_im[lane] * inv_im;
                g_im[lane] = y_re[lane] * inv_im + y_im[lane] * inv_re;
                let (u_re, u_im) = (12.0 * inv_re - 10.0, 12.0 * inv_im);
                before_re[lane] = u_re * y_re[lane] - next_re[lane] - u_im * y_im[lane];
                before_im[lane] = u_re * y_im[lane] - next_im[lane] + u_im * y_re[lane];
            }
            if i <= 2 {
                for lane in 0..LANES {
                    // (1 + h^2 Q/6) g = 2 y - g.
                    side_re[i][lane] = 2.0 * y_re[lane] - g_re[lane];
                    side_im[i][lane] = 2.0 * y_im[lane] - g_im[lane];
                }
            }
            self.g_re[i] = g_re;
            self.g_im[i] = g_im;
            (next_re, next_im) = (y_re, y_im);
            (y_re, y_im) = (before_re, before_im);
        }
        let mut ends = Ends {
            g_re: self.g_re[1],
            g_im: self.g_im[1],
            difference_re: [0.0; LANES],
            difference_im: [0.0; LANES],
        };
        for lane in 0..LANES {
            ends.difference_re[lane] = side_re[2][lane] - side_re[0][lane];
            ends.difference_im[lane] = side_im[2][lane] - side_im[0][lane];
        }
        ends
    }
}

//! The resonators at the sample rate.

use super::lanes::{LANES, Lanes, in_lanes};
use super::output::Output;
use crate::fused::Fused;
use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// States below this, in units of a full-scale code, are set to zero. It is so far above the smallest normal number
/// that no resonator that matters decays from it to subnormal numbers within one run.
const FAINT: f64 = 1e-150;

/// The state of a plate's resonators: z(n) = lambda z(n-1) + u(n), with the code u.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Resonators {
    #[serde(skip, default = "Arch::new")]
    arch: Arch,
    re: Vec<f64>,
    im: Vec<f64>,
    advance_re: Vec<f64>,
    advance_im: Vec<f64>,
}

impl Resonators {
    /// Resonators at rest with these factors per sample.
    pub(super) fn new(advance: &[Complex64]) -> Self {
        let padded = advance.len().next_multiple_of(LANES);
        let part = |of: fn(&Complex64) -> f64| in_lanes(advance.iter().map(of));
        Self {
            arch: Arch::new(),
            re: vec![0.0; padded],
            im: vec![0.0; padded],
            advance_re: part(|lambda| lambda.re),
            advance_im: part(|lambda| lambda.im),
        }
    }

    /// Takes the code `code` (-1 to 1 of full scale) and samples two outputs.
    pub fn step(&mut self, code: f64, outputs: [&Output; 2]) -> [f64; 2] {
        let (mut first, mut second) = ([0.0], [0.0]);
        self.run(&[code], outputs, [&mut first, &mut second]);
        [first[0], second[0]]
    }

    /// As [`Resonators::step`] for many codes: both inputs are sampled as each code leaves. Ends with the shortest of
    /// the slices.
    ///
    /// The outputs must belong to the plate of these resonators; the signal of another plate's output has no meaning.
    pub fn run(&mut self, codes: &[f64], outputs: [&Output; 2], signals: [&mut [f64]; 2]) {
        let [first, second] = signals;
        let count = codes.len().min(first.len()).min(second.len());
        if codes[..count].iter().chain(&self.re).chain(&self.im).all(|&it| it == 0.0) {
            // A plate at rest stays there: a simulated device in silence costs next to nothing.
            first[..count].fill(0.0);
            second[..count].fill(0.0);
            return;
        }
        let samples =
            codes.iter().zip(first).zip(second).map(|((code, first), second)| (*code, first, second));
        self.arch.dispatch(Run {
            samples,
            states: (self.re.as_chunks_mut().0, self.im.as_chunks_mut().0),
            advance: (self.advance_re.as_chunks().0, self.advance_im.as_chunks().0),
            outputs: outputs.map(|it| (it.re.as_chunks().0, it.im.as_chunks().0)),
        });
        self.forget_faint();
    }

    /// Sets decayed states to zero. Without it, strongly damped resonators in silence would fall to subnormal numbers
    /// within milliseconds and stay there, where a processor is many times slower.
    fn forget_faint(&mut self) {
        for (re, im) in self.re.iter_mut().zip(&mut self.im) {
            if re.abs() < FAINT && im.abs() < FAINT {
                (*re, *im) = (0.0, 0.0);
            }
        }
    }

    /// Sets all states to zero.
    pub fn rest(&mut self) {
        self.re.fill(0.0);
        self.im.fill(0.0);
    }
}

struct Run<'a, I> {
    samples: I,
    states: (&'a mut [Lanes], &'a mut [Lanes]),
    advance: (&'a [Lanes], &'a [Lanes]),
    outputs: [(&'a [Lanes], &'a [Lanes]); 2],
}

impl<'a, I: Iterator<Item = (f64, &'a mut f64, &'a mut f64)>> WithSimd for Run<'_, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let [(b_re, b_im), (c_re, c_im)] = self.outputs;
        let count = self.states.0.len().min(b_re.len()).min(c_re.len());
        let (re, im) = (&mut self.states.0[..count], &mut self.states.1[..count]);
        let (a_re, a_im) = (&self.advance.0[..count], &self.advance.1[..count]);
        let (b_re, b_im, c_re, c_im) = (&b_re[..count], &b_im[..count], &c_re[..count], &c_im[..count]);
        for (code, first, second) in self.samples {
            let (mut b_sum, mut c_sum) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..count {
                for lane in 0..LANES {
                    let (x, y) = (
                        a_re[i][lane].fused(re[i][lane], (-a_im[i][lane]).fused(im[i][lane], code)),
                        a_re[i][lane].fused(im[i][lane], a_im[i][lane] * re[i][lane]),
                    );
                    (re[i][lane], im[i][lane]) = (x, y);
                    b_sum[lane] = b_re[i][lane].fused(x, (-b_im[i][lane]).fused(y, b_sum[lane]));
                    c_sum[lane] = c_re[i][lane].fused(x, (-c_im[i][lane]).fused(y, c_sum[lane]));
                }
            }
            *first = b_sum.iter().sum();
            *second = c_sum.iter().sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_rest_silence_gives_zero_and_the_first_code_ends_it() {
        let mut resonators = Resonators::new(&[Complex64::from_polar(0.99, 0.3)]);
        let output = Output { re: in_lanes([1.0].into_iter()), im: in_lanes([0.0].into_iter()), error: 0.0 };
        let mut signals = [[f64::NAN; 4]; 2];
        let [first, second] = &mut signals;
        resonators.run(&[0.0; 3], [&output, &output], [first, &mut second[..3]]);
        assert_eq!((&signals[0][..3], &signals[1][..3]), (&[0.0; 3][..], &[0.0; 3][..]));
        assert!(signals.iter().all(|signal| signal[3].is_nan()), "as many values as codes");
        assert_eq!(resonators.step(0.5, [&output, &output]), [0.5, 0.5]);
        assert!(resonators.step(0.0, [&output, &output])[0] > 0.4, "it rings");
    }

    #[test]
    fn what_dies_away_in_silence_ends_at_zero_and_not_among_subnormal_numbers() {
        // Time constants of 20 samples and of 1000.
        let advance = [0.05_f64, 0.001].map(|loss| Complex64::from_polar((-loss).exp(), 0.3));
        let mut resonators = Resonators::new(&advance);
        let output =
            Output { re: in_lanes([1.0, 1.0].into_iter()), im: in_lanes([0.0, 0.0].into_iter()), error: 0.0 };
        let mut signals = [[0.0; 128]; 2];
        let [first, second] = &mut signals;
        resonators.run(&[1.0; 128], [&output, &output], [first, second]);
        let mut seen = 0;
        for _ in 0..5000 {
            let [first, second] = &mut signals;
            resonators.run(&[0.0; 128], [&output, &output], [first, second]);
            let states = || resonators.re.iter().chain(&resonators.im);
            assert!(!states().any(|state| state.is_subnormal()));
            seen += usize::from(states().any(|state| *state != 0.0));
        }
        // The slower one is e^-345 after 2700 blocks.
        assert!((2600..2750).contains(&seen), "{seen} blocks");
    }
}

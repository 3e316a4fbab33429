//! The driven end of a bending plate with supported edges: w = f(x) cos(pi z/2W), f = p + e.
//!
//! Projected on the width mode the Laplacian is L f = f'' + s f' - q^2 f with s = W'/W and q = pi/(2 W), and the plate's
//! equation L L f = K^4 f splits into L p = -K^2 p (the amplitude equation) and L e = K^2 e. The bending energy
//! (D/2) integral of W ((L f)^2 + 2 (1 - nu) q^2 (f f')') dx, to first order in s, has the boundary forces at x = 0
//!
//! ```text
//! on f':  -D W (L f + (1 - nu) q^2 f)                       the moment, times the integral of cos^2 over the width = W
//! on f:    D W ((L f)' - (1 - nu) q^2 (f' - s f))           Kirchhoff's force
//! ```
//! that an external agent must exert. D is complex with loss, K^4 = rho h omega^2/D. With shear and rotary inertia, K
//! is Mindlin's and D the value that gives the correct power of the wave, rho h omega/(K^2 dK^2/d omega).

use super::DrivenEnd;
use super::lead_in;
use super::near_field::{Course, Decay, NearField, NearWave};
use super::one_mode::source_force;
use super::strip::Strip;
use crate::definition::plate::Plate;
use crate::definition::source::{EndSlope, Source};
use num_complex::Complex64;

impl Strip {
    /// D W with loss: K^4 D is real in vacuum.
    fn lossy_stiffness(&self) -> Complex64 {
        let ratio = self.lossless_axial / (self.lossless_axial * self.compliance);
        self.stiffness * ratio * ratio
    }

    /// -e'/e at x = 0: gamma, with the change of the width to first order.
    fn decay(&self) -> Complex64 {
        let square = self.axial + self.across;
        square.sqrt() + 0.5 * self.narrowing * (1.0 - self.across / square)
    }

    /// The forces on f and on f' at x = 0, each as coefficients of p(0), p'(0) and e(0).
    fn forces(&self) -> [[Complex64; 3]; 2] {
        let stiffness = self.lossy_stiffness();
        let lateral = self.lateral * self.across;
        let decay = self.decay();
        let kirchhoff = [
            Complex64::from(lateral * self.narrowing),
            -self.axial - lateral,
            -decay * (self.axial - lateral) + lateral * self.narrowing,
        ];
        let moment = [self.axial - lateral, Complex64::ZERO, -self.axial - lateral];
        [kirchhoff.map(|term| stiffness * term), moment.map(|term| stiffness * term)]
    }

    /// The end with the conditions `first` = `drive` and `second` = 0, each as coefficients of p(0), p'(0) and e(0).
    fn end(&self, first: [Complex64; 3], second: [Complex64; 3], drive: Complex64) -> DrivenEnd {
        let per_value = -second[0] / second[2];
        let per_slope = -second[1] / second[2];
        let decay = Decay { axial: self.axial, across: self.across.into() };
        let wave = NearWave { per_value, per_slope, course: Course::DiesOut(decay) };
        DrivenEnd {
            alpha: first[0] + first[2] * per_value,
            beta: first[1] + first[2] * per_slope,
            drive,
            near: NearField { waves: vec![wave] },
        }
    }

    /// f and f' as coefficients of p(0), p'(0) and e(0).
    fn motion(&self) -> [[Complex64; 3]; 2] {
        [[Complex64::ONE, Complex64::ZERO, Complex64::ONE], [Complex64::ZERO, Complex64::ONE, -self.decay()]]
    }
}

/// An end whose deflection is prescribed, f = 1, and whose slope is free or held.
pub(super) fn moved(plate: &Plate, frequency_hz: f64, narrowing: f64, slope: EndSlope) -> DrivenEnd {
    let strip = Strip::new(plate, frequency_hz, narrowing);
    let [value, turn] = strip.motion();
    let second = match slope {
        EndSlope::Held => turn,
        EndSlope::Free => strip.forces()[1],
    };
    strip.end(value, second, Complex64::ONE)
}

/// An end on which a source acts, with its lead-in behind it.
pub(super) fn sourced(plate: &Plate, frequency_hz: f64, narrowing: f64, source: &Source) -> DrivenEnd {
    let strip = Strip::new(plate, frequency_hz, narrowing);
    let [value, turn] = strip.motion();
    let behind = source.lead_in.map(|lead_in| lead_in::dynamic_stiffness(&strip, &lead_in));
    let behind = behind.unwrap_or([[Complex64::ZERO; 2]; 2]);
    let load = source.impedance.dynamic_stiffness(strip.omega);
    let mut forces = strip.forces();
    for (force, stiffness) in forces.iter_mut().zip(behind) {
        for (term, (value, turn)) in force.iter_mut().zip(value.iter().zip(turn)) {
            *term += stiffness[0] * value + stiffness[1] * turn;
        }
    }
    for (term, value) in forces[0].iter_mut().zip(value) {
        *term += load * value;
    }
    let second = match source.slope {
        Some(EndSlope::Held) => turn,
        Some(EndSlope::Free) | None => forces[1],
    };
    strip.end(forces[0], second, source_force(plate, source))
}

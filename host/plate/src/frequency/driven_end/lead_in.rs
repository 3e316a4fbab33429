//! The strip behind a driven end in bending: its dynamic stiffness as a load of the end.
//!
//! With y = 0 at the junction and y = l at the far end its four waves are e^(jky), e^(jk(l - y)), e^(-gamma y) and
//! e^(-gamma (l - y)), each at most 1 on the strip, with k^2 = K^2 - q^2 and gamma^2 = K^2 + q^2. At the far end the
//! moment is zero and a damper takes the force.

use super::strip::Strip;
use crate::definition::impedance::Impedance;
use crate::definition::source::LeadIn;
use nalgebra::{Matrix2, Matrix4, Vector4};
use num_complex::Complex64;

/// The forces on (f, f') at the junction that move the strip, per unit of f and of f' (x points away from the strip).
pub(super) fn dynamic_stiffness(strip: &Strip, lead_in: &LeadIn) -> [[Complex64; 2]; 2] {
    // D (1 - j eta) at the same K^4 D: K^2 varies as the inverse root.
    let loss = Complex64::new(1.0, -lead_in.loss_factor);
    let axial = strip.lossless_axial / loss.sqrt();
    let stiffness = strip.stiffness * loss;
    let lateral = strip.lateral * strip.across;
    let wavenumber = (axial - strip.across).sqrt();
    let decay = (axial + strip.across).sqrt();
    let length = lead_in.length_m;
    let damper = -Impedance::damper(lead_in.end_resistance_n_s_per_m).dynamic_stiffness(strip.omega);

    // Columns: the four waves. Rows: f and df/dy at the junction, moment and force balance at the far end.
    let mut conditions = Matrix4::<Complex64>::zeros();
    let mut forces = [[Complex64::ZERO; 4]; 2];
    let through_k = (Complex64::I * wavenumber * length).exp();
    let through_decay = (-decay * length).exp();
    let waves = [
        // (value at the junction, value at the far end, d/dy over the value, L f over f)
        (Complex64::ONE, through_k, Complex64::I * wavenumber, -axial),
        (through_k, Complex64::ONE, -Complex64::I * wavenumber, -axial),
        (Complex64::ONE, through_decay, -decay, axial),
        (through_decay, Complex64::ONE, decay, axial),
    ];
    for (column, (near, far, rate, laplacian)) in waves.into_iter().enumerate() {
        conditions[(0, column)] = near;
        conditions[(1, column)] = near * rate;
        conditions[(2, column)] = far * (laplacian + lateral);
        // -D W ((L f)' - (1 - nu) q^2 f') = j omega R f: the damper acts on the end.
        conditions[(3, column)] = far * (stiffness * rate * (laplacian - lateral) + damper);
        forces[0][column] = near * stiffness * rate * (laplacian - lateral);
        forces[1][column] = -near * stiffness * (laplacian + lateral);
    }
    // Rows are scaled to one size: the force row is in N/m, the others in powers of 1/m.
    let scale = (strip.stiffness * axial.norm().powf(1.5)).recip();
    for column in 0..4 {
        conditions[(1, column)] /= axial.norm().sqrt();
        conditions[(2, column)] /= axial.norm();
        conditions[(3, column)] *= scale;
    }
    let factors = conditions.lu();
    let response = |row: usize, size: f64| {
        let mut unit = Vector4::<Complex64>::zeros();
        unit[row] = Complex64::from(size);
        let amplitude = factors.solve(&unit).unwrap_or_else(Vector4::zeros);
        forces.map(|force| force.iter().zip(&amplitude).map(|(force, amplitude)| force * amplitude).sum())
    };
    let per_value: [Complex64; 2] = response(0, 1.0);
    let per_turn: [Complex64; 2] = response(1, axial.norm().sqrt().recip());
    let of_y = Matrix2::new(per_value[0], per_turn[0], per_value[1], per_turn[1]);
    // y = -x reverses the signs of f' and of the force on it.
    [[of_y[(0, 0)], -of_y[(0, 1)]], [-of_y[(1, 0)], of_y[(1, 1)]]]
}

//! The two-dimensional solver against closed forms, independent laws and itself.

mod fields;
mod rectangle;
mod reflections;

use crate::{Bending, DriveEnd, Model, Plate, PlateSpec, Taper};

/// Aluminium, 2 mm, in bending on a taper of 20 mm half-width: the plate of the al-bending preset.
fn aluminium(clamped: bool, loss_factor: f64) -> Plate {
    let bending = Bending {
        youngs_modulus_pa: 70e9,
        poisson_ratio: 0.33,
        density_kg_per_m3: 2700.0,
        thickness_m: 0.002,
        thick_plate: false,
    };
    Plate::new(PlateSpec {
        name: "aluminium".to_owned(),
        description: String::new(),
        taper: Taper::Exponential { half_width_m: 0.02, rate_per_m: 4.62 },
        length_m: 0.34,
        model: if clamped { Model::BendingClamped(bending) } else { Model::BendingSupported(bending) },
        loss_factor,
        wave_speed_tolerance: 0.0,
        loss_tolerance: None,
        drive_end: DriveEnd::Displacement,
        actuator: None,
        full_scale_m: 1e-6,
        span_start_m: 0.1,
        span_end_m: 0.25,
    })
    .expect("a plate")
}

/// The membrane with this tension, N per metre of width.
fn with_tension(plate: &Plate, tension: f64) -> Plate {
    let mut spec = plate.spec().clone();
    if let Model::Membrane { tension_n_per_m, .. } = &mut spec.model {
        *tension_n_per_m = Some(tension);
    }
    Plate::new(spec).expect("a plate")
}

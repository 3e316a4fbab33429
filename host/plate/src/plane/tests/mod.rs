//! The two-dimensional solver against closed forms, independent laws and itself.

mod fields;
mod fluid;
mod rectangle;
mod reflections;
mod sheet;

use crate::{Model, Plate, PlateSpec, preset};

/// The plate of the al-bending presets with a moved end, between supported or clamped edges.
fn aluminium(clamped: bool, loss_factor: f64) -> Plate {
    let supported = preset("al-bending-displacement").expect("a preset").spec().clone();
    let model = match supported.model.bending() {
        Some(bending) if clamped => Model::BendingClamped(bending.clone()),
        _ => supported.model.clone(),
    };
    let spec = PlateSpec { model, loss_factor, span_start_m: 0.1, span_end_m: 0.25, ..supported };
    Plate::new(spec).expect("a plate")
}

/// The membrane with this tension, N per metre of width.
fn with_tension(plate: &Plate, tension: f64) -> Plate {
    let mut spec = plate.spec().clone();
    if let Model::Membrane { tension_n_per_m, .. } = &mut spec.model {
        *tension_n_per_m = Some(tension);
    }
    Plate::new(spec).expect("a plate")
}

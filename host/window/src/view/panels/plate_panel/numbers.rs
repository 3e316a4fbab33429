//! The numbers of the plate on the screen. A change of one field makes a new plate.

use crate::caption::{self, Panel};
use crate::intent::{Intent, Intents};
use crate::view::fields::field::{InputField, labelled, row};
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_model::setup::edit::Edit;
use slipline_plate::quantity::{Caption, FIELD_DIGITS};
use slipline_plate::{
    Actuator, Bending, DriveEnd, EndSlope, Film, LeadIn, Model, Plate, PlateSpec, Resonator, Source, Taper,
    Travel,
};
use std::sync::Arc;

/// Shows the numbers of `plate`.
pub(super) fn show(ui: &mut egui::Ui, plate: &Arc<Plate>, view: &mut ViewState, intents: &mut Intents) {
    let mut numbers = Numbers { plate, view, intents };
    theme::heading(ui, "Shape");
    shape(ui, &mut numbers);
    ui.separator();
    theme::heading(ui, "Wave");
    wave(ui, &mut numbers);
    ui.separator();
    theme::heading(ui, "Drive end");
    drive_end(ui, &mut numbers);
    ui.separator();
    theme::heading(ui, "Actuator");
    actuator(ui, &mut numbers);
}

/// The plate and the state with which the fields are shown.
pub(super) struct Numbers<'a, 'b> {
    pub(super) plate: &'a Arc<Plate>,
    pub(super) view: &'b mut ViewState,
    pub(super) intents: &'b mut Intents,
}

impl Numbers<'_, '_> {
    /// Takes a changed plate.
    pub(super) fn take(&mut self, plate: Plate) {
        self.intents.push(Intent::Edit(Edit::Plate(Arc::new(plate))));
    }

    pub(super) fn number(
        &mut self,
        ui: &mut egui::Ui,
        caption: &Caption,
        value: f64,
        set: impl FnOnce(&mut PlateSpec, f64),
    ) {
        labelled(ui, caption.name, |ui| {
            let text = caption.unit.written(value, FIELD_DIGITS);
            let field = InputField {
                name: caption.name,
                value: &text,
                hint: "The range is checked by the rule that plate files obey",
                width: 120.0,
                caption: None,
                is_live: false,
            };
            let taken = field.show(ui, &mut self.view.fields, |text| {
                let value = caption.unit.read(text).map_err(|error| error.to_string())?;
                changed(self.plate, |spec| set(spec, value))
            });
            if let Some(plate) = taken {
                self.take(plate);
            }
        });
    }
}

/// The plate with a change, or the reason of its refusal.
pub(super) fn changed(plate: &Plate, set: impl FnOnce(&mut PlateSpec)) -> Result<Plate, String> {
    let mut spec = plate.spec().clone();
    set(&mut spec);
    // A changed preset is no longer that preset: its name says so.
    spec.mark_name(" (changed)");
    Plate::new(spec).map_err(|error| error.worded(&Panel::Plate))
}

fn shape(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let plate = Arc::clone(numbers.plate);
    let spec = plate.spec();
    numbers.number(ui, &caption::LENGTH, spec.length_m, |spec, value| spec.length_m = value);
    match &spec.taper {
        Taper::Exponential { half_width_m, rate_per_m } => {
            numbers.number(ui, &caption::HALF_WIDTH, *half_width_m, |spec, value| {
                if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                    *half_width_m = value;
                }
            });
            numbers.number(ui, &caption::TAPER_RATE, *rate_per_m, |spec, value| {
                if let Taper::Exponential { rate_per_m, .. } = &mut spec.taper {
                    *rate_per_m = value;
                }
            });
        }
        Taper::Linear { half_width_m, end_half_width_m } => {
            numbers.number(ui, &caption::HALF_WIDTH, *half_width_m, |spec, value| {
                if let Taper::Linear { half_width_m, .. } = &mut spec.taper {
                    *half_width_m = value;
                }
            });
            numbers.number(ui, &caption::END_HALF_WIDTH, *end_half_width_m, |spec, value| {
                if let Taper::Linear { end_half_width_m, .. } = &mut spec.taper {
                    *end_half_width_m = value;
                }
            });
        }
        Taper::Sampled { points } => {
            row(ui, caption::HALF_WIDTH.name, format!("{} points from the file", points.len()));
        }
    }
    numbers.number(ui, &caption::SPAN_START, spec.span_start_m, |spec, value| spec.span_start_m = value);
    numbers.number(ui, &caption::SPAN_END, spec.span_end_m, |spec, value| spec.span_end_m = value);
}

fn wave(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let plate = Arc::clone(numbers.plate);
    let spec = plate.spec();
    let kind = match &spec.model {
        Model::Membrane { .. } => "stretched membrane",
        Model::ShearHorizontal { .. } => "shear-horizontal wave",
        Model::BendingSupported(_) => "bending, edges supported",
        Model::BendingClamped(_) => "bending, edges clamped",
    };
    row(ui, "Model", kind);
    match &spec.model {
        Model::Membrane { wave_speed_m_per_s, tension_n_per_m, film } => {
            numbers.number(ui, &caption::WAVE_SPEED, *wave_speed_m_per_s, |spec, value| {
                if let Model::Membrane { wave_speed_m_per_s, .. } = &mut spec.model {
                    *wave_speed_m_per_s = value;
                }
            });
            if let Some(tension) = tension_n_per_m {
                numbers.number(ui, &caption::TENSION, *tension, |spec, value| {
                    if let Model::Membrane { tension_n_per_m, .. } = &mut spec.model {
                        *tension_n_per_m = Some(value);
                    }
                });
            }
            if let Some(film) = film {
                let mut of = |ui: &mut egui::Ui, caption, value, set: fn(&mut Film, f64)| {
                    numbers.number(ui, caption, value, |spec, value| {
                        if let Model::Membrane { film: Some(film), .. } = &mut spec.model {
                            set(film, value);
                        }
                    });
                };
                of(ui, &caption::YOUNGS_MODULUS, film.youngs_modulus_pa, |film, v| {
                    film.youngs_modulus_pa = v;
                });
                of(ui, &caption::POISSON_RATIO, film.poisson_ratio, |film, v| film.poisson_ratio = v);
                of(ui, &caption::THICKNESS, film.thickness_m, |film, v| film.thickness_m = v);
            }
        }
        Model::ShearHorizontal { shear_modulus_pa, density_kg_per_m3, thickness_m } => {
            numbers.number(ui, &caption::SHEAR_MODULUS, *shear_modulus_pa, |spec, value| {
                if let Model::ShearHorizontal { shear_modulus_pa, .. } = &mut spec.model {
                    *shear_modulus_pa = value;
                }
            });
            numbers.number(ui, &caption::DENSITY, *density_kg_per_m3, |spec, value| {
                if let Model::ShearHorizontal { density_kg_per_m3, .. } = &mut spec.model {
                    *density_kg_per_m3 = value;
                }
            });
            if let Some(thickness) = thickness_m {
                numbers.number(ui, &caption::THICKNESS, *thickness, |spec, value| {
                    if let Model::ShearHorizontal { thickness_m, .. } = &mut spec.model {
                        *thickness_m = Some(value);
                    }
                });
            }
        }
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => {
            let mut of = |ui: &mut egui::Ui, caption, value, set: fn(&mut Bending, f64)| {
                numbers.number(ui, caption, value, |spec, value| match &mut spec.model {
                    Model::BendingSupported(bending) | Model::BendingClamped(bending) => set(bending, value),
                    _ => {}
                });
            };
            of(ui, &caption::YOUNGS_MODULUS, bending.youngs_modulus_pa, |b, v| {
                b.youngs_modulus_pa = v;
            });
            of(ui, &caption::POISSON_RATIO, bending.poisson_ratio, |b, v| {
                b.poisson_ratio = v;
            });
            of(ui, &caption::DENSITY, bending.density_kg_per_m3, |b, v| {
                b.density_kg_per_m3 = v;
            });
            of(ui, &caption::THICKNESS, bending.thickness_m, |b, v| b.thickness_m = v);
            thin_plate(ui, numbers, bending);
        }
    }
    numbers.number(ui, &caption::LOSS_FACTOR, spec.loss_factor, |spec, value| {
        spec.loss_factor = value;
    });
}

/// The box for leaving out shear and rotary inertia. It is enabled if the plate is valid either way.
fn thin_plate(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>, bending: &Bending) {
    let mut thin = !bending.thick_plate;
    let other = changed(numbers.plate, |spec| {
        if let Model::BendingSupported(bending) | Model::BendingClamped(bending) = &mut spec.model {
            bending.thick_plate = thin;
        }
    });
    let check = ui.add_enabled(other.is_ok(), egui::Checkbox::new(&mut thin, "Thin plate"));
    match other {
        Ok(plate) => {
            if check.on_hover_text("Leave out shear and rotary inertia").changed() {
                numbers.take(plate);
            }
        }
        Err(reason) => drop(check.on_disabled_hover_text(reason)),
    }
}

fn drive_end(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let plate = Arc::clone(numbers.plate);
    let spec = plate.spec();
    let (name, help) = match &spec.drive_end {
        DriveEnd::Displacement => ("displacement", "The end follows the drive: waves come back and resonate"),
        DriveEnd::Force { .. } => ("force", "The end is pushed with a force"),
        DriveEnd::Resistance { .. } => {
            ("damped source", "A source with a resistance swallows what comes back; 1 is matched")
        }
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Free } => (
            "displacement, hinged",
            "The end follows the drive and is free to turn: waves come back and resonate",
        ),
        DriveEnd::DisplacementAndSlope { slope: EndSlope::Held } => (
            "displacement, guided",
            "The end follows the drive and cannot turn: waves come back and resonate",
        ),
        DriveEnd::Source(Source { lead_in: Some(_), .. }) => {
            ("source with lead-in", "A force; the strip behind it swallows what comes back")
        }
        DriveEnd::Source(_) => ("source", "A force on an end with a resistance, a mass and a spring"),
    };
    row(ui, "Kind", name);
    ui.label(RichText::new(help).small().weak());
    if let DriveEnd::Resistance { ratio, .. } = &spec.drive_end {
        numbers.number(ui, &caption::DRIVE_RATIO, *ratio, |spec, value| {
            if let DriveEnd::Resistance { ratio, .. } = &mut spec.drive_end {
                *ratio = value;
            }
        });
    }
    if let DriveEnd::Source(source) = &spec.drive_end {
        source_numbers(ui, numbers, *source);
    }
    numbers.number(ui, &caption::AT_FULL_SCALE, spec.full_scale_m, |spec, value| {
        spec.full_scale_m = value;
    });
}

/// The mechanical numbers of a source and of the lead-in behind it.
fn source_numbers(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>, source: Source) {
    let mut of = |ui: &mut egui::Ui, caption, value, set: fn(&mut Source, f64)| {
        numbers.number(ui, caption, value, |spec, value| {
            if let DriveEnd::Source(source) = &mut spec.drive_end {
                set(source, value);
            }
        });
    };
    of(ui, &caption::END_RESISTANCE, source.impedance.resistance_n_s_per_m, |it, value| {
        it.impedance.resistance_n_s_per_m = value;
    });
    of(ui, &caption::MOVING_MASS, source.impedance.mass_kg, |it, value| it.impedance.mass_kg = value);
    of(ui, &caption::END_STIFFNESS, source.impedance.stiffness_n_per_m, |it, value| {
        it.impedance.stiffness_n_per_m = value;
    });
    let Some(lead_in) = source.lead_in else { return };
    let mut of_lead_in = |ui: &mut egui::Ui, caption, value, set: fn(&mut LeadIn, f64)| {
        numbers.number(ui, caption, value, |spec, value| {
            if let DriveEnd::Source(Source { lead_in: Some(lead_in), .. }) = &mut spec.drive_end {
                set(lead_in, value);
            }
        });
    };
    of_lead_in(ui, &caption::LEAD_IN_LENGTH, lead_in.length_m, |it, value| it.length_m = value);
    of_lead_in(ui, &caption::LEAD_IN_LOSS, lead_in.loss_factor, |it, value| it.loss_factor = value);
    of_lead_in(ui, &caption::LEAD_IN_DAMPER, lead_in.end_resistance_n_s_per_m, |it, value| {
        it.end_resistance_n_s_per_m = value;
    });
}

/// The actuator's numbers, if the plate file has any. How far it moves is limited only if the file says how far it may.
fn actuator(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let plate = Arc::clone(numbers.plate);
    let actuator = plate.spec().actuator.as_ref();
    if let Some(Actuator::Measured(curve)) = actuator {
        row(ui, "Response", format!("{} points from the file", curve.points.len()));
    }
    let mut of = |ui: &mut egui::Ui, caption, value, set: fn(&mut Resonator, f64)| {
        numbers.number(ui, caption, value, |spec, value| {
            if let Some(Actuator::Resonator(resonator)) = &mut spec.actuator {
                set(resonator, value);
            }
        });
    };
    let resonator = actuator.and_then(Actuator::resonator);
    if let Some(resonator) = resonator {
        of(ui, &caption::RESONANCE, resonator.resonance_hz, |it, value| it.resonance_hz = value);
        of(ui, &caption::QUALITY, resonator.quality, |it, value| it.quality = value);
    }
    let Some(travel) = resonator.and_then(|resonator| resonator.travel) else {
        row(ui, caption::PEAK_TRAVEL.name, "not limited");
        ui.label(RichText::new("The plate file names no peak travel of an actuator").small().weak());
        return;
    };
    let mut of = |ui: &mut egui::Ui, caption, value, set: fn(&mut Travel, f64)| {
        numbers.number(ui, caption, value, |spec, value| {
            if let Some(Actuator::Resonator(Resonator { travel: Some(travel), .. })) = &mut spec.actuator {
                set(travel, value);
            }
        });
    };
    of(ui, &caption::PEAK_TRAVEL, travel.peak_m, |travel, value| travel.peak_m = value);
    of(ui, &caption::STATIC_TRAVEL, travel.static_m, |travel, value| travel.static_m = value);
}

//! The numbers of the plate on the screen. A change of one field makes a new plate.

use crate::caption::{self, Panel};
use crate::intent::{Intent, Intents};
use crate::view::field::{InputField, labelled, row};
use crate::view::{ViewState, theme};
use eframe::egui::{self, RichText};
use slipline_model::setup::edit::Edit;
use slipline_plate::quantity::{Caption, FIELD_DIGITS};
use slipline_plate::{Bending, DriveEnd, Model, Plate, PlateSpec, Taper, Travel, limits};
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

/// The `Ui` and state with which the fields are shown.
struct Numbers<'a, 'b> {
    plate: &'a Arc<Plate>,
    view: &'b mut ViewState,
    intents: &'b mut Intents,
}

impl Numbers<'_, '_> {
    fn number(
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
            };
            let taken = field.show(ui, &mut self.view.fields, |text| {
                let value = caption.unit.read(text).map_err(|error| error.to_string())?;
                let mut spec = self.plate.spec().clone();
                set(&mut spec, value);
                Plate::new(renamed(spec, self.plate)).map_err(|error| error.told(&Panel::Plate))
            });
            if let Some(plate) = taken {
                self.intents.push(Intent::Edit(Edit::Plate(Arc::new(plate))));
            }
        });
    }
}

/// A changed preset is no longer that preset: its name says so.
fn renamed(mut spec: PlateSpec, before: &Plate) -> PlateSpec {
    const MARK: &str = " (changed)";
    if !before.name().ends_with(MARK) {
        let room = limits::NAME.most - MARK.len();
        spec.name = spec.name.chars().take(room).chain(MARK.chars()).collect();
    }
    spec
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
        Model::Membrane { wave_speed_m_per_s } => {
            numbers.number(ui, &caption::WAVE_SPEED, *wave_speed_m_per_s, |spec, value| {
                if let Model::Membrane { wave_speed_m_per_s } = &mut spec.model {
                    *wave_speed_m_per_s = value;
                }
            });
        }
        Model::ShearHorizontal { shear_modulus_pa, density_kg_per_m3 } => {
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
    let mut spec = numbers.plate.spec().clone();
    if let Model::BendingSupported(bending) | Model::BendingClamped(bending) = &mut spec.model {
        bending.thick_plate = thin;
    }
    let other = Plate::new(renamed(spec, numbers.plate)).map_err(|error| error.told(&Panel::Plate));
    let check = ui.add_enabled(other.is_ok(), egui::Checkbox::new(&mut thin, "Thin plate"));
    match other {
        Ok(plate) => {
            if check.on_hover_text("Leave out shear and rotary inertia").changed() {
                numbers.intents.push(Intent::Edit(Edit::Plate(Arc::new(plate))));
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
    numbers.number(ui, &caption::AT_FULL_SCALE, spec.full_scale_m, |spec, value| {
        spec.full_scale_m = value;
    });
}

/// The actuator's numbers, if the plate file has any. How far it moves is limited only if the file says how far it may.
fn actuator(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let actuator = numbers.plate.spec().actuator;
    if let Some(actuator) = actuator {
        numbers.number(ui, &caption::RESONANCE, actuator.resonance_hz, |spec, value| {
            if let Some(actuator) = &mut spec.actuator {
                actuator.resonance_hz = value;
            }
        });
        numbers.number(ui, &caption::QUALITY, actuator.quality, |spec, value| {
            if let Some(actuator) = &mut spec.actuator {
                actuator.quality = value;
            }
        });
    }
    let Some(travel) = actuator.and_then(|actuator| actuator.travel) else {
        row(ui, caption::PEAK_TRAVEL.name, "not limited");
        ui.label(RichText::new("The plate file names no peak travel of an actuator").small().weak());
        return;
    };
    let mut of = |ui: &mut egui::Ui, caption, value, set: fn(&mut Travel, f64)| {
        numbers.number(ui, caption, value, |spec, value| {
            if let Some(travel) = spec.actuator.as_mut().and_then(|actuator| actuator.travel.as_mut()) {
                set(travel, value);
            }
        });
    };
    of(ui, &caption::PEAK_TRAVEL, travel.peak_m, |travel, value| travel.peak_m = value);
    of(ui, &caption::STATIC_TRAVEL, travel.static_m, |travel, value| travel.static_m = value);
}

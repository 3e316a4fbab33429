//! The numbers of the plate on the screen. A change of one field makes a new plate.

use crate::caption::Panel;
use crate::intent::{Intent, Intents};
use crate::view::fields::field::{InputField, labelled, row};
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_model::setup::edit::Edit;
use slipline_plate::quantity::FIELD_DIGITS;
use slipline_plate::quantity::Notation as _;
use slipline_plate::quantity::number_format::typed;
use slipline_plate::{Actuator, Bending, DriveEnd, EndSlope, Model, Plate, PlateSpec, Source, Taper, fields};
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
    if numbers.plate.spec().frame.is_some() {
        ui.separator();
        theme::heading(ui, "Frame");
        numbers.show(
            ui,
            &[
                "frame.thickness_m",
                "frame.rim_m",
                "frame.youngs_modulus_pa",
                "frame.density_kg_per_m3",
                "frame.table_mass_kg",
            ],
        );
    }
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

    /// The fields with these paths in a plate file, each if this plate has it.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, paths: &[&str]) {
        let mut spec = self.plate.spec().clone();
        for path in paths {
            let field = fields::field(path);
            let Some((field, caption)) = field.and_then(|field| Some((field, field.caption?))) else {
                debug_assert!(false, "{path} is no field with a caption");
                continue;
            };
            let Some(&mut value) = field.number_of(&mut spec) else { continue };
            labelled(ui, caption.name, |ui| {
                let text = caption.unit.written(value, FIELD_DIGITS);
                let hint = "The range is checked by the rule that plate files obey";
                let input = InputField::new(caption.name, &text, hint, 120.0);
                let taken = input.show(ui, &mut self.view.fields, |text| {
                    let value = caption.unit.read(text).map_err(|error| error.to_string())?;
                    changed(self.plate, |spec| {
                        if let Some(number) = field.number_of(spec) {
                            *number = value;
                        }
                    })
                });
                if let Some(plate) = taken {
                    self.take(plate);
                }
            });
        }
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
    numbers.show(
        ui,
        &["length_m", "taper.half_width_m", "taper.rate_per_m", "taper.end_half_width_m", "edge_give_m"],
    );
    if let Taper::Sampled { points } = &numbers.plate.spec().taper {
        row(ui, &Panel::Plate.field("taper.half_width_m"), format!("{} points from the file", points.len()));
    }
    numbers.show(ui, &["span_start_m", "span_end_m"]);
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
    numbers.show(
        ui,
        &[
            "model.wave_speed_m_per_s",
            "model.tension_n_per_m",
            "tension_ratio",
            "model.shear_modulus_pa",
            "model.youngs_modulus_pa",
            "model.poisson_ratio",
            "model.density_kg_per_m3",
            "model.thickness_m",
        ],
    );
    if let Some(bending) = spec.model.bending() {
        thin_plate(ui, numbers, bending);
    }
    numbers.show(ui, &["loss_factor", "loss_exponent"]);
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
            ("damped source", "A source with a resistance absorbs what comes back; 1 is matched")
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
            ("source with lead-in", "A force; the strip behind it absorbs what comes back")
        }
        DriveEnd::Source(_) => ("source", "A force on an end with a resistance, a mass and a spring"),
    };
    row(ui, "Kind", name);
    ui.label(RichText::new(help).small().weak());
    numbers.show(
        ui,
        &[
            "drive.ratio",
            "drive.resistance_n_s_per_m",
            "drive.mass_kg",
            "drive.stiffness_n_per_m",
            "drive.lead_in.length_m",
            "drive.lead_in.loss_factor",
            "drive.lead_in.end_resistance_n_s_per_m",
            "full_scale_m",
        ],
    );
}

/// The actuator's numbers, if the plate file has any. How far it moves is limited only if the file says how far it may.
fn actuator(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let plate = Arc::clone(numbers.plate);
    let actuator = plate.spec().actuator.as_ref();
    if let Some(Actuator::Measured(curve)) = actuator {
        row(ui, "Response", format!("{} points from the file", curve.points.len()));
    }
    numbers.show(
        ui,
        &["actuator.resonance_hz", "actuator.quality", "actuator.peak_travel_m", "actuator.static_travel_m"],
    );
    let is_limited =
        actuator.and_then(Actuator::resonator).is_some_and(|resonator| resonator.travel.is_some());
    if !is_limited {
        row(ui, &Panel::Plate.field("actuator.peak_travel_m"), "not limited");
        ui.label(RichText::new("The plate file names no peak travel of an actuator").small().weak());
    }
    if let Some(harmonics) = &plate.spec().harmonics {
        row(ui, "Harmonics", format!("from the file, at level {}", typed(harmonics.level)));
    }
}

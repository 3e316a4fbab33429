//! The plate panel: which plate, its taper, material and loss, the table for it; its validity lights; the designer.

use super::field::{Field, labelled, row};
use super::intent::{Intent, Intents};
use super::{Scene, ViewState, designer, theme, validity};
use crate::edit::Edit;
use crate::plate_fault::{Panel, sentence};
use crate::quantity::{self, show_frequency, show_length, show_place};
use eframe::egui::{self, RichText};
use slipline_plate::{Bending, DriveEnd, Model, Plate, PlateSpec, Taper};
use std::sync::Arc;

/// What the panel is open at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    #[default]
    Plate,
    Validity,
    Designer,
}

const PAGES: [(Page, &str, &str); 3] = [
    (Page::Plate, "This plate", "Which plate it is, and its numbers"),
    (Page::Validity, "Validity", "How far plate and boundary can be relied on"),
    (Page::Designer, "Designer", "A plate for a band: taper, damper, cut files"),
];

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = ((ui.available_width() - 8.0) / 3.0).floor();
        for (page, name, help) in PAGES {
            let text = RichText::new(name).size(12.5);
            let button = egui::Button::selectable(view.plate_page == page, text);
            if ui.add(button.min_size(egui::vec2(width, 24.0))).on_hover_text(help).clicked() {
                view.plate_page = page;
            }
        }
    });
    ui.add_space(6.0);
    match view.plate_page {
        Page::Plate => numbers(ui, scene, view, intents),
        Page::Validity => validity::show(ui, scene),
        Page::Designer => designer::show(ui, scene, view, intents),
    }
}

fn numbers(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let plate = &scene.setup.plate;
    presets(ui, plate, intents);
    ui.label(RichText::new(&plate.spec().description).small().color(palette.weak));
    ui.add_space(4.0);
    ui.separator();
    theme::heading(ui, "Shape");
    let mut numbers = Numbers { plate, view, intents };
    shape(ui, &mut numbers);
    ui.separator();
    theme::heading(ui, "Wave");
    wave(ui, &mut numbers);
    ui.separator();
    theme::heading(ui, "Drive end");
    drive_end(ui, &mut numbers);
    ui.separator();
    theme::heading(ui, "What follows");
    let (low, high) = plate.band_hz();
    row(ui, "Cut-off", show_frequency(plate.cut_off_hz()));
    row(ui, "Band", format!("{} to {}", show_frequency(low), show_frequency(high)));
    table(ui, scene, intents);
}

fn presets(ui: &mut egui::Ui, plate: &Arc<Plate>, intents: &mut Intents) {
    let name = plate.name();
    let response = egui::ComboBox::from_id_salt("preset")
        .selected_text(name)
        .width(ui.available_width() - 8.0)
        .height(340.0)
        .show_ui(ui, |ui| {
            for preset in slipline_plate::presets() {
                let Some(other) = preset.plate() else { continue };
                let is_this = other.spec() == plate.spec();
                let label = ui.selectable_label(is_this, other.name());
                if label.on_hover_text(preset.description()).clicked() && !is_this {
                    intents.push(Intent::Edit(Edit::Plate(Arc::new(other))));
                }
            }
            ui.separator();
            if ui.button("From a file…").clicked() {
                intents.push(Intent::OpenDialog);
            }
        });
    let label = format!("Plate: {name}");
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
}

/// The numbers of a plate, each a field that makes a new plate.
struct Numbers<'a, 'b> {
    plate: &'a Arc<Plate>,
    view: &'b mut ViewState,
    intents: &'b mut Intents,
}

/// How a number is written and read.
enum Unit {
    /// Millimetres, or any length unit when typed.
    Length,
    /// A plain number with this unit behind it, times the factor in SI.
    Plain(&'static str, f64),
}

impl Numbers<'_, '_> {
    fn number(
        &mut self,
        ui: &mut egui::Ui,
        name: &str,
        value: f64,
        unit: &Unit,
        set: impl FnOnce(&mut PlateSpec, f64),
    ) {
        labelled(ui, name, |ui| {
            let text = match unit {
                Unit::Length => show_millimetres(value),
                Unit::Plain(unit, factor) => {
                    format!("{} {unit}", trimmed(value / factor)).trim_end().to_owned()
                }
            };
            let field = Field {
                name,
                value: &text,
                hint: "The range is checked by the rule that plate files obey",
                width: 120.0,
                caption: None,
            };
            let taken = field.show(ui, &mut self.view.fields, |text| {
                let value = match unit {
                    Unit::Length => quantity::length_m(text),
                    Unit::Plain(unit, factor) => quantity::plain(text, unit).map(|value| value * factor),
                };
                let mut spec = self.plate.spec().clone();
                set(&mut spec, value.map_err(|error| error.to_string())?);
                Plate::new(renamed(spec, self.plate)).map_err(|error| sentence(&error, Panel::Plate))
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
        let room = 80 - MARK.len();
        spec.name = spec.name.chars().take(room).chain(MARK.chars()).collect();
    }
    spec
}

fn trimmed(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn show_millimetres(metres: f64) -> String {
    format!("{} mm", trimmed(metres * 1e3))
}

fn shape(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let plate = Arc::clone(numbers.plate);
    let spec = plate.spec();
    numbers.number(ui, "Length", spec.length_m, &Unit::Length, |spec, value| spec.length_m = value);
    match &spec.taper {
        Taper::Exponential { half_width_m, rate_per_m } => {
            numbers.number(ui, "Half-width", *half_width_m, &Unit::Length, |spec, value| {
                if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                    *half_width_m = value;
                }
            });
            numbers.number(ui, "Taper rate", *rate_per_m, &Unit::Plain("1/m", 1.0), |spec, value| {
                if let Taper::Exponential { rate_per_m, .. } = &mut spec.taper {
                    *rate_per_m = value;
                }
            });
        }
        Taper::Linear { half_width_m, end_half_width_m } => {
            numbers.number(ui, "Half-width", *half_width_m, &Unit::Length, |spec, value| {
                if let Taper::Linear { half_width_m, .. } = &mut spec.taper {
                    *half_width_m = value;
                }
            });
            numbers.number(ui, "at the end", *end_half_width_m, &Unit::Length, |spec, value| {
                if let Taper::Linear { end_half_width_m, .. } = &mut spec.taper {
                    *end_half_width_m = value;
                }
            });
        }
        Taper::Sampled { points } => row(ui, "Half-width", format!("{} points from the file", points.len())),
    }
    numbers
        .number(ui, "Span from", spec.span_start_m, &Unit::Length, |spec, value| spec.span_start_m = value);
    numbers.number(ui, "Span to", spec.span_end_m, &Unit::Length, |spec, value| spec.span_end_m = value);
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
            numbers.number(ui, "Wave speed", *wave_speed_m_per_s, &Unit::Plain("m/s", 1.0), |spec, value| {
                if let Model::Membrane { wave_speed_m_per_s } = &mut spec.model {
                    *wave_speed_m_per_s = value;
                }
            });
        }
        Model::ShearHorizontal { shear_modulus_pa, density_kg_per_m3 } => {
            numbers.number(
                ui,
                "Shear modulus",
                *shear_modulus_pa,
                &Unit::Plain("MPa", 1e6),
                |spec, value| {
                    if let Model::ShearHorizontal { shear_modulus_pa, .. } = &mut spec.model {
                        *shear_modulus_pa = value;
                    }
                },
            );
            numbers.number(ui, "Density", *density_kg_per_m3, &Unit::Plain("kg/m³", 1.0), |spec, value| {
                if let Model::ShearHorizontal { density_kg_per_m3, .. } = &mut spec.model {
                    *density_kg_per_m3 = value;
                }
            });
        }
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => {
            let mut of = |ui: &mut egui::Ui, name, value, unit: Unit, set: fn(&mut Bending, f64)| {
                numbers.number(ui, name, value, &unit, |spec, value| match &mut spec.model {
                    Model::BendingSupported(bending) | Model::BendingClamped(bending) => set(bending, value),
                    _ => {}
                });
            };
            of(ui, "Young's modulus", bending.youngs_modulus_pa, Unit::Plain("GPa", 1e9), |b, v| {
                b.youngs_modulus_pa = v;
            });
            of(ui, "Poisson's ratio", bending.poisson_ratio, Unit::Plain("", 1.0), |b, v| {
                b.poisson_ratio = v;
            });
            of(ui, "Density", bending.density_kg_per_m3, Unit::Plain("kg/m³", 1.0), |b, v| {
                b.density_kg_per_m3 = v;
            });
            of(ui, "Thickness", bending.thickness_m, Unit::Length, |b, v| b.thickness_m = v);
        }
    }
    numbers.number(ui, "Loss factor", spec.loss_factor, &Unit::Plain("", 1.0), |spec, value| {
        spec.loss_factor = value;
    });
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
        numbers.number(ui, "Resistance ratio", *ratio, &Unit::Plain("", 1.0), |spec, value| {
            if let DriveEnd::Resistance { ratio, .. } = &mut spec.drive_end {
                *ratio = value;
            }
        });
    }
    numbers.number(ui, "At full scale", spec.full_scale_m, &Unit::Length, |spec, value| {
        spec.full_scale_m = value;
    });
}

fn table(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    use crate::app::TableState;
    let palette = theme::palette(ui);
    match scene.table {
        TableState::Waiting => row(ui, "Table", "made once a device tells its rate"),
        TableState::Making => row(ui, "Table", "being made…"),
        TableState::Cancelled => {
            row(ui, "Table", "given up");
            if ui.button("Make the table").clicked() {
                intents.push(Intent::MakeTable);
            }
        }
        TableState::Failed(reason) => {
            ui.label(RichText::new(reason).small().color(palette.wrong));
        }
        TableState::Ready(made) => {
            let table = &made.drive_table;
            row(ui, "Table", format!("{} knots, {:.0} kS/s", table.knots.len(), table.sample_rate_hz * 1e-3));
            row(ui, "Peak at level 1", show_length(table.peak_at_full_scale_m));
            row(ui, "Levelled out", format!("{:.1} dB of swing", table.swing_without_gain_db));
            row(ui, "Left between knots", format!("{:.2} dB", table.worst_error_db));
            if let Some(decibel) = made.sensitivity_db {
                let colour = if decibel > 3.0 { palette.warn } else { palette.text };
                row(ui, "If waves are 1 % faster", RichText::new(format!("±{decibel:.2} dB")).color(colour));
                if decibel > 3.0 {
                    let text = "This end resonates: the table holds only while the plate stays as measured. A damped source cures it.";
                    ui.label(RichText::new(text).small().color(palette.warn));
                }
            }
            if table.knots_without_peak > 0 {
                let (start, end) = (table.span_start_m, table.span_end_m);
                let places = table.knots.iter().filter(|knot| !knot.peak_present).map(|knot| knot.position_m);
                let (low, high) = places.fold((end, start), |(low, high), x| (low.min(x), high.max(x)));
                let text = format!(
                    "No peak stands from {} to {}: the loss is too high.",
                    show_place(low),
                    show_place(high)
                );
                ui.label(RichText::new(text).small().color(palette.warn));
            }
        }
    }
}

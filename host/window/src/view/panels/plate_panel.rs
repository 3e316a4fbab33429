//! The plate panel: the plate, its numbers and its table; the validity lights; the designer.

mod air;
mod cards;
mod numbers;

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::bars::tour;
use crate::view::fields::field::row;
use crate::view::panels::{designer, measure_panel, plane_check, validity};
use crate::view::state::{PlatePage, ViewState};
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_instrument::TourStep;
use slipline_model::setup::edit::Edit;
use slipline_plate::quantity::{show_frequency, show_length, show_place};
use std::sync::Arc;

const PAGES: [(PlatePage, &str, &str); 4] = [
    (PlatePage::Plate, "This plate", "Which plate it is, and its numbers"),
    (PlatePage::Validity, "Validity", "How reliable plate and boundary are"),
    (PlatePage::Designer, "Designer", "A plate for a band: taper, damper, cut files"),
    (PlatePage::Measure, "Measure", "The measured response, beside the plate's model"),
];

/// The buttons of the pages, which stay while a page is scrolled.
pub(crate) fn pages(ui: &mut egui::Ui, view: &mut ViewState) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 4.0;
        let gaps = 4.0 * (PAGES.len() - 1) as f32;
        let width = ((ui.available_width() - gaps) / PAGES.len() as f32).floor();
        for (page, name, help) in PAGES {
            let text = RichText::new(name).size(12.5);
            let button = egui::Button::selectable(view.plate_page == page, text);
            if ui.add(button.min_size(egui::vec2(width, 24.0))).on_hover_text(help).clicked() {
                view.plate_page = page;
            }
        }
    });
}

/// The open page.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    match view.plate_page {
        PlatePage::Plate => this_plate(ui, scene, view, intents),
        PlatePage::Validity => {
            plane_check::show(ui, scene, intents);
            validity::show(ui, scene, view);
        }
        PlatePage::Designer => designer::show(ui, scene, view, intents),
        PlatePage::Measure => measure_panel::show(ui, scene, view, intents),
    }
}

fn this_plate(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let plate = &scene.setup.plate;
    presets(ui, scene, intents);
    ui.label(RichText::new(&plate.spec().description).small().color(palette.weak));
    ui.add_space(4.0);
    ui.separator();
    numbers::show(ui, plate, view, intents);
    air::show(ui, &mut numbers::Numbers { plate, view, intents });
    ui.separator();
    theme::heading(ui, "What follows");
    let (low, high) = plate.band_hz();
    row(ui, "Turning width", plate.spec().turning_width.words().to_owned());
    row(ui, "Cut-off", show_frequency(plate.cut_off_hz()));
    row(ui, "Band", format!("{} to {}", show_frequency(low), show_frequency(high)));
    table(ui, scene, intents);
}

fn presets(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let plate = &scene.setup.plate;
    let name = plate.name();
    let response = egui::ComboBox::from_id_salt("preset")
        .selected_text(name)
        .truncate()
        .width(ui.available_width() - 8.0)
        .height(420.0)
        .show_ui(ui, |ui| {
            for card in cards::all() {
                let is_this = card.plate.spec() == plate.spec();
                if card.show(ui, is_this).clicked() && !is_this {
                    intents.push(Intent::Edit(Edit::Plate(Arc::clone(&card.plate))));
                    ui.close();
                }
            }
            ui.separator();
            let file = ui.button("From a file…");
            file.on_hover_text("A plate file, or a setup with its plate").asks(intents, Intent::OpenDialog);
        });
    tour::mark(ui, scene, TourStep::OwnPlate, response.response.rect);
    let label = format!("Plate: {name}");
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
    response
        .response
        .on_hover_text("Choose one of the plates that come with Slipline, or one of your own from a file");
}

fn table(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    use slipline_model::jobs::table::TableState;
    let palette = theme::palette(ui);
    match scene.table {
        TableState::Waiting => {
            row(ui, "Table", "made once a device reports its rate");
        }
        TableState::Making => {
            row(ui, "Table", "being made…");
        }
        TableState::Cancelled => {
            row(ui, "Table", "given up");
            let make = ui.button("Make the table");
            make.on_hover_text("Without it the plate cannot be driven").asks(intents, Intent::MakeTable);
        }
        TableState::Failed(reason) => {
            ui.label(RichText::new(reason).small().color(palette.wrong));
        }
        TableState::Ready(made) => {
            let table = &made.drive_table;
            row(
                ui,
                "Table",
                format!("{} knots, {:.0} kS/s", table.knots().len(), table.sample_rate_hz() * 1e-3),
            );
            row(ui, "Peak at level 1", show_length(table.peak_at_full_scale_m()));
            if let Some(travel) = table.travel() {
                let percent = 100.0 * travel.largest_share;
                row(ui, "Travel at level 1", format!("{percent:.0} % of the peak travel at most"));
                if travel.scale < 1.0 {
                    let text = format!("Lowered by {:.1} dB to keep the peak travel.", travel.lowered_db());
                    ui.label(RichText::new(text).small().color(palette.weak));
                }
            }
            row(ui, "Gain range of the table", format!("{:.1} dB", table.swing_without_gain_db()));
            row(ui, "Error between points", format!("{:.2} dB", table.worst_error_db()));
            if let Some(decibel) = made.sensitivity_db {
                let colour = if decibel > 3.0 { palette.warn } else { palette.text };
                row(ui, "If waves are 1 % faster", RichText::new(format!("±{decibel:.2} dB")).color(colour));
                if decibel > 3.0 {
                    let text = "This end resonates: the table holds only while the plate stays as measured. A damped source cures it.";
                    ui.label(RichText::new(text).small().color(palette.warn));
                }
            }
            if table.knots_without_peak() > 0 {
                let (start, end) = table.span_m();
                let places =
                    table.knots().iter().filter(|knot| !knot.peak_present).map(|knot| knot.position_m);
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

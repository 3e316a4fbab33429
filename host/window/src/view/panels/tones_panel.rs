//! The tones panel: one row per tone, and their sum.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::fields::{
    field::{InputField, UNKNOWN, row},
    place_field::typed_position,
    slider::Quantity,
};
use crate::view::stage;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_model::setup::MAX_TONES;
use slipline_model::setup::edit::Edit;
use slipline_plate::quantity::{show_frequency, show_place};

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let setup = scene.setup;
    let palette = theme::palette(ui);
    let sum = scene.headroom_sum();
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{} of {MAX_TONES} tones", setup.tones.len())).strong().size(15.0));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_free = setup.free_slot().is_some();
            let add = ui.add_enabled(is_free, theme::primary(ui, "Add tone", is_free && sum <= 1.0));
            if add
                .on_hover_text("Add a peak in the widest gap. Double-click the plate to add one there")
                .clicked()
            {
                intents.push(Intent::Edit(Edit::Add { position_m: widest_gap_m(scene) }));
            }
        });
    });
    for tone in &setup.tones {
        let slot = tone.slot;
        let is_selected = slot == scene.selected;
        let stroke = egui::Stroke::new(1.0, if is_selected { palette.accent } else { palette.line });
        egui::Frame::new().stroke(stroke).corner_radius(6).inner_margin(8).show(ui, |ui| {
            ui.push_id(slot, |ui| {
                ui.horizontal(|ui| {
                    let name = stage::handle_name(scene, slot);
                    let number =
                        ui.selectable_label(is_selected, RichText::new(format!("{}", slot + 1)).strong());
                    number.widget_info(|| {
                        egui::WidgetInfo::selected(
                            egui::Role::Button,
                            true,
                            is_selected,
                            format!("Select tone {}", slot + 1),
                        )
                    });
                    let help =
                        format!("{name}: the arrow keys and the page Boundary are for the selected tone");
                    number.on_hover_text(help).asks(intents, Intent::Select(slot));
                    let value = scene.line(slot).map_or(UNKNOWN.to_owned(), |line| show_place(line.place_m));
                    let label = format!("Position of tone {}", slot + 1);
                    let hint = "A place (120 mm) or a frequency (126 Hz, 40 kHz)";
                    let field = InputField::new(&label, &value, hint, 84.0);
                    let taken = field.show(ui, &mut view.fields, |text| typed_position(scene, tone, text));
                    intents.extend(taken.map(|position_m| Intent::Edit(Edit::Move { slot, position_m })));
                    let hertz = setup.plate.frequency_for_boundary_hz(tone.position_m);
                    ui.label(RichText::new(show_frequency(hertz)).color(palette.weak));
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        let remove = ui.add_enabled(setup.tones.len() > 1, egui::Button::new("×"));
                        remove.widget_info(|| {
                            let label = format!("Remove tone {}", slot + 1);
                            egui::WidgetInfo::labeled(egui::Role::Button, true, label)
                        });
                        remove
                            .on_hover_text("Remove this tone")
                            .asks(intents, Intent::Edit(Edit::Remove { slot }));
                    });
                });
                if let Some(what) = scene.line(slot).map(|line| line.holds.words()) {
                    ui.label(RichText::new(what).small().color(palette.weak));
                }
                let name = format!("Level of tone {}", slot + 1);
                let level = |level| Edit::Level { slot, level };
                Quantity::level(name, tone.level, &level).show(ui, setup, &mut view.fields, intents);
            });
        });
    }
    ui.add_space(4.0);
    let colour = if sum > 1.0 { palette.wrong } else { palette.text };
    row(ui, "Sum, of full scale", RichText::new(format!("{:.0} %", sum * 100.0)).color(colour));
    if sum > 1.0 {
        ui.horizontal_wrapped(|ui| {
            let text = "More than the DAC can send: the device refuses it. Lower levels or the master.";
            ui.label(RichText::new(text).small().color(palette.wrong));
            let fit = ui.add(theme::primary(ui, "Make it fit", true));
            if fit.on_hover_text("Lower the master so that the sum fits").clicked() {
                intents.push(Intent::Edit(Edit::Master(setup.fitting_master_db(sum))));
            }
        });
    }
    if let Some(beat_hz) = slowest_beat_hz(scene) {
        let text = format!("Two ultrasonic tones {beat_hz:.0} Hz apart: a finger feels the beat.");
        ui.label(RichText::new(text).small().color(palette.weak));
    }
}

/// The middle of the widest gap between the lines and the ends of where they can be, in metres.
fn widest_gap_m(scene: &Scene<'_>) -> f64 {
    let (start, end) = scene.limits_m;
    let mut places: Vec<f64> = scene.lines.iter().map(|line| line.place_m).collect();
    places.extend([start, end]);
    places.sort_by(f64::total_cmp);
    let widest = places.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    widest.map_or(0.5 * (start + end), |gap| 0.5 * (gap[0] + gap[1]))
}

/// The smallest difference of two ultrasonic tones, if a finger could feel it (below about 1 kHz), in Hz.
fn slowest_beat_hz(scene: &Scene<'_>) -> Option<f64> {
    let plate = &scene.setup.plate;
    let mut pitches: Vec<f64> = scene
        .setup
        .tones
        .iter()
        .filter(|tone| tone.level > 0.0)
        .map(|tone| plate.frequency_for_boundary_hz(tone.position_m))
        .filter(|&hertz| hertz >= slipline_plate::check::sensation::SLIPPERY_FROM_HZ)
        .collect();
    pitches.sort_by(f64::total_cmp);
    let beat = pitches.windows(2).map(|pair| pair[1] - pair[0]).min_by(f64::total_cmp)?;
    (beat < 1000.0).then_some(beat)
}

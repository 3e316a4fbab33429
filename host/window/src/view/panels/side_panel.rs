//! The side panel at the right: shows one of boundary, tones, texture, plate, device and play.

use crate::intent::Intents;
use crate::scene::Scene;
use crate::view::panels::{
    boundary_panel, device_panel, plate_panel, play_panel, texture_panel, tones_panel,
};
use crate::view::state::{Tab, ViewState};
use crate::view::theme;
use eframe::egui::{self, ScrollArea};

/// Width of the panel, in points.
pub(crate) const WIDTH: f32 = 320.0;

const TABS: [(Tab, &str, &str); 6] = [
    (Tab::Boundary, "Boundary", "Where the boundary is, its frequency and level"),
    (Tab::Tones, "Tones", "Up to 16 peaks: add, move, level, remove"),
    (Tab::Texture, "Texture", "Solid areas, painted profiles, stripes and beats"),
    (Tab::Plate, "Plate", "Which plate: preset or file, material, taper, loss"),
    (Tab::Device, "Device", "Port, connection, arming, table, counters"),
    (Tab::Play, "Play", "Compare two setups, record and replay a drag, slow motion"),
];

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 2.0;
        // As wide as their words need, and the rest is shared.
        let font = egui::TextStyle::Button.resolve(ui.style());
        let word = |name: &str| theme::text_width(ui, name, font.clone());
        let words: f32 = TABS.iter().map(|(_, name, _)| word(name)).sum();
        let gaps = 4.0 * (TABS.len() - 1) as f32;
        let more = (ui.available_width() - gaps - words) / TABS.len() as f32;
        let widths = TABS.map(|(_, name, _)| (word(name) + more).floor());
        for ((tab, name, help), width) in TABS.into_iter().zip(widths) {
            let button = egui::Button::selectable(view.tab == tab, name).min_size(egui::vec2(width, 28.0));
            if ui.add(button).on_hover_text(help).clicked() {
                view.tab = tab;
            }
        }
    });
    ui.add_space(6.0);
    ui.separator();
    ui.add_space(4.0);
    if view.tab == Tab::Plate {
        plate_panel::pages(ui, view);
        ui.add_space(4.0);
    }
    // Each page keeps the place to which it was scrolled.
    let area = ScrollArea::vertical().id_salt((view.tab, view.plate_page)).auto_shrink([false, false]);
    area.show(ui, |ui| {
        theme::clear_of_bar(ui);
        match view.tab {
            Tab::Boundary => boundary_panel::show(ui, scene, view, intents),
            Tab::Tones => tones_panel::show(ui, scene, view, intents),
            Tab::Texture => texture_panel::show(ui, scene, view, intents),
            Tab::Plate => plate_panel::show(ui, scene, view, intents),
            Tab::Device => device_panel::show(ui, scene, view, intents),
            Tab::Play => play_panel::show(ui, scene, view, intents),
        }
    });
}

//! The measured responses in the place of the stage, while the page Measure is open and nothing is being measured: Bode (level, phase, what the plate's
//! model leaves), Nyquist.
//!
//! ```text
//! wide:   | level      | Nyquist |     narrow: one of level and residual, phase, Nyquist
//!         | phase      |         |
//!         | residual   |         |
//! ```

mod bode;
mod curves;
pub(crate) mod inks;
mod nyquist;

use crate::scene::Scene;
use crate::view::kept::{ResponsePart, ResponseView};
use crate::view::plots::{
    self,
    frame::{fit, more},
};
use crate::view::stage::aligned;
use bode::Strip;
use curves::Curves;
use eframe::egui::{self, Rect, UiBuilder, pos2};

const PARTS: [(ResponsePart, &str); 3] =
    [(ResponsePart::Level, "Level"), (ResponsePart::Phase, "Phase"), (ResponsePart::Nyquist, "Nyquist")];

/// The least width and height, in points, for all plots at once.
const ALL: egui::Vec2 = egui::vec2(600.0, 300.0);
/// The share of the width that is Bode's.
const BODE: f32 = 0.62;
/// Space between two plots, in points.
const GAP: f32 = 10.0;
const NAME: &str = "Measured response";

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, response: &mut ResponseView) {
    let room = ui.available_size();
    let is_wide = room.x >= ALL.x && room.y >= ALL.y;
    let is_reset = aligned::headed(ui, NAME, |ui| {
        if !is_wide {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.spacing_mut().button_padding.x = 5.0;
            for (part, name) in PARTS {
                let label = ui.selectable_label(response.chosen == part, name);
                if label.on_hover_text("Show this of the response; a larger window shows all").clicked() {
                    response.chosen = part;
                }
            }
        }
        more(ui, NAME, "Show all again, and the scale of the frequencies", |ui| {
            let is_reset = fit(ui, NAME);
            let mut is_logarithmic = !response.is_linear;
            ui.checkbox(&mut is_logarithmic, "Logarithmic frequency").on_hover_text(plots::LOGARITHMIC_HELP);
            response.is_linear = !is_logarithmic;
            is_reset
        })
    });
    let Some(curves) = Curves::of(scene, response.is_linear) else {
        return plots::empty(ui, "All measurements are hidden");
    };
    let area = ui.available_rect_before_wrap();
    let (bode, nyquist) = if is_wide {
        let x = (area.left() + BODE * area.width()).floor();
        let strips = [(Strip::Level, 0.44), (Strip::Phase, 0.28), (Strip::Residual, 0.28)];
        (
            Some((Rect::from_min_max(area.min, pos2(x - GAP, area.bottom())), strips.to_vec())),
            Some(Rect::from_min_max(pos2(x + GAP, area.top()), area.max)),
        )
    } else {
        match response.chosen {
            ResponsePart::Level => (Some((area, vec![(Strip::Level, 0.65), (Strip::Residual, 0.35)])), None),
            ResponsePart::Phase => (Some((area, vec![(Strip::Phase, 1.0)])), None),
            ResponsePart::Nyquist => (None, Some(area)),
        }
    };
    if let Some((area, strips)) = bode {
        let last = strips.len() - 1;
        let free = area.height() - GAP * last as f32;
        let mut top = area.top();
        for (i, (strip, share)) in strips.into_iter().enumerate() {
            let bottom = top + share * free;
            let rect = Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), bottom.floor()));
            within(ui, rect, |ui| bode::show(ui, &curves, strip, i == last, is_reset));
            top = bottom + GAP;
        }
    }
    if let Some(rect) = nyquist {
        within(ui, rect, |ui| nyquist::show(ui, &curves, is_reset, &mut response.aspect));
    }
    ui.allocate_rect(area, egui::Sense::hover());
}

/// Shows a plot in a rectangle of its own.
fn within(ui: &mut egui::Ui, rect: Rect, add: impl FnOnce(&mut egui::Ui)) {
    let mut cell =
        ui.new_child(UiBuilder::new().max_rect(rect).id_salt((rect.min.x as i32, rect.min.y as i32)));
    cell.shrink_clip_rect(rect.expand(4.0));
    add(&mut cell);
}

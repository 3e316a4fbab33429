//! The tour's card, in the place of the plots, and the ring around the real control that its step is about.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{self, CornerRadius, Id, LayerId, Order, Rect, RichText, Stroke, StrokeKind};
use slipline_instrument::{TourScene, TourStep};

/// Height of the card, in points: a row for the title, two for the sentence, one for the buttons.
pub(crate) const HEIGHT: f32 = 120.0;
/// Space between a control and its ring, and the ring's width, in points.
const AROUND: f32 = 4.0;
const RING: f32 = 2.5;

/// Shows the card of the present step.
pub(crate) fn show(ui: &mut egui::Ui, tour: TourScene, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let TourScene { step, is_done } = tour;
    let is_last = step.number() == TourStep::ALL.len();
    ui.horizontal(|ui| {
        let of = format!("{} of {}", step.number(), TourStep::ALL.len());
        ui.label(RichText::new(format!("Tour: {}", lower(step.title()))).strong().size(theme::HEADING));
        ui.label(RichText::new(of).color(palette.weak));
        if is_done {
            ui.label(RichText::new("Done").color(palette.good));
        }
    });
    // Two rows, whatever the sentence needs, so that the buttons keep their places.
    let rows = 2.0 * ui.text_style_height(&egui::TextStyle::Body) + 2.0;
    ui.allocate_ui(egui::vec2(ui.available_width(), rows), |ui| {
        ui.set_min_height(rows);
        ui.add(egui::Label::new(step.sentence()).wrap());
    });
    ui.horizontal(|ui| {
        let next = theme::primary(ui, if is_last { "Finish" } else { "Next" }, is_done);
        let help = if is_last { "End the tour; what you did stays" } else { "The next step, done or not" };
        ui.add(next).on_hover_text(help).asks(intents, Intent::NextStep);
        let back = ui.add_enabled(step.number() > 1, egui::Button::new("Back"));
        back.on_hover_text("The step before").asks(intents, Intent::StepBack);
        ui.button("End tour")
            .on_hover_text("Put this card away; Help begins the tour again")
            .asks(intents, Intent::EndTour);
    });
}

/// A title within a sentence.
fn lower(title: &str) -> String {
    let mut letters = title.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// Rings the control at `rect` while the tour is at its step.
pub(crate) fn mark(ui: &egui::Ui, scene: &Scene<'_>, step: TourStep, rect: Rect) {
    if scene.tour.is_none_or(|tour| tour.step != step || tour.is_done) || scene.dialog.is_some() {
        return;
    }
    // Above its neighbours, and no farther than the area that may be scrolled.
    let layer = LayerId::new(Order::Middle, Id::unique("tour"));
    let painter = ui.ctx().layer_painter(layer).with_clip_rect(ui.clip_rect().expand(AROUND + RING));
    let stroke = Stroke::new(RING, theme::palette(ui).accent);
    painter.rect_stroke(rect.expand(AROUND), CornerRadius::same(6), stroke, StrokeKind::Outside);
}

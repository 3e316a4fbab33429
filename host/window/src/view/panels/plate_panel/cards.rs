//! The presets as cards: the plate's outline, its name, its band and edge, and what its lights say.

use crate::view::panels::validity;
use crate::view::theme;
use eframe::egui::{
    self, CornerRadius, FontId, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, pos2, text::LayoutJob, vec2,
};
use slipline_instrument::concern;
use slipline_plate::Plate;
use slipline_plate::quantity::{show_frequency, show_length};
use std::sync::{Arc, LazyLock};

/// Places of the outline along the plate.
const PLACES: usize = 24;
/// Space in a card, size of the drawing, height of the numbers, and the most rows of its description, in points and rows.
const INSET: f32 = 6.0;
const DRAWING: egui::Vec2 = vec2(72.0, 30.0);
const NUMBERS: f32 = 15.0;
const ROWS: usize = 4;

/// A preset, as its card shows it.
pub(super) struct Card {
    pub(super) plate: Arc<Plate>,
    name: &'static str,
    /// Half-widths over the largest, from the driven end on.
    outline: Vec<f32>,
    numbers: String,
}

/// All presets, made when they are shown first.
pub(super) fn all() -> &'static [Card] {
    static CARDS: LazyLock<Vec<Card>> = LazyLock::new(|| {
        let presets = slipline_plate::presets().iter();
        presets.filter_map(|preset| Some(Card::of(preset.name, preset.plate()?))).collect()
    });
    &CARDS
}

impl Card {
    fn of(name: &'static str, plate: Plate) -> Self {
        let half_m = |place: usize| plate.half_width_m(plate.length_m() * place as f64 / (PLACES - 1) as f64);
        let outline = (0..PLACES).map(|place| (half_m(place) / half_m(0)) as f32).collect();
        let (low_hz, high_hz) = plate.band_hz();
        let edge = plate
            .edge_width_m(0.5 * (low_hz + high_hz))
            .map_or_else(String::new, |edge_m| format!(", edge {}", show_length(edge_m)));
        let numbers = format!("{} to {}{edge}", show_frequency(low_hz), show_frequency(high_hz));
        Self { plate: Arc::new(plate), name, outline, numbers }
    }

    /// Shows it; `is_this` marks the plate on the screen.
    pub(super) fn show(&self, ui: &mut egui::Ui, is_this: bool) -> egui::Response {
        let palette = theme::palette(ui);
        let width = ui.available_width();
        let mut words = LayoutJob::simple(
            self.plate.spec().description.clone(),
            FontId::proportional(12.0),
            palette.weak,
            width - 2.0 * INSET,
        );
        words.wrap.max_rows = ROWS;
        let words = ui.painter().layout_job(words);
        let size = vec2(width, DRAWING.y + NUMBERS + words.size().y + 3.0 * INSET);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_this, self.name));
        let is_hot = response.hovered() || response.has_focus();
        let rim = if is_this || is_hot { palette.accent } else { palette.line };
        let stroke = Stroke::new(if is_hot { 2.0 } else { 1.0 }, rim);
        ui.painter().rect(rect, CornerRadius::same(5), palette.panel, stroke, StrokeKind::Inside);
        let inside = rect.shrink(INSET);
        self.draw(ui, Rect::from_min_size(inside.min, DRAWING));
        let left = inside.left() + DRAWING.x + INSET;
        let text = |at: Pos2, text: &str, size: f32, ink| {
            ui.painter().text(at, egui::Align2::LEFT_TOP, text, FontId::proportional(size), ink);
        };
        text(pos2(left, inside.top() + 7.0), self.name, 13.5, palette.text);
        // Below the drawing, where they have the whole width.
        text(pos2(inside.left(), inside.top() + DRAWING.y + 1.0), &self.numbers, 12.0, palette.weak);
        let lights = concern::of_preset(self.name);
        let at = pos2(inside.right() - 6.0, inside.top() + 15.0);
        validity::mark(ui.painter(), at, lights, validity::ink(lights, palette));
        let below = inside.top() + DRAWING.y + NUMBERS + INSET;
        ui.painter().galley(pos2(inside.left(), below), words, palette.weak);
        // Whole: the card has room for its first rows.
        response.on_hover_text(self.plate.spec().description.as_str())
    }

    fn draw(&self, ui: &egui::Ui, rect: Rect) {
        let palette = theme::palette(ui);
        let edge = |side: f32| {
            let last = (self.outline.len() - 1) as f32;
            self.outline.iter().enumerate().map(move |(place, half)| {
                let x = rect.left() + place as f32 / last * rect.width();
                pos2(x, rect.center().y + side * half * 0.5 * rect.height())
            })
        };
        let outline: Vec<Pos2> = edge(-1.0).chain(edge(1.0).rev()).collect();
        ui.painter().add(Shape::closed_line(outline, Stroke::new(1.2, palette.weak)));
    }
}

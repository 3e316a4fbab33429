//! The scenes to start from: a card each, with a small picture of its envelope on the plate and of what is felt.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::stage::felt_strip;
use crate::view::theme;
use eframe::egui::{
    self, CornerRadius, FontId, Mesh, Pos2, Rangef, Rect, RichText, Sense, Shape, Stroke, StrokeKind, pos2,
    vec2,
};
use slipline_model::scenes::{SCENES, Thumbnail};

/// Least width of a card, and its height, in points.
const WIDTH: f32 = 180.0;
const HEIGHT: f32 = 132.0;
/// Space in a card, and between two, in points.
const INSET: f32 = 8.0;
/// Heights of the plate, of the envelope and of the strip in a card, in points.
const ROWS: [f32; 3] = [22.0, 26.0, 7.0];

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    ui.heading("Scenes");
    ui.label("Setups to start from. Undo brings the present one back.");
    ui.add_space(6.0);
    let columns = (((ui.available_width() + INSET) / (WIDTH + INSET)).floor() as usize).max(1);
    let width = (ui.available_width() - INSET * (columns - 1) as f32) / columns as f32;
    for (row, scenes) in SCENES.chunks(columns).enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = INSET;
            for (column, offered) in scenes.iter().enumerate() {
                let number = row * columns + column;
                let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::click());
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, offered.name));
                let is_hot = response.hovered() || response.has_focus();
                card(ui, rect, is_hot, offered.name, offered.description, scene.thumbnails.get(number));
                response.on_hover_text(offered.description).asks(intents, Intent::StartScene(number));
            }
        });
        ui.add_space(INSET);
    }
}

fn card(ui: &egui::Ui, rect: Rect, is_hot: bool, name: &str, description: &str, picture: Option<&Thumbnail>) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(rect);
    let line =
        Stroke::new(if is_hot { 2.0 } else { 1.0 }, if is_hot { palette.accent } else { palette.line });
    painter.rect(rect, CornerRadius::same(6), palette.panel, line, StrokeKind::Inside);
    let inside = rect.shrink(INSET);
    let mut top = inside.top();
    let rows = ROWS.map(|height| {
        let row = Rect::from_x_y_ranges(inside.x_range(), Rangef::new(top, top + height));
        top += height + 2.0;
        row
    });
    if let Some(picture) = picture {
        draw(&painter, palette, rows, picture);
    }
    let name = painter.layout_no_wrap(name.to_owned(), FontId::proportional(13.5), palette.text);
    painter.galley(pos2(inside.left(), top), name.clone(), palette.text);
    top += name.size().y;
    let words = RichText::new(description).size(11.0).color(palette.weak);
    let font = FontId::proportional(11.0);
    let words = painter.layout(words.text().to_owned(), font, palette.weak, inside.width());
    painter.galley(pos2(inside.left(), top), words, palette.weak);
}

/// The plate's outline, the envelope and the strip of what is felt, over one axis.
fn draw(painter: &egui::Painter, palette: &theme::Palette, rows: [Rect; 3], picture: &Thumbnail) {
    let [plate, envelope, strip] = rows;
    let last = picture.height.len().saturating_sub(1).max(1) as f32;
    let x = |place: usize| plate.left() + place as f32 / last * plate.width();
    let edge = |side: f32| -> Vec<Pos2> {
        let half = picture.half_width.iter().map(|half| side * half * 0.5 * plate.height());
        half.enumerate().map(|(place, half)| pos2(x(place), plate.center().y + half)).collect()
    };
    for side in [-1.0, 1.0] {
        painter.add(Shape::line(edge(side), Stroke::new(1.0, palette.weak)));
    }
    let mut mesh = Mesh::default();
    for (place, height) in picture.height.iter().enumerate() {
        let top = envelope.bottom() - height * envelope.height();
        mesh.colored_vertex(pos2(x(place), top), palette.accent.gamma_multiply(0.5));
        mesh.colored_vertex(pos2(x(place), envelope.bottom()), palette.accent.gamma_multiply(0.5));
    }
    for place in 0..picture.height.len().saturating_sub(1) as u32 {
        mesh.add_triangle(2 * place, 2 * place + 1, 2 * place + 2);
        mesh.add_triangle(2 * place + 1, 2 * place + 2, 2 * place + 3);
    }
    painter.add(Shape::mesh(mesh));
    for (place, zone) in picture.zones.iter().enumerate() {
        // Cells overlap by half a point, so that none shows a seam.
        let half = 0.5 * plate.width() / last + 0.5;
        let across = Rangef::new(x(place) - half, x(place) + half);
        let cell = Rect::from_x_y_ranges(across, strip.y_range()).intersect(strip);
        painter.rect_filled(cell, 0.0, felt_strip::colour(*zone, palette));
    }
    painter.rect_stroke(strip, 1.0, Stroke::new(1.0, palette.line), StrokeKind::Outside);
}

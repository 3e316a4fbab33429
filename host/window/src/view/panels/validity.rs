//! The validity lights: a summary that is always visible, and the list with a sentence for each light.

use crate::scene::Scene;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{
    self, Color32, CornerRadius, FontId, Pos2, Rect, RichText, Sense, Shape, Stroke, pos2, vec2,
};
use slipline_instrument::concern::Concern;
use slipline_plate::check::Light;
use slipline_plate::quantity::{show_frequency, show_place};
use theme::Palette;

/// Half the size of a light's symbol, in points.
const MARK: f32 = 4.5;

pub(crate) fn ink(concern: impl Into<Concern>, palette: &Palette) -> Color32 {
    match concern.into() {
        Concern::Unchecked | Concern::Note => palette.weak,
        Concern::Green => palette.good,
        Concern::Amber => palette.warn,
        Concern::Red => palette.wrong,
    }
}

/// The symbol of a concern: a ring, a dot, a short bar, a triangle or a square. The shape serves users who cannot distinguish
/// the colours.
pub(crate) fn mark(painter: &egui::Painter, centre: Pos2, concern: impl Into<Concern>, fill: Color32) {
    match concern.into() {
        Concern::Unchecked => {
            painter.circle_stroke(centre, MARK - 0.75, Stroke::new(1.5, fill));
        }
        Concern::Green => {
            painter.circle_filled(centre, MARK, fill);
        }
        Concern::Note => {
            painter.rect_filled(Rect::from_center_size(centre, vec2(2.0 * MARK, 3.0)), 1.5, fill);
        }
        Concern::Amber => {
            let corners = [vec2(0.0, -MARK - 0.5), vec2(MARK + 0.8, MARK), vec2(-MARK - 0.8, MARK)];
            let corners = corners.map(|corner| centre + corner).to_vec();
            painter.add(Shape::convex_polygon(corners, fill, Stroke::NONE));
        }
        Concern::Red => {
            painter.rect_filled(Rect::from_center_size(centre, vec2(2.0 * MARK, 2.0 * MARK)), 0.0, fill);
        }
    }
}

/// The worst concern and the text of the summary.
fn summary(scene: &Scene<'_>) -> (Option<Concern>, String) {
    if scene.background.checks.newest().is_none() {
        return (None, "checking".to_owned());
    }
    scene
        .concerns()
        .map_or((None, "not checked".to_owned()), |concerns| (Some(concerns.worst()), concerns.summary()))
}

const CHIP_FONT: FontId = FontId::proportional(12.5);

/// A long summary: the box is no narrower for a shorter one, so that it does not move with what is pressed.
const USUAL: &str = "8 red, 8 amber";

/// Width of the summary's box, in points.
pub(crate) fn chip_width(ui: &egui::Ui, scene: &Scene<'_>) -> f32 {
    let width = |text: &str| theme::text_width(ui, text, CHIP_FONT);
    width(&summary(scene).1).max(width(USUAL)) + 32.0
}

/// The summary in a small box; returns whether it was pressed.
pub(crate) fn chip(ui: &mut egui::Ui, scene: &Scene<'_>) -> bool {
    let palette = theme::palette(ui);
    let (worst, text) = summary(scene);
    let colour = worst.map_or(palette.weak, |worst| ink(worst, palette));
    let galley = ui.painter().layout_no_wrap(text.clone(), CHIP_FONT, colour);
    let (rect, response) = ui.allocate_exact_size(vec2(chip_width(ui, scene), 24.0), Sense::click());
    let name = format!("Validity: {text}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let painter = ui.painter();
    let faint = colour.gamma_multiply(if response.hovered() { 0.2 } else { 0.1 });
    let rim = if response.has_focus() {
        Stroke::new(2.0, palette.accent)
    } else {
        Stroke::new(1.0, colour.gamma_multiply(0.5))
    };
    painter.rect(rect, CornerRadius::same(12), faint, rim, egui::StrokeKind::Inside);
    if let Some(worst) = worst {
        mark(painter, rect.left_center() + vec2(13.0, 0.0), worst, colour);
    }
    painter.galley(pos2(rect.left() + 22.0, rect.center().y - 0.5 * galley.size().y), galley, colour);
    response.on_hover_text("How reliable this plate and boundary are: press for the reasons").clicked()
}

/// The name of a light, as the beginning of a line.
pub(crate) fn title(light: &Light) -> String {
    let mut name = light.name.to_owned();
    if let Some(first) = name.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    name
}

/// The list.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState) {
    let palette = theme::palette(ui);
    let Some(checked) = scene.background.checks.newest() else {
        ui.label(RichText::new("Being checked…").color(palette.weak));
        return;
    };
    let job = &checked.job;
    let frequency_hz = job.plate.frequency_for_boundary_hz(job.boundary_m);
    ui.horizontal(|ui| {
        let text = format!("Turning point {}, {}", show_place(job.boundary_m), show_frequency(frequency_hz));
        ui.label(RichText::new(text).strong());
        if scene.background.checks.current().is_none() {
            ui.label(RichText::new("being checked…").small().color(palette.weak));
        }
    });
    ui.add_space(4.0);
    match &checked.report {
        Err(reason) => {
            ui.label(RichText::new(reason.to_string()).color(palette.warn));
        }
        Ok(report) => {
            if let Some(known) = report.known() {
                let text = format!("By its calibration {known}.");
                ui.add(egui::Label::new(RichText::new(text).color(palette.weak)).wrap());
                ui.add_space(4.0);
            }
            for (concern, shown) in scene.concerns().into_iter().flat_map(|concerns| concerns.lights) {
                let behind = ui.painter().add(Shape::Noop);
                let row = ui.scope(|ui| light(ui, shown, concern, palette)).response.rect;
                if view.pressed_light == Some(shown.name) && concern > Concern::Green {
                    let fill = palette.accent.gamma_multiply(0.14);
                    ui.painter().set(behind, Shape::rect_filled(row.expand(3.0), 4.0, fill));
                    if std::mem::take(&mut view.scrolls_to_light) {
                        ui.scroll_to_rect(row, None);
                    }
                }
                ui.add_space(6.0);
            }
        }
    }
}

fn light(ui: &mut egui::Ui, light: &Light, concern: Concern, palette: &Palette) {
    const INDENT: f32 = 20.0;
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.horizontal(|ui| {
        ui.spacing_mut().interact_size.y = 18.0;
        let (rect, _) =
            ui.allocate_exact_size(vec2(INDENT - ui.spacing().item_spacing.x, 18.0), Sense::hover());
        let ink = ink(concern, palette);
        mark(ui.painter(), rect.left_center() + vec2(MARK + 1.0, 0.0), concern, ink);
        ui.label(title(light));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let label = ui.label(RichText::new(concern.name()).small().color(ink));
            let said = format!("{}: {}", light.name, concern.name());
            label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
        });
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().interact_size.y = 10.0;
        ui.add_space(INDENT);
        ui.add(egui::Label::new(RichText::new(&light.sentence).small().color(palette.weak)).wrap());
    });
}

//! The designed plate on the stage, before it is loaded: its outline over the present plate, and the turning points of its
//! band.

use crate::axis::Axis;
use crate::scene::{DesignState, Scene};
use crate::view::kept::Sketched;
use crate::view::theme;
use eframe::egui::{
    self, Align2, CornerRadius, FontId, Pos2, Rangef, Rect, Sense, Shape, Stroke, pos2, vec2,
};
use slipline_plate::design::Design;
use slipline_plate::quantity::{show_frequency, show_place};

/// Points of the outline along the plate.
const POINTS: usize = 61;
/// How much of the present plate's colours is covered.
const COVER: f32 = 0.8;
/// Height of the title, in points, and what it begins with.
const TITLE: f32 = 15.0;
const NOT_LOADED: &str = "Design, not loaded";

/// Draws the design in the plate's rectangle, to the scale of the axis, or smaller where it would not fit. Returns whether there
/// is one.
pub(crate) fn show(
    ui: &egui::Ui,
    scene: &Scene<'_>,
    sketched: &mut Sketched,
    axis: &Axis,
    rect: Rect,
) -> bool {
    match &scene.background.design {
        DesignState::Ready(designed) => *sketched = designed.result.as_ref().ok().cloned(),
        DesignState::Making => {}
        DesignState::Closed | DesignState::Cancelled => *sketched = None,
    }
    let Some(design) = sketched.as_deref().filter(|design| design.plate.spec() != scene.setup.plate.spec())
    else {
        return false;
    };
    let palette = theme::palette(ui);
    let plate = &design.plate;
    let screen = axis.screen();
    let across = 0.5 * rect.height() - 16.0;
    let along = axis.points_per_m().min(screen.span() / plate.length_m() as f32);
    // A very wide plate is drawn narrower, as the present one is.
    let scale = along.min(across / plate.cut_half_width_m(0.0) as f32);
    let at = |x_m: f64| screen.min + x_m as f32 * along;
    let half = |x_m: f64| plate.cut_half_width_m(x_m) as f32 * scale;
    let middle = rect.center().y;
    let places = (0..POINTS).map(|i| i as f64 / (POINTS - 1) as f64 * plate.length_m());
    let upper: Vec<Pos2> = places.map(|x_m| pos2(at(x_m), middle - half(x_m))).collect();
    let mut outline = upper.clone();
    outline.extend(upper.iter().rev().map(|corner| pos2(corner.x, 2.0 * middle - corner.y)));
    let painter = ui.painter().with_clip_rect(rect.expand(2.0));
    painter.rect_filled(axis.over_plate(rect), CornerRadius::ZERO, palette.page.gamma_multiply(COVER));
    outline.extend(upper.first());
    painter.extend(Shape::dashed_line(&outline, Stroke::new(1.8, palette.accent), 7.0, 4.0));
    let font = FontId::proportional(11.5);
    let mut before: Option<Rect> = None;
    for (end, align, side) in
        [(&design.low, Align2::RIGHT_BOTTOM, -4.0), (&design.high, Align2::LEFT_BOTTOM, 4.0)]
    {
        let x = at(end.boundary_m);
        let rows = Rangef::new(middle - half(end.boundary_m), rect.bottom());
        painter.vline(x, rows, Stroke::new(1.2, palette.accent));
        let words = format!("{} at {}", show_place(end.boundary_m), show_frequency(end.frequency_hz));
        let galley = painter.layout_no_wrap(words, font.clone(), palette.text);
        let label = align.anchor_size(pos2(x + side, rect.bottom()), galley.size());
        // Beside the plate stands whether it is drawn to scale.
        let left = label.left().min(rect.right() - galley.size().x).max(screen.min);
        let mut place = Rect::from_min_size(pos2(left, label.top()), galley.size());
        if before.is_some_and(|before| before.expand2(vec2(4.0, 0.0)).intersects(place)) {
            place = place.translate(vec2(0.0, -place.height()));
        }
        // In a low plate the second has no room under the title.
        if place.top() >= rect.top() + TITLE {
            painter.galley(place.min, galley, palette.text);
            before = Some(place);
        }
    }
    let words = title(design);
    let place = pos2(screen.min, rect.top());
    let font = FontId::proportional(12.5);
    let whole = painter.layout_no_wrap(words.clone(), font.clone(), palette.accent);
    if whole.size().x <= screen.span() {
        painter.galley(place, whole, palette.accent);
    } else {
        painter.text(place, Align2::LEFT_TOP, NOT_LOADED, font, palette.accent);
    }
    let seen = ui.interact(rect, ui.scope_id().with("design"), Sense::hover());
    seen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    true
}

/// Covers a view of the present plate, which is not that of the drawn one.
pub(crate) fn cover(ui: &egui::Ui, axis: &Axis, rect: Rect, words: &str) {
    let palette = theme::palette(ui);
    let over = axis.over_plate(rect);
    let painter = ui.painter().with_clip_rect(rect.expand(2.0));
    painter.rect_filled(over, CornerRadius::ZERO, palette.page.gamma_multiply(COVER));
    painter.text(over.center(), Align2::CENTER_CENTER, words, FontId::proportional(12.5), palette.weak);
}

/// What is drawn, and that it is not loaded.
fn title(design: &Design) -> String {
    let plate = &design.plate;
    format!("{NOT_LOADED}: {}, {} long", plate.name(), show_place(plate.length_m()))
}

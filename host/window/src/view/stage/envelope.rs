//! The envelope: the largest displacement at each x, predicted by the solver and from the simulated plate.

use crate::axis::Axis;
use crate::scene::Scene;
use crate::view::fields::field::UNKNOWN;
use crate::view::stage::polyline::thinned;
use crate::view::theme;
use eframe::egui::{
    self, Align2, Color32, FontId, Mesh, Pos2, Rangef, Rect, Sense, Shape, Stroke, pos2, vec2,
};
use slipline_model::field::steady_field::{POINTS, displacement_unit};
use slipline_model::setup::BoundaryMode;
use slipline_plate::quantity::show_place;
use slipline_plate::quantity::ticks::Ticks;

/// The share of the ink in points of an earlier drive.
const STALE: f32 = 0.35;

/// Least height of a label with the space to the next, in points.
const LABEL: f32 = 22.0;
/// The least height of an envelope with a legend, in points.
const LEGEND: f32 = 80.0;
/// Space over the top of the scale, in points.
const OVER: f32 = 6.0;

/// The transform from displacement to screen position; 0 is at the bottom.
pub(super) struct Height {
    rect: Rect,
    top_m: f64,
}

impl Height {
    pub(super) fn of(scene: &Scene<'_>, rect: Rect) -> Self {
        Self { rect, top_m: scene.envelope_top_m() }
    }

    pub(super) fn screen(&self, metres: f64) -> f32 {
        let share = (metres / self.top_m).clamp(0.0, 1.0) as f32;
        self.rect.bottom() - share * (self.rect.height() - OVER)
    }

    /// The displacement at a screen position, within the scale.
    pub(super) fn metres(&self, y: f32) -> f64 {
        let share = (self.rect.bottom() - y) / (self.rect.height() - OVER);
        self.top_m * f64::from(share.clamp(0.0, 1.0))
    }
}

/// Shows the envelope in `rect`.
pub(crate) fn show(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, rect: Rect) {
    let palette = theme::palette(ui);
    let predicted = scene.predicted;
    let is_known = scene.full_peak_m.is_some();
    let height = Height::of(scene, rect);
    let top_m = height.top_m;
    scale(ui, axis, &height, is_known);
    factor(ui, scene.magnification, pos2(rect.left(), rect.top() + 13.0));
    let painter = ui.painter().with_clip_rect(rect.expand(1.0));
    let place = |i: usize| axis.screen_from_place(i as f64 / (POINTS - 1) as f64 * axis.length_m());
    let line = |values: &[f64]| -> Vec<Pos2> {
        let at = |(i, &metres): (usize, &f64)| pos2(place(i), height.screen(metres));
        thinned(&values.iter().enumerate().map(at).collect::<Vec<_>>())
    };
    let is_sounding = scene.sounding.is_some();
    let ink = if is_known { palette.accent } else { palette.weak };
    let curve = line(&predicted.drawn_m());
    let fill = ink.gamma_multiply(if is_sounding { 0.22 } else { 0.08 });
    painter.add(area(&curve, rect.bottom(), fill));
    painter.extend(curve_of(scene, &curve, ink));
    if predicted.is_mean() {
        let bound = line(&predicted.bound_m);
        painter.extend(Shape::dashed_line(&bound, Stroke::new(1.2, palette.weak), 3.0, 3.0));
    }
    if let Some(rings) = scene.measured.as_ref().filter(|_| is_known && scene.load.is_none()) {
        for (x_m, metres) in rings.field.points().step_by(2) {
            let centre = pos2(axis.screen_from_place(x_m), height.screen(metres));
            point(&painter, centre, measured_ink(palette, rings.is_current), palette.well);
        }
    }
    for place in scene.measured_places.iter().filter(|_| is_known && scene.load.is_none()) {
        if let Some(metres) = place.amplitude_m(predicted) {
            mark(&painter, pos2(axis.screen_from_place(place.place_m), height.screen(metres)), palette);
        }
    }
    edge(ui, scene, axis, &height);
    // The amplitude from which on the selected tone is felt.
    let tone = scene.setup.tone(scene.selected).filter(|_| is_known);
    let just_felt_m = tone.map_or(f64::INFINITY, |tone| {
        scene.setup.feeling.just_felt_m(scene.setup.plate.frequency_for_boundary_hz(tone.position_m))
    });
    if scene.setup.boundary == BoundaryMode::FeltEdge && just_felt_m < top_m {
        let y = height.screen(just_felt_m);
        let line = [pos2(axis.screen().min, y), pos2(axis.screen().max, y)];
        painter.extend(Shape::dashed_line(&line, Stroke::new(1.0, palette.weak), 5.0, 4.0));
        let place = pos2(axis.screen().max - 4.0, y - 2.0);
        painter.text(place, Align2::RIGHT_BOTTOM, "just felt", FontId::proportional(11.5), palette.weak);
    }
}

/// The predicted curve, here and in the legend: dashed while nothing sounds.
fn curve_of(scene: &Scene<'_>, points: &[Pos2], ink: Color32) -> Vec<Shape> {
    if scene.sounding.is_some() {
        vec![Shape::line(points.to_vec(), Stroke::new(1.8, ink))]
    } else {
        Shape::dashed_line(points, Stroke::new(1.5, ink), 6.0, 4.0)
    }
}

/// The ink of the simulated plate's points: dim while they are those of an earlier drive.
fn measured_ink(palette: &theme::Palette, is_current: bool) -> Color32 {
    if is_current { palette.text } else { palette.text.gamma_multiply(STALE) }
}

/// A ring. Two discs are four triangles from a texture, where a stroke is more than a hundred.
fn point(painter: &egui::Painter, centre: Pos2, ink: Color32, inside: Color32) {
    painter.circle_filled(centre, 2.8, ink);
    painter.circle_filled(centre, 1.6, inside);
}

/// A measured place of a real plate: larger than a ring, because there are few.
fn mark(painter: &egui::Painter, centre: Pos2, palette: &theme::Palette) {
    let corners = [vec2(0.0, -5.5), vec2(5.5, 0.0), vec2(0.0, 5.5), vec2(-5.5, 0.0)].map(|to| centre + to);
    painter.add(Shape::convex_polygon(corners.to_vec(), palette.well, Stroke::new(2.0, palette.text)));
}

fn area(line: &[Pos2], bottom: f32, fill: Color32) -> Shape {
    let mut mesh = Mesh::default();
    for point in line {
        mesh.colored_vertex(*point, fill);
        mesh.colored_vertex(pos2(point.x, bottom), fill);
    }
    for i in 0..line.len().saturating_sub(1) as u32 {
        mesh.add_triangle(2 * i, 2 * i + 1, 2 * i + 2);
        mesh.add_triangle(2 * i + 1, 2 * i + 2, 2 * i + 3);
    }
    Shape::mesh(mesh)
}

fn scale(ui: &egui::Ui, axis: &Axis, height: &Height, is_known: bool) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let font = FontId::proportional(11.5);
    painter.hline(axis.screen(), height.rect.bottom() + 0.5, Stroke::new(1.0, palette.line));
    if !is_known {
        let place = pos2(axis.screen().min - 8.0, height.rect.center().y);
        painter.text(place, Align2::RIGHT_CENTER, UNKNOWN, font, palette.weak);
        return;
    }
    let (unit, unit_m) = displacement_unit(height.top_m);
    let top = height.top_m / unit_m;
    // In a low envelope fewer, so that none lies over its neighbour.
    let count = (height.rect.height() / LABEL).clamp(1.0, 3.5);
    let ticks = Ticks::between(0.0, top, top / f64::from(count));
    for &tick in &ticks.places {
        let y = height.screen(tick * unit_m).round() + 0.5;
        if tick > 0.0 {
            painter.hline(axis.screen(), y, Stroke::new(1.0, palette.grid));
        }
        let place = pos2(axis.screen().min - 8.0, y);
        painter.text(place, Align2::RIGHT_CENTER, ticks.label(tick), font.clone(), palette.weak);
    }
    let left = Rangef::new(height.rect.left(), axis.screen().min);
    let place = pos2(left.min, height.rect.top() - 1.0);
    painter.text(place, Align2::LEFT_TOP, unit, font, palette.weak);
}

/// The factor by which displacements are shown larger than to the table's full scale, where there is one.
fn factor(ui: &egui::Ui, magnification: f64, at: Pos2) {
    if magnification > 1.0 {
        let ink = theme::palette(ui).text;
        let text = format!("×{magnification}");
        ui.painter().text(at, Align2::LEFT_TOP, text, FontId::proportional(12.5), ink);
    }
}

/// The edge of the selected tone: from its peak to a tenth of it, or the absence of a peak.
fn edge(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, height: &Height) {
    let palette = theme::palette(ui);
    let Some(wave) = scene.predicted.tone(scene.selected) else { return };
    let painter = ui.painter();
    let font = FontId::proportional(11.5);
    let Some(peak_m) = wave.peak_position_m else {
        let place = pos2(axis.screen_from_place(wave.turning_point_m) - 8.0, height.rect.top() + 6.0);
        let cause = if scene.load.is_some() { "finger" } else { "loss" };
        let text = format!("no peak: the {cause} leaves none here");
        painter.text(place, Align2::RIGHT_TOP, text, font, palette.warn);
        return;
    };
    let y = height.rect.bottom() - 7.0;
    let range = Rangef::new(
        axis.screen_from_place(peak_m),
        axis.screen_from_place((peak_m + wave.edge_width_m).min(axis.length_m())),
    );
    let stroke = Stroke::new(1.5, palette.text);
    painter.hline(range, y, stroke);
    for x in [range.min, range.max] {
        painter.vline(x, Rangef::new(y - 3.5, y + 3.5), stroke);
    }
    let around = Rect::from_x_y_ranges(range, Rangef::new(y - 6.0, y + 6.0));
    let bracket = ui.interact(around, ui.scope_id().with("edge"), Sense::hover());
    let said = format!("Edge: {}", show_place(wave.edge_width_m));
    bracket.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
    bracket.on_hover_text(
        "From the peak to a tenth of it. The shorter this is, the crisper is the boundary of the selected tone",
    );
}

/// The legend, in an opaque box, so that the boundary lines do not cross its text. It has the upper row from `left_end` on, in
/// points; a low envelope has none, because it would hide the peak.
pub(super) fn legend(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, rect: Rect, left_end: f32) {
    if rect.height() < LEGEND {
        return;
    }
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let box_behind = painter.add(Shape::Noop);
    let font = FontId::proportional(11.5);
    let mut right = axis.screen().max - 6.0;
    let y = rect.top() + 11.0;
    let mut entry = |text: &str, sample: &dyn Fn(f32)| {
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), palette.weak);
        let left = right - galley.size().x;
        // In a narrow window the last entries have no room.
        if left - 24.0 < left_end {
            return;
        }
        painter.galley(pos2(left, y - 0.5 * galley.size().y), galley, palette.weak);
        sample(left - 24.0);
        right = left - 38.0;
    };
    let live = &scene.measure.live;
    if live.is_secret && !live.is_secret_measured {
        entry("hidden test plate: not measured yet", &|_| ());
    } else if let Some(rings) = &scene.measured {
        if scene.load.is_some() {
            entry(&format!("{}: without a finger only", rings.name()), &|_| ());
        } else {
            let before = if rings.is_current { "" } else { ", before" };
            entry(&format!("{}{before}", rings.name()), &|left| {
                let ink = measured_ink(palette, rings.is_current);
                point(painter, pos2(left + 9.0, y), ink, palette.well);
            });
        }
    }
    if !scene.measured_places.is_empty() {
        entry("measured", &|left| mark(painter, pos2(left + 9.0, y), palette));
    }
    if scene.predicted.is_mean() {
        entry("bound of the largest", &|left| {
            let line = [pos2(left, y), pos2(left + 18.0, y)];
            painter.extend(Shape::dashed_line(&line, Stroke::new(1.2, palette.weak), 3.0, 3.0));
        });
    }
    let what = if scene.predicted.is_mean() { "mean of all tones, predicted" } else { "predicted" };
    let touched = if scene.load.is_some() { " with the finger" } else { "" };
    entry(&format!("{what}{touched}"), &|left| {
        painter.extend(curve_of(scene, &[pos2(left, y), pos2(left + 18.0, y)], palette.accent));
    });
    let behind = Rect::from_min_max(pos2(right + 8.0, y - 9.0), pos2(axis.screen().max, y + 9.0));
    painter.set(box_behind, Shape::rect_filled(behind, 4.0, palette.well.gamma_multiply(0.9)));
}

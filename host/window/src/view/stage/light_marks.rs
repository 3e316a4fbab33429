//! The lights that are not green, on the stage: over the plate's x axis each has a bar where it fails, and a symbol beside
//! the boundary line that says what it is and opens its row on the page of lights.

use crate::axis::Axis;
use crate::intent::Intents;
use crate::scene::Scene;
use crate::view::panels::validity;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Rangef, Rect, Sense, Shape, Stroke, pos2, vec2};
use slipline_instrument::concern::Concern;
use slipline_plate::check::{Light, Stretch};
use slipline_plate::order;
use slipline_plate::quantity::show_place;
use std::sync::Arc;
use theme::HANDLE;

/// Height of the middle of the symbols over the envelope, in points: between it and the plate.
const RAISED: f32 = 7.0;
/// Height of a bar, and half the height of the tick of a single place, in points.
const BAR: f32 = 2.0;
const TICK: f32 = 3.0;
/// The least distance of two symbols, in points; where even that has no room, they go to the line's other side.
const TIGHT: f32 = 11.0;
/// The share of the ink in the lights of an earlier boundary.
const STALE: f32 = 0.45;

/// The lights that are not green, from the driven end on.
pub(crate) struct LightMarks<'a> {
    lights: Vec<(Concern, &'a Light)>,
    /// Where their symbols are on the screen, in the same order, in points.
    at: Vec<f32>,
    /// Distance of the symbols, in points.
    gap: f32,
    is_current: bool,
    /// Middle of the symbols, and top of the envelope.
    row: f32,
    axis: Axis,
    views: Rect,
    /// For the stretch of the light under the pointer, behind the lines.
    behind: egui::layers::ShapeIdx,
}

impl<'a> LightMarks<'a> {
    /// Shows bars and symbols over the envelope, whose top is at `top`; `area` is the stage's extent, `views` are plate and
    /// envelope.
    pub(crate) fn show(
        ui: &egui::Ui,
        scene: &'a Scene<'_>,
        view: &mut ViewState,
        axis: &Axis,
        area: Rangef,
        (views, top): (Rect, f32),
    ) -> Self {
        let behind = ui.painter().add(Shape::Noop);
        let (lights, is_current) = failing(scene);
        let line = scene.line(scene.selected).map(|line| axis.line_from_place(line.place_m));
        let wanted: Vec<f32> =
            lights.iter().map(|(_, light)| axis.screen_from_place(middle_m(light))).collect();
        let (at, gap) = beside(line, &wanted, area.shrink(0.5 * HANDLE));
        let mut marks = Self { lights, at, gap, is_current, row: top - RAISED, axis: *axis, views, behind };
        marks.stay(scene, view);
        marks.paint(ui, top);
        marks
    }

    /// While a line is dragged they stand still: their boundary is the one before.
    fn stay(&mut self, scene: &Scene<'_>, view: &mut ViewState) {
        if scene.grab.is_some() && view.marks_m.len() == self.at.len() {
            self.at = view.marks_m.iter().map(|&x_m| self.axis.screen_from_place(x_m)).collect();
        } else {
            view.marks_m = self.at.iter().map(|&x| self.axis.place_from_screen(x)).collect();
        }
    }

    fn paint(&self, ui: &egui::Ui, top: f32) {
        let palette = theme::palette(ui);
        let painter = ui.painter();
        let share = if self.is_current { 1.0 } else { STALE };
        let mut marks: Vec<((Concern, &Light), f32)> =
            self.lights.iter().copied().zip(self.at.iter().copied()).collect();
        // Red over amber over notes.
        order::sort_by_key(&mut marks, |((concern, _), _)| *concern);
        for ((concern, light), x) in marks {
            let ink = validity::ink(concern, palette).gamma_multiply(share);
            for stretch in &light.stretches {
                let range = on_screen(&self.axis, stretch);
                let (bar, half) =
                    if range.span() > BAR { (range, 0.5 * BAR) } else { (range.expand(0.5 * BAR), TICK) };
                let middle = top - 0.5 * BAR;
                painter.rect_filled(Rect::from_x_y_ranges(bar, middle - half..=middle + half), 0.0, ink);
            }
            validity::mark(painter, pos2(x, self.row), concern, ink);
        }
    }

    /// Lets the symbols be pointed at, reached by the Tab key and pressed; returns whether the pointer is on one.
    pub(crate) fn interact(&self, ui: &egui::Ui, view: &mut ViewState, intents: &mut Intents) -> bool {
        let palette = theme::palette(ui);
        let mut is_pointed_at = false;
        for (&(concern, light), &x) in self.lights.iter().zip(&self.at) {
            let rect = Rect::from_center_size(pos2(x, self.row), vec2(self.gap.min(HANDLE), HANDLE));
            let id = ui.scope_id().with(("light", light.name));
            // With a click alone the view under it would take the drag.
            let response = ui.interact(rect, id, Sense::click_and_drag());
            let name = format!("{}, {}, {}", validity::title(light), concern.name(), places(light));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            if response.has_focus() {
                ui.painter().circle_stroke(rect.center(), 9.0, Stroke::new(2.0, palette.accent));
            }
            is_pointed_at |= response.hovered();
            if response.hovered() || response.has_focus() {
                self.point_out(ui, light, validity::ink(concern, palette));
            }
            let is_pressed = response.clicked();
            response.on_hover_text(help(light, concern, self.is_current));
            if is_pressed {
                view.open_light(light.name, intents);
            }
        }
        is_pointed_at
    }

    /// Shows in plate and envelope where this light fails.
    fn point_out(&self, ui: &egui::Ui, light: &Light, ink: egui::Color32) {
        let shape = |stretch| {
            let range = on_screen(&self.axis, stretch);
            let range = if range.span() > BAR { range } else { range.expand(0.5 * BAR) };
            let rect = Rect::from_x_y_ranges(range, self.views.y_range());
            let share = if range.span() > 2.0 * BAR { 0.22 } else { 0.7 };
            Shape::rect_filled(rect, 0.0, ink.gamma_multiply(share))
        };
        ui.painter().set(self.behind, Shape::Vec(light.stretches.iter().map(shape).collect()));
    }
}

/// The lights that are not green and have a place on the plate, from the driven end on, and whether they are those of the boundary on
/// the screen.
fn failing<'a>(scene: &'a Scene<'_>) -> (Vec<(Concern, &'a Light)>, bool) {
    let checks = &scene.background.checks;
    let checked = checks.newest().filter(|checked| Arc::ptr_eq(&checked.job.plate, &scene.setup.plate));
    let (Some(checked), Some(tone)) = (checked, scene.setup.tone(scene.selected)) else {
        return (Vec::new(), true);
    };
    let lights = checked.report.as_ref().map_or(&[][..], |report| &report.lights);
    let failing = lights.iter().filter(|light| !light.stretches.is_empty());
    let mut failing: Vec<_> = failing.map(|light| (scene.concern(light), light)).collect();
    // Lights of the same place keep their order.
    order::sort_by(&mut failing, |(_, a), (_, b)| middle_m(a).total_cmp(&middle_m(b)));
    (failing, checked.job.boundary_m == tone.position_m && checks.current().is_some())
}

fn middle_m(light: &Light) -> f64 {
    light.stretches.first().map_or(0.0, |stretch| stretch.middle_m())
}

fn on_screen(axis: &Axis, stretch: &Stretch) -> Rangef {
    Rangef::new(axis.screen_from_place(stretch.from_m), axis.screen_from_place(stretch.to_m))
}

/// Where a light fails, in words.
fn places(light: &Light) -> String {
    let words = |stretch: &Stretch| match (stretch.from_m, stretch.to_m) {
        (from_m, to_m) if from_m < to_m => format!("{:.1} to {}", from_m * 1e3, show_place(to_m)),
        (0.0, _) => "at the driven end".to_owned(),
        (from_m, _) => format!("at {}", show_place(from_m)),
    };
    light.stretches.iter().map(words).collect::<Vec<_>>().join(", ")
}

/// Name, concern, place, number with its limits, and the sentence with what can be done.
fn help(light: &Light, concern: Concern, is_current: bool) -> String {
    let mut help = format!("{}: {}, {}", validity::title(light), concern.name(), places(light));
    if let Some(number) = light.number() {
        help.push_str(&format!("\n{number}"));
        if let Some(limit) = light.limit {
            help.push_str(&format!("; {}", limit.words(light.unit)));
        }
    }
    help.push_str(&format!("\n{}", light.sentence));
    help.push_str(if is_current { "\nPress for all lights." } else { "\nOf the boundary before." });
    help
}

/// Places for symbols that are wanted at `wanted` (in rising order), none of them over the handle of the line, and their
/// distance: those of places before the line stand on its near side, the others beyond it.
fn beside(line: Option<f32>, wanted: &[f32], room: Rangef) -> (Vec<f32>, f32) {
    let Some(line) = line else { return spread(wanted, room) };
    let sides = [Rangef::new(room.min, line - HANDLE), Rangef::new(line + HANDLE, room.max)];
    let has_room = |side: Rangef, count: usize| count == 0 || side.span() >= TIGHT * (count - 1) as f32;
    // The line is on a pixel, so its own place may be a little beyond it.
    let mut before = wanted.partition_point(|&x| x <= line + 1.0);
    if !has_room(sides[0], before) {
        before = 0;
    } else if !has_room(sides[1], wanted.len() - before) {
        before = wanted.len();
    }
    let (near, far) = wanted.split_at(before);
    let (mut at, near_gap) = spread(near, sides[0]);
    let (beyond, far_gap) = spread(far, sides[1]);
    at.extend(beyond);
    (at, near_gap.min(far_gap))
}

/// Places in `room` that keep their order and a distance, and are as near as can be to those that are wanted: with the
/// distances taken away this is an isotonic regression, which pools neighbours that would overtake each other.
fn spread(wanted: &[f32], room: Rangef) -> (Vec<f32>, f32) {
    let steps = wanted.len().saturating_sub(1) as f32;
    let gap = if steps > 0.0 { HANDLE.min(room.span().max(0.0) / steps) } else { HANDLE };
    // The mean of each pool, and how many are in it.
    let mut pools: Vec<(f32, usize)> = Vec::new();
    for (i, &x) in wanted.iter().enumerate() {
        let mut pool = (x - gap * i as f32, 1);
        while let Some(&(mean, count)) = pools.last().filter(|(mean, _)| *mean > pool.0) {
            let both = count + pool.1;
            pool = ((mean * count as f32 + pool.0 * pool.1 as f32) / both as f32, both);
            pools.pop();
        }
        pools.push(pool);
    }
    let last = (room.max - gap * steps).max(room.min);
    let means = pools.into_iter().flat_map(|(mean, count)| std::iter::repeat_n(mean, count));
    let at = means.enumerate().map(|(i, mean)| mean.clamp(room.min, last) + gap * i as f32);
    (at.collect(), gap)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_stand_where_they_are_wanted_and_make_room_for_each_other() {
        let room = Rangef::new(0.0, 400.0);
        assert_eq!(spread(&[100.0, 200.0], room).0, [100.0, 200.0]);
        assert_eq!(spread(&[100.0, 100.0, 300.0], room).0, [88.0, 112.0, 300.0]);
        assert_eq!(spread(&[0.0, 0.0, 0.0], room).0, [0.0, 24.0, 48.0]);
        assert_eq!(spread(&[390.0, 400.0], room).0, [376.0, 400.0]);
        let (at, gap) = spread(&[5.0; 5], Rangef::new(0.0, 60.0));
        assert_eq!((at, gap), (vec![0.0, 15.0, 30.0, 45.0, 60.0], 15.0));
        assert_eq!(spread(&[], room).0, [0.0; 0]);
    }

    #[test]
    fn no_symbol_stands_on_the_handle_of_the_line() {
        let room = Rangef::new(0.0, 400.0);
        for line in [0.0, 30.0, 120.0, 200.0, 371.0, 400.0] {
            let (at, gap) = beside(Some(line), &[0.0, 150.0, 200.0, 200.0, 260.0], room);
            assert!(at.iter().all(|x| (x - line).abs() >= HANDLE - 0.01), "{line}: {at:?}");
            assert!(at.is_sorted() && at.iter().all(|x| room.contains(*x)), "{line}: {at:?}");
            assert!(gap >= TIGHT, "{line}: {gap}");
        }
        // The boundary's own lights stand before it.
        assert_eq!(beside(Some(200.0), &[200.0], room).0, [176.0]);
    }

    #[test]
    fn a_small_move_of_the_places_is_a_small_move_of_the_symbols() {
        let room = Rangef::new(0.0, 400.0);
        let at = |dx: f32| beside(Some(200.0 + dx), &[0.0, 150.0 + dx, 160.0 + dx, 210.0 + dx], room).0;
        for step in 0..400 {
            let dx = 0.25 * step as f32 - 50.0;
            for (before, after) in at(dx).iter().zip(&at(dx + 0.25)) {
                assert!((after - before).abs() <= 0.25 + 1e-3, "{dx}: {before} {after}");
            }
        }
    }
}

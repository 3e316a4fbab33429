//! The plate from above, to scale, with its wave.

use crate::axis::Axis;
use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::view::fields::field::UNKNOWN;
use crate::view::panels::validity;
use crate::view::stage::{displacement, polyline::thinned, relief};
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Align2, FontId, Galley, Mesh, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};
use slipline_link::protocol::event::State;
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::field::sheet::FieldSource;
use slipline_plate::quantity::show_length;
use std::sync::Arc;
use theme::GAP;

/// Width of a column of the wave's picture, in points.
const COLUMN: f32 = 3.0;
/// Columns of one strip of the picture. In a triangle it is stretched evenly, so a strip must not taper much.
const STRIDE: usize = 4;

/// The least width of the line above the plate for the whole colour scale, in points.
const ROOM_FOR_SCALE: f32 = 720.0;

/// Least width of the plate's name, in points.
const NAME: f32 = 110.0;

/// The line above the plate: the plate's name, the source and slow-motion factor of the wave, the summary of the
/// validity lights, and the colour scale.
pub(crate) fn title(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let palette = theme::palette(ui);
    ui.horizontal_centered(|ui| {
        let look = Scale {
            show_amplitude: scene.settings.show_amplitude,
            is_wide: ui.available_width() >= ROOM_FOR_SCALE,
        };
        let chip = validity::chip_width(ui, scene) + 14.0;
        let mark = ui.spacing().icon_width + ui.spacing().icon_spacing;
        let switches_width =
            SWITCHES.iter().map(|name| button_width(ui, name)).sum::<f32>() + 3.0 * GAP + mark;
        let whole = chip + switches_width + look.size(ui).x + GAP;
        // Without room for the colour scale the switches share a button; the envelope's axis shows the scale's values.
        let has_scale = ui.available_width() >= NAME + whole;
        let right = if has_scale { whole } else { chip + button_width(ui, colours(scene)) + GAP };
        // The name is shortened in favour of the controls at the right; hovering shows all of it.
        let left = vec2((ui.available_width() - right).max(30.0), ui.available_height());
        ui.allocate_ui_with_layout(left, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(left.x);
            let text = egui::RichText::new(drawn(scene)).color(palette.weak);
            let width = theme::text_width(ui, text.text(), FontId::proportional(13.0));
            let beside = if has_scale { width + GAP } else { 0.0 };
            // What a calibration or a file adds to the name is at its end, so the words after it are left out first.
            let font = FontId::proportional(15.0);
            let whole = theme::text_width(ui, scene.setup.plate.name(), font);
            let room = (left.x - beside).max((whole + 4.0).min(left.x - NAME)).max(NAME);
            let name = egui::RichText::new(scene.setup.plate.name()).strong().size(15.0);
            ui.scope(|ui| {
                ui.set_max_width(room.min(left.x));
                ui.add(egui::Label::new(name).truncate());
            });
            if !has_scale {
                // The name needs all the remaining space.
                return;
            }
            let shown = ui.add(egui::Label::new(text).truncate());
            if scene.load.is_some() {
                shown.on_hover_text(
                    "Modal lines: a finger that moves would make another 2-D sheet, which begins at rest",
                );
            } else if let Some(FieldSource::Lines(Some(reason))) = &scene.background.source {
                shown.on_hover_text(format!("Modal lines: {reason}"));
            }
        });
        if validity::chip(ui, scene) {
            view.open_validity(intents);
        }
        if has_scale {
            switches(ui, scene, intents);
        } else {
            // In a narrow line they share one button.
            let name = colours(scene);
            let menu = ui.menu_button(name, |ui| switches(ui, scene, intents));
            menu.response.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("View of the plate: {name}"))
            });
            menu.response.on_hover_text("What the plate's colours mean, and whether it is shown in relief");
        }
        if has_scale {
            look.show(ui, scene);
        }
    });
}

/// The switches of the view: what the colours mean, and whether the plate is shown in relief.
const SWITCHES: [&str; 3] = ["Wave", "Amplitude", "Relief"];

/// The name of what the colours mean.
fn colours(scene: &Scene<'_>) -> &'static str {
    SWITCHES[usize::from(scene.settings.show_amplitude)]
}

fn switches(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let Settings { show_amplitude, show_relief, .. } = *scene.settings;
    let [wave, amplitude, relief] = SWITCHES;
    let wave = ui.selectable_label(!show_amplitude, wave);
    wave.on_hover_text("Colour the plate by where it is now, in slow motion")
        .asks(intents, Intent::ShowAmplitude(false));
    let amplitude = ui.selectable_label(show_amplitude, amplitude);
    amplitude
        .on_hover_text("Colour the plate by how far it moves at most")
        .asks(intents, Intent::ShowAmplitude(true));
    let mut is_relief = show_relief;
    let relief = ui.checkbox(&mut is_relief, relief);
    let help = "Show the displacement as hills and valleys too, seen from the side and much magnified";
    relief.on_hover_text(help).asks(intents, Intent::ShowRelief(is_relief));
}

fn button_width(ui: &egui::Ui, name: &str) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    theme::text_width(ui, name, font) + 2.0 * ui.spacing().button_padding.x
}

/// The meaning of the plate's colours, and the slow-motion factor.
fn drawn(scene: &Scene<'_>) -> String {
    if scene.is_measured_now() {
        return "being measured".to_owned();
    }
    let Some(steady) = scene.sounding else {
        let is_driving = scene.snapshot.drive.status.is_some_and(|status| status.state == State::Driving);
        return if is_driving { "waits for its table" } else { "at rest" }.to_owned();
    };
    let source = match (scene.sheet, scene.load) {
        (Some(_), _) => "2-D sheet",
        (None, Some(_)) => "modal lines, touched",
        (None, None) => "modal lines",
    };
    if scene.settings.show_amplitude {
        return format!("{source}, maximum over time");
    }
    let paused = if scene.settings.animate { "" } else { ", paused" };
    let slower = slow_factor(steady) / scene.settings.speed;
    // Three digits.
    let step = 10f64.powf(slower.log10().floor() - 2.0).max(1.0);
    format!("{source}, 1/{:.0} speed{paused}", (slower / step).round() * step)
}

/// The longest labels at the ends of a wide and of a narrow colour scale.
const FULLEST: [&str; 2] = ["−888.8 µm", "±888.8 µm"];

/// Steps of the colour scale, between which its colours are mixed.
const STEPS: u32 = 32;

/// The colour scale, with the displacements at both ends, or only at the right end if there is little space.
#[derive(Clone, Copy)]
struct Scale {
    show_amplitude: bool,
    is_wide: bool,
}

impl Scale {
    fn bar(self) -> Vec2 {
        vec2(if self.is_wide { 90.0 } else { 40.0 }, 10.0)
    }

    /// The labels at its ends.
    fn ends(self, ui: &egui::Ui, scene: &Scene<'_>) -> [Arc<Galley>; 2] {
        let full =
            scene.full_peak_m.map_or_else(|| UNKNOWN.to_owned(), |_| show_length(scene.full_colour_m()));
        let ends = match (self.show_amplitude, self.is_wide) {
            (true, true) => ["0".to_owned(), full],
            (true, false) => [String::new(), full],
            (false, _) if scene.full_peak_m.is_none() => [String::new(), full],
            (false, true) => [format!("−{full}"), format!("+{full}")],
            (false, false) => [String::new(), format!("±{full}")],
        };
        let ink = theme::palette(ui).weak;
        ends.map(|end| ui.painter().layout_no_wrap(end, FontId::proportional(11.5), ink))
    }

    /// Its size does not depend on what the colours mean or how much they stand for, so that its neighbours keep their
    /// places.
    fn size(self, ui: &egui::Ui) -> Vec2 {
        let longest = FULLEST.map(|end| theme::text_width(ui, end, FontId::proportional(11.5)));
        let ends = if self.is_wide { 2.0 * longest[0] } else { longest[1] };
        vec2(ends + self.bar().x + 12.0, 18.0)
    }

    fn show(self, ui: &mut egui::Ui, scene: &Scene<'_>) {
        let palette = theme::palette(ui);
        let (rect, response) = ui.allocate_exact_size(self.size(ui), egui::Sense::hover());
        let [left, right] = self.ends(ui, scene);
        response.on_hover_text("What full colour stands for");
        let painter = ui.painter();
        let bar = self.bar();
        let centre = pos2(rect.left() + left.size().x + 6.0 + 0.5 * bar.x, rect.center().y);
        let bar_rect = Rect::from_center_size(centre, bar);
        // One mesh: rectangles would each have an edge to be smoothed.
        let mut mesh = Mesh::default();
        for step in 0..=STEPS {
            let share = step as f32 / STEPS as f32;
            let value = if self.show_amplitude { share } else { 2.0 * share - 1.0 };
            let colour = displacement::colour(value, self.show_amplitude, palette);
            let x = bar_rect.left() + bar.x * share;
            mesh.colored_vertex(pos2(x, bar_rect.top()), colour);
            mesh.colored_vertex(pos2(x, bar_rect.bottom()), colour);
        }
        for first in (0..2 * STEPS).step_by(2) {
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
        painter.add(Shape::mesh(mesh));
        painter.galley(pos2(rect.left(), rect.center().y - 0.5 * left.size().y), left, palette.weak);
        let place = pos2(bar_rect.right() + 6.0, rect.center().y - 0.5 * right.size().y);
        painter.galley(place, right, palette.weak);
    }
}

/// Shows the plate in `rect`, aligned with the axis.
pub(crate) fn show(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, rect: Rect) {
    let palette = theme::palette(ui);
    let plate = &scene.setup.plate;
    let screen = axis.screen();
    let columns = ((screen.span() / (STRIDE as f32 * COLUMN)).ceil() as usize).max(1) * STRIDE;
    let half_px = |x_m: f64| plate.half_width_m(x_m) as f32 * axis.points_per_m();
    // A very wide plate is drawn narrower than to scale, so that it does not cover its neighbours.
    let is_relief = scene.settings.show_relief;
    let most = if is_relief { relief::depth(rect) } else { 0.5 * rect.height() - 4.0 };
    let squeeze = most.min(half_px(0.0)) / half_px(0.0);
    let half = |share: f32| half_px(f64::from(share) * axis.length_m()) * squeeze;
    let outline: Vec<Pos2> = (0..=columns)
        .map(|column| column as f32 / columns as f32)
        .map(|share| pos2(screen.min + share * screen.span(), rect.center().y - half(share)))
        .collect();
    let mirrored = |at: &Pos2| pos2(at.x, 2.0 * rect.center().y - at.y);
    if is_relief {
        relief::show(ui, scene, rect, &outline);
    } else {
        let strips = outline.iter().step_by(STRIDE).map(|upper| [*upper, mirrored(upper)]);
        displacement::show(ui, scene, strips, columns);
    }
    let painter = ui.painter();
    let upper = thinned(&outline);
    let lower: Vec<Pos2> = upper.iter().map(mirrored).collect();
    let rim = Stroke::new(1.5, palette.weak);
    // The driven end is a thick bar: this is where the actuator holds the plate.
    let (first, last) = (upper[0], upper[upper.len() - 1]);
    let far = (lower[0], lower[lower.len() - 1]);
    painter.line_segment([last, far.1], rim);
    if !is_relief {
        painter.add(Shape::line(upper, rim));
    }
    painter.add(Shape::line(lower, rim));
    let bar = Rect::from_min_max(first + vec2(-6.0, -1.0), far.0 + vec2(-1.0, 1.0));
    painter.rect_filled(bar, 2.0, palette.weak);
    let squeeze = if is_relief { 0.0 } else { squeeze };
    beside_drive(ui, pos2(bar.left() - 6.0, rect.center().y), squeeze);
}

/// Height of a line of the words beside the driven end, in points.
const BESIDE: f32 = 13.0;

/// What stands at the driven end and whether the width is drawn to scale: in the margin, where it lies over nothing, and about
/// the plate's middle, so that it does not reach the scale of the envelope.
fn beside_drive(ui: &egui::Ui, middle: Pos2, squeeze: f32) {
    let palette = theme::palette(ui);
    let lines: &[&str] =
        if squeeze < 0.999 { &["drive", "width not", "to scale"] } else { &["drive", "to scale"] };
    let top = middle.y - 0.5 * BESIDE * lines.len() as f32;
    for (i, line) in lines.iter().enumerate() {
        let font = FontId::proportional(if i == 0 { 11.5 } else { 10.5 });
        let place = pos2(middle.x, top + BESIDE * i as f32);
        ui.painter().text(place, Align2::RIGHT_TOP, line, font, palette.weak);
    }
}

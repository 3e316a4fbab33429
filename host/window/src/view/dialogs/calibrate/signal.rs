//! What the sensor shows right now, on the pages where it is put in its place.

use crate::intent::{Asks as _, Intent, Intents, MeasureIntent};
use crate::scene::Scene;
use crate::view::fields::lines::lines;
use crate::view::panels::validity;
use crate::view::theme;
use eframe::egui::{self, Rect, Sense, pos2, vec2};

/// The quietest signal that the bar shows, dB of full scale: below a step of the converter.
const FLOOR_DB: f64 = -72.0;
/// Height of the bar, in points.
const HEIGHT: f32 = 8.0;
/// Lines of the longest sentence in a narrow window.
const LINES: usize = 2;

/// The bar and its sentence; nothing if the device has no inputs. Their space does not change with what is shown, so that no
/// button moves under the pointer.
pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    if !scene.snapshot.can_listen() {
        return;
    }
    let palette = theme::palette(ui);
    let signal = scene.measure.live.signal;
    let ink = signal.map_or(palette.weak, |signal| validity::ink(signal.colour(), palette));
    let sentence = signal.map_or("not known yet.".to_owned(), |signal| signal.sentence());
    ui.add_space(4.0);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let share = signal.map_or(0.0, |signal| (1.0 - signal.level_db() / FLOOR_DB).clamp(0.0, 1.0) as f32);
    let filled = Rect::from_min_max(rect.min, pos2(rect.left() + share * rect.width(), rect.bottom()));
    ui.painter().rect_filled(rect, 4.0, palette.weak.gamma_multiply(0.2));
    ui.painter().rect_filled(filled, 4.0, ink);
    let name = format!("Sensor's signal: {sentence}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &name));
    response.on_hover_text("How much of its input the sensor fills now, from -72 to 0 dB");
    lines(ui, format!("The sensor now: {sentence}"), ink, LINES);
    if scene.hold.has_rig {
        let tap = ui.button("Tap the simulated plate");
        tap.on_hover_text("Taps its driven end for half a second, to see the sensor's signal")
            .asks(intents, Intent::Measure(MeasureIntent::Tap));
    }
}

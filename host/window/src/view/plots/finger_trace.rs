//! The trace of the finger: amplitude and friction at the finger, and its speed, over the last seconds. Its lanes share one
//! time axis, whose right end is now.
//!
//! ```text
//!  200 |amplitude     63 µm|
//!    0 |~~~~~~/\_____/~~~~~|
//!    1 |friction       0.45|     from 20 kHz on; below, a finger feels the vibration itself
//!    0 |------\/-----\-----|
//!   50 |speed       35 mm/s|
//!    0 |___/~~~\____/~~~~\_|
//!      4 s ago  illustrative now
//! ```
//! Where a row is too low for this, the words stand left of the lanes, in place of the scales.

use crate::intent::Intents;
use crate::scene::Scene;
use crate::view::kept::PlotsView;
use crate::view::plots;
use crate::view::plots::tabs::{FINGER, FINGER_HELP, headed};
use crate::view::theme;
use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rangef, Rect, Sense, Stroke, pos2, vec2};
use slipline_model::field::felt::Zone;
use slipline_model::field::steady_field::displacement_unit;
use slipline_model::field::touch::{Met, TRACE_S, Trace};
use slipline_plate::quantity::ticks::{label, round_step};

/// Space left of the lanes for the scales, and for the words of low lanes, in points.
const SCALE: f32 = 34.0;
const BESIDE: f32 = 70.0;
/// Space between two lanes, and for the time axis, in points.
const GAP: f32 = 4.0;
const TIME: f32 = 16.0;
/// Height of a line of words, and the least height of a lane with words over its curve, in points.
const WORDS: f32 = 14.0;
const LEAST_LANE: f32 = 35.0;
/// The top of a scale is at least this, so that the noise of a resting finger does not fill its lane.
const LEAST_AMPLITUDE_M: f64 = 1e-9;
const LEAST_SPEED_M_PER_S: f64 = 0.01;

/// Shows the trace in the whole of `ui`.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, plots: &mut PlotsView, intents: &mut Intents) {
    headed(ui, plots, FINGER, |ui, _| plots::pause(ui, scene, FINGER, intents));
    if scene.finger.is_none() && scene.measure.live.so_far.is_none() {
        return plots::empty(ui, "no finger on the plate");
    }
    let Some(latest) = scene.trace.latest().filter(|_| scene.sounding.is_some()) else {
        let is_paused = scene.sounding.is_some() && !scene.settings.animate;
        return if is_paused { plots::empty(ui, "paused") } else { plots::at_rest(ui, scene) };
    };
    let area = ui.available_rect_before_wrap();
    let lanes = lanes(scene.trace);
    let free = area.height() - TIME - GAP * (lanes.len() - 1) as f32;
    let height = (free / lanes.len() as f32).floor().max(WORDS);
    let left = area.left() + if height < LEAST_LANE { BESIDE } else { SCALE };
    let across = Rangef::new(left, area.right().max(left + 1.0));
    let time = Time { across, latest };
    // The values under the pointer are those of that time.
    let pointer =
        ui.rect_contains_pointer(area).then(|| ui.input(|input| input.pointer.hover_pos())).flatten();
    let ago = pointer.map(|pointer| time.ago(pointer.x));
    let shown = ago.map_or(Some(latest), |ago| scene.trace.before(ago));
    for (i, lane) in lanes.iter().enumerate() {
        let top = area.top() + i as f32 * (height + GAP);
        let rect = Rect::from_x_y_ranges(across, Rangef::new(top, top + height));
        lane.show(ui, scene.trace, &time, rect, shown);
    }
    time_axis(ui, &time, area, shown.filter(|_| ago.is_some()));
    ui.allocate_rect(area, Sense::hover());
}

/// The time axis of all lanes.
struct Time<'a> {
    across: Rangef,
    latest: &'a Met,
}

impl Time<'_> {
    fn screen(&self, met: &Met) -> f32 {
        let ago = (self.latest.time_s - met.time_s) / TRACE_S;
        self.across.max - (ago as f32).clamp(0.0, 1.0) * self.across.span()
    }

    /// Seconds before now at a place on the screen.
    fn ago(&self, x: f32) -> f64 {
        f64::from((self.across.max - x) / self.across.span()).clamp(0.0, 1.0) * TRACE_S
    }
}

/// One quantity over time.
struct Lane {
    /// Its names, the longest first.
    names: &'static [&'static str],
    value: fn(&Met) -> Option<f64>,
    /// The top of the scale.
    top: f64,
    /// Whether its curve and its words state how it is felt.
    is_felt: bool,
    /// The unit in which values are written, and that unit in SI units.
    unit: (&'static str, f64),
}

/// The lanes of a trace: friction only if there is some in it.
fn lanes(trace: &Trace) -> Vec<Lane> {
    let most = |value: fn(&Met) -> Option<f64>| trace.iter().filter_map(value).fold(0.0, f64::max);
    let amplitude: fn(&Met) -> Option<f64> = |met| Some(met.amplitude_m);
    let speed: fn(&Met) -> Option<f64> = |met| Some(met.speed_m_per_s);
    let top_m = round_step(most(amplitude).max(LEAST_AMPLITUDE_M));
    let mut lanes = vec![Lane {
        names: &["amplitude"],
        value: amplitude,
        top: top_m,
        is_felt: true,
        unit: displacement_unit(top_m),
    }];
    if trace.iter().any(|met| met.friction.is_some()) {
        let names = &["friction, illustrative", "friction"];
        lanes.push(Lane { names, value: |met| met.friction, top: 1.0, is_felt: false, unit: ("", 1.0) });
    }
    let top = round_step(most(speed).max(LEAST_SPEED_M_PER_S));
    lanes.push(Lane { names: &["speed"], value: speed, top, is_felt: false, unit: ("mm/s", 1e-3) });
    lanes
}

impl Lane {
    /// A value to a hundredth of the scale.
    fn words(&self, value: f64) -> String {
        let (unit, of_si) = self.unit;
        let written = label(value / of_si, 0.01 * self.top / of_si);
        if unit.is_empty() { written } else { format!("{written} {unit}") }
    }

    /// What was met, in words: an amplitude with how it is felt.
    fn words_of(&self, met: &Met) -> String {
        let Some(value) = (self.value)(met) else { return String::new() };
        let zone = if self.is_felt { format!(", {}", Zone::of(met.felt).name()) } else { String::new() };
        self.words(value) + &zone
    }

    /// Paints the lane, with the words for what was met at `shown`.
    fn show(&self, ui: &mut egui::Ui, trace: &Trace, time: &Time<'_>, rect: Rect, shown: Option<&Met>) {
        let palette = theme::palette(ui);
        let font = FontId::proportional(11.5);
        let words = shown.map_or_else(String::new, |met| self.words_of(met));
        let response = ui.interact(rect, ui.scope_id().with(self.names), Sense::hover());
        let said = format!("{}: {words}", self.names[0]);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
        response.on_hover_text(FINGER_HELP);
        let painter = ui.painter();
        painter.rect_filled(rect, 2.0, palette.well);
        painter.hline(rect.x_range(), rect.bottom() - 0.5, Stroke::new(1.0, palette.line));
        let is_low = rect.height() < LEAST_LANE;
        let reach = rect.height() - if is_low { 4.0 } else { WORDS + 2.0 };
        let at = |met: &Met, value: f64| -> Pos2 {
            let share = (value / self.top).clamp(0.0, 1.0) as f32;
            pos2(time.screen(met), rect.bottom() - 1.0 - share * reach)
        };
        let points: Vec<(Option<Pos2>, bool)> = trace
            .iter()
            .map(|met| ((self.value)(met).map(|value| at(met, value)), Zone::of(met.felt) != Zone::Not))
            .collect();
        // Where nothing is felt the curve is weak.
        for pair in points.windows(2) {
            if let [(Some(from), _), (Some(to), is_felt)] = *pair {
                let ink = if is_felt || !self.is_felt { palette.accent } else { palette.weak };
                painter.line_segment([from, to], Stroke::new(1.4, ink));
            }
        }
        if let Some((met, value)) = shown.and_then(|met| Some((met, (self.value)(met)?))) {
            painter.circle_filled(at(met, value), 2.5, palette.accent);
        }
        let text = |at: Pos2, align: Align2, text: &str, ink: Color32| {
            painter.text(at, align, text, font.clone(), ink)
        };
        if is_low {
            let (left, middle) = (rect.left() - BESIDE, rect.center().y);
            text(
                pos2(left, middle + 1.0),
                Align2::LEFT_BOTTOM,
                self.names[self.names.len() - 1],
                palette.weak,
            );
            text(pos2(left, middle - 2.0), Align2::LEFT_TOP, &words, palette.text);
            return;
        }
        let top = self.top / self.unit.1;
        text(rect.left_top() - vec2(5.0, 1.0), Align2::RIGHT_TOP, &label(top, top), palette.weak);
        text(rect.left_bottom() - vec2(5.0, -1.0), Align2::RIGHT_BOTTOM, "0", palette.weak);
        let drawn = text(rect.right_top() - vec2(3.0, 0.0), Align2::RIGHT_TOP, &words, palette.text);
        let room = drawn.left() - 6.0 - rect.left();
        let galley = |name: &&str| painter.layout_no_wrap((*name).to_owned(), font.clone(), palette.weak);
        if let Some(name) = self.names.iter().map(galley).find(|name| name.size().x <= room) {
            painter.galley(rect.left_top() + vec2(4.0, 0.0), name, palette.weak);
        }
    }
}

/// How long ago the ends are, or the time of the values that are shown; and that a finger is illustrative.
fn time_axis(ui: &egui::Ui, time: &Time<'_>, area: Rect, shown: Option<&Met>) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let font = FontId::proportional(11.5);
    let text = |x: f32, align: Align2, text: &str| {
        painter.text(pos2(x, area.bottom()), align, text, font.clone(), palette.weak);
    };
    text(time.across.min, Align2::LEFT_BOTTOM, &format!("{TRACE_S:.0} s ago"));
    text(time.across.max, Align2::RIGHT_BOTTOM, "now");
    let is_low = time.across.min > area.left() + SCALE;
    let (x, align) = if is_low {
        (area.left(), Align2::LEFT_BOTTOM)
    } else {
        (time.across.center() + 8.0, Align2::CENTER_BOTTOM)
    };
    let Some(met) = shown else { return text(x, align, "illustrative") };
    text(x, align, &format!("{:.1} s", time.latest.time_s - met.time_s));
    let x = time.screen(met);
    painter.vline(x, Rangef::new(area.top(), area.bottom() - TIME), Stroke::new(1.0, palette.weak));
}

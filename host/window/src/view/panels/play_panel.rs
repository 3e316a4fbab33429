//! The play panel: two setups to compare, a drag that is recorded and played again, and the time of the wave.

use crate::intent::{Asks as _, Export, Intent, Intents};
use crate::scene::Scene;
use crate::settings::SPEEDS;
use crate::view::fields::{field::row, slider::FreeSlider};
use crate::view::panels::time_line;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::setup::Setup;
use slipline_model::setup::compare::Side;
use slipline_plate::quantity::{self, show_frequency};

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    compare(ui, scene, intents);
    ui.add_space(6.0);
    ui.separator();
    recording(ui, scene, intents);
    ui.add_space(6.0);
    ui.separator();
    time(ui, scene, view, intents);
}

/// A setup in a line: its plate, its tones and the first one's frequency, which is the same wherever its line is drawn.
fn summary(setup: &Setup) -> String {
    let count = setup.tones.len();
    let tones = if count == 1 { "1 tone".to_owned() } else { format!("{count} tones") };
    let frequency = setup.tones.first().map_or_else(String::new, |tone| {
        format!(", {}", show_frequency(setup.plate.frequency_for_boundary_hz(tone.position_m)))
    });
    format!("{}, {tones}{frequency}", setup.plate.name())
}

fn compare(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    theme::heading(ui, "Two setups");
    let here = scene.compare.side();
    for side in [Side::A, Side::B] {
        let is_here = side == here;
        let other = scene.compare.other().filter(|_| !is_here);
        let setup = if is_here { Some(scene.setup) } else { other };
        let words = setup.map_or_else(|| "copy of A".to_owned(), summary);
        let text = format!("{}   {words}", side.letter());
        let size = egui::vec2(ui.available_width(), 28.0);
        let button = egui::Button::selectable(is_here, text).truncate().min_size(size);
        let button = ui.add(button);
        button.widget_info(|| {
            let name = format!("Setup {}: {words}", side.letter());
            egui::WidgetInfo::selected(egui::Role::Button, true, is_here, name)
        });
        let help = "The plate follows at once, if it is driven. Ctrl+B switches; Undo takes it back";
        if button.on_hover_text(help).clicked() && !is_here {
            intents.push(Intent::Switch);
        }
    }
}

/// Widths of the two buttons of a recording, which do not depend on their labels, in points.
const RECORD: f32 = 112.0;
const PLAY: f32 = 86.0;

fn recording(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    theme::heading(ui, "Recorded drag");
    let recorder = scene.recorder;
    let moves = recorder.recording().moves().len();
    let is_playing = recorder.played_s().is_some();
    ui.horizontal(|ui| {
        let is_recording = recorder.is_recording();
        let (word, name, help) = if is_recording {
            ("Stop", "Stop the recording", "Keep what was recorded")
        } else {
            ("Record", "Record", "Record where and when lines are moved; the recording before is replaced")
        };
        let record = theme::primary(ui, word, is_recording || moves == 0);
        let record = ui.add(record.min_size(egui::vec2(RECORD, 0.0)));
        record.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
        record.on_hover_text(help).asks(intents, Intent::Record(!is_recording));
        let word = if is_playing { "Stop" } else { "Play" };
        let play = theme::primary(ui, word, moves > 0 && !is_recording);
        let play = ui.add_enabled(moves > 0, play.min_size(egui::vec2(PLAY, 0.0)));
        play.widget_info(|| {
            let name = if is_playing { "Stop the replay" } else { "Play the recording" };
            egui::WidgetInfo::labeled(egui::Role::Button, moves > 0, name)
        });
        let help =
            "Move the lines as they were dragged. It arms and starts nothing; STOP, Esc and a drag end it";
        play.on_hover_text(help)
            .on_disabled_hover_text("Record or import a drag first")
            .asks(intents, Intent::Play(!is_playing));
        let mut is_looped = recorder.is_looped;
        ui.checkbox(&mut is_looped, "Loop")
            .on_hover_text("Begin again at the end")
            .asks(intents, Intent::Loop(is_looped));
    });
    let length_s = recorder.recording().duration_s();
    let words = match (recorder.is_recording(), recorder.played_s()) {
        (true, _) => format!("recording, {moves} moves, {length_s:.1} s"),
        (false, Some(played_s)) => format!("playing, {played_s:.1} of {length_s:.1} s"),
        (false, None) if moves == 0 => "none yet".to_owned(),
        (false, None) => format!("{moves} moves, {length_s:.1} s"),
    };
    row(ui, "Recording", words);
    time_line::show(ui, scene, intents);
    ui.horizontal(|ui| {
        let help = "A CSV file of time_s, tone and place_m, such as Export writes";
        ui.button("Import…").on_hover_text(help).asks(intents, Intent::OpenDialog);
        let export = ui.add_enabled(moves > 0, egui::Button::new("Export…"));
        export
            .on_hover_text("Write where and when the lines were moved into a CSV file")
            .asks(intents, Intent::Export(Export::Recording));
    });
}

/// Periods of the slowest tone through which the time can be moved.
const PERIODS: f64 = 2.0;

fn time(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let palette = theme::palette(ui);
    theme::heading(ui, "Motion on the screen");
    let speed = scene.settings.speed;
    let slider = FreeSlider {
        name: "Speed",
        help: "Of the usual slow motion; the plate itself is not changed",
        value: speed,
        range: SPEEDS,
        is_logarithmic: true,
        shown: format!("{speed:.2}"),
        allowed: format!("{} to {}", SPEEDS.start(), SPEEDS.end()),
        read: |text| quantity::plain(text, ""),
    };
    intents.extend(slider.show(ui, &mut view.fields).map(Intent::Speed));
    let Some(steady) = scene.sounding else {
        ui.label(RichText::new("At rest there is no time to choose.").small().color(palette.weak));
        return;
    };
    let slowest_hz = steady.tones.iter().map(|wave| wave.tone.frequency_hz).fold(f64::INFINITY, f64::min);
    if !slowest_hz.is_finite() {
        return;
    }
    let span_s = PERIODS / slowest_hz;
    let (unit, scale) = if span_s < 1e-3 { ("µs", 1e6) } else { ("ms", 1e3) };
    let time_s = (scene.wave_time_s / slow_factor(steady)).rem_euclid(span_s);
    let slider = FreeSlider {
        name: "Time",
        help: "Pauses the wave and shows it at this time, through two periods of the slowest tone",
        value: time_s,
        range: 0.0..=span_s,
        is_logarithmic: false,
        shown: format!("{:.2} {unit}", time_s * scale),
        allowed: format!("0 to {:.2} {unit}", span_s * scale),
        read: quantity::short_time_s,
    };
    intents.extend(slider.show(ui, &mut view.fields).map(Intent::Scrub));
}

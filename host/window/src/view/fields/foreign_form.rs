//! The form for what a file of another program does not state: the sensor's place and kind, and the noise.

use crate::intent::{Intent, Intents, MeasureIntent};
use crate::scene::Scene;
use crate::scene::{Asked, AskedContent};
use crate::view::fields::field::refusal;
use crate::view::fields::sensor_fields::{kind, number, place};
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui::{self, Label, RichText};
use slipline_instrument::measured_file::ForeignMetadata;
use slipline_plate::calibrate::SNR;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{Range, plain, show_frequency};

/// Shows the form while a file waits for these values; returns whether one waits.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, typed: &mut Fields, intents: &mut Intents) -> bool {
    let Some(asked) = scene.measure.asked else { return false };
    let palette = theme::palette(ui);
    let mut ask = |intent: MeasureIntent| intents.push(Intent::Measure(intent));
    let wrapped = |ui: &mut egui::Ui, text: RichText| {
        ui.add(Label::new(text).wrap());
    };
    egui::Frame::group(ui.style()).show(ui, |ui| {
        wrapped(ui, RichText::new(&asked.name).strong());
        wrapped(ui, RichText::new(sentence(&asked.content)).small().color(palette.weak));
        ui.add_space(2.0);
        let stated = asked.metadata;
        let mut reason = None;
        ui.horizontal_top(|ui| {
            let field = ("Sensor stood at", "Where it stood, from the driven end (32 mm)", 82.0);
            let at = (stated.place_m, scene.setup.plate.length_m());
            if let Some(place_m) = place(ui, typed, &mut reason, field, at) {
                ask(MeasureIntent::Describe(ForeignMetadata { place_m, ..stated }));
            }
            if let AskedContent::Recording { wav, .. } = &asked.content {
                let shown = asked.channel.to_string();
                let field = ("Channel", "The sensor's channel in the file, from 1", 52.0);
                let of_file = (shown.as_str(), "channel", Range::new(1.0, wav.channels() as f64, ""));
                let read = |text: &str| plain(text, "");
                if let Some(channel) = number(ui, typed, &mut reason, field, of_file, read) {
                    ask(MeasureIntent::Channel(channel.round() as usize));
                }
            } else {
                let field =
                    ("Over the noise, dB", "How far the answers are above the noise: 0 to 140 dB", 52.0);
                let shown = with_decimals(stated.snr_db, 0);
                let of_noise = (shown.as_str(), "signal over noise", SNR);
                let read = |text: &str| plain(text, "dB");
                if let Some(snr_db) = number(ui, typed, &mut reason, field, of_noise, read) {
                    ask(MeasureIntent::Describe(ForeignMetadata { snr_db, ..stated }));
                }
            }
            if let Some(kind) = kind(ui, "It showed", stated.kind) {
                ask(MeasureIntent::Describe(ForeignMetadata { kind: Some(kind), ..stated }));
            }
        });
        refusal(ui, reason.as_deref().or(asked.refused.as_deref()));
        if let AskedContent::Recording { sweep, .. } = &asked.content {
            ui.horizontal(|ui| {
                let help = "The file that `slipline sweep` wrote when it played the recorded sweep";
                if ui.button("Open its sweep…").on_hover_text(help).clicked() {
                    ask(MeasureIntent::OpenFile);
                }
                let name = sweep.as_ref().map_or("no description yet", |(name, _)| name.as_str());
                ui.add(Label::new(RichText::new(name).small().color(palette.weak)).truncate());
            });
        }
        ui.horizontal(|ui| {
            let missing = missing(asked);
            let add = ui.add_enabled(missing.is_none(), theme::primary(ui, "Take it", missing.is_none()));
            let add = add.on_hover_text("Add it to the list with these values");
            if add.on_disabled_hover_text(missing.unwrap_or_default()).clicked() {
                ask(MeasureIntent::TakeAsked);
            }
            if ui.button("Leave it").on_hover_text("Close the file and keep nothing of it").clicked() {
                ask(MeasureIntent::LeaveAsked);
            }
        });
    });
    ui.add_space(4.0);
    true
}

/// What the file contains, and what it does not state.
fn sentence(content: &AskedContent) -> String {
    match content {
        AskedContent::Table(foreign) => {
            let frequencies = || foreign.points.iter().map(|point| point.0);
            let (low, high) =
                frequencies().fold((f64::INFINITY, 0.0), |(low, high), hz| (hz.min(low), hz.max(high)));
            format!(
                "By another program: {} frequencies from {} to {}. Its file does not state where the sensor stood.",
                foreign.points.len(),
                show_frequency(low),
                show_frequency(high)
            )
        }
        AskedContent::Recording { wav, .. } => format!(
            "A recording of the sweep: {} s at {}, {}. Record both places with the same gain, and with automatic gain off.",
            with_decimals(wav.seconds(), 1),
            show_frequency(wav.rate_hz()),
            if wav.channels() == 1 { "1 channel".to_owned() } else { format!("{} channels", wav.channels()) },
        ),
    }
}

/// What the user must state or wait for before the file can be taken.
fn missing(asked: &Asked) -> Option<&'static str> {
    if asked.metadata.kind.is_none() {
        return Some("Choose what the sensor showed first");
    }
    match &asked.content {
        AskedContent::Table(_) => None,
        AskedContent::Recording { is_read: true, .. } => Some("It is being read"),
        AskedContent::Recording { sweep: None, .. } => Some("Open the description of its sweep first"),
        AskedContent::Recording { .. } => None,
    }
}

//! The form for what a file of another program does not state: the sensor's place and kind, and the noise.

use crate::intent::{Intent, Intents, MeasureIntent};
use crate::scene::Scene;
use crate::scene::{Asked, AskedContent, AskedTable};
use crate::view::fields::field::{refusal, refusal_over};
use crate::view::fields::sensor_fields::{kind, number, place};
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui::{self, Label, RichText};
use slipline_instrument::measured_file::ForeignMetadata;
use slipline_plate::calibrate::{SNR, band_hz};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{Range, plain, show_frequency};
use slipline_plate::text_table::MEANINGS;

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
        let band = band_hz(&scene.setup.plate);
        wrapped(ui, RichText::new(sentence(&asked.content, band)).small().color(palette.weak));
        ui.add_space(2.0);
        if let AskedContent::Table(table) = &asked.content
            && table.foreign.as_ref().is_none_or(|foreign| foreign.is_table)
        {
            columns(ui, table, &mut ask);
        }
        let stated = asked.metadata;
        let mut reason = None;
        let fields = ui.horizontal_top(|ui| {
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
        });
        // In a row of its own: three would be wider than the side panel.
        if let Some(kind) = kind(ui, "Sensor type", stated.kind) {
            ask(MeasureIntent::Describe(ForeignMetadata { kind: Some(kind), ..stated }));
        }
        refusal_over(ui, fields.response.rect, reason.as_deref());
        refusal(ui, asked.refused.as_deref());
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
            if ui.button("Leave it").on_hover_text("Close the file without adding it to the list").clicked() {
                ask(MeasureIntent::LeaveAsked);
            }
        });
    });
    ui.add_space(4.0);
    true
}

/// What each column was read as; it can be changed.
fn columns(ui: &mut egui::Ui, table: &AskedTable, ask: &mut impl FnMut(MeasureIntent)) {
    ui.horizontal_wrapped(|ui| {
        for (at, column) in table.columns.iter().enumerate() {
            let now = column.meaning();
            let number = at + 1;
            let shown = now.as_deref().unwrap_or("left out");
            let caption = if column.name.is_empty() { number.to_string() } else { column.name.clone() };
            ui.label(RichText::new(caption).small());
            let list =
                egui::ComboBox::from_id_salt(("column", at)).selected_text(shown).width(108.0).height(400.0);
            let list = list.show_ui(ui, |ui| {
                let offered = std::iter::once(None).chain(MEANINGS.map(Some));
                for meaning in offered {
                    let word = meaning.map_or("left out".to_owned(), |(of, unit)| match unit {
                        "" => of.word().to_owned(),
                        unit => format!("{} in {unit}", of.word()),
                    });
                    if ui.selectable_label(word == shown, &word).clicked() {
                        ask(MeasureIntent::Column(at, meaning));
                    }
                }
            });
            let name = format!("Column {number}: {shown}");
            list.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
            list.response.on_hover_text(format!("What column {number}, {}, holds", column.name));
        }
    });
}

/// What the file contains, and what it does not state.
fn sentence(content: &AskedContent, band_hz: (f64, f64)) -> String {
    match content {
        AskedContent::Table(AskedTable { foreign: None, .. }) => {
            "By another program. Its columns are not clear: choose what they are.".to_owned()
        }
        AskedContent::Table(AskedTable { foreign: Some(foreign), .. }) => {
            let read = foreign.read(band_hz);
            format!(
                "By another program: {} frequencies from {} to {}; {}. Its file does not state where the sensor stood.",
                read.rows,
                show_frequency(read.low_hz),
                show_frequency(read.high_hz),
                read.understood()
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
    if matches!(&asked.content, AskedContent::Table(AskedTable { foreign: None, .. })) {
        return Some("Choose what its columns are first");
    }
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

//! The page of the board's self-test: what is wired, and the steps as lights.

use crate::intent::{Asks as _, Intent, Intents, MeasureIntent};
use crate::scene::Scene;
use crate::view::panels::validity::{ink, mark};
use crate::view::theme;
use eframe::egui::{self, RichText, Sense, vec2};
use slipline_instrument::concern::Concern;
use slipline_instrument::selftest::{SelftestRequest, StepResult, Verdict};
use slipline_link::capitalized;

/// Size of a light's place, in points.
const LIGHT: egui::Vec2 = vec2(16.0, 18.0);

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    ui.heading("Test this board");
    ui.add_space(6.0);
    let text = if scene.selftest.request.is_amplifier_on {
        "Quiet tones at -40 dB, first with the amplifier muted, then with it on: an input must receive them only then. The board is disarmed then. Do this once all else has passed without the amplifier."
    } else {
        "The board measures itself for about a minute, with its amplifier muted, and is disarmed then. Steps without their wire are skipped."
    };
    ui.add(egui::Label::new(text).wrap());
    ui.add_space(6.0);
    let test = &scene.selftest;
    let is_running = test.progress.is_some();
    ui.add_enabled_ui(!is_running, |ui| choices(ui, test.request, intents));
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        if is_running {
            let cancel = ui.button("Cancel the test");
            cancel
                .on_hover_text("End it now; the board is disarmed")
                .asks(intents, Intent::Measure(MeasureIntent::Cancel));
        } else {
            let may = scene.snapshot.is_connected() && !scene.is_measured_now();
            let begin = ui.add_enabled(may, theme::primary(ui, "Test", may));
            begin
                .on_hover_text("Disarm the board and begin")
                .on_disabled_hover_text("Only with a connected board that is not measured now")
                .asks(intents, Intent::Measure(MeasureIntent::Selftest));
        }
        if let Some(progress) = test.progress {
            ui.label(progress.to_string());
        }
    });
    let palette = theme::palette(ui);
    if let Some(prompt) = test.prompt {
        ui.label(RichText::new(prompt.sentence()).strong().color(palette.accent));
    }
    if let Some(failed) = test.failed {
        ui.add(egui::Label::new(RichText::new(failed).color(palette.wrong)).wrap());
    }
    for step in test.report.iter().flat_map(|report| &report.steps) {
        light(ui, step);
    }
}

fn choices(ui: &mut egui::Ui, request: SelftestRequest, intents: &mut Intents) {
    let mut wanted = request;
    let amplifier = ui.checkbox(&mut wanted.is_amplifier_on, "Test the amplifier, connected and switched on");
    amplifier.on_hover_text(
        "An inverted mute is silent in every drive and on in every fault; arm a board for it first",
    );
    // The test of the amplifier must not have the wires that the other steps need.
    ui.add_enabled_ui(!wanted.is_amplifier_on, |ui| without_amplifier(ui, &mut wanted));
    if wanted != request {
        intents.push(Intent::Measure(MeasureIntent::SelftestDraft(wanted)));
    }
}

/// What the steps without the amplifier may use.
fn without_amplifier(ui: &mut egui::Ui, wanted: &mut SelftestRequest) {
    ui.checkbox(&mut wanted.has_sensor_wire, "A wire from the DAC's pin to the sensor's")
        .on_hover_text("For the converters, their lag and their noise");
    ui.checkbox(&mut wanted.has_trigger_wire, "A wire from the trigger output to the trigger input")
        .on_hover_text("For the time from a trigger to its drive");
    ui.checkbox(&mut wanted.is_amplifier_unplugged, "The amplifier is unplugged").on_hover_text(
        "Two steps then take the mute pin high: to time how it falls, and to make the board fail on purpose",
    );
    ui.checkbox(&mut wanted.is_short, "In three seconds")
        .on_hover_text("Fewer codes, the clocks over that time alone, and no restart of the board");
    ui.checkbox(&mut wanted.asks, "Ask me to press the board's buttons")
        .on_hover_text("For the user button, the stop input, the flash and the chip's bootloader");
}

/// A step as a light: its name, its verdict, its numbers that have limits, and its sentence.
fn light(ui: &mut egui::Ui, step: &StepResult) {
    let palette = theme::palette(ui);
    let concern = match step.verdict {
        Verdict::Skipped => Concern::Unchecked,
        Verdict::Green => Concern::Green,
        Verdict::Amber => Concern::Amber,
        Verdict::Red => Concern::Red,
    };
    let ink = ink(concern, palette);
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(LIGHT, Sense::hover());
        mark(ui.painter(), rect.center(), concern, ink);
        ui.label(capitalized(&step.name));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let label = ui.label(RichText::new(step.verdict.name()).small().color(ink));
            let said = format!("{}: {}", step.name, step.verdict.name());
            label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
        });
    });
    let numbers: Vec<String> = step
        .readings
        .iter()
        .filter_map(|reading| {
            let allowed = reading.allowed()?;
            Some(format!("{} {} (allowed {allowed})", reading.quantity, reading.shown()))
        })
        .collect();
    let text = if numbers.is_empty() {
        step.sentence.clone()
    } else {
        format!("{} {}.", step.sentence, capitalized(&numbers.join("; ")))
    };
    ui.horizontal(|ui| {
        ui.add_space(LIGHT.x + ui.spacing().item_spacing.x);
        ui.add(egui::Label::new(RichText::new(text).small().color(palette.weak)).wrap());
    });
}

//! The check of the drive before a measurement, and the drive's values from data sheets.

use crate::intent::MeasureDraft;
use crate::scene::LiveScene;
use crate::view::fields::sensor_fields::{number, refusal};
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_instrument::measure::KnownDrive;
use slipline_instrument::measure::circuit::{AMPLIFIER, COIL, PIEZO, SHUNT, ampere, farad, ohm, volt};
use slipline_plate::calibrate::{DriveCircuit, DriveLoad};
use slipline_plate::quantity::show_si;

const CHECK_HELP: &str = "Before anything louder is played, quiet tones check by the drive's current for an open or shorted wire, an amplifier that is off, or another coil or piezo";
/// Initial value of a piezo's capacitance.
const USUAL_PIEZO_F: f64 = 100e-9;
/// Initial value of a voice coil's resistance.
const USUAL_COIL_OHM: f64 = 4.0;

/// Shows the switch, and the fields while it is on; returns the user's change.
pub(crate) fn show(ui: &mut egui::Ui, fields: &mut Fields, live: &LiveScene<'_>) -> Option<MeasureDraft> {
    let mut draft = *live.draft;
    let switch = ui.checkbox(&mut draft.is_checked, "Check first that the drive is on");
    switch.on_hover_text(CHECK_HELP);
    if draft.is_checked && !live.is_drive_known {
        draft.drive = circuit(ui, fields, draft.drive);
    }
    (draft != *live.draft).then_some(draft)
}

/// The fields of the circuit.
fn circuit(ui: &mut egui::Ui, fields: &mut Fields, drive: KnownDrive) -> KnownDrive {
    let KnownDrive { circuit: DriveCircuit { mut full_scale_v, mut load, tolerance }, mut full_scale_a } =
        drive;
    let mut reason = None;
    ui.horizontal_top(|ui| {
        let field = ("Amplifier", "The amplitude of its voltage at the DAC's full scale (2 V)", 64.0);
        let value = shown(full_scale_v, AMPLIFIER.unit);
        let entry = (value.as_str(), "amplifier", AMPLIFIER);
        full_scale_v = number(ui, fields, &mut reason, field, entry, volt).unwrap_or(full_scale_v);
        load = kind(ui, load);
    });
    ui.horizontal_top(|ui| {
        match &mut load {
            DriveLoad::Coil { resistance_ohm } => {
                let field = ("Resistance", "Of the voice coil, by its data sheet (4 ohm)", 82.0);
                let value = shown(*resistance_ohm, COIL.unit);
                let entry = (value.as_str(), "resistance", COIL);
                let read = number(ui, fields, &mut reason, field, entry, ohm);
                *resistance_ohm = read.unwrap_or(*resistance_ohm);
            }
            DriveLoad::Piezo { capacitance_f } => {
                let field = ("Capacitance", "Of the piezo, by its data sheet (220 nF)", 82.0);
                let value = shown(*capacitance_f, PIEZO.unit);
                let entry = (value.as_str(), "capacitance", PIEZO);
                let read = number(ui, fields, &mut reason, field, entry, farad);
                *capacitance_f = read.unwrap_or(*capacitance_f);
            }
        }
        let field = ("Shunt", "The current at the end of the range of the second input (1.65 A)", 82.0);
        let value = shown(full_scale_a, SHUNT.unit);
        let entry = (value.as_str(), "shunt", SHUNT);
        full_scale_a = number(ui, fields, &mut reason, field, entry, ampere).unwrap_or(full_scale_a);
    });
    refusal(ui, reason.as_deref());
    KnownDrive { circuit: DriveCircuit { full_scale_v, load, tolerance }, full_scale_a }
}

/// A number as a user types it: without trailing zeros.
fn shown(value: f64, unit: &str) -> String {
    let text = show_si(value, unit);
    match text.split_once(' ') {
        Some((number, unit)) if number.contains('.') => {
            format!("{} {unit}", number.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => text,
    }
}

/// What the amplifier drives.
fn kind(ui: &mut egui::Ui, load: DriveLoad) -> DriveLoad {
    let mut chosen = load;
    let kinds = [
        DriveLoad::Coil { resistance_ohm: USUAL_COIL_OHM },
        DriveLoad::Piezo { capacitance_f: USUAL_PIEZO_F },
    ];
    let word = |load: &DriveLoad| match load {
        DriveLoad::Coil { .. } => "voice coil",
        DriveLoad::Piezo { .. } => "piezo",
    };
    ui.vertical(|ui| {
        ui.label(RichText::new("It drives a").small().color(theme::palette(ui).weak));
        let list = egui::ComboBox::from_id_salt("drive kind").selected_text(word(&load)).width(96.0);
        let list = list.show_ui(ui, |ui| {
            for other in kinds {
                let is_it = word(&other) == word(&load);
                let choice = ui.selectable_label(is_it, word(&other));
                if choice.on_hover_text("What moves the plate's driven end").clicked() && !is_it {
                    chosen = other;
                }
            }
        });
        let name = format!("Drive: {}", word(&load));
        list.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
        list.response.on_hover_text("The current gives a coil's resistance, or a piezo's capacitance");
    });
    chosen
}

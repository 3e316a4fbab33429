//! The check of the drive before a measurement, and the drive's values from data sheets.

use crate::intent::MeasureDraft;
use crate::scene::LiveScene;
use crate::view::fields::choice::choice_under;
use crate::view::fields::field::refusal_over;
use crate::view::fields::sensor_fields::{Field, number};
use crate::view::kept::Fields;
use eframe::egui;
use slipline_instrument::measure::KnownDrive;
use slipline_instrument::measure::circuit::{AMPLIFIER, COIL, PIEZO, SHUNT, ampere, farad, ohm, volt};
use slipline_plate::calibrate::{DriveCircuit, DriveLoad};
use slipline_plate::quantity::{QuantityError, Range, show_si};

const CHECK_HELP: &str = "Before anything louder is played, quiet tones check by the drive's current for an open or shorted wire, an amplifier that is off, or another coil or piezo";
/// Initial value of a piezo's capacitance.
const USUAL_PIEZO_F: f64 = 100e-9;
/// Initial value of a voice coil's resistance.
const USUAL_COIL_OHM: f64 = 4.0;

/// Shows the switch, and the fields while it is on; returns the user's change.
pub(crate) fn show(ui: &mut egui::Ui, fields: &mut Fields, live: &LiveScene<'_>) -> Option<MeasureDraft> {
    let mut draft = *live.draft;
    let switch = ui.checkbox(&mut draft.is_checked, "Test the drive first");
    switch.on_hover_text(CHECK_HELP);
    if draft.is_checked && !live.is_drive_known {
        draft.drive = circuit(ui, fields, draft.drive);
    }
    (draft != *live.draft).then_some(draft)
}

/// The fields of the circuit.
fn circuit(ui: &mut egui::Ui, fields: &mut Fields, drive: KnownDrive) -> KnownDrive {
    let KnownDrive {
        circuit: DriveCircuit { mut full_scale_v, mut load, tolerance }, mut full_scale_a, ..
    } = drive;
    let mut reason = None;
    type Read = fn(&str) -> Result<f64, QuantityError>;
    let mut entry =
        |ui: &mut egui::Ui, value: &mut f64, field: Field, term: &'static str, range: Range, read: Read| {
            let entry = (&*shown(*value, range.unit), term, range);
            *value = number(ui, fields, &mut reason, field, entry, read).unwrap_or(*value);
        };
    ui.horizontal_top(|ui| {
        let field = ("Amplifier", "The amplitude of its voltage at the DAC's full scale (2 V)", 64.0);
        entry(ui, &mut full_scale_v, field, "amplifier", AMPLIFIER, volt);
        load = kind(ui, load);
    });
    let fields = ui.horizontal_top(|ui| {
        match &mut load {
            DriveLoad::Coil { resistance_ohm } => {
                let field = ("Resistance", "Of the voice coil, by its data sheet (4 ohm)", 82.0);
                entry(ui, resistance_ohm, field, "resistance", COIL, ohm);
            }
            DriveLoad::Piezo { capacitance_f } => {
                let field = ("Capacitance", "Of the piezo, by its data sheet (220 nF)", 82.0);
                entry(ui, capacitance_f, field, "capacitance", PIEZO, farad);
            }
        }
        let field = ("Shunt", "The current at the end of the range of the second input (1.65 A)", 82.0);
        entry(ui, &mut full_scale_a, field, "shunt", SHUNT, ampere);
    });
    refusal_over(ui, fields.response.rect, reason.as_deref());
    KnownDrive { circuit: DriveCircuit { full_scale_v, load, tolerance }, full_scale_a, ..drive }
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
    let kinds = [
        DriveLoad::Coil { resistance_ohm: USUAL_COIL_OHM },
        DriveLoad::Piezo { capacitance_f: USUAL_PIEZO_F },
    ];
    let word = |load: &DriveLoad| match load {
        DriveLoad::Coil { .. } => "voice coil",
        DriveLoad::Piezo { .. } => "piezo",
    };
    let help = "The current gives a coil's resistance, or a piezo's capacitance";
    let chosen = choice_under(ui, "It drives a", ("Drive", word(&load), help), 96.0, |ui| {
        let pressed = |other: &DriveLoad| {
            let is_it = word(other) == word(&load);
            let entry = ui.selectable_label(is_it, word(other));
            entry.on_hover_text("What moves the plate's driven end").clicked() && !is_it
        };
        kinds.into_iter().filter(pressed).last()
    });
    chosen.unwrap_or(load)
}

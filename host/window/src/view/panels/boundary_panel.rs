//! The boundary panel: the boundary's place, its tone and its level.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::sound::IS_THERE;
use crate::view::fields::{
    feeling_fields,
    field::{InputField, UNKNOWN, row},
    hold_fields,
    lines::lines,
    place_field::{allowed, typed_position},
    slider::Quantity,
    sound,
};
use crate::view::stage::finger;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_model::field::steady_field::SteadyTone;
use slipline_model::setup::edit::Edit;
use slipline_model::setup::{BoundaryMode, ToneSetup};
use slipline_plate::check::sensation::SLIPPERY_FROM_HZ;
use slipline_plate::quantity::{show_frequency, show_half_width, show_length, show_place};

/// Size of the line's place, in points.
const HEADLINE: f32 = 20.0;
/// Space between two rows of the page, and the least height of one with controls, in points.
const CLOSE: f32 = 3.0;
const ROW: f32 = 24.0;
const CANCEL_HELP: &str = "Play the tones again from silence, with companions opposite to the drive's harmonics that the plate states; until a tone changes";
const SLIPPERY_HELP: &str = "Slippery surfaces need 20 kHz or more; below, a finger feels the vibration";

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let setup = scene.setup;
    let Some(tone) = setup.tone(scene.selected).copied() else { return };
    let slot = tone.slot;
    let plate = &setup.plate;
    let frequency_hz = plate.frequency_for_boundary_hz(tone.position_m);
    let steady = scene.drive_table.map(|table| SteadyTone::of(setup, &tone, table));
    let palette = theme::palette(ui);

    // The whole page is in sight at 1280 x 720.
    ui.spacing_mut().item_spacing.y = CLOSE;
    ui.spacing_mut().interact_size.y = ROW;
    let kind = if frequency_hz >= SLIPPERY_FROM_HZ { "Slippery boundary" } else { "Vibration boundary" };
    let explanation = if frequency_hz >= SLIPPERY_FROM_HZ {
        "Slippery up to the line, the plate's own friction beyond."
    } else {
        "Vibration up to the line, stillness beyond it."
    };
    // The one number of the line, and beside it whose it is: another tone moves nothing.
    let place = scene.line(slot).map_or(UNKNOWN.to_owned(), |line| show_place(line.place_m));
    ui.horizontal(|ui| {
        ui.label(RichText::new(&place).strong().size(HEADLINE));
        let many = setup.tones.len() > 1;
        let kind = if many { format!("{kind}, tone {}", slot + 1) } else { kind.to_owned() };
        ui.add(egui::Label::new(RichText::new(kind).strong().size(13.0)).truncate());
    });
    ui.label(RichText::new(explanation).color(palette.weak).small()).on_hover_text(SLIPPERY_HELP);
    ui.add_space(4.0);

    let mut reason = None;
    ui.horizontal_top(|ui| {
        let place_hint = "A place (120 mm, 12,5 cm) or a frequency (126 Hz, 40 kHz)";
        let hertz_hint = "A frequency (126 Hz, 40 kHz) or a place (120 mm)";
        for (caption, name, value, hint) in [
            ("Position", "Boundary position", place, place_hint),
            ("Frequency", "Boundary frequency", show_frequency(frequency_hz), hertz_hint),
        ] {
            let field = InputField::new(name, &value, hint, 124.0).under(caption);
            let take = |text: &str| typed_position(scene, &tone, text);
            let taken = field.show_apart(ui, &mut view.fields, &mut reason, take);
            intents.extend(taken.map(|position_m| Intent::Edit(Edit::Move { slot, position_m })));
        }
    });
    range(ui, scene, reason);
    rows(ui, scene, &tone, steady);
    ui.separator();
    mode(ui, scene, intents);
    finger::choice(ui, scene, intents);
    if IS_THERE {
        sound::choice(ui, scene, intents);
    }
    let level = |level| Edit::Level { slot, level };
    Quantity::level("Level".to_owned(), tone.level, &level).show(ui, setup, &mut view.fields, intents);
    Quantity::master(setup.master_db).show(ui, setup, &mut view.fields, intents);
    Quantity::glide(setup.glide_s).show(ui, setup, &mut view.fields, intents);
    let stretched = scene.snapshot.stretched_glide_s().map_or_else(String::new, |seconds| {
        format!("The last change takes {:.0} ms: none is faster.", 1e3 * seconds)
    });
    lines(ui, stretched, palette.weak, 1);
    if plate.spec().harmonics.is_some() {
        ui.button("Cancel harmonics").on_hover_text(CANCEL_HELP).asks(intents, Intent::CancelHarmonics);
    }
    if IS_THERE {
        sound::volume(ui, scene, &mut view.fields, intents);
    }

    ui.separator();
    feeling_fields::show(ui, scene, &mut view.fields, intents);
    // Last, because its state comes under it.
    hold_fields::show(ui, scene, &mut view.fields, intents);
}

/// The values that follow from the place. Every line has the same number of rows; they are close to each other so that the
/// sliders are in sight.
fn rows(ui: &mut egui::Ui, scene: &Scene<'_>, tone: &ToneSetup, steady: Option<SteadyTone>) {
    let (plate, slot) = (&scene.setup.plate, tone.slot);
    let usual = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 2.0);
    row(ui, "Turning point", show_place(tone.position_m));
    if let Some(half_m) = plate.boundary_tolerance_m(tone.position_m) {
        row(ui, "Turning point known to", show_half_width(half_m)).on_hover_text(
            "Here, in 95 of 100 calibrations. The felt edge has an interval of its own, beside the strip; the calibration \
             states the largest over the span",
        );
    }
    if let Some(wave) = scene.predicted.tone(slot) {
        row(ui, "Peak at", wave.peak_position_m.map_or("none".to_owned(), show_place));
        let height_m =
            if scene.load.is_some() { wave.peak_height_m } else { steady.map(|steady| steady.peak_m) };
        let height_m = height_m.filter(|_| steady.is_some());
        row(ui, "Peak height", height_m.map_or(UNKNOWN.to_owned(), show_length));
        row(ui, "Edge, peak to 10 %", show_place(wave.edge_width_m));
    }
    ui.spacing_mut().item_spacing.y = usual;
}

/// The allowed range, or the reason why a typed text is refused. Its space is always reserved, so that a reason
/// moves nothing.
fn range(ui: &mut egui::Ui, scene: &Scene<'_>, reason: Option<String>) {
    let palette = theme::palette(ui);
    let (text, colour) = match reason {
        Some(reason) => (reason, palette.wrong),
        None => (allowed(scene, scene.limits_m), palette.weak),
    };
    lines(ui, text, colour, 2);
}

/// What the line holds, and how a finger feels.
fn mode(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    ui.horizontal(|ui| {
        theme::heading(ui, "Line at");
        for (mode, name, help) in MODES {
            let radio = ui.radio(scene.setup.boundary == mode, name).on_hover_text(help);
            radio.asks(intents, Intent::Edit(Edit::Boundary(mode)));
        }
    });
}

const MODES: [(BoundaryMode, &str, &str); 2] = [
    (
        BoundaryMode::FeltEdge,
        "Felt edge",
        "Where the motion of the plate without a finger falls below what is just felt. Illustrative: fingers differ",
    ),
    (BoundaryMode::TurningPoint, "Turning point", "Where the wave turns back: set by the frequency alone"),
];

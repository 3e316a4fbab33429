//! The boundary panel: the boundary's place, its tone and its level.

use super::field::{InputField, UNKNOWN, row};
use super::slider::Quantity;
use super::{Scene, ViewState, finger, sound, stage, theme};
use crate::intent::{Intent, Intents};
use eframe::egui::{self, RichText, text::LayoutJob};
use slipline_model::field::steady_field::{SteadyTone, shown_boundary_m, turning_point_for};
use slipline_model::setup::edit::Edit;
use slipline_model::setup::{BoundaryMode, ToneSetup};
use slipline_plate::Plate;
use slipline_plate::quantity::{self, PlaceOrFrequency, show_frequency, show_length, show_place};
use slipline_plate::sensation::SLIPPERY_FROM_HZ;

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let setup = scene.setup;
    let Some(tone) = setup.tone(scene.selected).copied() else { return };
    let slot = tone.slot;
    let plate = &setup.plate;
    let frequency_hz = plate.frequency_for_boundary_hz(tone.position_m);
    let steady = scene.full_peak_m.map(|full_peak_m| SteadyTone::of(setup, &tone, full_peak_m));
    let palette = theme::palette(ui);

    let kind = if frequency_hz >= SLIPPERY_FROM_HZ { "Slippery boundary" } else { "Vibration boundary" };
    let explanation = if frequency_hz >= SLIPPERY_FROM_HZ {
        "Slippery up to the line, the plate's own friction beyond."
    } else {
        "Vibration up to the line, stillness beyond it. Slipperiness needs 20 kHz and more."
    };
    ui.label(RichText::new(kind).strong().size(15.0));
    ui.label(RichText::new(explanation).color(palette.weak).small());
    if setup.tones.len() > 1 {
        ui.label(RichText::new(format!("Selected: {}", stage::handle_name(scene, slot))).small());
    }
    ui.add_space(4.0);

    let mut reason = None;
    ui.horizontal_top(|ui| {
        let value = position_words(scene, &tone, steady.as_ref());
        let place = InputField {
            name: "Boundary position",
            value: &value,
            hint: "A place (120 mm, 12,5 cm) or a frequency (126 Hz, 40 kHz)",
            width: 124.0,
            caption: Some("Position"),
        };
        let taken = place
            .show_apart(ui, &mut view.fields, &mut reason, |text| position(scene, steady.as_ref(), text));
        let value = show_frequency(frequency_hz);
        let pitch = InputField {
            name: "Boundary frequency",
            value: &value,
            hint: "A frequency (126 Hz, 40 kHz) or a place (120 mm)",
            width: 124.0,
            caption: Some("Frequency"),
        };
        let taken = pitch
            .show_apart(ui, &mut view.fields, &mut reason, |text| position(scene, steady.as_ref(), text))
            .or(taken);
        if let Some(position_m) = taken {
            intents.push(Intent::Edit(Edit::Move { slot, position_m }));
        }
    });
    range(ui, plate, reason);
    if let Some(wave) = scene.predicted.tone(slot) {
        row(ui, "Peak at", wave.peak_position_m.map_or("none".to_owned(), show_place));
        let height_m =
            if scene.finger.is_some() { wave.peak_height_m } else { steady.map(|steady| steady.peak_m) };
        let height_m = height_m.filter(|_| steady.is_some());
        row(ui, "Peak height", height_m.map_or(UNKNOWN.to_owned(), show_length));
        row(ui, "Edge, peak to 10 %", show_place(wave.edge_width_m));
    }
    ui.add_space(6.0);
    ui.separator();
    theme::heading(ui, "The line holds");
    mode(ui, scene, view, frequency_hz, intents);

    ui.add_space(6.0);
    ui.separator();
    theme::heading(ui, "Strength");
    let level = |level| Edit::Level { slot, level };
    Quantity::level("Level".to_owned(), tone.level, &level).show(ui, setup, view, intents);
    Quantity::master(setup.master_db).show(ui, setup, view, intents);
    Quantity::glide(setup.glide_s).show(ui, setup, view, intents);

    ui.add_space(6.0);
    ui.separator();
    finger::choice(ui, scene, intents);
    sound::choice(ui, scene, intents);
}

/// The allowed range, or the reason why a typed text is refused. Its space is always reserved, so that a reason
/// moves nothing.
fn range(ui: &mut egui::Ui, plate: &Plate, reason: Option<String>) {
    let palette = theme::palette(ui);
    let ((start, end), (low, high)) = (plate.span_m(), plate.band_hz());
    let span = format!(
        "{:.0} to {:.0} mm, or {} to {}",
        start * 1e3,
        end * 1e3,
        show_frequency(low),
        show_frequency(high)
    );
    let (text, colour) = match reason {
        // A reason that already names the range needs no second one.
        Some(reason) if reason.starts_with("outside") => (reason, palette.wrong),
        Some(reason) => (format!("{reason}. Type {span}."), palette.wrong),
        None => (span, palette.weak),
    };
    let size = egui::vec2(ui.available_width(), 2.0 * ui.text_style_height(&egui::TextStyle::Small));
    ui.allocate_ui_with_layout(size, egui::Layout::top_down(egui::Align::Min), |ui| {
        ui.set_min_size(size);
        let font = egui::TextStyle::Small.resolve(ui.style());
        let mut lines = LayoutJob::simple(text, font, colour, size.x);
        lines.wrap.max_rows = 2;
        ui.label(lines);
    });
}

/// The place of the boundary as text; a felt edge is unknown until the height of its tone is known.
fn position_words(scene: &Scene<'_>, tone: &ToneSetup, steady: Option<&SteadyTone>) -> String {
    let setup = scene.setup;
    match (setup.boundary, steady) {
        (BoundaryMode::TurningPoint, _) => show_place(tone.position_m),
        (BoundaryMode::FeltEdge { .. }, None) => UNKNOWN.to_owned(),
        (mode, Some(steady)) => {
            shown_boundary_m(&setup.plate, steady, mode).map_or_else(|| "not felt".to_owned(), show_place)
        }
    }
}

/// The turning point for a typed place or frequency.
fn position(scene: &Scene<'_>, tone: Option<&SteadyTone>, text: &str) -> Result<f64, String> {
    let plate = &scene.setup.plate;
    let (start, end) = plate.span_m();
    let x_m = match quantity::place_or_frequency(text).map_err(|error| error.to_string())? {
        PlaceOrFrequency::Place(x_m) if scene.setup.boundary == BoundaryMode::TurningPoint => x_m,
        PlaceOrFrequency::Place(x_m) => {
            let tone = tone.ok_or("not known until the table is made: type a frequency")?;
            turning_point_for(plate, x_m, tone.peak_m, scene.setup.boundary)
                .ok_or("no tone of this level has its felt edge there")?
        }
        PlaceOrFrequency::Frequency(hertz) => plate.turning_point_m(hertz).ok_or_else(|| {
            format!(
                "{} cannot enter this plate: its cut-off is {}",
                show_frequency(hertz),
                show_frequency(plate.cut_off_hz())
            )
        })?,
    };
    // The ends of the range must not be refused because of rounding in the text.
    if (start - 1e-5..=end + 1e-5).contains(&x_m) {
        return Ok(x_m);
    }
    let (low, high) = plate.band_hz();
    Err(format!(
        "outside {:.0} to {:.0} mm ({} to {})",
        start * 1e3,
        end * 1e3,
        show_frequency(low),
        show_frequency(high)
    ))
}

fn mode(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    view: &mut ViewState,
    frequency_hz: f64,
    intents: &mut Intents,
) {
    let setup = scene.setup;
    // A tenth of the full peak, where the edge's width ends. Illustrative until it is calibrated.
    let default_threshold_m = scene.full_peak_m.map(|full_peak_m| (0.1 * full_peak_m).clamp(1e-9, 1e-2));
    let is_felt = matches!(setup.boundary, BoundaryMode::FeltEdge { .. });
    ui.horizontal(|ui| {
        let turning = ui.radio(!is_felt, "Turning point");
        if turning.on_hover_text("Where the wave turns back: set by the frequency alone").clicked() {
            intents.push(Intent::Edit(Edit::Boundary(BoundaryMode::TurningPoint)));
        }
        let felt =
            ui.add_enabled(default_threshold_m.is_some(), egui::RadioButton::new(is_felt, "Felt edge"));
        let felt = felt.on_hover_text(
            "Past the peak, where the motion of the plate without a finger falls below what is just felt",
        );
        if let Some(threshold_m) = default_threshold_m.filter(|_| felt.clicked()) {
            let mode = BoundaryMode::FeltEdge { threshold_m };
            intents.push(Intent::Edit(Edit::Boundary(mode)));
        }
    });
    if let BoundaryMode::FeltEdge { threshold_m } = setup.boundary {
        ui.horizontal_top(|ui| {
            ui.label("just felt at");
            let value = show_length(threshold_m);
            let field = InputField {
                name: "Threshold of feeling",
                value: &value,
                hint: "Peak displacement that is just felt: 1 nm to 10 mm. Illustrative: calibrate on your own plate",
                width: 90.0, caption: None,
            };
            let taken = field.show(ui, &mut view.fields, |text| {
                let metres = quantity::length_m(text).map_err(|error| error.to_string())?;
                let mode = BoundaryMode::FeltEdge { threshold_m: metres };
                slipline_model::setup::edit::apply(setup, &Edit::Boundary(mode)).map_err(|error| error.to_string())?;
                Ok(mode)
            });
            if let Some(mode) = taken {
                intents.push(Intent::Edit(Edit::Boundary(mode)));
            }
        });
        if frequency_hz >= SLIPPERY_FROM_HZ {
            ui.label(RichText::new("A film of air needs about 1 µm.").small().weak());
        }
    }
}

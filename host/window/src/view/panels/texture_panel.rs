//! The texture page: the wanted sensation, how much of it is reachable, and the tones that make it.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::bars::tour;
use crate::view::fields::field::{InputField, refusal, refusal_over, row};
use crate::view::fields::lines::lines;
use crate::view::fields::refusal::Refusal;
use crate::view::kept::Brush;
use crate::view::panels::texture_plot;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText, vec2};
use slipline_instrument::TourStep;
use slipline_model::field::felt::by_person_places;
use slipline_model::jobs::texture::Textured;
use slipline_model::texture::{BREAKPOINTS_DRAWN_MAX, Fitted, Made, WishDraft, WishKind};
use slipline_plate::quantity::{self, show_frequency, show_length, show_place};
use slipline_plate::texture::{Figures, TONES_MAX};

/// Width of a field, and what its margins add to it, in points.
const FIELD: f32 = 96.0;
const EDGES: f32 = 8.0;

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let texture = scene.texture;
    let palette = theme::palette(ui);
    let draft = texture.draft;
    let mut changed: Option<WishDraft> = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 4.0;
        for kind in WishKind::ALL {
            let button = ui.selectable_label(draft.kind == kind, kind.name());
            if button.on_hover_text(kind.sentence()).clicked() {
                changed = Some(WishDraft { kind, ..draft.clone() });
                view.brush = Brush::default();
            }
        }
    });
    lines(ui, draft.kind.sentence(), palette.weak, 2);
    ui.add_space(2.0);
    changed = fields(ui, scene, view, intents).or(changed);
    actions(ui, scene, intents);
    let length_m = scene.setup.plate.length_m();
    changed = texture_plot::show(ui, &texture, length_m, view).or(changed);
    texture_plot::legend(ui, &texture);
    if let Some(draft) = changed {
        intents.push(Intent::Texture(Box::new(draft)));
    }
    ui.add_space(2.0);
    result(ui, scene);
}

/// The values of the kind that is wanted, and the number of tones; returns the changed draft.
fn fields(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    view: &mut ViewState,
    intents: &mut Intents,
) -> Option<WishDraft> {
    let draft = scene.texture.draft;
    let mut changed = None;
    let mut reason = None;
    let mut field = |ui: &mut egui::Ui,
                     (name, value, hint): (&str, &str, &str),
                     take: &dyn Fn(&str) -> anyhow::Result<WishDraft>| {
        let field = InputField::new(name, value, hint, FIELD).under(name);
        let taken = field.show_apart(ui, &mut view.fields, &mut reason, take);
        changed = taken.or(changed.take());
    };
    let shown = ui.horizontal_top(|ui| {
        match draft.kind {
            WishKind::Solid => {
                let value = show_place(draft.felt_edge_m);
                let take = |text: &str| Ok(WishDraft { felt_edge_m: quantity::length_m(text)?, ..draft.clone() });
                field(ui, ("Felt to", &value, "Where the even area ends, as a place (200 mm, 20 cm)"), &take);
            }
            WishKind::Stripes => {
                let value = show_length(draft.stripes_m);
                let take = |text: &str| Ok(WishDraft { stripes_m: quantity::length_m(text)?, ..draft.clone() });
                field(ui, ("Distance", &value, "From stripe to stripe, as a length (12 mm)"), &take);
            }
            WishKind::Beat => {
                let value = show_place(draft.beat_place_m);
                let take = |text: &str| Ok(WishDraft { beat_place_m: quantity::length_m(text)?, ..draft.clone() });
                field(ui, ("Place", &value, "The place up to which both tones travel (120 mm)"), &take);
                let value = show_frequency(draft.beat_hz);
                let take = |text: &str| Ok(WishDraft { beat_hz: quantity::frequency_hz(text)?, ..draft.clone() });
                field(ui, ("Beat", &value, "How fast it swells and fades: 1 Hz to 1 kHz"), &take);
            }
            WishKind::Profile => {
                ui.vertical(|ui| {
                    ui.label(RichText::new("From file").small().color(theme::palette(ui).weak));
                    // As wide as the field that another kind has in its place.
                    let open = egui::Button::new("Open profile…").min_size(vec2(FIELD + EDGES, 0.0));
                    let open = ui.add(open);
                    let help =
                        "CSV: lines of place in metres, comma, amplitude. PNG: the brightness of its middle row";
                    open.on_hover_text(help).asks(intents, Intent::OpenProfile);
                });
            }
        }
        if matches!(draft.kind, WishKind::Solid | WishKind::Profile) {
            let value = draft.most.to_string();
            let take = |text: &str| match text.trim().parse() {
                Ok(most) if (1..=TONES_MAX).contains(&most) => Ok(WishDraft { most, ..draft.clone() }),
                _ => Err(Refusal::beyond("tones at most", text, "1 to 16").into()),
            };
            field(ui, ("Tones at most", &value, "How many tones it may take: 1 to 16. More come nearer to what is wanted"), &take);
        }
        if draft.kind == WishKind::Profile {
            brush(ui, scene, &mut view.brush, intents);
        }
    });
    refusal_over(ui, shown.response.rect, reason.as_deref());
    if draft.kind == WishKind::Profile && draft.profile.len() > BREAKPOINTS_DRAWN_MAX {
        let count = draft.profile.len();
        ui.label(RichText::new(format!("{count} points from a file.")).small());
    }
    changed
}

const BRUSH_HELP: &str = "Draw the wanted amplitude over the envelope of the stage: the tones follow each stroke, as loud as it is \
    drawn, and Undo takes it back. It arms and starts nothing";

/// The switch of the stage's brush.
fn brush(ui: &mut egui::Ui, scene: &Scene<'_>, brush: &mut Brush, intents: &mut Intents) {
    ui.vertical(|ui| {
        ui.label(RichText::new("Draw").small().color(theme::palette(ui).weak));
        let button = egui::Button::selectable(brush.is_taken, "Brush").frame(true);
        // Heights have no measure without the plate's table.
        let button = ui.add_enabled(scene.full_peak_m.is_some(), button);
        let button = button.on_disabled_hover_text("As soon as the plate's table is made");
        if button.on_hover_text(BRUSH_HELP).clicked() {
            brush.switch();
            intents.push(Intent::EndDrawing);
        }
    });
}

/// What can be done with the texture, as soon as all of it is made.
fn actions(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let texture = scene.texture;
    let is_finished =
        |textured: &&Textured| texture.is_current && textured.is_finished && textured.result.is_ok();
    let is_ready = texture.latest.filter(is_finished).is_some();
    ui.horizontal(|ui| {
        let play = ui.add_enabled(is_ready, theme::primary(ui, "Play this", is_ready));
        tour::mark(ui, scene, TourStep::Texture, play.rect);
        play.on_hover_text("Put these tones in the setup; Undo takes them back")
            .asks(intents, Intent::PlayTexture);
        let save = ui.add_enabled(is_ready, egui::Button::new("Save setup…"));
        save.on_hover_text("A setup that this app and `slipline drive --setup` play")
            .asks(intents, Intent::SaveTexture);
        let again = "Compute it: it was cancelled before";
        if texture.is_given_up && ui.button("Make it").on_hover_text(again).clicked() {
            intents.push(Intent::Texture(Box::new(texture.draft.clone())));
        }
    });
}

/// What was made, or why nothing was.
fn result(ui: &mut egui::Ui, scene: &Scene<'_>) {
    let texture = scene.texture;
    let palette = theme::palette(ui);
    let weak = |text: &str| RichText::new(text).color(palette.weak);
    let of_kind = |textured: &&Textured| textured.wish.wish.kind() == texture.draft.kind;
    let Some(textured) = texture.latest.filter(of_kind) else {
        let text = if scene.drive_table.is_none() {
            "Made as soon as the plate's table is: connect, and wait for it."
        } else {
            "Being made…"
        };
        ui.label(weak(text));
        return;
    };
    match &textured.result {
        Err(reason) => refusal(ui, Some(&reason.to_string())),
        Ok(made) => {
            // First, because the numbers are more for one kind than for another.
            tones(ui, made);
            numbers(ui, scene, textured, made);
        }
    }
}

fn decibel(value: f64) -> String {
    format!("{value:.1} dB")
}

fn numbers(ui: &mut egui::Ui, scene: &Scene<'_>, textured: &Textured, made: &Made) {
    if let Some(lack) = made.lack(textured.wish.most) {
        let text = RichText::new(lack.sentence()).small().color(theme::palette(ui).weak);
        ui.add(egui::Label::new(text).wrap());
    }
    if let Some(fitted) = &made.fitted {
        ui.scope(|ui| figures(ui, fitted));
    }
    let rest = made.fitted.as_ref().and_then(|fitted| fitted.rest.as_ref());
    if let Some(flutter) = rest.and_then(|rest| rest.flutter) {
        let swing = format!("{} at {}", decibel(flutter.swing_db), show_frequency(flutter.frequency_hz));
        let (largest, place) = (decibel(flutter.largest_db), show_place(flutter.largest_at_m));
        row(ui, "Flutter", swing).on_hover_text(format!(
            "How far its RMS over 30 ms swings within a second, by beats: at the median place, and up to {largest} at {place}"
        ));
    }
    if let Some(places) = rest.and_then(|rest| by_person_places(rest.by_person?)) {
        row(ui, "Felt to, by person", places)
            .on_hover_text("Where the area ends for persons who feel less and for those who feel more");
    }
    let largest_m = textured.rms_m.iter().copied().fold(0.0, f64::max);
    row(ui, "RMS at most", show_length(largest_m));
    if let Some(distance_m) = made.stripes_m {
        row(ui, "Stripes, in the middle", show_length(distance_m));
    }
    if let Some(felt_db) = made.stripes_felt_db.filter(|felt_db| felt_db.is_finite()) {
        row(ui, "Felt under the contact", decibel(felt_db));
    }
    let table = &textured.wish.table.drive_table;
    let sum: f64 = made.tones.iter().map(|tone| tone.level * table.gain(tone.position_m)).sum();
    row(ui, "Sum, of full scale", format!("{:.0} %", 100.0 * sum));
    if let Some(gain_db) = made.chord_gain_db().filter(|gain_db| *gain_db > 0.05) {
        let is_possible = !scene.snapshot.is_connected() || scene.snapshot.can_play_chords();
        let text =
            if is_possible { format!("+{}", decibel(gain_db)) } else { "not by this device".to_owned() };
        row(ui, "As a chord", text);
    }
}

/// How near it comes, how near any number of tones could, and the worst within the plate's tolerances.
fn figures(ui: &mut egui::Ui, fitted: &Fitted) {
    let palette = theme::palette(ui);
    let columns = [fitted.texture.figures, fitted.texture.reach, fitted.worst];
    let error = |figures: &Figures| Some(format!("{:.1} %", 100.0 * figures.rms_error));
    let ripple = |figures: &Figures| figures.ripple_db.map(decibel);
    let contrast = |figures: &Figures| figures.contrast_db.map(decibel);
    type Shown<'a> = &'a dyn Fn(&Figures) -> Option<String>;
    let rows: [(&str, Shown<'_>); 3] = [("Error", &error), ("Ripple", &ripple), ("Contrast", &contrast)];
    ui.spacing_mut().interact_size.y = 17.0;
    egui::Grid::new("texture figures").num_columns(4).min_col_width(40.0).spacing([14.0, 2.0]).show(
        ui,
        |ui| {
            let small = |text: &str| RichText::new(text).small().color(palette.weak);
            ui.label("");
            for (name, help) in [
                ("its tones", "What these tones make"),
                ("any number", "The best that any number of tones can do"),
                ("worst", "Of these tones, within the plate's tolerances of speed and loss"),
            ] {
                ui.label(small(name)).on_hover_text(help);
            }
            ui.end_row();
            for (name, shown) in rows {
                let Some(texts) = columns.iter().map(shown).collect::<Option<Vec<_>>>() else { continue };
                ui.label(RichText::new(name).color(palette.weak));
                texts.into_iter().for_each(|text| drop(ui.label(text)));
                ui.end_row();
            }
        },
    );
}

fn tones(ui: &mut egui::Ui, made: &Made) {
    let title =
        if made.tones.len() == 1 { "1 tone".to_owned() } else { format!("{} tones", made.tones.len()) };
    egui::CollapsingHeader::new(title).id_salt("texture tones").show_unindented(ui, |ui| {
        for tone in &made.tones {
            let (place, frequency) = (show_place(tone.position_m), show_frequency(tone.frequency_hz));
            row(ui, &place, format!("{frequency}, level {:.3}", tone.level));
        }
    });
}

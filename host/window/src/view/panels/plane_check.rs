//! The button that computes the plate in two dimensions, and the difference to the one-mode equation.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_model::jobs::plane::sentence;
use slipline_plate::Finger;
use slipline_plate::quantity::show_place;

const NAME: &str = "Check in two dimensions";
const HELP: &str =
    "Compute the whole plate at this boundary without the one-mode equation, and show where the two differ";

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    // A result of another plate or boundary is no longer true.
    let planes = &scene.background.planes;
    let job = planes.asked().filter(|asked| Some(*asked) == scene.plane_job.as_ref());
    let result = planes.current().filter(|_| job.is_some());
    let failed = result.and_then(|result| result.as_ref().err()).map(ToString::to_string);
    let refusal = match &failed {
        Some(reason) => Some(reason.as_str()),
        _ if job.is_some() && result.is_none() => Some("Being computed"),
        _ if scene.plane_job.is_none() => Some("There is no tone whose boundary could be computed"),
        _ => None,
    };
    let button = ui.add_enabled(refusal.is_none(), theme::primary(ui, NAME, refusal.is_none()));
    let button = button.on_disabled_hover_text(refusal.unwrap_or_default()).on_hover_text(HELP);
    button.asks(intents, Intent::CheckPlane);
    let words = match job.zip(result) {
        Some((job, Ok(differs))) => Some((
            format!("At {}{}: {}", show_place(job.boundary_m), finger_words(job.finger), sentence(differs)),
            palette.text,
        )),
        Some((_, Err(reason))) => Some((format!("Not computed: {reason}."), palette.warn)),
        None => None,
    };
    if let Some((text, colour)) = words {
        ui.add(egui::Label::new(RichText::new(text).small().color(colour)).wrap());
    }
    ui.add_space(4.0);
    ui.separator();
}

fn finger_words(finger: Option<Finger>) -> String {
    finger.map_or_else(String::new, |finger| format!(", with the finger at {}", show_place(finger.place_m)))
}

//! The designer: the requirements (its [`form`]), the resulting plate, and the actions on it.

mod form;
pub(crate) mod sketch;

use crate::caption::Panel;
use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::DesignState;
use crate::scene::Scene;
use crate::view::fields::field::row;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use form::Form;
use slipline_plate::design::Design;
use slipline_plate::quantity::{show_frequency, show_length, show_place};

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let background = scene.background;
    if matches!(background.design, DesignState::Closed) {
        intents.push(Intent::Design(Box::new(background.draft.clone())));
    }
    let result = match &background.design {
        DesignState::Ready(designed) => Some(&designed.result),
        DesignState::Closed | DesignState::Making | DesignState::Cancelled => None,
    };
    let refusal = result.and_then(|result| result.as_ref().err());
    let form::Shown { change, is_told } = Form::new(&background.draft, refusal, &mut view.fields).show(ui);
    if let Some(draft) = change {
        intents.push(Intent::Design(Box::new(draft)));
    }
    ui.separator();
    theme::heading(ui, "The plate");
    let palette = theme::palette(ui);
    match &background.design {
        DesignState::Closed | DesignState::Making => {
            ui.label(RichText::new("Being designed…").color(palette.weak));
        }
        DesignState::Cancelled => {
            if ui
                .button("Design it")
                .on_hover_text("Compute the plate for these values; it was cancelled")
                .clicked()
            {
                intents.push(Intent::Design(Box::new(background.draft.clone())));
            }
        }
        DesignState::Ready(designed) => match &designed.result {
            Ok(design) => {
                let wide = egui::vec2(ui.available_width(), 28.0);
                let take = ui.add_sized(wide, theme::primary(ui, "Use this plate", true));
                take.on_hover_text("Put it on the screen; Undo takes it back")
                    .asks(intents, Intent::UseDesign);
                for (name, help, intent) in SAVE {
                    ui.add_sized(wide, egui::Button::new(name)).on_hover_text(help).asks(intents, intent());
                }
                ui.add_space(2.0);
                figures(ui, design);
            }
            Err(refusal) => {
                let text = if is_told {
                    "None: see the field above.".to_owned()
                } else {
                    refusal.worded(&Panel::Designer)
                };
                ui.label(RichText::new(text).small().color(palette.wrong));
            }
        },
    }
}

/// An action on the plate: the button's text, its explanation and its intent.
type Offer = (&'static str, &'static str, fn() -> Intent);

const SAVE: [Offer; 2] = [
    ("Save plate (TOML)…", "A plate file for the app and the command line", || Intent::SaveDesign),
    ("Save cut files (SVG, DXF)…", "Plate and frame with dimensions, into a folder", || {
        Intent::SaveCutFiles
    }),
];

fn figures(ui: &mut egui::Ui, design: &Design) {
    let plate = &design.plate;
    let width = |x_m: f64| show_length(2.0 * plate.cut_half_width_m(x_m));
    row(ui, "Width, driven end", width(0.0));
    row(ui, "Width, narrow end", width(plate.length_m()));
    row(ui, "Taper rate", format!("{:.3} 1/m", design.rate_per_m));
    for (name, end) in [("Nearest boundary", &design.low), ("Farthest boundary", &design.high)] {
        row(ui, name, format!("{} at {}", show_place(end.boundary_m), show_frequency(end.frequency_hz)));
        row(ui, "   its edge width", show_length(end.edge_width_m));
    }
    row(ui, "Loss margin", format!("{} of {:.3}", plate.spec().loss_factor, design.loss_factor_limit));
    row(ui, "Mode-free travel", show_length(design.mode_free_travel_m()));
    let damper = &design.damper;
    if let Some(lead_in) = damper.lead_in {
        row(ui, "Lead-in", format!("{}, loss factor {}", show_length(lead_in.length_m), lead_in.loss_factor));
        row(ui, "   damper at its end", format!("{:.3} N s/m", damper.resistance_n_s_per_m));
    } else {
        row(ui, "Damper", format!("{:.3} N s/m", damper.resistance_n_s_per_m));
        row(ui, "   matches at", show_frequency(damper.match_frequency_hz));
        row(ui, "   r over the band", format!("{:.2} to {:.2}", damper.ratio_range.0, damper.ratio_range.1));
    }
    row(ui, "   reflection", format!("at most {:.0} %", 100.0 * damper.largest_reflection));
    if let Some(tension) = design.tension_n_per_m {
        row(ui, "Tension", format!("{tension:.1} N/m"));
    }
    if let Some(frame) = design.frame {
        row(ui, "Frame", format!("2 × {} of {}", show_length(frame.sheet_m), frame.material));
    }
    ui.label(RichText::new(design.mounting.sentence()).small().color(theme::palette(ui).weak));
    if let Some(caution) = design.caution() {
        ui.add(egui::Label::new(RichText::new(caution).small().color(theme::palette(ui).warn)).wrap());
    }
}

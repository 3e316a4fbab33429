//! What the handles on the stage share.

use eframe::egui;

/// The place after increment, decrement and set-value from a screen reader or a switch, in metres.
pub(crate) fn by_assistive_technology(ui: &egui::Ui, id: egui::Id, position_m: f64) -> Option<f64> {
    use egui::accesskit::{Action, ActionData};
    let mut to = None;
    ui.input(|input| {
        let steps = input.num_accesskit_action_requests(id, Action::Increment) as f64
            - input.num_accesskit_action_requests(id, Action::Decrement) as f64;
        if steps != 0.0 {
            to = Some(position_m + steps * 1e-3);
        }
        for request in input.accesskit_action_requests(id, Action::SetValue) {
            if let Some(ActionData::NumericValue(mm)) = request.data {
                to = Some(mm * 1e-3);
            }
        }
    });
    to
}

//! The question whether an actuator's profile is written to the board.

use crate::intent::{Intent, Intents};
use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_instrument::profile_file;
use slipline_link::protocol::profile::ActuatorProfile;

/// Shows the profile and asks; returns whether the page is over.
pub(super) fn show(
    ui: &mut egui::Ui,
    profile: &ActuatorProfile,
    scene: &Scene<'_>,
    intents: &mut Intents,
) -> bool {
    ui.heading("Write this actuator's profile to the board?");
    ui.add_space(6.0);
    ui.add(egui::Label::new(RichText::new(profile_file::write(profile).trim_end()).monospace()).wrap());
    ui.add_space(6.0);
    let text = "Press the user button on the board and hold it, press Write within 30 s, and let the button go when the device has answered: for up \
                to 5 s it takes no stop. From then on the device refuses what exceeds these limits, from every program. An armed device is disarmed first.";
    ui.add(egui::Label::new(text).wrap());
    ui.add_space(10.0);
    ui.horizontal(|ui| {
        let is_cancelled = ui.button("Cancel").on_hover_text("Leave everything as it is").clicked();
        let may = scene.snapshot.keeps_profile();
        let write = ui.add_enabled(may, theme::primary(ui, "Write", may));
        let write = write.on_hover_text("Write it, while the board's user button is held");
        let is_written = write.on_disabled_hover_text("No board is connected that keeps a profile").clicked();
        if is_written {
            intents.push(Intent::WriteProfile(Box::new(profile.clone())));
        }
        is_cancelled || is_written
    })
    .inner
}

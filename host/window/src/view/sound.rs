//! The choice of what is heard.

use super::{Scene, theme};
use crate::intent::{Intent, Intents};
use crate::sound::{SoundChoice, SpeakerState};
use eframe::egui::{self, RichText, Slider};

const CHOICES: [(SoundChoice, &str, &str); 3] = [
    (SoundChoice::Off, "Off", "Nothing is played"),
    (
        SoundChoice::Finger,
        "Finger",
        "What the finger meets; ultrasound is shifted down by whole octaves. Illustrative",
    ),
    (
        SoundChoice::Drive,
        "Drive",
        "The drive itself, up to 1 kHz: connect an amplifier and a voice coil to this computer's sound output. \
         Take off headphones, begin with a low volume, and keep this window in sight: covered, it falls silent",
    ),
];

/// The choice, the volume, and why nothing is heard.
pub(super) fn choice(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        theme::heading(ui, "Sound");
        for (choice, name, help) in CHOICES {
            let radio = ui.radio(scene.sound.choice == choice, name);
            let said = format!("Sound: {name}");
            radio.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::RadioButton, true, scene.sound.choice == choice, &said)
            });
            if radio.on_hover_text(help).clicked() {
                intents.push(Intent::Sound(choice));
            }
        }
    });
    // Without a finger nothing of it is heard.
    let is_heard = match scene.sound.choice {
        SoundChoice::Off => false,
        SoundChoice::Finger => scene.finger.is_some(),
        SoundChoice::Drive => true,
    };
    if !is_heard {
        return;
    }
    let mut volume = scene.settings.volume;
    let slider = Slider::new(&mut volume, 0.0..=1.0).text("Volume").fixed_decimals(2);
    if ui.add(slider).changed() {
        intents.push(Intent::Volume(volume));
    }
    let (text, colour) = match (&scene.sound.speaker, &scene.sound.unplayed) {
        (SpeakerState::Failed(reason), _) => (format!("No sound: {reason}."), palette.wrong),
        (_, Some(reason)) => (reason.clone(), palette.warn),
        (_, None) => return,
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(text).small().color(colour));
        if matches!(scene.sound.speaker, SpeakerState::Failed(_)) && ui.small_button("Try again").clicked() {
            intents.push(Intent::Sound(scene.sound.choice));
        }
    });
}

//! The choice of what is heard, and how loud.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::sound::{SoundChoice, SpeakerState};
use crate::view::fields::lines::lines;
use crate::view::fields::slider::{FreeSlider, LEVELS};
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui;
use slipline_plate::quantity;

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

/// The choice.
pub(crate) fn choice(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    ui.horizontal(|ui| {
        theme::heading(ui, "Sound");
        for (choice, name, help) in CHOICES {
            let radio = ui.radio(scene.sound.choice == choice, name);
            let said = format!("Sound: {name}");
            radio.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::RadioButton, true, scene.sound.choice == choice, &said)
            });
            radio.on_hover_text(help).asks(intents, Intent::Sound(choice));
        }
    });
}

/// The volume, and why nothing is heard. The row has the same height for every choice.
pub(crate) fn volume(ui: &mut egui::Ui, scene: &Scene<'_>, typed: &mut Fields, intents: &mut Intents) {
    let palette = theme::palette(ui);
    // Without a finger nothing of it is heard.
    let is_heard = match scene.sound.choice {
        SoundChoice::Off => false,
        SoundChoice::Finger => scene.finger.is_some(),
        SoundChoice::Drive => true,
    };
    let volume = f64::from(scene.settings.volume);
    let slider = FreeSlider {
        name: "Volume",
        help: "How loud it is played",
        value: volume,
        range: 0.0..=1.0,
        is_logarithmic: false,
        shown: format!("{volume:.2}"),
        allowed: LEVELS.to_owned(),
        read: quantity::level,
    };
    if !is_heard {
        // Its room stays, so that what is under it keeps its place.
        ui.allocate_space(egui::vec2(ui.available_width(), ui.spacing().interact_size.y));
    } else if let Some(volume) = slider.show(ui, typed) {
        intents.push(Intent::Volume(volume as f32));
    }
    let (text, colour) = match (&scene.sound.speaker, &scene.sound.unplayed) {
        _ if !is_heard => (String::new(), palette.weak),
        (SpeakerState::Failed(reason), _) => (format!("No sound: {reason}."), palette.wrong),
        (_, Some(reason)) => (reason.clone(), palette.warn),
        (_, None) => (String::new(), palette.weak),
    };
    ui.horizontal_top(|ui| {
        let help = "Open the sound output of this computer once more";
        if is_heard
            && matches!(scene.sound.speaker, SpeakerState::Failed(_))
            && ui.small_button("Try again").on_hover_text(help).clicked()
        {
            intents.push(Intent::Sound(scene.sound.choice));
        }
        lines(ui, text, colour, 2);
    });
}

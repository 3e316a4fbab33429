//! The lights beside the simulated device: every scene, preset and texture opens with notes at most, but for the presets that do
//! not work by nature, which say so themselves.

use crate::session::Session;
use slipline_instrument::concern::{Concern, of_preset};
use slipline_model::scenes::SCENES;
use slipline_model::setup::edit::Edit;
use slipline_model::texture::WishKind;
use std::sync::Arc;

/// The presets that are red by nature, and words of the sentences that say why.
const RED_BY_NATURE: [(&str, &[&str]); 4] = [
    ("al-bending-displacement", &["sends every wave back"]),
    ("paper-rubber", &["sends every wave back"]),
    ("paper-as-printed", &["the edges bend too much", "wider than a hand", "sends every wave back"]),
    ("al-sh", &["the edges bend too much"]),
];

/// What the chip says, and the sentences of the lights behind it.
fn chip(session: &Session) -> (Concern, String) {
    let shown = session.instrument.shown();
    assert!(shown.background.checks.current().is_some(), "it is checked");
    let concerns = shown.concerns().unwrap();
    let lights = concerns.lights.iter().filter(|(concern, _)| *concern > Concern::Green);
    let lines =
        lights.map(|(concern, light)| format!("  {} {}: {}", concern.name(), light.name, light.sentence));
    let lines: Vec<String> = std::iter::once(concerns.summary()).chain(lines).collect();
    (concerns.worst(), lines.join("\n"))
}

/// Opens these presets beside the simulated device.
fn presets_are_red_by_nature_only(is_opened: impl Fn(&str) -> bool) {
    let mut session = Session::driving();
    for preset in slipline_plate::presets().iter().filter(|preset| is_opened(preset.name)) {
        session.instrument.edit(&Edit::Plate(Arc::new(preset.plate().unwrap())));
        session.pass(600);
        let (worst, said) = chip(&session);
        assert_eq!(worst, of_preset(preset.name), "{}: {said}", preset.name);
        match RED_BY_NATURE.iter().find(|(name, _)| *name == preset.name) {
            None => assert!(worst <= Concern::Note, "{}: {said}", preset.name),
            Some((name, sentences)) => {
                for sentence in *sentences {
                    assert!(said.contains(sentence), "{name}: \"{sentence}\" in {said}");
                }
                assert_eq!(preset.description().matches("Red light").count(), 1, "{name}: in its card, once");
            }
        }
    }
}

#[test]
fn every_scene_opens_with_notes_at_most_and_says_nothing_of_lights() {
    for scene in &SCENES {
        let session = Session::driving_setup(scene.setup().unwrap());
        let (worst, said) = chip(&session);
        assert!(worst <= Concern::Note, "{}: {said}", scene.name);
        assert!(!scene.description.contains("light"), "{}", scene.description);
    }
}

#[test]
fn a_loud_preset_opens_with_notes_and_one_that_does_not_work_with_red() {
    presets_are_red_by_nature_only(|name| ["al-bending", "paper-rubber"].contains(&name));
}

#[test]
#[ignore = "all presets: .ci/run statistics"]
fn every_preset_opens_with_notes_at_most_but_four() {
    presets_are_red_by_nature_only(|_| true);
}

#[test]
fn every_kind_of_texture_is_played_with_notes_at_most() {
    let mut session = Session::driving_setup(SCENES[0].setup().unwrap());
    session.attention.is_texture_open = true;
    session.pass(100);
    for kind in WishKind::ALL {
        let mut draft = session.instrument.shown().texture.draft.clone();
        draft.kind = kind;
        session.instrument.screen.draft_texture(draft);
        session.pass(600);
        let before = session.instrument.desk.setup().tones.clone();
        session.instrument.play_texture();
        session.pass(600);
        assert_ne!(session.instrument.desk.setup().tones, before, "{}: {}", kind.name(), session.notice());
        let (worst, said) = chip(&session);
        assert!(worst <= Concern::Note, "{}: {said}", kind.name());
        session.instrument.undo();
        session.pass(600);
    }
}

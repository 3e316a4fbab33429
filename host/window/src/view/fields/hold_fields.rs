//! The level hold in the boundary panel: its switch, its largest rise, its state and the state of each tone.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::fields::slider::FreeSlider;
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_instrument::hold::{MAX_RISE, Standing, ToneWords, words};
use slipline_plate::quantity::number_format::rounded;
use slipline_plate::quantity::{self, Measure, show_frequency, show_place, show_range};

const HELP: &str = "A sensor listens to the tones on the untouched plate; the device then keeps the level of each, \
    whatever a finger absorbs. A drag ends that; the sensor listens again when the line rests";
const RISE_HELP: &str =
    "How far above the drive's level a held tone may rise; full scale, heat and travel also limit it";
/// The limits of the window's pictures during a hold.
const NOT_SHOWN: &str = "Wave, envelope, strip and trace are those of the drive's own levels; what is sent instead is known \
    to the device alone.";

/// Shows it, for a device that can listen.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, typed: &mut Fields, intents: &mut Intents) {
    if !scene.snapshot.can_listen() {
        return;
    }
    let hold = &scene.hold;
    let mut is_on = hold.is_put_up || hold.holding.is_on();
    ui.checkbox(&mut is_on, "Hold the level").on_hover_text(HELP).asks(intents, Intent::HoldLevel(is_on));
    let palette = theme::palette(ui);
    let say = |ui: &mut egui::Ui, text: RichText| ui.add(egui::Label::new(text).wrap());
    let colour = match hold.standing {
        _ if hold.is_put_up => palette.text,
        Standing::Off(None) => return,
        Standing::Off(Some(end)) if end.is_trouble() => palette.wrong,
        Standing::Off(_) => palette.weak,
        Standing::Listening(_) => palette.warn,
        Standing::Waiting | Standing::Silent | Standing::Changing | Standing::Holding(_) => palette.text,
    };
    let text = if hold.is_put_up {
        "The simulated sensor is put in its place…".to_owned()
    } else {
        format!("{}.", hold.standing)
    };
    say(ui, RichText::new(text).color(colour));
    if !is_on {
        return;
    }
    if let Standing::Holding(held) = hold.standing {
        for tone in held.into_iter().flat_map(words) {
            let colour = if tone.is_well { palette.text } else { palette.warn };
            say(ui, RichText::new(tone_state(scene, &tone)).color(colour));
        }
    }
    let slider = FreeSlider {
        name: "Rise",
        help: RISE_HELP,
        value: hold.max_rise_db,
        range: MAX_RISE.low..=MAX_RISE.high,
        is_logarithmic: false,
        shown: format!("{} dB", rounded(hold.max_rise_db, 1)),
        allowed: show_range(MAX_RISE.low, MAX_RISE.high, Measure::Plain("dB")),
        read: |text| quantity::plain(text, "dB"),
    };
    intents.extend(slider.show(ui, typed).map(Intent::MaxRise));
    if hold.has_rig {
        let place = show_place(hold.place_m);
        let text = format!(
            "The simulated sensor is {place} from the driven end (Plate, Measure). While the level is held, the finger on \
             the screen touches its plate."
        );
        say(ui, RichText::new(text).small().color(palette.weak));
    }
    say(ui, RichText::new(NOT_SHOWN).small().color(palette.weak));
    ui.add_space(4.0);
}

/// A tone's frequency, its correction and its state.
fn tone_state(scene: &Scene<'_>, tone: &ToneWords) -> String {
    let hertz = scene.hold.holding.frequency_hz(tone.slot);
    let name = hertz.map_or_else(|| format!("Tone {}", tone.slot + 1), show_frequency);
    // Never -0.0.
    let decibels = (10.0 * tone.correction_db).round() / 10.0 + 0.0;
    format!("{name}: {decibels:+.1} dB, {}", tone.words)
}

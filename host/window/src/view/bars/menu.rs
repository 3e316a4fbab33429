//! The menus of the top bar; every entry says what it does.

use crate::intent::{Dialog, Export, Intent, Intents};
use crate::scene::Scene;
use crate::settings::ThemeChoice;
use eframe::egui;
use slipline_instrument::CalibrationSide;
use slipline_model::export::figures::Format;
use slipline_model::field::sheet::SourceChoice;

/// One entry of a menu.
struct Entry<'a> {
    name: String,
    keys: &'a str,
    help: &'a str,
    /// Why it cannot be chosen now.
    refusal: Option<&'a str>,
}

fn entry<'a>(name: impl Into<String>, keys: &'a str, help: &'a str) -> Entry<'a> {
    Entry { name: name.into(), keys, help, refusal: None }
}

impl<'a> Entry<'a> {
    /// As it is, or refused for this reason.
    fn unless(self, is_refused: bool, reason: &'a str) -> Self {
        Self { refusal: is_refused.then_some(reason), ..self }
    }

    fn show(self, ui: &mut egui::Ui, intents: &mut Intents, intent: Intent) {
        let button = egui::Button::new(self.name).shortcut_text(self.keys);
        let button = ui.add_enabled(self.refusal.is_none(), button).on_hover_text(self.help);
        if button.on_disabled_hover_text(self.refusal.unwrap_or_default()).clicked() {
            intents.push(intent);
            ui.close();
        }
    }
}

/// The menus, side by side.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    // The longest of them is higher than the smallest screen.
    let room = ui.ctx().content_rect().bottom() - ui.max_rect().bottom() - 30.0;
    let file = ui.menu_button("File", |ui| {
        egui::ScrollArea::vertical()
            .min_scrolled_height(room)
            .max_height(room)
            .show(ui, |ui| file_menu(ui, scene, intents))
    });
    file.response.on_hover_text("Setups, plates and recordings: open, save and export them");
    let edit = ui.menu_button("Edit", |ui| edit_menu(ui, scene, intents));
    edit.response.on_hover_text("Undo changes of the setup, or switch between two setups");
    let view = ui.menu_button("View", |ui| view_menu(ui, scene, intents));
    view.response.on_hover_text("Colours of the window, its parts, and how the wave is computed");
    let help = ui.menu_button("Help", |ui| help_menu(ui, intents));
    help.response.on_hover_text("Keys, ports that cannot be opened, and what this program is");
}

fn file_menu(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let export = |what| Intent::Export(what);
    entry("New", "", "Begin again with the first scene; Undo brings this setup back").show(
        ui,
        intents,
        Intent::New,
    );
    let scenes = Intent::Dialog(Some(Dialog::Scenes));
    entry("Scenes…", "", "Setups to start from, each with a picture of what is felt")
        .show(ui, intents, scenes);
    let help = "A setup, a plate file or a recorded drag; files can be dropped on the window, too";
    entry("Open…", "Ctrl+O", help).show(ui, intents, Intent::OpenDialog);
    ui.add_enabled_ui(!scene.settings.recent.is_empty(), |ui| {
        let recent = ui.menu_button("Open recent", |ui| {
            for path in &scene.settings.recent {
                let name = path
                    .file_name()
                    .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
                let place = path.display().to_string();
                entry(name, "", &place).show(ui, intents, Intent::Open(path.clone()));
            }
        });
        let recent = recent.response.on_hover_text("Files that you opened or saved recently");
        recent.on_disabled_hover_text("You have not opened or saved a file yet");
    });
    let help = "Plate, tones, levels and feeling in one file, which the command line plays, too";
    entry("Save setup…", "Ctrl+S", help).show(ui, intents, Intent::SaveDialog);
    if scene.has_address {
        let help = "Copy the address of this page with the setup in it: everyone who opens it sees the same";
        entry("Share", "", help).show(ui, intents, Intent::Share);
    }
    let help = "The plate alone, as `slipline` and other setups read it";
    entry("Save plate…", "", help).show(ui, intents, Intent::SavePlateDialog);
    ui.separator();
    let help = "Plate, envelope and boundaries for print, as lines that scale";
    entry("Export figure (SVG)…", "", help).show(ui, intents, export(Export::Figure(Format::Svg)));
    #[cfg(not(target_arch = "wasm32"))]
    {
        let help = "Plate, envelope and boundaries for print, as pixels";
        entry("Export figure (PNG)…", "", help).show(ui, intents, export(Export::Figure(Format::Png)));
    }
    let help = "The largest displacement at each place, predicted and of the simulated plate";
    entry("Export envelope (CSV)…", "", help).show(ui, intents, export(Export::Envelope));
    let help = "The drive as the plot shows it, in shares of full scale over time";
    entry("Export waveform (CSV)…", "", help).show(ui, intents, export(Export::Waveform));
    let help = "The drive as sound, for other programs and sound cards";
    entry("Export drive (WAV)…", "", help).show(ui, intents, export(Export::Sound));
    let has_none = scene.recorder.recording().moves().is_empty();
    entry("Export recorded drag (CSV)…", "", "Where and when the lines were moved; Open plays it again")
        .unless(has_none, "Record a drag first, on the page Play")
        .show(ui, intents, export(Export::Recording));
    let help = "The window as it looks now";
    entry("Save screenshot (PNG)…", "", help).show(ui, intents, export(Export::Screenshot));
    let help = "Versions, counters, setup and log, to send with a question; you read them first";
    entry("Copy diagnostics", "", help).show(ui, intents, Intent::CopyDiagnostics);
}

fn edit_menu(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let name = |verb: &str, what: Option<&str>| {
        what.map_or_else(|| verb.to_owned(), |what| format!("{verb} {what}"))
    };
    entry(name("Undo", scene.undo.0), "Ctrl+Z", "Undo the latest change of the setup; a drag counts as one")
        .unless(scene.undo.0.is_none(), "Nothing was changed yet")
        .show(ui, intents, Intent::Undo);
    entry(name("Redo", scene.undo.1), "Ctrl+Y", "Repeat the change that was undone")
        .unless(scene.undo.1.is_none(), "Nothing was taken back")
        .show(ui, intents, Intent::Redo);
    let (name, help) = match scene.calibration_side {
        Some(CalibrationSide::Before) => ("Show after the calibration", "The calibrated plate again"),
        Some(CalibrationSide::After) | None => {
            ("Show before the calibration", "The plate as its file had it before it was calibrated")
        }
    };
    let refusal = "Calibrate a plate and use it first, on the page Measure";
    entry(name, "B", help).unless(scene.calibration_side.is_none(), refusal).show(
        ui,
        intents,
        Intent::BeforeOrAfter,
    );
    let name = format!("Switch to {}", scene.compare.side().other().letter());
    let help = "Two setups to compare: the plate follows at once, if it is driven";
    entry(name, "Ctrl+B", help).show(ui, intents, Intent::Switch);
}

fn view_menu(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    for choice in ThemeChoice::ALL {
        let help = match choice {
            ThemeChoice::Light => "Dark on bright, for a bright room",
            ThemeChoice::Dark => "Bright on dark, for a dark room",
            ThemeChoice::System => "As the desktop is set",
        };
        let radio = ui.radio(scene.settings.theme == choice, choice.name()).on_hover_text(help);
        if radio.clicked() {
            intents.push(Intent::Theme(choice));
            ui.close();
        }
    }
    ui.separator();
    let shown = [
        (
            scene.settings.show_panel,
            "Panel",
            "The pages at the right; without them the stage is wider (Ctrl+0)",
            Intent::ShowPanel as fn(bool) -> Intent,
        ),
        (
            scene.settings.show_plots,
            "Plots, meters and log",
            "The row at the bottom; without it the stage is higher (Ctrl+0)",
            Intent::ShowPlots,
        ),
    ];
    for (mut is_shown, name, help, intent) in shown {
        if ui.checkbox(&mut is_shown, name).on_hover_text(help).clicked() {
            intents.push(intent(is_shown));
            ui.close();
        }
    }
    ui.separator();
    for choice in SourceChoice::ALL {
        let radio = ui.radio(scene.settings.wave == choice, choice.name()).on_hover_text(choice.sentence());
        if radio.clicked() {
            intents.push(Intent::Wave(choice));
            ui.close();
        }
    }
}

fn help_menu(ui: &mut egui::Ui, intents: &mut Intents) {
    let help = "A minute over the real controls: line, finger, texture, measure, calibrate, your own plate";
    entry("Take the tour", "", help).show(ui, intents, Intent::BeginTour);
    for (name, keys, help, dialog) in [
        ("Shortcuts", "F1", "What every key and gesture does", Dialog::Shortcuts),
        (
            "Ports and permissions",
            "",
            "What to do when a device is missing or access is denied",
            Dialog::PortHelp,
        ),
        ("About Slipline", "", "The version, the idea, and the licences", Dialog::About),
    ] {
        entry(name, keys, help).show(ui, intents, Intent::Dialog(Some(dialog)));
    }
    let help =
        "Ten seconds: a finger strokes the simulated plate and the line moves. A press or a key ends it";
    entry("Show the demonstration", "", help).show(ui, intents, Intent::Demonstrate);
}

//! Pages in front of the window: scenes, the calibration, shortcuts, port help, about, diagnostics, a path to be typed,
//! confirmations, an actuator's profile, the board's self-test.

mod calibrate;
mod path;
mod profile;
mod scenes;
mod selftest;

use crate::intent::{Asks as _, Confirm, Dialog, Export, Intent, Intents};
use crate::scene::Scene;
use crate::view::bars::{status_line, top_bar};
use crate::view::room;
use crate::view::state::ViewState;
use crate::view::theme;
use crate::view::theme::GAP;
use eframe::egui::os::OperatingSystem;
use eframe::egui::{self, RichText};
use slipline_link::{udev, upkeep};
use slipline_model::export::report;

/// Every key and what it does.
pub(crate) const SHORTCUTS: [(&str, &str); 20] = [
    ("Esc", "STOP in every state, even while typing or in a page: silence; a real device is disarmed"),
    ("Space", "The same, but not while typing"),
    (
        "Esc or Space twice",
        "Within a second: emergency stop, a fault to be cleared; not on a silent simulated plate",
    ),
    ("Ctrl+Enter", "Drive"),
    ("Left, Right", "Move the boundary by 1 mm"),
    ("Shift+Left, Shift+Right", "Move the boundary by 0.1 mm"),
    ("Tab, Shift+Tab", "Next, previous control"),
    ("Enter", "Press the control; take a typed value"),
    ("Ctrl+Z, Ctrl+Y", "Undo, redo"),
    ("Ctrl+O, Ctrl+S", "Open, save the setup"),
    ("Ctrl+1 … Ctrl+6", "Boundary, tones, texture, plate, device, play"),
    ("Ctrl+B", "Switch between the setups A and B"),
    ("B", "After a calibration: switch between the plate before it and after it"),
    ("Ctrl+0", "The whole window for the stage, or panel and plots again"),
    ("P", "Pause the wave and the plots"),
    ("Click, double-click", "On plate and envelope: move the line here; add a tone here"),
    ("Wheel on a plot", "Zoom about the pointer; with Shift its values"),
    ("Drag, double click on a plot", "Move it, show all of it again"),
    ("Ctrl+Plus, Ctrl+Minus", "Zoom in, out"),
    ("F1", "This page"),
];

/// What Esc does while a page is open, beside its Close.
const ESC: &str = "Esc closes it, too, and always stops the drive";

/// Space between the edge of a page and its content, in points.
const MARGIN: i8 = 16;
/// Width of a page, and of one with much text, in points; less in a narrow window.
const USUAL: f32 = 460.0;
const WIDE: f32 = 620.0;
/// Least height of a page, even in a window that is too low for it, in points.
const LEAST_HEIGHT: f32 = 90.0;
/// Height of the calibration's pages without their buttons, in points; less in a low window.
const CALIBRATE: f32 = 520.0;
/// Height of the row with Close, and the space before it, in points.
const CLOSE: f32 = 26.0 + 2.0 * GAP;

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let Some(dialog) = scene.dialog else {
        view.typed_path = None;
        return;
    };
    let is_calibration = matches!(dialog, Dialog::Calibrate);
    let size = ui.ctx().content_rect().size();
    let is_beside = is_calibration && room::has_room_beside(size);
    let Placed { modal, room } =
        if is_beside { beside(ui, size) } else { centred(ui, size, is_wide(dialog)) };
    let response = modal.show(ui.ctx(), |ui| {
        ui.set_width(room.x);
        // The calibration's buttons keep their places from page to page.
        let is_fixed = is_calibration;
        let most = if is_fixed && !is_beside { (room.y - CLOSE).min(CALIBRATE) } else { room.y - CLOSE };
        // Without the least height an area in a page takes no more than it had: a page that grows would be cut.
        let area = egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most);
        // Each of its pages begins at its top.
        let page =
            scene.calibration.as_ref().filter(|_| is_fixed).map(|shown| shown.calibration.step.number());
        let area = area.auto_shrink([false, !is_fixed]).id_salt(page);
        let is_ended = area.show(ui, |ui| {
            theme::clear_of_bar(ui);
            match dialog {
                Dialog::Scenes => scenes::show(ui, scene, intents),
                Dialog::Shortcuts => shortcuts(ui),
                Dialog::PortHelp => port_help(ui, scene.asks_for_port, intents),
                Dialog::About => about(ui),
                Dialog::Diagnostics => diagnostics(ui, scene, intents),
                Dialog::Calibrate => calibrate::show(ui, scene, view, intents),
                Dialog::Selftest => selftest::show(ui, scene, intents),
                Dialog::Path(question) => return path::show(ui, question, &mut view.typed_path, intents),
                Dialog::Confirm(confirm) => return confirmation(ui, *confirm, scene, intents),
                Dialog::Profile(profile) => return profile::show(ui, profile, scene, intents),
            }
            false
        });
        if matches!(dialog, Dialog::Path(_) | Dialog::Confirm(_) | Dialog::Profile(_)) {
            return is_ended.inner;
        }
        ui.add_space(GAP);
        if matches!(dialog, Dialog::Calibrate) {
            return calibrate::steps(ui, scene, intents);
        }
        ui.horizontal(|ui| {
            let is_closed =
                ui.button("Close").on_hover_text("Back to the window; nothing is changed").clicked();
            ui.label(RichText::new(ESC).small().color(theme::palette(ui).weak));
            is_closed
        })
        .inner
    });
    // A press on the plate, which is in sight beside the calibration, does not end it.
    let is_beside_it = is_calibration && response.backdrop_response.clicked();
    if response.inner || (response.should_close() && !is_beside_it) {
        intents.push(Intent::Dialog(None));
    }
}

/// A page's place in the window, and the room within its margins, in points.
struct Placed {
    modal: egui::Modal,
    room: egui::Vec2,
}

/// In the middle of the window, low enough to stay clear of STOP, which is drawn above every page.
fn centred(ui: &egui::Ui, size: egui::Vec2, is_wide: bool) -> Placed {
    let most = size - egui::Vec2::splat(2.0 * f32::from(MARGIN));
    let width = if is_wide { WIDE } else { USUAL };
    let frame = egui::Frame::popup(ui.style()).inner_margin(MARGIN);
    Placed {
        modal: egui::Modal::new(egui::Id::unique("dialog")).frame(frame),
        room: egui::vec2(
            width.min(most.x - 2.0 * GAP).max(0.0),
            (most.y - 2.0 * top_bar::HEIGHT).max(LEAST_HEIGHT),
        ),
    }
}

/// At the right of the stage, which stays as bright as it is but for a trace, between the top bar and the status line.
fn beside(ui: &egui::Ui, size: egui::Vec2) -> Placed {
    let id = egui::Id::unique("dialog");
    let under = egui::vec2(0.0, top_bar::HEIGHT);
    let area = egui::Modal::default_area(id).anchor(egui::Align2::RIGHT_TOP, under);
    let frame = egui::Frame::new()
        .fill(theme::palette(ui).panel)
        .stroke(egui::Stroke::new(1.0, theme::palette(ui).line))
        .inner_margin(MARGIN);
    let outer = egui::vec2(room::BESIDE, size.y - top_bar::HEIGHT - status_line::HEIGHT);
    Placed {
        modal: egui::Modal::new(id)
            .area(area)
            .frame(frame)
            .backdrop_color(egui::Color32::from_black_alpha(1)),
        room: outer - frame.total_margin().sum(),
    }
}

/// Whether a page has much text, or a picture.
const fn is_wide(dialog: &Dialog) -> bool {
    matches!(
        dialog,
        Dialog::Calibrate | Dialog::Diagnostics | Dialog::PortHelp | Dialog::Scenes | Dialog::Selftest
    )
}

/// Width of the column of keys, in points.
const KEYS: f32 = 170.0;

fn shortcuts(ui: &mut egui::Ui) {
    ui.heading("Shortcuts");
    ui.add_space(6.0);
    for (keys, action) in SHORTCUTS {
        ui.horizontal_top(|ui| {
            let column = egui::vec2(KEYS, ui.spacing().interact_size.y);
            ui.allocate_ui_with_layout(column, egui::Layout::left_to_right(egui::Align::Min), |ui| {
                ui.set_min_width(KEYS);
                ui.label(RichText::new(keys).strong());
            });
            ui.add(egui::Label::new(action).wrap());
        });
    }
}

/// What helps with ports on the user's own system; in a browser, which lists and names them itself, only what that leaves.
fn port_help(ui: &mut egui::Ui, is_browser: bool, intents: &mut Intents) {
    ui.heading("Ports and permissions");
    ui.add_space(6.0);
    let help = |ui: &mut egui::Ui, question: &str, answer: &str| {
        ui.label(RichText::new(question).strong());
        ui.add(egui::Label::new(answer).wrap());
        ui.add_space(4.0);
    };
    let again = if is_browser { "press \"A board by USB…\" and choose it" } else { "press Look again" };
    help(
        ui,
        "The device is not listed",
        &format!(
            "Use a cable that carries data, not a charging cable. The board shows up a second after it is plugged in; then {again}."
        ),
    );
    let system = ui.ctx().os();
    let is_unknown = system == OperatingSystem::Unknown;
    if system == OperatingSystem::Windows || is_unknown {
        help(
            ui,
            "Windows",
            "The port works with the system's own driver. If it is listed but busy, close other serial programs.",
        );
    }
    if (system == OperatingSystem::Mac || is_unknown) && !is_browser {
        help(ui, "macOS", "Choose the port that begins with /dev/cu.");
    }
    if system == OperatingSystem::Nix || is_unknown {
        help(
            ui,
            "Linux: no permission",
            "Put the rules below into /etc/udev/rules.d/70-slipline.rules (the two lines at their top do it) and plug the device in again. Or join the group dialout (on some systems uucp) and log in again.",
        );
        udev_rules(ui, intents);
    }
}

fn udev_rules(ui: &mut egui::Ui, intents: &mut Intents) {
    egui::Frame::group(ui.style()).show(ui, |ui| {
        ui.add(egui::Label::new(RichText::new(udev::RULES).monospace().small()).wrap());
    });
    if ui
        .button("Copy the rules")
        .on_hover_text("Put them on the clipboard, to paste them into that file")
        .clicked()
    {
        intents.push(Intent::Copy(udev::RULES.to_owned()));
    }
}

fn about(ui: &mut egui::Ui) {
    ui.heading(format!("Slipline {}", env!("CARGO_PKG_VERSION")));
    ui.add_space(6.0);
    for text in [
        "A tactile display on a tapered plate: a wave travels to its turning point, peaks and dies out. The frequency sets where.",
        "What a finger feels is illustrative: calibrate on your own plate.",
        "MIT OR Apache-2.0. Fonts: Ubuntu (Ubuntu font licence), Noto and Hack as they come with egui.",
    ] {
        ui.add(egui::Label::new(text).wrap());
        ui.add_space(4.0);
    }
}

/// Height of the diagnostics text, in points; less in a small window.
const DIAGNOSTICS: f32 = 380.0;

fn diagnostics(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    ui.heading("Diagnostics");
    ui.add_space(6.0);
    ui.label("The diagnostic text is on the clipboard now: read it before you send it.");
    ui.label("It contains neither your name nor that of your computer.");
    let text = report::text(scene.snapshot, scene.setup, scene.table);
    ui.horizontal(|ui| {
        ui.button("Copy again")
            .on_hover_text("Put the text below on the clipboard once more")
            .asks(intents, Intent::CopyDiagnostics);
        ui.button("Save diagnostics…")
            .on_hover_text("Write the text below into a file")
            .asks(intents, Intent::Export(Export::Diagnostics));
    });
    let height = (ui.ctx().content_rect().height() - 310.0).clamp(60.0, DIAGNOSTICS);
    egui::Frame::group(ui.style()).show(ui, |ui| {
        let area = egui::ScrollArea::both().max_height(height).auto_shrink([false, false]);
        area.show(ui, |ui| {
            ui.add(egui::Label::new(RichText::new(text).monospace()).extend());
        });
    });
}

/// Title, explanation and button text.
const fn words(confirm: Confirm) -> (&'static str, &'static str, &'static str) {
    match confirm {
        Confirm::Arm => (
            "Arm the device?",
            "The amplifier is unmuted and the plate can move as soon as it is driven. Keep hands and loose things off the actuator. STOP, Esc and Space stop and disarm it; twice within a second they are an emergency stop.",
            "Arm",
        ),
        Confirm::Store => (
            "Overwrite what the device keeps?",
            "The device's present table replaces the one in its flash and is used from the next start on. An armed device is disarmed first: for up to 5 s it takes no stop.",
            "Overwrite",
        ),
        Confirm::Forget => (
            "Erase what the device keeps?",
            "The table in the device's flash is erased. The one in use stays. An armed device is disarmed first: for up to 5 s it takes no stop.",
            "Erase",
        ),
        Confirm::Bootloader => (
            "Restart into the bootloader?",
            "The device leaves Slipline and waits for new firmware. It comes back after flashing, or when it is plugged in again. If the board keeps a profile, press its user button and hold it until the board restarts.",
            "Restart",
        ),
        Confirm::BrownOutLevel => (
            "Set the board's brown-out level?",
            "The board writes the level that it needs, and restarts. Press its user button and hold it meanwhile.",
            "Set",
        ),
    }
}

fn confirmation(ui: &mut egui::Ui, confirm: Confirm, scene: &Scene<'_>, intents: &mut Intents) -> bool {
    let (title, text, mut verb) = words(confirm);
    ui.heading(title);
    ui.add_space(6.0);
    ui.add(egui::Label::new(text).wrap());
    if confirm == Confirm::Arm
        && let Some(sentence) = scene.asks_before_arming()
    {
        ui.add_space(6.0);
        let warning = RichText::new(sentence).color(theme::palette(ui).warn);
        ui.add(egui::Label::new(warning).wrap());
        ui.add(egui::Label::new("Slipline asks this once for each board.").wrap());
        verb = "Arm anyway";
    }
    if confirm == Confirm::BrownOutLevel {
        ui.add_space(6.0);
        let risk = RichText::new(upkeep::OPTION_BYTES_RISK).color(theme::palette(ui).warn);
        ui.add(egui::Label::new(risk).wrap());
    }
    ui.add_space(10.0);
    ui.horizontal(|ui| {
        let is_cancelled = ui.button("Cancel").on_hover_text("Leave everything as it is").clicked();
        let confirm_button = ui.add(theme::primary(ui, verb, true));
        let is_confirmed =
            confirm_button.on_hover_text("Carry out the action that is described above").clicked();
        if is_confirmed {
            intents.push(Intent::Confirmed(confirm));
        }
        is_cancelled || is_confirmed
    })
    .inner
}

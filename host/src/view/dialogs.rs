//! Pages in front of the window: shortcuts, port help, about, confirmations; and the message bar.

use super::intent::{Confirm, Dialog, Intent, Intents};
use super::{Scene, ViewState, bottom, theme};
use crate::app::Notice;
use eframe::egui::{self, Align2, RichText, Sense, vec2};
use std::time::Duration;

/// Every key and what it does.
pub(super) const SHORTCUTS: [(&str, &str); 14] = [
    ("Esc", "STOP, in every state, even while typing"),
    ("Space", "STOP, in every state but while typing"),
    ("Ctrl+Enter", "Drive"),
    ("Left, Right", "Move the boundary by 1 mm"),
    ("Shift+Left, Shift+Right", "Move the boundary by 0.1 mm"),
    ("Tab, Shift+Tab", "Next, previous control"),
    ("Enter", "Press the control; take a typed value"),
    ("Ctrl+Z, Ctrl+Y", "Undo, redo"),
    ("Ctrl+O, Ctrl+S", "Open, save the setup"),
    ("Ctrl+1 … Ctrl+4", "Boundary, tones, plate, device"),
    ("P", "Pause the wave and the plots"),
    ("Double click", "On the plate: add a tone there"),
    ("Ctrl+Plus, Ctrl+Minus", "Larger, smaller"),
    ("F1", "This page"),
];

/// A message and since when it stands, in seconds of the window's time.
pub(crate) struct Standing {
    notice: Notice,
    since_s: f64,
}

/// How long a message stands that tells of nothing wrong, in seconds.
const NOTICE_S: f64 = 5.0;

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    notice(ui, scene, view, intents);
    let Some(dialog) = scene.dialog else { return };
    let response = egui::Modal::new(egui::Id::unique("dialog")).show(ui.ctx(), |ui| {
        ui.set_width(460.0);
        match dialog {
            Dialog::Shortcuts => shortcuts(ui),
            Dialog::PortHelp => port_help(ui, intents),
            Dialog::About => about(ui),
            Dialog::Confirm(confirm) => return confirmation(ui, *confirm, intents),
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| ui.button("Close").clicked()).inner
    });
    if response.inner || response.should_close() {
        intents.push(Intent::Dialog(None));
    }
}

/// The message lies over the log, which tells the same: it covers nothing that is needed.
fn notice(ui: &egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let Some(notice) = scene.notice else {
        view.notice = None;
        return;
    };
    let now_s = ui.input(|input| input.time);
    if view.notice.as_ref().is_none_or(|standing| standing.notice != *notice) {
        view.notice = Some(Standing { notice: notice.clone(), since_s: now_s });
    }
    if let Some(standing) = view.notice.as_ref().filter(|standing| !standing.notice.is_error) {
        let left_s = standing.since_s + NOTICE_S - now_s;
        if left_s <= 0.0 {
            intents.push(Intent::DismissNotice);
            return;
        }
        ui.ctx().request_repaint_after(Duration::from_secs_f64(left_s));
    }
    let palette = theme::palette(ui);
    let colour = if notice.is_error { palette.bad } else { palette.accent };
    let frame = egui::Frame::popup(ui.style()).stroke(egui::Stroke::new(1.5, colour));
    let width = (bottom::log_width(ui.ctx().content_rect().width()) - frame.total_margin().sum().x).max(40.0);
    let area = egui::Area::new(egui::Id::unique("notice")).anchor(Align2::RIGHT_BOTTOM, vec2(-14.0, -10.0));
    let shown = area.sense(Sense::click()).show(ui.ctx(), |ui| {
        frame
            .show(ui, |ui| {
                ui.set_width(width);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
                    let is_dismissed = ui.button("Dismiss").clicked();
                    let text = RichText::new(&notice.text).color(palette.text);
                    let label = egui::Label::new(text).wrap().selectable(false);
                    ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| ui.add(label));
                    is_dismissed
                })
                .inner
            })
            .inner
    });
    if shown.inner || shown.response.clicked() {
        intents.push(Intent::DismissNotice);
    }
}

fn shortcuts(ui: &mut egui::Ui) {
    ui.heading("Shortcuts");
    ui.add_space(6.0);
    egui::Grid::new("shortcuts").num_columns(2).spacing([28.0, 6.0]).show(ui, |ui| {
        for (keys, action) in SHORTCUTS {
            ui.label(RichText::new(keys).strong());
            ui.label(action);
            ui.end_row();
        }
    });
}

/// The udev rule that lets the user at the screen open a device.
pub(crate) const UDEV_RULE: &str = concat!(
    "SUBSYSTEM==\"tty\", ATTRS{idVendor}==\"1209\", ATTRS{idProduct}==\"0001\", ",
    "ENV{ID_MM_DEVICE_IGNORE}=\"1\", TAG+=\"uaccess\""
);

fn port_help(ui: &mut egui::Ui, intents: &mut Intents) {
    ui.heading("Ports and permissions");
    ui.add_space(6.0);
    for (question, answer) in [
        (
            "The device is not listed",
            "Use a cable that carries data, not a charging cable. The board shows up a second after it is plugged in; then press Look again.",
        ),
        (
            "Linux: no permission",
            "Put the rule below into /etc/udev/rules.d/70-slipline.rules and plug the device in again. Or join the group dialout (on some systems uucp) and log in again.",
        ),
        (
            "Windows",
            "The port works with the system's own driver. If it is listed but busy, close other serial programs.",
        ),
        ("macOS", "Choose the port that begins with /dev/cu."),
    ] {
        ui.label(RichText::new(question).strong());
        ui.add(egui::Label::new(answer).wrap());
        ui.add_space(4.0);
    }
    egui::Frame::group(ui.style()).show(ui, |ui| {
        ui.add(egui::Label::new(RichText::new(UDEV_RULE).monospace().small()).wrap());
    });
    if ui.button("Copy the rule").clicked() {
        intents.push(Intent::Copy(UDEV_RULE.to_owned()));
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

/// Title, what happens, and the word on the button.
const fn words(confirm: Confirm) -> (&'static str, &'static str, &'static str) {
    match confirm {
        Confirm::Arm => (
            "Arm the device?",
            "The amplifier is unmuted and the plate can move as soon as it is driven. Keep hands and loose things off the actuator. STOP, Esc and Space stop it.",
            "Arm",
        ),
        Confirm::Store => (
            "Overwrite what the device keeps?",
            "The device's present table replaces the one in its flash and is used from the next start on.",
            "Overwrite",
        ),
        Confirm::Forget => (
            "Erase what the device keeps?",
            "The table in the device's flash is erased. The one in use stays.",
            "Erase",
        ),
        Confirm::Bootloader => (
            "Restart into the bootloader?",
            "The device leaves Slipline and waits for new firmware. It comes back after flashing, or when it is plugged in again.",
            "Restart",
        ),
    }
}

fn confirmation(ui: &mut egui::Ui, confirm: Confirm, intents: &mut Intents) -> bool {
    let (title, text, verb) = words(confirm);
    ui.heading(title);
    ui.add_space(6.0);
    ui.add(egui::Label::new(text).wrap());
    ui.add_space(10.0);
    ui.horizontal(|ui| {
        let is_cancelled = ui.button("Cancel").clicked();
        let is_confirmed = ui.button(RichText::new(verb).strong()).clicked();
        if is_confirmed {
            intents.push(Intent::Confirmed(confirm));
        }
        is_cancelled || is_confirmed
    })
    .inner
}

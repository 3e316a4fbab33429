//! The device panel: port, connection, table, counters.

use crate::intent::{Asks as _, Confirm, DeviceIntent, Dialog, Intent, Intents, MeasureIntent};
use crate::scene::Scene;
use crate::view::bars::top_bar;
use crate::view::fields::field::{InputField, labelled, row};
use crate::view::fields::lines::lines;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_link::protocol::event::State;
use slipline_link::{LinkError, LinkState, Port, upkeep};

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    ports(ui, scene, view, intents);
    ui.separator();
    connection(ui, scene, intents);
    if scene.snapshot.is_connected() {
        ui.separator();
        identity(ui, scene, intents);
        ui.separator();
        table(ui, scene, intents);
        ui.separator();
        quality(ui, scene);
        ui.separator();
        service(ui, scene, intents);
    }
}

/// Height of a port in the list, in points, and the number of ports for which the list always has room.
const PORT: f32 = 28.0;
const LISTED: f32 = 3.0;

fn ports(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        theme::heading(ui, "Ports");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.small_button("Look again")
                .on_hover_text(top_bar::LOOK_AGAIN)
                .asks(intents, Intent::RefreshPorts);
        });
    });
    let end = ui.cursor().top() + LISTED * (PORT + ui.spacing().item_spacing.y);
    for info in scene.ports {
        let is_current = scene.snapshot.link.port.as_ref() == Some(&info.port);
        let badge = match info.port {
            Port::Simulated => "simulated",
            Port::Serial(_) | Port::Unix(_) if info.is_ours => "Slipline",
            Port::Serial(_) | Port::Unix(_) => "",
        };
        let badge = RichText::new(badge).small().color(palette.accent);
        let size = egui::vec2(ui.available_width(), PORT);
        let button =
            egui::Button::selectable(is_current, &info.label).right_text(badge).truncate().min_size(size);
        let help = format!("{}: press to connect to it", info.port);
        let is_open = is_current && scene.snapshot.is_connected();
        if ui.add(button).on_hover_text(help).clicked() && !is_open {
            intents.push(Intent::Connect(info.port.clone()));
        }
    }
    let (name, help) = top_bar::ASK_FOR_PORT;
    if scene.asks_for_port && ui.button(name).on_hover_text(help).clicked() {
        intents.push(Intent::AskForPort);
    }
    if scene.ports.len() <= 1 {
        ui.label(RichText::new("No serial port found.").small().color(palette.weak));
    }
    // A board that is plugged in moves nothing.
    ui.add_space((end - ui.cursor().top()).max(0.0));
    // A browser opens no port by its name.
    if !scene.asks_for_port {
        another_port(ui, scene, view, intents);
    }
    let missing = ui.link("My device is missing or access is denied");
    missing
        .on_hover_text("Cables, permissions and drivers: what to look at")
        .asks(intents, Intent::Dialog(Some(Dialog::PortHelp)));
}

fn another_port(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    labelled(ui, "Another port", |ui| {
        let current = scene.snapshot.link.port.as_ref().map_or_else(String::new, ToString::to_string);
        let hint = "unix:PATH of a served device, or a serial port's name. Enter connects to it and arms no real device";
        let field = InputField::new("Another port", &current, hint, ui.available_width() - 8.0);
        intents.extend(field.show(ui, &mut view.fields, str::parse).map(Intent::Connect));
    });
}

/// Width of the buttons of a connection, in points.
const BUTTON: f32 = 90.0;

fn connection(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let snapshot = scene.snapshot;
    let (word, colour, sentence) = top_bar::state_words(scene, palette);
    row(ui, "State", RichText::new(word).color(colour));
    lines(ui, sentence, palette.weak, 2);
    if matches!(snapshot.link.error, Some(LinkError::NoPermission(_))) {
        ui.button("Permit this port…")
            .on_hover_text(
                "The rules by which the system lets you open it, to be copied, and how to install them",
            )
            .asks(intents, Intent::Dialog(Some(Dialog::PortHelp)));
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().button_padding.x = 6.0;
        // The first button keeps its width when its label changes, so that its neighbours do not move.
        let button = |ui: &mut egui::Ui, name: &str, is_due: bool| {
            ui.add(theme::primary(ui, name, is_due).min_size(egui::vec2(BUTTON, 0.0)))
        };
        let is_open = !matches!(snapshot.link.state, LinkState::Disconnected);
        let again = "Open the same port again; the device comes back disarmed";
        if matches!(snapshot.link.state, LinkState::Lost(_))
            && button(ui, "Reconnect", true).on_hover_text(again).clicked()
        {
            intents.push(Intent::Connect(snapshot.link.port.clone().unwrap_or(Port::Simulated)));
        }
        if is_open {
            button(ui, "Disconnect", false)
                .on_hover_text("Stop, disarm and close the port")
                .asks(intents, Intent::Device(DeviceIntent::Disconnect));
        } else if button(ui, "Connect", true).on_hover_text("Open the port that was chosen last").clicked() {
            intents.push(Intent::Connect(snapshot.link.port.clone().unwrap_or(Port::Simulated)));
        }
    });
    ui.horizontal(|ui| {
        let mut looks = snapshot.link.auto_reconnect;
        let switch = ui.checkbox(&mut looks, "Reconnect by itself");
        switch
            .on_hover_text("Look for a lost device, which comes back disarmed, and wait for a missing port")
            .asks(intents, Intent::Device(DeviceIntent::AutoReconnect(looks)));
    });
}

fn identity(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let snapshot = scene.snapshot;
    let Some(identity) = &snapshot.device.identity else { return };
    let (major, minor, patch) = identity.firmware;
    row(ui, "Board", identity.board.as_str());
    row(ui, "Firmware", format!("{major}.{minor}.{patch} ({})", identity.build));
    row(ui, "Protocol", format!("{}.{}", identity.version.major, identity.version.minor));
    if let Some(unit) = snapshot.unit() {
        row(ui, "Unit", RichText::new(unit).monospace().small());
    }
    row(
        ui,
        "Rate",
        format!("{:.0} kS/s, {} bits", f64::from(identity.sample_rate_hz) * 1e-3, identity.dac_bits),
    );
    if let Some(maintenance) = &snapshot.device.maintenance {
        let colour = |is_good: bool| if is_good { palette.text } else { palette.warn };
        let wear =
            RichText::new(upkeep::wear(maintenance)).color(colour(upkeep::worn(maintenance).is_none()));
        row(ui, "Flash erased", wear);
        let level =
            RichText::new(upkeep::brown_out_level(maintenance)).color(colour(maintenance.brown_out_guarded));
        row(ui, "Brown-out level", level);
        let warnings = upkeep::before_arming(maintenance)
            .map(str::to_owned)
            .into_iter()
            .chain(upkeep::worn(maintenance));
        for warning in warnings {
            ui.label(RichText::new(warning).small().color(palette.warn));
        }
        if !maintenance.brown_out_guarded && snapshot.sets_brown_out_level() {
            ui.button("Set brown-out level…")
                .on_hover_text("Have the board write the level into its chip's option bytes, once")
                .asks(intents, Intent::Dialog(Some(Dialog::Confirm(Confirm::BrownOutLevel))));
        }
    }
    if let Some(wear) = snapshot.device.wear.as_ref().filter(|_| snapshot.keeps_profile()) {
        row(ui, "Profile's flash", upkeep::profile_wear(wear));
    }
    if let Some(report) = snapshot.device.profile.as_ref().filter(|_| snapshot.keeps_profile()) {
        let name = report.profile.as_ref().map_or("none", |profile| profile.name.as_str());
        row(ui, "Actuator profile", name);
    }
    if let Some(warning) = snapshot.device.board.as_ref().and_then(upkeep::muted_for_good) {
        ui.label(RichText::new(warning).small().color(palette.warn));
    }
    if let Some(warning) = snapshot.device.analogue.as_ref().and_then(upkeep::wrong_reference) {
        ui.label(RichText::new(warning).small().color(palette.warn));
    }
    if let Some(compatibility) = snapshot.device.compatibility {
        let colour = if compatibility.may_drive() { palette.weak } else { palette.wrong };
        ui.label(RichText::new(compatibility.sentence()).small().color(colour));
    }
    if !identity.crash.is_empty() {
        let text = format!("It crashed before: {}", identity.crash);
        ui.label(RichText::new(text).small().color(palette.warn));
    }
    let has_faults = snapshot.drive.status.is_some_and(|status| !status.faults.is_empty());
    let clear = ui.add_enabled(has_faults, egui::Button::new("Clear faults"));
    let clear = clear.on_hover_text("Clear the latched faults whose cause is gone");
    clear
        .on_disabled_hover_text("There is no fault")
        .asks(intents, Intent::Device(DeviceIntent::ClearFaults));
}

fn table(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let snapshot = scene.snapshot;
    theme::heading(ui, "Turning-point table");
    let device = &snapshot.table;
    let on_device = device.report.active;
    let on_device =
        on_device.map_or("none".to_owned(), |header| format!("{:08x}, {} knots", header.crc, header.knots));
    row(ui, "On the device", RichText::new(on_device).monospace().small());
    let on_screen = scene.table_crc().map_or("being made".to_owned(), |crc| format!("{crc:08x}"));
    row(ui, "On the screen", RichText::new(on_screen).monospace().small());
    let (text, colour) = match (device.upload, scene.is_table_dirty(), device.upload_verified) {
        (Some(progress), ..) => (format!("sending {} of {}", progress.sent, progress.total), palette.weak),
        (None, true, Some(false)) => ("the digest read back is not the one sent".to_owned(), palette.wrong),
        (None, true, _) => ("they differ".to_owned(), palette.warn),
        (None, false, Some(true)) => ("the same: verified by its digest".to_owned(), palette.good),
        (None, false, _) => ("the same".to_owned(), palette.good),
    };
    row(ui, "Which are", RichText::new(text).color(colour));
    let (text, colour) = match snapshot.drive.travel_limit {
        Some(_) => ("limited by the device", palette.good),
        None if !snapshot.can_limit_travel() => ("not limited: the firmware is too old", palette.warn),
        None => ("not limited", palette.weak),
    };
    row(ui, "Actuator's travel", RichText::new(text).color(colour));
    ui.horizontal(|ui| {
        if let Some(progress) = snapshot.table.upload {
            let share = f32::from(progress.sent) / f32::from(progress.total.max(1));
            ui.add(egui::ProgressBar::new(share).desired_width(170.0).show_percentage());
            let cancel = ui.button("Cancel upload");
            cancel
                .on_hover_text("Cancel it; the device keeps its present table")
                .asks(intents, Intent::Device(DeviceIntent::CancelUpload));
        } else {
            let upload = theme::primary(ui, "Upload", scene.is_table_dirty());
            let upload = ui.add_enabled(scene.table_crc().is_some(), upload);
            let upload =
                upload.on_hover_text("Send the table of the plate on the screen, and compare its digest");
            upload.on_disabled_hover_text("The table is being made").asks(intents, Intent::Upload);
            ui.button("Read back")
                .on_hover_text("Ask the device which table it holds")
                .asks(intents, Intent::Device(DeviceIntent::ReadBack));
        }
    });
}

fn quality(ui: &mut egui::Ui, scene: &Scene<'_>) {
    theme::heading(ui, "Link");
    let snapshot = scene.snapshot;
    let ms = |time: std::time::Duration| format!("{:.2} ms", time.as_secs_f64() * 1e3);
    let mut counter = |name: &str, value: String, help: &str| row(ui, name, value).on_hover_text(help);
    let round_trip =
        format!("{}, worst {}", ms(snapshot.link.round_trip.average), ms(snapshot.link.round_trip.worst));
    counter("Round trip", round_trip, "From a command to its answer");
    let link = snapshot.link.counters;
    counter("Commands", link.commands.to_string(), "How many were sent, repeats not counted");
    let lost = format!("{} / {}", link.retries, link.timeouts);
    counter(
        "Retries / time-outs",
        lost,
        "Commands sent again, and answers that did not come in time: a bad cable or a busy port",
    );
    let help = "Drives that a newer one or a stop replaced before they were sent, as in a drag";
    counter("Superseded drives", link.superseded.to_string(), help);
    let help = "Messages of the device that arrived damaged; the commands that wait for them are sent again";
    counter("CRC errors (computer)", snapshot.link.decoder.damaged.to_string(), help);
    if let Some(status) = snapshot.drive.status {
        let device = status.counters;
        let help = "Commands that arrived damaged at the device; it did not act on them";
        counter("CRC errors (device)", device.crc_errors.to_string(), help);
        let help = "Answers that this computer did not take in time, and commands that a stop or a full queue left out";
        counter("Dropped (device)", device.dropped.to_string(), help);
        let help = "Commands that the device got twice and acted on once";
        counter("Repeats (device)", device.duplicates.to_string(), help);
        let failed = format!("{} / {}", device.underruns, device.clips);
        counter(
            "Underruns / clips",
            failed,
            "Times the DAC ran out of samples, and samples that were beyond its range",
        );
        if device.max_cycles > 0 {
            let help = "The longest time that the device's processor needed for a block of the drive";
            let share = snapshot.worst_block();
            let percent = share.map(|share| format!(" ({:.0} %)", share * 100.0)).unwrap_or_default();
            counter("Cycles a block, most", format!("{}{percent}", device.max_cycles), help);
            if let Some(warning) = share.and_then(upkeep::hardly_in_time) {
                ui.label(RichText::new(warning).small().color(theme::palette(ui).warn));
            }
        }
    }
}

/// Why the buttons that write to flash are disabled.
const SOUNDS: &str = "Only while nothing sounds";

fn service(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    theme::heading(ui, "Service");
    let state = scene.snapshot.drive.status.map(|status| status.state);
    // With a fault it is disarmed, and some faults are cured by storing again.
    let is_silent = matches!(state, Some(State::Idle | State::Armed | State::Fault));
    // An incompatible device may report no state, and flashing it is the remedy, so this must stay possible.
    let is_muted = matches!(state, None | Some(State::Idle | State::Fault | State::SafeMode));
    ui.horizontal_wrapped(|ui| {
        for (name, help, may, otherwise, confirm) in [
            (
                "Keep table…",
                "Keep the device's table in its flash, used from the next start on",
                is_silent,
                SOUNDS,
                Confirm::Store,
            ),
            ("Forget table…", "Erase the table kept in flash", is_silent, SOUNDS, Confirm::Forget),
            (
                "Bootloader…",
                "Restart into the ROM bootloader to flash firmware",
                is_muted,
                "Only while it is disarmed",
                Confirm::Bootloader,
            ),
        ] {
            let button = ui.add_enabled(may, egui::Button::new(name));
            button
                .on_hover_text(help)
                .on_disabled_hover_text(otherwise)
                .asks(intents, Intent::Dialog(Some(Dialog::Confirm(confirm))));
        }
        let may_compare = is_silent && scene.table_crc().is_some() && !scene.is_table_dirty();
        let compare = ui.add_enabled(may_compare, egui::Button::new("Compare codes"));
        compare
            .on_hover_text("Play 16 tones, 90 % of full scale together, for two seconds, and compare the device's codes with the mirror's")
            .on_disabled_hover_text("Only while nothing sounds, with the plate's table on the device")
            .asks(intents, Intent::Measure(MeasureIntent::Verify));
        let test = ui.button("Test this board…");
        test.on_hover_text("Clocks, supply, mute pin, converters, codes and link, by a wire or two, with the amplifier muted")
            .asks(intents, Intent::Dialog(Some(Dialog::Selftest)));
        let keeps_one = scene.snapshot.keeps_profile();
        let profile = ui.add_enabled(keeps_one && is_silent, egui::Button::new("Actuator profile…"));
        let profile =
            profile.on_hover_text("Open the TOML file of an actuator's profile, and write it to the board");
        let otherwise = if keeps_one {
            SOUNDS
        } else {
            "Only a real board keeps one, with firmware of protocol 1.3 or newer"
        };
        profile.on_disabled_hover_text(otherwise).asks(intents, Intent::OpenDialog);
    });
}

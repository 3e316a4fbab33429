//! The top bar: the connected device, its state, and STOP.

use crate::intent::{Asks as _, DeviceIntent, Dialog, Intent, Intents};
use crate::scene::Scene;
use crate::view::bars::{menu, offers};
use crate::view::stage::aligned::{self, Width};
use crate::view::theme;
use eframe::egui::{self, Color32, CornerRadius, FontId, RichText, Sense, Stroke, Vec2, pos2, vec2};
use slipline_instrument::autopilot::drive_arms;
use slipline_instrument::{SAFE_MODE, fault_sentence};
use slipline_link::protocol::event::{Fault, State, Status};
use slipline_link::{LinkError, LinkState, Port};
use theme::Palette;

/// What looking for ports again does.
pub(crate) const LOOK_AGAIN: &str = "Search this computer's ports once more, after a device was plugged in";

/// The entry by which a browser is asked for a board, and what it does.
pub(crate) const ASK_FOR_PORT: (&str, &str) =
    ("A board by USB…", "Choose a board in the browser's list: this page then lists it among its ports");

/// Height of the bar with its margins, in points.
pub(crate) const HEIGHT: f32 = STOP.y + 20.0;
/// Size of the STOP button, in points.
const STOP: Vec2 = vec2(104.0, 34.0);
/// What STOP does, with a click or a key.
const STOP_HELP: &str = "Ramps to silence now; a real device is also disarmed. Twice within a second: emergency stop, \
    silent within 2 ms, with a fault to be cleared. Keys: Esc or Space, in every state";

/// What a measurement does to the drive of the setup.
const MEASURING: &str = "The setup does not sound until it is done.";

/// The error text as a whole sentence.
fn sentence(trouble: &LinkError) -> String {
    let text = slipline_link::capitalized(&trouble.to_string());
    let end = if text.ends_with(['.', '?', '!']) { "" } else { "." };
    text + end
}

/// The content of the state chip: a word, its colour, and a sentence.
pub(crate) fn state_words(scene: &Scene<'_>, palette: &Palette) -> (&'static str, Color32, String) {
    let snapshot = scene.snapshot;
    if let Some(progress) = scene.measure.live.progress {
        let why =
            if scene.measure.live.is_checking { "Quiet tones first: is the drive on?" } else { MEASURING };
        return ("measuring", palette.accent, format!("Measuring: {progress}. {why}"));
    }
    match &snapshot.link.state {
        LinkState::Disconnected => {
            let why = snapshot.link.error.as_ref().map_or_else(|| "No port is open.".to_owned(), sentence);
            ("disconnected", palette.weak, why)
        }
        LinkState::Connecting => ("connecting", palette.warn, "Waiting for the device's answer.".to_owned()),
        LinkState::Lost(trouble) => ("lost", palette.wrong, sentence(trouble)),
        LinkState::Reconnecting(trouble @ LinkError::NoSuchPort(_)) => {
            ("waiting for port", palette.warn, format!("{} Waiting for it.", sentence(trouble)))
        }
        LinkState::Reconnecting(trouble) => {
            ("reconnecting", palette.warn, format!("{} Reconnecting …", sentence(trouble)))
        }
        LinkState::Connected => match snapshot.drive.status {
            None => ("connected", palette.weak, "The device answers.".to_owned()),
            Some(status) => match status.state {
                State::Idle if drive_arms(snapshot) => {
                    ("idle", palette.weak, "Disarmed: press Drive to move the plate.".to_owned())
                }
                State::Idle => ("idle", palette.weak, "Disarmed: press Arm, then Drive.".to_owned()),
                State::Armed => {
                    ("armed", palette.good, "Armed and at rest: press Drive to move the plate.".to_owned())
                }
                State::Driving => ("driving", palette.accent, "The device drives the plate.".to_owned()),
                State::Waiting => {
                    ("waiting", palette.accent, "A drive waits for the trigger input.".to_owned())
                }
                State::Stopping => ("stopping", palette.warn, "Ramping to silence.".to_owned()),
                State::Fault => ("fault", palette.wrong, fault_sentence(snapshot).unwrap_or_default()),
                State::SafeMode => ("safe mode", palette.wrong, SAFE_MODE.to_owned()),
            },
        },
    }
}

/// In windows narrower than this, in points, the device has a row of its own, below menus and STOP.
const ROOM_FOR_ONE_ROW: f32 = 560.0;
/// In windows narrower than this, in points, the program's name is left out.
const ROOM_FOR_NAME: f32 = 760.0;
/// In windows narrower than this, in points, the state names a fault without its cause; tooltip and status line have the
/// cause.
const ROOM_FOR_FAULT: f32 = 900.0;
/// In windows narrower than this, in points, only the status line has a measurement's progress.
const ROOM_FOR_PROGRESS: f32 = 1040.0;
/// The longest words of that progress: the chip is no narrower for others, so that Cancel keeps its place.
const LONGEST_PROGRESS: &str = "measuring: 88 %, 88 s left";
/// A cause with more letters than this is only in the tooltip.
const LONGEST_CAUSE: usize = 32;
/// Space in and between the buttons of such a narrow bar, in points.
const NARROW: f32 = 4.0;
/// Room that state and STOP need beside what stands in place of the menus, in points.
const TITLE_LEAVES: f32 = 420.0;
/// Widths of the work in progress with its button, as usual and in a narrow bar, and of the round trip, in points.
const WIDE_BADGE: f32 = 206.0;
const SMALL_BADGE: f32 = 58.0;
const ROUND_TRIP: f32 = 118.0;
/// The widest of the words of a device that is in use: the chip is no narrower for another.
const USUAL_STATE: &str = "stopping";
/// Smallest and largest width of the device menu, in points.
const DEVICE: (f32, f32) = (70.0, 180.0);

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let end = ui.max_rect().right();
    if ui.available_width() >= ROOM_FOR_ONE_ROW {
        row(ui, "row", |ui| {
            menus(ui, scene, intents);
            ui.separator();
            in_use(ui, scene, Some(end), intents);
        });
        return;
    }
    row(ui, "menus", |ui| {
        menus(ui, scene, intents);
        aligned::at_right(ui, |ui| stop_button(ui, theme::palette(ui), end, intents));
    });
    row(ui, "device", |ui| in_use(ui, scene, None, intents));
}

/// A row of this name, under which its widths are kept.
fn row(ui: &mut egui::Ui, name: &str, show: impl FnOnce(&mut egui::Ui)) {
    let show = |ui: &mut egui::Ui| {
        ui.set_min_height(STOP.y);
        if ui.available_width() < ROOM_FOR_NAME {
            ui.spacing_mut().button_padding.x = NARROW;
            ui.spacing_mut().item_spacing.x = NARROW;
        }
        show(ui);
    };
    ui.push_id(name, |ui| ui.horizontal(show));
}

/// The program's name where there is room for it, and the menus.
fn menus(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    if ui.available_width() >= ROOM_FOR_NAME {
        ui.label(RichText::new("Slipline").strong().size(18.0));
        ui.add_space(4.0);
    }
    match scene.stage_alone {
        None => menu::show(ui, scene, intents),
        Some((name, effect)) => title(ui, name, effect),
    }
}

/// The device, its state and the running work; then STOP, which ends at `stop`, if it stands in this row.
fn in_use(ui: &mut egui::Ui, scene: &Scene<'_>, stop: Option<f32>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let row = ui.max_rect().width();
    // The device menu is as wide as this window allows beside what usually follows it, and keeps this width: the
    // running work or the round trip get the rest.
    let badge = Width::of(ui, "badge");
    let gap = ui.spacing().item_spacing.x;
    let after_state = if stop.is_some() { STOP.x + 6.0 + 3.0 * gap } else { 0.0 };
    let usual =
        usual_state(ui, scene) + after_state + if row < ROOM_FOR_NAME { SMALL_BADGE } else { ROUND_TRIP };
    let room = ui.available_width() - after_state;
    let device_width = (ui.available_width() - usual).clamp(DEVICE.0, DEVICE.1);
    let device = match scene.stage_alone {
        None => port_menu(ui, scene, device_width, intents).rect.width(),
        Some(_) => 0.0,
    };
    let shown = ui.horizontal(|ui| {
        let (word, colour, sentence) = state_words(scene, palette);
        let more = scene.measure.live.progress.map(|progress| progress.to_string()).or_else(|| {
            let status = scene.snapshot.is_connected().then_some(scene.snapshot.drive.status).flatten();
            status.and_then(fault).map(str::to_owned)
        });
        let is_measured = scene.is_measured_now();
        let is_wide = row >= if is_measured { ROOM_FOR_PROGRESS } else { ROOM_FOR_FAULT };
        let least = if is_measured && is_wide { LONGEST_PROGRESS } else { USUAL_STATE };
        chip(ui, (word, more), (is_wide, least), colour).on_hover_text(sentence);
        offer_buttons(ui, scene, intents);
    });
    let room = room - device - shown.response.rect.width() - gap;
    let round_trip = round_trip(ui, scene, room - badge.points() - gap);
    aligned::at_right(ui, |ui| {
        let is_small = room < WIDE_BADGE;
        let shown = ui.horizontal(|ui| table_badge(ui, scene, is_small, intents)).response.rect.width();
        badge.note(ui, shown);
        if let Some(text) = round_trip {
            ui.label(text).on_hover_text("From a command to its answer, running average");
        }
        if let Some(end) = stop {
            ui.add_space(6.0);
            stop_button(ui, palette, end, intents);
        }
    });
}

/// What stands in place of the menus, where the stage is alone.
fn title(ui: &mut egui::Ui, name: &str, effect: &str) {
    ui.label(RichText::new(name).strong().size(16.0));
    let room = (ui.available_width() - TITLE_LEAVES).max(0.0);
    ui.scope(|ui| {
        ui.set_max_width(room);
        ui.add(egui::Label::new(RichText::new(effect).color(theme::palette(ui).weak)).truncate());
    });
}

/// The usual width of the state and of what is offered beside it, in points.
fn usual_state(ui: &egui::Ui, scene: &Scene<'_>) -> f32 {
    let width = |text: &str| {
        let font = egui::TextStyle::Button.resolve(ui.style());
        let around = 2.0 * ui.spacing().button_padding.x + ui.spacing().item_spacing.x;
        theme::text_width(ui, text, font) + around
    };
    let is_real = scene.snapshot.link.port.as_ref().is_some_and(|port| *port != Port::Simulated);
    let disarm = if is_real { width("Disarm") } else { 0.0 };
    chip_width(ui, USUAL_STATE) + width("Drive") + disarm
}

/// The round-trip time of the device, if its text fits this width in points.
fn round_trip(ui: &egui::Ui, scene: &Scene<'_>, room: f32) -> Option<RichText> {
    if !scene.snapshot.is_connected() {
        return None;
    }
    let milliseconds = scene.snapshot.link.round_trip.average.as_secs_f64() * 1e3;
    let text = format!("round trip {milliseconds:.1} ms");
    let font = egui::TextStyle::Body.resolve(ui.style());
    (theme::text_width(ui, &text, font) <= room).then(|| RichText::new(text).color(theme::palette(ui).weak))
}

/// The cause of a fault, of the first if there are several.
fn fault(status: Status) -> Option<&'static str> {
    let first = status.faults.iter().next().filter(|_| status.state == State::Fault);
    first.map(Fault::text).filter(|text| text.len() <= LONGEST_CAUSE)
}

const CHIP_FONT: FontId = FontId::proportional(13.0);

/// Width of the chip with this text, in points.
fn chip_width(ui: &egui::Ui, text: &str) -> f32 {
    theme::text_width(ui, text, CHIP_FONT) + 34.0
}

/// A rounded box with a coloured dot, a word, and where there is room for it the cause of a fault or the progress of a
/// measurement. It is no narrower than for the text `least`.
fn chip(
    ui: &mut egui::Ui,
    (word, more): (&str, Option<String>),
    (is_wide, least): (bool, &str),
    colour: Color32,
) -> egui::Response {
    let said = more.map_or_else(|| word.to_owned(), |more| format!("{word}: {more}"));
    let shown = if is_wide { said.as_str() } else { word };
    let size = vec2(chip_width(ui, shown).max(chip_width(ui, least)), 24.0);
    let galley = ui.painter().layout_no_wrap(shown.to_owned(), CHIP_FONT, colour);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter();
    painter.rect(
        rect,
        CornerRadius::same(12),
        colour.gamma_multiply(0.12),
        Stroke::new(1.0, colour.gamma_multiply(0.55)),
        egui::StrokeKind::Inside,
    );
    painter.circle_filled(rect.left_center() + vec2(13.0, 0.0), 4.0, colour);
    painter.galley(rect.left_center() + vec2(23.0, -0.5 * galley.size().y), galley, colour);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("State: {said}")));
    response
}

/// STOP is above every page and menu, never dimmed, always inside the window, and works with one click in every
/// state. It is at the `end` of the bar, whatever stands before it.
fn stop_button(ui: &mut egui::Ui, palette: &Palette, end: f32, intents: &mut Intents) {
    let (place, _) = ui.allocate_exact_size(STOP, Sense::hover());
    // A page blocks clicks on all layers below it; a separate floating layer keeps STOP above it.
    let area = egui::Area::new(egui::Id::unique("stop"))
        .order(egui::Order::Tooltip)
        .fixed_pos(pos2(end - STOP.x, place.top()))
        .constrain_to(ui.ctx().content_rect())
        .default_size(STOP)
        .layout(egui::Layout::top_down(egui::Align::Center))
        .fade_in(false);
    area.show(ui.ctx(), |ui| {
        let button = ui.add(egui::Button::new("").fill(palette.bad).min_size(STOP));
        let (middle, painter) = (button.rect.center(), ui.painter());
        for (line, size, below) in [("STOP", 16.0, -6.0), ("twice: emergency", 10.0, 9.0)] {
            let (place, font) = (middle + vec2(0.0, below), FontId::proportional(size));
            painter.text(place, egui::Align2::CENTER_CENTER, line, font, palette.on_colour);
        }
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "STOP"));
        button.on_hover_text(STOP_HELP).asks(intents, Intent::Stop);
    });
}

fn offer_buttons(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    for offer in offers::offers(scene) {
        let button = ui.add_enabled(!offer.asks.is_empty(), egui::Button::new(offer.name));
        if button.on_hover_text(&offer.help).on_disabled_hover_text(offer.help).clicked() {
            intents.extend(offer.asks);
        }
    }
}

fn table_badge(ui: &mut egui::Ui, scene: &Scene<'_>, is_narrow: bool, intents: &mut Intents) {
    let palette = theme::palette(ui);
    if let Some(progress) = scene.snapshot.table.upload {
        let help = "Give up the upload; the old table stays";
        if cancel(ui, is_narrow, help) {
            intents.push(Intent::Device(DeviceIntent::CancelUpload));
        }
        let share = f32::from(progress.sent) / f32::from(progress.total.max(1));
        let text = format!("table {} / {}", progress.sent, progress.total);
        bar(ui, is_narrow, share, text, "The table is being sent");
    } else if let Some(waiting) = scene.waiting {
        if cancel(ui, is_narrow, "Cancel it; the earlier result stays") {
            intents.push(Intent::CancelWork);
        }
        let text = format!("{} {:.0} %", waiting.what, 100.0 * waiting.share);
        bar(ui, is_narrow, waiting.share, text, "Being computed");
    } else if scene.is_table_dirty() {
        let name = "table differs: upload";
        let text = RichText::new(if is_narrow { "Upload" } else { name }).color(palette.warn);
        let button = ui.add(egui::Button::new(text).stroke(Stroke::new(1.0, palette.warn)));
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
        let help = "The device's table is not the one for the plate on the screen. Click to upload it";
        button.on_hover_text(help).asks(intents, Intent::Upload);
    }
}

/// The button that cancels the work in progress; only a symbol in a narrow bar.
fn cancel(ui: &mut egui::Ui, is_narrow: bool, help: &str) -> bool {
    let button = ui.button(if is_narrow { "×" } else { "Cancel" });
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Cancel"));
    button.on_hover_text(help).clicked()
}

/// The progress bar of the work; without text in a narrow bar.
fn bar(ui: &mut egui::Ui, is_narrow: bool, share: f32, text: String, help: &str) {
    let bar = egui::ProgressBar::new(share);
    if is_narrow {
        ui.add(bar.desired_width(30.0)).on_hover_text(format!("{help}: {text}"));
    } else {
        ui.add(bar.desired_width(130.0).text(text)).on_hover_text(help);
    }
}

/// The device menu, with this width in points.
fn port_menu(ui: &mut egui::Ui, scene: &Scene<'_>, width: f32, intents: &mut Intents) -> egui::Response {
    let current = scene.snapshot.link.port.as_ref();
    let label = current.map_or_else(
        || "No device".to_owned(),
        |port| {
            let known = scene.ports.iter().find(|info| info.port == *port);
            known.map_or_else(|| port.to_string(), |info| info.label.clone())
        },
    );
    // A long name must not push STOP out of the window.
    let menu = egui::ComboBox::from_id_salt("port").selected_text(label.as_str()).width(width).truncate();
    let menu_of = |ui: &mut egui::Ui| {
        for info in scene.ports {
            let is_current = current == Some(&info.port);
            let choice = ui.selectable_label(is_current, &info.label);
            if choice.on_hover_text(format!("Open {} and close the port before", info.port)).clicked()
                && !is_current
            {
                intents.push(Intent::Connect(info.port.clone()));
            }
        }
        if scene.asks_for_port && ui.button(ASK_FOR_PORT.0).on_hover_text(ASK_FOR_PORT.1).clicked() {
            intents.push(Intent::AskForPort);
        }
        ui.separator();
        ui.button("Look again").on_hover_text(LOOK_AGAIN).asks(intents, Intent::RefreshPorts);
        let missing = ui.button("A port is missing…");
        missing
            .on_hover_text("Cables, permissions and drivers: what to look at")
            .asks(intents, Intent::Dialog(Some(Dialog::PortHelp)));
    };
    let response = ui.scope(|ui| {
        ui.set_max_width(width);
        menu.show_ui(ui, menu_of)
    });
    let response = response.inner;
    let name = format!("Device: {label}");
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
    response.response.on_hover_text(format!("{label} is the driven device. Press to choose another port"))
}

//! Input from keys, pointer and dropped files, processed before anything is painted.

use super::App;
use crate::files::{FileJob, PROFILE_EXTENSIONS, has_extension, is_measurement};
use crate::intent::{Dialog, Dragged, Intent, Intents};
use crate::view::{Brush, Tab, arrow_step_m};
use eframe::egui::{self, Key, Modifiers};
use slipline_link::Snapshot;
use slipline_link::protocol::event::State;

/// The smallest window after zooming, in points: in a smaller one the panels would overlap.
const LEAST_ROOM: egui::Vec2 = egui::vec2(800.0, 520.0);
/// The lowest window that is not shown smaller, and the smallest zoom of one that is.
const LEAST_HEIGHT: f32 = 400.0;
const LEAST_ZOOM: f32 = 0.5;

impl App {
    /// Whether the input is not that of the last call. While the window is hidden egui takes no input, so that of the last
    /// frame would be seen again each time: a press of Escape would become many, and they an emergency stop.
    pub(super) fn has_new_input(&mut self, ctx: &egui::Context) -> bool {
        let time_s = ctx.input(|input| input.time);
        self.view.input_time_s.replace(time_s) != Some(time_s)
    }

    pub(super) fn keys(&mut self, ctx: &egui::Context) {
        end_zoom(ctx, &mut self.view.is_shrunk);
        // At Escape egui takes the focus before anything of a frame is seen; what was typed before is in the same frame, if
        // that took long.
        let is_left = self.view.was_typing && ctx.input(|input| input.key_pressed(Key::Escape));
        let is_typing = is_left || ctx.text_edit_focused();
        let focused = ctx.memory(egui::Memory::focused);
        let mut asked = Intents::new();
        // The line comes first, because the window exists for it; the controls follow.
        self.view.begins_by_tab = focused.is_none()
            && self.dialog.is_none()
            && ctx.input(|input| input.modifiers.is_none() && input.key_pressed(Key::Tab));
        let closed = match self.dialog {
            Some(_) => Some("closed the page"),
            None if self.view.brush.is_taken => Some("ended the drawing"),
            None => None,
        };
        let closed = closed.filter(|_| ctx.input(|input| input.key_pressed(Key::Escape)));
        let notice = closed.and_then(|closed| by_escape(closed, self.instrument.drive.snapshot()));
        if closed.is_some() && self.dialog.is_none() {
            self.view.brush = Brush::default();
        }
        let presses = ctx.input_mut(|input| {
            let is_press = |event: &&egui::Event| {
                matches!(
                    event,
                    egui::Event::Key { pressed: true, repeat: false, .. }
                        | egui::Event::PointerButton { pressed: true, .. }
                )
            };
            let presses = input.events.iter().filter(is_press).count() as u64;
            // Escape is read, not consumed: it also closes pages and leaves fields.
            let stops = stop_presses(input, is_typing);
            asked.extend(std::iter::repeat_n(Intent::StopKey, stops));
            if !is_typing {
                input.consume_key(Modifiers::NONE, Key::Space);
                if input.consume_key(Modifiers::NONE, Key::P) {
                    self.settings.animate = !self.settings.animate;
                }
                if input.consume_key(Modifiers::NONE, Key::B) {
                    asked.push(Intent::BeforeOrAfter);
                }
            }
            if input.consume_key(Modifiers::COMMAND, Key::Enter) {
                asked.push(Intent::Start);
            }
            let redo = input.consume_key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
                || input.consume_key(Modifiers::COMMAND, Key::Y);
            if redo {
                asked.push(Intent::Redo);
            } else if input.consume_key(Modifiers::COMMAND, Key::Z) {
                asked.push(Intent::Undo);
            }
            for (modifiers, key, intent) in [
                (Modifiers::COMMAND, Key::B, Intent::Switch),
                (Modifiers::COMMAND, Key::O, Intent::OpenDialog),
                (Modifiers::COMMAND, Key::S, Intent::SaveDialog),
                (Modifiers::NONE, Key::F1, Intent::Dialog(Some(Dialog::Shortcuts))),
            ] {
                if input.consume_key(modifiers, key) {
                    asked.push(intent);
                }
            }
            if input.consume_key(Modifiers::COMMAND, Key::Num0) {
                // Both, or the whole window for the stage.
                let show = !(self.settings.show_panel || self.settings.show_plots);
                (self.settings.show_panel, self.settings.show_plots) = (show, show);
            }
            let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];
            for (key, tab) in keys.into_iter().zip(Tab::ALL) {
                if input.consume_key(Modifiers::COMMAND, key) {
                    self.view.tab = tab;
                    asked.push(Intent::ShowPanel(true));
                }
            }
            // A slider or field that has the focus uses the arrow keys itself.
            if focused.is_some() && self.view.focused_finger == focused {
                let step_m = arrow_step_m(input);
                if step_m != 0.0 {
                    asked.push(Intent::MoveFinger(self.instrument.screen.finger_place_m() + step_m));
                }
            } else if (focused.is_none() && !self.view.is_measuring())
                || (focused.is_some() && self.view.focused_handle == focused)
            {
                let step_m = arrow_step_m(input);
                if step_m != 0.0
                    && let Some(line) = self.instrument.line(self.instrument.desk.selected())
                {
                    asked.push(Intent::MoveLine {
                        slot: self.instrument.desk.selected(),
                        place_m: line.place_m + step_m,
                    });
                }
            }
            presses
        });
        if self.is_stage_alone() {
            // Visitors and readers have STOP, the line and the finger.
            asked.retain(|intent| {
                matches!(intent, Intent::StopKey | Intent::MoveLine { .. } | Intent::MoveFinger(_))
            });
        }
        self.instrument.desk.begin_gestures(presses);
        self.perform(ctx, asked);
        if let Some(notice) = notice {
            self.instrument.out.post(notice);
        }
    }

    /// During a drag, the pointer moves what it holds: a tone is sent before anything is painted.
    pub(super) fn follow_pointer(&mut self, ctx: &egui::Context) {
        let Some(grab) = self.grab else { return };
        let (moves, is_down) = ctx.input(|input| {
            let moves: Vec<egui::Pos2> = input
                .events
                .iter()
                .filter_map(|event| if let egui::Event::PointerMoved(to) = event { Some(*to) } else { None })
                .collect();
            (moves, input.pointer.primary_down())
        });
        let places_m: Vec<f64> =
            moves.iter().map(|to| grab.axis.place_from_screen(to.x - grab.offset)).collect();
        match (grab.held, places_m.last()) {
            (_, None) => {}
            (Dragged::Finger, Some(&place_m)) => self.perform(ctx, vec![Intent::MoveFinger(place_m)]),
            (Dragged::Tone(slot), Some(_)) => {
                self.settings.has_dragged = true;
                self.instrument.drag_line(slot, &places_m);
            }
        }
        if !is_down {
            self.grab = None;
        }
    }

    /// Opens what was dropped: every measurement, and of other files the first; the others are named.
    pub(super) fn dropped_files(&mut self, ctx: &egui::Context) {
        if self.is_stage_alone() {
            return;
        }
        let (mut is_opened, mut left) = (false, Vec::new());
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            let path = file.path().to_owned();
            // On the page of measurements a table is one.
            let is_table = has_extension(&path, &["csv"]) && self.view.is_measuring();
            let job = if is_table || is_measurement(&path) {
                FileJob::OpenMeasurement(path)
            } else if has_extension(&path, &PROFILE_EXTENSIONS) {
                FileJob::OpenProfile(path)
            } else {
                FileJob::Open(path)
            };
            if !matches!(job, FileJob::OpenMeasurement(_)) && std::mem::replace(&mut is_opened, true) {
                left.push(file.path().file_name().unwrap_or_default().display().to_string());
            } else {
                self.services.files.begin(job);
            }
        }
        if !left.is_empty() {
            let left = left.join(", ");
            self.instrument.out.fail(format!(
                "Only one setup, plate, recording or picture opens at a time. Not opened: {left}."
            ));
        }
    }
}

/// How often a key of STOP was pressed: Escape, and Space unless text is typed, which Escape ends. A key that is held was
/// pressed once.
fn stop_presses(input: &egui::InputState, mut is_typing: bool) -> usize {
    let is_press = |event: &&egui::Event| {
        let egui::Event::Key { key, pressed: true, repeat: false, modifiers, .. } = event else {
            return false;
        };
        is_typing &= *key != Key::Escape;
        let is_space = *key == Key::Space && modifiers.matches_logically(Modifiers::NONE);
        *key == Key::Escape || (is_space && !is_typing)
    };
    input.events.iter().filter(is_press).count()
}

/// What Escape does in this state beside what it has closed, for the user who only wanted that; nothing where nothing was driven.
fn by_escape(closed: &str, snapshot: &Snapshot) -> Option<String> {
    let state = snapshot.drive.status.map(|status| status.state).filter(|_| snapshot.is_connected());
    let more = match (state, snapshot.is_simulated()) {
        (None, _) => ". No device answers; the stop was sent nevertheless.",
        (Some(State::Driving | State::Waiting), true) => " and stopped the drive. Press Drive to resume.",
        (Some(State::Driving | State::Waiting), false) => ", stopped the drive and disarmed the device.",
        (Some(State::Armed | State::Stopping), false) => " and disarmed the device.",
        (Some(State::Idle | State::Armed | State::Stopping | State::Fault | State::SafeMode), _) => {
            return None;
        }
    };
    Some(format!("Esc {closed}{more}"))
}

/// Reduces a zoom that leaves less than [`LEAST_ROOM`]. A window that is smaller itself is not magnified at all, and one that is
/// lower than [`LEAST_HEIGHT`], such as a page that its browser magnifies to 300 %, is shown smaller, so that it keeps a plate;
/// `is_shrunk` says whether it is.
fn end_zoom(ctx: &egui::Context, is_shrunk: &mut bool) {
    let zoom = ctx.zoom_factor();
    let size = zoom * ctx.content_rect().size();
    let tenths = |share: f32| (10.0 * share).floor() / 10.0;
    let is_low = size.y < LEAST_HEIGHT && size.x > size.y;
    let most = if is_low {
        tenths(size.y / LEAST_HEIGHT).max(LEAST_ZOOM)
    } else {
        tenths((size / LEAST_ROOM).min_elem()).max(1.0)
    };
    if zoom > most {
        ctx.set_zoom_factor(most);
    } else if *is_shrunk && zoom < most {
        ctx.set_zoom_factor(most.min(1.0));
    }
    *is_shrunk = is_low;
}

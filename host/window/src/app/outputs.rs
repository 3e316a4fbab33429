//! What passes between window and instrument: what the instrument must know of the window, and what it has the window do.

use super::App;
use crate::files::{FileJob, Save};
use crate::intent::{Confirm, Dialog};
use crate::settings::Part;
use crate::sound::SoundChoice;
use crate::view::{PlatePage, Tab};
use eframe::egui;
use slipline_instrument::{Attention, Output, Page};
use slipline_link::Port;
use std::time::Duration;

/// Time between two frames of the moving wave.
const FRAME: Duration = Duration::from_millis(33);
/// Time between two updates of the meters while the wave is paused.
const GLANCE: Duration = Duration::from_millis(500);

impl App {
    /// Reports to the instrument what the window shows and the user holds.
    pub(super) fn attend(&mut self, ctx: &egui::Context) {
        let (now_s, is_pressed) = ctx.input(|input| (input.time, input.pointer.any_down()));
        self.instrument.attend(Attention {
            now_s,
            press_age_s: self.services.press_ages.present_s(),
            is_pressed,
            is_dragging: self.grab.is_some() || self.is_demonstrating(),
            is_animated: self.settings.animate,
            has_page: self.dialog.is_some(),
            is_calibration_open: self.dialog == Some(Dialog::Calibrate),
            is_measurements_open: self.view.is_measuring(),
            is_texture_open: self.view.tab == Tab::Texture,
            wave: self.settings.wave,
            uploads: self.settings.auto_upload,
        });
    }

    /// Connects to a port.
    pub fn connect(&mut self, port: Port) {
        // The chosen port is remembered even if it does not exist at the moment.
        self.settings.port = Some(port.to_string());
        // The present sound was chosen for the previous device.
        self.hearing.chosen = None;
        self.instrument.connect(port);
    }

    /// Carries out what the instrument asks of the window.
    pub(super) fn carry_out(&mut self, ctx: &egui::Context) {
        for output in self.instrument.out.take_outputs() {
            match output {
                Output::Open(Page::Calibration) => self.dialog = Some(Dialog::Calibrate),
                Output::Open(Page::Measurements) => self.open_panel(Tab::Plate, PlatePage::Measure),
                Output::Open(Page::Texture) => self.open_panel(Tab::Texture, self.view.plate_page),
                Output::Open(Page::Boundary) => self.open_panel(Tab::Boundary, self.view.plate_page),
                Output::Open(Page::Plate) => self.open_panel(Tab::Plate, PlatePage::Plate),
                Output::Open(Page::Arm) => self.dialog = Some(Dialog::Confirm(Confirm::Arm)),
                Output::CloseCalibration => self.dialog = None,
                Output::ChooseMeasurement => self.services.files.begin(FileJob::ChooseMeasurement),
                Output::Save { name, kind, extension, bytes } => self.save(&name, kind, extension, bytes),
            }
        }
        if let Some(after) = self.instrument.out.take_wake() {
            ctx.request_repaint_after(after);
        }
    }

    /// Opens a page of the panel, which may be closed or in a small window behind the plots.
    const fn open_panel(&mut self, tab: Tab, page: PlatePage) {
        (self.view.tab, self.view.plate_page) = (tab, page);
        (self.settings.show_panel, self.settings.in_front) = (true, Part::Panel);
    }

    /// Has a file saved.
    pub(super) fn save(&mut self, name: &str, kind: &'static str, extension: &'static str, bytes: Vec<u8>) {
        let save = Save { name: name.to_owned(), kind, extension, bytes: bytes.into() };
        self.services.files.begin(FileJob::Save(save));
    }

    /// Moves the wave on and asks for the next frame, but only while something moves.
    pub(super) fn move_on(&mut self, ctx: &egui::Context) {
        let is_visible = ctx.input(|input| {
            let viewport = input.viewport();
            viewport.minimized != Some(true) && viewport.occluded != Some(true)
        });
        if !self.instrument.screen.is_sounding() || !is_visible {
            return;
        }
        if self.settings.animate {
            let step_s = ctx.input(|input| f64::from(input.stable_dt.min(0.1))) * self.settings.speed;
            self.instrument.move_on(step_s);
            ctx.request_repaint_after(FRAME);
        } else {
            let plays_drive = self.sound_choice() == SoundChoice::Drive;
            ctx.request_repaint_after(if plays_drive { FRAME } else { GLANCE });
        }
    }
}

//! The user's actions: each goes to its room, with what follows in the others.

use super::shell::{Output, Page};
use super::shown::Awaited;
use super::{CalibrateIntent, DeviceIntent, Instrument, MeasureIntent};
use crate::hold::HoldEnd;
use crate::recording::Recording;
use slipline_link::protocol::event::State;
use slipline_link::{Port, Request, Severity};
use slipline_model::field::touch::Touch;
use slipline_model::response::is_measurement;
use slipline_model::setup::edit::{self, Edit};
use slipline_model::setup::file as setup_file;
use std::sync::Arc;

/// The desk.
impl Instrument {
    /// Begins a new recording, or ends it.
    pub fn record(&mut self, records: bool) {
        self.desk.record(records, &mut self.out);
    }
}

/// The drive.
impl Instrument {
    /// Connects to a port.
    pub fn connect(&mut self, port: Port) {
        self.lab.end_hold(HoldEnd::LinkLost, &mut self.out);
        // The connection is tried again, so the message about the earlier failure is obsolete.
        self.out.connected();
        self.lab.leave_port();
        self.drive.connect(port);
    }

    /// Carries out a request of the user to the device.
    pub fn perform(&mut self, intent: DeviceIntent) {
        if intent == DeviceIntent::Disconnect {
            self.lab.leave_port();
        }
        self.drive.perform(intent);
    }

    /// Handles a press of Drive: the tones are sent now, or as soon as the device is ready for them.
    pub fn start(&mut self) {
        if self.lab.is_measuring() {
            let text = "The plate is being measured: cancel that or press STOP first.";
            return self.out.hinder(text.to_owned());
        }
        self.lab.take_owed_drive();
        self.drive.note(Severity::Info, "Drive.".to_owned());
        self.drive.start(self.desk.setup(), &self.attention, &mut self.out);
    }

    /// Plays the tones with companions that cancel the harmonics of the drive, until they change; or reports the obstacle.
    pub fn cancel_harmonics(&mut self) {
        self.drive.cancel_harmonics(self.desk.setup(), &mut self.out);
    }

    /// Drives the simulated plate if it rests. Another device is driven by its user alone.
    pub fn start_simulated(&mut self) {
        let snapshot = self.drive.snapshot();
        let is_driving = matches!(snapshot.drive.status.map(|status| status.state), Some(State::Driving));
        if snapshot.is_simulated() && !is_driving && !self.lab.is_measuring() {
            self.start();
        }
    }

    /// When the press that is handled now was made, in seconds of the user's time.
    const fn pressed_s(&self) -> f64 {
        self.attention.now_s - self.attention.press_age_s
    }

    /// Carries out a press of a key of STOP. Esc also leaves pages and fields, so on a simulated device that is known to be
    /// silent a key is no first press.
    pub fn press_stop_key(&mut self) {
        if self.drive.is_known_to_be_silent(self.pressed_s()) && !self.lab.is_measuring() {
            self.stop();
        } else {
            self.press_stop();
        }
    }

    /// Carries out a press of the STOP button.
    pub fn press_stop(&mut self) {
        if self.drive.is_second_stop(self.pressed_s()) {
            self.end_drive(Request::EmergencyStop);
        } else {
            self.stop();
        }
    }

    /// Stops the drive for every source and disarms a real device: only the user can drive again.
    pub fn stop(&mut self) {
        self.end_drive(Request::Stop);
        self.drive.disarm_real();
    }

    /// Disarms at the user's request.
    pub fn disarm(&mut self) {
        self.end_drive(Request::Stop);
        self.drive.send(Request::Disarm);
    }

    /// Sends a stop; the drive is no longer wanted.
    fn end_drive(&mut self, stop: Request) {
        let is_emergency = matches!(stop, Request::EmergencyStop);
        self.desk.end_replay();
        self.lab.cancel_measuring();
        self.lab.take_owed_drive();
        self.lab.end_hold(HoldEnd::Stopped, &mut self.out);
        self.out.settle();
        self.drive.end(stop);
        // The stop goes first.
        self.drive.note(Severity::Info, if is_emergency { "Emergency stop." } else { "Stop." }.to_owned());
    }
}

/// The lab.
impl Instrument {
    /// Carries out a request of the page of measurements.
    pub fn perform_measure(&mut self, intent: MeasureIntent) {
        let (lab, mut reach) = self.reach();
        lab.perform_measure(intent, &mut reach);
    }

    /// Carries out a request of the calibration's pages.
    pub fn perform_calibrate(&mut self, intent: CalibrateIntent) {
        let (lab, mut reach) = self.reach();
        if let Some(plate) = lab.perform_calibrate(intent, &mut reach) {
            self.use_calibrated(plate);
            // The page with the stage, where the rings lie on the curve now.
            self.out.push(Output::Open(Page::Boundary));
            // A drive that the measurement interrupted resumes by itself on the simulated plate alone.
            if self.lab.take_owed_drive() && self.drive.snapshot().is_simulated() {
                self.start();
            }
            self.out.post("The calibrated plate is in use. Undo takes it back.".to_owned());
        }
    }

    /// Switches the hold on or reports the obstacle; or switches it off.
    pub fn switch_hold(&mut self, is_on: bool) {
        let (lab, mut reach) = self.reach();
        lab.switch_hold(is_on, &mut reach);
    }

    /// Sets the largest rise of held tones, dB. An active hold begins again.
    pub fn choose_max_rise(&mut self, decibels: f64) {
        self.lab.choose_max_rise(decibels, self.desk.plate());
    }

    /// Reads a measurement's file and opens its page. The user is asked for metadata that a file by another
    /// program lacks.
    pub fn open_measurement(&mut self, name: &str, bytes: Vec<u8>) {
        let (lab, mut reach) = self.reach();
        lab.open_measurement(name, bytes, &mut reach);
    }

    /// Reads a sweep's description, for the waiting recording and later ones; returns whether the text is
    /// one.
    pub fn opened_sweep(&mut self, name: &str, text: &str) -> bool {
        self.lab.opened_sweep(name, text, &mut self.out)
    }

    /// Opens a recorded drag or a measurement; returns whether the text is one of them.
    pub fn opened_table(&mut self, name: &str, text: &str) -> bool {
        if Recording::is_one(text) {
            match Recording::from_csv(text) {
                Ok(recording) => {
                    self.desk.take_recording(recording);
                    self.out.post(format!("Opened {name}: press Play on the page Play"));
                }
                Err(error) => self.out.not_opened(name, &error),
            }
        } else if is_measurement(text) {
            self.open_measurement(name, text.as_bytes().to_vec());
        } else {
            return false;
        }
        true
    }
}

/// The screen.
impl Instrument {
    /// Puts a finger on the plate, at the peak of the selected tone, or takes it off.
    pub fn touch(&mut self, touch: Touch) {
        let (screen, sight, _) = self.sight_of_screen();
        screen.touch(touch, sight);
    }

    /// Advances the wave by `step_s` seconds of the user's time.
    pub fn move_on(&mut self, step_s: f64) {
        let (screen, sight, _) = self.sight_of_screen();
        screen.move_on(step_s, sight);
    }

    /// Requests the plate on the screen in two dimensions.
    pub fn check_plane(&mut self) {
        self.screen.check_plane(&self.desk);
    }

    /// Cancels the work in progress. If that is a table, the plate and the table from before are restored.
    pub fn cancel_work(&mut self) {
        match self.screen.under_way(&self.drive).map(|waiting| waiting.what) {
            None => {}
            Some(Awaited::Table) => {
                if let Some(kept) = self.drive.cancel_table() {
                    self.edit(&Edit::Plate(Arc::clone(&kept.plate)));
                    self.drive.restore_table(kept);
                    self.screen.keep_edges(Vec::new());
                }
            }
            Some(what) => self.screen.cancel(what),
        }
    }

    /// Draws the draft itself, along a path of places and RMS displacements in metres; its tones follow.
    pub fn draw_texture(&mut self, path: &[(f64, f64)]) {
        self.screen.draw_texture(path, self.desk.gesture());
    }

    /// Draws the texture from a profile file, and opens its page.
    pub fn take_profile(&mut self, name: &str, bytes: &[u8]) {
        self.screen.take_profile(name, bytes, &mut self.out);
    }

    /// Has the shell save the computed texture as a setup.
    pub fn save_texture(&mut self) {
        let Some(made) = self.screen.made_texture() else { return };
        match edit::apply(self.desk.setup(), &made.edit()) {
            Ok(setup) => self.out.save("texture.toml", "Setup", "toml", setup_file::write(&setup)),
            Err(error) => self.out.fail(slipline_link::capitalized(&error.to_string())),
        }
    }
}

//! Carries out the intents of the views.

use super::{App, set_theme};
use crate::files::{FileEvent, FileJob, has_extension};
use crate::intent::{Confirm, DeviceIntent, Dialog, Export, Intent, Intents};
use crate::scene::DesignState;
use crate::settings::{Part, SPEEDS};
use crate::view::Tab;
use eframe::egui;
use slipline_instrument::profile_file;
use slipline_link::Severity;
use slipline_model::content::Content;
use slipline_model::export::csv_wav;
use slipline_model::export::figures::plate::FigureJob;
use slipline_model::export::report;
use slipline_model::jobs::design::cut_files;
use slipline_model::setup::edit::Edit;
use slipline_model::setup::file::{self as setup_file, Opened};
use slipline_model::setup::fragment;
use slipline_plate::design::Design;
use slipline_plate::text_table::text_of;
use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;

/// Why codes cannot be saved that are not those of the device.
const UNKNOWN_CODES: &str = "The device's output is unknown, because it held levels or this program lost track of it: stop, and \
    drive again";

impl App {
    pub(super) fn perform(&mut self, ctx: &egui::Context, intents: Intents) {
        for intent in intents {
            let is_stop = matches!(intent, Intent::Stop | Intent::StopKey);
            self.services.press_ages.begin_event(is_stop);
            self.attend(ctx);
            if matches!(intent, Intent::Touch(_) | Intent::MoveFinger(_)) {
                self.hearing.has_touched = true;
            }
            match intent {
                Intent::Edit(edit) => self.instrument.edit(&edit),
                Intent::MoveLine { slot, place_m } => {
                    self.instrument.desk.end_replay();
                    self.instrument.drag_line(slot, &[place_m]);
                }
                Intent::Device(asked) => {
                    if let DeviceIntent::AutoReconnect(looks) = asked {
                        self.settings.auto_reconnect = looks;
                    }
                    self.instrument.perform(asked);
                }
                Intent::Connect(port) => self.connect(port),
                Intent::Start if self.view.is_stopped => {}
                Intent::Start => self.instrument.start(),
                Intent::CancelHarmonics => self.instrument.cancel_harmonics(),
                Intent::Stop => self.press_stop(),
                Intent::StopKey => {
                    self.view.is_stopped = true;
                    self.instrument.press_stop_key();
                }
                Intent::Disarm => self.instrument.disarm(),
                Intent::HoldLevel(is_on) => self.instrument.switch_hold(is_on),
                Intent::MaxRise(decibels) => self.instrument.choose_max_rise(decibels),
                Intent::Select(slot) => self.instrument.desk.select(slot),
                Intent::Touch(touch) => self.instrument.touch(touch),
                Intent::MoveFinger(place_m) => self.instrument.screen.move_finger(place_m),
                Intent::Sound(choice) => self.choose_sound(choice),
                Intent::Volume(volume) => self.settings.volume = volume.clamp(0.0, 1.0),
                Intent::Grab(grab) => {
                    self.instrument.desk.end_replay();
                    self.grab = Some(grab);
                }
                Intent::Switch => self.instrument.switch_setups(),
                Intent::Record(records) => self.instrument.record(records),
                Intent::Play(plays) => self.instrument.desk.play(plays),
                Intent::Seek(time_s) => self.instrument.seek(time_s),
                Intent::Loop(is_looped) => self.instrument.desk.loop_replay(is_looped),
                Intent::Speed(speed) => {
                    self.settings.speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
                }
                Intent::Scrub(time_s) => {
                    if self.instrument.screen.scrub(time_s) {
                        self.settings.animate = false;
                    }
                }
                Intent::BeforeOrAfter => self.instrument.show_before_or_after(),
                Intent::Undo => self.instrument.undo(),
                Intent::Redo => self.instrument.redo(),
                Intent::New => {
                    self.start_scene(0);
                }
                Intent::StartScene(number) => {
                    self.dialog = None;
                    self.start_scene(number);
                }
                Intent::OpenDialog => self.services.files.begin(FileJob::Choose),
                Intent::Open(path) => self.services.files.begin(FileJob::Open(path)),
                Intent::SaveDialog => {
                    let text = setup_file::write(self.instrument.desk.setup());
                    self.save("setup.toml", "Setup", "toml", text.into_bytes());
                }
                Intent::SavePlateDialog => {
                    let text = self.instrument.desk.setup().plate.to_toml();
                    self.save("plate.toml", "Plate", "toml", text.into_bytes());
                }
                Intent::Share => self.share(ctx),
                Intent::Design(draft) => self.instrument.screen.design(*draft),
                Intent::UseDesign => {
                    if let Some(designed) = self.designed() {
                        self.instrument.edit(&Edit::Plate(Arc::new(designed.plate.clone())));
                    }
                }
                Intent::SaveDesign => {
                    if let Some(designed) = self.designed() {
                        let text = designed.plate.to_toml();
                        self.save("plate.toml", "Plate", "toml", text.into_bytes());
                    }
                }
                Intent::SaveCutFiles => {
                    if let Some(designed) = self.designed() {
                        self.services.files.begin(FileJob::SaveFolder(cut_files(&designed)));
                    }
                }
                Intent::Texture(draft) => self.instrument.screen.draft_texture(*draft),
                Intent::Draw(path) => self.instrument.draw_texture(&path),
                Intent::EndDrawing => self.instrument.screen.end_drawing(),
                Intent::PlayTexture => self.instrument.play_texture(),
                Intent::SaveTexture => self.instrument.save_texture(),
                Intent::OpenProfile => self.services.files.begin(FileJob::ChooseProfile),
                Intent::Measure(intent) => self.instrument.perform_measure(intent),
                Intent::Calibrate(intent) => self.instrument.perform_calibrate(intent),
                Intent::CheckPlane => self.instrument.check_plane(),
                Intent::CancelWork => self.instrument.cancel_work(),
                Intent::MakeTable => self.instrument.drive.make_table(),
                Intent::Wave(wish) => self.settings.wave = wish,
                Intent::Export(export) => self.export(ctx, export),
                Intent::Upload => self.instrument.drive.upload(),
                Intent::Theme(choice) => {
                    self.settings.theme = choice;
                    set_theme(ctx, choice);
                }
                Intent::Dialog(dialog) => {
                    if dialog == Some(Dialog::Scenes) && self.thumbnails.is_empty() {
                        self.services.scenes.ask(());
                    }
                    self.dialog = dialog.or(self.behind.take());
                }
                Intent::Path(text, may_replace) => self.take_path(&text, may_replace),
                Intent::WriteProfile(profile) => self.instrument.drive.write_profile(*profile),
                Intent::Confirmed(confirm) => {
                    self.dialog = None;
                    self.confirmed(confirm);
                }
                Intent::DismissNotice(number) => self.instrument.out.dismiss(number),
                Intent::RefreshPorts => self.look_for_ports(),
                Intent::AskForPort => {
                    if let Some(ask) = &mut self.services.ask_for_port {
                        ask();
                    }
                }
                Intent::ShowAmplitude(show) => self.settings.show_amplitude = show,
                Intent::ShowRelief(show) => self.settings.show_relief = show,
                Intent::ShowPanel(show) => {
                    self.view.log.is_open &= !show;
                    self.settings.show_panel = show;
                    self.settings.in_front = if show { Part::Panel } else { Part::Plots };
                }
                Intent::ShowPlots(show) => {
                    self.view.log.is_open &= !show;
                    self.settings.show_plots = show;
                    self.settings.in_front = if show { Part::Plots } else { Part::Panel };
                }
                Intent::Animate(animate) => self.settings.animate = animate,
                Intent::Copy(text) => ctx.copy_text(text),
                Intent::ShowDevice => self.view.tab = Tab::Device,
                Intent::Demonstrate => self.replay_demonstration(),
                Intent::BeginTour => self.instrument.begin_tour(),
                Intent::NextStep => self.instrument.next_step(),
                Intent::StepBack => self.instrument.step_back(),
                Intent::EndTour => self.instrument.end_tour(),
                Intent::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
                Intent::CopyDiagnostics => {
                    ctx.copy_text(self.diagnostics());
                    self.dialog = Some(Dialog::Diagnostics);
                }
            }
            self.carry_out(ctx);
            ctx.request_repaint();
        }
    }

    /// Carries out a press of STOP.
    pub fn press_stop(&mut self) {
        self.view.is_stopped = true;
        self.instrument.press_stop();
    }

    /// Ends the drive: nobody sees the window any more.
    pub fn end_drive(&mut self) {
        self.view.is_stopped = true;
        self.instrument.stop();
    }

    /// Shows a setup or a plate that was opened; Undo brings the present one back.
    pub fn use_opened(&mut self, opened: Opened) {
        // Its end would put the line of before into what is opened.
        self.end_demonstration();
        match opened {
            Opened::Setup(setup) => self.instrument.edit(&Edit::Replace(setup)),
            Opened::Plate(plate) => self.instrument.edit(&Edit::Plate(plate)),
        }
    }

    /// Copies the address that shows the setup.
    fn share(&mut self, ctx: &egui::Context) {
        let Some(address) = &self.services.address else { return };
        let address = format!("{address}#{}", fragment::write(self.instrument.desk.setup()));
        self.instrument.out.post(format!("Copied the address of this setup: {} characters", address.len()));
        ctx.copy_text(address);
    }

    fn confirmed(&mut self, confirm: Confirm) {
        let snapshot = self.instrument.drive.snapshot();
        let asked = match confirm {
            Confirm::Arm => DeviceIntent::Arm,
            Confirm::Store => DeviceIntent::Store,
            Confirm::Forget => DeviceIntent::Forget,
            Confirm::Bootloader => DeviceIntent::Bootloader,
            Confirm::BrownOutLevel => DeviceIntent::RaiseBrownOutLevel,
        };
        if confirm == Confirm::Arm
            && let Some(unit) = snapshot.unit()
        {
            if snapshot.device.maintenance.is_some_and(|reported| !reported.brown_out_guarded) {
                self.settings.arms_unguarded(unit.clone());
            }
            if snapshot.lacks_profile() {
                self.settings.arms_without_profile(unit);
            }
        }
        self.instrument.perform(asked);
    }

    /// The plate that was designed from the present draft.
    fn designed(&self) -> Option<Arc<Design>> {
        let DesignState::Ready(designed) = &self.instrument.screen.background().design else { return None };
        designed.result.as_ref().ok().cloned()
    }

    fn diagnostics(&self) -> String {
        report::text(
            self.instrument.drive.snapshot(),
            self.instrument.desk.setup(),
            self.instrument.shown().table,
        )
    }

    fn export(&mut self, ctx: &egui::Context, what: Export) {
        if matches!(what, Export::Figure(_) | Export::Envelope) && self.instrument.screen.load().is_some() {
            // The simulated plate beside the prediction has no finger.
            self.instrument.out.post("The export shows the plate without the finger".to_owned());
            let touch = self.instrument.screen.lift_finger();
            self.export(ctx, what);
            return self.instrument.screen.touch_again(touch);
        }
        match what {
            Export::Figure(format) => {
                let is_largest = self.settings.show_amplitude;
                let Some(subject) = self.instrument.shown().figure(self.magnification, is_largest) else {
                    return self.fail_unknown();
                };
                self.services.figures.ask(FigureJob { subject, format });
            }
            Export::Screenshot => {
                let (sender, waker) = (self.screenshots.0.clone(), ctx.clone());
                let taken = egui::ScreenshotCallback::new(move |image| {
                    // The receiver is gone if the window was closed.
                    let _ = sender.send(image);
                    waker.request_repaint();
                });
                ctx.send_viewport_cmd(egui::ViewportCommand::Screenshot(taken));
            }
            Export::Envelope => {
                let Some(text) = self.instrument.shown().envelope_csv() else { return self.fail_unknown() };
                self.save("envelope.csv", "Table", "csv", text.into_bytes());
            }
            Export::Waveform | Export::Sound if self.instrument.screen.is_waveform_unknown() => {
                self.instrument.out.fail(UNKNOWN_CODES.to_owned());
            }
            Export::Waveform => match csv_wav::waveform_csv(self.instrument.shown().waveform) {
                Some(text) => self.save("waveform.csv", "Table", "csv", text.into_bytes()),
                None => {
                    self.instrument.out.fail("Nothing is driven, so there is no waveform to save".to_owned());
                }
            },
            Export::Sound => match csv_wav::wav(self.instrument.shown().waveform) {
                Ok(Some(bytes)) => self.save("drive.wav", "Sound", "wav", bytes),
                Ok(None) => {
                    self.instrument.out.fail("Nothing is driven, so there is no drive to save".to_owned());
                }
                Err(error) => self.instrument.out.fail(format!("The sound could not be made: {error}")),
            },
            Export::Recording => {
                let text = self.instrument.desk.recorder().recording().to_csv();
                self.save("drag.csv", "Recording", "csv", text.into_bytes());
            }
            Export::Diagnostics => {
                let text = self.diagnostics();
                self.save("slipline-diagnostics.txt", "Text", "txt", text.into_bytes());
            }
        }
    }

    fn fail_unknown(&mut self) {
        let text =
            "The plate's table is not made yet, so its heights are not known: connect, and wait for it";
        self.instrument.out.fail(text.to_owned());
    }

    pub(super) fn file_event(&mut self, event: FileEvent) {
        // The log is part of the diagnostics, so it contains only names of files, not their folders, which may
        // name the user.
        let name_of = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match event {
            FileEvent::Opened(path, text) => {
                let name = name_of(&path);
                let text = match text {
                    Ok(text) => text,
                    Err(error) => return self.instrument.out.not_opened(&name, &error),
                };
                if self.instrument.opened_table(&name, &text) || self.instrument.opened_sweep(&name, &text) {
                    return;
                }
                if has_extension(&path, &["csv"]) {
                    return self.instrument.open_measurement(&name, text.into_bytes());
                }
                if profile_file::is_one(&text) {
                    match profile_file::read(&text) {
                        Ok(profile) => self.dialog = Some(Dialog::Profile(Box::new(profile))),
                        Err(error) => self.instrument.out.not_opened(&name, &error),
                    }
                    return;
                }
                match setup_file::read(&text) {
                    Ok(opened) => self.use_opened(opened),
                    Err(error) => return self.instrument.out.not_opened(&name, &error),
                }
                self.settings.used(&path);
                self.instrument.out.post(format!("Opened {name}"));
            }
            FileEvent::Measurement(path, bytes) => {
                let name = name_of(&path);
                match bytes {
                    Ok(bytes) => {
                        let is_text = Content::of(&bytes) == Content::Other;
                        if !(is_text && self.instrument.opened_table(&name, &text_of(&bytes))) {
                            self.instrument.open_measurement(&name, bytes);
                        }
                    }
                    Err(error) => self.instrument.out.not_opened(&name, &error),
                }
            }
            FileEvent::Profile(path, bytes) => {
                let text = bytes.as_ref().ok().map(|bytes| text_of(bytes));
                if text.is_some_and(|text| self.instrument.opened_table(&name_of(&path), &text)) {
                    return;
                }
                match bytes {
                    Ok(bytes) => self.instrument.take_profile(&name_of(&path), &bytes),
                    Err(error) => self.instrument.out.not_opened(&name_of(&path), &error),
                }
            }
            FileEvent::Saved(path, Ok(())) => {
                if path.extension().is_some_and(|extension| extension == "toml") {
                    self.settings.used(&path);
                }
                let logged = format!("Saved {}.", name_of(&path));
                self.instrument.out.report(Severity::Info, format!("Saved {}", path.display()), logged);
            }
            FileEvent::Saved(path, Err(reason)) => {
                let said = |name: &dyn Display| format!("{name} was not saved: {reason}");
                let (shown, logged) = (said(&path.display()), said(&name_of(&path)));
                self.instrument.out.report(Severity::Error, shown, logged);
            }
            FileEvent::NoDialog(job) => self.ask_for_path(job, None),
            FileEvent::Exists(path, save) => self.ask_for_path(FileJob::Save(save), Some(&path)),
        }
    }
}

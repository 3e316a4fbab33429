//! Carries out the intents of the views.

use super::{App, first_setup, set_theme};
use crate::files::{FileEvent, FileJob, Save, has_extension};
use crate::intent::{Confirm, Dialog, Export, Intent, Intents};
use crate::scene::DesignState;
use crate::settings::{Part, SPEEDS};
use eframe::egui;
use slipline_instrument::recording::Recording;
use slipline_link::protocol::event::State;
use slipline_link::{Request, Severity};
use slipline_model::export::csv_wav;
use slipline_model::export::figures::plate::{FigureJob, Subject};
use slipline_model::export::report;
use slipline_model::jobs::design::cut_files;
use slipline_model::response::is_measurement;
use slipline_model::scenes::{SCENES, Scene};
use slipline_model::setup::edit::Edit;
use slipline_model::setup::file::{self as setup_file, Opened};
use slipline_plate::design::Design;
use std::path::Path;
use std::sync::Arc;

/// Why codes cannot be saved that are not those of the device.
const UNKNOWN_CODES: &str = "What the device sends is not known since its levels were held, or since this program lost track of it: \
                             stop, and drive again";

impl App {
    pub(super) fn perform(&mut self, ctx: &egui::Context, intents: Intents) {
        for intent in intents {
            match intent {
                Intent::Edit(edit) => self.edit(&edit),
                Intent::MoveLine { slot, place_m } => {
                    self.end_replay();
                    self.move_line(slot, place_m);
                    self.note_move(ctx.input(|input| input.time), slot);
                }
                Intent::Request(request) => {
                    if let Request::AutoReconnect(looks) = request {
                        self.settings.auto_reconnect = looks;
                    }
                    let is_clearing = matches!(request, Request::ClearFaults);
                    let ticket = self.parts.link.send(request);
                    if is_clearing {
                        self.clear_sent = Some(ticket);
                    }
                }
                Intent::Connect(port) => self.connect(port),
                Intent::Start => self.start(),
                Intent::Stop => self.press_stop(ctx.input(|input| input.time)),
                Intent::Disarm => self.disarm(),
                Intent::HoldLevel(is_on) => self.switch_hold(is_on),
                Intent::MaxRise(decibels) => self.choose_max_rise(decibels),
                Intent::Select(slot) => self.selected = slot,
                Intent::Touch(touch) => self.touch(touch),
                Intent::MoveFinger(place_m) => self.move_finger(place_m),
                Intent::Sound(choice) => self.choose_sound(choice),
                Intent::Volume(volume) => self.settings.volume = volume.clamp(0.0, 1.0),
                Intent::Grab(grab) => {
                    self.end_replay();
                    self.grab = Some(grab);
                }
                Intent::Switch => {
                    let edit = self.compare.switch(&self.setup);
                    self.edit(&edit);
                }
                Intent::Record(records) => self.record(records),
                Intent::Play(plays) => self.play(plays),
                Intent::Loop(is_looped) => self.recorder.is_looped = is_looped,
                Intent::Speed(speed) => {
                    self.settings.speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
                }
                Intent::Scrub(time_s) => self.scrub(time_s),
                Intent::Undo => {
                    let name = self.history.undo_name();
                    let setup = self.history.undo(&self.setup);
                    self.step_back_or_forth(name, setup);
                }
                Intent::Redo => {
                    let name = self.history.redo_name();
                    let setup = self.history.redo(&self.setup);
                    self.step_back_or_forth(name, setup);
                }
                Intent::New => {
                    if let Some(setup) = first_setup() {
                        self.edit(&Edit::New(Box::new(setup)));
                    }
                }
                Intent::StartScene(number) => {
                    self.dialog = None;
                    if let Some(setup) = SCENES.get(number).and_then(Scene::setup) {
                        self.edit(&Edit::New(Box::new(setup)));
                    }
                }
                Intent::OpenDialog => self.parts.files.begin(FileJob::Choose),
                Intent::Open(path) => self.parts.files.begin(FileJob::Open(path)),
                Intent::SaveDialog => {
                    let text = setup_file::write(&self.setup);
                    self.save("setup.toml", "Setup", "toml", text.into_bytes());
                }
                Intent::SavePlateDialog => {
                    let text = self.setup.plate.to_toml();
                    self.save("plate.toml", "Plate", "toml", text.into_bytes());
                }
                Intent::Design(draft) => self.design(*draft),
                Intent::UseDesign => {
                    if let Some(designed) = self.designed() {
                        self.edit(&Edit::Plate(Arc::new(designed.plate.clone())));
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
                        self.parts.files.begin(FileJob::SaveFolder(cut_files(&designed)));
                    }
                }
                Intent::Texture(draft) => self.textures.draft(*draft),
                Intent::PlayTexture => self.play_texture(),
                Intent::SaveTexture => self.save_texture(),
                Intent::OpenProfile => self.parts.files.begin(FileJob::ChooseProfile),
                Intent::Measure(intent) => self.perform_measure(intent),
                Intent::Calibrate(intent) => self.perform_calibrate(intent),
                Intent::CheckPlane => self.check_plane(),
                Intent::CancelWork => self.cancel_work(),
                Intent::MakeTable => {
                    self.table_asked = None;
                    self.ask_for_table();
                }
                Intent::Wave(wish) => self.settings.wave = wish,
                Intent::Export(export) => self.export(ctx, export),
                Intent::Upload => {
                    if let Some(made) = self.table.made() {
                        self.parts.link.send(Request::Upload(Arc::clone(&made.device_table)));
                    }
                }
                Intent::Theme(choice) => {
                    self.settings.theme = choice;
                    set_theme(ctx, choice);
                }
                Intent::Dialog(dialog) => {
                    if dialog == Some(Dialog::Scenes) && self.thumbnails.is_empty() {
                        self.parts.scenes.ask(());
                    }
                    self.dialog = dialog.or(self.behind.take());
                }
                Intent::Path(text, may_replace) => self.take_path(&text, may_replace),
                Intent::Confirmed(confirm) => {
                    self.dialog = None;
                    self.confirmed(confirm);
                }
                Intent::DismissNotice(number) => self.notices.dismiss(number),
                Intent::RefreshPorts => self.ports = (self.parts.ports)(),
                Intent::ShowAmplitude(show) => self.settings.show_amplitude = show,
                Intent::ShowRelief(show) => self.settings.show_relief = show,
                Intent::ShowPanel(show) => {
                    self.settings.show_panel = show;
                    self.settings.in_front = if show { Part::Panel } else { Part::Plots };
                }
                Intent::ShowPlots(show) => {
                    self.settings.show_plots = show;
                    self.settings.in_front = if show { Part::Plots } else { Part::Panel };
                    // Where there is room for one part, a message would keep the panel open.
                    self.notices.seen();
                }
                Intent::Animate(animate) => self.settings.animate = animate,
                Intent::Copy(text) => ctx.copy_text(text),
                Intent::ShowDevice => self.view.open_device(),
                Intent::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
                Intent::CopyDiagnostics => {
                    ctx.copy_text(self.diagnostics());
                    self.dialog = Some(Dialog::Diagnostics);
                }
            }
            ctx.request_repaint();
        }
    }

    fn confirmed(&mut self, confirm: Confirm) {
        let snapshot = &self.snapshot;
        let request = match confirm {
            Confirm::Arm => Request::Arm,
            Confirm::Store => Request::Store,
            Confirm::Forget => Request::Forget,
            Confirm::Bootloader => Request::Bootloader,
        };
        if confirm == Confirm::Arm
            && snapshot.maintenance.is_some_and(|told| !told.brown_out_guarded)
            && let Some(unit) = snapshot.unit()
        {
            self.settings.arms_unguarded(unit);
        }
        let is_armed = snapshot.status.is_some_and(|status| status.state == State::Armed);
        if is_armed && matches!(confirm, Confirm::Store | Confirm::Forget) {
            // An armed device does not write its flash.
            self.parts.link.send(Request::Disarm);
        }
        self.parts.link.send(request);
    }

    /// The plate that was designed from the present draft.
    fn designed(&self) -> Option<Arc<Design>> {
        let DesignState::Ready(designed) = &self.background.shown.design else { return None };
        designed.result.as_ref().ok().cloned()
    }

    fn diagnostics(&self) -> String {
        report::text(&self.snapshot, &self.setup, &self.table)
    }

    pub(super) fn save(&mut self, name: &str, kind: &'static str, extension: &'static str, bytes: Vec<u8>) {
        let save = Save { name: name.to_owned(), kind, extension, bytes: bytes.into() };
        self.parts.files.begin(FileJob::Save(save));
    }

    fn export(&mut self, ctx: &egui::Context, what: Export) {
        if matches!(what, Export::Figure(_) | Export::Envelope) && self.finger().is_some() {
            // The simulated plate beside the prediction has no finger.
            self.notices.tell("The export shows the plate without the finger".to_owned());
            return self.without_finger(|app| app.export(ctx, what));
        }
        match what {
            Export::Figure(format) => {
                let Some(full_peak_m) = self.full_peak_m() else { return self.fail_unknown() };
                let subject = Subject {
                    setup: self.setup.clone(),
                    predicted: self.predicted.clone(),
                    sounding: self.sounding_on_screen().cloned(),
                    sheet: self.shown_sheet().cloned(),
                    measured: self.current_measured().cloned(),
                    full_peak_m,
                    is_largest: self.settings.show_amplitude,
                    wave_time_s: self.playback.wave_time_s,
                };
                self.parts.figures.ask(FigureJob { subject, format });
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
                let Some(full_peak_m) = self.full_peak_m() else { return self.fail_unknown() };
                let measured = self.current_measured();
                let text = csv_wav::envelope_csv(&self.setup, &self.predicted, measured, full_peak_m);
                self.save("envelope.csv", "Table", "csv", text.into_bytes());
            }
            Export::Waveform | Export::Sound if self.playback.is_unknown() => {
                self.fail(UNKNOWN_CODES.to_owned());
            }
            Export::Waveform => match csv_wav::waveform_csv(&self.playback.waveform) {
                Some(text) => self.save("waveform.csv", "Table", "csv", text.into_bytes()),
                None => self.fail("Nothing is driven, so there is no waveform to save".to_owned()),
            },
            Export::Sound => match csv_wav::wav(&self.playback.waveform) {
                Ok(Some(bytes)) => self.save("drive.wav", "Sound", "wav", bytes),
                Ok(None) => self.fail("Nothing is driven, so there is no drive to save".to_owned()),
                Err(error) => self.fail(format!("The sound could not be made: {error}")),
            },
            Export::Recording => {
                let text = self.recorder.recording().to_csv();
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
        self.fail(text.to_owned());
    }

    pub(super) fn file_event(&mut self, event: FileEvent) {
        // The log is part of the diagnostics, so it contains only names of files, not their folders, which may
        // name the user.
        let name_of = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match event {
            FileEvent::Opened(path, text) => {
                let name = name_of(&path);
                if let Ok(text) = &text {
                    if self.opened_table(&name, text) {
                        return;
                    }
                    if self.opened_sweep(&name, text) {
                        return;
                    }
                    if has_extension(&path, &["csv"]) {
                        return self.open_measurement(&name, text.clone().into_bytes());
                    }
                }
                let opened = text.and_then(|text| setup_file::read(&text).map_err(|error| error.to_string()));
                match opened {
                    Ok(Opened::Setup(setup)) => self.edit(&Edit::Replace(setup)),
                    Ok(Opened::Plate(plate)) => self.edit(&Edit::Plate(plate)),
                    Err(reason) => return self.not_opened(&name, &reason),
                }
                self.settings.used(&path);
                self.note(Severity::Info, format!("Opened {name}."));
                self.notices.tell(format!("Opened {name}"));
            }
            FileEvent::Measurement(path, bytes) => {
                let name = name_of(&path);
                match bytes {
                    Ok(bytes) => {
                        let text = str::from_utf8(&bytes).unwrap_or_default();
                        if !self.opened_table(&name, text) {
                            self.open_measurement(&name, bytes);
                        }
                    }
                    Err(reason) => self.not_opened(&name, &reason),
                }
            }
            FileEvent::Profile(path, bytes) => {
                let text = bytes.as_ref().ok().and_then(|bytes| str::from_utf8(bytes).ok());
                if text.is_some_and(|text| self.opened_table(&name_of(&path), text)) {
                    return;
                }
                self.take_profile(&name_of(&path), bytes);
            }
            FileEvent::Saved(path, Ok(())) => {
                if path.extension().is_some_and(|extension| extension == "toml") {
                    self.settings.used(&path);
                }
                self.note(Severity::Info, format!("Saved {}.", name_of(&path)));
                self.notices.tell(format!("Saved {}", path.display()));
            }
            FileEvent::Saved(path, Err(reason)) => {
                self.note(Severity::Error, format!("{} was not saved: {reason}", name_of(&path)));
                self.fail(format!("{} was not saved: {reason}", path.display()));
            }
            FileEvent::NoDialog(job) => self.ask_for_path(job, None),
            FileEvent::Exists(path, save) => self.ask_for_path(FileJob::Save(save), Some(&path)),
        }
    }

    /// Takes a recorded drag or a measurement; whether the text is one of them.
    fn opened_table(&mut self, name: &str, text: &str) -> bool {
        if Recording::is_one(text) {
            self.open_recording(name, Recording::from_csv(text).map_err(|error| error.to_string()));
        } else if is_measurement(text) {
            self.open_measurement(name, text.as_bytes().to_vec());
        } else {
            return false;
        }
        true
    }

    fn open_recording(&mut self, name: &str, recording: Result<Recording, String>) {
        match recording {
            Ok(recording) => {
                self.take_recording(recording);
                self.note(Severity::Info, format!("Opened {name}."));
                self.notices.tell(format!("Opened {name}: press Play on the page Play"));
            }
            Err(reason) => self.not_opened(name, &reason),
        }
    }

    /// Tells why a file was not opened, on the screen and in the log.
    pub(super) fn not_opened(&mut self, name: &str, reason: &str) {
        let text = format!("{name} was not opened, nothing has changed. {reason}");
        self.note(Severity::Error, text.clone());
        self.fail(text);
    }

    pub(super) fn note(&self, severity: Severity, text: String) {
        self.parts.link.send(Request::Note(severity, text));
    }
}

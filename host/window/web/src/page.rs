//! The page's entry: the window on a canvas, with the browser's parts.

use crate::access;
use crate::files::{BrowserFiles, Dropped};
use crate::fonts::fonts;
use crate::host::Host;
use crate::message;
use crate::remote_link::RemoteLink;
use crate::work::{self, Kind, Workers};
use eframe::egui;
use js_sys::Promise;
use serde::Serialize;
use slipline_instrument::Jobs;
use slipline_instrument::bench::Bench;
use slipline_model::export::figures::plate;
use slipline_model::field::line::Holds;
use slipline_model::jobs::JobQueue;
use slipline_model::scenes::thumbnails;
use slipline_model::setup::file::{self as setup_file, Opened};
use slipline_model::setup::fragment;
use slipline_model::sound::Sound;
use slipline_window::app::{App, Parts, PressAges, Services, first_setup};
use slipline_window::settings::Settings;
use slipline_window::sound::{Speaker, SpeakerState};
use slipline_window::view::theme;
use std::cell::RefCell;
use std::rc::Rc;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::HtmlCanvasElement;

/// Keys of the values that are stored between visits.
const KEPT_SETTINGS: &str = "slipline-settings";
const KEPT_SETUP: &str = "slipline-setup";
/// The browser has no clipboard for this page, or the user has not allowed its use.
const NOT_COPIED: &str =
    "The browser did not let the page copy. The address bar has the address of this setup";

/// A browser plays no sound yet, and offers none.
struct NoSpeaker;

impl Speaker for NoSpeaker {
    fn play(&self, _sound: Sound, _volume: f32) {}

    fn state(&self) -> SpeakerState {
        SpeakerState::Closed
    }

    fn retry(&self) {}
}

/// The reports of the page's script since the latest picture.
#[derive(Default)]
struct Reports {
    /// STOP was pressed outside the canvas.
    is_stopped: bool,
    /// The page was hidden or left, and stopped: the sentence to show on return.
    left: Option<String>,
    /// The fragment of the address, and whether this page itself has written it.
    fragment: Option<(String, bool)>,
    /// What the browser could not do, as a sentence.
    refused: Option<String>,
    /// What a screen reader has pressed.
    pressed: Vec<egui::Event>,
}

/// The window on the page.
struct Window {
    app: App,
    link: RemoteLink,
    dropped: Dropped,
    workers: Rc<Workers>,
    host: Rc<Host>,
    reports: Rc<RefCell<Reports>>,
    /// The file of the setup that somebody's link has opened: as long as it is as it was, the user's own setup stays stored.
    linked: Option<String>,
    /// Whether the page is a frame of another page, of which nothing is kept.
    is_frame: bool,
    /// Pictures so far.
    frames: u64,
}

impl Window {
    /// Opens the setup of an address.
    fn open_fragment(&mut self, fragment: &str, is_own: bool) {
        match fragment::read(fragment) {
            Some(Ok(opened)) => {
                self.app.use_opened(opened);
                self.linked = (!is_own).then(|| setup_file::write(self.app.setup()));
            }
            Some(Err(error)) => self.app.fail(error.to_string()),
            None => {}
        }
    }

    /// Has the page copy what the picture wants to be copied: only it knows whether that was possible.
    fn copy(&self, ctx: &egui::Context) {
        let commands = ctx.output_mut(|output| {
            let (copied, rest) = std::mem::take(&mut output.commands)
                .into_iter()
                .partition::<Vec<_>, _>(|command| matches!(command, egui::OutputCommand::CopyText(_)));
            output.commands = rest;
            copied
        });
        for command in commands {
            let egui::OutputCommand::CopyText(text) = command else { continue };
            report(self.host.copy(&text), ctx, &self.reports, |answer| {
                (answer.as_bool() != Some(true)).then(|| NOT_COPIED.to_owned())
            });
        }
    }
}

impl eframe::App for Window {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        let Reports { is_stopped, left, fragment, refused, pressed: _ } = self.reports.take();
        access::follow_up(ctx);
        if is_stopped {
            self.app.press_stop();
        }
        if let Some(sentence) = left {
            self.app.end_drive();
            if !sentence.is_empty() {
                self.app.fail(sentence);
            }
        }
        if let Some((fragment, is_own)) = fragment {
            self.open_fragment(&fragment, is_own);
        }
        if let Some(sentence) = refused {
            self.app.fail(sentence);
        }
        let (are_ports_new, chosen) = self.link.take_port_news();
        if are_ports_new {
            self.app.look_for_ports();
        }
        if let Some(port) = chosen {
            self.app.connect(port);
        }
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.dropped.replace(dropped);
        }
        self.app.logic(ctx);
        self.link.send_bench();
        self.workers.attend();
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.frames += 1;
        self.app.show(ui);
        self.copy(ui.ctx());
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, raw_input: &mut egui::RawInput) {
        raw_input.events.append(&mut self.reports.borrow_mut().pressed);
        access::begin(ctx, raw_input.time.unwrap_or_default());
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::ground(visuals)
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if self.is_frame {
            return;
        }
        storage.set_string(KEPT_SETTINGS, self.app.settings().write());
        let setup = setup_file::write(&self.app.kept_setup());
        if self.linked.as_ref() != Some(&setup) {
            self.linked = None;
            storage.set_string(KEPT_SETUP, setup);
        }
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }

    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

/// The state of the window, for `window.slipline.state()`.
#[derive(Serialize)]
struct State<'a> {
    turning_point_m: f64,
    felt_edge_m: Option<f64>,
    can_undo: bool,
    tones: usize,
    /// Pictures so far.
    frames: u64,
    notice: Option<&'a str>,
    /// The kinds of the jobs that run in workers.
    computing: Vec<Kind>,
}

/// The page that is open; the script passes messages and events on to it.
#[wasm_bindgen]
pub struct Page {
    runner: eframe::WebRunner,
    link: RemoteLink,
    workers: Rc<Workers>,
    ctx: egui::Context,
    reports: Rc<RefCell<Reports>>,
}

#[wasm_bindgen]
impl Page {
    /// Takes an update of the device worker; a loud one is worth a picture.
    #[wasm_bindgen(js_name = deviceChanged)]
    pub fn device_changed(&self, bytes: &[u8], is_loud: bool) {
        self.link.update(bytes);
        if is_loud {
            self.ctx.request_repaint();
        }
    }

    /// The device worker has failed.
    #[wasm_bindgen(js_name = deviceCrashed)]
    pub fn device_crashed(&self) {
        self.link.crash();
        self.ctx.request_repaint();
    }

    /// Takes the result of a job from the worker of this name; nothing if the worker has failed.
    #[wasm_bindgen(js_name = jobDone)]
    pub fn job_done(&self, lane: &str, bytes: Option<Vec<u8>>) {
        self.workers.take(lane, bytes);
    }

    /// Takes the share that the worker of this name has done of its job.
    #[wasm_bindgen(js_name = jobProgress)]
    pub fn job_progress(&self, lane: &str, share: f64) {
        self.workers.progress(lane, share);
    }

    /// STOP was pressed outside the canvas: the window wants no drive any more.
    pub fn stop(&self) {
        self.reports.borrow_mut().is_stopped = true;
        self.ctx.request_repaint();
    }

    /// The page was hidden or left, and the device stopped: the sentence to show on return, or an empty one.
    pub fn left(&self, sentence: String) {
        self.reports.borrow_mut().left = Some(sentence);
        self.ctx.request_repaint();
    }

    /// Opens the setup in the fragment of the address, which somebody else has written.
    #[wasm_bindgen(js_name = openFragment)]
    pub fn open_fragment(&self, fragment: String) {
        self.reports.borrow_mut().fragment = Some((fragment, false));
        self.ctx.request_repaint();
    }

    /// The lines and the setup on the screen and the jobs that run as JSON, for `window.slipline.state()`; nothing after a panic.
    pub fn state(&self) -> Option<String> {
        let window = self.runner.app_mut::<Window>()?;
        let shown = window.app.shown();
        let line = shown.line(shown.selected)?;
        Some(message::json(&State {
            turning_point_m: shown.setup.tone(shown.selected)?.position_m,
            felt_edge_m: (line.holds == Holds::FeltEdge).then_some(line.place_m),
            can_undo: shown.undo.0.is_some(),
            tones: shown.setup.tones.len(),
            frames: window.frames,
            notice: window.app.notice().map(|notice| notice.text.as_str()),
            computing: self.workers.computing(),
        }))
    }

    /// The accessible nodes of the window in reading order, if they have changed since the last call.
    #[wasm_bindgen(js_name = newNodes)]
    pub fn new_nodes(&self) -> Option<js_sys::Array> {
        access::take_news(&self.ctx).then(|| access::nodes(&self.ctx))
    }

    /// CSS pixels of a point of the window.
    #[must_use]
    pub fn zoom(&self) -> f32 {
        self.ctx.zoom_factor()
    }

    /// Presses the accessible node of this id.
    pub fn press(&self, id: &str) {
        self.reports.borrow_mut().pressed.extend(access::press(id));
        self.ctx.request_repaint();
    }

    /// The accessible nodes of the latest picture, for `window.slipline.nodes()` of a build for tests.
    #[cfg(feature = "tests")]
    #[must_use]
    pub fn nodes(&self) -> js_sys::Array {
        access::nodes(&self.ctx)
    }

    /// The setup on the screen as the fragment of an address, without its `#`; nothing during the demonstration, whose line is
    /// not the user's, and after a panic.
    pub fn fragment(&self) -> Option<String> {
        let window = self.runner.app_mut::<Window>()?;
        (!window.app.is_demonstrating()).then(|| fragment::write(window.app.setup()))
    }
}

/// Opens the window on this canvas, with the fragment of the address and whether this page itself has written it.
///
/// # Errors
/// Why there can be no window, such as a browser without WebGL 2.
#[wasm_bindgen(js_name = openPage)]
pub async fn open_page(
    canvas: HtmlCanvasElement,
    host: Host,
    fragment: String,
    is_own: bool,
) -> Result<Page, JsValue> {
    let host = Rc::new(host);
    let runner = eframe::WebRunner::new();
    let bench = Bench::elsewhere();
    let link = RemoteLink::new(Rc::clone(&host), bench.clone());
    let reports = Rc::new(RefCell::new(Reports { fragment: Some((fragment, is_own)), ..Reports::default() }));
    let options = eframe::WebOptions {
        // Noise under the last bit of a colour is not seen, and software graphics compute it for every pixel.
        dithering: false,
        ..Default::default()
    };
    let context = Rc::new(RefCell::new(None));
    let (linked, reported, opened) = (link.clone(), Rc::clone(&reports), Rc::clone(&context));
    let create = move |creation: &eframe::CreationContext<'_>| {
        access::keep(&creation.egui_ctx);
        let (workers, jobs) = work::workers(&host, &creation.egui_ctx);
        let workers = Rc::new(workers);
        opened.replace(Some((creation.egui_ctx.clone(), Rc::clone(&workers))));
        let dropped = Dropped::default();
        let files = BrowserFiles::new(Rc::clone(&host), creation.egui_ctx.clone(), Rc::clone(&dropped));
        creation.egui_ctx.set_fonts(fonts());
        let ask_for_port = board_question(&host, &creation.egui_ctx, &reported);
        let parts = parts(linked.clone(), jobs, bench, files, (host.address(), ask_for_port));
        let is_frame = host.is_frame();
        let app = app(creation, parts, host.is_still(), is_frame)?;
        let (link, reports) = (linked, reported);
        let window = Window { app, link, dropped, workers, host, reports, linked: None, is_frame, frames: 0 };
        Ok(Box::new(window) as Box<dyn eframe::App>)
    };
    runner.start(canvas, options, Box::new(create)).await?;
    let (ctx, workers) = context.take().ok_or("the window was not made")?;
    Ok(Page { runner, link, workers, ctx, reports })
}

/// Has the user choose a board in the browser's list; a sentence if that cannot be goes to the reports.
fn board_question(host: &Rc<Host>, ctx: &egui::Context, reports: &Rc<RefCell<Reports>>) -> Box<dyn FnMut()> {
    let (host, ctx, reports) = (Rc::clone(host), ctx.clone(), Rc::clone(reports));
    Box::new(move || report(host.ask_for_port(), &ctx, &reports, |answer| answer.as_string()))
}

/// Waits for an answer of the page; a sentence that is made of it goes to the reports.
fn report(
    answer: Promise,
    ctx: &egui::Context,
    reports: &Rc<RefCell<Reports>>,
    sentence_of: impl FnOnce(JsValue) -> Option<String> + 'static,
) {
    let (ctx, reports) = (ctx.clone(), Rc::clone(reports));
    spawn_local(async move {
        let sentence = JsFuture::from(answer).await.ok().and_then(sentence_of);
        if let Some(sentence) = sentence.filter(|sentence| !sentence.is_empty()) {
            reports.borrow_mut().refused = Some(sentence);
            ctx.request_repaint();
        }
    });
}

/// The window's parts, as a browser has them.
fn parts(
    link: RemoteLink,
    jobs: Jobs,
    bench: Bench,
    files: BrowserFiles,
    (address, ask_for_port): (String, Box<dyn FnMut()>),
) -> Parts {
    let listing = link.clone();
    let services = Services {
        scenes: JobQueue::inline(|(), task: &_| thumbnails(task)),
        figures: JobQueue::inline(|job, task: &_| plate::work(&job, task)),
        speaker: Box::new(NoSpeaker),
        files: Box::new(files),
        ports: Box::new(move || listing.ports()),
        ask_for_port: Some(ask_for_port),
        address: Some(address),
        press_ages: PressAges::default(),
    };
    Parts { link: Box::new(link), jobs, bench, services }
}

/// The app with what is stored of an earlier visit; a first one begins without motion if the user wants little of it. A frame
/// takes nothing from there: it shows what the page around it asks for.
fn app(
    creation: &eframe::CreationContext<'_>,
    parts: Parts,
    is_still: bool,
    is_frame: bool,
) -> Result<App, Box<dyn std::error::Error + Send + Sync>> {
    let storage = creation.storage.filter(|_| !is_frame);
    let kept = |key: &str| storage.and_then(|storage| storage.get_string(key));
    let settings = kept(KEPT_SETTINGS);
    let is_first_visit = settings.is_none();
    let first = Settings { animate: !is_still, ..Settings::default() };
    let settings = settings.as_deref().map_or(first, Settings::read);
    let setup = match kept(KEPT_SETUP).as_deref().map(setup_file::read) {
        Some(Ok(Opened::Setup(setup))) => *setup,
        _ => first_setup().ok_or("the first preset is damaged")?,
    };
    let mut app = App::new(&creation.egui_ctx, parts, setup, settings);
    if is_frame {
        app.open_in_frame();
    } else if is_first_visit && !is_still {
        app.demonstrate();
    }
    Ok(app)
}

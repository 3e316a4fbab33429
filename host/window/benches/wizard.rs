//! The calibration's pages by a real pointer: in a real window, on a secret plate, from a preset to the actual plate.
//!
//! `cargo bench --profile dev --bench wizard` prints how long it takes beside the measurements themselves, and how far
//! the rings of the actual plate lie from the predicted curve afterwards; it fails if one lies too far away. It needs
//! an X display and `xdotool`, and moves the display's pointer.
//! Where a control is says the window's accessibility tree, what is on the envelope its export as CSV.

use eframe::egui::{self, Pos2, ViewportCommand, accesskit::Role, pos2};
use slipline_instrument::bench::Bench;
use slipline_link::native::{SystemOpener, Worker};
use slipline_link::simulator::Options;
use slipline_model::setup::Setup;
use slipline_window::app::{App, Parts, run_in_event_loop};
use slipline_window::files::{FileEvent, FileJob, Files};
use slipline_window::settings::Settings;
use slipline_window::view::theme;
use std::process::{Command, ExitCode};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

/// Presets of either kind of wave whose edge one can build.
const PRESETS: [&str; 3] = ["membrane", "latex-membrane", "al-bending"];
/// The goal for all that is pressed and read, without the two measurements.
const GOAL: Duration = Duration::from_secs(60);
/// How far a ring may lie from the curve, over the height of the curve.
const CLOSE: f64 = 0.01;
/// Places that are compared, over the distance of the boundary from the driven end.
const SHARES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];
/// Time between two looks at the window, and the longest wait for anything.
const LOOK: Duration = Duration::from_millis(20);
const HANG: Duration = Duration::from_secs(300);
/// How long a hand rests on a control before it presses, and how long it presses.
const REST: &str = "0.15";
const PRESS: &str = "0.06";

/// A control or a text of the window.
#[derive(Clone, PartialEq)]
struct Control {
    role: Role,
    name: String,
    /// Its middle on the screen, in pixels.
    at: Pos2,
    is_enabled: bool,
}

/// What the window says of itself, by its accessibility tree.
#[derive(Clone, Default)]
struct Seen(Arc<Mutex<Vec<Control>>>);

impl egui::Plugin for Seen {
    fn debug_name(&self) -> &'static str {
        "what the window says of itself"
    }

    fn output_hook(&mut self, ctx: &egui::Context, output: &mut egui::FullOutput) {
        let Some(update) = &output.platform_output.accesskit_update else { return };
        let window = ctx.input(|input| input.viewport().inner_rect).unwrap_or(egui::Rect::ZERO);
        let scale = output.pixels_per_point;
        let control = |(_, node): &(_, egui::accesskit::Node)| {
            let bounds = node.bounds()?;
            let middle = pos2((0.5 * (bounds.x0 + bounds.x1)) as f32, (0.5 * (bounds.y0 + bounds.y1)) as f32);
            Some(Control {
                role: node.role(),
                name: node.label().or_else(|| node.value())?.to_owned(),
                at: ((window.min + middle.to_vec2()).to_vec2() * scale).to_pos2(),
                is_enabled: !node.is_disabled(),
            })
        };
        *lock(&self.0) = update.nodes.iter().filter_map(control).collect();
    }
}

fn lock<T>(shared: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The file that the window saved last.
#[derive(Clone, Default)]
struct Saved(Arc<Mutex<Option<String>>>);

impl Files for Saved {
    fn begin(&mut self, job: FileJob) {
        if let FileJob::Save(save) = job {
            *lock(&self.0) = Some(String::from_utf8_lossy(&save.bytes).into_owned());
        }
    }

    fn take(&mut self) -> Option<FileEvent> {
        None
    }
}

/// A hand that looks at the window and presses its controls by the pointer of the display.
struct Hand {
    ctx: egui::Context,
    seen: Seen,
    saved: Saved,
}

impl Hand {
    /// Waits until `find` finds something in the window.
    fn wait<T>(&self, what: &str, find: impl Fn(&[Control]) -> Option<T>) -> T {
        let began = Instant::now();
        loop {
            if let Some(found) = find(&lock(&self.seen.0)) {
                return found;
            }
            assert!(began.elapsed() < HANG, "{what} never comes");
            sleep(LOOK);
        }
    }

    /// Presses a control once it is shown, enabled and at rest.
    fn press(&self, role: Role, name: &str) {
        let found = |seen: &[Control]| {
            // An entry of a menu has its shortcut after its name, if it has one.
            let is_it = |it: &&Control| it.role == role && it.name.trim_end() == name && it.is_enabled;
            seen.iter().find(is_it).cloned()
        };
        let mut control = self.wait(name, found);
        loop {
            sleep(3 * LOOK);
            let now = self.wait(name, found);
            if now == control {
                break;
            }
            control = now;
        }
        let (x, y) = (control.at.x.round().to_string(), control.at.y.round().to_string());
        let moves = ["mousemove", &x, &y, "sleep", REST];
        let presses = ["mousedown", "1", "sleep", PRESS, "mouseup", "1"];
        let status = Command::new("xdotool").args(moves).args(presses).status();
        assert!(status.is_ok_and(|status| status.success()), "xdotool presses {name}");
    }

    fn is_there(&self, name: &str) -> bool {
        lock(&self.seen.0).iter().any(|it| it.name == name)
    }

    /// Waits for the calibration's page of this number.
    fn page(&self, number: usize) {
        let page = format!("{number} of 5");
        self.wait(&page, |seen| seen.iter().any(|it| it.name == page).then_some(()));
    }

    /// Measures with the device; returns how long that takes.
    fn measure(&self) -> Duration {
        self.press(Role::Button, "Measure now");
        let is_measuring = |seen: &[Control]| seen.iter().any(|it| it.name == "Cancel measuring");
        self.wait("a measurement", |seen| is_measuring(seen).then_some(()));
        let began = Instant::now();
        // The rig is put together first; between the two nothing is under way.
        let leads_on = |seen: &[Control]| seen.iter().any(|it| it.name == "Next" && it.is_enabled);
        self.wait("the end of a measurement", |seen| (!is_measuring(seen) && leads_on(seen)).then_some(()));
        began.elapsed()
    }

    /// The envelope as the window exports it.
    fn envelope(&self) -> Envelope {
        lock(&self.saved.0).take();
        self.press(Role::Button, "File");
        self.press(Role::Button, "Export envelope (CSV)…");
        let text = self.wait("a file", |_| lock(&self.saved.0).take());
        Envelope::read(&text)
    }

    /// Calibrates the plate on the screen by one that is a few per cent off; returns the time beside the measurements and
    /// the envelope on the calibrated plate.
    fn calibrate(&self) -> (Duration, Duration, Envelope) {
        self.wait("a drive", |seen| seen.iter().any(|it| it.name == "State: driving").then_some(()));
        let began = Instant::now();
        self.press(Role::Button, "Plate");
        self.press(Role::Button, "Measure");
        self.press(Role::CheckBox, "Hidden test plate (its numbers differ)");
        self.press(Role::Button, "Calibrate…");
        for number in [1, 2] {
            self.page(number);
            self.press(Role::Button, "Next");
        }
        self.page(3);
        let mut measured = self.measure();
        self.press(Role::Button, "Next");
        self.page(4);
        measured += self.measure();
        self.press(Role::Button, "Next");
        self.page(5);
        // A drive that the measurement interrupted resumes by itself.
        self.press(Role::Button, "Use this plate");
        self.wait("a drive", |seen| seen.iter().any(|it| it.name == "State: driving").then_some(()));
        let took = began.elapsed() - measured;
        loop {
            let envelope = self.envelope();
            if !envelope.there.is_empty() {
                return (took, measured, envelope);
            }
            assert!(began.elapsed() < HANG && self.is_there("State: driving"), "no ring ever comes");
        }
    }
}

/// The window is closed however its hand ends.
impl Drop for Hand {
    fn drop(&mut self) {
        self.ctx.send_viewport_cmd(ViewportCommand::Close);
        self.ctx.request_repaint();
    }
}

/// The exported envelope: places in metres from the driven end, displacements in metres.
struct Envelope {
    plate: String,
    boundary_m: f64,
    predicted: Vec<(f64, f64)>,
    there: Vec<(f64, f64)>,
}

impl Envelope {
    fn read(text: &str) -> Self {
        let head = |from: &str, to: &str| {
            let after = text.split_once(from).map_or("", |(_, after)| after);
            after.split_once(to).map_or("", |(value, _)| value).to_owned()
        };
        let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
        let cells: Vec<Vec<Option<f64>>> =
            rows.map(|row| row.split(',').map(|cell| cell.parse().ok()).collect()).collect();
        let column = |number: usize| {
            cells.iter().filter_map(|row| Some(((*row.first()?)?, (*row.get(number)?)?))).collect()
        };
        let boundary_m = head("Hz, turning point ", " m,").parse().unwrap_or(f64::NAN);
        Self { plate: head("# plate: ", "\n"), boundary_m, predicted: column(1), there: column(3) }
    }

    /// How far the rings lie from the curve at the places of [`SHARES`], over the height of the curve. The sensor on a secret
    /// plate has no known sensitivity, so the level is that of the prediction, as on the stage.
    fn off(&self) -> [f64; SHARES.len()] {
        let highest = |points: &[(f64, f64)]| points.iter().map(|point| point.1).fold(0.0, f64::max);
        let (top_m, level) = (highest(&self.predicted), highest(&self.predicted) / highest(&self.there));
        SHARES.map(|share| {
            let wanted_m = share * self.boundary_m;
            let away = |point: &&(f64, f64)| (point.0 - wanted_m).abs();
            let ring = self.there.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let Some(&(x_m, ring_m)) = ring else { return f64::NAN };
            let after =
                self.predicted.partition_point(|point| point.0 < x_m).clamp(1, self.predicted.len() - 1);
            let ((a_m, from_m), (b_m, to_m)) = (self.predicted[after - 1], self.predicted[after]);
            let curve_m = from_m + (to_m - from_m) * (x_m - a_m) / (b_m - a_m);
            (level * ring_m - curve_m).abs() / top_m
        })
    }
}

struct Window {
    app: App,
    _worker: Worker,
}

impl eframe::App for Window {
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::ground(visuals)
    }

    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.app.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        // The system's own accessibility may have switched it off.
        ui.ctx().enable_accesskit();
        self.app.show(ui);
    }
}

/// Calibrates one preset in a window of its own.
fn calibrate(preset: &'static str) -> Result<(), String> {
    let plate = slipline_plate::preset(preset).ok_or("there is no such preset")?;
    let setup = Setup::new(plate.into());
    let viewport = egui::ViewportBuilder::default().with_inner_size([1280.0, 800.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let hand: Arc<Mutex<Option<JoinHandle<_>>>> = Arc::default();
    let moved = Arc::clone(&hand);
    let open = move |context: &eframe::CreationContext<'_>| {
        let ctx = &context.egui_ctx;
        let (bench, saved, seen) = (Bench::default(), Saved::default(), Seen::default());
        let (wired, waker) = (bench.clone(), ctx.clone());
        let worker =
            Worker::spawn_with(SystemOpener::wired(Options::default(), move || wired.inputs()), move || {
                waker.request_repaint();
            })?;
        let handle = worker.handle();
        let mut parts = Parts { bench, ..Parts::threaded(ctx, Box::new(handle.clone()))? };
        parts.services.files = Box::new(saved.clone());
        ctx.enable_accesskit();
        ctx.add_plugin(seen.clone());
        let app = App::new(ctx, parts, setup, Settings::default());
        let press_ages = app.press_ages();
        let hand = Hand { ctx: ctx.clone(), seen, saved };
        *lock(&moved) = Some(spawn(move || hand.calibrate()));
        Ok((Box::new(Window { app, _worker: worker }) as Box<dyn eframe::App>, handle, press_ages))
    };
    run_in_event_loop("Slipline wizard", options, open, || ()).map_err(|error| error.to_string())?;
    let hand = lock(&hand).take().ok_or("the window was never opened")?;
    let (took, measured, envelope) = hand.join().map_err(|_| "the hand did not get to the end")?;
    let off = envelope.off();
    println!("{preset}: \"{}\"", envelope.plate);
    println!(
        "  pressed and read             {:6.1} s    goal {} s, beside {:.1} s of measuring",
        took.as_secs_f64(),
        GOAL.as_secs(),
        measured.as_secs_f64()
    );
    let percent = off.map(|off| format!("{:.2}", 100.0 * off)).join("  ");
    println!("  rings from the curve     {percent} %  goal {} %", 100.0 * CLOSE);
    let is_close = off.iter().all(|&off| off <= CLOSE);
    is_close.then_some(()).ok_or_else(|| format!("{preset}: a ring lies beside the curve"))
}

fn main() -> ExitCode {
    // As `cargo test --benches` calls it: there may be no display.
    if !std::env::args().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS;
    }
    if let Some(preset) =
        PRESETS.into_iter().find(|&preset| std::env::args().any(|argument| argument == preset))
    {
        return match calibrate(preset) {
            Ok(()) => ExitCode::SUCCESS,
            Err(reason) => {
                eprintln!("{reason}");
                ExitCode::FAILURE
            }
        };
    }
    // A process has one event loop, so each window has its process.
    let is_done = |preset: &str| {
        let program =
            std::env::current_exe().map(|path| Command::new(path).args(["--bench", preset]).status());
        program.is_ok_and(|status| status.is_ok_and(|status| status.success()))
    };
    let done = PRESETS.map(is_done);
    if done.contains(&false) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

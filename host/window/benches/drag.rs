//! How soon the picture follows the pointer while the boundary is dragged, in a real window on the simulated plate.
//!
//! `cargo bench -p slipline-window --bench drag` prints it; it needs a display, and opens a window for some seconds, or for as
//! many as a number after ` -- ` says: over an hour the memory that it prints must not grow.
//! A thread moves the pointer 125 times a second, as a mouse does. For each move it is measured how long it takes until
//! the first picture that knows of it has been handed to the graphics (software graphics have drawn it by then; a graphics
//! card may need some milliseconds more), and how much processor time the whole program takes, all its threads together.

use eframe::egui::{self, CursorIcon, Event, Pos2, pos2};
use slipline_link::native::Worker;
use slipline_window::app::{App, Parts, first_setup, run_in_event_loop};
use slipline_window::settings::Settings;
use std::cell::Cell;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Time between two moves of the pointer.
const MOVE: Duration = Duration::from_millis(8);
/// Time for the device to connect, and for the table to be made and sent.
const SETTLE: Duration = Duration::from_secs(6);
/// How long is dragged and measured, unless the command says otherwise.
const DRAG_S: u64 = 8;
/// How far the pointer goes to either side, in points, and how long it takes to be back.
const SWING: f32 = 120.0;
const PERIOD: Duration = Duration::from_secs(2);
/// The goals on software graphics and two cores: a longer delay than this is noticed.
const GOAL_MS: f64 = 40.0;
const GOAL_PICTURES: f64 = 25.0;
const GOAL_CORE_PERCENT: f64 = 100.0;

/// What the pointer does at present.
enum Stage {
    Settling(Instant),
    /// It looks for the boundary's handle, and is at this place.
    Seeking(Pos2),
    Dragging(Drag),
    Done,
}

struct Drag {
    grip: Pos2,
    is_pressed: bool,
    since: Instant,
    lasts: Duration,
    processor_s: f64,
    /// Memory in use when the drag began, in MB.
    memory_mb: f64,
    moves: Receiver<Instant>,
    /// The moves that the picture on its way knows of.
    on_the_way: Vec<Instant>,
    delays: Vec<Duration>,
    pictures: u32,
}

struct Bench {
    app: App,
    stage: Stage,
    /// When the last picture had been handed to the graphics.
    drawn: Rc<Cell<Instant>>,
    _worker: Worker,
}

impl eframe::App for Bench {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.app.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.app.show(ui);
        let Stage::Seeking(at) = &mut self.stage else { return };
        if ui.output(|output| output.cursor_icon) == CursorIcon::ResizeHorizontal {
            self.stage = Stage::Dragging(Drag::begin(*at, ui.ctx()));
        } else {
            at.x += 3.0;
            assert!(at.x < ui.ctx().content_rect().right(), "the boundary's handle was not found");
            ui.ctx().request_repaint();
        }
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        match &mut self.stage {
            Stage::Settling(since) if since.elapsed() < SETTLE => {
                ctx.request_repaint_after(Duration::from_millis(50));
            }
            Stage::Settling(_) => {
                let area = ctx.content_rect();
                self.stage = Stage::Seeking(area.left_top() + 0.32 * area.height() * egui::Vec2::Y);
                ctx.request_repaint();
            }
            Stage::Seeking(at) => input.events.push(Event::PointerMoved(*at)),
            Stage::Dragging(drag) => {
                drag.advance(input, self.drawn.get());
                if drag.since.elapsed() > drag.lasts {
                    drag.report();
                    self.stage = Stage::Done;
                    ctx.send_viewport_cmd(egui::ViewportCommand::Close);
                }
            }
            Stage::Done => {}
        }
    }
}

impl Drag {
    fn begin(grip: Pos2, ctx: &egui::Context) -> Self {
        let (sender, moves) = channel();
        let ctx = ctx.clone();
        std::thread::spawn(move || {
            // Until the window is closed.
            while sender.send(Instant::now()).is_ok() {
                ctx.request_repaint();
                std::thread::sleep(MOVE);
            }
        });
        let (since, processor_s) = (Instant::now(), processor_s());
        let (on_the_way, delays) = (Vec::new(), Vec::new());
        let asked_s = std::env::args().find_map(|argument| argument.parse().ok());
        let lasts = Duration::from_secs(asked_s.unwrap_or(DRAG_S));
        let (memory_mb, pictures) = (memory_mb(), 0);
        Self {
            grip,
            is_pressed: false,
            since,
            lasts,
            processor_s,
            memory_mb,
            moves,
            on_the_way,
            delays,
            pictures,
        }
    }

    /// The picture before was finished when it was `drawn`; the next one knows of all moves up to now.
    fn advance(&mut self, input: &mut egui::RawInput, drawn: Instant) {
        self.pictures += u32::from(!self.on_the_way.is_empty());
        self.delays.extend(self.on_the_way.drain(..).map(|moved| drawn.duration_since(moved)));
        self.on_the_way.extend(self.moves.try_iter());
        let Some(latest) = self.on_the_way.last() else { return };
        if !self.is_pressed {
            self.is_pressed = true;
            let (pos, button) = (self.grip, egui::PointerButton::Primary);
            input.events.push(Event::PointerButton {
                pos,
                button,
                pressed: true,
                modifiers: egui::Modifiers::NONE,
            });
        }
        let turns = latest.duration_since(self.since).as_secs_f32() / PERIOD.as_secs_f32();
        let away = SWING * (std::f32::consts::TAU * turns).sin();
        input.events.push(Event::PointerMoved(pos2(self.grip.x + away, self.grip.y)));
    }

    fn report(&mut self) {
        let took_s = self.since.elapsed().as_secs_f64();
        let core = 100.0 * (processor_s() - self.processor_s) / took_s;
        self.delays.sort();
        let at = |share: f64| {
            let delay = self.delays.get(((self.delays.len() as f64 - 1.0) * share) as usize);
            delay.map_or(f64::NAN, |delay| delay.as_secs_f64() * 1e3)
        };
        println!("pointer to picture, median    {:6.1} ms   goal {GOAL_MS} ms", at(0.5));
        println!("pointer to picture, 95 %      {:6.1} ms", at(0.95));
        let pictures = f64::from(self.pictures) / took_s;
        println!("pictures a second             {pictures:6.1}      goal {GOAL_PICTURES}");
        println!("processor, of one core        {core:6.0} %    goal {GOAL_CORE_PERCENT} %");
        println!("memory, before and after      {:6.0} MB and {:.0} MB", self.memory_mb, memory_mb());
    }
}

/// Memory of this program that is in use, in MB; not known on every system.
fn memory_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes / 1024.0)
}

/// Processor time that all threads of this program have taken, in seconds; not known on every system.
fn processor_s() -> f64 {
    // The 14th and 15th value, in ticks; the name before them may hold spaces, but ends with a bracket.
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = text.rsplit(')').next().map(|rest| {
        rest.split_whitespace().skip(11).take(2).filter_map(|value| value.parse::<f64>().ok()).sum::<f64>()
    });
    ticks.filter(|&ticks| ticks > 0.0).map_or(f64::NAN, |ticks| ticks / 100.0)
}

fn main() -> eframe::Result {
    // As `cargo test --benches` calls it: there may be no display.
    if !std::env::args().any(|argument| argument == "--bench") {
        return Ok(());
    }
    let viewport = egui::ViewportBuilder::default().with_inner_size([1280.0, 800.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let drawn = Rc::new(Cell::new(Instant::now()));
    let at = Rc::clone(&drawn);
    let open = |context: &eframe::CreationContext<'_>| {
        let ctx = &context.egui_ctx;
        let waker = ctx.clone();
        let worker = Worker::spawn(move || waker.request_repaint())?;
        let handle = worker.handle();
        let parts = Parts::threaded(ctx, Box::new(handle.clone()))?;
        let setup = first_setup().ok_or_else(|| anyhow::anyhow!("the first preset is damaged"))?;
        let app = App::new(ctx, parts, setup, Settings::default());
        let bench = Bench { app, stage: Stage::Settling(Instant::now()), drawn, _worker: worker };
        Ok((Box::new(bench) as Box<dyn eframe::App>, handle))
    };
    run_in_event_loop("Slipline drag", options, open, move || at.set(Instant::now()))
}

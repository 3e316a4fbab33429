//! How soon the picture follows the pointer while the boundary is dragged, in a real window on the simulated plate.
//!
//! `cargo bench --profile dev --bench drag` prints it; it needs a display, and opens a window for some seconds, or for as
//! many as a number after ` -- ` says: over an hour the memory that it prints must not grow.
//! A thread moves the pointer 125 times a second, as a mouse does. For each move it is measured how long it takes until
//! the first picture that knows of it has been handed to the graphics (software graphics have drawn it by then; a graphics
//! card may need some milliseconds more), and how much processor time the whole program takes, all its threads together; how
//! long a picture itself takes, in the program and in the graphics; and how late the latest of the link's keep-alives and of
//! the window's signs of life was.

use eframe::egui::{self, CursorIcon, Event, Pos2, pos2};
use slipline_link::native::{Handle, Worker};
use slipline_link::protocol::Command;
use slipline_link::protocol::limits::KEEP_ALIVE_PERIOD_MS;
use slipline_link::{SIGN_PERIOD, TracedMessage};
use slipline_window::app::{App, Parts, first_setup, run_in_event_loop};
use slipline_window::settings::Settings;
use slipline_window::view::theme;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
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
const GOAL_LATE_MS: f64 = 200.0;

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
    processor_s: BTreeMap<String, f64>,
    /// Memory in use when the drag began, in MB.
    memory_mb: f64,
    moves: Receiver<Instant>,
    /// The moves that the picture on its way knows of.
    on_the_way: Vec<Instant>,
    delays: Vec<Duration>,
    pictures: u32,
    /// How long the program worked on each picture, and then the graphics.
    own: Vec<[Duration; 2]>,
    late: Arc<Mutex<Late>>,
}

/// How late the latest of the link's keep-alives and of the window's signs of life came.
#[derive(Default)]
struct Late {
    beat: Option<Duration>,
    sign: Option<Duration>,
    keep_alive_late: Duration,
    sign_late: Duration,
}

impl Late {
    /// Looks at what the link has sent since the last call, and at the latest sign.
    fn look(&mut self, link: &Handle) {
        let period = Duration::from_millis(KEEP_ALIVE_PERIOD_MS.into());
        let snapshot = link.snapshot();
        for frame in snapshot.record.frames.iter() {
            let is_beat = matches!(frame.message, TracedMessage::Command(Command::KeepAlive(_)));
            if is_beat && self.beat.is_none_or(|beat| frame.time > beat) {
                let since = self.beat.replace(frame.time).map_or(period, |beat| frame.time - beat);
                self.keep_alive_late = self.keep_alive_late.max(since.saturating_sub(period));
            }
        }
        let sign = link.latest_sign();
        let since = self.sign.replace(sign).map_or(SIGN_PERIOD, |before| sign.saturating_sub(before));
        self.sign_late = self.sign_late.max(since.saturating_sub(SIGN_PERIOD));
    }
}

struct Bench {
    app: App,
    link: Handle,
    /// When the program began with the present picture, and when the graphics began.
    began: [Instant; 2],
    stage: Stage,
    /// When the last picture had been handed to the graphics.
    drawn: Rc<Cell<Instant>>,
    _worker: Worker,
}

impl eframe::App for Bench {
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::ground(visuals)
    }

    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.began[0] = Instant::now();
        self.app.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.app.show(ui);
        self.began[1] = Instant::now();
        let Stage::Seeking(at) = &mut self.stage else { return };
        if ui.output(|output| output.cursor_icon) == CursorIcon::ResizeHorizontal {
            self.stage = Stage::Dragging(Drag::begin(*at, ui.ctx(), self.link.clone()));
        } else {
            // Half the handle's width.
            at.x += 12.0;
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
                let [began, shown] = self.began;
                drag.own.push([shown - began, self.drawn.get().saturating_duration_since(shown)]);
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
    fn begin(grip: Pos2, ctx: &egui::Context, link: Handle) -> Self {
        let (sender, moves) = channel();
        let ctx = ctx.clone();
        let late: Arc<Mutex<Late>> = Arc::default();
        let looked = Arc::clone(&late);
        std::thread::spawn(move || {
            // Until the window is closed.
            while sender.send(Instant::now()).is_ok() {
                ctx.request_repaint();
                looked.lock().unwrap_or_else(PoisonError::into_inner).look(&link);
                std::thread::sleep(MOVE);
            }
        });
        println!("the boundary of the first scene is dragged");
        let (since, processor_s) = (Instant::now(), processor_s());
        let (on_the_way, delays, own) = (Vec::new(), Vec::new(), Vec::new());
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
            own,
            late,
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
        let now_s = processor_s();
        let core = |name: &str| {
            let at = |times: &BTreeMap<String, f64>| times.get(name).copied().unwrap_or(0.0);
            100.0 * (at(&now_s) - at(&self.processor_s)) / took_s
        };
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let at = |times: &mut dyn Iterator<Item = Duration>, share: f64| {
            let mut sorted: Vec<Duration> = times.collect();
            sorted.sort();
            sorted.get(((sorted.len() as f64 - 1.0) * share) as usize).map_or(f64::NAN, |&time| ms(time))
        };
        let delay = |share| at(&mut self.delays.iter().copied(), share);
        println!("pointer to picture, median    {:6.1} ms   goal {GOAL_MS} ms", delay(0.5));
        println!("pointer to picture, 95 %      {:6.1} ms", delay(0.95));
        let pictures = f64::from(self.pictures) / took_s;
        println!("pictures a second             {pictures:6.1}      goal {GOAL_PICTURES}");
        let own = |part: usize| at(&mut self.own.iter().map(|own| own[part]), 0.5);
        println!(
            "a picture itself, median      {:6.1} ms in the program, {:.1} ms in the graphics",
            own(0),
            own(1)
        );
        let whole: f64 = now_s.keys().map(|name| core(name)).sum();
        println!("processor, of one core        {whole:6.0} %    goal {GOAL_CORE_PERCENT} %");
        for name in now_s.keys().filter(|name| core(name) >= 1.0) {
            println!("  {name:28}{:6.0} %", core(name));
        }
        let late = self.late.lock().unwrap_or_else(PoisonError::into_inner);
        println!(
            "latest keep-alive, late by    {:6.1} ms   goal {GOAL_LATE_MS} ms; latest sign of life {:.1} ms",
            ms(late.keep_alive_late),
            ms(late.sign_late)
        );
        // Without what was measured meanwhile.
        let measured = size_of_val(self.delays.as_slice()) + size_of_val(self.own.as_slice());
        let after_mb = memory_mb() - measured as f64 / f64::from(1 << 20);
        println!("memory, before and after      {:6.0} MB and {after_mb:.0} MB", self.memory_mb);
    }
}

/// Memory of this program that is in use, in MB; not known on every system.
fn memory_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes / 1024.0)
}

/// Processor time that the threads of this program have taken, by their names, in seconds; not known on every system.
fn processor_s() -> BTreeMap<String, f64> {
    let mut times = BTreeMap::new();
    for thread in std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten() {
        let text = std::fs::read_to_string(thread.path().join("stat")).unwrap_or_default();
        // The name may hold spaces, but ends with a bracket; the 14th and 15th value are in ticks.
        let Some((start, rest)) = text.rsplit_once(')') else { continue };
        let ticks = rest.split_whitespace().skip(11).take(2).filter_map(|value| value.parse::<f64>().ok());
        let name = start.split_once('(').map_or("", |(_, name)| name);
        *times.entry(name.to_owned()).or_default() += ticks.sum::<f64>() / 100.0;
    }
    times
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
        let (link, began) = (handle.clone(), [Instant::now(); 2]);
        let press_ages = app.press_ages();
        let bench = Bench { app, link, began, stage: Stage::Settling(began[0]), drawn, _worker: worker };
        Ok((Box::new(bench) as Box<dyn eframe::App>, handle, press_ages))
    };
    run_in_event_loop("Slipline drag", options, open, move || at.set(Instant::now()))
}

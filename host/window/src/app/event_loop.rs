//! The window's event loop: eframe's app runs in it, and beside it the link's questions are answered.
//!
//! ```text
//! link worker --question--> event loop's queue --> answer: a sign of life --> link worker
//! ```
//! A question is an event of the loop's own queue, and answering it paints nothing. So it is answered at rest and while
//! the window is minimised, covered or being resized, when eframe may not call the app at all; and it is not answered
//! when the loop hangs, which is when neither STOP nor a key would have an effect.
//!
//! Without the display's refresh to wait for, [`Pace`] keeps a drag from drawing without a pause.

use super::eframe_log;
use super::no_display;
use super::pace::Pace;
use super::press_ages::PressAges;
use eframe::egui::ViewportId;
use eframe::{AppCreator, CreationContext, EframeWinitApplication, UserEvent};
use slipline_link::native::Handle;
use std::cell::OnceCell;
use std::rc::Rc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, ElementState, KeyEvent, MouseButton, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::platform::run_on_demand::EventLoopExtRunOnDemand as _;
use winit::window::WindowId;

/// Opens a window and runs its event loop until it is closed. `open` makes the app, and names its link; `drawn` is called
/// whenever a picture has been handed to the graphics.
///
/// # Errors
/// When there is no display, or the app cannot be made.
pub fn run<'app>(
    name: &str,
    mut options: eframe::NativeOptions,
    open: impl FnOnce(&CreationContext<'_>) -> anyhow::Result<(Box<dyn eframe::App>, Handle, PressAges)> + 'app,
    drawn: impl FnMut() + 'app,
) -> Result<(), eframe::Error> {
    // Waiting for the next refresh of the display would delay each drag's command to the device by up to 17 ms.
    options.glow_options.vsync = false;
    // Noise under the last bit of a colour is not seen, and software graphics compute it for every pixel.
    options.dithering = false;
    if let Some(lacking) = no_display::lacking() {
        return Err(eframe::Error::AppCreation(lacking.into()));
    }
    let mut event_loop = EventLoop::<UserEvent>::with_user_event().build()?;
    let questions = event_loop.create_proxy();
    let link = Rc::new(OnceCell::new());
    let opened = Rc::clone(&link);
    let creator: AppCreator<'app> = Box::new(move |context| {
        let (app, handle, press_ages) = open(context)?;
        handle.ask_for_signs(move || {
            // The loop is gone when the window was closed.
            let _ = questions.send_event(question());
        });
        let _ = opened.set((handle, press_ages));
        Ok(app)
    });
    keep_memory();
    eframe_log::listen();
    let app = eframe::create_native(name, options, creator, &event_loop);
    // Dropped before the loop, which owns the connection to the display.
    let mut answering =
        Answering { app, link, presses: Vec::new(), pace: Pace::default(), drawn: Box::new(drawn) };
    event_loop.run_app_on_demand(&mut answering)?;
    let ended_by = eframe_log::take_error();
    let never_opened = answering.link.get().is_none().then(|| "the window system gave no window".to_owned());
    ended_by.or(never_opened).map_or(Ok(()), |reason| Err(eframe::Error::AppCreation(reason.into())))
}

/// Size of a block that is taken and given back once, in bytes: twice of it is more than a picture needs.
const KEPT: usize = 8 << 20;

/// Has the allocator keep what one picture gives back for the next. That of glibc keeps up to twice the largest block that was
/// given back (its M_TRIM_THRESHOLD) and returns the rest to the system, which clears each page when it is taken again;
/// software graphics take some megabytes for each picture. Other allocators do nothing about it.
fn keep_memory() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(KEPT)));
}

/// The viewport that a question names. No window has it, so eframe would do nothing about it.
fn nowhere() -> ViewportId {
    ViewportId::from_hash_of("a question for a sign of life")
}

/// The link's question, in the only form that the event loop has for it.
fn question() -> UserEvent {
    UserEvent::RequestRepaint { viewport_id: nowhere(), when: Instant::now(), cumulative_pass_nr: 0 }
}

/// Gives a sign of life if an event of the loop is the link's question; returns whether it is.
fn answer(event: &UserEvent, sign: impl FnOnce()) -> bool {
    let is_question =
        matches!(event, UserEvent::RequestRepaint { viewport_id, .. } if *viewport_id == nowhere());
    if is_question {
        sign();
    }
    is_question
}

/// Whether it may press STOP: its keys, and the pointer, which presses a button when it is released.
#[expect(clippy::wildcard_enum_match_arm, reason = "no other event of the system presses STOP")]
fn is_stop_press(event: &WindowEvent) -> bool {
    match event {
        WindowEvent::KeyboardInput { event: KeyEvent { state, repeat, logical_key, .. }, .. } => {
            let is_key = matches!(logical_key, Key::Named(NamedKey::Escape | NamedKey::Space));
            is_key && *state == ElementState::Pressed && !repeat
        }
        WindowEvent::MouseInput { state: ElementState::Released, button: MouseButton::Left, .. } => true,
        _ => false,
    }
}

/// Answers the link's questions, and hands everything else to eframe: a request for a picture when it is due.
struct Answering<'app> {
    app: EframeWinitApplication<'app>,
    /// The link and the app's presses, once the window is open.
    link: Rc<OnceCell<(Handle, PressAges)>>,
    /// When the presses since the latest picture came.
    presses: Vec<Instant>,
    pace: Pace<WindowId>,
    drawn: Box<dyn FnMut() + 'app>,
}

impl Answering<'_> {
    fn draw(&mut self, event_loop: &ActiveEventLoop, window: WindowId) {
        let began = Instant::now();
        if let Some((_, press_ages)) = self.link.get() {
            let age_s = |pressed: Instant| began.saturating_duration_since(pressed).as_secs_f64();
            press_ages.begin_frame(self.presses.drain(..).map(age_s).collect());
        }
        self.app.window_event(event_loop, window, WindowEvent::RedrawRequested);
        self.pace.drawn(began, Instant::now());
        (self.drawn)();
    }
}

impl ApplicationHandler<UserEvent> for Answering<'_> {
    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: UserEvent) {
        let sign = || {
            if let Some((link, _)) = self.link.get() {
                link.sign_of_life();
            }
        };
        if !answer(&event, sign) {
            self.app.user_event(event_loop, event);
        }
    }

    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.app.resumed(event_loop);
    }

    #[expect(clippy::wildcard_enum_match_arm, reason = "eframe handles the system's other events")]
    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        if is_stop_press(&event) {
            self.presses.push(Instant::now());
        }
        match event {
            WindowEvent::RedrawRequested => {
                if self.pace.may_draw(window, Instant::now()) {
                    self.draw(event_loop, window);
                }
            }
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                // The system shows the window at its new size only when it is drawn.
                self.pace = Pace::default();
                self.app.window_event(event_loop, window, event);
            }
            _ => self.app.window_event(event_loop, window, event),
        }
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        self.app.new_events(event_loop, cause);
    }

    fn device_event(&mut self, event_loop: &ActiveEventLoop, device: DeviceId, event: DeviceEvent) {
        self.app.device_event(event_loop, device, event);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if let Some(window) = self.pace.due(Instant::now()) {
            self.draw(event_loop, window);
        }
        self.app.about_to_wait(event_loop);
        if let Some(due) = self.pace.waits_until() {
            let due = match event_loop.control_flow() {
                ControlFlow::WaitUntil(other) => other.min(due),
                // eframe polls for the picture that is held back here.
                ControlFlow::Poll | ControlFlow::Wait => due,
            };
            event_loop.set_control_flow(ControlFlow::WaitUntil(due));
        }
    }

    fn suspended(&mut self, event_loop: &ActiveEventLoop) {
        self.app.suspended(event_loop);
    }

    fn exiting(&mut self, event_loop: &ActiveEventLoop) {
        self.app.exiting(event_loop);
    }

    fn memory_warning(&mut self, event_loop: &ActiveEventLoop) {
        self.app.memory_warning(event_loop);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_is_answered_by_the_loop_and_a_repaint_is_eframes() {
        let signs = std::cell::Cell::new(0);
        let sign = || signs.set(signs.get() + 1);
        assert!(answer(&question(), sign));
        assert_eq!(signs.get(), 1);
        let when = Instant::now();
        let repaint =
            UserEvent::RequestRepaint { viewport_id: ViewportId::ROOT, when, cumulative_pass_nr: 0 };
        assert!(!answer(&repaint, sign));
        assert_eq!(signs.get(), 1);
    }
}

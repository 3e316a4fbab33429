//! The window sends what an instrument without one sends: the same script, the same requests, the same codes.

use crate::measure::open_measure;
use crate::script::{Hands, play};
use crate::session::Session;
use crate::test_app::TestApp;
use eframe::egui::accesskit::{Action, ActionData, ActionRequest, Role, TreeId};
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use slipline_link::Request;

/// A user at the window. Presses and keys are seen in frames of their own, before time goes on.
struct AtWindow(TestApp);

impl AtWindow {
    fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.0.window.key_press_modifiers(modifiers, key);
        self.0.window.run_steps(3);
    }
}

impl AtWindow {
    fn press(&mut self, role: Role, name: &str) {
        self.0.window.get_by_role_and_label(role, name).click();
        self.0.window.run_steps(3);
    }

    fn tab(&mut self, name: &str) {
        self.press(Role::Button, name);
    }

    /// Presses a button that may lie below what is seen of its page, after so much time.
    fn page(&mut self, name: &str, after_ms: u64) {
        self.0.window.get_by_role_and_label(Role::Button, name).scroll_to_me();
        self.0.wait(after_ms);
        self.press(Role::Button, name);
    }
}

impl Hands for AtWindow {
    fn pass(&mut self, ms: u64) {
        self.0.wait(ms);
    }

    fn move_line(&mut self, mm: u32) {
        // Another gesture, as a press of the pointer is.
        self.key(Modifiers::NONE, Key::F20);
        let slider = self.0.window.get_by_role_and_label(Role::Slider, "Boundary");
        let target_node = slider.accesskit_node().locate().0;
        self.0.window.event(Event::AccessKitActionRequest(ActionRequest {
            action: Action::SetValue,
            target_tree: TreeId::ROOT,
            target_node,
            data: Some(ActionData::NumericValue(f64::from(mm))),
        }));
        self.0.window.step();
    }

    fn undo(&mut self) {
        self.key(Modifiers::COMMAND, Key::Z);
    }

    fn redo(&mut self) {
        self.key(Modifiers::COMMAND, Key::Y);
    }

    fn drive(&mut self) {
        self.key(Modifiers::COMMAND, Key::Enter);
    }

    fn stop(&mut self) {
        self.key(Modifiers::NONE, Key::Space);
    }

    fn play_a_texture(&mut self) {
        self.tab("Texture");
        self.0.wait(300);
        self.press(Role::Button, "Play this");
        self.tab("Boundary");
    }

    fn hold(&mut self) {
        self.tab("Boundary");
        self.0.window.get_by_role_and_label(Role::CheckBox, "Hold the level").scroll_to_me();
        self.0.wait(400);
        self.press(Role::CheckBox, "Hold the level");
    }

    fn record(&mut self, records: bool) {
        self.tab("Play");
        self.press(Role::Button, if records { "Record" } else { "Stop the recording" });
    }

    fn replay(&mut self) {
        self.press(Role::Button, "Play the recording");
    }

    fn calibrate(&mut self) {
        self.page("Calibrate…", 900);
        for name in ["Next", "Next", "Measure now", "Next", "Measure now", "Next", "Use this plate"] {
            self.page(name, 600);
            if name == "Measure now" {
                self.0.wait(30_000);
            }
        }
    }

    fn measure_a_secret(&mut self) {
        // Time passes for the panels to open: as much as in the script.
        open_measure(&mut self.0);
        for label in ["Hidden test plate (its numbers differ)", "Measure now"] {
            self.0.window.get_by_label(label).click();
            self.0.window.run_steps(3);
        }
    }

    fn plug(&mut self, is_plugged: bool) {
        self.0.plug(is_plugged);
    }

    fn digest(&self) -> u64 {
        self.0.digest()
    }

    fn take_sent(&mut self) -> Vec<Request> {
        self.0.take_sent()
    }
}

#[test]
fn the_window_sends_what_an_instrument_without_one_sends() {
    let mut without = Session::new();
    let wanted = play(&mut without);
    let bench = Bench::default();
    let mut with = AtWindow(TestApp::sensed_from_the_start(bench.inputs(), bench));
    let sent = play(&mut with);
    for (number, (sent, wanted)) in sent.iter().zip(&wanted).enumerate() {
        assert_eq!(sent, wanted, "{number}");
    }
    assert_eq!(sent.len(), wanted.len());
}

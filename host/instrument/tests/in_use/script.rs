//! A user's script for a window and for an instrument without one: both must send the same requests and
//! codes.

use super::session::Session;
use slipline_instrument::calibration::WizardPage;
use slipline_instrument::{CalibrateIntent, MeasureIntent};
use slipline_link::Request;

/// Actions of a user.
pub(crate) trait Hands {
    /// Waits, in milliseconds.
    fn pass(&mut self, ms: u64);
    /// Moves the line of the first tone to this place, in millimetres.
    fn move_line(&mut self, mm: u32);
    /// Undoes the latest change.
    fn undo(&mut self);
    /// Redoes it.
    fn redo(&mut self);
    /// Presses Drive.
    fn drive(&mut self);
    /// Presses STOP.
    fn stop(&mut self);
    /// Opens the page of textures (300 ms), plays the shown texture, and closes the page.
    fn play_a_texture(&mut self);
    /// Switches the level hold on (400 ms to find the switch).
    fn hold(&mut self);
    /// Starts or ends a recording of the lines.
    fn record(&mut self, records: bool);
    /// Replays the recording.
    fn replay(&mut self);
    /// Opens the calibration (900 ms) and measures at both its places (600 ms a page, 30 s a measurement).
    /// Uses the plate of its result (600 ms).
    fn calibrate(&mut self);
    /// Opens the page of measurements (300 ms), has the simulated device use an unknown plate, and starts to
    /// measure it.
    fn measure_a_secret(&mut self);
    /// Plugs the cable in, or pulls it.
    fn plug(&mut self, is_plugged: bool);
    /// A digest of all codes that the device has sent.
    fn digest(&self) -> u64;
    /// The requests since the last call.
    fn take_sent(&mut self) -> Vec<Request>;
}

/// Carries out the script; returns the requests in words, and the digest of all codes after each wait.
pub(crate) fn play(hands: &mut impl Hands) -> Vec<String> {
    let mut seen = Vec::new();
    let mut pass = |hands: &mut _, ms| pass(hands, ms, &mut seen);
    pass(hands, 2000);
    for mm in [150, 175, 200] {
        hands.move_line(mm);
        pass(hands, 100);
    }
    hands.undo();
    pass(hands, 300);
    hands.redo();
    pass(hands, 300);
    hands.play_a_texture();
    pass(hands, 500);
    hands.undo();
    pass(hands, 300);
    hands.stop();
    pass(hands, 1500);
    hands.drive();
    pass(hands, 500);
    hands.measure_a_secret();
    pass(hands, 20_000);
    hands.calibrate();
    pass(hands, 1500);
    hands.drive();
    pass(hands, 500);
    hands.hold();
    pass(hands, 3000);
    hands.stop();
    pass(hands, 500);
    hands.drive();
    pass(hands, 500);
    hands.plug(false);
    pass(hands, 1000);
    hands.plug(true);
    pass(hands, 3000);
    hands.drive();
    pass(hands, 1500);
    hands.record(true);
    for mm in [160, 170, 180] {
        hands.move_line(mm);
        pass(hands, 100);
    }
    hands.record(false);
    hands.replay();
    hands.pass(1000);
    // The recording includes the duration of a window's frames: the same moves, at other samples.
    seen.extend(in_words(hands));
    seen
}

/// The requests since the last call.
fn in_words(hands: &mut impl Hands) -> Vec<String> {
    hands.take_sent().iter().map(|request| format!("{request:?}")).collect()
}

fn pass(hands: &mut impl Hands, ms: u64, seen: &mut Vec<String>) {
    hands.pass(ms);
    seen.extend(in_words(hands));
    seen.push(format!("codes {:016x}", hands.digest()));
}

/// After each action the instrument is turned before time advances, as in the frames in which a window
/// handles the action.
impl Hands for Session {
    fn pass(&mut self, ms: u64) {
        Self::pass(self, ms);
    }

    fn move_line(&mut self, mm: u32) {
        self.instrument.desk.begin_gestures(1);
        self.instrument.drag_line(0, &[f64::from(mm) * 1e-3]);
        self.turn();
    }

    fn undo(&mut self) {
        self.instrument.undo();
        self.turn();
    }

    fn redo(&mut self) {
        self.instrument.redo();
        self.turn();
    }

    fn drive(&mut self) {
        self.instrument.start();
        self.turn();
    }

    fn stop(&mut self) {
        self.instrument.press_stop();
        self.turn();
    }

    fn play_a_texture(&mut self) {
        self.attention.is_texture_open = true;
        self.pass(300);
        self.instrument.play_texture();
        self.turn();
        self.attention.is_texture_open = false;
    }

    fn hold(&mut self) {
        self.pass(400);
        self.instrument.switch_hold(true);
        self.turn();
    }

    fn record(&mut self, records: bool) {
        self.instrument.record(records);
        self.turn();
    }

    fn replay(&mut self) {
        self.instrument.desk.play(true);
        self.turn();
    }

    fn calibrate(&mut self) {
        self.pass(900);
        self.instrument.perform_calibrate(CalibrateIntent::Open);
        self.turn();
        for page in
            [WizardPage::FirstPlace, WizardPage::FirstAnswer, WizardPage::SecondPlace, WizardPage::Result]
        {
            self.pass(600);
            self.instrument.perform_calibrate(CalibrateIntent::Page(page));
            self.turn();
            if let Some(sensor) = page.sensor() {
                self.pass(600);
                self.instrument.perform_measure(MeasureIntent::Begin(Some(sensor)));
                self.turn();
                self.pass(30_000);
            }
        }
        self.pass(600);
        self.instrument.perform_calibrate(CalibrateIntent::Use);
        self.turn();
    }

    fn measure_a_secret(&mut self) {
        // The window opens its page first.
        self.pass(300);
        self.instrument.perform_measure(MeasureIntent::Secret(true));
        self.instrument.perform_measure(MeasureIntent::Begin(None));
        self.turn();
    }

    fn plug(&mut self, is_plugged: bool) {
        self.worker.borrow().plug(is_plugged);
    }

    fn digest(&self) -> u64 {
        self.worker.borrow().digest()
    }

    fn take_sent(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.worker.borrow_mut().sent)
    }
}

//! A user's script that a window and an instrument without one carry out alike: the same requests, the same codes.

use super::session::Session;
use slipline_instrument::MeasureIntent;
use slipline_link::Request;

/// What a user does.
pub(crate) trait Hands {
    /// Waits, in milliseconds.
    fn pass(&mut self, ms: u64);
    /// Moves the line of the first tone to this place, in millimetres.
    fn move_line(&mut self, mm: u32);
    /// Takes the latest change back.
    fn undo(&mut self);
    /// Makes it again.
    fn redo(&mut self);
    /// Presses Drive.
    fn drive(&mut self);
    /// Presses STOP.
    fn stop(&mut self);
    /// Opens the page of measurements, which takes 300 ms, has the simulated device stand on a plate that nobody knows, and
    /// begins to measure it.
    fn measure_a_secret(&mut self);
    /// Puts the cable in, or pulls it.
    fn plug(&mut self, is_plugged: bool);
    /// What was sent since the last call.
    fn take_sent(&mut self) -> Vec<Request>;
}

/// Carries the script out; what was sent, in words.
pub(crate) fn play(hands: &mut impl Hands) -> Vec<String> {
    hands.pass(2000);
    for mm in [150, 175, 200] {
        hands.move_line(mm);
        hands.pass(100);
    }
    hands.undo();
    hands.pass(300);
    hands.redo();
    hands.pass(300);
    hands.stop();
    hands.pass(1500);
    hands.drive();
    hands.pass(500);
    hands.measure_a_secret();
    hands.pass(9000);
    hands.drive();
    hands.pass(500);
    hands.plug(false);
    hands.pass(1000);
    hands.plug(true);
    hands.pass(3000);
    hands.drive();
    hands.pass(1500);
    hands.take_sent().iter().map(in_words).collect()
}

/// A request in words; of a table its check sum.
fn in_words(request: &Request) -> String {
    match request {
        Request::Upload(table) => format!("Upload({:08x})", table.crc()),
        request => format!("{request:?}"),
    }
}

/// After each act the instrument is turned, as it is in the frames in which a window sees the act, before time goes on.
impl Hands for Session {
    fn pass(&mut self, ms: u64) {
        Self::pass(self, ms);
    }

    fn move_line(&mut self, mm: u32) {
        self.instrument.begin_gestures(1);
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

    fn take_sent(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.worker.borrow_mut().sent)
    }
}

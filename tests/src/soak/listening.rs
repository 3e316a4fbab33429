//! Measurements during a soak, compared with the response of the wire.

use std::f64::consts::TAU;

use slipline_app::Timing;
use slipline_protocol::command::Command;
use slipline_protocol::limits::{MAX_CAPTURE_LOG2, MAX_CAPTURE_VALUES};
use slipline_protocol::listen::{
    CapturePart, CaptureWindow, Captured, InputsReport, ListenPart, ListenWindow, Listened, Progress,
    WindowShape,
};
use slipline_protocol::units::SampleIndex;

use super::Soak;
use crate::answer;
use crate::client::Client;
use crate::rig::BLOCK;
use crate::wire::Wire;

/// The longest window, in blocks.
const LONGEST_WINDOW: u32 = 2000;
/// Blocks between the one that is rendered and the one whose codes the inputs have sampled, at most.
const BEHIND: u64 = 4;
/// Periods of the tone in a window from which its phase is checked.
const PERIODS: f64 = 20.0;
/// Tolerance of the phase in degrees: leakage of the tone's own image at minus its frequency.
const DEGREES: f64 = 3.0;

/// The measurements under way, and the expected results.
#[derive(Debug, Default)]
pub(super) struct Listening {
    wire: Wire,
    window: Option<Window>,
    capture: Option<Capture>,
    sounding: Option<Sounding>,
}

/// A tone alone that does not change: its phase step, from a sample on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sounding {
    pub(super) from: SampleIndex,
    pub(super) step: u32,
}

#[derive(Debug)]
struct Window {
    begin: SampleIndex,
    blocks: u16,
    has_both: bool,
    /// The lowest and the highest code.
    span: Option<(u16, u16)>,
    /// The phase step of the only tone, which sounds all the time.
    step: Option<u32>,
}

#[derive(Debug)]
struct Capture {
    begin: SampleIndex,
    log2_codes: u8,
    values: Vec<u32>,
    count: u16,
}

impl Window {
    fn end(&self) -> SampleIndex {
        self.begin + u64::from(self.blocks) * BLOCK
    }

    fn periods(&self, step: u32) -> f64 {
        f64::from(self.blocks) * BLOCK as f64 * f64::from(step) / 4_294_967_296.0
    }
}

impl Capture {
    fn end(&self) -> SampleIndex {
        self.begin + (u64::from(self.count) << self.log2_codes)
    }
}

impl Listening {
    /// Notes that something is ordered which changes what sounds.
    pub(super) fn acted(&mut self) {
        self.sounding = None;
        if let Some(window) = &mut self.window {
            window.step = None;
        }
    }

    /// Notes that one tone sounds, and nothing else.
    pub(super) fn sounds(&mut self, alone: Sounding) {
        self.sounding = Some(alone);
    }

    /// A new session drops what is measured.
    pub(super) fn dropped(&mut self) {
        (self.window, self.capture) = (None, None);
    }

    /// Takes codes that were sent, in order.
    pub(super) fn pass(&mut self, first: SampleIndex, codes: &[u16]) {
        for (index, code) in (first..).zip(codes) {
            let heard = self.wire.carry(*code);
            if let Some(window) = &mut self.window
                && (window.begin..window.end()).contains(&index)
            {
                let (lowest, highest) = window.span.unwrap_or((heard, heard));
                window.span = Some((lowest.min(heard), highest.max(heard)));
            }
            if let Some(capture) = &mut self.capture
                && (capture.begin..capture.end()).contains(&index)
            {
                let value = ((index - capture.begin) >> capture.log2_codes) as usize;
                if capture.values.len() == value {
                    capture.values.push(0);
                }
                capture.values[value] += u32::from(heard);
            }
        }
    }
}

impl Soak {
    /// Orders a measurement, a capture or both, in the place of those under way: mostly such that they end within the pause
    /// that comes.
    pub(super) fn measure(&mut self, pause_ms: u32) {
        let pause = u32::try_from(self.rig.samples(pause_ms)).unwrap_or(u32::MAX);
        if self.random.below(2) == 0 {
            let blocks = 1 + self.random.below((pause / BLOCK as u32).max(1)).min(LONGEST_WINDOW) as u16;
            let shape = [WindowShape::Rectangular, WindowShape::Hann][self.random.below(2) as usize];
            // Both inputs, with half of the slots, or one with all.
            let (input, slots) = [(None, 0xFF), (Some(0), u16::MAX)][usize::from(blocks % 2)];
            let window = ListenWindow { from: self.ahead(pause), blocks, shape, slots, input };
            let begin = self.accepted(&Command::Listen(window));
            let mut window = Window { begin, blocks, has_both: input.is_none(), span: None, step: None };
            window.step = self
                .listening
                .sounding
                .filter(|alone| begin >= alone.from + BLOCK && window.periods(alone.step) >= PERIODS)
                .map(|alone| alone.step);
            self.listening.window = Some(window);
        }
        if self.random.below(2) == 0 {
            let longest = (pause >> 1).checked_ilog2().unwrap_or(0).min(u32::from(MAX_CAPTURE_LOG2));
            let log2_codes = self.random.below(longest + 1) as u8;
            let most = (pause >> log2_codes).clamp(1, u32::from(MAX_CAPTURE_VALUES));
            let values = 1 + self.random.below(most) as u16;
            let window = CaptureWindow { from: self.ahead(pause / 2), input: 0, log2_codes, values };
            let begin = self.accepted(&Command::Capture(window));
            self.listening.capture =
                Some(Capture { begin, log2_codes, values: Vec::with_capacity(values.into()), count: values });
        }
    }

    /// At once, or a random sample of the pause, as far ahead as is allowed.
    fn ahead(&mut self, pause: u32) -> Option<SampleIndex> {
        let Self { random, rig, .. } = self;
        let farthest = Timing::at(rig.device.sample_rate_hz()).max_apply_ahead;
        (random.below(4) != 0).then(|| rig.device.now() + u64::from(random.below(pause)).min(farthest))
    }

    /// Reads what is complete, and compares it.
    pub(super) fn read_what_was_measured(&mut self) {
        let heard = self.rig.device.now().saturating_sub(BEHIND * BLOCK);
        if let Some(window) = self.listening.window.take_if(|window| window.end() <= heard) {
            self.check_window(&window);
            self.tally.measured += 1;
        }
        if let Some(capture) = self.listening.capture.take_if(|capture| capture.end() <= heard) {
            self.check_capture(&capture);
            self.tally.measured += 1;
        }
    }

    fn check_window(&mut self, window: &Window) {
        let reading = self.listened(0);
        assert_eq!(
            (reading.progress, reading.begin, reading.blocks),
            (Progress::Finished, window.begin, window.blocks)
        );
        assert_eq!(Some((reading.lowest, reading.highest)), window.span, "from {} on", window.begin);
        let stuck = self.listened(1);
        let code = if window.has_both { Wire::STUCK } else { 0 };
        assert_eq!((stuck.lowest, stuck.highest), (code, code));
        assert_eq!(self.inputs().lost_blocks, 0);
        let Some(step) = window.step else { return };
        let answer = reading.answers.first().expect("a finished window has answers");
        assert_eq!(reading.followed, 1, "one tone sounds: {window:?}");
        let lag = f64::from(step) / 4_294_967_296.0 * Wire::LAG as f64;
        let found = (answer.quadrature as f64).atan2(answer.in_phase as f64) / TAU;
        let off = (found + lag - (found + lag).round()) * 360.0;
        assert!(off.abs() < DEGREES, "{off} degrees off: {window:?}");
        self.tally.phases += 1;
    }

    fn check_capture(&mut self, capture: &Capture) {
        let mut read = Vec::new();
        while read.len() < usize::from(capture.count) {
            let part = self.captured(read.len() as u16);
            assert_eq!(
                (part.progress, part.from, part.captured),
                (Progress::Finished, capture.begin, capture.count)
            );
            assert!(!part.values.is_empty(), "{capture:?}");
            read.extend_from_slice(&part.values);
        }
        assert!(read == capture.values, "a capture of {} values from {} on", capture.count, capture.begin);
    }

    fn listened(&mut self, input: u8) -> Listened {
        answer!(self, Command::ListenRead(ListenPart { input, first_slot: 0 }), Listened)
    }

    fn captured(&mut self, first: u16) -> Captured {
        answer!(self, Command::CaptureRead(CapturePart { first }), Captured)
    }

    fn inputs(&mut self) -> InputsReport {
        answer!(self, Command::Inputs, Inputs)
    }
}

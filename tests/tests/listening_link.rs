//! The link measures the inputs: combs, windows and captures as requests, with answers that are known.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use slipline_link::simulator::loopback::Loopback;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_link::{
    CaptureRequest, Captured, CombRequest, DeviceTable, HarmonicRequest, ListenRequest, Listened, Outcome,
    Refusal, Request, Sounding, WindowShape,
};
use slipline_tests::rig::RATE_HZ;

/// A resonance: `y[n] = x[n] + 2 r cos(w) y[n-1] - r^2 y[n-2]`, scaled; its response is known in closed form. The second
/// input is the DAC's pin.
struct Resonance(Arc<Mutex<[f64; 2]>>);

const R: f64 = 0.98;
const RESONANCE: f64 = 0.1;
const SCALE: f64 = 0.02;

impl SimulatedInputs for Resonance {
    fn inputs(&self) -> usize {
        2
    }

    fn sample(&mut self, codes: &[u16; 128], muted: bool, sensed: &mut [[u16; 128]; 2]) {
        let mut state = self.0.lock().unwrap();
        for (n, code) in codes.iter().enumerate() {
            let force = if muted { 0.0 } else { f64::from(*code) - 2048.0 };
            let y = force + 2.0 * R * (TAU * RESONANCE).cos() * state[0] - R * R * state[1];
            *state = [y, state[0]];
            sensed[0][n] = (2048.0 + SCALE * y).round() as u16;
            sensed[1][n] = *code;
        }
    }
}

/// The response at a frequency in turns per sample.
fn response(turns: f64) -> (f64, f64) {
    let (s, c) = (TAU * turns).sin_cos();
    let (s2, c2) = (2.0 * TAU * turns).sin_cos();
    // 1 - 2 r cos(w0) exp(-iw) + r^2 exp(-2iw)
    let a = 2.0 * R * (TAU * RESONANCE).cos();
    let (re, im) = (1.0 - a * c + R * R * c2, a * s - R * R * s2);
    let square = re * re + im * im;
    (SCALE * re / square, -SCALE * im / square)
}

fn connected() -> Loopback {
    let options = Options { sample_rate_hz: RATE_HZ, ..Options::default() };
    let device = SimulatedDevice::with_inputs(options, Box::new(Resonance(Arc::default())));
    let mut loopback = Loopback::connect_to(device).unwrap();
    let knots = (0..=64).map(|i| (60e3 - 625.0 * f64::from(i), 1.0));
    let table = DeviceTable::from_knots((0.08, 0.27), f64::from(RATE_HZ), knots, 1e-6).unwrap();
    loopback.perform(Request::Upload(Arc::new(table)), |_| ()).unwrap();
    loopback
}

/// Performs a request and returns how it ended.
fn outcome(loopback: &mut Loopback, request: Request) -> Outcome {
    loopback.perform(request, |_| ()).unwrap();
    loopback.view().record.outcomes.back().unwrap().1.clone()
}

fn listened(loopback: &mut Loopback, request: ListenRequest) -> Arc<Listened> {
    match outcome(loopback, Request::Listen(request)) {
        Outcome::Listened(listened) => listened,
        other => panic!("{other:?}"),
    }
}

fn captured(loopback: &mut Loopback, request: CaptureRequest) -> Arc<Captured> {
    match outcome(loopback, Request::Capture(request)) {
        Outcome::Captured(captured) => captured,
        other => panic!("{other:?}"),
    }
}

/// Sixteen tones over 40 blocks, from 234 Hz to 179 kHz, across the resonance at 40 kHz.
fn comb() -> CombRequest {
    let tones = (0..16u16).map(|i| HarmonicRequest {
        harmonic: 3 + 150 * i + i % 3,
        level: 0.05,
        phase_turns: f64::from(i) * 0.37,
    });
    CombRequest::of(40, tones.collect())
}

const WINDOW: ListenRequest =
    ListenRequest { from: None, blocks: 80, shape: WindowShape::Rectangular, slots: u16::MAX, input: 0 };

#[test]
fn a_comb_and_a_window_give_the_response_that_is_known() {
    let mut loopback = connected();
    let inputs = loopback.view().device.inputs.expect("a device of 1.3 reports them");
    assert_eq!((inputs.inputs, inputs.lock_ins, inputs.lost_blocks), (2, 16, 0));
    assert!(loopback.view().can_listen());
    let at = loopback.perform(Request::Play(Sounding::Comb(comb())), |_| ()).unwrap();
    let from = Some(at + 20_001);
    let sensor = listened(&mut loopback, ListenRequest { from, ..WINDOW });
    assert_eq!((sensor.begin, sensor.blocks), ((at + 20_001).next_multiple_of(128), 80));
    assert!(loopback.samples() < sensor.begin + 90 * 128, "it is read as soon as the window is over");
    let pin = listened(&mut loopback, ListenRequest { input: 1, ..WINDOW });
    for ((tone, sensor), pin) in comb().tones.iter().zip(sensor.answers).zip(pin.answers) {
        let (sensor, pin) = (sensor.unwrap(), pin.unwrap());
        assert!((pin.0 - 2047.0 * 0.05).hypot(pin.1) < 0.03, "the pin: {pin:?}");
        let (re, im) = response(f64::from(tone.harmonic) / 5120.0);
        let off = (sensor.0 - 2047.0 * 0.05 * re).hypot(sensor.1 - 2047.0 * 0.05 * im);
        assert!(off < 0.03, "multiple {}: {sensor:?}, {off} codes off", tone.harmonic);
    }
    assert!(0 < sensor.lowest && sensor.lowest < 2030 && 2066 < sensor.highest && sensor.highest < 4095);
    // Some slots only, one of them silent: one read is enough for the lower eight.
    let some = listened(&mut loopback, ListenRequest { slots: 0b101, shape: WindowShape::Hann, ..WINDOW });
    let followed: Vec<usize> = (0..16).filter(|slot| some.answers[*slot].is_some()).collect();
    assert_eq!(followed, [0, 2]);
}

#[test]
fn a_capture_comes_whole_and_in_order() {
    let mut loopback = connected();
    let mut sent: Vec<u16> = Vec::new();
    let before = loopback.samples();
    loopback.perform(Request::Play(Sounding::Comb(comb())), |codes| sent.extend(codes)).unwrap();
    loopback.pass(10_000, |codes| sent.extend(codes));
    let from = loopback.samples() + 1000;
    let request = CaptureRequest { from: Some(from), input: 1, log2_codes: 3, values: 333 };
    loopback.perform(Request::Capture(request), |codes| sent.extend(codes)).unwrap();
    let Some((_, Outcome::Captured(captured))) = loopback.view().record.outcomes.back().cloned() else {
        panic!()
    };
    let codes = &sent[(captured.from - before) as usize..];
    let sums: Vec<u32> =
        codes.chunks(8).take(333).map(|eight| eight.iter().map(|it| u32::from(*it)).sum()).collect();
    assert_eq!((captured.from, &captured.values), (from, &sums));
    let first: f64 = codes[..8].iter().map(|code| f64::from(*code) - 2048.0).sum::<f64>() / 8.0;
    assert_eq!(captured.codes().next(), Some(first));
}

#[test]
fn a_newer_window_takes_the_place_of_one_under_way_and_commands_pass_both() {
    let mut loopback = connected();
    let long = ListenRequest { blocks: 10_000, ..WINDOW };
    let first = loopback.hand_over(Request::Listen(long));
    loopback.pass(10_000, |_| ());
    assert_eq!(loopback.view().outcome(first), None);
    // A drive does not wait for the window.
    let now = loopback.samples();
    let at = loopback.perform(Request::Play(Sounding::Comb(comb())), |_| ()).unwrap();
    assert!(at < now + 10 * 128, "{at} {now}");
    listened(&mut loopback, WINDOW);
    assert_eq!(loopback.view().outcome(first), Some(&Outcome::Superseded));
}

#[test]
fn lost_codes_and_a_device_without_inputs_are_reported() {
    let mut loopback = connected();
    let ticket = loopback.hand_over(Request::Listen(WINDOW));
    loopback.pass(1280, |_| ());
    loopback.inject_overrun(1);
    loopback.pass(20_000, |_| ());
    assert!(
        matches!(loopback.view().outcome(ticket), Some(Outcome::Refused(Refusal::InputLost { .. }))),
        "{:?}",
        loopback.view().outcome(ticket)
    );
    captured(&mut loopback, CaptureRequest { from: None, input: 0, log2_codes: 0, values: 10 });

    let mut deaf = Loopback::connect(RATE_HZ).unwrap();
    assert!(!deaf.view().can_listen());
    let refused = deaf.perform(Request::Listen(WINDOW), |_| ()).unwrap_err();
    assert_eq!(refused.to_string(), "this device cannot do that");
}

#[test]
fn a_window_that_has_passed_is_refused_and_the_log_says_nothing_of_it() {
    let mut loopback = connected();
    loopback.pass(20_000, |_| ());
    let logged = |loopback: &Loopback| loopback.view().record.log.len();
    let before = logged(&loopback);
    let late = Request::Listen(ListenRequest { from: Some(128), ..WINDOW });
    assert!(loopback.perform(late, |_| ()).is_err());
    assert_eq!(logged(&loopback), before, "{:?}", loopback.view().record.log);
    // Who asks goes on from now; what else is refused is in the log.
    listened(&mut loopback, WINDOW);
    let none = Request::Listen(ListenRequest { blocks: 0, ..WINDOW });
    assert!(loopback.perform(none, |_| ()).is_err());
    assert_eq!(logged(&loopback), before + 1, "{:?}", loopback.view().record.log);
}

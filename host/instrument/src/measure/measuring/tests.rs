//! The procedure with a device that returns ideal results.

use super::*;
use crate::measure::{NextStep, Run, Wanted, Warning};
use slipline_link::protocol::board::Analogue;
use slipline_link::protocol::event::{Fault, Faults, Status};
use slipline_link::protocol::refusal::{Field, Refusal as DeviceRefusal};
use slipline_link::{LinkState, Listened, Refusal, Snapshot};
use slipline_model::field::simulation;
use slipline_plate::calibrate::{DriveLoad, SensorKind};
use slipline_plate::check::Colour;
use slipline_plate::preset;
use std::f64::consts::TAU;

const RATE_HZ: u32 = 400_000;
const DELAY_NS: i64 = 1143;
const INPUTS: InputsReport =
    InputsReport { inputs: 2, lock_ins: 16, delay_ns: DELAY_NS, lost_blocks: 0, now: 0 };

/// The plate's response: a lag that grows with the frequency and a magnitude that falls.
fn response(frequency_hz: f64) -> Complex64 {
    Complex64::from_polar(100.0 / frequency_hz, 0.01 * frequency_hz)
}

/// A device whose lock-ins return exactly the response to its tones.
struct Ideal {
    now: u64,
    table: Arc<DeviceTable>,
    /// The sounding comb, and the index at which it begins.
    sounds: Option<(u64, CombRequest)>,
    /// Noise of each part of a result, codes.
    noise: f64,
    gain: f64,
    /// Sum of amplitudes that the actuator's travel allows.
    travel: f64,
    /// Periods of each window.
    windows: Vec<u16>,
    /// Samples of settling before each window with tones.
    settled: Vec<u64>,
    stops: usize,
    sums: Vec<f64>,
    /// The progress after each request.
    shares: Vec<f64>,
}

impl Ideal {
    fn new(table: &Arc<DeviceTable>) -> Self {
        Self {
            now: 1000,
            table: table.clone(),
            sounds: None,
            noise: 0.0,
            gain: 1.0,
            travel: 1.0,
            windows: Vec::new(),
            settled: Vec::new(),
            stops: 0,
            sums: Vec::new(),
            shares: Vec::new(),
        }
    }

    fn perform(&mut self, request: &Request) -> Outcome {
        self.now += 640;
        if let Request::Listen(window) = request {
            return self.listen(window);
        }
        if matches!(request, Request::Stop) {
            self.sounds = None;
            self.stops += 1;
            return Outcome::Done { at: self.now };
        }
        let Request::Play(Sounding::Comb(comb)) = request else { panic!("{request:?}") };
        assert!(self.sounds.is_none(), "a comb begins in silence");
        let sum = self.amplitudes(comb).iter().sum::<f64>();
        if sum > self.travel {
            let allowed_per_mille = (1000.0 * self.travel / sum) as u16;
            let travel = DeviceRefusal::Travel { travel_per_mille: 1250, allowed_per_mille };
            return Outcome::Refused(Refusal::Device(travel));
        }
        self.sounds = Some((self.now, comb.clone()));
        Outcome::Done { at: self.now }
    }

    /// Amplitude of each tone, by the table's gain or that of its nearer end.
    fn amplitudes(&self, comb: &CombRequest) -> Vec<f64> {
        let master = 10_f64.powf(comb.master_db / 20.0);
        let amplitude = |tone: &HarmonicRequest| {
            let turns = f64::from(tone.harmonic) / (128.0 * f64::from(comb.period_blocks));
            let knots = self.table.knots();
            let end = if turns * f64::from(RATE_HZ) < 150.0 { knots.first() } else { knots.last() };
            let place = self.table.place_of_turns(turns);
            let gain = place.map_or(end.unwrap().gain, |place| self.table.setting(place).gain);
            f64::from(gain.0) / 2_147_483_648.0 * tone.level * master
        };
        comb.tones.iter().map(amplitude).collect()
    }

    fn listen(&mut self, window: &ListenRequest) -> Outcome {
        let (at, comb) = self.sounds.clone().unwrap();
        let from = window.from.unwrap_or(self.now + u64::from(RATE_HZ));
        assert!(from >= at + (comb.glide_s * f64::from(RATE_HZ)) as u64);
        let windows = window.blocks / comb.period_blocks;
        assert_eq!((window.input, window.blocks), (0, windows * comb.period_blocks));
        assert!(windows == 1 || window.from.is_none(), "a longer window follows the first");
        self.windows.push(windows);
        assert_eq!(window.slots.count_ones() as usize, comb.tones.len());
        let mut answers = [None; 16];
        let (mut sum, mut swing) = (0.0, 0.0);
        for ((slot, tone), amplitude) in comb.tones.iter().enumerate().zip(self.amplitudes(&comb)) {
            let turns = f64::from(tone.harmonic) / (128.0 * f64::from(comb.period_blocks));
            let hz = turns * f64::from(RATE_HZ);
            // The hold's half sample, minus the delay.
            let lag = TAU * hz * (0.5 / f64::from(RATE_HZ) - 1e-9 * DELAY_NS as f64);
            let answer = (response(hz) * Complex64::cis(lag)).conj() * 2048.0 * amplitude * self.gain;
            let noise = Complex64::from_polar(self.noise * 2_f64.sqrt(), 2.4 * slot as f64);
            answers[slot] = Some(((answer + noise).re, (answer + noise).im));
            sum += amplitude;
            swing += answer.norm();
        }
        if comb.master_db == 0.0 {
            self.settled.push(from - at - (comb.glide_s * f64::from(RATE_HZ)) as u64);
            self.sums.push(sum);
        }
        self.now = from + 128 * u64::from(window.blocks);
        let swing = (swing.round() as u16).min(2047);
        Outcome::Listened(Arc::new(Listened {
            begin: from,
            blocks: window.blocks,
            answers,
            lowest: 2048 - swing - 1,
            highest: 2048 + swing,
        }))
    }
}

/// The results of a window, for changes.
fn heard(outcome: &mut Outcome) -> Option<&mut Listened> {
    if let Outcome::Listened(listened) = outcome { Some(Arc::make_mut(listened)) } else { None }
}

fn measuring(points: usize) -> (Run<Measuring>, Arc<DeviceTable>) {
    let (measuring, table) = planned(points);
    (Run::of(measuring), table)
}

fn planned(points: usize) -> (Measuring, Arc<DeviceTable>) {
    let plate = preset("membrane").unwrap();
    let (_, table) = simulation::table_for(&plate, RATE_HZ).unwrap();
    let wanted = Wanted { points, ..Wanted::of(&plate) };
    let plan = Plan::new(&plate, &wanted, f64::from(RATE_HZ), 16).unwrap();
    let sensor = Sensor { place_m: 0.032, kind: SensorKind::Velocity, input: 0, body: None };
    (Measuring::new(plan, table.clone(), sensor, &INPUTS).unwrap(), table)
}

/// Runs all steps; `change` may modify an outcome.
fn run(
    measuring: &mut Run<Measuring>,
    device: &mut Ideal,
    mut change: impl FnMut(&mut Outcome, &Request),
) -> Vec<Request> {
    let mut asked = Vec::new();
    loop {
        match measuring.step() {
            NextStep::Ask(request) => {
                assert!(matches!(measuring.step(), NextStep::Wait | NextStep::Ended));
                let mut outcome = device.perform(&request);
                change(&mut outcome, &request);
                device.shares.push(measuring.progress(device.now));
                measuring.take(&outcome);
                asked.push(request);
            }
            NextStep::Wait => panic!("nothing is awaited"),
            NextStep::Ended => return asked,
        }
        assert!(asked.len() < 1000, "it never ends");
    }
}

#[test]
fn the_response_of_an_ideal_device_is_found_to_the_last_digits() {
    let (measuring, table) = planned(60);
    let mut device = Ideal::new(&table);
    device.noise = 0.01;
    let combs = measuring.plan.combs.clone();
    let mut measuring = Run::of(measuring);
    let asked = run(&mut measuring, &mut device, |_, _| ());
    assert!(matches!(asked.last(), Some(Request::Stop)) && device.sounds.is_none());
    assert_eq!(measuring.progress(0), 1.0);
    assert!(device.shares.windows(2).all(|two| two[0] <= two[1] && two[1] <= 1.0), "{:?}", device.shares);
    assert!(device.shares.iter().filter(|share| **share > 0.1 && **share < 0.9).count() > 5);
    for (settled, comb) in device.settled.iter().zip(&combs) {
        assert!(*settled >= comb.settle_samples, "{settled}");
    }
    assert!(device.sums.iter().all(|sum| *sum <= 0.5 && *sum > 0.49), "{:?}", device.sums);
    let measured = measuring.finish().unwrap();
    let points = &measured.measurement.points;
    assert_eq!((points.len(), measured.measurement.sample_rate_hz), (60, Some(400e3)));
    assert!(points.windows(2).all(|two| two[0].frequency_hz < two[1].frequency_hz));
    for point in points {
        let error = (point.response - response(point.frequency_hz)).norm();
        assert!(error < 2.0 * point.noise && error > 0.0, "{point:?}");
    }
    assert_eq!(measured.light(), Colour::Green);
}

#[test]
fn the_noise_is_measured_in_silence_over_the_windows_length() {
    let (measuring, table) = planned(60);
    let mut device = Ideal::new(&table);
    // One code of noise in the first window: each part has 2/N of its square.
    let combs = measuring.plan.combs.clone();
    device.noise = (2.0 / combs[0].window_samples() as f64).sqrt();
    let tones = |comb: &Comb| loudness::tones(comb, &table, f64::from(RATE_HZ), measuring.plan.level);
    let windows: Vec<_> = combs.iter().map(|comb| (tones(comb), comb.window_samples())).collect();
    let mut measuring = Run::of(measuring);
    run(&mut measuring, &mut device, |_, _| ());
    let measured = measuring.finish().unwrap();
    // The silent comb adds a negligible amount.
    assert!((measured.noise_codes - 1.0).abs() < 0.02, "{}", measured.noise_codes);
    for point in &measured.measurement.points {
        let mut tones =
            windows.iter().flat_map(|(tones, samples)| tones.iter().map(move |tone| (tone, samples)));
        let (tone, samples) = tones.find(|(tone, _)| tone.frequency_hz == point.frequency_hz).unwrap();
        let wanted = (2.0 / *samples as f64).sqrt() / (2048.0 * tone.amplitude);
        assert!((point.noise / wanted - 1.0).abs() < 0.05, "{} {wanted}", point.noise);
    }
}

#[test]
fn answers_that_are_not_clear_are_averaged_over_as_many_windows_as_they_need() {
    let (measuring, table) = planned(16);
    let tones = loudness::tones(&measuring.plan.combs[0], &table, f64::from(RATE_HZ), measuring.plan.level);
    let codes = |tone: &Tone| 2048.0 * tone.amplitude * response(tone.frequency_hz).norm();
    let weakest = tones.iter().map(codes).fold(f64::INFINITY, f64::min);
    // The second window answers with three times the amplitude.
    let heard_at = |over_noise: f64| {
        let (mut measuring, table) = self::measuring(16);
        let mut device = Ideal::new(&table);
        device.noise = weakest / over_noise;
        run(&mut measuring, &mut device, |outcome, request| {
            let is_second = matches!(request, Request::Listen(ListenRequest { from: None, .. }));
            if let Some(listened) = heard(outcome).filter(|_| is_second) {
                for (re, im) in listened.answers.iter_mut().flatten() {
                    (*re, *im) = (3.0 * *re, 3.0 * *im);
                }
            }
        });
        assert!(device.shares.windows(2).all(|two| two[0] <= two[1]), "{:?}", device.shares);
        (device.windows, measuring.finish().unwrap().measurement.points)
    };
    let (windows, clear) = heard_at(100.0);
    assert_eq!(windows, [1, 1]);
    let (windows, _) = heard_at(1e-3);
    assert_eq!(windows, [1, 1], "what no number of windows makes clear");
    let (windows, points) = heard_at(20.0);
    let further = f64::from(windows[2]);
    assert!(windows.len() == 3 && (2.0..=5.0).contains(&further), "{windows:?}");
    for (point, clear) in points.iter().zip(&clear) {
        // Five times the noise of the clear one, over the root of the number of windows.
        let noise = 5.0 * clear.noise / (1.0 + further).sqrt();
        assert!((point.noise / noise - 1.0).abs() < 0.01, "{} {noise}", point.noise);
        let mean = (1.0 + 3.0 * further) / (1.0 + further);
        let error = (point.response / mean - response(point.frequency_hz)).norm();
        assert!(error < 2.0 * 5.0 * clear.noise, "{error}");
    }
    // A drive check raises its level and its window by itself.
    let plate = preset("membrane").unwrap();
    let load = DriveLoad::Coil { resistance_ohm: 8.0 };
    assert_eq!(Plan::of_drive(&plate, &load, 400e3, 16, 0.01, 0.1).unwrap().windows, 1);
}

#[test]
fn a_silent_input_still_rounds_and_is_reported() {
    let (mut measuring, table) = measuring(16);
    let mut device = Ideal::new(&table);
    device.gain = 1e-4;
    run(&mut measuring, &mut device, |outcome, _| {
        if let Some(listened) = heard(outcome) {
            (listened.lowest, listened.highest) = (2048, 2048);
        }
    });
    let measured = measuring.finish().unwrap();
    let message = |wanted: fn(&Warning) -> bool| measured.warnings.iter().any(wanted);
    assert!(message(|it| *it == Warning::Stuck) && message(|it| matches!(it, Warning::NoDither { .. })));
    assert!(
        message(|it| matches!(it, Warning::Weak { .. })) && message(|it| matches!(it, Warning::Quiet { .. }))
    );
    assert_eq!(measured.light(), Colour::Amber);
    assert!(measured.measurement.points.iter().all(|point| point.noise > 0.0));
    assert!(measured.warnings.iter().all(|warning| warning.sentence().ends_with(['.', '?'])));
}

#[test]
fn a_clipped_input_is_red_and_counted() {
    let (mut measuring, table) = measuring(32);
    let mut device = Ideal::new(&table);
    let mut windows = 0;
    run(&mut measuring, &mut device, |outcome, _| {
        if let Some(listened) = heard(outcome) {
            windows += 1;
            (listened.lowest, listened.highest) = if windows == 2 { (600, 4095) } else { (548, 3500) };
        }
    });
    let measured = measuring.finish().unwrap();
    assert_eq!(measured.light(), Colour::Red);
    assert_eq!(measured.warnings.first(), Some(&Warning::Clipped { count: 16 }));
    let free = measured.measurement.points.iter().filter(|point| point.headroom_db != Some(0.0));
    assert!(
        free.clone().count() == 16 && free.into_iter().all(|it| (it.headroom_db.unwrap() - 2.7).abs() < 0.1)
    );
}

#[test]
fn a_window_that_lost_samples_is_measured_again_but_not_for_ever() {
    let (mut measuring, table) = measuring(32);
    let mut device = Ideal::new(&table);
    let mut windows = 0;
    run(&mut measuring, &mut device, |outcome, _| {
        if heard(outcome).is_some() {
            windows += 1;
            if windows == 2 {
                *outcome = Outcome::Refused(Refusal::InputLost { at: 7 });
            }
        }
    });
    assert_eq!(windows, 4, "silence, a broken one, and two");
    assert_eq!(measuring.finish().unwrap().measurement.points.len(), 32);

    let (mut measuring, table) = self::measuring(32);
    let mut device = Ideal::new(&table);
    let asked = run(&mut measuring, &mut device, |outcome, _| {
        if heard(outcome).is_some() {
            *outcome = Outcome::Refused(Refusal::InputLost { at: 7 });
        }
    });
    assert!(matches!(asked.last(), Some(Request::Stop)));
    assert_eq!(measuring.finish(), Err(MeasureError::Overrun { tries: 4 }));
}

#[test]
fn a_host_that_asks_too_late_for_a_window_measures_from_then_on() {
    let (mut measuring, table) = measuring(32);
    let mut device = Ideal::new(&table);
    let mut refused = 0;
    let asked = run(&mut measuring, &mut device, |outcome, request| {
        if matches!(request, Request::Listen(ListenRequest { from: Some(_), .. })) {
            refused += 1;
            let late = DeviceRefusal::OutOfRange { field: Field::ApplyAt, min: 2, max: 3, got: 1 };
            *outcome = Outcome::Refused(Refusal::Device(late));
        }
    });
    let at_once = |request: &&Request| matches!(request, Request::Listen(ListenRequest { from: None, .. }));
    assert_eq!((refused, asked.iter().filter(at_once).count()), (3, 3));
    assert_eq!(measuring.finish().unwrap().measurement.points.len(), 32);
}

#[test]
fn a_travel_that_is_too_large_lowers_the_level() {
    let (mut measuring, table) = measuring(16);
    let mut device = Ideal::new(&table);
    device.travel = 0.3;
    let asked = run(&mut measuring, &mut device, |_, _| ());
    assert!(asked.len() > 7, "it was refused");
    assert!(device.sums.iter().all(|sum| *sum <= 0.3 && *sum > 0.28), "{:?}", device.sums);
    let points = measuring.finish().unwrap().measurement.points;
    assert!(points.iter().all(|it| (it.response - response(it.frequency_hz)).norm() < 2.0 * it.noise));
}

#[test]
fn on_a_board_full_scale_is_the_linear_part_of_its_output() {
    let plate = preset("membrane").unwrap();
    let (_, table) = simulation::table_for(&plate, RATE_HZ).unwrap();
    let wanted = Wanted { points: 16, level: 1.0, ..Wanted::of(&plate) };
    let plan = Plan::new(&plate, &wanted, f64::from(RATE_HZ), 16).unwrap();
    let sensor = Sensor { place_m: 0.032, kind: SensorKind::Velocity, input: 0, body: None };
    for (linear_per_mille, least, most) in [(880, 0.87, 0.88), (1000, 0.99, 1.0)] {
        let mut measuring = Run::of(Measuring::new(plan.clone(), table.clone(), sensor, &INPUTS).unwrap());
        let mut snapshot = Snapshot::default();
        snapshot.link.state = LinkState::Connected;
        snapshot.device.analogue = Some(Analogue { linear_per_mille, ..Analogue::default() });
        measuring.watch(&snapshot);
        let mut device = Ideal::new(&table);
        run(&mut measuring, &mut device, |_, _| ());
        assert!(device.sums.iter().all(|sum| *sum <= most && *sum > least), "{:?}", device.sums);
        let points = measuring.finish().unwrap().measurement.points;
        let off =
            |it: &slipline_plate::calibrate::MeasuredPoint| (it.response - response(it.frequency_hz)).norm();
        assert!(points.iter().all(|it| off(it) < 2.0 * it.noise));
    }
}

#[test]
fn a_refusal_a_fault_a_lost_link_and_a_cancel_end_with_a_stop_and_their_reason() {
    let ended = |change: &mut dyn FnMut(&mut Outcome, &Request)| {
        let (mut measuring, table) = measuring(32);
        let asked = run(&mut measuring, &mut Ideal::new(&table), change);
        assert!(matches!(asked.last(), Some(Request::Stop)), "{asked:?}");
        (measuring.finish().unwrap_err(), asked.len())
    };
    let of = |wanted: Outcome| {
        ended(&mut |outcome, request| {
            if matches!(request, Request::Play(Sounding::Comb(_))) {
                *outcome = wanted.clone();
            }
        })
    };
    let refusal = Refusal::Device(DeviceRefusal::NotSupported);
    assert_eq!(of(Outcome::Refused(refusal.clone())), (MeasureError::Refused(refusal), 3));
    assert_eq!(of(Outcome::DeviceTooOld).0, MeasureError::TooOld);
    assert_eq!(of(Outcome::NotConnected).0, MeasureError::Lost);
    assert_eq!(of(Outcome::Superseded).0, MeasureError::Stopped);
    // A tone that was not followed: another drive was played.
    let stopped = ended(&mut |outcome, _| {
        if let Some(listened) = heard(outcome) {
            listened.answers[3] = None;
        }
    });
    assert_eq!(stopped.0, MeasureError::Stopped);

    let (mut measuring, _) = measuring(32);
    let _ = measuring.step();
    measuring.cancel();
    assert!(matches!(measuring.step(), NextStep::Ask(Request::Stop)));
    measuring.take(&Outcome::Done { at: 0 });
    assert!(matches!(measuring.step(), NextStep::Ended));
    assert_eq!(measuring.finish(), Err(MeasureError::Cancelled));

    let (mut measuring, _) = self::measuring(32);
    measuring.watch(&Snapshot::default());
    assert!(matches!(measuring.step(), NextStep::Ask(Request::Stop)));
    measuring.take(&Outcome::NotConnected);
    assert_eq!(measuring.finish(), Err(MeasureError::Lost));
}

#[test]
fn an_outcome_that_comes_after_the_cancellation_does_not_stand_for_that_of_the_stop() {
    let (mut measuring, _) = measuring(32);
    for _ in 0..2 {
        assert!(matches!(measuring.step(), NextStep::Ask(_)));
        measuring.take(&Outcome::Done { at: 0 });
    }
    assert!(matches!(measuring.step(), NextStep::Ask(Request::Listen(_))));
    measuring.cancel();
    measuring.take(&Outcome::Superseded);
    assert!(matches!(measuring.step(), NextStep::Ask(Request::Stop)));
    measuring.take(&Outcome::Done { at: 0 });
    assert!(matches!(measuring.step(), NextStep::Ended));
    assert_eq!(measuring.finish(), Err(MeasureError::Cancelled));
}

#[test]
fn a_fault_ends_the_measurement_and_explains_why_the_tones_were_stopped() {
    let status = Status { faults: Faults::NONE.with(Fault::EmergencyStop), ..Status::default() };
    let mut faulty = Snapshot::default();
    faulty.link.state = LinkState::Connected;
    faulty.drive.status = Some(status);
    let (mut measuring, _) = measuring(32);
    measuring.watch(&faulty);
    assert!(matches!(measuring.step(), NextStep::Ask(Request::Stop)));
    measuring.take(&Outcome::Done { at: 0 });
    let Err(MeasureError::Fault(message)) = measuring.finish() else { panic!("a fault") };
    assert_eq!(message, status.faults.to_string());

    let (mut measuring, _) = self::measuring(32);
    let _ = measuring.step();
    measuring.take(&Outcome::Superseded);
    measuring.watch(&faulty);
    measuring.take(&Outcome::Done { at: 0 });
    assert!(matches!(measuring.finish(), Err(MeasureError::Fault(_))));
}

#[test]
fn a_device_without_the_input_is_refused() {
    let (measuring, table) = planned(16);
    let none = InputsReport { inputs: 0, ..INPUTS };
    let refused = Measuring::new(measuring.plan.clone(), table, measuring.sensor, &none).err();
    assert_eq!(refused, Some(MeasureError::NoInputs));
}

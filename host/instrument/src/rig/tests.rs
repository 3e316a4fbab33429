use super::*;
use crate::measure::Bandwidths;
use slipline_link::BLOCK;
use slipline_link::simulator::SimulatedInputs;
use slipline_plate::calibrate::{
    DriveCheck, MeasuredPoint, Measurement, SensorBody, SensorKind, check_drive, drive_check_hz,
};
use slipline_plate::{
    Air, AirMounting, Complex64, DriveEnd, Equation, Faces, Gas, Impedance, PlateSpec, Source, TurningWidth,
    preset, presets, respond, respond_touched,
};
use std::f64::consts::{PI, TAU};

const RATE_HZ: f64 = 400e3;

fn rig(plate: &Plate, options: RigOptions) -> PreparedRig {
    PreparedRig::new(plate, &options, RATE_HZ).expect("a rig")
}

/// Plays a number of blocks of a tone with this amplitude in codes and returns the codes of both inputs;
/// `first` counts samples.
fn play(inputs: &mut dyn SimulatedInputs, hz: f64, codes: f64, first: usize, blocks: usize) -> [Vec<u16>; 2] {
    let mut heard = [Vec::new(), Vec::new()];
    let mut sensed = [[0; BLOCK]; 2];
    for block in 0..blocks {
        let code = |i: usize| {
            let n = (first + block * BLOCK + i) as f64;
            (2048.0 + codes * (TAU * (hz * n / RATE_HZ).fract()).cos()).round() as u16
        };
        inputs.sample(&std::array::from_fn(code), false, &mut sensed);
        for (heard, sensed) in heard.iter_mut().zip(&sensed) {
            heard.extend_from_slice(sensed);
        }
    }
    heard
}

/// The amplitude H of Re(H e^(-j omega t_n)) in codes; `hz` must have whole periods in the codes.
fn amplitude(codes: &[u16], hz: f64, first: usize) -> Complex64 {
    let turned = codes.iter().zip(first..).map(|(&code, n)| {
        Complex64::cis(TAU * (hz * n as f64 / RATE_HZ).fract()) * (f64::from(code) - 2048.0)
    });
    turned.sum::<Complex64>() * (2.0 / codes.len() as f64)
}

fn level_db(codes: &[u16]) -> f64 {
    let mean = codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64;
    let square = codes.iter().map(|&code| (f64::from(code) - mean).powi(2)).sum::<f64>() / codes.len() as f64;
    10.0 * (square + 1e-9).log10()
}

/// Velocity of the driven end and field, per code of 1, in the frequency domain; without the codes' hold.
fn steady(plate: &Plate, hz: f64, points: usize) -> Vec<Complex64> {
    let field = respond(plate, hz, points, Equation::Corrected).expect("in range").amplitude;
    let drive = plate.drive_response(hz) * plate.spec().full_scale_m;
    field.into_iter().map(|f| f * drive).collect()
}

fn hold(hz: f64) -> Complex64 {
    let turn = PI * hz / RATE_HZ;
    Complex64::cis(turn) * (turn.sin() / turn)
}

fn assert_close(what: &str, found: Complex64, exact: Complex64) {
    let ratio = found / exact;
    let (decibels, degrees) = (20.0 * ratio.norm().log10(), ratio.arg().to_degrees());
    assert!(decibels.abs() < 0.05 && degrees.abs() < 0.3, "{what}: {decibels:.4} dB, {degrees:.3} degrees");
}

#[test]
fn codes_of_sensor_and_shunt_match_the_frequency_domain_on_a_secret_plate() {
    for (name, hz, settling) in [("membrane", 150.0, 3500), ("al-bending", 27e3, 400)] {
        let truth = secret(&preset(name).expect("a preset"), 11).expect("a plate");
        let place_m = 0.1 * truth.length_m();
        let delay_s = 7.3e-6;
        let options = RigOptions {
            place_m,
            sensor: SensorKind::Velocity,
            sensor_delay_s: delay_s,
            ..RigOptions::default()
        };
        let rig = rig(&truth, options);
        let mut inputs = rig.inputs();
        let codes = 900.0;
        play(&mut *inputs, hz, codes, 0, settling);
        let first = settling * BLOCK;
        // 0.16 s: whole periods.
        let heard = play(&mut *inputs, hz, codes, first, 500);
        let field = steady(&truth, hz, 5001);
        let velocity = |f: Complex64| Complex64::new(0.0, -TAU * hz) * f;
        let per_code = codes * hold(hz);
        let sensor = velocity(field[500]) * Complex64::cis(TAU * hz * delay_s) / rig.sensor_full_scale();
        assert_close(name, amplitude(&heard[0], hz, first), sensor * per_code);
        let amplifier = truth.spec().actuator.as_ref().expect("drawn").response(hz);
        let current = rig.motor().current_a(hz, amplifier, velocity(field[0])) / rig.shunt_full_scale_a();
        assert_close(&format!("{name}, shunt"), amplitude(&heard[1], hz, first), current * per_code);
        let nominal = rig.motor().current_a(hz, amplifier, Complex64::ZERO) / rig.shunt_full_scale_a();
        assert!((current / nominal - 1.0).norm() > 0.02, "{name}: the shunt sees the plate");
    }
}

#[test]
fn the_power_at_the_shunt_equals_the_losses_of_coil_source_and_plate() {
    let mut spec = preset("membrane").expect("a preset").spec().clone();
    // Plain width: k^2 = K^2 - (pi/2W)^2 without further terms.
    spec.turning_width = TurningWidth::Plain;
    let impedance = Impedance { resistance_n_s_per_m: 0.22, mass_kg: 1e-4, stiffness_n_per_m: 60.0 };
    let source = Source { impedance, at_frequency_hz: 140.0, slope: None, lead_in: None };
    spec.drive_end = DriveEnd::Source(source);
    let plate = Plate::new(spec).expect("a plate");
    let rig = rig(&plate, RigOptions::default());
    let motor = rig.motor();
    let Transducer::Coil { resistance_ohm, force_factor_n_per_a } = motor.transducer else {
        panic!("a membrane has a coil")
    };
    let tension_n_per_m = 40.0;
    for hz in [92.0, 120.0, 151.0, 205.0] {
        let omega = TAU * hz;
        let current = rig.current(hz) / hold(hz);
        let taken = 0.5 * (motor.full_scale_v * current.conj()).re;
        const POINTS: usize = 20_001;
        let field = steady(&plate, hz, POINTS);
        let step_m = plate.length_m() / (POINTS - 1) as f64;
        // A sheet of tension T loses eta omega times its strain energy: the integral of T/(1 + eta^2) W (|f'|^2 +
        // (q/W)^2 |f|^2)/2 over x.
        let eta = plate.wave_loss();
        let mut stored = 0.0;
        for i in 1..POINTS {
            let width = plate.half_width_m((i as f64 - 0.5) * step_m);
            let (slope, middle) = ((field[i] - field[i - 1]) / step_m, 0.5 * (field[i] + field[i - 1]));
            let across = (0.5 * PI / width).powi(2);
            stored += width * (slope.norm_sqr() + across * middle.norm_sqr()) * step_m;
        }
        let plate_loss = 0.5 * omega * eta / (1.0 + eta * eta) * tension_n_per_m * stored;
        let velocity = Complex64::new(0.0, -omega) * field[0];
        let mechanical = 0.22 - force_factor_n_per_a.powi(2) / resistance_ohm;
        let lost =
            0.5 * resistance_ohm * current.norm_sqr() + 0.5 * mechanical * velocity.norm_sqr() + plate_loss;
        assert!((taken / lost - 1.0).abs() < 2e-3, "{hz} Hz: {taken} W taken, {lost} W lost");
        assert!(plate_loss > 0.03 * taken, "{hz} Hz: {plate_loss} W of it in the plate");
    }
}

#[test]
fn a_sensor_that_is_moved_sees_the_plate_where_it_stands_then() {
    let plate = preset("al-bending").expect("a preset");
    let rig = rig(&plate, RigOptions { place_m: 0.034, ..RigOptions::default() });
    let (mut inputs, hand) = (rig.inputs(), rig.hand());
    let hz = 25e3;
    let blocks = 125;
    play(&mut *inputs, hz, 1500.0, 0, 400);
    let field = steady(&plate, hz, 3401);
    let mut first = 400 * BLOCK;
    for place_m in [0.034, 0.187, 0.1] {
        hand.put_sensor(place_m).expect("on the plate");
        assert_eq!(hand.place_m(), place_m);
        let heard = play(&mut *inputs, hz, 1500.0, first, blocks);
        let exact = field[(place_m * 1e4_f64).round() as usize] * hold(hz) * 1500.0 / rig.sensor_full_scale();
        assert_close(&format!("{place_m}"), amplitude(&heard[0], hz, first), exact);
        first += blocks * BLOCK;
    }
    let refused = hand.put_sensor(0.5).expect_err("beyond the end").to_string();
    assert!(refused.starts_with("sensor place = ") && refused.contains("0 to 0.34 m"), "{refused}");
    assert_eq!(hand.place_m(), 0.1);
    // A millimetre off: the codes of the shifted place, the mark of the present one.
    hand.set_fault(Some(RigFault::OffItsMark(0.001))).expect("a fault");
    let heard = play(&mut *inputs, hz, 1500.0, first, blocks);
    let exact = field[1010] * hold(hz) * 1500.0 / rig.sensor_full_scale();
    assert_close("off its mark", amplitude(&heard[0], hz, first), exact);
    assert_eq!(hand.place_m(), 0.1);
}

#[test]
fn each_fault_shows_at_the_input_where_it_is() {
    let plate = preset("al-bending").expect("a preset");
    let rig = rig(&plate, RigOptions { place_m: 0.034, ..RigOptions::default() });
    let hand = rig.hand();
    let hz = 25e3;
    let heard = |fault: Option<RigFault>| {
        hand.set_fault(fault).expect("a fault");
        let mut inputs = rig.inputs();
        play(&mut *inputs, hz, 600.0, 0, 200);
        play(&mut *inputs, hz, 600.0, 200 * BLOCK, 50)
    };
    let noise_db = 20.0 * 0.76_f64.log10();
    let [sensor, shunt] = heard(None);
    assert!(
        level_db(&sensor) > 10.0 && level_db(&shunt) > 10.0,
        "{} {}",
        level_db(&sensor),
        level_db(&shunt)
    );
    assert!(sensor.iter().chain(&shunt).all(|&code| code > 100 && code < 3995), "no input clips");
    let [unplugged, unchanged] = heard(Some(RigFault::Unplugged));
    assert!((level_db(&unplugged) - noise_db).abs() < 0.5, "{}", level_db(&unplugged));
    assert!((level_db(&unchanged) - level_db(&shunt)).abs() < 0.01);
    let [clipped, _] = heard(Some(RigFault::Clipped));
    assert!(clipped.contains(&0) && clipped.contains(&4095));
    let [stuck, _] = heard(Some(RigFault::Stuck(77)));
    assert!(stuck.iter().all(|&code| code == 77));
    let silent = heard(Some(RigFault::OpenMotor));
    assert!(silent.iter().all(|it| (level_db(it) - noise_db).abs() < 0.5));
    let [still, shorted] = heard(Some(RigFault::ShortedMotor));
    assert!((level_db(&still) - noise_db).abs() < 0.5 && shorted.contains(&4095));
    assert_eq!(hand.fault(), Some(RigFault::ShortedMotor));
    for (fault, field) in [
        (RigFault::WrongMotor(0.001), "current of the wrong motor = "),
        (RigFault::OffItsMark(0.2), "distance from the mark = "),
        (RigFault::OffItsMark(f64::NAN), "distance from the mark = "),
        (RigFault::Stuck(5000), "stuck code = "),
    ] {
        let refused = hand.set_fault(Some(fault)).expect_err("refused").to_string();
        assert!(refused.starts_with(field), "{refused}");
    }
}

#[test]
fn a_muted_amplifier_lets_the_plate_die_out_and_the_noise_is_as_stated_and_repeats() {
    let plate = preset("al-bending").expect("a preset");
    let rig = rig(&plate, RigOptions { place_m: 0.034, noise_lsb: 3.0, seed: 9, ..RigOptions::default() });
    let (mut one, mut other) = (rig.inputs(), rig.inputs());
    assert_eq!((one.inputs(), one.delay_ns()), (2, 0));
    play(&mut *one, 25e3, 1500.0, 0, 200);
    let mut sensed = [[0; BLOCK]; 2];
    let mut rest = [Vec::new(), Vec::new()];
    for block in 0..900 {
        let codes = std::array::from_fn(|i| if i % 16 < 8 { 4000 } else { 100 });
        one.sample(&codes, true, &mut sensed);
        if block >= 400 {
            rest.iter_mut().zip(&sensed).for_each(|(rest, sensed)| rest.extend_from_slice(sensed));
        }
    }
    for codes in &rest {
        let rms = 10_f64.powf(level_db(codes) / 20.0);
        assert!((rms / (9.0_f64 + 1.0 / 12.0).sqrt() - 1.0).abs() < 0.02, "{rms}");
    }
    let again = play(&mut *other, 25e3, 1500.0, 0, 3);
    let mut third = rig.inputs();
    assert_eq!(play(&mut *third, 25e3, 1500.0, 0, 3), again);
    let reseeded =
        self::rig(&plate, RigOptions { place_m: 0.034, noise_lsb: 3.0, seed: 10, ..RigOptions::default() });
    assert_ne!(play(&mut *reseeded.inputs(), 25e3, 1500.0, 0, 3), again);
}

/// Far below the cut-off the shunt's current is mainly the motor's, so a healthy rig's drive is found to be
/// on.
#[test]
fn every_preset_and_its_secrets_have_a_rig_whose_drive_is_on() {
    for preset in presets() {
        let nominal = preset.plate().expect("a preset");
        for truth in [0, 1, 3, 6].map(|seed| secret(&nominal, seed)).into_iter().chain([Ok(nominal.clone())])
        {
            let truth = truth.expect("a plate");
            assert_eq!(checked(&truth), Ok(DriveCheck::On), "{}", preset.name);
        }
    }
}

/// The drive check of a rig on this plate.
fn checked(truth: &Plate) -> Result<DriveCheck, RigError> {
    let options = RigOptions { place_m: 0.55 * truth.length_m(), ..RigOptions::default() };
    let rig = PreparedRig::new(truth, &options, RATE_HZ)?;
    let circuit = rig.known_drive().circuit;
    let point = |frequency_hz| MeasuredPoint {
        frequency_hz,
        response: rig.current(frequency_hz),
        noise: 1e-6 * rig.shunt_full_scale_a(),
        headroom_db: Some(20.0),
    };
    let points = drive_check_hz(truth, &circuit.load).into_iter().map(point).collect();
    let current = Measurement::at(0.0, SensorKind::Displacement, points);
    let check = check_drive(truth, &circuit, &current).expect("a circuit and a current");
    println!("{} {:?} {:?}", truth.name(), circuit.load, check);
    Ok(check)
}

/// Below its cut-off a clamped strip of steel yields under its piezo: the motion's current counts as capacitance, which the data
/// sheet of the piezo must outweigh.
#[test]
fn a_plate_that_is_soft_below_its_cut_off_has_a_piezo_that_outweighs_its_motion() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../plate/tests/clamped_lead_in.toml");
    let lead_in = &std::fs::read_to_string(file).expect("the file");
    let lead_in = Plate::from_toml(lead_in).expect("a plate");
    let with = |source: Source| {
        let spec = PlateSpec { drive_end: DriveEnd::Source(source), ..lead_in.spec().clone() };
        Plate::new(spec).expect("valid")
    };
    let DriveEnd::Source(source) = lead_in.spec().drive_end else { panic!("a source") };
    let bare = with(Source { lead_in: None, ..source });
    let damper = Impedance { resistance_n_s_per_m: 2.0, ..source.impedance };
    let damped = with(Source { impedance: damper, ..source });
    for plate in [lead_in.clone(), bare, damped] {
        let secrets = [0, 3].map(|seed| secret(&plate, seed).expect("a plate"));
        for truth in secrets.into_iter().chain([plate]) {
            assert_eq!(checked(&truth), Ok(DriveCheck::On));
        }
    }
}

/// The pressure of a baffle at a distance is singular where a tone turns at the plate's end, above the band that is measured.
#[test]
fn a_membrane_in_a_baffle_has_a_rig_with_its_sensor_at_every_place() {
    let in_baffle = |name: &str, faces: Faces| {
        let air = Some(Air::Around { gas: Gas::ROOM, mounting: AirMounting::Baffle { faces }, gap_m: None });
        Plate::new(PlateSpec { air, ..preset(name).expect("a preset").spec().clone() }).expect("valid")
    };
    for (name, faces, seed) in [
        ("latex-membrane", Faces::Two, None),
        ("latex-membrane", Faces::Two, Some(3)),
        ("latex-membrane", Faces::One, Some(2)),
        ("membrane-heavy", Faces::Two, Some(3)),
    ] {
        let plate = in_baffle(name, faces);
        let truth = seed.map_or_else(|| Ok(plate.clone()), |seed| secret(&plate, seed)).expect("a plate");
        let options = RigOptions { place_m: 0.094, ..RigOptions::default() };
        let rig = PreparedRig::new(&truth, &options, RATE_HZ);
        let rig = rig.unwrap_or_else(|error| panic!("{name} {faces:?} {seed:?}: {error}"));
        for place_m in [0.05, 0.198] {
            rig.hand()
                .put_sensor(place_m)
                .unwrap_or_else(|error| panic!("{name} {faces:?} {seed:?} {place_m}: {error}"));
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused_by_name_and_range() {
    let plate = preset("membrane").expect("a preset");
    let refused =
        |options: RigOptions| PreparedRig::new(&plate, &options, RATE_HZ).expect_err("refused").to_string();
    let healthy = RigOptions::default();
    let error = refused(RigOptions { noise_lsb: 101.0, ..healthy });
    assert!(error.starts_with("noise = ") && error.contains("0 to 100 LSB"), "{error}");
    let error = refused(RigOptions { sensor_delay_s: -1e-9, ..healthy });
    assert!(error.starts_with("sensor delay = ") && error.contains("0 to 0.001 s"), "{error}");
    let error = refused(RigOptions { full_scale: Some(0.0), ..healthy });
    assert!(error.starts_with("sensor full scale = "), "{error}");
    let error = refused(RigOptions { place_m: 0.33, ..healthy });
    assert!(error.starts_with("sensor place = ") && error.contains("0 to 0.32 m"), "{error}");
    let error = refused(RigOptions { sensor: SensorKind::Strain, ..healthy });
    assert!(error.contains("strains its surface"), "{error}");
}

#[test]
fn a_rig_is_printed_in_a_line_and_not_in_all_its_numbers() {
    let nominal = slipline_plate::preset("membrane").unwrap();
    let rig = rig(&nominal, RigOptions { place_m: 0.05, ..RigOptions::default() });
    let debug = format!("{rig:?} {:?}", rig.hand());
    assert!(debug.contains("place_m: 0.05") && debug.len() < 2000, "{} letters", debug.len());
}

/// A sensor that weighs takes its mass along: its signal is that of the plate with the mass under it, at either place.
#[test]
fn a_sensor_with_mass_measures_the_plate_as_its_mass_changes_it() {
    let truth = secret(&preset("tungsten-membrane").expect("a preset"), 3).expect("a plate");
    let hz = 0.5 * (truth.band_hz().0 + truth.band_hz().1);
    // Whole periods in the codes that are read.
    let hz = (hz / 6.25).round() * 6.25;
    let body = SensorBody { mass_kg: 6e-5, width_m: 5e-3 };
    let options = RigOptions { place_m: 0.1, body: Some(body), ..RigOptions::default() };
    let rig = rig(&truth, options.clone());
    let mut inputs = rig.inputs();
    let codes = 900.0;
    for (turn, place_m) in [0.1, 0.16].into_iter().enumerate() {
        rig.hand().put_sensor(place_m).expect("on the plate");
        let first = turn * 4000 * BLOCK;
        play(&mut *inputs, hz, codes, first, 3500);
        let heard = play(&mut *inputs, hz, codes, first + 3500 * BLOCK, 500);
        let drive = truth.drive_response(hz) * truth.spec().full_scale_m;
        let share = place_m / truth.length_m() * 4000.0;
        let at = |finger: Option<&slipline_plate::Finger>| {
            let field = respond_touched(&truth, finger, hz, 4001, Equation::Corrected).expect("in range");
            let (left, t) = (share as usize, share.fract());
            (field.amplitude[left] * (1.0 - t) + field.amplitude[left + 1] * t) * drive
        };
        let (bare, weighed) = (at(None), at(Some(&body.at(place_m))));
        assert!((weighed / bare - 1.0).norm() > 0.03, "the mass counts: {bare} {weighed}");
        let wanted = weighed / rig.sensor_full_scale() * codes * hold(hz);
        let found = amplitude(&heard[0], hz, first + 3500 * BLOCK);
        let ratio = found / wanted;
        assert!((ratio - 1.0).norm() < 0.02, "{place_m}: {ratio}");
    }
    let finger = Some(slipline_plate::Finger::light(0.2));
    let both = PreparedRig::new(&truth, &RigOptions { finger, ..options }, RATE_HZ);
    assert!(matches!(both, Err(RigError::FingerAndBody)), "{both:?}");
}

/// The images of a tone fold onto the current of a piezo, as a smaller capacitance; the bound that its bandwidth states covers them.
#[test]
fn an_amplifier_with_a_bandwidth_lets_images_into_the_current_of_a_piezo() {
    let plate = preset("al-bending").expect("a preset");
    let hz = 25e3;
    let current = |amplifier_hz: Option<f64>| {
        let options = RigOptions { place_m: 0.034, amplifier_hz, ..RigOptions::default() };
        let rig = rig(&plate, options);
        let mut inputs = rig.inputs();
        play(&mut *inputs, hz, 1500.0, 0, 400);
        let heard = play(&mut *inputs, hz, 1500.0, 400 * BLOCK, 250);
        let found = amplitude(&heard[1], hz, 400 * BLOCK) * rig.shunt_full_scale_a() / 1500.0;
        assert_close("as it is stated", found, rig.current(hz));
        found
    };
    let ideal = current(None);
    let off = |bandwidth_hz: f64| {
        let bandwidths = Bandwidths { amplifier_hz: Some(bandwidth_hz), filter_hz: None };
        let ratio = current(Some(bandwidth_hz)) / ideal / bandwidths.response(hz);
        let load =
            rig(&plate, RigOptions { place_m: 0.034, ..RigOptions::default() }).known_drive().circuit.load;
        let bound = bandwidths.error(&load, hz, RATE_HZ).expect("known");
        assert!((ratio - 1.0).norm() < bound + 0.02, "{bandwidth_hz}: {ratio} {bound}");
        ratio
    };
    let ratio = off(100e3);
    assert!(ratio.re < 0.88, "a fifth of the capacitance is missing: {ratio}");
    let ratio = off(45e3);
    assert!((ratio - 1.0).norm() < 0.08, "{ratio}");
}

#[test]
fn a_rig_states_the_linear_share_of_its_device() {
    let plate = preset("al-bending").expect("a preset");
    let share = |linear_share| {
        let rig = rig(&plate, RigOptions { linear_share, ..RigOptions::default() });
        rig.device_options().analogue.linear_per_mille
    };
    assert_eq!((share(1.0), share(0.88)), (1000, 880));
    let refused = |options| PreparedRig::new(&plate, &options, RATE_HZ).expect_err("refused").to_string();
    let error = refused(RigOptions { linear_share: 0.05, ..RigOptions::default() });
    assert!(error.starts_with("linear share = 0.05: must be 0.1 to 1"), "{error}");
    let error = refused(RigOptions { amplifier_hz: Some(200e3), ..RigOptions::default() });
    assert!(error.starts_with("bandwidth of the amplifier = 200000"), "{error}");
}

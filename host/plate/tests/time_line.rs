//! The plate in time against the frequency domain: through codes, with and without the table, for presets and for
//! random plates.

use super::drive_curve::settled_phasor;
use proptest::prelude::*;
use slipline_plate::quantity::{OutOfRange, decibels};
use slipline_plate::{
    Actuator, Air, AirMounting, Bending, Complex64, DriveEnd, DriveTable, Equation, Faces, Gas, LineError,
    Model, Plate, PlateSpec, Resonator, Source, Taper, TimeDomainLine, TurningWidth, preset, presets,
    respond,
};
use std::f64::consts::TAU;

/// Plays a tone of 12-bit codes on the line until it has settled; afterwards the envelope can be read.
fn settle(line: &mut TimeDomainLine, rate: f64, frequency: f64, amplitude: f64) {
    let code = |n: usize| {
        let value = amplitude * (TAU * frequency * n as f64 / rate).cos();
        (2048.0 + 2047.0 * value).round() as u16
    };
    line.rest();
    let wait = (line.settle_time_s() * rate) as usize;
    let cycles = (rate * 12.0 / frequency) as usize;
    let codes: Vec<u16> = (0..wait + cycles).map(code).collect();
    line.push_codes(&codes[..wait], 12);
    line.reset_envelope();
    line.push_codes(&codes[wait..], 12);
}

/// A sample rate, Hz, that can carry the plate's band but keeps the test short.
fn rate_for(plate: &Plate) -> f64 {
    (plate.band_hz().1 * 10.0).clamp(4e3, 400e3)
}

/// Asserts that the fields of settled tones on a line in time equal those of `respond`, up to `error` times the largest
/// amplitude.
pub(crate) fn assert_answers_tones(plate: &Plate, rate_hz: f64, frequencies_hz: &[f64], error: f64) {
    let line = TimeDomainLine::new(plate, rate_hz, 65).expect("a line");
    frequencies_hz.iter().for_each(|hz| assert_answers_a_tone(plate, line.clone(), (rate_hz, *hz), error));
}

fn assert_answers_a_tone(
    plate: &Plate,
    mut line: TimeDomainLine,
    (rate_hz, frequency_hz): (f64, f64),
    error: f64,
) {
    let settle = (rate_hz * line.settle_time_s()) as u32;
    let tone = |n: u32| (TAU * frequency_hz * f64::from(n) / rate_hz).cos() as f32;
    line.push(&(0..settle).map(tone).collect::<Vec<f32>>());
    line.reset_envelope();
    line.push(&(settle..settle + 2000).map(tone).collect::<Vec<f32>>());
    let steady = respond(plate, frequency_hz, 65, Equation::Corrected).expect("enters");
    let largest = steady.amplitude.iter().map(|f| f.norm()).fold(0.0, f64::max);
    for (found, wanted) in line.envelope().rms_m().iter().zip(&steady.amplitude) {
        let wanted = wanted.norm() / 2.0_f64.sqrt();
        let found = f64::from(*found) / plate.spec().full_scale_m;
        assert!((found - wanted).abs() < error * largest, "{found} {wanted}");
    }
}

#[test]
fn a_light_membrane_in_a_baffle_moves_in_time_as_at_each_frequency() {
    let mounting = AirMounting::Baffle { faces: Faces::Two };
    let air = Some(Air::Around { gas: Gas::ROOM, mounting, gap_m: None });
    let still = preset("latex-membrane").expect("a preset");
    // 0.2 kg/m^2: above its span the field is no sum of decaying resonances.
    let model = Model::Membrane { wave_speed_m_per_s: 12.0, tension_n_per_m: Some(28.8), film: None };
    let plate = Plate::new(PlateSpec { air, model, ..still.spec().clone() }).expect("a plate");
    assert_answers_tones(&plate, 4e3, &[85.0, 120.0, 160.0, 200.0], 3e-2);
}

#[test]
fn the_latency_is_the_time_by_which_the_field_lags_the_plate() {
    // One rate whose codes are decimated once, and rates whose codes are decimated twice.
    for (name, rate_hz) in [("al-bending", 400e3), ("al-sh", 400e3), ("membrane", 4e3), ("membrane", 20e3)] {
        let plate = preset(name).expect("a preset");
        let (low_hz, high_hz) = plate.band_hz();
        let line = TimeDomainLine::new(&plate, rate_hz, 65).expect("a line");
        // The remaining phase of the field: at every frequency the same, that of the carrier.
        let left = |hz: f64| {
            let found = settled_phasor(&line, hz, rate_hz, 20);
            let exact = respond(&plate, hz, 65, Equation::Corrected).expect("in band").amplitude[20];
            // A code is held from its time on, so the middle of its hold is half a sample later.
            found / (exact * plate.drive_response(hz) * Complex64::cis(std::f64::consts::PI * hz / rate_hz))
        };
        let (first_hz, last_hz) = (1.02 * low_hz, 0.98 * high_hz);
        for hz in [(first_hz * last_hz).sqrt(), last_hz] {
            let samples = (left(hz) / left(first_hz)).arg() / (TAU * (hz - first_hz)) * rate_hz;
            assert!(samples.abs() < 0.1, "{name}, {rate_hz} Hz, {hz} Hz: {samples} samples");
        }
    }
}

fn peaks_agree(plate: &Plate, frequency: f64, line: &mut TimeDomainLine, rate: f64) -> Result<(), String> {
    settle(line, rate, frequency, 0.9);
    let exact = respond(plate, frequency, 401, Equation::Corrected).map_err(|error| error.to_string())?;
    let found = line.envelope().peak(plate, frequency);
    match (found, exact.peak) {
        (Some(found), Some(wanted)) => {
            let off = (found.position_m - wanted.position_m).abs();
            if off > exact.edge_width_m / 20.0 {
                return Err(format!(
                    "{frequency} Hz: peak at {} for {}",
                    found.position_m, wanted.position_m
                ));
            }
            let turn = std::f64::consts::PI * frequency / rate;
            let actuator = plate.spec().actuator.as_ref().map_or(1.0, |it| it.response(frequency).norm());
            let level = 0.9 * wanted.amplitude * actuator * plate.spec().full_scale_m * turn.sin() / turn;
            let error_db = decibels(found.amplitude / level);
            if error_db.abs() > 0.5 {
                return Err(format!("{frequency} Hz: {error_db} dB"));
            }
        }
        (None, None) => {}
        // At the limit of having a peak the two may disagree; then neither has a clear peak.
        (Some(peak), None) | (None, Some(peak)) => {
            if peak.position_m > 0.02 * plate.length_m() && plate.wave_loss() < 0.02 {
                return Err(format!("{frequency} Hz: {found:?} for {:?}", exact.peak));
            }
        }
    }
    Ok(())
}

#[test]
fn every_preset_peaks_in_time_where_the_frequency_domain_puts_it() {
    for entry in presets() {
        let plate = entry.plate().expect("a preset");
        let rate = rate_for(&plate);
        let mut line = TimeDomainLine::new(&plate, rate, 257).expect("a line");
        let (start, end) = plate.span_m();
        for i in 0..4 {
            let x = start + (end - start) * (f64::from(i) + 0.4) / 4.0;
            peaks_agree(&plate, plate.frequency_for_boundary_hz(x), &mut line, rate)
                .unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
        }
    }
}

#[test]
fn dragged_in_steps_with_the_table_the_settled_peak_stays_within_1_db_for_every_preset() {
    for entry in presets() {
        let plate = entry.plate().expect("a preset");
        let rate = rate_for(&plate);
        let table = DriveTable::build(&plate, rate, 1025).expect("a table");
        let mut line = TimeDomainLine::new(&plate, rate, 193).expect("a line");
        for i in 0..5 {
            let x = table.span_m().0 + (table.span_m().1 - table.span_m().0) * (f64::from(i) + 0.61) / 5.0;
            let frequency = table.frequency_hz(x);
            settle(&mut line, rate, frequency, table.gain(x));
            let Some(peak) = line.envelope().peak(&plate, frequency) else { continue };
            let error = decibels(peak.amplitude / table.peak_at_full_scale_m());
            assert!(error.abs() < 1.0, "{} at {x}: {error} dB", entry.name);
        }
    }
}

#[test]
fn a_line_between_clamped_edges_peaks_where_the_frequency_domain_puts_it() {
    let mut spec = preset("al-bending").expect("a preset").spec().clone();
    spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
    (spec.drive_end, spec.loss_factor) = (DriveEnd::Displacement, 0.02);
    let bending = spec.model.bending().expect("bending").clone();
    for thick_plate in [false, true] {
        let model = Model::BendingClamped(Bending { thick_plate, ..bending.clone() });
        let plate = Plate::new(PlateSpec { model, ..spec.clone() }).expect("a valid plate");
        let mut line = TimeDomainLine::new(&plate, 400e3, 257).expect("a line");
        for x in [0.21, 0.25] {
            let frequency_hz = plate.frequency_for_boundary_hz(x);
            settle(&mut line, 400e3, frequency_hz, 0.5);
            let found = line.envelope().peak(&plate, frequency_hz).expect("a peak").position_m;
            let exact = respond(&plate, frequency_hz, 513, Equation::Corrected).expect("enters");
            let wanted = exact.peak.expect("a peak").position_m;
            assert!((found - wanted).abs() < 1e-3, "{thick_plate} {x}: {found} for {wanted}");
        }
    }
    spec.drive_end = DriveEnd::Source(Source::soft(&spec.model, 60e3));
    let plate = Plate::new(spec).expect("a valid plate");
    assert!(TimeDomainLine::new(&plate, 400e3, 64).is_ok());
}

#[test]
fn thick_and_actuated_plates_ring_as_the_frequency_domain_says() {
    let base = preset("al-bending").expect("a preset").spec().clone();
    let bending = base.model.bending().expect("bending").clone();
    let variations = [
        PlateSpec {
            model: Model::BendingSupported(Bending { thick_plate: true, ..bending }),
            ..base.clone()
        },
        PlateSpec {
            actuator: Some(Actuator::Resonator(Resonator {
                resonance_hz: 21e3,
                quality: 12.0,
                travel: None,
            })),
            ..base.clone()
        },
        PlateSpec {
            actuator: Some(Actuator::Resonator(Resonator { resonance_hz: 30e3, quality: 4.0, travel: None })),
            drive_end: DriveEnd::Force { at_frequency_hz: 20e3 },
            loss_factor: 0.01,
            ..base
        },
    ];
    for spec in variations {
        let plate = Plate::new(spec).expect("a valid plate");
        let mut line = TimeDomainLine::new(&plate, 400e3, 257).expect("a line");
        for x in [0.13, 0.26] {
            peaks_agree(&plate, plate.frequency_for_boundary_hz(x), &mut line, 400e3)
                .unwrap_or_else(|fault| panic!("{:?}: {fault}", plate.spec()));
        }
    }
}

#[test]
fn a_plate_at_rest_stays_at_rest_and_rest_ends_every_motion() {
    let plate = preset("membrane").expect("a preset");
    let mut line = TimeDomainLine::new(&plate, 4e3, 64).expect("a line");
    line.push(&[0.0; 4000]);
    let mut field = vec![1.0_f32; 64];
    line.field_m(&mut field);
    assert!(field.iter().all(|&u| u == 0.0));
    line.push(&[f32::NAN, f32::INFINITY, 1.0, -1.0]);
    line.push(&(0..4000).map(|n| (f64::from(n) * 0.2).sin() as f32).collect::<Vec<_>>());
    line.field_m(&mut field);
    assert!(field.iter().all(|u| u.is_finite()) && field.iter().any(|u| u.abs() > 1e-6));
    line.rest();
    line.push(&[0.0; 2000]);
    assert!(line.envelope().maximum_m().iter().all(|&u| u == 0.0));
}

#[test]
fn the_analytic_field_of_a_tone_turns_at_the_tones_frequency_and_has_its_amplitude() {
    let plate = preset("al-bending").expect("a preset");
    let (rate, frequency) = (400e3, 30e3);
    let mut line = TimeDomainLine::new(&plate, rate, 65).expect("a line");
    settle(&mut line, rate, frequency, 0.9);
    let codes_per_field = (rate / line.step_rate_hz()).round() as usize;
    let place = 40;
    let mut turned = Vec::new();
    for step in 0..120 {
        line.push(
            &(0..codes_per_field)
                .map(|n| (0.9 * (TAU * frequency * (step * codes_per_field + n) as f64 / rate).cos()) as f32)
                .collect::<Vec<_>>(),
        );
        let mut field = vec![Complex64::ZERO; 65];
        line.analytic_m(&mut field);
        let mut real = vec![0.0_f32; 65];
        line.field_m(&mut real);
        assert!((f64::from(real[place]) - field[place].re).abs() < 1e-12);
        turned.push(field[place] * Complex64::cis(TAU * frequency * step as f64 / line.step_rate_hz()));
    }
    // The join of two stretches of codes causes a transient; after it the phasor is constant.
    let exact = respond(&plate, frequency, 65, Equation::Corrected).expect("enters").amplitude[place].norm();
    let turn = std::f64::consts::PI * frequency / rate;
    let level = 0.9 * exact * plate.spec().full_scale_m * turn.sin() / turn;
    let still = &turned[110..];
    for value in still {
        assert!((value - still[0]).norm() < 0.05 * level, "{value} {}", still[0]);
        assert!((value.norm() / level - 1.0).abs() < 0.05, "{} for {level}", value.norm());
    }
}

#[test]
fn a_line_that_cannot_be_made_says_why() {
    let plate = preset("al-bending").expect("a preset");
    let fault = |rate: f64, points: usize| TimeDomainLine::new(&plate, rate, points).err().expect("refused");
    let told = "sample rate = 50000 Hz: must be 88696 to 1e8 Hz, the plate's band ends at 39912.9 Hz";
    assert_eq!(fault(50e3, 64).to_string(), told);
    assert_eq!(DriveTable::build(&plate, 50e3, 5).expect_err("the same rule").to_string(), told);
    assert!(matches!(fault(f64::NAN, 64), LineError::SampleRate { .. }));
    assert!(matches!(fault(400e3, 4), LineError::OutOfRange(OutOfRange { field: "points", .. })));
}

fn any_plate() -> impl Strategy<Value = Plate> {
    let taper = (0.01..0.2_f64, 1.0..8.0_f64, 0..3_u8);
    let end = (0..3_u8, 0.3..3.0_f64);
    (taper, 0.15..0.8_f64, 0..3_u8, 0.002..0.12_f64, end, 0.05..0.35_f64, 0.7..0.98_f64).prop_filter_map(
        "a plate that can be made",
        |((half_width, rate, shape), length, model, loss, (end, ratio), start, stop)| {
            let width = |x: f64| half_width * (-rate * x).exp();
            let taper = match shape {
                0 => Taper::Exponential { half_width_m: half_width, rate_per_m: rate },
                1 => Taper::Linear { half_width_m: half_width, end_half_width_m: width(length) },
                _ => Taper::Sampled {
                    points: (0..=8)
                        .map(|i| f64::from(i) / 8.0 * length)
                        .map(|x| [x, width(x) / (1.0 + x)])
                        .collect(),
                },
            };
            let bending = Bending {
                youngs_modulus_pa: 7e10,
                poisson_ratio: 0.3,
                density_kg_per_m3: 2700.0,
                thickness_m: 0.001,
                thick_plate: false,
            };
            let model = match model {
                0 => Model::Membrane { wave_speed_m_per_s: 15.0, tension_n_per_m: None, film: None },
                1 => Model::ShearHorizontal {
                    shear_modulus_pa: 1e6,
                    density_kg_per_m3: 1100.0,
                    thickness_m: None,
                },
                // Clamped plates have their own tests in `clamped_time`.
                _ => Model::BendingSupported(bending),
            };
            let mut spec = PlateSpec {
                name: "random".to_owned(),
                taper,
                length_m: length,
                model,
                loss_factor: loss,
                turning_width: TurningWidth::Arc,
                drive_end: DriveEnd::Displacement,
                full_scale_m: 1e-5,
                span_start_m: start * length,
                span_end_m: stop * length,
                ..preset("membrane").expect("a preset").spec().clone()
            };
            let at_frequency_hz = Plate::new(spec.clone()).ok()?.band_hz().1 * 0.8;
            spec.drive_end = match end {
                0 => DriveEnd::Displacement,
                1 => DriveEnd::Force { at_frequency_hz },
                _ => DriveEnd::Resistance { ratio, at_frequency_hz },
            };
            Plate::new(spec).ok()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, max_global_rejects: 5000, ..ProptestConfig::default() })]

    #[test]
    fn random_plates_peak_in_time_where_the_frequency_domain_puts_it(plate in any_plate(), part in 0.0..1.0_f64) {
        let (start, end) = plate.span_m();
        let frequency = plate.frequency_for_boundary_hz(start + part * (end - start));
        let rate = (plate.band_hz().1 * 10.0).clamp(200.0, 1e7);
        let mut line = TimeDomainLine::new(&plate, rate, 201).expect("a line");
        if let Err(fault) = peaks_agree(&plate, frequency, &mut line, rate) {
            return Err(TestCaseError::fail(fault));
        }
    }
}

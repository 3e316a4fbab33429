use super::*;
use crate::definition::actuator::Actuator;
use crate::definition::impedance::Impedance;
use crate::definition::model::{Bending, Model};
use crate::definition::plate::PlateSpec;
use crate::definition::presets::{preset, presets};
use crate::definition::response_curve::ResponseCurve;
use crate::definition::source::{EndSlope, LeadIn, Source};
use crate::frequency::equation::Equation;
use crate::frequency::respond::respond_touched;

/// Settles tones of the band on a line and compares amplitude and peak with the frequency domain.
fn settled_tones_agree(plate: &Plate, line: TimeDomainLine, rate: f64) {
    settled_tones_agree_touched(plate, None, line, rate);
}

/// As [`settled_tones_agree`], optionally with a finger.
fn settled_tones_agree_touched(plate: &Plate, finger: Option<&Finger>, mut line: TimeDomainLine, rate: f64) {
    let name = plate.name();
    let (low, high) = plate.band_hz();
    for frequency in [low * 1.05, (low * high).sqrt(), high] {
        line.rest();
        let settle = (line.settle_time_s() * rate) as usize;
        let measure = (rate * (20.0 / frequency)) as usize;
        let tone = |n: usize| (TAU * frequency * n as f64 / rate).cos() as f32;
        let codes: Vec<f32> = (0..settle).map(tone).collect();
        line.push(&codes);
        line.reset_envelope();
        let codes: Vec<f32> = (settle..settle + measure).map(tone).collect();
        line.push(&codes);
        let exact = respond_touched(plate, finger, frequency, 257, Equation::Corrected).expect("in band");
        let turn = std::f64::consts::PI * frequency / rate;
        let scale = plate.spec().full_scale_m * turn.sin() / turn;
        let top = exact.amplitude.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let worst = line
            .envelope()
            .maximum_m()
            .iter()
            .zip(&exact.amplitude)
            .map(|(found, f)| (f64::from(*found) / scale - f.norm()).abs() / top)
            .fold(0.0, f64::max);
        let found = line.envelope().peak(plate, frequency);
        assert!(worst < 5e-3, "{name} {frequency} Hz: {worst}");
        if let (Some(found), Some(exact_peak)) = (found, exact.peak) {
            let off = (found.position_m - exact_peak.position_m).abs();
            assert!(off < exact.edge_width_m / 50.0, "{name} {frequency} Hz: {off} m");
        }
        assert_eq!(found.is_some(), exact.peak.is_some(), "{name} {frequency} Hz");
    }
}

#[test]
fn a_settled_tone_of_codes_has_the_frequency_domain_amplitude_and_peak() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let line = TimeDomainLine::new(&plate, 400e3, 257, 1).expect("a preset fits 400 kS/s");
        settled_tones_agree(&plate, line, 400e3);
    }
}

#[test]
fn a_settled_tone_on_a_fitted_line_has_the_frequency_domain_amplitude_and_peak() {
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        // A rate with ample room for the band: at a higher one the low presets, which settle for seconds, would take
        // too long.
        let rate = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let line = TimeDomainLine::fitted(&plate, rate, 257, 1).expect("the rate carries the band");
        settled_tones_agree(&plate, line, rate);
    }
}

#[test]
fn a_step_of_amplitude_decays_on_a_fitted_line_as_on_the_line_of_eigenfunctions() {
    for name in ["al-bending", "al-bending-displacement", "paper-as-printed"] {
        let plate = preset(name).expect("a preset");
        let (rate, frequency) = (400e3, plate.band_hz().1 * 0.83);
        let mut exact = TimeDomainLine::new(&plate, rate, 65, 1).expect("a line");
        let mut fitted = TimeDomainLine::fitted(&plate, rate, 65, 1).expect("a line");
        let settle = exact.settle_time_s() * rate;
        assert!((fitted.settle_time_s() * rate / settle - 1.0).abs() < 0.3, "{name}");
        let mut field = [vec![Complex64::ZERO; 65], vec![Complex64::ZERO; 65]];
        let (mut worst, mut top, mut after): (f64, f64, f64) = (0.0, 0.0, 0.0);
        let mut n = 0;
        // A tone of full scale for 4 ms, then of a tenth of full scale, in blocks of 0.1 ms.
        for block in 0..160 {
            let amplitude = if block < 40 { 1.0 } else { 0.1 };
            let codes: Vec<f32> = (n..n + 40)
                .map(|n| (amplitude * (TAU * frequency * f64::from(n) / rate).cos()) as f32)
                .collect();
            n += 40;
            exact.push(&codes);
            fitted.push(&codes);
            exact.analytic_m(&mut field[0]);
            fitted.analytic_m(&mut field[1]);
            for (a, b) in field[0].iter().zip(&field[1]) {
                worst = worst.max((a - b).norm());
                top = top.max(a.norm());
            }
            after = field[1].iter().map(|f| f.norm()).fold(0.0, f64::max);
        }
        assert!(worst < 1e-3 * top, "{name}: {worst} of {top}");
        assert!(after < 0.7 * top, "{name}: the step was heard");
    }
}

/// Preset `name` with another driven end.
fn with_end(name: &str, drive_end: DriveEnd) -> Plate {
    Plate::new(PlateSpec { drive_end, ..preset(name).expect("a preset").spec().clone() })
        .expect("a valid plate")
}

#[test]
fn sources_slopes_and_lead_ins_ring_as_the_frequency_domain_says() {
    let lead_in = LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 60.0 };
    let bending = preset("al-bending").expect("a preset").spec().model.clone();
    let membrane = preset("membrane").expect("a preset").spec().model.clone();
    let ends = [
        ("al-bending", DriveEnd::DisplacementAndSlope { slope: EndSlope::Free }),
        ("al-bending", DriveEnd::DisplacementAndSlope { slope: EndSlope::Held }),
        ("al-bending", DriveEnd::Source(Source { lead_in: Some(lead_in), ..Source::soft(&bending, 28e3) })),
        (
            "al-bending",
            DriveEnd::Source(Source {
                impedance: Impedance { mass_kg: 2e-4, ..Impedance::damper(43.0) },
                slope: Some(EndSlope::Held),
                ..Source::soft(&bending, 28e3)
            }),
        ),
        (
            "membrane",
            DriveEnd::Source(Source {
                impedance: Impedance { resistance_n_s_per_m: 0.15, mass_kg: 1e-3, stiffness_n_per_m: 600.0 },
                ..Source::soft(&membrane, 140.0)
            }),
        ),
    ];
    for (name, end) in ends {
        let plate = with_end(name, end);
        let rate = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let line =
            TimeDomainLine::new(&plate, rate, 257, 1).unwrap_or_else(|error| panic!("{end:?}: {error}"));
        settled_tones_agree(&plate, line, rate);
    }
}

#[test]
fn a_settled_tone_on_a_touched_line_has_the_amplitude_of_the_touched_plate() {
    let [membrane, bending] = ["membrane", "al-bending"].map(|name| preset(name).expect("a preset"));
    for (plate, finger) in
        [(&membrane, Finger::light(0.16)), (&membrane, Finger::firm(0.2)), (&bending, Finger::firm(0.24))]
    {
        let rate = (10.0 * plate.band_hz().1).clamp(4e3, 400e3);
        let line = TimeDomainLine::touched(plate, &finger, rate, 257).expect("a line");
        settled_tones_agree_touched(plate, Some(&finger), line, rate);
    }
    let off = TimeDomainLine::touched(&membrane, &Finger::light(2.0), 4e3, 257).err().expect("refused");
    assert!(off.to_string().starts_with("finger place = "), "{off}");
}

#[test]
fn what_has_no_line_is_refused() {
    let plate = with_end("al-bending", DriveEnd::DisplacementAndSlope { slope: EndSlope::Free });
    let refused = TimeDomainLine::new(&plate, 400e3, 65, 3).err().expect("refused");
    assert!(matches!(refused, LineError::OutOfRange(OutOfRange { field: "width mode", .. })), "{refused}");
    // 20 dB up and down within 4 Hz.
    let zigzag = |i: u32| [2e4 + 2.0 * f64::from(i), if i.is_multiple_of(2) { 10.0 } else { -10.0 }, 0.0];
    let curve = ResponseCurve { points: (0..10_000).map(zigzag).collect() };
    let measured = PlateSpec { actuator: Some(Actuator::Measured(curve)), ..plate.spec().clone() };
    let measured = Plate::new(measured).expect("a valid plate");
    let refused = TimeDomainLine::new(&measured, 400e3, 65, 1).err().expect("refused");
    assert!(matches!(&refused, LineError::Drive(error) if error.error > 0.5), "{refused}");
}

#[test]
fn a_field_that_grows_is_refused() {
    let plate = preset("al-bending").expect("a preset");
    let plan = plan(&plate, 400e3, 65, 1).expect("a line");
    let growing = |frequencies: &[f64]| {
        let field = |f: &f64| vec![1e3 / (Complex64::new(1.8e5, 1e3) - TAU * f); 65];
        frequencies.iter().map(field).collect::<Vec<_>>()
    };
    let fit = fit::exact(growing, &plan, 65);
    let refused = TimeDomainLine::of_fit(&plate, plan, 65, &fit).err().expect("refused");
    assert!(matches!(refused, LineError::Unfit { error, .. } if error > 0.1), "{refused}");
}

#[test]
fn a_line_that_eigenfunctions_do_not_describe_is_fitted() {
    let mut spec = preset("al-bending").expect("a preset").spec().clone();
    let bending = spec.model.bending().expect("bending").clone();
    spec.model = Model::BendingSupported(Bending { thick_plate: true, ..bending });
    let plate = Plate::new(spec).expect("a valid plate");
    let line = TimeDomainLine::new(&plate, 400e3, 257, 1).expect("a line");
    settled_tones_agree(&plate, line, 400e3);
}
